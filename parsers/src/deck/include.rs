//! INCLUDE, GDFILE, IMPORT and PATHS: how one file leads to the next.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::edit::{CellBox, Place};
use super::lexer::{Cursor, Keyword, Token, line_end, record_end};
use super::scan::{Block, Data, Scan};
use super::source::{Places, Source};
use super::walk::{Flow, Visitor, Walk};
use crate::bytes::FileBytes;
use crate::error::{ErrorKind, ParseError};
use crate::records::{Form, RecordFile};

/// Deepest nesting and largest number of included files.
const DEEPEST: usize = 64;
const MOST_FILES: usize = 2000;
/// Bytes of files that may be included again after their first time: each time they are read through, and their arrays
/// noted.
const MOST_AGAIN: usize = 64 << 20;

/// The files being read.
#[derive(Default)]
pub(super) struct Nesting {
    /// Their paths, outermost first.
    open: Vec<PathBuf>,
    /// How many were opened so far.
    opened: usize,
    /// All that were included, and bytes of those that were again.
    known: HashSet<PathBuf>,
    again: usize,
}

/// Files that included one, innermost first, with the line of the INCLUDE.
type Chain = Vec<(PathBuf, usize)>;

impl Nesting {
    pub(super) fn enter(&mut self, path: &Path) {
        self.opened += 1;
        self.open.push(path.to_owned());
    }

    pub(super) fn leave(&mut self) {
        self.open.pop();
    }

    /// The file that a keyword names, with those that include it, unless it is one of them or they are too many.
    pub(super) fn include(
        &mut self,
        source: &Source,
        keyword: &Keyword,
        at: usize,
        file: Result<FileBytes, ParseError>,
    ) -> Result<(FileBytes, Chain), ParseError> {
        let name = keyword.name.as_str();
        let mut chain = vec![(source.path().to_owned(), source.line(keyword.at))];
        chain.extend_from_slice(&source.included_from);
        let file = match file {
            Ok(file) => file,
            Err(mut error) => {
                error.included_from = chain;
                return Err(error);
            }
        };
        let path = file.path();
        if self.open.iter().any(|open| open == path) {
            let message = format!("'{}' includes itself through other files", path.display());
            return Err(source.error(ErrorKind::Malformed, at, name, message));
        }
        if self.open.len() >= DEEPEST || self.opened >= MOST_FILES {
            let message = format!("more than {DEEPEST} nested or {MOST_FILES} included files");
            return Err(source.error(ErrorKind::TooLarge, at, name, message));
        }
        if !self.known.insert(path.to_owned()) {
            self.again = self.again.saturating_add(file.bytes().len());
        }
        if self.again > MOST_AGAIN {
            let most = MOST_AGAIN >> 20;
            let message = format!(
                "the same files are included again and again, with more than {most} MiB in all"
            );
            return Err(source.error(ErrorKind::TooLarge, at, name, message));
        }
        Ok((file, chain))
    }
}

impl Places<'_> {
    /// PATHS: names of folders.
    pub(super) fn add_aliases(
        &mut self,
        source: &Source,
        cursor: &mut Cursor,
    ) -> Result<(), ParseError> {
        loop {
            let items = cursor
                .record()
                .map_err(|mistake| source.mistake("PATHS", mistake))?;
            if items.is_empty() {
                return Ok(());
            }
            let text = |index: usize| {
                items
                    .get(index)?
                    .text
                    .map(|text| String::from_utf8_lossy(text).into_owned())
            };
            if let (Some(alias), Some(path)) = (text(0), text(1)) {
                self.aliases.insert(alias, path);
            }
        }
    }
}

/// The file that INCLUDE names, opened, and where its name stands.
fn included(
    places: &mut Places<'_>,
    source: &Source,
    cursor: &mut Cursor,
    keyword: &Keyword,
) -> Result<(usize, Result<FileBytes, ParseError>), ParseError> {
    let (at, written) = named_file(source, cursor, keyword)?;
    let found = places.find(&written, source.path());
    let path = found.map_err(|places| {
        let places: Vec<_> = places
            .iter()
            .map(|place| place.display().to_string())
            .collect();
        let message = format!(
            "'{written}' was not found; looked for {}",
            places.join(" and ")
        );
        source.error(ErrorKind::NotFound, at, &keyword.name, message)
    })?;
    Ok((at, places.open(&path)))
}

impl Walk<'_> {
    /// Walks through the file that INCLUDE names.
    pub(super) fn include(
        &mut self,
        visitor: &mut dyn Visitor,
        source: &Source,
        cursor: &mut Cursor,
        keyword: &Keyword,
    ) -> Result<Flow, ParseError> {
        let (at, file) = included(&mut self.places, source, cursor, keyword)?;
        self.include_file(visitor, source, keyword, at, file)
    }

    fn include_file(
        &mut self,
        visitor: &mut dyn Visitor,
        source: &Source,
        keyword: &Keyword,
        at: usize,
        file: Result<FileBytes, ParseError>,
    ) -> Result<Flow, ParseError> {
        let (file, chain) = self.nesting.include(source, keyword, at, file)?;
        self.file(visitor, file, chain)
    }
}

impl Scan<'_> {
    /// GDFILE and IMPORT: a text file is included, one of arrays noted for when the grid is built.
    pub(super) fn array_file(
        &mut self,
        walk: &mut Walk<'_>,
        source: &Rc<Source>,
        cursor: &mut Cursor,
        keyword: &Keyword,
    ) -> Result<Flow, ParseError> {
        let (at, written) = named_file(source, cursor, keyword)?;
        // Some write behind the name whether the file is formatted.
        if let Some(end) = record_end(cursor.text, cursor.at)
            && end < line_end(cursor.text, cursor.at)
        {
            cursor.at = line_end(cursor.text, end);
        }
        let found = walk.places.find(&written, source.path());
        let path = found.unwrap_or_else(|places| places.into_iter().next().unwrap_or_default());
        let file = walk.places.open(&path);
        if file.as_ref().is_ok_and(|file| !holds_arrays(file.bytes())) {
            return walk.include_file(self, source, keyword, at, file);
        }
        let place = Place {
            source: Rc::clone(source),
            at,
            keyword: keyword.name.clone(),
        };
        if keyword.name == "GDFILE" {
            // A file that is not there is missed where the grid is needed, which it is not to read faults alone.
            self.found.grid_file = Some((place, file));
        } else if let Err(error) = file.and_then(|file| self.import(&place, file)) {
            let message = format!("IMPORT was not read, so its arrays are missing: {error}");
            place.warn(self.warnings, message);
        }
        Ok(Flow::On)
    }

    /// Notes the arrays of a file as if they stood in the deck.
    fn import(&mut self, place: &Place, file: FileBytes) -> Result<(), ParseError> {
        let bytes = file.bytes().len();
        let file = Rc::new(RecordFile::from_bytes(file)?);
        self.found.bytes = self.found.bytes.saturating_add(bytes);
        self.found.files.push(file.path().to_owned());
        for entry in file.entries().iter().filter(|entry| entry.is_numeric()) {
            let block = Block {
                source: Rc::clone(&place.source),
                name: entry.name().to_ascii_uppercase(),
                at: place.at,
                data: Data::Imported(Rc::clone(&file), *entry),
                section: self.section,
            };
            match block.name.as_str() {
                "MAPAXES" => self.found.map_axes = file.f64s(entry)?.try_into().ok(),
                // Dimensions are the deck's.
                "SPECGRID" | "DIMENS" => {}
                _ => self.keep(block, CellBox::default()),
            }
        }
        Ok(())
    }
}

/// The path that stands at the cursor, and where.
pub(super) fn named_file(
    source: &Source,
    cursor: &mut Cursor,
    keyword: &Keyword,
) -> Result<(usize, String), ParseError> {
    let missing = || {
        let message = "expected the path of a file, in quotes";
        source.error(ErrorKind::Malformed, keyword.at, &keyword.name, message)
    };
    included_path(cursor).ok_or_else(missing)
}

/// True for a file of arrays, binary or formatted, also where a binary one is damaged.
fn holds_arrays(bytes: &[u8]) -> bool {
    Form::of(bytes).is_some() || bytes.iter().take(64).any(|&byte| byte == 0)
}

/// The path behind INCLUDE, in quotes or bare up to a blank, and moves behind its record.
fn included_path(cursor: &mut Cursor) -> Option<(usize, String)> {
    cursor.skip_blank();
    let at = cursor.at;
    let quoted = matches!(cursor.text.get(at), Some(b'\'' | b'"'));
    let path = if quoted {
        match cursor.token() {
            Ok(Some((_, Token::Text(path)))) => path,
            _ => return None,
        }
    } else {
        let behind = cursor.text.get(at..)?;
        let length = behind
            .iter()
            .position(|&byte| byte <= b' ')
            .unwrap_or(behind.len());
        let path = &behind[..length];
        let ended = path.strip_suffix(b"/");
        cursor.at = at + ended.unwrap_or(path).len();
        ended.unwrap_or(path)
    };
    // Sloppy decks leave the closing slash out; nothing else can follow, so that is harmless.
    let mut behind = cursor.clone();
    if let Ok(Some((_, Token::Slash))) = behind.token() {
        cursor.at = line_end(cursor.text, behind.at);
    }
    let path = String::from_utf8_lossy(path.trim_ascii()).into_owned();
    (!path.is_empty()).then_some((at, path))
}
