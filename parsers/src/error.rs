//! What went wrong, in which file, at which place.
//!
//! A reader fails with one [`ParseError`], whose [`ErrorKind`] tells programs what its message tells people; what it could work around is handed to a
//! [`Warnings`] collector with the same kind of place, so that nothing is dropped silently.

use std::fmt;
use std::path::{Path, PathBuf};

/// A place in a file: a line and column of text, or a byte offset of binary data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum At {
    /// Line and column, both counted from 1.
    Line {
        /// Line, from 1.
        line: usize,
        /// Column in bytes, from 1.
        column: usize,
    },
    /// Byte offset from the start of the file.
    Byte(u64),
    /// The file as a whole.
    File,
}

/// What kind of thing is wrong, for programs that act on it; what it is exactly stands in the error's message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A file, a folder or a case is not there: ask for another path, or for the missing file.
    NotFound,
    /// The operating system does not let a file be read: [`ParseError::cause`] is its error.
    Io,
    /// The file is of another format: try another reader.
    NotThisFormat,
    /// The file ends too early, as while a simulator is still writing it: read it again later, or read what is
    /// complete by [`crate::records::RecordFile::open_lenient`].
    Truncated,
    /// The bytes break the rules of the format: get the file again from where it was made.
    Malformed,
    /// A keyword that is needed is not there: look for it in another file.
    MissingKeyword,
    /// An array holds elements of another type than was asked for: see [`crate::records::Entry::kind`].
    WrongType,
    /// There are more or fewer values or items than there must be: correct the file.
    WrongCount,
    /// A value is not one of those that can stand there: correct the file.
    BadValue,
    /// Files that are right by themselves do not belong together: choose others.
    Mismatch,
    /// The file is right and asks for what this crate does not read: convert it.
    Unsupported,
    /// The file asks for more than a limit, the memory or the address space of this machine allows: reduce it, or use
    /// a larger machine.
    TooLarge,
    /// None of the above: made by [`ParseError::new`], which no reader of this crate uses.
    Other,
}

/// An error of a reader: file, place, keyword and what is wrong.
///
/// Shown as `path:line:column: KEYWORD: message` for text and
/// `path@0x1f40: KEYWORD: message` for binary files.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub struct ParseError {
    /// What kind of thing is wrong.
    pub kind: ErrorKind,
    /// The file that could not be read.
    pub path: PathBuf,
    /// The place in that file.
    pub at: At,
    /// The keyword being read, empty where none is known yet.
    pub keyword: String,
    /// What is wrong and, where there is something to do about it, what to do.
    pub message: String,
    /// Files that included this one, innermost first, with the line of the INCLUDE.
    pub included_from: Vec<(PathBuf, usize)>,
    /// The cause given by the operating system, if any; the message tells it already, so that a
    /// chain of errors does not tell it twice.
    pub cause: Option<std::io::Error>,
}

impl ParseError {
    /// An error of the kind [`ErrorKind::Other`] at `at` of `path` while reading `keyword` (may be empty).
    pub fn new(path: &Path, at: At, keyword: &str, message: impl Into<String>) -> Self {
        Self::of(ErrorKind::Other, path, at, keyword, message)
    }

    /// As [`Self::new`], of a kind.
    pub fn of(
        kind: ErrorKind,
        path: &Path,
        at: At,
        keyword: &str,
        message: impl Into<String>,
    ) -> Self {
        Self {
            kind,
            path: path.to_owned(),
            at,
            keyword: one_line(keyword.trim().to_owned()),
            message: one_line(message.into()),
            included_from: Vec::new(),
            cause: None,
        }
    }

    /// An error of the operating system about the whole file.
    pub fn io(path: &Path, what: &str, cause: std::io::Error) -> Self {
        let kind = match cause.kind() {
            std::io::ErrorKind::NotFound => ErrorKind::NotFound,
            _ => ErrorKind::Io,
        };
        let mut error = Self::of(kind, path, At::File, "", format!("{what}: {cause}"));
        error.cause = Some(cause);
        error
    }
}

/// Names and tokens of damaged files may hold anything, and what people are told is one line.
fn one_line(text: String) -> String {
    match text.contains(char::is_control) {
        true => text.replace(char::is_control, "?"),
        false => text,
    }
}

impl fmt::Display for ParseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_place(f, &self.path, self.at)?;
        if !self.keyword.is_empty() {
            write!(f, "{}: ", self.keyword)?;
        }
        f.write_str(&self.message)?;
        for (path, line) in &self.included_from {
            write!(f, " (included from {}:{line})", path.display())?;
        }
        Ok(())
    }
}

fn write_place(f: &mut fmt::Formatter<'_>, path: &Path, at: At) -> fmt::Result {
    match at {
        At::Line { line, column } => write!(f, "{}:{line}:{column}: ", path.display()),
        At::Byte(offset) => write!(f, "{}@{offset:#x}: ", path.display()),
        At::File => write!(f, "{}: ", path.display()),
    }
}

/// Something odd that did not stop a reader, with its place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Warning {
    /// The file.
    pub path: PathBuf,
    /// The place in it.
    pub at: At,
    /// One sentence: what is odd and what was done about it.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_place(f, &self.path, self.at)?;
        f.write_str(&self.message)
    }
}

/// Collects the [`Warning`]s of one or several readers, in the order they were met.
#[derive(Debug, Default, Clone)]
pub struct Warnings(Vec<Warning>);

impl Warnings {
    /// Adds a warning.
    pub fn push(&mut self, path: &Path, at: At, message: impl Into<String>) {
        self.0.push(Warning {
            path: path.to_owned(),
            at,
            message: one_line(message.into()),
        });
    }

    /// All warnings so far.
    pub fn iter(&self) -> impl Iterator<Item = &Warning> {
        self.0.iter()
    }

    /// True when nothing odd was met.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}
