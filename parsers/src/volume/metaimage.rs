//! MetaImage: `.mha`, or a header `.mhd` with its samples in other files.
//!
//! Read are samples as they are, as text, and compressed by zlib; in the file (`LOCAL`), in another one, in a list of
//! files (`LIST`) or in numbered ones. The rows of `TransformMatrix` are the directions of the axes. The facts are those
//! of ITK's documentation of MetaIO.

use std::io::{self, Write};
use std::path::PathBuf;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::detached::{self, Placing};
use super::fields::{Field, Fields, lines};
use super::lattice::Lattice;
use super::sample::{ByteOrder, Coding, SampleType};
use super::source::Source;
use super::store::{self, Packing, Store};
use super::write::{self, Contents};
use super::{Axis, Format, Options, Samples, VolumeFile};
use crate::error::{At, ErrorKind, ParseError};

/// Types by the names of the format.
const TYPES: [(&str, SampleType); 12] = [
    ("MET_CHAR", SampleType::I8),
    ("MET_UCHAR", SampleType::U8),
    ("MET_SHORT", SampleType::I16),
    ("MET_USHORT", SampleType::U16),
    ("MET_INT", SampleType::I32),
    ("MET_UINT", SampleType::U32),
    ("MET_LONG", SampleType::I32),
    ("MET_ULONG", SampleType::U32),
    ("MET_LONG_LONG", SampleType::I64),
    ("MET_ULONG_LONG", SampleType::U64),
    ("MET_FLOAT", SampleType::F32),
    ("MET_DOUBLE", SampleType::F64),
];

/// True where a file begins as a header does.
pub(super) fn is_header(start: &[u8]) -> bool {
    let line = start
        .split(|byte| *byte == b'\n')
        .next()
        .unwrap_or_default();
    let key = line.split(|byte| *byte == b'=').next().unwrap_or_default();
    let key = key.trim_ascii();
    line.contains(&b'=') && (key == b"ObjectType" || key == b"NDims" || key == b"Comment")
}

struct Header<'a> {
    fields: Fields<'a>,
    /// Files that stand line by line behind `ElementDataFile = LIST`.
    list: Vec<String>,
    /// Where samples begin.
    end: u64,
}

fn header<'a>(source: &'a Source, head: &[u8]) -> Result<Header<'a>, ParseError> {
    let mut all: Vec<Field> = Vec::new();
    let mut rest = lines(head).enumerate();
    let mut end = None;
    for (n, (text, behind)) in rest.by_ref() {
        if text.trim().is_empty() {
            continue;
        }
        let Some((key, value)) = text.split_once('=') else {
            let at = At::Line {
                line: n + 1,
                column: 1,
            };
            let message = "expected 'Key = value'; ElementDataFile ends the header";
            return Err(source.error(ErrorKind::Malformed, at, "MetaImage", message));
        };
        all.push(Field {
            key: key.trim().to_owned(),
            value: value.trim().to_owned(),
            line: n + 1,
        });
        if key.trim() == "ElementDataFile" {
            end = Some(behind);
            break;
        }
    }
    let Some(end) = end else {
        let message = "is missing: it ends the header and says where the samples are";
        let kind = ErrorKind::MissingKeyword;
        return Err(source.error(kind, At::File, "ElementDataFile", message));
    };
    let list = rest.map(|(_, (text, _))| text.trim().to_owned());
    let is_list = all
        .last()
        .is_some_and(|field| field.value.starts_with("LIST"));
    Ok(Header {
        list: match is_list {
            true => list.filter(|name| !name.is_empty()).collect(),
            false => Vec::new(),
        },
        fields: Fields { source, all },
        end,
    })
}

fn is_true(fields: &Fields, keys: &[&str], default: bool) -> bool {
    let found = keys.iter().find_map(|key| fields.find(key));
    found.map_or(default, |field| {
        matches!(field.value.as_bytes().first(), Some(b'T' | b't' | b'1'))
    })
}

/// The numbers of the first of `keys` that is there.
fn first_of(fields: &Fields, keys: &[&str], count: usize) -> Result<Option<Vec<f64>>, ParseError> {
    let key = keys.iter().find(|key| fields.find(key).is_some());
    match key {
        Some(key) => fields.some(key, count),
        None => Ok(None),
    }
}

fn lattice(fields: &Fields, dims: [usize; 3], axes: usize) -> Result<Lattice, ParseError> {
    let padded = |numbers: Option<Vec<f64>>, none: f64| {
        let mut padded = [none; 3];
        for (value, read) in padded.iter_mut().zip(numbers.into_iter().flatten()) {
            *value = read;
        }
        padded
    };
    let spacing = first_of(fields, &["ElementSpacing", "ElementSize"], axes)?;
    let origin = first_of(fields, &["Offset", "Position", "Origin"], axes)?;
    let spacing = padded(spacing, 1.0);
    let mut lattice = Lattice::straight(dims, padded(origin, 0.0), spacing);
    let keys = ["TransformMatrix", "Rotation", "Orientation"];
    if let Some(matrix) = first_of(fields, &keys, axes * axes)? {
        for (axis, row) in matrix.chunks(axes).enumerate() {
            for (value, direction) in lattice.edges[axis].iter_mut().zip(row) {
                *value = direction * spacing[axis];
            }
        }
    }
    Ok(lattice)
}

/// Files of `ElementDataFile`; none where the samples are in this one.
fn data_files(header: &Header, field: &Field) -> Result<Option<Vec<PathBuf>>, ParseError> {
    let words: Vec<&str> = field.value.split_whitespace().collect();
    let numbers: Vec<i64> = words.iter().skip(1).flat_map(|w| w.parse().ok()).collect();
    let names = match (&words[..], &numbers[..]) {
        (["LOCAL" | "Local" | "local"], _) => return Ok(None),
        (["LIST", ..], _) => header.list.clone(),
        ([pattern, _, _, ..], [first, last, step @ ..]) if pattern.contains('%') => {
            let range = [*first, *last, step.first().copied().unwrap_or(1)];
            detached::numbered(pattern, range).ok_or_else(|| {
                let message = "expected a pattern such as slice%03d.raw, and first, last and step";
                header.fields.error(ErrorKind::BadValue, field, message)
            })?
        }
        _ => vec![field.value.clone()],
    };
    let at = At::Line {
        line: field.line,
        column: 1,
    };
    detached::files(header.fields.source, &names, at, "ElementDataFile").map(Some)
}

fn samples(header: &Header, count: u64, kind: SampleType) -> Result<Store, ParseError> {
    let fields = &header.fields;
    let field = fields.need("ElementDataFile")?;
    let files = data_files(header, field)?;
    let skip = fields.whole::<i64>("HeaderSize", 0)?;
    let is_packed = is_true(fields, &["CompressedData"], false);
    let placing = Placing {
        lines: 0,
        bytes: match files {
            // What counts within this file is where the header ends.
            None => Some(0),
            Some(_) => u64::try_from(skip).ok(),
        },
        packing: is_packed.then_some(Packing::Zlib),
    };
    let length = count * kind.size() as u64;
    if is_true(fields, &["BinaryData"], true) {
        return match files {
            Some(files) => detached::parts(fields.source, &files, length, placing),
            None => detached::store(fields.source, header.end, length, placing),
        };
    }
    let (source, start) = match files.as_deref() {
        None => (fields.source.clone(), header.end),
        Some([file]) => (Source::open(file)?, 0),
        Some(_) => {
            let message = "text in several files is not read: join them";
            return Err(fields.error(ErrorKind::Unsupported, field, message));
        }
    };
    store::numbers(&source, [start, source.length()], count, kind)
}

fn sample_type(fields: &Fields) -> Result<SampleType, ParseError> {
    let field = fields.need("ElementType")?;
    let name = field.value.trim_end_matches("_ARRAY");
    let known = TYPES.iter().find(|(known, _)| *known == name);
    known.map(|(_, kind)| *kind).ok_or_else(|| {
        let message =
            format!("samples of the type {name} are not read: write the file as MET_FLOAT");
        fields.error(ErrorKind::Unsupported, field, message)
    })
}

pub(super) fn read(
    source: &Source,
    head: &[u8],
    options: &Options,
) -> Result<VolumeFile, ParseError> {
    let header = header(source, head)?;
    let fields = &header.fields;
    let field = fields.need("DimSize")?;
    let sizes: Vec<u64> = fields.numbers(field)?;
    let axes = fields.whole::<usize>("NDims", sizes.len())?;
    if axes != sizes.len() || !(1..=3).contains(&axes) {
        let message = format!("expected the sizes of up to 3 axes, as many as NDims, {axes}");
        return Err(fields.error(ErrorKind::Unsupported, field, message));
    }
    let (dims, count) = fields.dims(field, &sizes)?;
    let components = fields.whole::<usize>("ElementNumberOfChannels", 1)?;
    fields.check_component(field, options.component, components)?;
    let numbers = count.checked_mul(components as u64);
    let numbers = numbers.filter(|n| n.checked_mul(8).is_some_and(|bytes| bytes < 1 << 62));
    let numbers = numbers.ok_or_else(|| {
        let message = "no volume of so many components can be addressed";
        fields.error(ErrorKind::TooLarge, field, message)
    })?;
    let kind = sample_type(fields)?;
    let store = samples(&header, numbers, kind)?;
    let keys = ["BinaryDataByteOrderMSB", "ElementByteOrderMSB"];
    let is_big = is_true(fields, &keys, false) && !matches!(store, Store::Memory(_));
    let coding = Coding {
        kind,
        order: if is_big {
            ByteOrder::Big
        } else {
            ByteOrder::Little
        },
    };
    let rows = Samples::Rows {
        store,
        stride: kind.size() * components,
        first: (options.component * kind.size()) as u64,
    };
    let lattice = lattice(fields, dims, axes)?;
    let mut volume = VolumeFile::new(Format::MetaImage, source, lattice, coding, rows);
    if components > 1 {
        let message = format!(
            "has {components} components: {} (from 0) is read",
            options.component
        );
        volume.notes.push(source.path(), At::File, message);
    }
    volume.axes = std::array::from_fn(|_| Axis {
        name: String::new(),
        unit: fields.text("DistanceUnits").to_owned(),
    });
    volume.frame = fields.text("AnatomicalOrientation").to_owned();
    volume.name = fields.text("Name").to_owned();
    volume.header = match fields.text("Comment") {
        "" => Vec::new(),
        comment => vec![comment.to_owned()],
    };
    Ok(volume)
}

/// Writes a volume with its samples in the same file (`.mha`), as they are or compressed by zlib; `values` are in natural
/// order, i fastest.
///
/// # Errors
/// When writing fails, the format has no such type, the edges are not at right angles, or the values are not as many as
/// the samples, or none of the type.
pub fn write<W: Write>(
    mut out: W,
    contents: &Contents,
    is_packed: bool,
    values: impl IntoIterator<Item = f64>,
) -> io::Result<W> {
    let named = TYPES.iter().find(|(_, kind)| *kind == contents.sample);
    let (kind, _) = named.ok_or_else(|| contents.refuse_type("MetaImage"))?;
    let lattice = &contents.lattice;
    let matrix = write::directions(lattice, "MetaImage")?;
    let [ni, nj, nk] = lattice.dims;
    let words = |v: &[f64]| v.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let is = |flag: bool| if flag { "True" } else { "False" };
    write!(
        out,
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = {}\nCompressedData = {}\n\
         TransformMatrix = {}\nOffset = {}\nElementSpacing = {}\nDimSize = {ni} {nj} {nk}\n",
        is(contents.byte_order == ByteOrder::Big),
        is(is_packed),
        words(matrix.as_flattened()),
        words(&lattice.origin),
        words(&lattice.spacing()),
    )?;
    if !contents.name.is_empty() {
        writeln!(out, "Name = {}", write::one_line(&contents.name))?;
    }
    if !is_packed {
        write!(out, "ElementType = {kind}\nElementDataFile = LOCAL\n")?;
        write::samples(&mut out, contents, values)?;
        return Ok(out);
    }
    // The length stands before the bytes.
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::default());
    write::samples(&mut packed, contents, values)?;
    let packed = packed.finish()?;
    write!(
        out,
        "CompressedDataSize = {}\nElementType = {kind}\nElementDataFile = LOCAL\n",
        packed.len()
    )?;
    out.write_all(&packed)?;
    Ok(out)
}
