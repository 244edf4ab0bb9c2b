//! Names of properties as keywords of Eclipse files, which have 8 characters.

use std::collections::HashMap;
use std::io;
use std::path::Path;

use super::contents::Contents;
use super::error::{ExportError, failed};
use super::output::Output;

/// Characters of a keyword.
const LENGTH: usize = 8;
/// Keywords that mean something else where arrays of cells stand.
const TAKEN: [&str; 4] = ["ACTNUM", "COORD", "NNC", "ZCORN"];

/// The keyword that a property is written as: letters, digits and `_`, a letter in front, perhaps `-` behind as in
/// `MULTX-`. Differences begin with `D_`, so that they are not taken for what they are a difference of.
pub(super) fn keyword(name: &str) -> String {
    let (body, end) = match name.strip_suffix('-') {
        Some(body) => (body, if name.len() <= LENGTH { "-" } else { "" }),
        _ if TAKEN.contains(&name) => (name, "_"),
        _ => (name, ""),
    };
    let is_letter = name.starts_with(|c: char| c.is_ascii_alphabetic());
    let start = match (is_letter, body.contains('-')) {
        (_, true) => "D_",
        (false, _) => "P_",
        (true, _) => "",
    };
    let spelled = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let cut = start.chars().chain(body.chars()).map(spelled);
    cut.take(LENGTH - end.len()).chain(end.chars()).collect()
}

/// Says which properties are written under another name.
///
/// # Errors
/// When two have the same keyword.
pub(super) fn note_keywords(
    contents: &Contents<'_>,
    path: &Path,
    output: &mut Output<'_>,
) -> Result<(), ExportError> {
    let mut known: HashMap<String, &str> = HashMap::new();
    for property in &contents.properties {
        let keyword = keyword(&property.name);
        if keyword != property.name {
            output.note(format!("{} is written as {keyword}", property.name));
        }
        if let Some(other) = known.insert(keyword.clone(), &property.name) {
            let message = format!(
                "{other} and {} would both be {keyword}; write them to files of their own",
                property.name
            );
            let cause = io::Error::new(io::ErrorKind::InvalidInput, message);
            return Err(failed(path)(cause));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keywords_are_cut_and_spelled_as_files_have_them() {
        for (name, expected) in [
            ("PORO", "PORO"),
            ("PRESSURE", "PRESSURE"),
            ("THICKNESS", "THICKNES"),
            ("PORO.FRACTURE", "PORO_FRA"),
            ("PRESSURE-PRESSURE@0", "D_PRESSU"),
            ("MULTX-", "MULTX-"),
            ("LONG_NAMES-", "LONG_NAM"),
            ("4D", "P_4D"),
            ("ACTNUM", "ACTNUM_"),
            ("é", "P__"),
            ("", "P_"),
        ] {
            assert_eq!(keyword(name), expected);
        }
    }
}
