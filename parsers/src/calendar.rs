//! Dates as simulators write them, and the days between them.

/// Days since 1970-01-01 of a date of the Gregorian calendar: year, month and day.
pub fn days_from([year, month, day]: [i64; 3]) -> i64 {
    // A year that begins in March has the odd day at its end.
    let (year, month) = if month > 2 {
        (year, month - 3)
    } else {
        (year - 1, month + 9)
    };
    let era = year.div_euclid(400);
    let of_era = year.rem_euclid(400);
    let of_year = (153 * month + 2) / 5 + day - 1;
    146_097 * era + 365 * of_era + of_era / 4 - of_era / 100 + of_year - 719_468
}

/// The time that `YYYY-MM-DD`, `YYYY-MM-DD hh:mm` or `YYYY-MM-DD hh:mm:ss` names, in days since 1970; `None` for
/// any other text.
pub fn moment(text: &str) -> Option<f64> {
    let numbers = |text: &str, between: char| -> Option<Vec<i64>> {
        let parts = text.split(between);
        parts.map(|p| p.parse().ok().filter(|n| *n >= 0)).collect()
    };
    let (date, clock) = text.trim().split_once(' ').unwrap_or((text.trim(), "0"));
    let date: [i64; 3] = numbers(date, '-')?.try_into().ok()?;
    let clock = numbers(clock.trim(), ':')?;
    let is_date = date[0] < 10_000 && (1..=12).contains(&date[1]) && (1..=31).contains(&date[2]);
    let most = [24, 60, 60];
    let is_clock = clock.len() <= 3 && clock.iter().zip(most).all(|(n, most)| *n < most);
    let seconds = clock.iter().zip([3600, 60, 1]).map(|(n, each)| n * each);
    (is_date && is_clock).then(|| days_from(date) as f64 + seconds.sum::<i64>() as f64 / 86_400.0)
}

/// The date so many days after 1970-01-01: year, month and day.
pub fn date_of(days: i64) -> [i64; 3] {
    // Back from the number of a day as `days_from` counts it, with years that begin in March.
    let days = days + 719_468;
    let (era, of_era) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    [400 * era + year + i64::from(month <= 2), month, day]
}

/// The time so many days after 1970-01-01, to the minute: `YYYY-MM-DD`, or `YYYY-MM-DD hh:mm` where it is not midnight.
///
/// Empty beyond the year 9999.
pub fn text(moment: f64) -> String {
    let minutes = (moment * 1440.0).round();
    if !minutes.is_finite() || minutes.abs() > 5e9 {
        return String::new();
    }
    let minutes = minutes as i64;
    let (day, minute) = (minutes.div_euclid(1440), minutes.rem_euclid(1440));
    let [year, month, day] = date_of(day);
    match minute {
        _ if !(0..10_000).contains(&year) => String::new(),
        0 => format!("{year:04}-{month:02}-{day:02}"),
        _ => format!(
            "{year:04}-{month:02}-{day:02} {:02}:{:02}",
            minute / 60,
            minute % 60
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_the_inverse_of_moment() {
        for day in (-700_000..2_900_000).step_by(97) {
            let day = f64::from(day);
            assert_eq!(moment(&text(day)), Some(day), "{}", text(day));
        }
        for date in [
            "2000-02-29",
            "2100-03-01",
            "1999-12-31 23:59",
            "1969-07-20 20:17",
        ] {
            assert_eq!(text(moment(date).unwrap()), date);
        }
        assert_eq!(text(1.0 - 1e-5), "1970-01-02");
        for wild in [f64::NAN, f64::INFINITY, 1e300, 3e6] {
            assert_eq!(text(wild), "");
        }
    }

    #[test]
    fn days_between_dates() {
        assert_eq!(moment("1970-01-01"), Some(0.0));
        let between = |a: &str, b: &str| {
            let days = moment(b).unwrap() - moment(a).unwrap();
            (86_400.0 * days).round()
        };
        assert_eq!(between("2020-01-01", "2020-03-01"), 60.0 * 86_400.0);
        assert_eq!(between("2100-01-01", "2100-03-01"), 59.0 * 86_400.0);
        assert_eq!(between("1999-12-31", "2000-01-01"), 86_400.0);
        assert_eq!(between("2025-01-01", "2025-01-01 06:30"), 6.5 * 3600.0);
        assert_eq!(between("2025-01-01 00:00:30", "2025-01-02"), 86_370.0);
        for text in [
            "",
            "last",
            "12",
            "2025-13-01",
            "2025-01-01 25:00",
            "2025-1",
            "2025-01-01 1:2:3:4",
        ] {
            assert_eq!(moment(text), None, "{text}");
        }
    }
}
