//! Files and folders in the making: nothing half done is left behind.

use std::io;
use std::path::{Path, PathBuf};

/// A name for what will become a file or folder; what has that name goes away unless it is kept.
pub struct Draft {
    place: PathBuf,
    temporary: PathBuf,
}

impl Draft {
    /// A draft on the same file system as its place: beside it, or inside where that is a folder.
    pub fn of(place: &Path) -> Self {
        let part = format!(".{}.part", std::process::id());
        let temporary = if place.is_dir() {
            place.join(part)
        } else {
            let mut name = place.file_name().unwrap_or_default().to_owned();
            name.push(part);
            place.with_file_name(name)
        };
        Self {
            place: place.to_owned(),
            temporary,
        }
    }

    /// Where to write.
    pub fn path(&self) -> &Path {
        &self.temporary
    }

    /// Moves what was written to its place; the files of a folder join those of an existing one.
    pub fn keep(self) -> io::Result<()> {
        if !(self.temporary.is_dir() && self.place.is_dir()) {
            return std::fs::rename(&self.temporary, &self.place);
        }
        for entry in std::fs::read_dir(&self.temporary)? {
            let entry = entry?;
            std::fs::rename(entry.path(), self.place.join(entry.file_name()))?;
        }
        Ok(())
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        // The error that matters was told before; a leftover is only untidy.
        drop::<io::Result<()>>(if self.temporary.is_dir() {
            std::fs::remove_dir_all(&self.temporary)
        } else {
            std::fs::remove_file(&self.temporary)
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names in a folder.
    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let name = |e: io::Result<std::fs::DirEntry>| e.unwrap().file_name().into_string().unwrap();
        let mut names: Vec<_> = entries.map(name).collect();
        names.sort();
        names
    }

    #[test]
    fn what_is_not_kept_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("film.png");
        for kept in [false, true] {
            let draft = Draft::of(&place);
            std::fs::write(draft.path(), "half").unwrap();
            assert_eq!(names(folder.path()).len(), 1);
            assert!(!place.exists());
            if kept {
                draft.keep().unwrap();
            }
            assert_eq!(place.exists(), kept);
        }
        assert_eq!(names(folder.path()), ["film.png"]);
    }

    #[test]
    fn folders_appear_whole_and_join_what_is_there() {
        let folder = tempfile::tempdir().unwrap();
        // As the user writes it.
        let place = folder.path().join("film/");
        let make = |file: &str, kept: bool| {
            let draft = Draft::of(&place);
            std::fs::create_dir(draft.path()).unwrap();
            std::fs::write(draft.path().join(file), file).unwrap();
            if kept {
                draft.keep().unwrap();
            }
        };
        make("a", false);
        assert!(!place.exists());
        make("a", true);
        assert_eq!(names(&place), ["a"]);
        make("b", true);
        make("c", false);
        assert_eq!(names(&place), ["a", "b"]);
        assert_eq!(names(folder.path()), ["film"]);
    }
}
