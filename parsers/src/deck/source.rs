//! The files of a deck: their text, who included them, and where an INCLUDE leads.

use std::cell::Cell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::files::DeckFiles;
use super::lexer::{Mistake, line_end};
use crate::bytes::FileBytes;
use crate::error::{At, ErrorKind, ParseError};

/// A file of a deck.
pub(super) struct Source {
    file: FileBytes,
    /// Innermost first, with the line of the INCLUDE.
    pub(super) included_from: Vec<(PathBuf, usize)>,
    /// An offset and its line, so that ever later places are found without counting anew.
    counted: Cell<(usize, usize)>,
}

impl Source {
    /// # Errors
    /// When the file is not text.
    pub(super) fn new(
        file: FileBytes,
        included_from: Vec<(PathBuf, usize)>,
    ) -> Result<Self, ParseError> {
        let source = Self {
            file,
            included_from,
            counted: Cell::new((0, 1)),
        };
        if source.text().iter().take(512).any(|byte| *byte == 0) {
            let message = "this is a binary file, not a text deck";
            return Err(source.error(ErrorKind::NotThisFormat, 0, "", message));
        }
        Ok(source)
    }

    /// The text, without the mark that some editors put before it (UTF-8 byte order mark).
    pub(super) fn text(&self) -> &[u8] {
        let bytes = self.file.bytes();
        bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
    }

    pub(super) fn path(&self) -> &Path {
        self.file.path()
    }

    /// Line and column of `offset`.
    pub(super) fn at(&self, offset: usize) -> At {
        let text = self.text();
        let offset = offset.min(text.len());
        let counted = self.counted.get();
        let (mut start, mut line) = if counted.0 <= offset { counted } else { (0, 1) };
        loop {
            let end = line_end(text, start);
            let next = end
                + if text[end..].starts_with(b"\r\n") {
                    2
                } else {
                    1
                };
            if end == text.len() || next > offset {
                break;
            }
            (start, line) = (next, line + 1);
        }
        self.counted.set((start, line));
        At::Line {
            line,
            column: offset - start + 1,
        }
    }

    pub(super) fn line(&self, offset: usize) -> usize {
        match self.at(offset) {
            At::Line { line, .. } => line,
            At::Byte(_) | At::File => 0,
        }
    }

    pub(super) fn error(
        &self,
        kind: ErrorKind,
        offset: usize,
        keyword: &str,
        message: impl Into<String>,
    ) -> ParseError {
        let mut error = ParseError::of(kind, self.path(), self.at(offset), keyword, message);
        error.included_from.clone_from(&self.included_from);
        error
    }

    pub(super) fn mistake(&self, keyword: &str, mistake: Mistake) -> ParseError {
        self.error(mistake.kind, mistake.at, keyword, mistake.message)
    }
}

/// Where included files are looked for, and the aliases PATHS gives to directories.
pub(super) struct Places<'f> {
    files: &'f dyn DeckFiles,
    /// Directory of the main deck.
    root: PathBuf,
    /// Alias without its `$`, and what it stands for.
    pub(super) aliases: HashMap<String, String>,
    /// Files that were opened: those included again are held once.
    opened: HashMap<PathBuf, FileBytes>,
}

impl<'f> Places<'f> {
    pub(super) fn new(files: &'f dyn DeckFiles, deck: &Path) -> Self {
        let root = deck.parent().unwrap_or(Path::new("")).to_owned();
        Self {
            files,
            root,
            aliases: HashMap::new(),
            opened: HashMap::new(),
        }
    }

    /// Opens a file that was [found](Self::find).
    pub(super) fn open(&mut self, path: &Path) -> Result<FileBytes, ParseError> {
        if let Some(file) = self.opened.get(path) {
            return Ok(file.clone());
        }
        let file = self.files.open(path)?;
        self.opened.insert(path.to_owned(), file.clone());
        Ok(file)
    }

    /// The existing file that `written` means in `from`, else all places looked at.
    pub(super) fn find(&self, written: &str, from: &Path) -> Result<PathBuf, Vec<PathBuf>> {
        let named = PathBuf::from(self.with_aliases(written));
        let beside = from.parent().unwrap_or(Path::new(""));
        let mut places = vec![self.root.join(&named), beside.join(&named)];
        places.dedup();
        let exact = places.iter().find_map(|place| self.files.find(place));
        let any_case = |place: &PathBuf| self.files.find_any_case(place);
        let found = exact.or_else(|| places.iter().find_map(any_case));
        found.ok_or(places)
    }

    /// Replaces `$NAME` by its directory and backslashes, which some systems write, by slashes.
    fn with_aliases(&self, written: &str) -> String {
        let mut parts = written.split('$');
        let mut path = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            let is_name = |letter: char| letter.is_alphanumeric() || letter == '_';
            let end = part.find(|letter| !is_name(letter)).unwrap_or(part.len());
            let (name, behind) = part.split_at(end);
            match self.aliases.get(name) {
                Some(directory) => path.push_str(directory),
                None => path.extend(["$", name]),
            }
            path.push_str(behind);
        }
        path.replace('\\', "/")
    }
}
