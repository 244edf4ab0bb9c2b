//! Round numbers along a legend.

/// Round values within a range, about `wanted` of them, rising; only the value where the range is empty.
pub fn ticks([low, high]: [f64; 2], wanted: usize) -> Vec<f64> {
    let span = high - low;
    if !(span > 0.0 && span.is_finite()) {
        return vec![low];
    }
    let rough = span / wanted.max(1) as f64;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .iter()
        .map(|m| m * power)
        .find(|s| *s >= 0.999 * rough)
        .unwrap_or(rough);
    if !(step > 0.0 && step.is_finite()) {
        return vec![low];
    }
    let first = (low / step - 1e-9).ceil();
    (0..=4 * wanted)
        .map(|n| (first + n as f64) * step)
        .take_while(|v| *v <= high + 1e-9 * span)
        .collect()
}

/// A tick's value with the digits that its step needs.
pub fn label(value: f64, span: f64) -> String {
    let magnitude = value.abs().max(span.abs());
    if magnitude >= 1e6 || (magnitude < 1e-3 && magnitude > 0.0) {
        return format!("{value:.2e}");
    }
    let decimals = (2.0 - span.abs().max(1e-9).log10()).floor().clamp(0.0, 6.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(ticks([0.0, 1.0], 5).len(), 6);
        assert_eq!(ticks([298.55, 364.9], 5), [300.0, 320.0, 340.0, 360.0]);
        assert_eq!(ticks([5.0, 5.0], 5), [5.0]);
        assert_eq!(ticks([-1.0, 1.0], 4), [-1.0, -0.5, 0.0, 0.5, 1.0]);
        for range in [
            [0.0, 1e-30],
            [-1e30, 1e30],
            [1e15, 1e15 + 4.0],
            [0.0, f64::NAN],
        ] {
            assert!(ticks(range, 5).len() <= 21);
        }
    }

    #[test]
    fn labels_show_what_the_step_needs() {
        assert_eq!(label(0.2, 1.0), "0.2");
        assert_eq!(label(300.0, 66.0), "300");
        assert_eq!(label(0.0, 1.0), "0");
        assert_eq!(label(2.5e7, 1e7), "2.50e7");
    }
}
