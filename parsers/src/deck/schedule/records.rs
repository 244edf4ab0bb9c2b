//! The records of keywords about wells and time.

use super::super::header::real;
use super::super::lexer::{Item, Mistake, shown};
use super::What;
use crate::calendar::days_from;
use crate::error::ErrorKind;
use crate::wells::{Direction, Kind, Status, Target};

/// Most layers that a record connects a well to, of which a grid has fewer.
const MOST_LAYERS: i32 = 1_000_000;

/// The text of an item; `None` where it is left to its default.
pub(super) fn text(items: &[Item], at: usize) -> Option<String> {
    let text = items.get(at)?.text?;
    let text = String::from_utf8_lossy(text).trim().to_owned();
    (!text.is_empty()).then_some(text)
}

/// A whole number, 0 where it is left to its default. Some write `5.0`.
fn whole(items: &[Item], at: usize) -> Result<i32, Mistake> {
    let Some(item) = items.get(at).filter(|item| item.text.is_some()) else {
        return Ok(0);
    };
    let value = real(item)?;
    let number = value as i32;
    match f64::from(number) == value {
        true => Ok(number),
        false => {
            let found = shown(item.text.unwrap_or_default());
            let message = format!("expected a whole number, found '{found}'");
            Err(Mistake::new(ErrorKind::BadValue, item.at, message))
        }
    }
}

/// WELSPECS (`first` is 2), and WELSPECL (3), where the name of a local grid stands before I and J.
pub(super) fn head(items: &[Item], first: usize) -> Result<What, Mistake> {
    let depth = items.get(first + 2).filter(|item| item.text.is_some());
    Ok(What::Head {
        grid: (first > 2).then(|| text(items, 2)).flatten(),
        group: text(items, 1),
        head: [whole(items, first)?, whole(items, first + 1)?],
        depth: depth.map(real).transpose()?.map(|depth| depth as f32),
    })
}

/// COMPDAT (`first` is 1), and COMPDATL (2), where the name of a local grid stands before I and J.
pub(super) fn connect(items: &[Item], first: usize) -> Result<What, Mistake> {
    let at = items.first().map_or(0, |item| item.at);
    let layers = [whole(items, first + 2)?, whole(items, first + 3)?];
    // One of them is enough.
    let layers = match layers {
        [k, 0] => [k, k],
        [0, k] => [k, k],
        both => both,
    };
    if layers[0] < 1 || layers[1] < layers[0] || layers[1] > MOST_LAYERS {
        let message = format!(
            "expected the first and the last layer (K1, K2), found {} and {}",
            layers[0], layers[1]
        );
        return Err(Mistake::new(ErrorKind::BadValue, at, message));
    }
    let direction = text(items, first + 11).unwrap_or_default();
    Ok(What::Connect {
        grid: (first > 1).then(|| text(items, 1)).flatten(),
        column: [whole(items, first)?, whole(items, first + 1)?],
        layers,
        is_open: is_open(text(items, first + 4)),
        direction: match direction.to_ascii_uppercase().as_str() {
            "X" | "FX" => Direction::X,
            "Y" | "FY" => Direction::Y,
            _ => Direction::Z,
        },
    })
}

/// OPEN and AUTO, and what is left to its default.
fn is_open(word: Option<String>) -> bool {
    word.is_none_or(|word| !word.eq_ignore_ascii_case("SHUT"))
}

fn status(word: Option<String>) -> Status {
    match word.unwrap_or_default().to_ascii_uppercase().as_str() {
        "SHUT" => Status::Shut,
        "STOP" => Status::Stopped,
        _ => Status::Open,
    }
}

/// WCONPROD and WCONHIST.
pub(super) fn producer(name: &str, items: &[Item]) -> What {
    let names: &[&str] = match name {
        "WCONHIST" => &["ORAT", "WRAT", "GRAT", "", "", "THP", "BHP"],
        _ => &["ORAT", "WRAT", "GRAT", "LRAT", "RESV", "BHP", "THP"],
    };
    What::Control {
        kind: Kind::Producer,
        status: status(text(items, 1)),
        targets: targets(names, items, 3),
    }
}

/// WCONINJE, WCONINJH and WCONINJ.
pub(super) fn injector(name: &str, items: &[Item]) -> What {
    let kind = text(items, 1).unwrap_or_default().to_ascii_uppercase();
    let kind = match kind.as_str() {
        "GAS" => Kind::GasInjector,
        "OIL" => Kind::OilInjector,
        "WATER" | "WAT" => Kind::WaterInjector,
        _ => Kind::Undefined,
    };
    let (names, first): (&[&str], usize) = match name {
        "WCONINJH" => (&["RATE", "BHP", "THP"], 3),
        "WCONINJE" => (&["RATE", "RESV", "BHP", "THP"], 4),
        _ => (&[], 0),
    };
    What::Control {
        kind,
        status: status(text(items, 2)),
        targets: targets(names, items, first),
    }
}

/// WELTARG: what of a well is asked otherwise from now on.
pub(super) fn target(items: &[Item]) -> Option<What> {
    let asked = text(items, 1)?.to_ascii_uppercase();
    let name = TARGETS.into_iter().find(|name| **name == *asked)?;
    let value = items.get(2).and_then(number)?;
    Some(What::Target(Target { name, value }))
}

/// Names of what is asked of wells.
const TARGETS: [&str; 8] = ["ORAT", "WRAT", "GRAT", "LRAT", "RESV", "BHP", "THP", "RATE"];

/// What items from one on ask for, by name; those that are left to their default ask for nothing.
fn targets(names: &[&str], items: &[Item], first: usize) -> Vec<Target> {
    let items = items.get(first..).unwrap_or_default().iter();
    let all = names.iter().zip(items).filter_map(|(name, item)| {
        let name = TARGETS.into_iter().find(|known| known == name)?;
        let value = number(item)?;
        Some(Target { name, value })
    });
    all.collect()
}

/// A number; `None` of what is left to its default, and of the name of a quantity that a run computes (UDQ), which is
/// told where that is defined.
fn number(item: &Item) -> Option<f64> {
    item.text.and_then(|_| real(item).ok())
}

/// WELOPEN: of the well, or of connections where one of them is named.
pub(super) fn open(items: &[Item]) -> Result<What, Mistake> {
    let is_whole = items.iter().skip(2).all(|item| item.text.is_none());
    if is_whole {
        return Ok(What::Status(status(text(items, 1))));
    }
    Ok(What::Connections {
        cell: [whole(items, 2)?, whole(items, 3)?, whole(items, 4)?],
        is_open: is_open(text(items, 1)),
    })
}

/// True where WELOPEN names completions by their numbers.
pub(super) fn is_by_number(items: &[Item]) -> bool {
    items.iter().skip(5).any(|item| item.text.is_some())
}

/// Names of months, of which one has two.
const MONTHS: [&str; 13] = [
    "JAN", "FEB", "MAR", "APR", "MAY", "JUN", "JUL", "AUG", "SEP", "OCT", "NOV", "DEC", "JLY",
];

/// Day, month, year and perhaps time of day, in days since 1970.
pub(super) fn date(items: &[Item]) -> Result<f64, Mistake> {
    let at = items.first().map_or(0, |item| item.at);
    let (day, year) = (whole(items, 0)?, whole(items, 2)?);
    let month = text(items, 1).unwrap_or_default().to_ascii_uppercase();
    let month = MONTHS
        .iter()
        .position(|m| month.get(..3).is_some_and(|start| start == *m));
    let (Some(month), 1..=31, 1..=9999) = (month, day, year) else {
        let message = "expected a date like 1 JAN 2020";
        return Err(Mistake::new(ErrorKind::BadValue, at, message));
    };
    let month = if month == 12 { 7 } else { month as i64 + 1 };
    let clock = text(items, 3).unwrap_or_default();
    let parts = clock.split(':').map(|n| n.trim().parse().unwrap_or(0.0));
    let seconds: f64 = parts.zip([3600.0, 60.0, 1.0]).map(|(n, s)| n * s).sum();
    let seconds = if seconds.is_finite() { seconds } else { 0.0 };
    let days = days_from([i64::from(year), month, i64::from(day)]);
    Ok(days as f64 + seconds / 86_400.0)
}

/// The sum of the lengths of steps.
pub(super) fn steps(items: &[Item]) -> Result<f64, Mistake> {
    let mut sum = 0.0;
    for item in items.iter().filter(|item| item.text.is_some()) {
        sum += real(item)?;
    }
    Ok(sum)
}

/// True where a name of a well is meant by one that ends in `*`, or has `?` for a letter, in any letter case.
pub(super) fn is_meant(pattern: &str, name: &str) -> bool {
    let fits = |pattern: &str, name: &str| {
        let mut letters = pattern.chars().zip(name.chars());
        letters.all(|(p, n)| p == '?' || p.eq_ignore_ascii_case(&n))
    };
    let length = name.chars().count();
    match pattern.split_once('*') {
        None => pattern.chars().count() == length && fits(pattern, name),
        Some((start, end)) => {
            let (first, last) = (start.chars().count(), end.chars().count());
            let behind: String = name.chars().skip(length.saturating_sub(last)).collect();
            first + last <= length && fits(start, name) && fits(end, &behind)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::is_meant;

    #[test]
    fn patterns_mean_names() {
        for (pattern, meant, other) in [
            ("P1", "p1", "P10"),
            ("P*", "P10", "OP"),
            ("P?", "P1", "P10"),
            ("*1", "OP1", "OP12"),
            ("O*1", "OP_1", "O2"),
        ] {
            assert!(is_meant(pattern, meant), "{pattern} {meant}");
            assert!(!is_meant(pattern, other), "{pattern} {other}");
        }
    }
}
