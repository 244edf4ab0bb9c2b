//! The legend, laid out as rectangles, lines and texts for pictures and the window alike: a bar of the transfer
//! function's colors with its true ends, round values between and the opacity beside it, or a swatch for each
//! category.

use glam::DVec2;

use super::layout::{LINE, LegendWidths};
use super::orientation::{Area, Text};
use super::ticks::{label, labels, log_labels, short_label};
use crate::case::Measure;
use crate::image::srgb_8bit;
use crate::transfer::{Scale, TransferFunction};

/// A legend on a ground of its own.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Legend {
    /// What it stands on.
    pub ground: Area,
    /// Rectangles of one color.
    pub blocks: Vec<(Area, [u8; 3])>,
    /// Rows of the opacity curve, as long as the opacity is high.
    pub opacities: Vec<Area>,
    /// Frames and ticks.
    pub strokes: Vec<[DVec2; 2]>,
    /// Heading, labels and notes.
    pub texts: Vec<Text>,
}

/// How much ink there is in the ground of a legend.
pub const GROUND: f64 = 0.05;

/// What a legend is made from.
pub struct Key<'a> {
    /// Colors and opacities.
    pub transfer: &'a TransferFunction,
    /// Values lie below the range, and above.
    pub beyond: [bool; 2],
    /// Name of the property, and its unit, which may be empty.
    pub heading: [&'a str; 2],
    /// How the values are written.
    pub measure: &'a Measure,
    /// The opacity counts in the picture: a curve of it stands beside the bar.
    pub has_opacity: bool,
    /// Text height; the unit of every size here.
    pub unit: f64,
    /// Width of a text of this height.
    pub width: &'a dyn Fn(&str) -> f64,
}

/// Sizes in text heights: free around the ground, and within it; the bar and its opacities; a tick and the gap
/// behind it; the most that a heading widens a legend to; a row of categories and its swatch.
const OUTSIDE: f64 = 0.5;
const INSIDE: f64 = 0.6;
const BAR: f64 = 1.3;
const OPACITIES: f64 = 1.7;
const TICK: f64 = 0.3;
const GAP: f64 = 0.3;
const WIDEST_HEADING: f64 = 9.0;
const ROW: f64 = 1.35;
const SWATCH: f64 = 1.0;
/// Height of the bar at most; where less than the least is left, the heading gives way.
const HIGHEST: f64 = 24.0;
const LEAST: f64 = 6.0;
/// Parts of a text height between the middles of labels at least.
const APART: f64 = 1.3;
/// What is written below the opacities.
const OPACITY: &str = "opacity";

impl Key<'_> {
    /// Widths of the legend in a strip about so high.
    pub fn widths(&self, height: f64) -> LegendWidths {
        let unit = self.unit;
        let heading = self.heading_lines().into_iter().map(|l| self.text_width(l));
        let heading = heading.fold(0.0, f64::max);
        let content = |is_narrow: bool| match &self.transfer.scale {
            Scale::Categories(values) => {
                let rows = self.rows(height, is_narrow);
                let columns = if values.len() > rows && !is_narrow {
                    2.0
                } else {
                    1.0
                };
                let all = columns * self.column_width(values);
                match values.len() > rows * columns as usize && !is_narrow {
                    true => all.max(self.text_width(&format!("1 of {} shown", values.len()))),
                    false => all,
                }
            }
            _ => {
                let count = if is_narrow {
                    2
                } else {
                    self.most(HIGHEST * unit)
                };
                let labels = self.marks(WANTED, count);
                let widest = labels.iter().map(|l| self.text_width(&l.1));
                let opacities = if is_narrow { 0.0 } else { self.opacity_width() };
                opacities + (BAR + TICK + GAP) * unit + widest.fold(0.0, f64::max)
            }
        };
        let around = 2.0 * (OUTSIDE + INSIDE) * unit;
        // Whole text heights, so that the volume beside it seldom changes its size.
        let whole = |width: f64| ((width + around) / unit).ceil() * unit;
        LegendWidths {
            full: whole(content(false).max(heading)),
            narrow: whole(content(true)),
        }
    }

    /// Lays the legend out in a strip; a narrow one without heading and opacities.
    pub fn laid_out(&self, strip: Area, is_narrow: bool) -> Legend {
        let unit = self.unit;
        let [low, high] = [strip[0] + OUTSIDE * unit, strip[1] - OUTSIDE * unit];
        let (left, right) = (low.x + INSIDE * unit, high.x - INSIDE * unit);
        let room = high.y - low.y - 2.0 * INSIDE * unit;
        let mut heading = match is_narrow {
            true => Vec::new(),
            false => self.heading_lines(),
        };
        if room - LINE * unit * heading.len() as f64 <= LEAST * unit {
            heading.clear();
        }
        let head =
            LINE * unit * heading.len() as f64 + if heading.is_empty() { 0.0 } else { 0.3 * unit };
        let mut legend = Legend::default();
        let body = [
            DVec2::new(left, low.y + INSIDE * unit + head),
            DVec2::new(right, high.y - INSIDE * unit),
        ];
        let height = match &self.transfer.scale {
            Scale::Categories(values) => self.categories(&mut legend, values, body, is_narrow),
            _ => self.bar(&mut legend, body, is_narrow),
        };
        let mut top = body[0].y - head;
        for line in heading {
            let text = self.cut(line, right - left);
            legend.write(&text, [left, top + 0.5 * LINE * unit], self);
            top += LINE * unit;
        }
        let bottom = (body[0].y + height + INSIDE * unit).min(high.y);
        legend.ground = [low, DVec2::new(high.x, bottom)];
        // In the middle of the strip.
        legend.shifted(DVec2::Y * (0.5 * (high.y - bottom)).round())
    }

    /// The bar with all that belongs to it; the height that it takes.
    fn bar(&self, legend: &mut Legend, body: Area, is_narrow: bool) -> f64 {
        let unit = self.unit;
        let beside = if is_narrow { 0.0 } else { self.opacity_width() };
        let caption = if beside > 0.0 { LINE * unit } else { 0.0 };
        let left = (body[0].x + beside).round();
        let right = (left + BAR * unit).round();
        let top = (body[0].y + 0.5 * unit).round();
        let height = (body[1].y - top - 0.5 * unit - caption).min(HIGHEST * unit);
        let height = height.max(unit).round();
        let bottom = top + height;
        let [low, high] = self.transfer.range;
        for n in 0..height as u32 {
            let y = top + f64::from(n);
            // Every value of an empty range has the color at 0.
            let position = match high > low {
                true => 1.0 - (f64::from(n) + 0.5) / height,
                false => 0.0,
            };
            let row = |from: f64, to: f64| [DVec2::new(from, y), DVec2::new(to, y + 1.0)];
            let color = srgb_8bit(self.transfer.srgb(position));
            legend.blocks.push((row(left, right), color));
            if beside > 0.0 {
                let part = self.transfer.opacity(position) / self.largest_opacity();
                let reach = (beside - 0.3 * unit) * part.clamp(0.0, 1.0);
                let edge = left - 0.3 * unit;
                legend.opacities.push(row(edge - reach, edge));
            }
        }
        legend.frame([DVec2::new(left, top), DVec2::new(right, bottom)]);
        let most = if is_narrow { 2 } else { self.most(height) };
        let wanted = ((height / (2.4 * unit)) as usize).clamp(2, WANTED);
        let mut taken: Vec<f64> = Vec::new();
        let mut labels = self.marks(wanted, most);
        // Where there is no room for all, the ends of the range go first.
        labels.sort_by(|a, b| (b.0 - 0.5).abs().total_cmp(&(a.0 - 0.5).abs()));
        for (position, text) in labels {
            let y = bottom - height * position;
            if taken.iter().any(|other| (y - other).abs() < unit) {
                continue;
            }
            taken.push(y);
            let tick = right + TICK * unit;
            legend
                .strokes
                .push([DVec2::new(right, y), DVec2::new(tick, y)]);
            let room = body[1].x - tick - GAP * unit;
            // Labels are rounded up to whole text heights in the strip's width, and so always fit.
            legend.write(&self.cut(&text, room + unit), [tick + GAP * unit, y], self);
        }
        if beside > 0.0 {
            let text = self.cut(OPACITY, body[1].x - body[0].x);
            legend.write(
                &text,
                [body[0].x, bottom + 0.5 * unit + 0.5 * caption],
                self,
            );
        }
        height + unit + caption
    }

    /// What stands beside the bar, the ends marked where their colors stand for values beyond them too.
    fn marks(&self, wanted: usize, most: usize) -> Vec<(f64, String)> {
        let mut marks = marks(self.transfer, self.measure, wanted, most);
        let mark =
            |(_, text): &mut (f64, String), sign: char| text.insert_str(0, &format!("{sign} "));
        if let ([true, _], Some(first)) = (self.beyond, marks.first_mut()) {
            mark(first, '≤');
        }
        if let ([_, true], Some(last)) = (self.beyond, marks.last_mut()) {
            mark(last, '≥');
        }
        marks
    }

    /// Swatches with their numbers, from the top; the height that they take.
    fn categories(&self, legend: &mut Legend, values: &[f64], body: Area, is_narrow: bool) -> f64 {
        let unit = self.unit;
        let height = body[1].y - body[0].y;
        let rows = ((height / (ROW * unit)) as usize).max(1);
        let column_width = self.column_width(values);
        let has_two = !is_narrow && body[1].x - body[0].x >= 2.0 * column_width - 0.5 * unit;
        let columns = if values.len() > rows && has_two { 2 } else { 1 };
        // The note on those left out takes a row.
        let (rows, every) = match values.len() <= rows * columns {
            true => (rows, 1),
            false => {
                let rows = rows.saturating_sub(1).max(1);
                (rows, values.len().div_ceil(rows * columns))
            }
        };
        let shown: Vec<usize> = (0..values.len()).step_by(every).collect();
        let rows = rows.min(shown.len().div_ceil(columns));
        for (place, n) in shown.iter().enumerate() {
            let (column, row) = (place / rows.max(1), place % rows.max(1));
            let at =
                body[0] + DVec2::new(column as f64 * column_width, row as f64 * ROW * unit).round();
            let inset = (0.5 * (ROW - SWATCH) * unit).round();
            let low = (at + DVec2::Y * inset).round();
            let swatch = [low, low + (SWATCH * unit).round()];
            let position = (*n as f64 + 0.5) / values.len() as f64;
            let color = srgb_8bit(self.transfer.srgb(position));
            legend.blocks.push((swatch, color));
            legend.frame(swatch);
            let middle = [swatch[1].x + 0.4 * unit, 0.5 * (swatch[0].y + swatch[1].y)];
            legend.write(&values[*n].to_string(), middle, self);
        }
        let taken = ROW * unit * rows as f64;
        if every == 1 {
            return taken;
        }
        let note = self.cut(&format!("1 of {every} shown"), body[1].x - body[0].x);
        legend.write(
            &note,
            [body[0].x, body[0].y + taken + 0.5 * ROW * unit],
            self,
        );
        taken + ROW * unit
    }

    /// Name and unit, a long difference in two lines.
    fn heading_lines(&self) -> Vec<&str> {
        let [name, unit] = self.heading;
        let is_long = self.text_width(name) > WIDEST_HEADING * self.unit;
        let lines = match name.split_at_checked(name.find('-').map_or(0, |n| n + 1)) {
            Some((first, second)) if is_long => [first, second, unit],
            _ => [name, "", unit],
        };
        lines.into_iter().filter(|l| !l.is_empty()).collect()
    }

    /// Rows of categories in a strip about so high.
    fn rows(&self, height: f64, is_narrow: bool) -> usize {
        let head = if is_narrow {
            0.0
        } else {
            LINE * self.heading_lines().len() as f64 + 0.3
        };
        let taken = (2.0 * (OUTSIDE + INSIDE) + head) * self.unit;
        ((height - taken) / (ROW * self.unit)).max(1.0) as usize
    }

    fn column_width(&self, values: &[f64]) -> f64 {
        let widest = values.iter().map(|v| self.text_width(&v.to_string()));
        (SWATCH + 0.9) * self.unit + widest.fold(0.0, f64::max)
    }

    /// Labels that a bar of a height has room for.
    fn most(&self, height: f64) -> usize {
        (height / (APART * self.unit)) as usize
    }

    fn largest_opacity(&self) -> f64 {
        let opacity = self.transfer.opacity.iter();
        opacity.fold(0.0, |most: f64, o| most.max(o.1))
    }

    /// Width of the opacities; 0 where they do not count or are the same everywhere, which a curve would not show.
    fn opacity_width(&self) -> f64 {
        let opacities = self.transfer.opacity.iter().map(|o| o.1);
        let least = opacities.fold(f64::INFINITY, f64::min);
        let largest = self.largest_opacity();
        match self.has_opacity && largest > least && largest.is_finite() {
            true => OPACITIES * self.unit,
            false => 0.0,
        }
    }

    fn text_width(&self, text: &str) -> f64 {
        (self.width)(text)
    }

    /// The text, cut with an ellipsis where it would be wider than `room`.
    fn cut(&self, text: &str, room: f64) -> String {
        cut(text, room, self.width)
    }
}

/// The text, cut with an ellipsis where it would be wider than `room`.
pub fn cut(text: &str, room: f64, width: &dyn Fn(&str) -> f64) -> String {
    if width(text) <= room {
        return text.to_owned();
    }
    let fits = |end: &usize| width(&text[..*end]) + width("…") <= room;
    let ends = text.char_indices().map(|(n, _)| n);
    let end = ends.take_while(fits).last().unwrap_or(0);
    text[..end].trim_end().to_owned() + "…"
}

impl Legend {
    fn frame(&mut self, [low, high]: Area) {
        let corners = [
            low,
            DVec2::new(high.x, low.y),
            high,
            DVec2::new(low.x, high.y),
            low,
        ];
        let sides = corners.windows(2).map(|side| [side[0], side[1]]);
        self.strokes.extend(sides);
    }

    /// Writes a text from the middle of its left end.
    fn write(&mut self, text: &str, [left, y]: [f64; 2], key: &Key<'_>) {
        self.texts.push(Text {
            text: text.to_owned(),
            middle: DVec2::new(left + 0.5 * key.text_width(text), y),
            height: key.unit,
        });
    }

    fn shifted(mut self, by: DVec2) -> Self {
        let shift = |area: &mut Area| area.iter_mut().for_each(|p| *p += by);
        shift(&mut self.ground);
        self.blocks.iter_mut().for_each(|(area, _)| shift(area));
        self.opacities.iter_mut().for_each(shift);
        self.strokes.iter_mut().for_each(shift);
        self.texts.iter_mut().for_each(|text| text.middle += by);
        self
    }
}

/// Round values between the ends of a bar, about.
const WANTED: usize = 7;

/// What stands beside a legend's bar: positions from 0 at the low end to 1, rising, each with its label.
///
/// The true ends, and between them about `wanted` round values; where the bar has parts of one color, the limits
/// of the bands, or every category in its middle. Of them each so many that at most `most` are left. Values are
/// written, and round, as a measure says.
fn marks(
    transfer: &TransferFunction,
    measure: &Measure,
    wanted: usize,
    most: usize,
) -> Vec<(f64, String)> {
    let [low, high] = transfer.range;
    let placed = |(value, text): (f64, String)| {
        let kept = transfer.scale.shown(measure.read(value), low);
        (transfer.position(kept), text)
    };
    let range = transfer.true_range().map(|end| measure.show(end));
    let round = match (&transfer.scale, transfer.bands) {
        (Scale::Categories(values), _) => {
            let every = values.len().div_ceil(most.max(1)).max(1);
            let count = values.len() as f64;
            let middle = |(n, v): (usize, &f64)| ((n as f64 + 0.5) / count, v.to_string());
            let all = values.iter().enumerate();
            return all.step_by(every).map(middle).collect();
        }
        (_, Some(bands)) => return limits(transfer, measure, bands, most),
        (Scale::Log, None) if high > low => log_labels(range, wanted),
        _ if high > low => labels(range, wanted),
        // An empty range is shown in its middle.
        _ => {
            let one = labels([measure.show(transfer.scale.true_value(low)); 2], 1).into_iter();
            return one.map(|(_, text)| (0.5, text)).collect();
        }
    };
    let [first, last] = ends(&transfer.scale, range);
    let apart = 1.0 / most.max(1) as f64;
    let is_between = |mark: &(f64, String)| mark.0 >= apart && mark.0 <= 1.0 - apart;
    let between = round.into_iter().map(placed).filter(is_between);
    [(0.0, first)]
        .into_iter()
        .chain(between)
        .chain([(1.0, last)])
        .collect()
}

/// The true ends of the range, with the digits that the range needs.
fn ends(scale: &Scale, range: [f64; 2]) -> [String; 2] {
    let largest = range[0].abs().max(range[1].abs());
    range.map(|value| match scale {
        Scale::Log => short_label(value, value, 5e-3 * value),
        _ => short_label(value, largest, 2e-3 * (range[1] - range[0])),
    })
}

/// The ends of the bands.
fn limits(
    transfer: &TransferFunction,
    measure: &Measure,
    bands: usize,
    most: usize,
) -> Vec<(f64, String)> {
    let [low, high] = transfer.range;
    let every = (bands + 1).div_ceil(most.max(2)).max(1);
    let at = |n: usize| n as f64 / bands as f64;
    let value = |n: usize| measure.show(transfer.scale.true_value(low + (high - low) * at(n)));
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
    let inner = (0..bands).step_by(every);
    let apart = inner.filter(|n| bands - n >= every);
    let shown = apart.chain([bands]);
    shown.map(|n| (at(n), text(n))).collect()
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
        marks(&transfer, &Measure::default(), 5, 10)
    }

    fn named(marks: &[(f64, String)]) -> Vec<(f64, &str)> {
        marks.iter().map(|m| (m.0, m.1.as_str())).collect()
    }

    #[test]
    fn marks_are_round_in_the_units_shown() {
        let transfer = TransferFunction {
            color: color_map("turbo").unwrap(),
            opacity: vec![(0.0, 0.1)],
            range: [0.0, 100.0],
            scale: Scale::Linear,
            bands: None,
            reference_length: 1.0,
        };
        // Celsius in Fahrenheit.
        let measure = crate::case::Units::FIELD.of_unit("C", "TEMP");
        let found = marks(&transfer, &measure, 5, 10);
        let [first, .., last] = &found[..] else {
            panic!("{found:?}")
        };
        assert_eq!((first.1.as_str(), last.1.as_str()), ("32", "212"));
        let middle = found.iter().find(|mark| mark.1 == "100").unwrap();
        assert!((middle.0 - 68.0 / 180.0).abs() < 1e-9);
        assert!(
            marks(&transfer, &Measure::default(), 5, 10)
                .iter()
                .all(|m| m.1 != "212")
        );
        let logarithmic = TransferFunction {
            range: [1.0, 3.0],
            scale: Scale::Log,
            ..transfer
        };
        let measure = crate::case::Units::FIELD.of_unit("BARSA", "PRESSURE");
        let found = marks(&logarithmic, &measure, 5, 10);
        let thousand = found.iter().find(|mark| mark.1 == "1000").unwrap();
        let expected = ((1000.0 / 14.503_773_773_f64).log10() - 1.0) / 2.0;
        assert!((thousand.0 - expected).abs() < 1e-9, "{found:?}");
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
    fn ends_are_the_true_ones_in_plain_numbers() {
        for (scale, range, expected) in [
            (Scale::Linear, [0.0231, 0.8497], ["0.023", "0.85"]),
            (Scale::Linear, [298.551, 364.902], ["298.6", "364.9"]),
            (Scale::Linear, [-1e-9, 0.744], ["0", "0.744"]),
            (Scale::Linear, [0.0, 1_234_000.0], ["0", "1.234e6"]),
            (
                Scale::Log,
                [0.0316f64.log10(), 3162.0f64.log10()],
                ["0.0316", "3162"],
            ),
        ] {
            let marks = texts(scale, range, None);
            let (first, last) = (&marks[0], &marks[marks.len() - 1]);
            assert_eq!((first.0, last.0), (0.0, 1.0));
            assert_eq!([&first.1, &last.1], expected);
            // Others keep away from them and from each other.
            assert!(
                marks.windows(2).all(|pair| pair[1].0 - pair[0].0 > 0.09),
                "{marks:?}"
            );
            assert!(marks.len() > 3);
        }
    }

    fn function(scale: Scale, range: [f64; 2], opacity: Vec<(f64, f64)>) -> TransferFunction {
        TransferFunction {
            color: color_map("turbo").unwrap(),
            opacity,
            range,
            scale,
            bands: None,
            reference_length: 1.0,
        }
    }

    fn regions(count: usize) -> TransferFunction {
        let values: Vec<f64> = (1..=count).map(|n| n as f64).collect();
        let end = count as f64 - 0.5;
        function(
            Scale::Categories(values.into()),
            [-0.5, end],
            vec![(0.0, 0.1)],
        )
    }

    fn width(text: &str) -> f64 {
        6.0 * text.chars().count() as f64
    }

    /// A legend in a strip as wide as it asks for.
    fn laid_out(transfer: &TransferFunction, height: f64, is_narrow: bool) -> (Area, Legend) {
        let key = Key {
            transfer,
            beyond: [false, true],
            heading: ["PRESSURE-PRESSURE@0", "BARSA"],
            measure: &Measure::default(),
            has_opacity: true,
            unit: 12.0,
            width: &width,
        };
        let widths = key.widths(height);
        assert!(widths.narrow <= widths.full);
        let wide = if is_narrow {
            widths.narrow
        } else {
            widths.full
        };
        let strip = [
            DVec2::new(500.0, 20.0),
            DVec2::new(500.0 + wide, 20.0 + height),
        ];
        (strip, key.laid_out(strip, is_narrow))
    }

    fn text_area(text: &Text) -> Area {
        let half = 0.5 * DVec2::new(width(&text.text), text.height);
        [text.middle - half, text.middle + half]
    }

    #[test]
    fn everything_lies_on_the_ground_in_the_strip_and_texts_lie_apart() {
        let ramp = || vec![(0.0, 0.0), (1.0, 0.6)];
        for transfer in [
            function(Scale::Linear, [0.0, 1.0], ramp()),
            function(Scale::Linear, [-123.456, 98_765.4], ramp()),
            function(Scale::Linear, [0.3, 0.3], ramp()),
            function(Scale::Log, [-3.0, 4.0], vec![(0.0, 0.2)]),
            regions(3),
            regions(25),
            regions(400),
        ] {
            for height in [60.0, 110.0, 180.0, 300.0, 900.0] {
                for is_narrow in [false, true] {
                    let (strip, legend) = laid_out(&transfer, height, is_narrow);
                    let within = |[low, high]: Area, [a, b]: Area| {
                        low.cmpge(a - 0.01).all() && high.cmple(b + 0.01).all()
                    };
                    assert!(within(legend.ground, strip), "{height} {is_narrow}");
                    for (area, _) in &legend.blocks {
                        assert!(within(*area, legend.ground), "{height} {is_narrow}");
                    }
                    for area in &legend.opacities {
                        assert!(within(*area, legend.ground));
                    }
                    let areas: Vec<Area> = legend.texts.iter().map(text_area).collect();
                    for (n, area) in areas.iter().enumerate() {
                        assert!(
                            within(*area, strip),
                            "{height} {is_narrow} {:?}",
                            legend.texts[n]
                        );
                        for (m, other) in areas.iter().enumerate().skip(n + 1) {
                            let apart = area[1].cmple(other[0]) | other[1].cmple(area[0]);
                            assert!(apart.any(), "{:?} {:?}", legend.texts[n], legend.texts[m]);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn opacities_stand_beside_the_bar_and_constant_ones_are_left_out() {
        let ramp = function(Scale::Linear, [0.0, 1.0], vec![(0.0, 0.0), (1.0, 0.6)]);
        let (_, legend) = laid_out(&ramp, 400.0, false);
        let lengths: Vec<f64> = legend.opacities.iter().map(|[a, b]| b.x - a.x).collect();
        assert!(lengths.is_sorted_by(|a, b| a >= b) && lengths[0] > 10.0);
        let bar = &legend.blocks[0].0;
        assert!(legend.opacities.iter().all(|[_, high]| high.x < bar[0].x));
        let flat = function(Scale::Linear, [0.0, 1.0], vec![(0.0, 0.6), (1.0, 0.6)]);
        let (_, without) = laid_out(&flat, 400.0, false);
        assert!(without.opacities.is_empty());
        assert!(!without.texts.iter().any(|t| t.text == OPACITY));
    }

    #[test]
    fn categories_have_two_columns_before_any_is_left_out() {
        let numbers = |count: usize| {
            let (_, legend) = laid_out(&regions(count), 300.0, false);
            let columns: std::collections::BTreeSet<i64> = legend
                .blocks
                .iter()
                .map(|(area, _)| area[0].x as i64)
                .collect();
            let texts = legend.texts.iter().map(|t| t.text.clone());
            (
                legend.blocks.len(),
                columns.len(),
                texts.collect::<Vec<_>>(),
            )
        };
        let (shown, columns, texts) = numbers(6);
        assert!(shown == 6 && columns == 1 && !texts.iter().any(|t| t.contains("shown")));
        let (shown, columns, texts) = numbers(20);
        assert!(shown == 20 && columns == 2 && !texts.iter().any(|t| t.contains("shown")));
        assert!((1..=20).all(|n| texts.contains(&n.to_string())));
        let (shown, columns, texts) = numbers(60);
        assert!(shown < 30 && columns == 2, "{shown}");
        let every = 60usize.div_ceil(shown);
        assert!(texts.contains(&format!("1 of {every} shown")), "{texts:?}");
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
