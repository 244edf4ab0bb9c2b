//! The line below a picture: what is drawn, in numbers and words.

use super::ticks::{short_label, shortened};
use crate::case::Case;
use crate::case::Weighting;
use crate::scene::facts::Values;
use crate::scene::{Facts, View};
use crate::strategies::StrategyKind;

/// Facts on what is drawn, from left to right.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Info {
    items: Vec<Item>,
}

/// A fact.
#[derive(Debug, Clone, PartialEq)]
struct Item {
    /// Ways to say it, the longest first.
    words: Vec<String>,
    /// Where room is lacking, what counts least becomes shorter first, and then goes.
    weight: Weight,
}

/// How much a fact counts, rising.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Weight {
    When,
    Exaggeration,
    Strategy,
    Filter,
    Cells,
    Values,
}

/// Between two facts.
const BETWEEN: &str = "  ·  ";

impl Info {
    /// Of a view of a case: `when` it was so, and its facts.
    pub fn of(case: &Case, view: &View, facts: &Facts, when: &str) -> Self {
        let item = |weight, words: Vec<String>| Item { words, weight };
        let mut items = Vec::new();
        if !when.is_empty() {
            items.push(item(Weight::When, vec![when.replace("   ", ", ")]));
        }
        items.push(item(Weight::Cells, cells(facts)));
        if let Some(values) = &facts.values {
            let unit = case.unit(&view.property);
            items.push(item(Weight::Values, said(values, &view.property, unit)));
        }
        let factor = format!("{:.2}", view.vertical_exaggeration);
        let factor = format!("Z x {}", shortened(&factor));
        items.push(item(Weight::Exaggeration, vec![factor]));
        if !facts.filter.is_empty() {
            let words = vec![format!("filter: {}", facts.filter), "filtered".into()];
            items.push(item(Weight::Filter, words));
        }
        match facts.planes {
            0 => {}
            1 => items.push(item(
                Weight::Filter,
                vec!["cut by a plane".into(), "cut".into()],
            )),
            n => items.push(item(
                Weight::Filter,
                vec![format!("cut by {n} planes"), "cut".into()],
            )),
        }
        if view.strategy == StrategyKind::Srg {
            let words = vec!["SRG: resampled".into(), "SRG".into()];
            items.push(item(Weight::Strategy, words));
        }
        Self { items }
    }

    /// Facts that are said in one way, the last one counting most; for tests.
    #[cfg(test)]
    pub fn of_items(texts: &[&str]) -> Self {
        let item = |text: &&str| Item {
            words: vec![(*text).to_owned()],
            weight: Weight::Values,
        };
        Self {
            items: texts.iter().map(item).collect(),
        }
    }

    /// True where there is more to say than of most pictures: about filters and cuts.
    pub fn is_long(&self) -> bool {
        self.items.iter().any(|i| i.weight == Weight::Filter)
    }

    /// All of it in one line.
    pub fn whole(&self) -> String {
        let items = self.items.iter().filter_map(|i| i.words.first());
        items.map(String::as_str).collect::<Vec<_>>().join(BETWEEN)
    }

    /// The lines that fit in a room, `most` at most: what counts least becomes shorter and then goes. Where the
    /// date stands in a title, it counts least of all; else most.
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
            let words: Vec<&str> = words.map(String::as_str).collect();
            let lines = wrapped(&words, room, width);
            if lines.len() <= most && lines.iter().all(|l| width(l) <= room) {
                return lines;
            }
            let rank = |item: &&mut Item| match item.weight {
                Weight::When if !is_dated => (1, item.weight),
                weight => (0, weight),
            };
            let left = items.iter_mut().filter(|i| !i.words.is_empty());
            match left.min_by_key(rank) {
                Some(least) => {
                    least.words.remove(0);
                }
                None => return Vec::new(),
            }
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

fn cells(facts: &Facts) -> Vec<String> {
    let [drawn, active] = [facts.drawn, facts.active].map(with_commas);
    vec![
        format!("{drawn} of {active} cells"),
        format!("{drawn} cells"),
    ]
}

/// What the values are like.
fn said(values: &Values, property: &str, unit: &str) -> Vec<String> {
    let Values { min, max, .. } = *values;
    let number = |v: f64| readable(v, min.abs().max(max.abs()), max - min);
    let unit = match unit.is_empty() {
        true => String::new(),
        false => format!(" {unit}"),
    };
    if min == max {
        let place = match values.are_all {
            true => "everywhere",
            false => "in all of them",
        };
        return vec![format!("{property} is {}{unit} {place}", number(min))];
    }
    let range = format!("{} to {}{unit}", number(min), number(max));
    let Some((mean, weights)) = values.mean else {
        return vec![format!("{property} {range}"), range];
    };
    let weighted = match weights {
        Weighting::PoreVolume | Weighting::PorosityVolume => "pore-volume-weighted",
        Weighting::BulkVolume => "volume-weighted",
    };
    let mean = number(mean);
    vec![
        format!("{property} {range}, {weighted} mean {mean}"),
        format!("{property} {range}, mean {mean}"),
        format!("{range}, mean {mean}"),
    ]
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
        let item = |weight, words: &[&str]| Item {
            words: words.iter().map(|w| (*w).to_owned()).collect(),
            weight,
        };
        Info {
            items: vec![
                item(Weight::When, &["2001-01-01, report 12"]),
                item(Weight::Cells, &["12,204 of 35,817 cells", "12,204 cells"]),
                item(Weight::Values, &["SOIL 0 to 0.8, mean 0.3", "0 to 0.8"]),
                item(Weight::Exaggeration, &["Z x 5"]),
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
        assert!(!text.contains("report") && text.contains("Z x 5"), "{text}");
        let text = in_one(400.0, true);
        assert_eq!(text, "12,204 cells  ·  SOIL 0 to 0.8, mean 0.3");
        assert_eq!(in_one(250.0, true), "SOIL 0 to 0.8, mean 0.3");
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

    #[test]
    fn values_are_said_plainly() {
        let pores = values(0.0231, 0.8497, Some((0.412_34, Weighting::PoreVolume)));
        assert_eq!(
            said(&pores, "SOIL", "")[0],
            "SOIL 0.023 to 0.85, pore-volume-weighted mean 0.412"
        );
        let bulk = values(200.0, 312.5, Some((250.0, Weighting::BulkVolume)));
        assert_eq!(
            said(&bulk, "PRESSURE", "BARSA")[0],
            "PRESSURE 200 to 312.5 BARSA, volume-weighted mean 250"
        );
        let regions = values(1.0, 7.0, None);
        assert_eq!(said(&regions, "FIPNUM", "")[0], "FIPNUM 1 to 7");
        let zero = values(0.0, 0.0, Some((0.0, Weighting::BulkVolume)));
        assert_eq!(said(&zero, "SGAS", "")[0], "SGAS is 0 everywhere");
        let some = Values {
            are_all: false,
            ..values(0.3, 0.3, None)
        };
        assert_eq!(said(&some, "PORO", "")[0], "PORO is 0.3 in all of them");
    }

    #[test]
    fn counts_have_commas() {
        let texts = [0, 999, 1000, 12_204, 1_234_567].map(with_commas);
        assert_eq!(texts, ["0", "999", "1,000", "12,204", "1,234,567"]);
    }
}
