//! A line of a text with well paths: numbers, words, or a comment.

/// What a line is.
#[derive(Debug, PartialEq)]
pub(super) enum Line<'a> {
    Blank,
    /// Behind its mark.
    Comment(&'a str),
    /// Numbers alone.
    Numbers(Vec<f64>),
    /// A name, a head, or anything else.
    Words(&'a str),
    /// Numbers, among which there is a word.
    Damaged {
        word: &'a str,
        /// Its place, from 1.
        column: usize,
    },
}

/// Rows of at least so many numbers are no names of wells.
const ROW: usize = 3;

impl<'a> Line<'a> {
    pub(super) fn of(line: &'a str) -> Self {
        let line = line.trim();
        if line.is_empty() {
            return Self::Blank;
        }
        if is_comment(line) {
            return Self::Comment(line.trim_start_matches(['#', '-', ' ', '\t']).trim());
        }
        let has_decimal_commas = has_decimal_commas(line);
        let words: Vec<&str> = parts(line, has_decimal_commas).collect();
        let numbers: Vec<Option<f64>> = words
            .iter()
            .map(|word| number(word, has_decimal_commas))
            .collect();
        let known: Vec<f64> = numbers.iter().flatten().copied().collect();
        match numbers.iter().position(Option::is_none) {
            None if !known.is_empty() => Self::Numbers(known),
            Some(bad) if known.len() >= ROW => Self::Damaged {
                word: words[bad],
                column: bad + 1,
            },
            _ => Self::Words(line),
        }
    }
}

/// All lines with their numbers, from 1; they end with LF, CR LF or CR.
pub(super) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut rest = Some(text);
    let next = move || {
        let text = rest?;
        let end = text.find(['\n', '\r']);
        let (line, behind) = text.split_at(end.unwrap_or(text.len()));
        rest = behind
            .strip_prefix("\r\n")
            .or_else(|| behind.get(1..))
            .filter(|_| end.is_some());
        Some(line)
    };
    (1..).zip(std::iter::from_fn(next))
}

pub(super) fn is_comment(line: &str) -> bool {
    let line = line.trim_start();
    line.starts_with('#') || line.starts_with("--")
}

/// The columns of a line.
pub(super) fn parts(line: &str, has_decimal_commas: bool) -> impl Iterator<Item = &str> {
    let is_between =
        move |c: char| c.is_whitespace() || c == ';' || c == ',' && !has_decimal_commas;
    line.split(is_between).filter(|part| !part.is_empty())
}

/// True where commas stand for decimal points: beside semicolons, or inside of columns that blanks part.
pub(super) fn has_decimal_commas(line: &str) -> bool {
    if line.contains(';') {
        return true;
    }
    let columns: Vec<&str> = line.split_whitespace().collect();
    let is_whole = |column: &&str| {
        let inner = column.trim_matches(',');
        inner.len() == column.len() && column.matches(',').count() <= 1 && !column.contains('.')
    };
    columns.len() >= ROW && line.contains(',') && columns.iter().all(is_whole)
}

fn number(word: &str, has_decimal_commas: bool) -> Option<f64> {
    let first = word.trim_start_matches(['+', '-']).chars().next()?;
    if !first.is_ascii_digit() && first != '.' && first != ',' {
        return None;
    }
    let changed = word.contains(',') && has_decimal_commas || word.contains(['d', 'D']);
    let value: f64 = match changed {
        true => word
            .replace(',', ".")
            .replace(['d', 'D'], "e")
            .parse()
            .ok()?,
        false => word.parse().ok()?,
    };
    value.is_finite().then_some(value)
}

/// The name that a line of words gives a well: between quotes, behind `name`, or all of it.
pub(super) fn name(words: &str) -> &str {
    let quotes = ['\'', '"', '`', '´', '’', '‘'];
    if let (Some(first), Some(last)) = (words.find(quotes), words.rfind(quotes))
        && first < last
    {
        let inside = words.get(first..last).unwrap_or_default();
        let inside = inside.trim_start_matches(quotes).trim();
        if !inside.is_empty() {
            return inside;
        }
    }
    labeled_name(words).unwrap_or(words)
}

/// The name behind `WELLNAME:`, `Well name`, `name` or `WELL:`, in any letter case.
pub(super) fn labeled_name(words: &str) -> Option<&str> {
    let label = |label: &str| {
        let start = words.get(..label.len())?;
        let rest = words.get(label.len()..)?;
        start.eq_ignore_ascii_case(label).then_some(rest)
    };
    let named = ["WELLNAME", "WELL NAME", "WELL_NAME", "NAME"];
    let behind = named.iter().find_map(|l| label(l)).filter(|rest| {
        let next = rest.chars().next();
        next.is_some_and(|c| c == ':' || c == '=' || c.is_whitespace())
    });
    let behind = behind.or_else(|| label("WELL:"))?;
    let name = behind.trim_start_matches([':', '=', ' ', '\t']).trim();
    let name = name.trim_matches(['\'', '"', '`', '´', '’', '‘']).trim();
    (!name.is_empty()).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_numbers_words_or_comments() {
        let row = |values: &[f64]| Line::Numbers(values.to_vec());
        for (text, expected) in [
            ("1 2\t3", row(&[1.0, 2.0, 3.0])),
            ("1, 2, -3.5", row(&[1.0, 2.0, -3.5])),
            ("1,2,3", row(&[1.0, 2.0, 3.0])),
            ("1,5;2,5;3", row(&[1.5, 2.5, 3.0])),
            ("1,5 2,5 3,0", row(&[1.5, 2.5, 3.0])),
            ("-999", row(&[-999.0])),
            ("4.5D2 1e3 .5", row(&[450.0, 1000.0, 0.5])),
            ("  # a b", Line::Comment("a b")),
            ("-- x", Line::Comment("x")),
            ("3Q AHB-J", Line::Words("3Q AHB-J")),
            ("nan inf 1", Line::Words("nan inf 1")),
            (
                "1 2x 3 4",
                Line::Damaged {
                    word: "2x",
                    column: 2,
                },
            ),
            (" \t", Line::Blank),
        ] {
            assert_eq!(Line::of(text), expected, "{text}");
        }
        let all: Vec<_> = lines("a\r\nb\rc\n\nd").collect();
        assert_eq!(all, [(1, "a"), (2, "b"), (3, "c"), (4, ""), (5, "d")]);
    }

    #[test]
    fn names_stand_in_quotes_behind_name_or_alone() {
        for (words, expected) in [
            ("WELLNAME: A-1", "A-1"),
            ("wellname: 'A 1'", "A 1"),
            ("Name Well_2", "Well_2"),
            ("‘B’", "B"),
            ("WELL NAME:  C 3", "C 3"),
            ("Well: D", "D"),
            ("names", "names"),
            ("3Q AHB-J", "3Q AHB-J"),
            ("Well 7", "Well 7"),
        ] {
            assert_eq!(name(words), expected, "{words}");
        }
    }
}
