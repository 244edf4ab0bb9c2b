//! Rows, columns or layers by number.

use serde::{Deserialize, Serialize};

/// Numbers from 1 along an axis, written back in the form in which they were given.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "filter: i, j and k must each be [first, last] or a list such as \"2,4-6,10-30:2\""
)]
pub enum Indices {
    /// From the first to the last, both kept.
    Range([usize; 2]),
    /// Numbers and ranges, each range with a step where it has a colon: `2,4-6,10-30:2`.
    List(String),
}

/// What is right, for people.
const FORM: &str = "write numbers and ranges such as 2,4-6,10-30:2";

impl From<[usize; 2]> for Indices {
    fn from(ends: [usize; 2]) -> Self {
        Self::Range(ends)
    }
}

impl Indices {
    /// What a user typed for an axis of `count`: a plain range as such, else the list as it is; `None` where
    /// it keeps everything or is empty.
    ///
    /// # Errors
    /// When it is not understood or does not fit; the sentence says what is right.
    pub fn typed(text: &str, count: usize) -> Result<Option<Self>, String> {
        let text = text.trim();
        if text.is_empty() {
            return Ok(None);
        }
        let list = Self::List(text.to_owned());
        let parts = list.parts()?;
        let flags = list.flags(count)?;
        Ok(match parts[..] {
            _ if !flags.contains(&false) => None,
            [[first, last, 1]] => Some(Self::Range([first, last])),
            _ => Some(list),
        })
    }

    /// As people write it: `3`, `1-46`, `2,4-6,10-30:2`.
    pub fn text(&self) -> String {
        match self {
            Self::Range([first, last]) if first == last => first.to_string(),
            Self::Range([first, last]) => format!("{first}-{last}"),
            Self::List(text) => text.split_whitespace().collect(),
        }
    }

    /// Which of `count` are kept, by zero-based index.
    ///
    /// # Errors
    /// When a number is not from 1 to `count`, or the text is not understood; the sentence says what is
    /// right.
    pub fn flags(&self, count: usize) -> Result<Vec<bool>, String> {
        let mut flags = vec![false; count];
        for [first, last, step] in self.parts()? {
            if first < 1 || last > count {
                let what = Self::Range([first, last]).text();
                return Err(format!("{what} does not lie within 1 to {count}"));
            }
            for n in (first..=last).step_by(step) {
                flags[n - 1] = true;
            }
        }
        Ok(flags)
    }

    /// The first and the last that are kept; `None` where the text is not understood.
    pub fn ends(&self) -> Option<[usize; 2]> {
        let parts = self.parts().ok()?;
        let first = parts.iter().map(|p| p[0]).min()?;
        let lasts = parts
            .iter()
            .map(|[first, last, step]| last - (last - first) % step);
        Some([first, lasts.max()?])
    }

    /// First, last and step of each part; the first is never larger than the last, and the step at least 1.
    fn parts(&self) -> Result<Vec<[usize; 3]>, String> {
        let parts: Vec<[usize; 3]> = match self {
            Self::Range([first, last]) => vec![[*first, *last, 1]],
            Self::List(text) => text.split(',').map(part).collect::<Result<_, _>>()?,
        };
        match parts.iter().find(|[first, last, _]| first > last) {
            Some([first, last, _]) => Err(format!(
                "{first}-{last} runs backward; write {last}-{first}"
            )),
            None => Ok(parts),
        }
    }
}

fn part(text: &str) -> Result<[usize; 3], String> {
    let text = text.trim();
    let number = |text: &str| {
        let number = text.trim().parse::<usize>();
        number.map_err(|_| format!("\"{text}\" is not a number; {FORM}"))
    };
    if text.is_empty() {
        return Err(format!("a number is missing; {FORM}"));
    }
    let (range, step) = match text.split_once(':') {
        Some((range, step)) => (range, number(step)?),
        None => (text, 1),
    };
    if step == 0 {
        return Err(format!("the step in {text} must be at least 1"));
    }
    let (first, last) = range.split_once('-').unwrap_or((range, range));
    Ok([number(first)?, number(last)?, step])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(indices: &Indices, count: usize) -> Vec<usize> {
        let flags = indices.flags(count).unwrap();
        (1..=count).filter(|n| flags[n - 1]).collect()
    }

    #[test]
    fn lists_keep_what_they_say() {
        let list = Indices::List("2,4-6,10-30:2".into());
        let even = (10..=30).step_by(2);
        assert_eq!(
            kept(&list, 40),
            [2, 4, 5, 6].into_iter().chain(even).collect::<Vec<_>>()
        );
        assert_eq!(list.ends(), Some([2, 30]));
        assert_eq!(kept(&Indices::List(" 3 - 4 ,1 ".into()), 4), [1, 3, 4]);
        assert_eq!(kept(&Indices::Range([2, 3]), 4), [2, 3]);
        assert_eq!(Indices::List("1-6:4".into()).ends(), Some([1, 5]));
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, word) in [
            ("", "missing"),
            ("1,,2", "missing"),
            ("4-x", "\"x\" is not a number"),
            ("-3", "2,4-6,10-30:2"),
            ("6-4", "write 4-6"),
            ("1-8:0", "at least 1"),
            ("0", "1 to 9"),
            ("4-10", "4-10 does not lie within 1 to 9"),
            ("99999999999999999999999", "not a number"),
        ] {
            let said = Indices::List(text.into()).flags(9).unwrap_err();
            assert!(said.contains(word), "{text}: {said}");
        }
        assert!(Indices::Range([3, 2]).flags(9).is_err());
        assert!(Indices::Range([0, 2]).flags(9).is_err());
    }

    #[test]
    fn what_is_typed_takes_the_simplest_form() {
        let typed = |text| Indices::typed(text, 9);
        assert_eq!(typed("4-6"), Ok(Some(Indices::Range([4, 6]))));
        assert_eq!(typed(" 5 "), Ok(Some(Indices::Range([5, 5]))));
        assert_eq!(typed("1-9"), Ok(None));
        assert_eq!(typed("1-4,5-9"), Ok(None));
        assert_eq!(typed(""), Ok(None));
        assert_eq!(typed("1,3"), Ok(Some(Indices::List("1,3".into()))));
        assert!(typed("10").is_err());
    }
}
