//! The legend: a bar of the transfer function's colors with round values and the opacity curve.

use glam::DVec2;

use super::orientation::Area;
use super::pen::Pen;
use super::srgb_8bit;
use super::ticks::labels;
use crate::transfer::TransferFunction;

/// Where the bar is, in pixels.
struct Bar {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Bar {
    /// Height of a value; the middle where the range is empty.
    fn y(&self, transfer: &TransferFunction, value: f64) -> f64 {
        let [low, high] = transfer.range;
        let position = if high > low {
            transfer.position(value)
        } else {
            0.5
        };
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
    let height = (0.5 * h).min(20.0 * unit);
    let wanted = (height / (2.2 * unit)).clamp(2.0, 7.0) as usize;
    let labels = labels(transfer.range, wanted);
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
    values(pen, &bar, transfer, &labels);
    covered.map(DVec2::from_array)
}

fn colors(pen: &mut Pen, bar: &Bar, transfer: &TransferFunction) {
    for (y, position) in bar.rows(transfer) {
        let color = srgb_8bit(transfer.srgb(position));
        for x in bar.left as i64..bar.right as i64 {
            pen.canvas.blend(x, y, color, 1.0);
        }
    }
    pen.frame([bar.left, bar.top], [bar.right, bar.bottom], 0.8);
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

fn values(pen: &mut Pen, bar: &Bar, transfer: &TransferFunction, labels: &[(f64, String)]) {
    let unit = pen.unit;
    for (value, text) in labels {
        let (x, y) = (bar.right, bar.y(transfer, *value));
        pen.stroke([[x, y], [x + 0.35 * unit, y]], 1.0);
        pen.write(text, [x + 0.6 * unit, y - 0.55 * unit]);
    }
}
