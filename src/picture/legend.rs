//! The legend: a bar of the transfer function's colors with round values and the opacity curve.

use glam::DVec2;

use super::orientation::Area;
use super::pen::Pen;
use super::srgb_8bit;
use super::ticks::{label, labels, log_labels};
use crate::transfer::{Scale, TransferFunction};

/// What stands beside a legend's bar: positions from 0 at the low end to 1, rising, each with its label.
///
/// About `wanted` round values; where the bar has parts of one color, the limits of the bands, or every
/// category in its middle, of them each so many that at most `most` are left.
pub fn marks(transfer: &TransferFunction, wanted: usize, most: usize) -> Vec<(f64, String)> {
    let placed = |(value, text): (f64, String)| {
        let [low, high] = transfer.range;
        // An empty range is shown in its middle.
        let position = match high > low {
            true => transfer.position(transfer.scale.shown(value, low)),
            false => 0.5,
        };
        (position, text)
    };
    match (&transfer.scale, transfer.bands) {
        (Scale::Categories(values), _) => {
            let every = values.len().div_ceil(most.max(1)).max(1);
            let count = values.len() as f64;
            let middle = |(n, v): (usize, &f64)| ((n as f64 + 0.5) / count, v.to_string());
            let all = values.iter().enumerate();
            all.step_by(every).map(middle).collect()
        }
        (_, Some(bands)) => limits(transfer, bands, most),
        (Scale::Log, None) => {
            let labels = log_labels(transfer.true_range(), wanted);
            labels.into_iter().map(placed).collect()
        }
        _ => labels(transfer.range, wanted)
            .into_iter()
            .map(placed)
            .collect(),
    }
}

/// The ends of the bands.
fn limits(transfer: &TransferFunction, bands: usize, most: usize) -> Vec<(f64, String)> {
    let [low, high] = transfer.range;
    let every = (bands + 1).div_ceil(most.max(2)).max(1);
    let at = |n: usize| n as f64 / bands as f64;
    let value = |n: usize| transfer.scale.true_value(low + (high - low) * at(n));
    let largest = value(0).abs().max(value(bands).abs());
    let text = |n: usize| {
        // A digit more than the width of the next band has, and than the value itself in the logarithm.
        let width = (value(n + 1) - value(n)).abs();
        let width = match transfer.scale {
            Scale::Log => width.min(value(n)),
            _ => width,
        };
        label(value(n), largest, 0.1 * width)
    };
    let all = (0..=bands).step_by(every);
    all.map(|n| (at(n), text(n))).collect()
}

/// Where the bar is, in pixels.
struct Bar {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Bar {
    /// Height of a position in the range.
    fn y(&self, position: f64) -> f64 {
        self.bottom + (self.top - self.bottom) * position
    }

    /// Rows from top to bottom, each with its position in the range.
    fn rows(&self, transfer: &TransferFunction) -> Vec<(i64, f64)> {
        let [low, high] = transfer.range;
        let height = self.bottom - self.top;
        let position = |y: i64| match high > low {
            true => 1.0 - (y as f64 + 0.5 - self.top) / height,
            // Every value has the color at 0.
            false => 0.0,
        };
        let rows = self.top as i64..self.bottom as i64;
        rows.map(|y| (y, position(y))).collect()
    }
}

/// Draws the legend at the right edge and says what it covers; empty lines of the heading take no room.
pub fn draw(pen: &mut Pen, transfer: &TransferFunction, heading: [&str; 2]) -> Area {
    let [w, h] = pen.canvas.size.map(f64::from);
    let unit = pen.unit;
    let height = match &transfer.scale {
        Scale::Categories(values) => (1.8 * unit * values.len().max(1) as f64).min(20.0 * unit),
        _ => 20.0 * unit,
    };
    let height = height.min(0.5 * h);
    let wanted = (height / (2.2 * unit)).clamp(2.0, 7.0) as usize;
    let labels = marks(transfer, wanted, (height / (1.3 * unit)) as usize);
    let label_width = |l: &(f64, String)| pen.canvas.text_width(&l.1, unit);
    let widest = labels.iter().map(label_width).fold(0.0, f64::max);
    let right = (w - 1.6 * unit - widest).max(0.5 * w).round();
    let top = (0.5 * (h - height) + 0.5 * unit).round();
    let bar = Bar {
        left: (right - 1.2 * unit).round(),
        right,
        top,
        bottom: (top + height).round(),
    };
    let heading = heading
        .into_iter()
        .filter(|line| !line.is_empty())
        .map(|line| pen.canvas.cut(line, unit, 0.45 * w))
        .collect::<Vec<_>>();
    let width = |line: &String| pen.canvas.text_width(line, unit);
    let heading_left = heading
        .iter()
        .map(|line| bar.left.min(w - unit - width(line)))
        .fold(bar.left, f64::min);
    let first_line = bar.top - 0.4 * unit - 1.2 * unit * heading.len() as f64;
    let plate_left = heading_left.min(bar.left - 1.5 * unit) - 0.5 * unit;
    let covered = [
        [plate_left, first_line - 0.4 * unit],
        [w, bar.bottom + unit],
    ];
    pen.plate(covered[0], covered[1]);
    for (n, line) in heading.iter().enumerate() {
        pen.write(line, [heading_left, first_line + 1.2 * unit * n as f64]);
    }
    colors(pen, &bar, transfer);
    opacity(pen, &bar, transfer);
    values(pen, &bar, &labels);
    covered.map(DVec2::from_array)
}

fn colors(pen: &mut Pen, bar: &Bar, transfer: &TransferFunction) {
    for (y, position) in bar.rows(transfer) {
        let color = srgb_8bit(transfer.srgb(position));
        for x in bar.left as i64..bar.right as i64 {
            pen.canvas.blend(x, y, color, 1.0);
        }
    }
    let boxes = match &transfer.scale {
        Scale::Categories(values) => values.len().max(1),
        _ => 1,
    };
    let end = |n: usize| bar.y(n as f64 / boxes as f64).round();
    for n in 0..boxes {
        pen.frame([bar.left, end(n + 1)], [bar.right, end(n)], 0.8);
    }
}

/// The opacity curve as a shape left of the bar, widest where the opacity is largest.
fn opacity(pen: &mut Pen, bar: &Bar, transfer: &TransferFunction) {
    let largest = transfer.opacity.iter().fold(0.0, |m: f64, o| m.max(o.1));
    if !(largest > 0.0 && largest.is_finite()) {
        return;
    }
    let ink = pen.ink;
    let edge = (bar.left - 0.25 * pen.unit).floor() as i64;
    for (y, position) in bar.rows(transfer) {
        let width = 1.2 * pen.unit * (transfer.opacity(position) / largest).clamp(0.0, 1.0);
        for n in 0..width.ceil() as i64 {
            let coverage = (width - n as f64).min(1.0);
            pen.canvas.blend(edge - n - 1, y, ink, 0.35 * coverage);
        }
    }
}

fn values(pen: &mut Pen, bar: &Bar, labels: &[(f64, String)]) {
    let unit = pen.unit;
    for (position, text) in labels {
        let (x, y) = (bar.right, bar.y(*position));
        pen.stroke([[x, y], [x + 0.35 * unit, y]], 1.0);
        pen.write(text, [x + 0.6 * unit, y - 0.55 * unit]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transfer::presets::color_map;

    fn texts(scale: Scale, range: [f64; 2], bands: Option<usize>) -> Vec<(f64, String)> {
        let transfer = TransferFunction {
            color: color_map("turbo").unwrap(),
            opacity: vec![(0.0, 0.1)],
            range,
            scale,
            bands,
            reference_length: 1.0,
        };
        marks(&transfer, 5, 10)
    }

    fn named(marks: &[(f64, String)]) -> Vec<(f64, &str)> {
        marks.iter().map(|m| (m.0, m.1.as_str())).collect()
    }

    #[test]
    fn linear_and_log_marks_are_round() {
        let linear = texts(Scale::Linear, [0.0, 10.0], None);
        assert_eq!(linear[1], (0.2, "2".into()));
        let log = texts(Scale::Log, [-1.0, 3.0], None);
        let log = named(&log);
        assert_eq!(log.len(), 5);
        assert_eq!(log[0], (0.0, "0.1"));
        assert!(log[4].1 == "1000" && (log[2].0 - 0.5).abs() < 1e-12);
        // Less than a decade: even values at uneven places.
        let narrow = texts(Scale::Log, [20f64.log10(), 80f64.log10()], None);
        assert_eq!(narrow[1].1, "40");
        assert!((narrow[1].0 - 0.5).abs() < 1e-9);
        // One value alone.
        assert_eq!(named(&texts(Scale::Log, [2.0, 2.0], None)), [(0.5, "100")]);
    }

    #[test]
    fn bands_have_their_limits() {
        let four = texts(Scale::Linear, [0.0, 1.0], Some(4));
        let four = named(&four);
        assert_eq!(four[1], (0.25, "0.25"));
        assert_eq!(four.len(), 5);
        let log = texts(Scale::Log, [0.0, 2.0], Some(2));
        assert_eq!(named(&log), [(0.0, "1.0"), (0.5, "10"), (1.0, "100")]);
        // As many as there is room for.
        assert_eq!(texts(Scale::Linear, [0.0, 1.0], Some(40)).len(), 9);
    }

    #[test]
    fn categories_are_named_in_the_middle_of_their_boxes() {
        let of = |values: &[f64]| {
            let end = values.len() as f64 - 0.5;
            texts(
                Scale::Categories(values.into()),
                [-0.5, end],
                Some(values.len()),
            )
        };
        assert_eq!(named(&of(&[1.0, 7.0])), [(0.25, "1"), (0.75, "7")]);
        let many: Vec<f64> = (0..25).map(f64::from).collect();
        assert_eq!(of(&many).len(), 9);
    }
}
