//! Round numbers along a legend or an axis.

/// Round values within a range, about `wanted` of them, rising, each with its label; only the first
/// value where the range is empty or not finite.
pub fn labels(range: [f64; 2], wanted: usize) -> Vec<(f64, String)> {
    let values = ticks(range, wanted);
    let step = match values[..] {
        [a, b, ..] => b - a,
        [v] if v.fract() == 0.0 && v.abs() < 1e6 => 1.0,
        // One value alone is shown with three digits.
        _ => values[0].abs() * 1e-2,
    };
    let largest = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let named = |v: f64| (v, label(v, largest, step));
    values.into_iter().map(named).collect()
}

/// The same, never with an exponent: coordinates are long numbers whose last digits count.
pub fn plain_labels(range: [f64; 2], wanted: usize) -> Vec<(f64, String)> {
    let values = ticks(range, wanted);
    let step = values.get(1).map_or(1.0, |v| v - values[0]);
    let decimals = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
    let is_short = |v: f64| v == 0.0 || (1e-9..1e12).contains(&v.abs());
    let named = |v: f64| is_short(v).then(|| (v, format!("{v:.decimals$}")));
    values.into_iter().filter_map(named).collect()
}

/// Powers of ten within a range, twice and five times them too where there are few, each with its
/// label; those of [`labels`] where the range is less than a decade or not positive.
pub fn log_labels([low, high]: [f64; 2], wanted: usize) -> Vec<(f64, String)> {
    let decades = (high / low).log10();
    if !(low > 0.0 && decades >= 1.0 && decades.is_finite()) {
        return labels([low, high], wanted);
    }
    let few = 3.0 * decades <= 2.0 * wanted as f64;
    let factors: &[f64] = if few { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let every = (decades / wanted.max(1) as f64).ceil() as i32;
    (low.log10().floor() as i32..=high.log10().floor() as i32)
        .filter(|power| power.rem_euclid(every) == 0)
        .flat_map(|power| factors.iter().map(move |f| f * 10f64.powi(power)))
        .filter(|v| (low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(v))
        .map(|v| (v, label(v, v, v)))
        .collect()
}

fn ticks([low, high]: [f64; 2], wanted: usize) -> Vec<f64> {
    let span = high - low;
    let rough = span / wanted.max(1) as f64;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|m| m * power)
        .into_iter()
        .find(|s| *s >= 0.999 * rough)
        .unwrap_or(rough);
    // Steps that vanish beside the values would give the same value again and again.
    let visible = step > low.abs().max(high.abs()) * 1e-13;
    if !(span > 0.0 && step.is_finite() && visible) {
        return vec![low];
    }
    let first = (low / step - 1e-9).ceil();
    (0..=4 * wanted)
        // Adding 0 turns a negative zero into zero.
        .map(|n| (first + n as f64) * step + 0.0)
        .take_while(|v| *v <= high + 1e-9 * span)
        .collect()
}

/// A value with the digits that a step needs, where `largest` is the largest value beside it.
pub fn label(value: f64, largest: f64, step: f64) -> String {
    let digits = |v: f64| {
        let digits = v.abs().log10();
        if digits.is_finite() {
            (digits + 1e-9).floor()
        } else {
            0.0
        }
    };
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    if (1e-3..1e6).contains(&largest) {
        let decimals = (-digits(step)).clamp(0.0, 12.0) as usize;
        return format!("{value:.decimals$}");
    }
    let decimals = (digits(value) - digits(step)).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.decimals$e}");
    match text.split_once('e') {
        Some((mantissa, exponent)) => format!("{}e{exponent}", shortened(mantissa)),
        None => text,
    }
}

/// A value with the digits that a step needs and no zeros at its end, where `largest` is the largest value beside
/// it.
pub fn short_label(value: f64, largest: f64, step: f64) -> String {
    let text = label(value, largest, step);
    match text.contains('e') {
        true => text,
        false => match shortened(&text) {
            // What rounds to zero has no sign.
            "-0" => "0".to_owned(),
            short => short.to_owned(),
        },
    }
}

/// A decimal number without the zeros at its end.
pub fn shortened(number: &str) -> &str {
    if number.contains('.') {
        number.trim_end_matches('0').trim_end_matches('.')
    } else {
        number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(range: [f64; 2], wanted: usize) -> Vec<String> {
        labels(range, wanted).into_iter().map(|l| l.1).collect()
    }

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(
            texts([0.0, 1.0], 5),
            ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        assert_eq!(ticks([298.55, 364.9], 5), [300.0, 320.0, 340.0, 360.0]);
        assert_eq!(texts([298.55, 364.9], 5), ["300", "320", "340", "360"]);
        assert_eq!(texts([-1.0, 1.0], 4), ["-1.0", "-0.5", "0", "0.5", "1.0"]);
        assert_eq!(
            texts([-37.0, -12.0], 5),
            ["-35", "-30", "-25", "-20", "-15"]
        );
        // A negative twin: ticks must move with the range.
        assert_ne!(texts([-37.0, -12.0], 5), texts([-47.0, -22.0], 5));
    }

    #[test]
    fn labels_of_huge_and_tiny_values_differ_from_each_other() {
        assert_eq!(
            texts([0.0, 1e9], 5),
            ["0", "2e8", "4e8", "6e8", "8e8", "1e9"]
        );
        assert_eq!(texts([1e-7, 3.3e-6], 3), ["2e-6"]);
        assert_eq!(
            texts([300.0, 300.002], 2),
            ["300.000", "300.001", "300.002"]
        );
        for range in [
            [1e15, 1.0001e15],
            [1e-30, 3e-30],
            [-5e7, 5.1e7],
            [0.0, 1e-30],
        ] {
            let mut texts = texts(range, 5);
            let all = texts.len();
            texts.dedup();
            assert!(texts.len() == all && all > 2, "{range:?} {texts:?}");
        }
    }

    #[test]
    fn short_labels_have_no_zeros_at_the_end_and_no_negative_zero() {
        let text = |value: f64| short_label(value, 1.0, 1e-3);
        assert_eq!(
            [0.85, 0.0, -1e-8, -0.25, 1.0].map(text),
            ["0.85", "0", "0", "-0.25", "1"]
        );
        assert_eq!(short_label(2e8, 2e8, 1e5), "2e8");
        assert_eq!(short_label(300.0, 400.0, 2.0), "300");
    }

    #[test]
    fn coordinates_have_all_their_digits() {
        let texts = |range| -> Vec<String> {
            let labels = plain_labels(range, 4).into_iter();
            labels.map(|l| l.1).collect()
        };
        assert_eq!(
            texts([5_930_210.0, 5_933_500.0]),
            ["5931000", "5932000", "5933000"]
        );
        assert_eq!(texts([0.1, 0.9]), ["0.2", "0.4", "0.6", "0.8"]);
        assert_eq!(texts([-2.0, 2.0]), ["-2", "-1", "0", "1", "2"]);
        assert!(texts([f64::NAN, 1.0]).is_empty() && texts([1e300, 2e300]).is_empty());
    }

    #[test]
    fn empty_and_odd_ranges_give_one_value() {
        assert_eq!(texts([5.0, 5.0], 5), ["5"]);
        assert_eq!(texts([0.123_456, 0.123_456], 5), ["0.123"]);
        assert_eq!(texts([0.0, 0.0], 5), ["0"]);
        assert_eq!(texts([1e15, 1e15 + 0.125], 5), ["1e15"]);
        for odd in [
            [0.0, f64::NAN],
            [f64::NAN, 1.0],
            [-1e308, 1e308],
            [0.0, 5e-324],
            [2.0, 1.0],
        ] {
            assert_eq!(labels(odd, 5).len(), 1, "{odd:?}");
        }
        assert_eq!(labels([0.0, 1.0], 0).len(), 1);
    }

    #[test]
    fn log_labels_are_round_and_inside() {
        let texts = |range, wanted| -> Vec<String> {
            let labels = log_labels(range, wanted).into_iter();
            labels.map(|l| l.1).collect()
        };
        assert_eq!(texts([0.9, 11.0], 5), ["1", "2", "5", "10"]);
        assert_eq!(texts([0.015, 0.16], 2), ["0.02", "0.05", "0.1"]);
        assert_eq!(
            texts([1.0, 1e6], 7),
            ["1", "10", "100", "1000", "10000", "100000", "1e6"]
        );
        assert_eq!(
            texts([1e-6, 1e9], 5),
            ["1e-6", "0.001", "1", "1000", "1e6", "1e9"]
        );
        // Less than a decade, and what has no logarithm.
        assert_eq!(texts([20.0, 80.0], 3), ["20", "40", "60", "80"]);
        assert_eq!(texts([0.0, 1.0], 2), ["0", "0.5", "1.0"]);
        for odd in [
            [f64::NAN, 1.0],
            [1.0, f64::INFINITY],
            [5e-324, 1e308],
            [2.0, 1.0],
        ] {
            assert!(!texts(odd, 5).is_empty(), "{odd:?}");
        }
        assert!(!texts([1.0, 100.0], 0).is_empty());
    }
}
