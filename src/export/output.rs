//! The files of an export in the making, what is said of them, and how far they are.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use super::error::{ExportError, failed};
use crate::draft::Draft;

/// What was written.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Written {
    /// The files.
    pub files: Vec<PathBuf>,
    /// What is not as one might expect, one sentence each.
    pub notes: Vec<String>,
}

/// Files that appear together once all are whole, and not at all before.
pub(super) struct Output<'a> {
    drafts: Vec<Draft>,
    written: Written,
    /// Files that must stay, as the system names them.
    sources: Vec<PathBuf>,
    tell: &'a dyn Fn(f64) -> bool,
    total: usize,
    done: usize,
}

impl<'a> Output<'a> {
    /// An output that leaves `sources` as they are; `tell` gets the part done and returns false to cancel.
    pub fn new(sources: &[PathBuf], tell: &'a dyn Fn(f64) -> bool) -> Self {
        let real = |path: &PathBuf| path.canonicalize().ok();
        Self {
            drafts: Vec::new(),
            written: Written::default(),
            sources: sources.iter().filter_map(real).collect(),
            tell,
            total: 1,
            done: 0,
        }
    }

    /// Says how much work there is: values to write.
    pub fn expect(&mut self, total: usize) {
        self.total = total.max(1);
    }

    /// Says that so much work is done.
    ///
    /// # Errors
    /// When nobody wants the files anymore.
    pub fn advance(&mut self, work: usize) -> Result<(), ExportError> {
        self.done += work;
        let part = self.done as f64 / self.total as f64;
        match (self.tell)(part.min(1.0)) {
            true => Ok(()),
            false => Err(ExportError::Canceled),
        }
    }

    /// A sentence about what is written.
    pub fn note(&mut self, sentence: String) {
        self.written.notes.push(sentence);
    }

    /// Begins a file.
    ///
    /// # Errors
    /// When it cannot be made, or is one of the sources.
    pub fn file(&mut self, path: &Path) -> Result<File, ExportError> {
        let is_source = |real: PathBuf| self.sources.contains(&real);
        if path.canonicalize().is_ok_and(is_source) {
            return Err(ExportError::Source(path.to_owned()));
        }
        let draft = Draft::of(path);
        let file = File::create(draft.path()).map_err(failed(path))?;
        self.drafts.push(draft);
        self.written.files.push(path.to_owned());
        Ok(file)
    }

    /// Writes a file at once.
    ///
    /// # Errors
    /// As [`Self::file`], and when `content` fails.
    pub fn write(
        &mut self,
        path: &Path,
        content: impl FnOnce(File) -> io::Result<()>,
    ) -> Result<(), ExportError> {
        content(self.file(path)?).map_err(failed(path))
    }

    /// Moves all files to their places.
    ///
    /// # Errors
    /// When one cannot be moved.
    pub fn keep(self) -> Result<Written, ExportError> {
        for (draft, path) in self.drafts.into_iter().zip(&self.written.files) {
            draft.keep().map_err(failed(path))?;
        }
        Ok(self.written)
    }
}
