//! Raw samples without a header: their layout is given, or stands beside them in a JSON file.
//!
//! The file of the layout is opened, or `A.json` or `A.raw.json` is found beside `A.raw`:
//!
//! ```json
//! {"size": [256, 256, 128], "type": "u8", "spacing": [1, 1, 2], "origin": [0, 0, 0],
//!  "endian": "little", "skip": 0, "null": 255, "name": "density", "unit": "g/cm3", "file": "A.raw"}
//! ```
//!
//! `size` and `type` are needed. Types are those of [`SampleType::name`].

use std::str::FromStr;

use serde_json::{Map, Value};

use super::detached::{self, Placing};
use super::lattice::{self, Lattice};
use super::sample::{ByteOrder, Coding, SampleType};
use super::source::Source;
use super::{Format, Options, Samples, VolumeFile};
use crate::error::{At, ErrorKind, ParseError};

/// Where the samples of a file without a header are, and of which type: `256x256x128:u8:1,1,2:0,0,0`, of which spacing
/// and origin may be left out. The type may end in `be` or `le` for the order of bytes, which is little-endian otherwise.
///
/// ```
/// use strataray_parsers::volume::{ByteOrder, RawLayout};
///
/// let layout: RawLayout = "4x3x2:i16be:1,1,2.5".parse()?;
/// assert_eq!((layout.size, layout.byte_order), ([4, 3, 2], ByteOrder::Big));
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RawLayout {
    /// Samples along i, j and k.
    pub size: [u64; 3],
    /// Type of the samples.
    pub sample: SampleType,
    /// Order of their bytes.
    pub byte_order: ByteOrder,
    /// Steps along i, j and k.
    pub spacing: [f64; 3],
    /// Place of the first sample.
    pub origin: [f64; 3],
    /// Bytes before the samples.
    pub skip: u64,
}

/// Type and order of bytes of a name such as `i16be`.
fn coding(name: &str) -> Option<Coding> {
    let (kind, order) = match (name.strip_suffix("be"), name.strip_suffix("le")) {
        (Some(kind), _) => (kind, ByteOrder::Big),
        (_, Some(kind)) => (kind, ByteOrder::Little),
        _ => (name, ByteOrder::Little),
    };
    let kind = SampleType::from_name(kind)?;
    Some(Coding { kind, order })
}

fn names() -> String {
    SampleType::ALL.map(SampleType::name).join(", ")
}

/// Three numbers.
fn three<T: FromStr>(text: &str, separator: char) -> Option<[T; 3]> {
    let numbers: Option<Vec<T>> = text
        .split(separator)
        .map(|w| w.trim().parse().ok())
        .collect();
    numbers?.try_into().ok()
}

impl FromStr for RawLayout {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut words = text.split(':');
        let size = words.next().and_then(|word| three(word, 'x'));
        let size = size.ok_or_else(|| {
            format!("'{text}' is no layout such as 256x256x128:u8:1,1,2 (size, type, spacing)")
        })?;
        let name = words.next().unwrap_or_default();
        let coding = coding(name)
            .ok_or_else(|| format!("'{name}' is no type of samples: they are {}", names()))?;
        let mut layout = Self {
            size,
            sample: coding.kind,
            byte_order: coding.order,
            spacing: [1.0; 3],
            origin: [0.0; 3],
            skip: 0,
        };
        for numbers in [&mut layout.spacing, &mut layout.origin] {
            if let Some(word) = words.next() {
                *numbers = three(word, ',')
                    .ok_or_else(|| format!("'{word}' is not three numbers such as 1,1,2"))?;
            }
        }
        match words.next() {
            None => Ok(layout),
            Some(word) => Err(format!("'{word}' is behind size, type, spacing and origin")),
        }
    }
}

/// True where a file begins as a layout in JSON does.
pub(super) fn is_header(start: &[u8]) -> bool {
    let start = &start[..start.len().min(4096)];
    start.starts_with(b"{") && start.windows(6).any(|word| word == b"\"size\"")
}

/// True where a file begins as such a layout and says a type too: scenes are JSON with a size.
pub(super) fn is_layout(start: &[u8]) -> bool {
    let near = &start[..start.len().min(4096)];
    is_header(start) && near.windows(6).any(|word| word == b"\"type\"")
}

pub(super) fn read(
    source: &Source,
    head: &[u8],
    options: &Options,
) -> Result<VolumeFile, ParseError> {
    if let Some(layout) = options.raw {
        return volume(source, layout, source);
    }
    if is_header(head.trim_ascii_start()) {
        return described(source, head);
    }
    let path = source.path();
    let mut beside = path.as_os_str().to_owned();
    beside.push(".json");
    let beside = [path.with_extension("json"), beside.into()];
    let found = source
        .folder()
        .and_then(|_| beside.iter().find(|path| path.is_file()));
    let Some(found) = found else {
        let message = "raw samples say neither size nor type: give the layout, such as 256x256x128:u8:1,1,2, or put a JSON file beside them: {\"size\": [256, 256, 128], \"type\": \"u8\"}";
        return Err(source.error(ErrorKind::NotThisFormat, At::File, "", message));
    };
    let described_by = Source::open(found)?;
    let head = described_by.head()?;
    let description = Description::parse(&described_by, &head)?;
    description.volume(source)
}

fn described(source: &Source, head: &[u8]) -> Result<VolumeFile, ParseError> {
    let description = Description::parse(source, head)?;
    description.layout()?;
    let name = description.text("file")?;
    let names = name.map(|name| vec![name.to_owned()]).unwrap_or_default();
    let files = detached::files(source, &names, At::File, "file")?;
    match files.first() {
        Some(file) => description.volume(&Source::open(file)?),
        None => Err(description.error("file", "expected the name of a file")),
    }
}

/// A layout in JSON.
struct Description<'a> {
    source: &'a Source,
    keys: Map<String, Value>,
}

const KEYS: [&str; 10] = [
    "size", "type", "spacing", "origin", "endian", "skip", "null", "name", "unit", "file",
];

impl<'a> Description<'a> {
    fn parse(source: &'a Source, head: &[u8]) -> Result<Self, ParseError> {
        let keys: Map<String, Value> = serde_json::from_slice(head).map_err(|error| {
            let at = At::Line {
                line: error.line(),
                column: error.column(),
            };
            let message = format!("is no JSON object of a layout: {error}");
            source.error(ErrorKind::Malformed, at, "", message)
        })?;
        let description = Self { source, keys };
        let unknown = description
            .keys
            .keys()
            .find(|key| !KEYS.contains(&key.as_str()));
        match unknown {
            None => Ok(description),
            Some(key) => {
                let message = format!("is no key of a layout: they are {}", KEYS.join(", "));
                Err(description.error(key, message))
            }
        }
    }

    fn error(&self, key: &str, message: impl Into<String>) -> ParseError {
        self.source
            .error(ErrorKind::BadValue, At::File, key, message)
    }

    fn text(&self, key: &str) -> Result<Option<&str>, ParseError> {
        let value = self.keys.get(key);
        let text = value.map(|v| v.as_str().ok_or_else(|| self.error(key, "expected a text")));
        text.transpose()
    }

    fn numbers(&self, key: &str, default: [f64; 3]) -> Result<[f64; 3], ParseError> {
        let Some(value) = self.keys.get(key) else {
            return Ok(default);
        };
        let numbers = value.as_array().map(|all| all.iter().map(Value::as_f64));
        let numbers = numbers.and_then(Iterator::collect::<Option<Vec<_>>>);
        let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
        numbers.ok_or_else(|| self.error(key, "expected three numbers, such as [1, 1, 2]"))
    }

    fn layout(&self) -> Result<RawLayout, ParseError> {
        let size = self.numbers("size", [0.0; 3])?;
        if size.iter().any(|n| *n < 1.0 || n.fract() != 0.0) {
            return Err(self.error(
                "size",
                "expected three whole numbers, such as [256, 256, 128]",
            ));
        }
        let name = self.text("type")?.unwrap_or_default();
        let coding = coding(name).ok_or_else(|| {
            let message = format!("'{name}' is no type of samples: they are {}", names());
            self.error("type", message)
        })?;
        let order = match self.text("endian")? {
            None => coding.order,
            Some("little") => ByteOrder::Little,
            Some("big") => ByteOrder::Big,
            Some(_) => return Err(self.error("endian", "expected little or big")),
        };
        let skip = self.keys.get("skip").map(|skip| {
            skip.as_u64()
                .ok_or_else(|| self.error("skip", "expected a number of bytes"))
        });
        Ok(RawLayout {
            size: size.map(|n| n as u64),
            sample: coding.kind,
            byte_order: order,
            spacing: self.numbers("spacing", [1.0; 3])?,
            origin: self.numbers("origin", [0.0; 3])?,
            skip: skip.transpose()?.unwrap_or(0),
        })
    }

    fn volume(&self, samples: &Source) -> Result<VolumeFile, ParseError> {
        let mut volume = volume(self.source, self.layout()?, samples)?;
        volume.null = self.keys.get("null").and_then(Value::as_f64);
        volume.name = self.text("name")?.unwrap_or_default().to_owned();
        volume.unit = self.text("unit")?.unwrap_or_default().to_owned();
        Ok(volume)
    }
}

fn volume(header: &Source, layout: RawLayout, samples: &Source) -> Result<VolumeFile, ParseError> {
    let (dims, count) = lattice::samples(layout.size).ok_or_else(|| {
        let [ni, nj, nk] = layout.size;
        let message =
            format!("no volume of {ni} x {nj} x {nk} samples can be addressed on this machine");
        header.error(ErrorKind::TooLarge, At::File, "size", message)
    })?;
    let placing = Placing {
        lines: 0,
        bytes: Some(layout.skip),
        packing: None,
    };
    let length = count * layout.sample.size() as u64;
    let store = detached::store(samples, 0, length, placing)?;
    let rows = Samples::Rows {
        store,
        stride: layout.sample.size(),
        first: 0,
    };
    let coding = Coding {
        kind: layout.sample,
        order: layout.byte_order,
    };
    let lattice = Lattice::straight(dims, layout.origin, layout.spacing);
    let mut volume = VolumeFile::new(Format::Raw, samples, lattice, coding, rows);
    let left = samples
        .length()
        .saturating_sub(layout.skip.saturating_add(length));
    if left > 0 {
        let message = format!(
            "{left} bytes behind the samples are not read: look whether size and type are right"
        );
        volume.notes.push(samples.path(), At::File, message);
    }
    Ok(volume)
}
