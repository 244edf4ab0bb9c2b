//! The formulas of OPERATE and OPERATER.

/// A formula over the value x of one array, and for some the value r of the array that is set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Formula {
    /// a x + b
    Linear(f64, f64),
    /// r + a x^b
    AddPower(f64, f64),
    /// 10^(a + b x)
    Exponential(f64, f64),
    /// Logarithm of x, to 10.
    Log10,
    /// Logarithm of x, natural.
    LogE,
    /// 1 / x
    Inverse,
    /// a + x
    Shift(f64),
    /// The smaller one of a and x.
    AtMost(f64),
    /// The larger one of a and x.
    AtLeast(f64),
    /// a x^b
    Power(f64, f64),
    /// The magnitude of x.
    Magnitude,
    /// r x
    Product,
}

impl Formula {
    /// The formula of that name; `None` of one that is not known.
    pub(super) fn of(name: &str, [a, b]: [f64; 2]) -> Option<Self> {
        Some(match name {
            "MULTA" => Self::Linear(a, b),
            "MULTX" => Self::Linear(a, 0.0),
            "COPY" => Self::Linear(1.0, 0.0),
            "POLY" => Self::AddPower(a, b),
            "SLOG" => Self::Exponential(a, b),
            "LOG10" => Self::Log10,
            "LOGE" => Self::LogE,
            "INV" => Self::Inverse,
            "ADDX" => Self::Shift(a),
            "MAXLIM" => Self::AtMost(a),
            "MINLIM" => Self::AtLeast(a),
            "MULTP" => Self::Power(a, b),
            "ABS" => Self::Magnitude,
            "MULTIPLY" => Self::Product,
            _ => return None,
        })
    }

    /// True where the value of the array that is set matters.
    pub(super) fn needs_target(self) -> bool {
        matches!(self, Self::AddPower(..) | Self::Product)
    }

    /// The new value; NaN where `x` is undefined or the formula gives no finite number.
    pub(super) fn value(self, r: f64, x: f64) -> f64 {
        let value = match self {
            // Limits would take the defined one of two.
            _ if x.is_nan() => f64::NAN,
            Self::Linear(a, b) => a * x + b,
            Self::AddPower(a, b) => r + a * x.powf(b),
            Self::Exponential(a, b) => 10_f64.powf(a + b * x),
            Self::Log10 => x.log10(),
            Self::LogE => x.ln(),
            Self::Inverse => x.recip(),
            Self::Shift(a) => a + x,
            Self::AtMost(a) => x.min(a),
            Self::AtLeast(a) => x.max(a),
            Self::Power(a, b) => a * x.powf(b),
            Self::Magnitude => x.abs(),
            Self::Product => r * x,
        };
        if value.is_finite() { value } else { f64::NAN }
    }
}
