//! Which column is which, where a line names them.

use super::Vertical;
use super::line::{has_decimal_commas, parts};

/// Places of columns, from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Columns {
    pub(super) x: usize,
    pub(super) y: usize,
    pub(super) z: usize,
    pub(super) measured: Option<usize>,
    /// What the name of `z` says of it.
    pub(super) vertical: Option<Vertical>,
    /// How many columns are named.
    pub(super) count: usize,
}

const X: &[&str] = &["X", "EASTING", "EAST", "XCOORD", "UTMX", "XUTME"];
const Y: &[&str] = &["Y", "NORTHING", "NORTH", "YCOORD", "UTMY", "YUTMN"];
/// Below the sea. `TVD` and `DEPTH` may count from a drill floor, and are taken where there is nothing better.
const DEPTH: &[&str] = &["TVDSS", "SSTVD", "TVDMSL", "TVDSUBSEA", "ZTVDSS"];
const ELEVATION: &[&str] = &["ELEVATION", "ELEV"];
const FROM_FLOOR: &[&str] = &["TVD", "DEPTH"];
const MEASURED: &[&str] = &["MD", "MDEPTH", "MEASUREDDEPTH"];
const ANGLES: &[&str] = &["INC", "INCL", "INCLINATION", "AZI", "AZIM", "AZIMUTH"];

impl Columns {
    /// Those without names: x, y, z and, where there are more, measured depth.
    pub(super) fn unnamed(count: usize) -> Self {
        Self {
            x: 0,
            y: 1,
            z: 2,
            measured: (count > 3).then_some(3),
            vertical: None,
            count: 3,
        }
    }

    /// Those that a line names; `None` where it does not name x, y and z.
    pub(super) fn of(words: &str) -> Option<Self> {
        let names = names(words);
        let find = |known: &[&str]| names.iter().position(|name| known.contains(&name.as_str()));
        // Z of a well trace is an elevation beside TVD, which is not.
        let z = find(DEPTH)
            .map(|at| (at, Some(Vertical::Depth)))
            .or_else(|| Some((find(ELEVATION)?, Some(Vertical::Elevation))))
            .or_else(|| Some((find(&["Z"])?, find(&["TVD"]).map(|_| Vertical::Elevation))))
            .or_else(|| Some((find(FROM_FLOOR)?, Some(Vertical::Depth))));
        let (z, vertical) = z?;
        Some(Self {
            x: find(X)?,
            y: find(Y)?,
            z,
            measured: find(MEASURED),
            vertical,
            count: names.len(),
        })
    }

    /// The columns that a row has to have.
    pub(super) fn needed(&self) -> usize {
        let places = [self.x, self.y, self.z, self.measured.unwrap_or(0)];
        1 + places.into_iter().max().unwrap_or(0)
    }
}

/// True where a line names measured depth and angles, and no x.
pub(super) fn is_survey(words: &str) -> bool {
    let names = names(words);
    let has = |known: &[&str]| names.iter().any(|name| known.contains(&name.as_str()));
    has(MEASURED) && has(ANGLES) && !has(X)
}

/// Names in upper case, without units and what else is not a letter: `X-coord (m)` is `XCOORD`.
fn names(words: &str) -> Vec<String> {
    let mut plain = String::new();
    let mut depth = 0_usize;
    for c in words.chars() {
        match c {
            '(' | '[' => depth += 1,
            ')' | ']' => depth = depth.saturating_sub(1),
            '-' | '_' | ':' | '"' | '\'' => {}
            _ if depth == 0 => plain.push(c),
            _ => {}
        }
    }
    parts(&plain, has_decimal_commas(&plain) && plain.contains(';'))
        .map(str::to_uppercase)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_which_column_is_which() {
        let found = |words: &str| {
            let c = Columns::of(words)?;
            Some(([c.x, c.y, c.z], c.measured, c.vertical))
        };
        for (words, expected) in [
            (
                "X Y TVD MD",
                Some(([0, 1, 2], Some(3), Some(Vertical::Depth))),
            ),
            ("X Y Z MD", Some(([0, 1, 2], Some(3), None))),
            (
                "MD X Y Z TVD DX DY AZIM_TN INCL DLS",
                Some(([1, 2, 3], Some(0), Some(Vertical::Elevation))),
            ),
            (
                "Easting(m);Northing(m);TVDSS (m)",
                Some(([0, 1, 2], None, Some(Vertical::Depth))),
            ),
            (
                "x-coord,y-coord,Elevation",
                Some(([0, 1, 2], None, Some(Vertical::Elevation))),
            ),
            ("MD INCL AZIM", None),
            ("A well", None),
        ] {
            assert_eq!(found(words), expected, "{words}");
        }
        assert!(is_survey("MD INCL AZIM") && !is_survey("MD X Y Z INCL"));
    }
}
