//! Regular volumes, as their files say them: seismic and images, to be shown beside a reservoir.
//!
//! [`open`] reads what a file says of its samples: how many there are, where they are, of which type. The values are
//! read on demand, in regions ([`VolumeFile::f32s`]); nothing holds the whole volume. Files are told by what is in them,
//! then by their names.
//!
//! | format | module |
//! | --- | --- |
//! | SEG-Y rev 0 to 2 | [`segy`] |
//! | NRRD (`.nrrd`, `.nhdr`) | [`nrrd`] |
//! | MetaImage (`.mha`, `.mhd`) | [`metaimage`] |
//! | VTK ImageData (`.vti`) | [`vti`] |
//! | raw samples with a description | [`raw`] |
//!
//! Memory: a header of at most 1 MiB; of SEG-Y up to 200 bytes for each trace, which is less than a trace takes; of samples
//! written as text up to 4 bytes for each of the file's, and of compressed ones one block. All else is buffers, and the
//! regions that the caller asks for. A few compressed bytes, and few traces far apart, may stand for many samples: at most
//! 1040 for a byte, and 16 places of a lattice for each trace.
//!
//! ```
//! use strataray_parsers::volume::{self, Options, Region};
//!
//! # fn main() -> Result<(), strataray_parsers::ParseError> {
//! let text = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 1\nspacings: 1 1 4\nencoding: ascii\n\n1 2 3 4\n";
//! let volume = volume::from_bytes(("A.nrrd", text), &Options::default())?;
//! assert_eq!(volume.lattice.dims, [2, 2, 1]);
//! let row = Region { start: [0, 1, 0], size: [2, 1, 1] };
//! assert_eq!(volume.f32s(row)?, [3.0, 4.0]);
//! # Ok(())
//! # }
//! ```

mod detached;
mod fields;
mod lattice;
pub mod metaimage;
pub mod nrrd;
pub mod raw;
mod sample;
pub mod segy;
mod source;
mod store;
pub mod vti;
mod write;
mod xml;

use std::path::Path;

use crate::bytes::FileBytes;
use crate::error::{At, ErrorKind, ParseError, Warnings};

pub use lattice::{Lattice, Region};
pub use raw::RawLayout;
pub use sample::{ByteOrder, SampleType, Value};
pub use segy::{SegyLayout, SegyOptions, SegyWriter, Survey, Vertical};
pub use write::Contents;

use sample::Coding;
use segy::Traces;
use source::Source;
use store::Store;

/// What is read of a file, and how, where the file does not say.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// Which of several numbers of a sample is read, from 0.
    pub component: usize,
    /// Which of several arrays of a VTK file is read; without it the active scalars, or the first one.
    pub array: Option<String>,
    /// What stands for no value, where the file names nothing.
    pub null: Option<f64>,
    /// The layout of a file without a header.
    pub raw: Option<RawLayout>,
    /// Where things stand in a SEG-Y file.
    pub segy: SegyOptions,
}

/// A format of volumes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// SEG-Y.
    Segy,
    /// NRRD.
    Nrrd,
    /// MetaImage.
    MetaImage,
    /// VTK ImageData.
    Vti,
    /// Samples without a header.
    Raw,
}

impl Format {
    /// The name that people know.
    pub fn name(self) -> &'static str {
        match self {
            Self::Segy => "SEG-Y",
            Self::Nrrd => "NRRD",
            Self::MetaImage => "MetaImage",
            Self::Vti => "VTK ImageData",
            Self::Raw => "raw",
        }
    }
}

/// What an axis of the lattice is, as far as the file says it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Axis {
    /// Name, such as `inline`; empty where the file has none.
    pub name: String,
    /// Unit of lengths along it; empty where the file has none.
    pub unit: String,
}

/// A volume: where its samples are, of which type, and how they are read.
#[derive(Debug)]
pub struct VolumeFile {
    /// The format.
    pub format: Format,
    /// Where the samples are.
    pub lattice: Lattice,
    /// The axes i, j and k.
    pub axes: [Axis; 3],
    /// The frame of places, such as `left-posterior-superior`; empty where the file names none.
    pub frame: String,
    /// Type of the samples.
    pub sample: SampleType,
    /// Order of the bytes of a sample.
    pub byte_order: ByteOrder,
    /// What stands for no value; it is read as NaN.
    pub null: Option<f64>,
    /// What the values are; empty where the file has no name for them.
    pub name: String,
    /// Unit of the values; empty where the file has none.
    pub unit: String,
    /// Lines of the header that are for people.
    pub header: Vec<String>,
    /// What a SEG-Y file says beside that.
    pub survey: Option<Survey>,
    /// What is odd, and what was done about it.
    pub notes: Warnings,
    source: Source,
    samples: Samples,
}

#[derive(Debug)]
enum Samples {
    /// i fastest, then j, then k: the bytes, and how far samples are apart, and where the first one begins.
    Rows {
        store: Store,
        stride: usize,
        first: u64,
    },
    Traces(Traces),
}

/// Bytes that are decoded at a time.
const CHUNK: usize = 1 << 20;

impl VolumeFile {
    /// A volume of which nothing but lattice, type and samples is known.
    fn new(
        format: Format,
        source: &Source,
        lattice: Lattice,
        coding: Coding,
        samples: Samples,
    ) -> Self {
        Self {
            format,
            lattice,
            axes: Default::default(),
            frame: String::new(),
            sample: coding.kind,
            byte_order: coding.order,
            null: None,
            name: String::new(),
            unit: String::new(),
            header: Vec::new(),
            survey: None,
            notes: Warnings::default(),
            source: source.clone(),
            samples,
        }
    }

    /// The path that was opened, or the name that was given.
    pub fn path(&self) -> &Path {
        self.source.path()
    }

    /// The axis across which slabs are read fastest: 2 (k) where rows of the file run along i.
    pub fn slow_axis(&self) -> usize {
        match &self.samples {
            Samples::Rows { .. } => 2,
            Samples::Traces(traces) => traces.slow_axis(),
        }
    }

    /// Regions that cover the volume in the order in which it is read fastest, each of whole planes across
    /// [`Self::slow_axis`] and of at most `most` samples, or of one plane where that has more.
    pub fn slabs(&self, most: usize) -> impl Iterator<Item = Region> + use<> {
        self.lattice.region().slabs(self.slow_axis(), most)
    }

    /// Values of a region, i fastest, then j, then k. NaN where there is none.
    ///
    /// Compressed samples are read forward: a region before the last one that was read begins at the start again.
    ///
    /// # Errors
    /// When the region is not within the volume, there is not enough memory, or the samples are damaged or cut off.
    pub fn f32s(&self, region: Region) -> Result<Vec<f32>, ParseError> {
        self.values(region)
    }

    /// As [`Self::f32s`], in 8 bytes.
    ///
    /// # Errors
    /// As [`Self::f32s`].
    pub fn f64s(&self, region: Region) -> Result<Vec<f64>, ParseError> {
        self.values(region)
    }

    fn values<T: Value>(&self, region: Region) -> Result<Vec<T>, ParseError> {
        self.check(region)?;
        let count = region.samples();
        let mut values = Vec::new();
        // A plain allocation would end the process where memory is short.
        values.try_reserve_exact(count).map_err(|_| {
            let message = format!("{count} values need more memory than there is: ask for fewer");
            self.error(ErrorKind::TooLarge, message)
        })?;
        values.resize(count, T::NONE);
        self.read(region, &mut values)?;
        Ok(values)
    }

    /// As [`Self::f32s`] or [`Self::f64s`], into memory of the caller.
    ///
    /// # Errors
    /// As these; also when `out` has another length than the region has samples.
    pub fn read<T: Value>(&self, region: Region, out: &mut [T]) -> Result<(), ParseError> {
        self.check(region)?;
        if out.len() != region.samples() {
            let message = format!("{} values do not fit in {}", region.samples(), out.len());
            return Err(self.error(ErrorKind::WrongCount, message));
        }
        match &self.samples {
            Samples::Rows {
                store,
                stride,
                first,
            } => self.read_rows(store, *stride, *first, region, out)?,
            Samples::Traces(traces) => traces.read(&self.source, self.coding(), region, out)?,
        }
        if let Some(null) = self.null.and_then(|null| self.coding().rounded(null)) {
            let is_null = |value: &&mut T| value.wide() == T::of(null).wide();
            for value in out.iter_mut().filter(is_null) {
                *value = T::NONE;
            }
        }
        Ok(())
    }

    fn read_rows<T: Value>(
        &self,
        store: &Store,
        stride: usize,
        first: u64,
        region: Region,
        out: &mut [T],
    ) -> Result<(), ParseError> {
        let [ni, nj, _] = self.lattice.dims;
        let [i, j, k] = region.start;
        let [rows, planes] = [region.size[1], region.size[2]];
        // Whole rows, and whole planes, are read as one.
        let (run, runs) = match region.size {
            [i, j, _] if i == ni && j == nj => (out.len(), 1),
            [i, _, _] if i == ni => (i * rows, planes),
            [i, _, _] => (i, rows * planes),
        };
        if run == 0 {
            return Ok(());
        }
        let per_plane = runs / planes.max(1);
        let size = self.sample.size();
        let mut bytes = Vec::new();
        for (n, values) in out.chunks_mut(run).enumerate() {
            let (plane, row) = match per_plane {
                0 => (0, 0),
                per_plane => (n / per_plane, n % per_plane),
            };
            let mut sample = ((k + plane) * nj + j + row) * ni + i;
            for values in values.chunks_mut((CHUNK / stride).max(1)) {
                bytes.resize((values.len() - 1) * stride + size, 0);
                store.read(first + (sample * stride) as u64, &mut bytes)?;
                self.coding().decode(&bytes, stride, values);
                sample += values.len();
            }
        }
        Ok(())
    }

    /// Smallest and largest finite value, and how many samples have none; `None` where no sample has a value.
    ///
    /// # Errors
    /// As [`Self::f32s`].
    pub fn range(&self) -> Result<Option<Range>, ParseError> {
        let mut range = Range {
            low: f64::INFINITY,
            high: f64::NEG_INFINITY,
            absent: 0,
        };
        for slab in self.slabs(CHUNK) {
            let values = self.f64s(slab)?;
            for value in &values {
                if value.is_finite() {
                    range.low = range.low.min(*value);
                    range.high = range.high.max(*value);
                } else {
                    range.absent += 1;
                }
            }
        }
        Ok((range.low <= range.high).then_some(range))
    }

    fn coding(&self) -> Coding {
        Coding {
            kind: self.sample,
            order: self.byte_order,
        }
    }

    fn check(&self, region: Region) -> Result<(), ParseError> {
        if region.is_within(self.lattice.dims) {
            return Ok(());
        }
        let Region { start, size } = region;
        let dims = self.lattice.dims;
        let message = format!("{size:?} samples from {start:?} are not within {dims:?}");
        Err(self.error(ErrorKind::WrongCount, message))
    }

    fn error(&self, kind: ErrorKind, message: String) -> ParseError {
        self.source.error(kind, At::File, "", message)
    }
}

/// What values there are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Smallest finite value.
    pub low: f64,
    /// Largest finite value.
    pub high: f64,
    /// Samples without a finite value.
    pub absent: u64,
}

/// Opens a file; files that it names are looked for from its folder on.
///
/// # Errors
/// When the file cannot be read, is of no format that is known, or breaks the rules of its format.
pub fn open(path: &Path, options: &Options) -> Result<VolumeFile, ParseError> {
    read(&Source::open(path)?, options)
}

/// As [`open`], for a file that is in memory; one that names others is refused.
///
/// # Errors
/// As [`open`].
pub fn from_bytes(file: impl Into<FileBytes>, options: &Options) -> Result<VolumeFile, ParseError> {
    read(&Source::from(file.into()), options)
}

/// The format of a file; `None` where it is none of those that are read.
///
/// # Errors
/// When the file cannot be read.
pub fn sniff(path: &Path) -> Result<Option<Format>, ParseError> {
    let source = Source::open(path)?;
    let head = source.head()?;
    Ok(format(&source, &head))
}

/// True where a file that can be read is a volume.
pub(crate) fn is_volume(path: &Path) -> bool {
    let Ok(source) = Source::open(path) else {
        return false;
    };
    let Ok(head) = source.head() else {
        return false;
    };
    let start = head.trim_ascii_start();
    match format(&source, &head) {
        Some(Format::Raw) => !start.starts_with(b"{") || raw::is_layout(start),
        format => format.is_some(),
    }
}

fn read(source: &Source, options: &Options) -> Result<VolumeFile, ParseError> {
    let head = source.head()?;
    let format = match options.raw {
        Some(_) => Some(Format::Raw),
        None => format(source, &head),
    };
    let mut volume = match format {
        Some(Format::Segy) => segy::read(source, &options.segy),
        Some(Format::Nrrd) => nrrd::read(source, &head, options),
        Some(Format::MetaImage) => metaimage::read(source, &head, options),
        Some(Format::Vti) => vti::read(source, options),
        Some(Format::Raw) => raw::read(source, &head, options),
        None => Err(source.error(ErrorKind::NotThisFormat, At::File, "", UNKNOWN)),
    }?;
    volume.null = volume.null.or(options.null);
    if !volume.lattice.is_finite() {
        let message = "origin and spacing must be finite numbers: correct the header";
        return Err(source.error(ErrorKind::BadValue, At::File, "", message));
    }
    Ok(volume)
}

const UNKNOWN: &str = "is no volume that is read: SEG-Y, NRRD, MetaImage and VTK ImageData are, and raw samples whose size and type are given";

/// By what is in the file, then by its name.
fn format(source: &Source, head: &[u8]) -> Option<Format> {
    let start = head.trim_ascii_start();
    if head.starts_with(b"NRRD") {
        return Some(Format::Nrrd);
    }
    if metaimage::is_header(start) {
        return Some(Format::MetaImage);
    }
    if vti::is_header(start) {
        return Some(Format::Vti);
    }
    if raw::is_header(start) {
        return Some(Format::Raw);
    }
    let extension = source.path().extension().and_then(|e| e.to_str());
    let extension = extension.unwrap_or_default().to_ascii_lowercase();
    let is_named = matches!(extension.as_str(), "sgy" | "segy" | "seg-y");
    if is_named || segy::is_header(source, head) {
        return Some(Format::Segy);
    }
    match extension.as_str() {
        "raw" | "bin" | "vol" => Some(Format::Raw),
        _ => None,
    }
}
