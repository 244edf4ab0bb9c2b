//! The line below a picture: what is drawn, in numbers and words.

use super::ticks::{short_label, shortened};
use crate::case::{Case, Measure, Weighting};
use crate::model::Space;
use crate::scene::StrategyKind;
use crate::transfer::Scale;
use crate::view::facts::Values;
use crate::view::{Facts, View};

/// Facts on what is drawn, from left to right.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Info {
    items: Vec<Item>,
}

/// A fact, in ways to say it, the longest first.
#[derive(Debug, Clone, PartialEq)]
struct Item {
    words: Vec<Words>,
    is_about_selection: bool,
}

/// A way to say a fact. Where room is lacking, what is worth least gives way to a shorter one, or to nothing.
#[derive(Debug, Clone, PartialEq)]
struct Words {
    text: String,
    worth: u8,
}

/// What the date is worth, and where no title has it.
const WHEN: u8 = 1;
const UNDATED: u8 = 20;

/// Between two facts.
const BETWEEN: &str = "  ·  ";

impl Info {
    /// Of a view of a case: `when` it was so, and its facts.
    pub fn of(case: &Case, view: &View, facts: &Facts, when: &str) -> Self {
        let mut items = Vec::new();
        if !when.is_empty() {
            items.push(Item::of([(WHEN, when.replace("   ", ", "))]));
        }
        items.push(cells(facts));
        if let Some(values) = &facts.values {
            let measure = case.measure(&view.shown.property, view.notes.units);
            let is_log = view.style.transfer.scale == Scale::Log;
            let heading = case.heading_of(&view.shown.property);
            items.push(said(
                &shown(values, &measure),
                &heading,
                &measure.unit,
                is_log,
            ));
        }
        let doubt = case
            .property(&view.shown.property)
            .ok()
            .and_then(|p| p.doubt.as_ref());
        if let Some(doubt) = doubt {
            items.push(Item::of([
                (12, doubt.clone()),
                (13, "not as in the deck".into()),
            ]));
        }
        if let Some(shown) = &view.shown.cube {
            let name = &shown.cube.name;
            items.push(Item::of([
                (10, format!("beside it {name}, not lit")),
                (11, format!("beside it {name}")),
            ]));
        }
        let factor = format!("{:.2}", view.world.vertical_exaggeration);
        let factor = shortened(&factor);
        let stretched = match view.world.space {
            Space::Map => format!("Z x {factor}"),
            Space::Ijk if factor == "1" => "IJK space".into(),
            Space::Ijk => format!("IJK space, K x {factor}"),
        };
        items.push(Item::of([(6, stretched)]));
        let selection = |long: String, short: &str| Item {
            is_about_selection: true,
            ..Item::of([(5, long), (8, short.to_owned())])
        };
        if !facts.filter.is_empty() {
            items.push(selection(format!("filter: {}", facts.filter), "filtered"));
        }
        match facts.planes {
            0 => {}
            1 => items.push(selection("cut by a plane".into(), "cut")),
            n => items.push(selection(format!("cut by {n} planes"), "cut")),
        }
        if view.sampling.strategy == StrategyKind::Srg {
            let words = [(2, "SRG: resampled"), (7, "SRG")];
            items.push(Item::of(
                words.map(|(worth, text)| (worth, text.to_owned())),
            ));
        }
        Self { items }
    }

    /// Facts that are said in one way; for tests.
    #[cfg(test)]
    pub fn of_items(texts: &[&str]) -> Self {
        let item = |text: &&str| Item::of([(9, (*text).to_owned())]);
        Self {
            items: texts.iter().map(item).collect(),
        }
    }

    /// True where there is more to say than of most pictures: about filters and cuts.
    pub fn is_long(&self) -> bool {
        self.items.iter().any(|i| i.is_about_selection)
    }

    /// All of it in one line.
    pub fn whole(&self) -> String {
        let words = self.items.iter().filter_map(|i| i.words.first());
        let texts: Vec<&str> = words.map(|w| w.text.as_str()).collect();
        texts.join(BETWEEN)
    }

    /// The lines that fit in a room, `most` at most: what is worth least becomes shorter and then goes. Where the
    /// date stands in a title too, it is worth the least; else the most.
    pub fn lines(
        &self,
        room: f64,
        most: usize,
        is_dated: bool,
        width: &dyn Fn(&str) -> f64,
    ) -> Vec<String> {
        let mut items = self.items.clone();
        loop {
            let words = items.iter().filter_map(|i| i.words.first());
            let texts: Vec<&str> = words.map(|w| w.text.as_str()).collect();
            let lines = wrapped(&texts, room, width);
            if lines.len() <= most && lines.iter().all(|l| width(l) <= room) {
                return lines;
            }
            let worth = |item: &&mut Item| match item.words[0].worth {
                WHEN if !is_dated => UNDATED,
                worth => worth,
            };
            let left = items.iter_mut().filter(|i| !i.words.is_empty());
            match left.min_by_key(worth) {
                Some(least) => {
                    least.words.remove(0);
                }
                None => return Vec::new(),
            }
        }
    }
}

impl Item {
    fn of<const N: usize>(words: [(u8, String); N]) -> Self {
        let words = words.map(|(worth, text)| Words { text, worth });
        Self {
            words: words.into(),
            is_about_selection: false,
        }
    }
}

/// Facts in as few lines as hold them, each whole.
fn wrapped(words: &[&str], room: f64, width: &dyn Fn(&str) -> f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in words {
        match lines.last_mut() {
            Some(line) if width(&format!("{line}{BETWEEN}{word}")) <= room => {
                line.push_str(BETWEEN);
                line.push_str(word);
            }
            _ => lines.push((*word).to_owned()),
        }
    }
    lines
}

fn cells(facts: &Facts) -> Item {
    let [drawn, active] = [facts.drawn, facts.active].map(with_commas);
    Item::of([
        (4, format!("{drawn} of {active} cells")),
        (9, format!("{drawn} cells")),
    ])
}

/// A value near zero, with three digits.
fn small(value: f64) -> String {
    match format!("{value:.2e}").parse::<f64>() {
        Ok(v) if v.abs() >= 1e-4 => v.to_string(),
        Ok(v) => format!("{v:e}"),
        Err(_) => value.to_string(),
    }
}

/// The values as they are written.
fn shown(values: &Values, measure: &Measure) -> Values {
    Values {
        min: measure.show(values.min),
        max: measure.show(values.max),
        mean: values
            .mean
            .map(|(mean, weights)| (measure.show(mean), weights)),
        ..*values
    }
}

/// What the values are like.
fn said(values: &Values, property: &str, unit: &str, is_log: bool) -> Item {
    let Values { min, max, .. } = *values;
    let number = |v: f64| {
        let text = readable(v, min.abs().max(max.abs()), max - min);
        match text.parse() {
            // On a log scale a small value is far from zero; elsewhere it is rounding.
            Ok(0.0) if is_log && v != 0.0 => small(v),
            _ => text,
        }
    };
    let unit = match unit.is_empty() {
        true => String::new(),
        false => format!(" {unit}"),
    };
    if min == max {
        let place = match values.are_all {
            true => "everywhere",
            false => "in all of them",
        };
        return Item::of([(11, format!("{property} is {}{unit} {place}", number(min)))]);
    }
    let range = format!("{} to {}{unit}", number(min), number(max));
    let Some((mean, weights)) = values.mean else {
        return Item::of([(10, format!("{property} {range}")), (11, range)]);
    };
    let (long, short) = match weights {
        Weighting::PoreVolume | Weighting::PorosityVolume => ("pore-volume-weighted mean", "mean"),
        Weighting::BulkVolume => ("volume-weighted mean", "mean by volume"),
    };
    let mean = number(mean);
    Item::of([
        (3, format!("{property} {range}, {long} {mean}")),
        (10, format!("{property} {range}, {short} {mean}")),
        (11, format!("{range}, {short} {mean}")),
    ])
}

/// A number with the digits that a range of values needs: a few thousandths of the range show.
fn readable(value: f64, largest: f64, range: f64) -> String {
    let step = if range > 0.0 {
        2e-3 * range
    } else {
        1e-3 * largest
    };
    short_label(value, largest, step)
}

/// A count with commas between thousands.
pub fn with_commas(count: usize) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (n, digit) in digits.chars().enumerate() {
        if n > 0 && (digits.len() - n).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    fn values(min: f64, max: f64, mean: Option<(f64, Weighting)>) -> Values {
        Values {
            min,
            max,
            mean,
            are_all: true,
        }
    }

    fn info() -> Info {
        let item = |words: &[(u8, &str)]| Item {
            words: words
                .iter()
                .map(|(worth, text)| Words {
                    text: (*text).to_owned(),
                    worth: *worth,
                })
                .collect(),
            is_about_selection: false,
        };
        Info {
            items: vec![
                item(&[(WHEN, "2001-01-01, report 12")]),
                item(&[(4, "12,204 of 35,817 cells"), (9, "12,204 cells")]),
                item(&[(3, "SOIL 0 to 0.8, mean 0.3"), (11, "0 to 0.8")]),
                item(&[(6, "Z x 5")]),
            ],
        }
    }

    /// Ten pixels a character.
    fn width(text: &str) -> f64 {
        10.0 * text.chars().count() as f64
    }

    #[test]
    fn facts_stand_in_one_line_where_there_is_room_and_in_two_where_there_is_not() {
        let one = info().lines(1000.0, 2, true, &width);
        assert_eq!(one, [info().whole()]);
        let two = info().lines(600.0, 2, true, &width);
        assert_eq!(two.len(), 2);
        assert_eq!(two.join(BETWEEN), one[0]);
    }

    #[test]
    fn what_counts_least_goes_first() {
        let in_one = |room, is_dated| info().lines(room, 1, is_dated, &width).join("");
        let text = in_one(600.0, true);
        let all = "12,204 of 35,817 cells  ·  SOIL 0 to 0.8, mean 0.3  ·  Z x 5";
        assert_eq!(text, all);
        let text = in_one(500.0, true);
        assert_eq!(text, "12,204 of 35,817 cells  ·  0 to 0.8  ·  Z x 5");
        let text = in_one(400.0, true);
        assert_eq!(text, "12,204 cells  ·  0 to 0.8  ·  Z x 5");
        assert_eq!(in_one(250.0, true), "12,204 cells  ·  0 to 0.8");
        assert_eq!(in_one(100.0, true), "0 to 0.8");
        assert_eq!(in_one(20.0, true), "");
        // A picture without a title keeps its date.
        assert_eq!(in_one(250.0, false), "2001-01-01, report 12");
    }

    #[test]
    fn lines_never_leave_their_room() {
        for room in (0..1200).step_by(7).map(f64::from) {
            for most in [1, 2] {
                let lines = info().lines(room, most, true, &width);
                assert!(lines.len() <= most && lines.iter().all(|l| width(l) <= room));
            }
        }
    }

    fn first(item: &Item) -> String {
        item.words[0].text.clone()
    }

    #[test]
    fn values_are_said_plainly() {
        let pores = values(0.0231, 0.8497, Some((0.412_34, Weighting::PoreVolume)));
        assert_eq!(
            first(&said(&pores, "SOIL", "", false)),
            "SOIL 0.023 to 0.85, pore-volume-weighted mean 0.412"
        );
        let bulk = values(200.0, 312.5, Some((250.0, Weighting::BulkVolume)));
        assert_eq!(
            first(&said(&bulk, "PRESSURE", "BARSA", false)),
            "PRESSURE 200 to 312.5 BARSA, volume-weighted mean 250"
        );
        let regions = values(1.0, 7.0, None);
        assert_eq!(first(&said(&regions, "FIPNUM", "", false)), "FIPNUM 1 to 7");
        let zero = values(0.0, 0.0, Some((0.0, Weighting::BulkVolume)));
        assert_eq!(
            first(&said(&zero, "SGAS", "", false)),
            "SGAS is 0 everywhere"
        );
        let some = Values {
            are_all: false,
            ..values(0.3, 0.3, None)
        };
        assert_eq!(
            first(&said(&some, "PORO", "", false)),
            "PORO is 0.3 in all of them"
        );
        // What is left of 1 minus a saturation is rounding; a small permeability is none.
        let saturation = values(-5.96e-8, 0.85, None);
        let said_of = |values, name, is_log| first(&said(values, name, "", is_log));
        assert_eq!(said_of(&saturation, "SOIL", false), "SOIL 0 to 0.85");
        let permeability = values(1e-4, 9904.0, None);
        assert_eq!(
            said_of(&permeability, "PERMX", true),
            "PERMX 0.0001 to 9904"
        );
    }

    #[test]
    fn counts_have_commas() {
        let texts = [0, 999, 1000, 12_204, 1_234_567].map(with_commas);
        assert_eq!(texts, ["0", "999", "1,000", "12,204", "1,234,567"]);
    }
}
