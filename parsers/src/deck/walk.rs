//! The walk through the files of a deck, keyword by keyword, for whoever takes what they say.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::files::DeckFiles;
use super::include::Nesting;
use super::lexer::{Cursor, Keyword, keyword, line_end};
use super::source::{Places, Source};
use crate::bytes::FileBytes;
use crate::error::{ErrorKind, ParseError};

/// How reading goes on after a keyword.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Flow {
    On,
    EndOfFile,
    EndOfDeck,
}

/// Takes what the keywords of a deck say.
pub(super) trait Visitor {
    /// A file begins.
    fn begin(&mut self, _source: &Source) {}

    /// A keyword whose data stand at the cursor, but for those of the [walk](Walk) itself.
    fn keyword(
        &mut self,
        walk: &mut Walk<'_>,
        source: &Rc<Source>,
        cursor: &mut Cursor,
        keyword: &Keyword,
    ) -> Result<Flow, ParseError>;

    /// Text that belongs to no keyword, where it first stands in a file.
    fn stray(&mut self, _source: &Source, _at: usize) {}
}

/// A walk through a deck. What visitors need not know is done here: titles, comments of several lines (SKIP), names of
/// folders (PATHS), and the ends of files and decks.
pub(super) struct Walk<'f> {
    pub(super) places: Places<'f>,
    pub(super) nesting: Nesting,
}

impl<'f> Walk<'f> {
    /// Walks through the deck at a path.
    pub(super) fn through(
        files: &'f dyn DeckFiles,
        path: &Path,
        visitor: &mut dyn Visitor,
    ) -> Result<(), ParseError> {
        let mut walk = Self {
            places: Places::new(files, path),
            nesting: Nesting::default(),
        };
        walk.file(visitor, files.open(path)?, Vec::new()).map(drop)
    }

    /// Walks through a file of the deck.
    pub(super) fn file(
        &mut self,
        visitor: &mut dyn Visitor,
        file: FileBytes,
        included_from: Vec<(PathBuf, usize)>,
    ) -> Result<Flow, ParseError> {
        let source = Rc::new(Source::new(file, included_from)?);
        visitor.begin(&source);
        self.nesting.enter(source.path());
        let flow = self.keywords(visitor, &source);
        self.nesting.leave();
        flow
    }

    fn keywords(
        &mut self,
        visitor: &mut dyn Visitor,
        source: &Rc<Source>,
    ) -> Result<Flow, ParseError> {
        let mut cursor = Cursor::new(source.text(), 0);
        let mut stray = None;
        let mut flow = Flow::On;
        while flow == Flow::On && cursor.skip_blank() {
            if let Some(keyword) = keyword(cursor.text, cursor.at) {
                cursor.at = keyword.end;
                flow = self.keyword(visitor, source, &mut cursor, &keyword)?;
            } else {
                // A lone slash is common and harmless.
                if cursor.text.get(cursor.at) != Some(&b'/') {
                    stray.get_or_insert(cursor.at);
                }
                cursor.at = line_end(cursor.text, cursor.at);
            }
        }
        if let Some(at) = stray {
            visitor.stray(source, at);
        }
        Ok(match flow {
            Flow::EndOfFile => Flow::On,
            flow => flow,
        })
    }

    fn keyword(
        &mut self,
        visitor: &mut dyn Visitor,
        source: &Rc<Source>,
        cursor: &mut Cursor,
        keyword: &Keyword,
    ) -> Result<Flow, ParseError> {
        match keyword.name.as_str() {
            "END" => return Ok(Flow::EndOfDeck),
            "ENDINC" => return Ok(Flow::EndOfFile),
            "PATHS" => self.places.add_aliases(source, cursor)?,
            "TITLE" => skip_title(cursor),
            "SKIP" | "SKIP100" | "SKIP300" => skip_region(source, cursor, keyword)?,
            _ => return visitor.keyword(self, source, cursor, keyword),
        }
        Ok(Flow::On)
    }
}

/// SKIP and its like: moves behind ENDSKIP.
fn skip_region(source: &Source, cursor: &mut Cursor, skip: &Keyword) -> Result<(), ParseError> {
    while cursor.skip_blank() {
        let ends = keyword(cursor.text, cursor.at).is_some_and(|found| found.name == "ENDSKIP");
        cursor.at = line_end(cursor.text, cursor.at);
        if ends {
            return Ok(());
        }
    }
    Err(source.error(
        ErrorKind::Truncated,
        skip.at,
        &skip.name,
        "no ENDSKIP follows in this file",
    ))
}

/// The title is the next line with text.
fn skip_title(cursor: &mut Cursor) {
    if cursor.skip_blank() {
        cursor.at = line_end(cursor.text, cursor.at);
    }
}
