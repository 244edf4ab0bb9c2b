//! Fortran-record files: named, typed arrays (EGRID, INIT, UNRST, ...), in big-endian blocks or as text.
//!
//! Each array of a binary file has a header record of 16 bytes (name, count, type) and data in blocks, every record
//! between two copies of its length in bytes; a formatted file (FEGRID, FINIT, FUNRST, ...) has the same as text.
//! Which one it is the content says, not the name. Opening a file indexes the headers by skipping over
//! the data; an array is decoded when asked for. Large binary files stay on disk, from where arrays are read by place.

mod blocks;
mod decode;
mod index;
mod store;
mod text;
mod write;

use std::path::Path;

use crate::bytes::FileBytes;
use crate::error::{At, ErrorKind, ParseError, Warnings};

use store::{SMALL, Store};

pub use write::RecordWriter;
pub(crate) use write::refused;

/// Elements in a block by convention: numbers, strings.
const NUMBERS_PER_BLOCK: u64 = 1000;
const STRINGS_PER_BLOCK: u64 = 105;

/// How the arrays of a file are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Big-endian blocks between their lengths.
    Binary,
    /// Text.
    Formatted,
}

impl Form {
    /// The form of a file that starts with these bytes; `None` where it has no arrays.
    pub fn of(start: &[u8]) -> Option<Self> {
        if i32_at(start, 0) == Some(16) {
            return Some(Self::Binary);
        }
        text::is_text(start).then_some(Self::Formatted)
    }

    /// The place that people are told of a byte.
    pub(crate) fn place(self, bytes: &[u8], at: u64) -> At {
        match self {
            Self::Binary => At::Byte(at),
            Self::Formatted => text::place(bytes, at),
        }
    }
}

/// Type of the elements of an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// 4-byte integers.
    Inte,
    /// 4-byte reals.
    Real,
    /// 8-byte reals.
    Doub,
    /// 4-byte logicals.
    Logi,
    /// Strings of this many bytes (8 for CHAR, nn for C0nn).
    Text(u16),
    /// A message without data.
    Mess,
}

impl Kind {
    /// Bytes of one element.
    pub fn size(self) -> u64 {
        match self {
            Self::Inte | Self::Real | Self::Logi => 4,
            Self::Doub => 8,
            Self::Text(n) => u64::from(n),
            Self::Mess => 0,
        }
    }

    /// Elements in a block by convention.
    fn block(self) -> u64 {
        match self {
            Self::Text(_) => STRINGS_PER_BLOCK,
            _ => NUMBERS_PER_BLOCK,
        }
    }

    fn parse(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"INTE" => Self::Inte,
            b"REAL" => Self::Real,
            b"DOUB" => Self::Doub,
            b"LOGI" => Self::Logi,
            b"CHAR" => Self::Text(8),
            b"MESS" => Self::Mess,
            [b'C', digits @ ..] if digits.iter().all(u8::is_ascii_digit) => {
                let digits = std::str::from_utf8(digits).ok()?;
                Self::Text(digits.parse().ok().filter(|n| *n > 0)?)
            }
            _ => return None,
        })
    }
}

/// One array of a file, not decoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    name: [u8; 8],
    /// Element type.
    pub kind: Kind,
    /// Number of elements.
    pub count: u64,
    /// Byte offset of the header.
    pub offset: u64,
    /// Byte offset of the data.
    data: u64,
    /// Byte offset behind the data.
    end: u64,
}

impl Entry {
    /// Name without trailing blanks.
    pub fn name(&self) -> &str {
        std::str::from_utf8(&self.name)
            .unwrap_or_default()
            .trim_end()
    }

    /// True for types that hold numbers.
    pub fn is_numeric(&self) -> bool {
        matches!(self.kind, Kind::Inte | Kind::Real | Kind::Doub)
    }
}

/// A file with the index of its arrays.
#[derive(Debug)]
pub struct RecordFile {
    store: Store,
    form: Form,
    entries: Vec<Entry>,
    is_cut: bool,
}

impl RecordFile {
    /// Opens a file and indexes its arrays.
    ///
    /// # Errors
    /// When the file cannot be read, is not such a file, or ends within an array.
    pub fn open(path: &Path) -> Result<Self, ParseError> {
        Self::whole(Store::open(path, 1, SMALL)?)
    }

    /// As [`Self::open`], for a file that is in memory.
    ///
    /// # Errors
    /// When it is not such a file, or ends within an array.
    pub fn from_bytes(file: impl Into<FileBytes>) -> Result<Self, ParseError> {
        Self::whole(Store::Memory(file.into()))
    }

    /// Like [`Self::open`], but keeps the complete arrays of a file that ends within one, as a
    /// simulator that is still running leaves it; what is missing becomes a warning.
    ///
    /// # Errors
    /// When the file cannot be read or holds no complete array.
    pub fn open_lenient(path: &Path, warnings: &mut Warnings) -> Result<Self, ParseError> {
        Self::open_one_of(path, 1, warnings)
    }

    /// As [`Self::open_lenient`], of a file that is one of `count` that are held together: all of them take no more
    /// memory than one.
    pub(crate) fn open_one_of(
        path: &Path,
        count: usize,
        warnings: &mut Warnings,
    ) -> Result<Self, ParseError> {
        Self::as_far_as_whole(Store::open(path, count, SMALL)?, warnings)
    }

    /// As [`Self::open_lenient`], for a file that is in memory.
    ///
    /// # Errors
    /// When it holds no complete array.
    pub fn from_bytes_lenient(
        file: impl Into<FileBytes>,
        warnings: &mut Warnings,
    ) -> Result<Self, ParseError> {
        Self::as_far_as_whole(Store::Memory(file.into()), warnings)
    }

    fn whole(store: Store) -> Result<Self, ParseError> {
        match Self::indexed(store) {
            (_, Some(error)) => Err(error),
            (file, None) => Ok(file),
        }
    }

    fn as_far_as_whole(store: Store, warnings: &mut Warnings) -> Result<Self, ParseError> {
        let (file, broken) = Self::indexed(store);
        if let Some(error) = broken {
            if file.entries.is_empty() {
                return Err(error);
            }
            let message = match error.keyword.as_str() {
                "" => format!("the end of the file was left out: {}", error.message),
                keyword => format!(
                    "{keyword} and what follows it were left out: {}",
                    error.message
                ),
            };
            warnings.push(file.path(), error.at, message);
        }
        Ok(file)
    }

    /// The file with the index of its complete arrays, and why these are not all.
    fn indexed(store: Store) -> (Self, Option<ParseError>) {
        let form = match &store {
            Store::Memory(file) => Form::of(file.bytes()).unwrap_or(Form::Binary),
            Store::Disk(_) => Form::Binary,
        };
        let (entries, broken) = index::index(&store, form);
        let file = Self {
            store,
            form,
            entries,
            is_cut: broken.is_some(),
        };
        (file, broken)
    }

    /// Whether the file is binary or text.
    pub fn form(&self) -> Form {
        self.form
    }

    /// The place in the file that people are told of a byte: a line of text, or the byte itself.
    pub fn place(&self, offset: u64) -> At {
        self.form.place(self.store.text(), offset)
    }

    /// True where the file ends within an array, as one does that is being written.
    pub fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// All arrays in file order.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The path that was opened, or the name that was given.
    pub fn path(&self) -> &Path {
        self.store.path()
    }

    /// The first array called `name`.
    pub fn find(&self, name: &str) -> Option<&Entry> {
        self.entries.iter().find(|e| e.name() == name)
    }

    /// An error about an array of this file.
    pub(crate) fn error(
        &self,
        kind: ErrorKind,
        entry: &Entry,
        message: impl Into<String>,
    ) -> ParseError {
        let at = self.place(entry.offset);
        ParseError::of(kind, self.path(), at, entry.name(), message)
    }
}

/// Big-endian i32 at a byte offset, if the bytes are there.
fn i32_at(bytes: &[u8], at: usize) -> Option<i32> {
    let four = bytes.get(at..)?.first_chunk()?;
    Some(i32::from_be_bytes(*four))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Bytes of one array in blocks of at most `block` elements.
    pub(crate) fn array(name: &str, kind: &str, size: usize, data: &[u8], block: usize) -> Vec<u8> {
        let mut bytes = 16i32.to_be_bytes().to_vec();
        bytes.extend(format!("{name:<8}").bytes());
        let count = data.len().checked_div(size).unwrap_or(0);
        bytes.extend((count as i32).to_be_bytes());
        bytes.extend(kind.bytes());
        bytes.extend(16i32.to_be_bytes());
        for chunk in data.chunks((size * block).max(1)) {
            let length = (chunk.len() as i32).to_be_bytes();
            bytes.extend(length);
            bytes.extend(chunk);
            bytes.extend(length);
        }
        bytes
    }

    fn open(bytes: &[u8]) -> Result<RecordFile, ParseError> {
        RecordFile::from_bytes(("CASE.INIT", bytes.to_vec()))
    }

    fn reals(n: usize) -> Vec<u8> {
        (0..n).flat_map(|v| (v as f32).to_be_bytes()).collect()
    }

    #[test]
    fn ok_blocks_of_any_size() {
        for block in [1, 7, 1000, 5000] {
            let mut bytes = array("PORO", "REAL", 4, &reals(2500), block);
            bytes.extend(array("NOTHING", "INTE", 4, &[], 1000));
            bytes.extend(array("TEXT", "C012", 12, b"abc         defghijklmno", 105));
            bytes.extend(array("ENDSOL", "MESS", 0, &[], 1));
            let file = open(&bytes).unwrap();
            assert_eq!(file.entries().len(), 4, "blocks of {block}");
            let values = file.f32s(&file.entries()[0]).unwrap();
            assert!(values.iter().enumerate().all(|(n, v)| *v == n as f32));
            assert_eq!(values.len(), 2500);
            assert!(file.i32s(&file.entries()[1]).unwrap().is_empty());
            assert_eq!(
                file.strings(&file.entries()[2]).unwrap(),
                ["abc", "defghijklmno"]
            );
        }
    }

    #[test]
    fn err_truncated_anywhere_names_the_keyword() {
        let mut bytes = array("PORO", "REAL", 4, &reals(1200), 1000);
        bytes.extend(array("PERMX", "REAL", 4, &reals(1200), 1000));
        let half = bytes.len() / 2;
        for cut in (1..bytes.len()).step_by(61).filter(|&c| c != half) {
            let error = open(&bytes[..cut]).unwrap_err().to_string();
            assert!(error.contains('@'), "{cut}: {error}");
        }
        assert!(
            open(&bytes[..half]).is_ok(),
            "a whole number of arrays is a whole file"
        );
    }

    #[test]
    fn err_counts_that_the_file_does_not_cover() {
        for count in [-1i32, i32::MIN, i32::MAX, 1201] {
            let mut bytes = array("PORO", "REAL", 4, &reals(1200), 1000);
            bytes[12..16].copy_from_slice(&count.to_be_bytes());
            let error = open(&bytes).unwrap_err().to_string();
            assert!(error.contains("PORO"), "{count}: {error}");
        }
    }

    /// A file that stays on disk, however small it is, and is one of `count`.
    fn on_disk(path: &Path, count: usize) -> Result<RecordFile, ParseError> {
        RecordFile::whole(Store::open(path, count, 0)?)
    }

    /// What is in a file, or why it cannot be read.
    fn contents(file: Result<RecordFile, ParseError>) -> Vec<String> {
        let file = match file {
            Ok(file) => file,
            Err(error) => return vec![error.message],
        };
        let of_entry = |entry: &Entry| {
            let values = file.f64s(entry).map_err(|e| e.message);
            let strings = file.strings(entry).map_err(|e| e.message);
            let last = (entry.count as usize).saturating_sub(1);
            let one = [0, last / 2, last].map(|n| file.f32_at(entry, n).map_err(|e| e.message));
            format!("{entry:?} {values:?} {strings:?} {one:?}")
        };
        file.entries().iter().map(of_entry).collect()
    }

    #[test]
    fn ok_files_on_disk_are_read_as_those_in_memory() {
        let path = tempfile::NamedTempFile::new().unwrap();
        let compare = |bytes: &[u8]| {
            std::fs::write(path.path(), bytes).unwrap();
            let memory = contents(open(bytes));
            for count in [1, 1000] {
                let file = on_disk(path.path(), count);
                let is_on_disk = |file: &RecordFile| matches!(file.store, Store::Disk(_));
                assert!(file.as_ref().map_or(true, is_on_disk));
                assert_eq!(contents(file), memory);
            }
            memory
        };
        let mut random = fastrand::Rng::with_seed(3);
        for block in [1, 7, 1000, 1500, 70_000, 100_000] {
            let mut bytes = array("PORO", "REAL", 4, &reals(80_000), block);
            bytes.extend(array("NOTHING", "INTE", 4, &[], 1000));
            bytes.extend(array("TEXT", "C012", 12, b"abc         defghijklmno", 105));
            bytes.extend(array("ENDSOL", "MESS", 0, &[], 1));
            let whole = compare(&bytes);
            assert_eq!(whole.len(), 4, "{block}");
            assert!(whole[0].contains("79999.0") && whole[2].contains("defghijklmno"));
            for _ in 0..20 {
                let mut damaged = bytes.clone();
                let at = match random.bool() {
                    true => random.usize(..100),
                    false => random.usize(..bytes.len()),
                };
                damaged[at] = damaged[at].wrapping_add(random.u8(1..));
                damaged.truncate(
                    random
                        .usize(bytes.len() / 2..2 * bytes.len())
                        .min(bytes.len()),
                );
                compare(&damaged);
            }
        }
        // Blocks of other sizes that together take as many bytes.
        let halves = [
            array("A", "REAL", 4, &reals(500), 500),
            array("A", "REAL", 4, &reals(1500), 1500),
        ];
        let mut odd = halves.map(|array| array[24..].to_vec()).concat();
        odd.splice(
            ..0,
            array("PORO", "REAL", 4, &reals(2000), 1000)[..24].to_vec(),
        );
        assert!(compare(&odd)[0].contains("1499.0"));
    }

    #[test]
    fn err_file_that_is_cut_off_or_written_anew_while_open() {
        let path = tempfile::NamedTempFile::new().unwrap();
        for (count, block) in [(1, 1000), (1000, 1000), (1, 700)] {
            let bytes = array("PORO", "REAL", 4, &reals(5000), block);
            std::fs::write(path.path(), &bytes).unwrap();
            let file = on_disk(path.path(), count).unwrap();
            let poro = file.entries()[0];
            assert_eq!(file.f32s(&poro).unwrap().len(), 5000);
            let in_memory = RecordFile::open(path.path()).unwrap();
            let writer = std::fs::OpenOptions::new().write(true).open(path.path());
            let writer = writer.unwrap();
            for (length, place) in [(9000, "byte 0x2328"), (100, "byte 0x64"), (3, "byte 0x3")] {
                writer.set_len(length).unwrap();
                let errors = [
                    file.f32s(&poro).unwrap_err(),
                    file.f32_at(&poro, 4999).unwrap_err(),
                ];
                for error in errors {
                    assert_eq!(error.kind, ErrorKind::Truncated);
                    assert!(error.message.contains("cut off at"), "{error}");
                }
                let error = file.f32s(&poro).unwrap_err().to_string();
                assert!(error.contains("PORO") && error.contains(place), "{error}");
            }
            let other = array("PERMX", "REAL", 4, &reals(6000), 1000);
            std::fs::write(path.path(), other).unwrap();
            let error = file.f32s(&poro).unwrap_err().to_string();
            assert!(error.contains("written anew"), "{error}");
            // What was read is whole.
            assert!(in_memory.f32s(&in_memory.entries()[0]).is_ok());
        }
    }

    #[test]
    fn ok_half_written_file_keeps_complete_arrays() {
        let mut bytes = array("SWAT", "REAL", 4, &reals(10), 1000);
        bytes.extend(array("SGAS", "REAL", 4, &reals(10), 1000));
        bytes.truncate(bytes.len() - 9);
        let mut warnings = Warnings::default();
        let kept = RecordFile::from_bytes_lenient(("CASE.INIT", bytes), &mut warnings).unwrap();
        assert_eq!(kept.entries().len(), 1);
        assert_eq!(warnings.iter().count(), 1);
    }
}
