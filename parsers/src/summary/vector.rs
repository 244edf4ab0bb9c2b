//! What a vector is: its keyword and what it is of.
//!
//! The first letter of a keyword says what it is of, as the simulators' manuals list them: field, group, well,
//! connection, segment, region, block, aquifer, and with an L before them those of local grids.

use std::fmt;

use crate::error::{ErrorKind, ParseError};
use crate::records::RecordFile;
use crate::units::UnitSystem;

/// Stands for no name.
const NO_NAME: &str = ":+:+:+:+";
/// What numbers between two regions hold: the first plus this times ten more than the second.
const REGION_BASE: i32 = 1 << 15;

/// A summary vector. It is shown as its key, such as `FOPT`, `WOPR:P1`, `BPR:3,4,5`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Vector {
    /// Keyword, such as WOPR.
    pub keyword: String,
    /// What it is of.
    pub subject: Subject,
    /// Unit as written; empty where there is none.
    pub unit: String,
    /// Where its values are.
    pub(super) place: usize,
}

/// What a vector is of. Cells and numbers count from 1.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Subject {
    /// The field.
    Field,
    /// A group.
    Group(String),
    /// A well.
    Well(String),
    /// A connection of a well.
    Connection(String, [i32; 3]),
    /// A segment of a well.
    Segment(String, i32),
    /// A region.
    Region(i32),
    /// What goes from one region to another.
    Regions([i32; 2]),
    /// A cell.
    Block([i32; 3]),
    /// An aquifer.
    Aquifer(i32),
    /// A well in a local grid: grid and well.
    LocalWell(String, String),
    /// A connection in a local grid: grid, well, cell.
    LocalConnection(String, String, [i32; 3]),
    /// A cell of a local grid.
    LocalBlock(String, [i32; 3]),
    /// Anything else: times, the work of the simulator, with a name where there is one.
    Other(Option<String>),
}

impl Vector {
    /// True for what was measured, which is shown as points: a vector of the field, a group or a well whose keyword
    /// ends with H. Vectors that users define (a U as second letter) are not.
    pub fn is_history(&self) -> bool {
        let is_kind = matches!(
            self.subject,
            Subject::Field | Subject::Group(_) | Subject::Well(_)
        );
        is_kind && self.keyword.ends_with('H') && self.keyword.as_bytes().get(1) != Some(&b'U')
    }
}

impl fmt::Display for Vector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let keyword = &self.keyword;
        let cell = |[i, j, k]: &[i32; 3]| format!("{i},{j},{k}");
        match &self.subject {
            Subject::Field | Subject::Other(None) => f.write_str(keyword),
            Subject::Group(name) | Subject::Well(name) | Subject::Other(Some(name)) => {
                write!(f, "{keyword}:{name}")
            }
            Subject::Connection(well, place) => write!(f, "{keyword}:{well}:{}", cell(place)),
            Subject::Segment(well, number) => write!(f, "{keyword}:{well}:{number}"),
            Subject::Region(number) | Subject::Aquifer(number) => write!(f, "{keyword}:{number}"),
            Subject::Regions([from, to]) => write!(f, "{keyword}:{from}-{to}"),
            Subject::Block(place) => write!(f, "{keyword}:{}", cell(place)),
            Subject::LocalWell(grid, well) => write!(f, "{keyword}:{grid}:{well}"),
            Subject::LocalConnection(grid, well, place) => {
                write!(f, "{keyword}:{grid}:{well}:{}", cell(place))
            }
            Subject::LocalBlock(grid, place) => write!(f, "{keyword}:{grid}:{}", cell(place)),
        }
    }
}

/// The arrays of SMSPEC, which have an item for each vector.
pub(super) struct Names {
    keywords: Vec<String>,
    names: Vec<String>,
    numbers: Vec<i32>,
    units: Vec<String>,
    grids: Vec<String>,
    local: [Vec<i32>; 3],
    /// Cells along i, j, k.
    pub(super) dims: [i32; 3],
    /// INTEHEAD, item 1.
    pub(super) units_of_case: Option<UnitSystem>,
}

impl Names {
    pub(super) fn read(spec: &RecordFile) -> Result<Self, ParseError> {
        let strings = |name: &str| match spec.find(name) {
            Some(entry) => spec.strings(entry),
            None => Ok(Vec::new()),
        };
        let integers = |name: &str| match spec.find(name) {
            Some(entry) => spec.i32s(entry),
            None => Ok(Vec::new()),
        };
        if spec.find("KEYWORDS").is_none() {
            let message = "is missing; this is no SMSPEC file";
            let kind = ErrorKind::MissingKeyword;
            let at = crate::error::At::File;
            return Err(ParseError::of(kind, spec.path(), at, "KEYWORDS", message));
        }
        // NAMES takes the place of WGNAMES where names are longer than eight letters.
        let long = strings("NAMES")?;
        let names = if long.is_empty() {
            strings("WGNAMES")?
        } else {
            long
        };
        let dims = integers("DIMENS")?;
        let head = integers("INTEHEAD")?;
        Ok(Self {
            keywords: strings("KEYWORDS")?,
            names,
            numbers: integers("NUMS")?,
            units: strings("UNITS")?,
            grids: strings("LGRS")?,
            local: [integers("NUMLX")?, integers("NUMLY")?, integers("NUMLZ")?],
            dims: [1, 2, 3].map(|n| dims.get(n).copied().unwrap_or(0)),
            units_of_case: head.first().and_then(|code| UnitSystem::from_code(*code)),
        })
    }

    pub(super) fn count(&self) -> usize {
        self.keywords.len()
    }

    pub(super) fn vectors(&self) -> Vec<Vector> {
        let named = (0..self.count()).filter(|n| !self.keywords[*n].trim().is_empty());
        let vector = |n: usize| Vector {
            keyword: self.keywords[n].trim().to_owned(),
            subject: self.subject(n),
            unit: self.units.get(n).map_or("", |u| u.trim()).to_owned(),
            place: n,
        };
        named.map(vector).collect()
    }

    fn subject(&self, n: usize) -> Subject {
        let text = |texts: &[String]| {
            let text = texts.get(n).map(|t| t.trim().to_owned());
            text.filter(|t| !t.is_empty() && t != NO_NAME)
        };
        let name = text(&self.names);
        let grid = text(&self.grids);
        let number = self.numbers.get(n).copied().unwrap_or(0);
        let local = [0, 1, 2].map(|axis| self.local[axis].get(n).copied().unwrap_or(0));
        let other = Subject::Other(name.clone());
        let keyword = self.keywords[n].trim().as_bytes();
        let subject = match (keyword, name) {
            ([b'L', b'W', ..], Some(well)) => grid.map(|grid| Subject::LocalWell(grid, well)),
            ([b'L', b'C', ..], Some(well)) => {
                grid.map(|grid| Subject::LocalConnection(grid, well, local))
            }
            ([b'L', b'B', ..], _) => grid.map(|grid| Subject::LocalBlock(grid, local)),
            ([b'F', ..], _) => Some(Subject::Field),
            ([b'G', ..], Some(name)) => Some(Subject::Group(name)),
            ([b'W', ..], Some(name)) => Some(Subject::Well(name)),
            ([b'C', ..], Some(name)) => {
                let cell = self.cell(number);
                cell.map(|cell| Subject::Connection(name, cell))
            }
            ([b'S', ..], Some(name)) if number > 0 => Some(Subject::Segment(name, number)),
            ([b'B', ..], _) => self.cell(number).map(Subject::Block),
            ([b'R', ..], _) if number > 0 => Some(regions(number)),
            ([b'A', ..], _) if number > 0 => Some(Subject::Aquifer(number)),
            _ => None,
        };
        subject.unwrap_or(other)
    }

    /// The cell of a number in natural order.
    fn cell(&self, number: i32) -> Option<[i32; 3]> {
        let [ni, nj, nk] = self.dims;
        let index = number.checked_sub(1).filter(|n| *n >= 0)?;
        if ni < 1 || nj < 1 {
            return None;
        }
        let [i, j, k] = [index % ni, index / ni % nj, index / ni / nj];
        (k < nk).then_some([i + 1, j + 1, k + 1])
    }
}

fn regions(number: i32) -> Subject {
    match number / REGION_BASE - 10 {
        second @ 1.. => Subject::Regions([number % REGION_BASE, second]),
        _ => Subject::Region(number),
    }
}

/// What a key such as `WOPR:P1` names, as ESMRY has it.
pub(super) fn from_key(key: &str, unit: &str, place: usize) -> Vector {
    let mut parts = key.trim().split(':');
    let keyword = parts.next().unwrap_or_default();
    let rest: Vec<&str> = parts.collect();
    let number = |text: &str| text.parse::<i32>().ok();
    let cell = |text: &str| {
        let numbers: Option<Vec<i32>> = text.split(',').map(number).collect();
        numbers.and_then(|n| n.try_into().ok())
    };
    let pair = |text: &str| {
        let (from, to) = text.split_once('-')?;
        Some(Subject::Regions([number(from)?, number(to)?]))
    };
    let subject = match (keyword.as_bytes(), &rest[..]) {
        ([b'F', ..], []) => Some(Subject::Field),
        ([b'G', ..], [name]) => Some(Subject::Group((*name).to_owned())),
        ([b'W', ..], [name]) => Some(Subject::Well((*name).to_owned())),
        ([b'C', ..], [well, place]) => {
            cell(place).map(|cell| Subject::Connection((*well).to_owned(), cell))
        }
        ([b'S', ..], [well, n]) => number(n).map(|n| Subject::Segment((*well).to_owned(), n)),
        ([b'B', ..], [place]) => cell(place).map(Subject::Block),
        ([b'R', ..], [n]) => number(n).map(regions).or_else(|| pair(n)),
        ([b'A', ..], [n]) => number(n).map(Subject::Aquifer),
        _ => None,
    };
    let name = (!rest.is_empty()).then(|| rest.join(":"));
    Vector {
        keyword: keyword.to_owned(),
        subject: subject.unwrap_or(Subject::Other(name)),
        unit: unit.trim().to_owned(),
        place,
    }
}
