//! Paths of wells: points in the map with their depths, from text in several forms.
//!
//! | form | is known by |
//! | --- | --- |
//! | lists of points, as ResInsight and many others write them (`.dev`) | rows of `x y z [md]`, names of wells between them, `-999` behind each well |
//! | well traces of Petrel | comments such as `# WELL NAME: A-1`, a line that names the columns: `MD X Y Z TVD ...` |
//! | wells of RMS | a version, a line of text, `NAME x y rkb`, the number of logs and a line for each, rows of `x y z` and logs |
//! | JSON of ResInsight | `{"name": "A-1", "path": [{"x": 1, "y": 2, "z": 3, "md": 4}]}`, or a list of such |
//!
//! The content says which form it is. Columns may be apart by blanks, tabs, commas or semicolons.
//!
//! ```
//! use strataray_parsers::{Warnings, paths};
//!
//! # fn main() -> Result<(), strataray_parsers::ParseError> {
//! let text = "WELLNAME: A-1\n6507.1 725 2542 2590\n6523.5 757 2549 2626.6\n-999\n";
//! let wells = paths::from_bytes(("wells.dev", text), &mut Warnings::default())?;
//! assert_eq!(wells[0].name, "A-1");
//! assert_eq!(wells[0].points[1], [6523.5, 757.0, 2549.0]);
//! assert_eq!(wells[0].measured, Some(vec![2590.0, 2626.6]));
//! # Ok(())
//! # }
//! ```

mod columns;
mod json;
mod line;
mod rms;
mod rows;

use std::path::Path;

use self::columns::Columns;
use self::line::{Line, lines};
use crate::bytes::FileBytes;
use crate::error::{At, ErrorKind, ParseError, Warnings};
use crate::units::LengthUnit;

/// The path of a well.
#[derive(Debug, Clone, PartialEq)]
pub struct WellPath {
    /// Name of the well: that of the file, without its ending, where the file names none.
    pub name: String,
    /// Easting, northing and depth of each point, at least two; depth is positive down. All finite.
    pub points: Vec<[f64; 3]>,
    /// Measured depth of each point, where the file has it.
    pub measured: Option<Vec<f64>>,
    /// Length unit of all numbers, where the file says it.
    pub unit: Option<LengthUnit>,
    /// What the third coordinate of the file was taken for.
    pub vertical: Vertical,
}

/// What the third coordinate of a file was taken for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Vertical {
    /// Depth, as the form or the name of the column says.
    Depth,
    /// Elevation, as the form or the name of the column says.
    Elevation,
    /// Depth, because the largest values are positive.
    DepthBySign,
    /// Elevation, because the largest values are negative.
    ElevationBySign,
}

impl Vertical {
    /// In words, such as `elevation, by its sign`.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Elevation => "elevation",
            Self::DepthBySign => "depth, by its sign",
            Self::ElevationBySign => "elevation, by its sign",
        }
    }

    fn is_elevation(self) -> bool {
        matches!(self, Self::Elevation | Self::ElevationBySign)
    }
}

/// Reads the wells of the file at `path`.
///
/// # Errors
/// When it cannot be read, is in none of the forms, or has a row that is not of numbers.
pub fn read(path: &Path, warnings: &mut Warnings) -> Result<Vec<WellPath>, ParseError> {
    from_bytes(FileBytes::open(path)?, warnings)
}

/// As [`read`], of bytes in memory.
///
/// # Errors
/// As [`read`].
pub fn from_bytes(
    file: impl Into<FileBytes>,
    warnings: &mut Warnings,
) -> Result<Vec<WellPath>, ParseError> {
    let file = file.into();
    let (path, bytes) = (file.path(), file.bytes());
    if bytes.iter().take(512).any(|byte| *byte == 0) {
        let message = "this is a binary file, not a text with well paths";
        return Err(wrong(ErrorKind::NotThisFormat, path, None, message));
    }
    let text = String::from_utf8_lossy(bytes);
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let stem = path.file_stem().map(|stem| stem.to_string_lossy());
    let stem = stem.unwrap_or_default();
    let wells = if json::is_json(text) {
        json::read(path, text, &stem)?
    } else if rms::is_rms(text) {
        rms::read(path, text)?
    } else {
        rows::read(path, text, &stem)?
    };
    let mut whole = Vec::new();
    for well in wells {
        if well.points.len() > 1 {
            whole.push(well);
        } else {
            let message = format!(
                "the path of {} has one point and is left out: a path needs two",
                well.name
            );
            warnings.push(path, At::File, message);
        }
    }
    if whole.is_empty() {
        let message = "has no well path: expected rows of x, y and z, two for each well at least";
        return Err(wrong(ErrorKind::MissingKeyword, path, None, message));
    }
    Ok(whole)
}

/// True where a text begins as files with well paths do. `is_named_so` where the name of the file says that it has
/// some: then it is enough that it is no deck.
///
/// `start` may end anywhere in the file.
pub fn begin(start: &[u8], is_named_so: bool) -> bool {
    let text = String::from_utf8_lossy(start);
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    if start.contains(&0) {
        return is_named_so;
    }
    if json::is_json(text) {
        return is_named_so || text.contains("\"path\"");
    }
    if rms::is_rms(text) {
        return true;
    }
    let (mut has_rows, mut has_names, mut has_columns) = (false, false, false);
    for (_, line) in lines(text) {
        // A deck has records, and these have ends.
        if line.trim_end().ends_with('/') && !line::is_comment(line) {
            return false;
        }
        match Line::of(line) {
            Line::Numbers(row) => has_rows |= row.len() >= 3,
            Line::Words(words) | Line::Comment(words) => {
                has_columns |= Columns::of(words).is_some();
                has_names |= line::labeled_name(words).is_some();
            }
            Line::Blank | Line::Damaged { .. } => {}
        }
    }
    is_named_so || has_rows && (has_columns || has_names)
}

/// An error at a line, counted from 1.
fn wrong(
    kind: ErrorKind,
    path: &Path,
    line: Option<usize>,
    message: impl Into<String>,
) -> ParseError {
    let at = line.map_or(At::File, |line| At::Line { line, column: 1 });
    ParseError::of(kind, path, at, "", message)
}

/// Settles which way the third coordinate points, for all wells of a file alike, and turns it into depth.
fn settle(wells: &mut [WellPath], named: Option<Vertical>) {
    let all = wells.iter().flat_map(|well| &well.points);
    let largest = all
        .map(|point| point[2])
        .max_by(|a, b| a.abs().total_cmp(&b.abs()));
    let by_sign = match largest.is_some_and(|z| z < 0.0) {
        true => Vertical::ElevationBySign,
        false => Vertical::DepthBySign,
    };
    for well in wells {
        well.vertical = named.unwrap_or(by_sign);
        if well.vertical.is_elevation() {
            well.points.iter_mut().for_each(|point| point[2] *= -1.0);
        }
    }
}
