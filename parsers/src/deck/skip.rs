//! What a deck holds besides the grid: how to get past a keyword that is not read.
//!
//! Decks do not say how many records a keyword has. The rule: after a keyword, a word alone on its
//! line is the next keyword; anything else opens a record that runs to its `/`. Once a record
//! began with a number, every word at a line start is a keyword. Two short tables name the
//! keywords for which the rule could go wrong.

use super::lexer::{Cursor, Mistake, keyword, line_end, record_end, starts_number};
use crate::error::ErrorKind;

/// Keywords without data.
const WITHOUT_DATA: &[&str] = &[
    "RUNSPEC", "GRID", "EDIT", "PROPS", "REGIONS", "SOLUTION", "OIL", "WATER", "GAS", "DISGAS",
    "VAPOIL", "NOECHO", "ECHO", "INIT", "UNIFIN", "UNIFOUT", "FMTIN", "FMTOUT", "NOSIM",
    "NOINSPEC", "NORSSPEC", "METRIC", "FIELD", "LAB", "PVT-M", "ENDBOX", "ENDFIN", "NEWTRAN",
    "OLDTRAN", "ENDSKIP", "NONNC", "IMPES", "RADIAL", "DUALPORO", "DUALPERM", "NODPPM", "DPGRID",
];

/// Keywords whose records begin with words and which end with an empty record.
const UNTIL_EMPTY: &[&str] = &[
    "MULTREGT", "THPRES", "PINCHREG", "NNC", "EDITNNC", "AQUCON", "AQUANCON",
];

/// Keywords that change arrays by a rule, all ending with an empty record.
const OPERATIONS: &[&str] = &[
    "EQUALS", "ADD", "MULTIPLY", "COPY", "MAXVALUE", "MINVALUE", "COPYBOX", "EQUALREG", "ADDREG",
    "MULTIREG", "COPYREG", "OPERATE", "OPERATER",
];

/// Keywords that this reader knows: found at a line start, they end whatever went before.
const READ: &[&str] = &[
    "SPECGRID", "DIMENS", "COORD", "ZCORN", "ACTNUM", "MAPAXES", "MAPUNITS", "GRIDUNIT",
    "GDORIENT", "COORDSYS", "FAULTS", "INCLUDE", "BOX", "ENDBOX", "PORO", "PERMX", "PERMY",
    "PERMZ", "NTG",
];

/// Sections, each of which ends what went before as well.
const SECTIONS: &[&str] = &[
    "GRID", "EDIT", "PROPS", "REGIONS", "SOLUTION", "SUMMARY", "SCHEDULE",
];

pub(super) fn is_without_data(name: &str) -> bool {
    WITHOUT_DATA.contains(&name)
}

pub(super) fn is_operation(name: &str) -> bool {
    OPERATIONS.contains(&name)
}

pub(super) fn is_read(name: &str) -> bool {
    READ.contains(&name)
}

fn ends_operation(name: &str) -> bool {
    matches!(
        name,
        "COORD" | "ZCORN" | "SPECGRID" | "DIMENS" | "INCLUDE" | "FAULTS"
    ) || SECTIONS.contains(&name)
}

/// What lies behind a keyword that was skipped.
pub(super) enum Skipped {
    /// The next keyword or the end of the text.
    Whole,
    /// Exactly one record, and it starts like a number: data from the keyword to this offset.
    OneNumeric(usize),
    /// Text without the closing `/`, up to the end of the file.
    Unended(usize),
}

/// Moves behind all records of the keyword `name`, whose data start at the cursor.
pub(super) fn skip_records(cursor: &mut Cursor, name: &str) -> Result<Skipped, Mistake> {
    if is_without_data(name) {
        // What follows on the line is decoration.
        cursor.at = line_end(cursor.text, cursor.at);
        return Ok(Skipped::Whole);
    }
    let until_empty = UNTIL_EMPTY.contains(&name);
    let (mut records, mut numeric, mut first_end) = (0_usize, false, 0);
    while cursor.skip_blank() {
        let start = cursor.at;
        if starts_keyword(cursor, until_empty, numeric) {
            break;
        }
        let is_number = starts_number(&cursor.text[start..]);
        let Some(end) = record_end(cursor.text, start) else {
            return unended(cursor, start, is_number);
        };
        cursor.at = line_end(cursor.text, end);
        if until_empty && end == start {
            break;
        }
        records += 1;
        numeric |= is_number;
        if records == 1 {
            first_end = end;
        }
    }
    Ok(if records == 1 && numeric {
        Skipped::OneNumeric(first_end)
    } else {
        Skipped::Whole
    })
}

fn unended(cursor: &mut Cursor, start: usize, is_number: bool) -> Result<Skipped, Mistake> {
    cursor.at = cursor.text.len();
    if is_number {
        return Err(Mistake::new(
            ErrorKind::Truncated,
            start,
            "the file ends before the closing / of this record",
        ));
    }
    Ok(Skipped::Unended(start))
}

/// Whether a keyword, and not another record, starts at the cursor.
fn starts_keyword(cursor: &Cursor, until_empty: bool, after_numbers: bool) -> bool {
    keyword(cursor.text, cursor.at).is_some_and(|found| {
        if until_empty {
            return found.alone && ends_operation(&found.name);
        }
        found.alone || after_numbers || is_read(&found.name)
    })
}

/// True where a keyword that surely begins something else stands in place of another record of a list.
pub(super) fn ends_records(cursor: &Cursor) -> bool {
    starts_keyword(cursor, true, false)
}
