//! Line plots of figures over views or steps.

use super::pen::Pen;
use super::ticks::{labels, log_labels};
use crate::image::{Rgb8, srgb_8bit};

/// A named line of a plot.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Series {
    /// Name in the key.
    pub name: String,
    /// x and y of its points in order; the line is broken where one cannot be drawn.
    pub points: Vec<[f64; 2]>,
}

/// A line plot.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Plot {
    /// Line at the top.
    pub title: String,
    /// Under the x axis.
    pub x_label: String,
    /// Over the y axis.
    pub y_label: String,
    /// Whether the y axis is logarithmic.
    pub log_y: bool,
    /// The lines; colors repeat after ten.
    pub series: Vec<Series>,
}

/// From values to pixels.
struct Axis {
    log: bool,
    /// Least and largest value drawn.
    data: [f64; 2],
    /// Values at the ends, a little beyond the data.
    range: [f64; 2],
    /// Pixels at the ends.
    ends: [f64; 2],
    ticks: Vec<(f64, String)>,
}

impl Axis {
    /// An axis without place and ticks.
    fn over(values: impl Iterator<Item = f64>, log: bool) -> Self {
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let data = values.fold(none, |[low, high], v| [low.min(v), high.max(v)]);
        let data = if data == none { [1.0, 10.0] } else { data };
        let [low, high] = data.map(|v| if log { v.log10() } else { v });
        let room = match high - low {
            span if span > 0.0 => 0.04 * span,
            _ if log || low == 0.0 => 0.5,
            _ => 0.1 * low.abs(),
        };
        let range = [low - room, high + room].map(|v| if log { 10f64.powf(v) } else { v });
        Self {
            log,
            data,
            range,
            ends: [0.0; 2],
            ticks: Vec::new(),
        }
    }

    fn at(&self, value: f64) -> f64 {
        let scaled = |v: f64| if self.log { v.log10() } else { v };
        let [low, high] = self.range.map(scaled);
        self.ends[0] + (self.ends[1] - self.ends[0]) * (scaled(value) - low) / (high - low)
    }

    fn length(&self) -> f64 {
        (self.ends[1] - self.ends[0]).abs()
    }
}

impl Plot {
    /// Draws the plot on white; a picture too small for it stays empty.
    ///
    /// Left out are points that are not finite, such as the PSNR of equal pictures, and on a
    /// logarithmic axis those not above 0.
    pub fn draw(&self, size: [u32; 2]) -> Rgb8 {
        let white = [1.0; 3];
        let mut picture = Rgb8::filled(size, srgb_8bit(white));
        let mut pen = Pen::new(picture.canvas(), white, Pen::unit_of(size));
        let [x, y] = self.axes(&pen);
        if x.ends[0] < x.ends[1] && y.ends[1] < y.ends[0] {
            pen.title(&self.title);
            draw_axes(&mut pen, &x, &y);
            self.draw_axis_labels(&mut pen, &x, &y);
            for (n, series) in self.series.iter().enumerate() {
                self.draw_line(&mut pen, [&x, &y], color(n), &series.points);
                draw_name(&mut pen, [&x, &y], n, &series.name);
            }
        }
        picture
    }

    fn can_draw(&self, [x, y]: [f64; 2]) -> bool {
        x.is_finite() && y.is_finite() && (y > 0.0 || !self.log_y)
    }

    /// The axes with room around them for title, labels and names.
    fn axes(&self, pen: &Pen) -> [Axis; 2] {
        let unit = pen.unit;
        let [width, height] = pen.canvas.size.map(f64::from);
        let points = self.series.iter().flat_map(|s| s.points.iter().copied());
        let drawn: Vec<[f64; 2]> = points.filter(|p| self.can_draw(*p)).collect();
        let mut y = Axis::over(drawn.iter().map(|p| p[1]), self.log_y);
        y.ends = [height - 3.6 * unit, 4.4 * unit].map(f64::round);
        let wanted = (y.length() / (2.5 * unit)).clamp(2.0, 8.0) as usize;
        y.ticks = match self.log_y {
            true => log_labels(y.range, wanted),
            false => labels(y.range, wanted),
        };

        let mut x = Axis::over(drawn.iter().map(|p| p[0]), false);
        let left = 1.8 * unit + widest(pen, y.ticks.iter().map(|t| &t.1));
        let names = match widest(pen, self.series.iter().map(|s| &s.name)) {
            0.0 => 0.0,
            widest => (widest + 2.6 * unit).min(0.35 * width),
        };
        x.ends = [left, width - names - 1.5 * unit].map(f64::round);
        let mut wanted = (x.length() / (5.0 * unit)).clamp(2.0, 10.0);
        if drawn.iter().all(|p| p[0].fract() == 0.0) {
            // What is counted has no ticks in between.
            wanted = wanted.min(x.data[1] - x.data[0]);
        }
        x.ticks = labels(x.data, wanted as usize);
        [x, y]
    }

    fn draw_axis_labels(&self, pen: &mut Pen, x: &Axis, y: &Axis) {
        let unit = pen.unit;
        let room = f64::from(pen.canvas.size[0]) - 2.0 * unit;
        let label = pen.canvas.cut(&self.y_label, unit, room);
        pen.write(&label, [unit, y.ends[1] - 1.7 * unit]);
        let label = pen.canvas.cut(&self.x_label, unit, room);
        let middle = 0.5 * (x.ends[0] + x.ends[1] - pen.canvas.text_width(&label, unit));
        pen.write(&label, [middle.max(unit), y.ends[0] + 1.9 * unit]);
    }

    fn draw_line(&self, pen: &mut Pen, [x, y]: [&Axis; 2], color: [u8; 3], points: &[[f64; 2]]) {
        let at = |p: &[f64; 2]| self.can_draw(*p).then(|| [x.at(p[0]), y.at(p[1])]);
        let points: Vec<Option<[f64; 2]>> = points.iter().map(at).collect();
        let width = line_width(pen);
        for ends in points.windows(2) {
            if let [Some(a), Some(b)] = *ends {
                pen.canvas.line([a, b], [width; 2], color, |_, _| 1.0);
            }
        }
        // Points too close to be told apart are as wide as the line, which shows lonely ones still.
        let crowded = points.len() as f64 * pen.unit > x.length();
        let dot = if crowded { width } else { 3.0 * width };
        for point in points.into_iter().flatten() {
            pen.canvas.line([point; 2], [dot; 2], color, |_, _| 1.0);
        }
    }
}

fn color(series: usize) -> [u8; 3] {
    let color = colorous::TABLEAU10[series % colorous::TABLEAU10.len()];
    [color.r, color.g, color.b]
}

fn line_width(pen: &Pen) -> f64 {
    2.0 * pen.thin
}

fn widest<'a>(pen: &Pen, texts: impl Iterator<Item = &'a String>) -> f64 {
    let width = |text: &String| pen.canvas.text_width(text, pen.unit);
    texts.map(width).fold(0.0, f64::max)
}

/// Draws both axes with their ticks and faint lines across.
fn draw_axes(pen: &mut Pen, x: &Axis, y: &Axis) {
    let unit = pen.unit;
    let ([left, right], [bottom, top]) = (x.ends, y.ends);
    for (value, text) in &x.ticks {
        let (at, width) = (x.at(*value), pen.canvas.text_width(text, unit));
        pen.stroke([[at, bottom], [at, top]], 0.12);
        pen.stroke([[at, bottom], [at, bottom + 0.35 * unit]], 1.0);
        pen.write(text, [at - 0.5 * width, bottom + 0.5 * unit]);
    }
    for (value, text) in &y.ticks {
        let (at, width) = (y.at(*value), pen.canvas.text_width(text, unit));
        pen.stroke([[left, at], [right, at]], 0.12);
        pen.stroke([[left - 0.35 * unit, at], [left, at]], 1.0);
        pen.write(text, [left - 0.6 * unit - width, at - 0.55 * unit]);
    }
    pen.stroke([[left, top], [left, bottom]], 0.8);
    pen.stroke([[left, bottom], [right, bottom]], 0.8);
}

/// Draws the name of a series with a piece of its line right of the plot, where there is room.
fn draw_name(pen: &mut Pen, [x, y]: [&Axis; 2], series: usize, name: &str) {
    let (unit, left) = (pen.unit, x.ends[1] + 0.8 * pen.unit);
    let middle = y.ends[1] + (0.6 + 1.4 * series as f64) * unit;
    if name.is_empty() || middle + 0.6 * unit > y.ends[0] {
        return;
    }
    let widths = [line_width(pen); 2];
    let piece = [[left, middle], [left + 1.4 * unit, middle]];
    pen.canvas.line(piece, widths, color(series), |_, _| 1.0);
    let text = left + 1.9 * unit;
    let room = f64::from(pen.canvas.size[0]) - text - 0.2 * unit;
    let name = pen.canvas.cut(name, unit, room);
    pen.write(&name, [text, middle - 0.55 * unit]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(points: &[[f64; 2]]) -> Plot {
        Plot {
            title: "Quality over the views".into(),
            x_label: "view".into(),
            y_label: "PSNR [dB]".into(),
            log_y: false,
            series: vec![Series {
                name: String::new(),
                points: points.to_vec(),
            }],
        }
    }

    /// Columns and rows of the pixels that have exactly the color of a series.
    fn seen(picture: &Rgb8, series: usize) -> Vec<[usize; 2]> {
        let width = picture.size[0] as usize;
        (0..picture.pixels.len())
            .filter(|&p| picture.pixels[p] == color(series))
            .map(|p| [p % width, p / width])
            .collect()
    }

    #[test]
    fn ok_line_goes_where_the_values_are() {
        let picture = plot(&[[0.0, 10.0], [1.0, 30.0], [2.0, 10.0]]).draw([400, 300]);
        let pixels = seen(&picture, 0);
        let highest = pixels.iter().min_by_key(|p| p[1]).unwrap();
        let lowest = pixels.iter().max_by_key(|p| p[1]).unwrap();
        let left = pixels.iter().map(|p| p[0]).min().unwrap();
        let right = pixels.iter().map(|p| p[0]).max().unwrap();
        // The peak is in the middle, the feet at the ends.
        assert!(highest[0].abs_diff((left + right) / 2) <= 3, "{highest:?}");
        assert!(lowest[0] - left < 5 || right - lowest[0] < 5, "{lowest:?}");
        assert!(lowest[1] - highest[1] > 100);
    }

    #[test]
    fn ok_axes_map_linearly_and_by_logarithm() {
        let axis = |values: [f64; 2], log| Axis {
            ends: [0.0, 108.0],
            ..Axis::over(values.into_iter(), log)
        };
        let linear = axis([1.0, 100.0], false);
        let log = axis([1.0, 100.0], true);
        for (axis, value, expected) in [
            (&linear, 1.0, 4.0),
            (&linear, 50.5, 54.0),
            (&log, 1.0, 4.0),
            (&log, 10.0, 54.0),
            (&log, 100.0, 104.0),
        ] {
            assert!(
                (axis.at(value) - expected).abs() < 1e-9,
                "{value} {expected}"
            );
        }
        assert!((linear.at(10.0) - 54.0).abs() > 10.0);
        // One value lies in the middle.
        for (value, log) in [(5.0, false), (0.0, false), (-3e9, false), (1e-7, true)] {
            let at = axis([value; 2], log).at(value);
            assert!((at - 54.0).abs() < 1e-6, "{value} {at}");
        }
    }

    #[test]
    fn ok_whole_numbers_have_no_ticks_between() {
        let ticks = |points: &[[f64; 2]]| -> Vec<String> {
            let mut picture = Rgb8::filled([900, 300], [255; 3]);
            let pen = Pen::new(picture.canvas(), [1.0; 3], 11.0);
            let [x, _] = plot(points).axes(&pen);
            x.ticks.into_iter().map(|t| t.1).collect()
        };
        assert_eq!(ticks(&[[0.0, 1.0], [3.0, 1.0]]), ["0", "1", "2", "3"]);
        assert_eq!(ticks(&[[7.0, 1.0]]), ["7"]);
        let between = ticks(&[[0.0, 1.0], [0.5, 1.0], [3.0, 1.0]]);
        assert!(between.contains(&"0.5".to_owned()), "{between:?}");
    }

    #[test]
    fn ok_points_that_cannot_be_drawn_break_the_line() {
        let points = |middle: f64| [[0.0, 10.0], [1.0, 10.0], [2.0, middle], [3.0, 10.0]];
        let columns = |plot: Plot| {
            let mut columns: Vec<usize> = seen(&plot.draw([400, 300]), 0)
                .iter()
                .map(|p| p[0])
                .collect();
            columns.sort_unstable();
            columns.dedup();
            columns.windows(2).map(|c| c[1] - c[0]).max().unwrap()
        };
        assert_eq!(columns(plot(&points(10.0))), 1);
        for odd in [f64::INFINITY, f64::NAN] {
            assert!(columns(plot(&points(odd))) > 50, "{odd}");
        }
        let log = |middle| Plot {
            log_y: true,
            ..plot(&points(middle))
        };
        assert!(columns(log(0.0)) > 50 && columns(log(10.0)) == 1);
    }

    #[test]
    fn ok_every_size_and_odd_values_are_drawn_without_panic() {
        let long = "REEK \u{0} é 漢字 ".repeat(200);
        let odd = [
            0.0,
            -1.0,
            1e308,
            -1e308,
            5e-324,
            f64::NAN,
            f64::NEG_INFINITY,
        ];
        let points: Vec<[f64; 2]> = odd.iter().flat_map(|&x| odd.map(|y| [x, y])).collect();
        for size in [[0, 0], [1, 1], [30, 3000], [3000, 30], [200, 150]] {
            for log_y in [false, true] {
                for points in [&points[..], &points[..1], &[]] {
                    let series = Series {
                        name: long.clone(),
                        points: points.to_vec(),
                    };
                    let plot = Plot {
                        title: long.clone(),
                        x_label: long.clone(),
                        y_label: long.clone(),
                        log_y,
                        series: vec![series; 30],
                    };
                    plot.draw(size);
                }
            }
        }
        // Empty where too small, else not.
        let is_empty = |size| {
            plot(&[[0.0, 1.0]])
                .draw(size)
                .pixels
                .iter()
                .all(|p| *p == [255; 3])
        };
        assert!(is_empty([40, 40]) && !is_empty([200, 150]));
    }

    #[test]
    fn ok_series_differ_in_color_and_have_their_names() {
        let mut two = plot(&[[0.0, 1.0], [1.0, 2.0]]);
        two.series.push(Series {
            name: String::new(),
            points: vec![[0.0, 2.0], [1.0, 1.0]],
        });
        let [unnamed, plts, libc] = ["", "plts", "libc"].map(|name| {
            two.series[1].name = name.into();
            two.draw([400, 300])
        });
        let rightmost = |picture, series| seen(picture, series).iter().map(|p| p[0]).max();
        assert!(rightmost(&unnamed, 0).is_some() && rightmost(&unnamed, 1) > Some(370));
        // The name and a piece of its line take room from the plot.
        assert!(rightmost(&plts, 0) < Some(350) && rightmost(&plts, 1) > Some(350));
        assert_ne!(plts, libc);
    }
}
