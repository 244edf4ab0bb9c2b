//! The HDF5 files of a package: datasets as numbers.

use std::path::{Path, PathBuf};

use hdf5_reader::messages::datatype::Datatype;
use hdf5_reader::{Hdf5File, OpenOptions};

use super::arrays::Dataset;
use crate::bytes::FileBytes;
use crate::error::{At, ErrorKind, ParseError};

/// Most bytes that one of a compressed file stands for: deflate makes no more of it.
const MOST_OF_BYTE: u64 = 1032;

/// The files that the arrays of a package are in.
#[derive(Default)]
pub(super) struct Files {
    package: PathBuf,
    files: Vec<(String, Opened)>,
}

enum Opened {
    File(Box<Arrays>),
    Failed {
        kind: ErrorKind,
        path: PathBuf,
        why: String,
    },
}

struct Arrays {
    bytes: FileBytes,
    file: Hdf5File,
}

/// Bytes as the reader takes them.
struct Lent(FileBytes);

impl AsRef<[u8]> for Lent {
    fn as_ref(&self) -> &[u8] {
        self.0.bytes()
    }
}

impl Files {
    pub(super) fn new(package: &Path) -> Self {
        Self {
            package: package.to_owned(),
            files: Vec::new(),
        }
    }

    /// Adds the file that the object `proxy` stands for; one that cannot be opened is told once it is asked for.
    pub(super) fn add(&mut self, proxy: String, file: Result<FileBytes, ParseError>) {
        let opened = match file.and_then(open) {
            Ok(arrays) => Opened::File(Box::new(arrays)),
            Err(error) => Opened::Failed {
                kind: error.kind,
                path: error.path,
                why: error.message,
            },
        };
        self.files.push((proxy, opened));
    }

    /// The paths of the files that were opened.
    pub(super) fn paths(&self) -> impl Iterator<Item = &Path> {
        self.files.iter().filter_map(|(_, opened)| match opened {
            Opened::File(arrays) => Some(arrays.bytes.path()),
            Opened::Failed { .. } => None,
        })
    }

    /// The numbers of a dataset, of which there have to be `count`.
    pub(super) fn numbers(&self, dataset: &Dataset, count: usize) -> Result<Vec<f64>, ParseError> {
        self.read(dataset, Some(count))
    }

    /// The numbers of a dataset, however many.
    pub(super) fn any_count(&self, dataset: &Dataset) -> Result<Vec<f64>, ParseError> {
        self.read(dataset, None)
    }

    /// An error about a dataset.
    pub(super) fn error(
        &self,
        dataset: &Dataset,
        kind: ErrorKind,
        message: impl Into<String>,
    ) -> ParseError {
        let path = match self.find(dataset) {
            Ok(arrays) => arrays.bytes.path(),
            Err(_) => &self.package,
        };
        ParseError::of(kind, path, At::File, &dataset.name, message)
    }

    /// The error where memory does not hold so many numbers.
    pub(super) fn too_large(&self, count: usize) -> ParseError {
        let message = format!("{count} values are more than the memory holds");
        ParseError::of(ErrorKind::TooLarge, &self.package, At::File, "", message)
    }

    fn find(&self, dataset: &Dataset) -> Result<&Arrays, ParseError> {
        let named = self.files.iter().find(|(proxy, _)| *proxy == dataset.file);
        match named.or(self.files.first()) {
            Some((_, Opened::File(arrays))) => Ok(arrays),
            Some((_, Opened::Failed { kind, path, why })) => {
                let message = format!("{why}; the package has its arrays in that file");
                Err(ParseError::of(*kind, path, At::File, "", message))
            }
            None => {
                let message = format!(
                    "the package does not name the HDF5 file that has {}: export it again, with its .h5 file",
                    dataset.name
                );
                let kind = ErrorKind::NotFound;
                Err(ParseError::of(kind, &self.package, At::File, "", message))
            }
        }
    }

    fn read(&self, dataset: &Dataset, count: Option<usize>) -> Result<Vec<f64>, ParseError> {
        let arrays = self.find(dataset)?;
        let path = arrays.bytes.path();
        let error = |kind, message: String| {
            Err(ParseError::of(kind, path, At::File, &dataset.name, message))
        };
        let found = match arrays.file.dataset(&dataset.name) {
            Ok(found) => found,
            Err(why) => return error(kind_of(&why), sentence(&why)),
        };
        let there = found.num_elements().unwrap_or(u64::MAX);
        if let Some(count) = count.filter(|count| *count as u64 != there) {
            let message = format!("expected {count} values, found {there}");
            return error(ErrorKind::WrongCount, message);
        }
        let Some(number) = Number::of(found.dtype()) else {
            let message = format!("has values of the type {:?}, not numbers", found.dtype());
            return error(ErrorKind::WrongType, message);
        };
        let most = (arrays.bytes.bytes().len() as u64).saturating_mul(MOST_OF_BYTE);
        if there.saturating_mul(number.size() as u64) > most {
            let message = format!("a file of that size cannot hold {there} values");
            return error(ErrorKind::TooLarge, message);
        }
        match found.read_native_bytes() {
            Ok(bytes) => number.values(&bytes).map_or_else(
                || error(ErrorKind::TooLarge, "is more than the memory holds".into()),
                Ok,
            ),
            Err(why) => error(kind_of(&why), sentence(&why)),
        }
    }
}

fn kind_of(error: &hdf5_reader::error::Error) -> ErrorKind {
    use hdf5_reader::error::Error;
    match error {
        Error::DatasetNotFound(_) | Error::GroupNotFound(_) => ErrorKind::MissingKeyword,
        Error::ResourceLimit(_) => ErrorKind::TooLarge,
        Error::Context { source, .. } => kind_of(source),
        _ => ErrorKind::Malformed,
    }
}

/// What is wrong, without the name of the dataset, which stands before it.
fn sentence(error: &hdf5_reader::error::Error) -> String {
    match error {
        hdf5_reader::error::Error::Context { source, .. } => sentence(source),
        error => format!("cannot be read: {error}"),
    }
}

fn open(bytes: FileBytes) -> Result<Arrays, ParseError> {
    let most = (bytes.bytes().len() as u64).saturating_mul(MOST_OF_BYTE);
    let most = usize::try_from(most).unwrap_or(usize::MAX);
    // Arrays are read whole and once: what is kept of them is kept as values of a case.
    let options = OpenOptions::default()
        .with_chunk_cache_bytes(0)
        .with_max_read_bytes(most)
        .with_max_chunk_bytes(most);
    match Hdf5File::from_owner(Lent(bytes.clone()), options) {
        Ok(file) => Ok(Arrays { bytes, file }),
        Err(why) => {
            let message = format!("is no HDF5 file that can be read: {why}");
            let kind = ErrorKind::NotThisFormat;
            Err(ParseError::of(kind, bytes.path(), At::File, "", message))
        }
    }
}

/// Types of numbers.
#[derive(Clone, Copy)]
enum Number {
    F32,
    F64,
    Signed(usize),
    Unsigned(usize),
}

impl Number {
    fn of(datatype: &Datatype) -> Option<Self> {
        match datatype {
            Datatype::FloatingPoint { size: 4, .. } => Some(Self::F32),
            Datatype::FloatingPoint { size: 8, .. } => Some(Self::F64),
            Datatype::FixedPoint {
                size: size @ (1 | 2 | 4 | 8),
                signed,
                ..
            } => Some(match signed {
                true => Self::Signed(usize::from(*size)),
                false => Self::Unsigned(usize::from(*size)),
            }),
            // Truth values.
            Datatype::Enum { base, .. } => Self::of(base),
            _ => None,
        }
    }

    fn size(self) -> usize {
        match self {
            Self::F32 => 4,
            Self::F64 => 8,
            Self::Signed(size) | Self::Unsigned(size) => size,
        }
    }

    /// The numbers of bytes in the order of this machine; `None` where memory does not hold them.
    fn values(self, bytes: &[u8]) -> Option<Vec<f64>> {
        match self {
            Self::F32 => each(bytes, |b| f64::from(f32::from_ne_bytes(b))),
            Self::F64 => each(bytes, f64::from_ne_bytes),
            Self::Signed(1) => each(bytes, |b| f64::from(i8::from_ne_bytes(b))),
            Self::Signed(2) => each(bytes, |b| f64::from(i16::from_ne_bytes(b))),
            Self::Signed(4) => each(bytes, |b| f64::from(i32::from_ne_bytes(b))),
            Self::Signed(_) => each(bytes, |b| i64::from_ne_bytes(b) as f64),
            Self::Unsigned(1) => each(bytes, |b| f64::from(u8::from_ne_bytes(b))),
            Self::Unsigned(2) => each(bytes, |b| f64::from(u16::from_ne_bytes(b))),
            Self::Unsigned(4) => each(bytes, |b| f64::from(u32::from_ne_bytes(b))),
            Self::Unsigned(_) => each(bytes, |b| u64::from_ne_bytes(b) as f64),
        }
    }
}

fn each<const N: usize>(bytes: &[u8], value: impl Fn([u8; N]) -> f64) -> Option<Vec<f64>> {
    let (numbers, _) = bytes.as_chunks::<N>();
    let mut values = Vec::new();
    values.try_reserve_exact(numbers.len()).ok()?;
    values.extend(numbers.iter().map(|number| value(*number)));
    Some(values)
}
