//! Dates on the axis of curves, whose positions are days since the start of the run.

use crate::case::{Step, date_of, days_from};

/// The calendar of a run: which date is how many days after the start.
#[derive(Debug, Clone, Copy)]
pub struct Calendar {
    /// Days from 1970-01-01 to the start.
    start: f64,
}

impl Calendar {
    /// That of a run with these steps; `None` where they have no dates.
    pub fn of(steps: &[Step]) -> Option<Self> {
        let first = steps.first()?;
        Some(Self {
            start: days_of(&first.date)? - first.days,
        })
    }

    /// That of a run which starts so many days after 1970-01-01.
    pub fn since(start: f64) -> Self {
        Self { start }
    }

    /// Days from 1970-01-01 to the start.
    pub fn start(self) -> f64 {
        self.start
    }

    /// The date so many days after the start.
    pub fn date(self, days: f64) -> String {
        let [year, month, day] = date_of((self.start + days).floor() as i64);
        format!("{year}-{month:02}-{day:02}")
    }

    /// The first days of months (1: of each, 12: of January only, 60: of each fifth January) within a range,
    /// in days after the start.
    pub fn months(self, [low, high]: [f64; 2], every: i64) -> Vec<f64> {
        let [year, month, _] = date_of((self.start + low).floor() as i64);
        let mut at = (12 * year + month - 1).div_euclid(every) * every;
        let mut found = Vec::new();
        loop {
            let day = days_from([at.div_euclid(12), at.rem_euclid(12) + 1, 1]) as f64 - self.start;
            if day > high || found.len() > 1000 {
                return found;
            }
            if day >= low {
                found.push(day);
            }
            at += every;
        }
    }
}

/// Days from 1970-01-01 to a date such as `2001-06-30`, whatever follows it.
fn days_of(date: &str) -> Option<f64> {
    let mut parts = date.get(..10)?.split('-').map(str::parse::<i64>);
    let mut next = || parts.next()?.ok();
    let date = [next()?, next()?, next()?];
    let is_date = (1..=12).contains(&date[1]) && (1..=31).contains(&date[2]);
    is_date.then(|| days_from(date) as f64)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    fn step(date: &str, days: f64) -> Step {
        Step {
            report: 0,
            date: date.into(),
            days,
        }
    }

    #[test]
    fn days_and_dates_go_both_ways() {
        for (date, days) in [
            ([1970, 1, 1], 0),
            ([2000, 2, 29], 11_016),
            ([2000, 3, 1], 11_017),
            ([1900, 3, 1], -25_508),
            ([2100, 1, 1], 47_482),
        ] {
            assert_eq!((days_from(date), date_of(days)), (days, date));
        }
        for days in -800_000..800_000 {
            assert_eq!(days_from(date_of(days)), days);
        }
    }

    #[test]
    fn a_run_tells_dates_and_where_months_begin() {
        let steps = [step("2001-12-30 06:00", 29.0), step("2003-01-01", 396.0)];
        let calendar = Calendar::of(&steps).unwrap();
        assert_eq!(calendar.date(0.0), "2001-12-01");
        assert_eq!(calendar.date(31.9), "2002-01-01");
        assert_eq!(calendar.months([1.0, 70.0], 1), [31.0, 62.0]);
        assert_eq!(calendar.months([0.0, 800.0], 12), [31.0, 396.0, 761.0]);
        assert!(Calendar::of(&[step("day 3", 0.0)]).is_none());
        assert!(Calendar::of(&[]).is_none());
    }
}
