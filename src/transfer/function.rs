//! The transfer function: piecewise linear color and opacity over a property's range.

use super::Scale;

/// Opacities are kept below one: full opacity would mean an infinite extinction.
pub const MAX_OPACITY: f64 = 1.0 - 1e-6;

/// Positions and what is there; linear between them, a jump where two are equal.
pub type Curve<T> = Vec<(f64, T)>;

/// Piecewise linear color and opacity over positions 0..1 of a property's range.
///
/// **Invariants**: both curves have at least one point; positions do not decrease.
/// **Units**: `reference_length` in world-space length units; opacity is per that length.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunction {
    /// Position and color in sRGB, 0..1.
    pub color: Curve<[f64; 3]>,
    /// Position and opacity, 0..1.
    pub opacity: Curve<f64>,
    /// Values at positions 0 and 1, in the scale.
    pub range: [f64; 2],
    /// What values and range stand for.
    pub scale: Scale,
    /// Number of equal parts that have one color each; `None` where colors pass into each other.
    pub bands: Option<usize>,
    /// Length to which an opacity refers.
    pub reference_length: f64,
}

impl TransferFunction {
    /// The range as true values; of categories the first and the last.
    pub fn true_range(&self) -> [f64; 2] {
        self.range.map(|v| self.scale.true_value(v))
    }

    /// Position of a value in the range, clamped to 0..1. An empty range puts all at 0.
    pub fn position(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        if high > low {
            ((value - low) / (high - low)).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }

    /// Position of a value that is given as a part of `range`, not clamped: offset, and factor on the part.
    /// Both are 0 where this function's own range is empty.
    pub fn positions(&self, range: [f64; 2]) -> [f64; 2] {
        let [low, high] = self.range;
        let scale = if high > low { 1.0 / (high - low) } else { 0.0 };
        [scale * (range[0] - low), scale * (range[1] - range[0])]
    }

    /// Color at a position in sRGB; interpolation happens in sRGB, as color maps are published.
    pub fn srgb(&self, position: f64) -> [f64; 3] {
        color_at(&self.color, position)
    }

    /// Opacity per reference length at a position.
    pub fn opacity(&self, position: f64) -> f64 {
        let (a, b, f) = segment(&self.opacity, position);
        a + (b - a) * f
    }

    /// Extinction at a position, per world-space length.
    pub fn extinction(&self, position: f64) -> f64 {
        self.extinction_of(self.opacity(position))
    }

    /// Extinction of an opacity per reference length, per world-space length: `-ln(1 - alpha) / L`.
    pub fn extinction_of(&self, opacity: f64) -> f64 {
        -(-opacity.min(MAX_OPACITY)).ln_1p() / self.reference_length
    }
}

/// The color of a map at a position, in sRGB.
pub fn color_at(map: &Curve<[f64; 3]>, position: f64) -> [f64; 3] {
    let (a, b, f) = segment(map, position);
    std::array::from_fn(|c| a[c] + (b[c] - a[c]) * f)
}

/// The two points around `position` and the fraction between them.
pub(super) fn segment<T: Copy>(curve: &[(f64, T)], position: f64) -> (T, T, f64) {
    let after = curve.partition_point(|point| point.0 <= position);
    let (low, high) = (after.saturating_sub(1), after.min(curve.len() - 1));
    let (a, b) = (curve[low], curve[high]);
    let width = b.0 - a.0;
    let fraction = if width > 0.0 {
        (position - a.0) / width
    } else {
        0.0
    };
    (a.1, b.1, fraction.clamp(0.0, 1.0))
}
