//! NRRD: `.nrrd`, or a header `.nhdr` with its samples in other files.
//!
//! Read are the encodings raw, text and gzip; samples in the file, in another one (`data file`), in a list of files or in
//! numbered ones; `byte skip` and `line skip`; places by `space directions` and `space origin`, or by `spacings` and
//! `axis mins`. Of a fourth axis, the first or the last, one component is read. The facts are those of the definition of
//! the format by its authors (teem, `nrrd/format.html`).

use std::io::{self, Write};

use flate2::Compression;
use flate2::write::GzEncoder;

use super::detached::{self, Placing};
use super::fields::{Field, Fields, lines};
use super::lattice::Lattice;
use super::sample::{ByteOrder, Coding, SampleType};
use super::source::Source;
use super::store::{self, Packing, Store};
use super::write::{self, Contents};
use super::{Axis, Format, Options, Samples, VolumeFile};
use crate::error::{At, ErrorKind, ParseError};

struct Header<'a> {
    fields: Fields<'a>,
    /// Files that stand line by line at the end, of `data file: LIST`.
    list: Vec<String>,
    /// `key:=value`, and comments.
    notes: Vec<String>,
    /// Where samples begin.
    end: u64,
}

fn header<'a>(source: &'a Source, head: &[u8]) -> Result<Header<'a>, ParseError> {
    let mut fields = Fields {
        source,
        all: Vec::new(),
    };
    let (mut list, mut notes, mut end) = (Vec::new(), Vec::new(), None);
    let mut is_list = false;
    for (n, (text, behind)) in lines(head).enumerate().skip(1) {
        let is_key = |key: &str| fields.find(key).is_some();
        if text.is_empty() {
            end = Some(behind);
            break;
        }
        if is_list {
            list.push(text);
        } else if let Some(comment) = text.strip_prefix('#') {
            notes.push(comment.trim().to_owned());
        } else if let Some((key, value)) = text.split_once(": ").or(text.split_once(":\t")) {
            is_list = key.trim().replace(' ', "") == "datafile" && value.trim().starts_with("LIST");
            // Both spellings are in use.
            let key = match key.trim() {
                "datafile" => "data file".to_owned(),
                "byteskip" => "byte skip".to_owned(),
                "lineskip" => "line skip".to_owned(),
                key => key.to_ascii_lowercase(),
            };
            if is_key(&key) {
                continue;
            }
            fields.all.push(Field {
                key,
                value: value.trim().to_owned(),
                line: n + 1,
            });
        } else if text.contains(":=") {
            notes.push(text);
        } else {
            let at = At::Line {
                line: n + 1,
                column: 1,
            };
            let message =
                "expected 'field: value', 'key:=value' or a comment; an empty line ends the header";
            return Err(source.error(ErrorKind::Malformed, at, "NRRD", message));
        }
    }
    if end.is_none() && (fields.find("data file").is_none() || head.len() as u64 != source.length())
    {
        let message = "the header has no end: an empty line stands before the samples";
        return Err(source.error(ErrorKind::Truncated, At::File, "NRRD", message));
    }
    Ok(Header {
        fields,
        list,
        notes,
        end: end.unwrap_or(source.length()),
    })
}

/// Words of an axis in quotes.
fn quoted(value: &str) -> Vec<String> {
    let words = value.split('"').skip(1).step_by(2);
    words.map(str::to_owned).collect()
}

/// Vectors such as `(1,0,0) none (0,0,2)`.
fn vectors(fields: &Fields, field: &Field) -> Result<Vec<Option<[f64; 3]>>, ParseError> {
    let refuse = || {
        let message = "expected vectors of three numbers, such as (1,0,0), or none";
        fields.error(ErrorKind::BadValue, field, message)
    };
    let (mut found, mut rest) = (Vec::new(), field.value.trim());
    while !rest.is_empty() {
        if let Some(behind) = rest.strip_prefix("none") {
            found.push(None);
            rest = behind.trim_start();
            continue;
        }
        let inside = rest.strip_prefix('(').and_then(|r| r.split_once(')'));
        let (inside, behind) = inside.ok_or_else(refuse)?;
        let mut vector = [0.0; 3];
        let mut words = inside.split(',');
        for value in &mut vector {
            let word = words.next().ok_or_else(refuse)?;
            *value = word.trim().parse().map_err(|_| refuse())?;
        }
        if words.next().is_some() {
            return Err(refuse());
        }
        found.push(Some(vector));
        rest = behind.trim_start();
    }
    Ok(found)
}

/// Which axes of the file are those of space, and where the numbers of one component stand among the others.
struct Shape {
    dims: [usize; 3],
    samples: u64,
    /// The first axis of space.
    first: usize,
    /// Components that stand side by side, and one behind the other.
    inner: usize,
    outer: usize,
    axes: usize,
}

fn shape(fields: &Fields, options: &Options) -> Result<Shape, ParseError> {
    let field = fields.need("sizes")?;
    let sizes: Vec<u64> = fields.numbers(field)?;
    let dimension = fields.need("dimension")?;
    if fields.numbers::<usize>(dimension)? != [sizes.len()] {
        let message = format!("is not the number of sizes, {}", sizes.len());
        return Err(fields.error(ErrorKind::WrongCount, dimension, message));
    }
    let kinds: Vec<&str> = fields.text("kinds").split_whitespace().collect();
    let directions = fields.find("space directions");
    let directions = directions.map(|f| vectors(fields, f)).transpose()?;
    let is_space = |axis: usize| {
        let vector = directions.as_ref().and_then(|d| d.get(axis));
        let is_kind = |kind: &&&str| matches!(**kind, "domain" | "space" | "???" | "none");
        let kind = kinds.get(axis).is_none_or(|kind| is_kind(&kind));
        vector.is_none_or(Option::is_some) && kind
    };
    let count = sizes.len();
    let (first, space, inner, outer) = match count {
        1..=3 if (0..count).all(is_space) => (0, count, 1, 1),
        2..=4 if !is_space(0) => (1, count - 1, sizes[0], 1),
        2..=4 if count == 4 || !is_space(count - 1) => (0, count - 1, 1, sizes[count - 1]),
        _ => {
            let message = "volumes have three axes, and a fourth one, the first or the last, for components: split the file";
            return Err(fields.error(ErrorKind::Unsupported, field, message));
        }
    };
    let (dims, samples) = fields.dims(field, &sizes[first..first + space])?;
    let components = inner.saturating_mul(outer);
    let bytes = samples
        .checked_mul(components)
        .and_then(|n| n.checked_mul(8));
    if components == 0 || bytes.is_none_or(|bytes| bytes > isize::MAX as u64) {
        let message = "no volume of so many components can be addressed";
        return Err(fields.error(ErrorKind::TooLarge, field, message));
    }
    fields.check_component(field, options.component, components as usize)?;
    Ok(Shape {
        dims,
        samples,
        first,
        inner: inner as usize,
        outer: outer as usize,
        axes: count,
    })
}

fn sample_type(fields: &Fields) -> Result<SampleType, ParseError> {
    let field = fields.need("type")?;
    let words: Vec<&str> = field.value.split_whitespace().collect();
    Ok(match words.join(" ").as_str() {
        "signed char" | "int8" | "int8_t" => SampleType::I8,
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => SampleType::U8,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => {
            SampleType::I16
        }
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => {
            SampleType::U16
        }
        "int" | "signed int" | "int32" | "int32_t" => SampleType::I32,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => SampleType::U32,
        "longlong"
        | "long long"
        | "long long int"
        | "signed long long"
        | "signed long long int"
        | "int64"
        | "int64_t" => SampleType::I64,
        "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => {
            SampleType::U64
        }
        "float" => SampleType::F32,
        "double" => SampleType::F64,
        other => {
            let message =
                format!("samples of the type '{other}' are not read: write the file as float");
            return Err(fields.error(ErrorKind::Unsupported, field, message));
        }
    })
}

/// The numbers of the axes of space, of a field with one for each axis.
fn per_axis(fields: &Fields, key: &str, shape: &Shape, none: f64) -> Result<[f64; 3], ParseError> {
    let mut found = [none; 3];
    if let Some(all) = fields.some::<f64>(key, shape.axes)? {
        for (value, read) in found.iter_mut().zip(&all[shape.first..]) {
            // Stands for an axis without.
            *value = if read.is_nan() { none } else { *read };
        }
    }
    Ok(found)
}

fn lattice(fields: &Fields, shape: &Shape) -> Result<Lattice, ParseError> {
    let spacing = per_axis(fields, "spacings", shape, 1.0)?;
    let mins = per_axis(fields, "axis mins", shape, 0.0)?;
    let mut lattice = Lattice::straight(shape.dims, mins, spacing);
    let centers: Vec<&str> = fields.text("centerings").split_whitespace().collect();
    if fields.find("axis mins").is_some() {
        for (axis, first) in lattice.origin.iter_mut().enumerate() {
            // The smallest place of an axis is the border of the first sample's cell.
            if centers.get(shape.first + axis) == Some(&"cell") {
                *first += spacing[axis] / 2.0;
            }
        }
    }
    if let Some(field) = fields.find("space directions") {
        let found = vectors(fields, field)?;
        if found.len() != shape.axes {
            let message = format!("expected {} vectors, found {}", shape.axes, found.len());
            return Err(fields.error(ErrorKind::WrongCount, field, message));
        }
        lattice.origin = [0.0; 3];
        for (edge, vector) in lattice.edges.iter_mut().zip(&found[shape.first..]) {
            *edge = vector.unwrap_or(*edge);
        }
    }
    if let Some(field) = fields.find("space origin") {
        if let [Some(origin)] = vectors(fields, field)?[..] {
            lattice.origin = origin;
        } else {
            let message = "expected one vector, such as (0,0,0)";
            return Err(fields.error(ErrorKind::BadValue, field, message));
        }
    }
    Ok(lattice)
}

fn byte_order(fields: &Fields, kind: SampleType) -> Result<ByteOrder, ParseError> {
    match fields.find("endian") {
        Some(field) => match field.value.to_ascii_lowercase().as_str() {
            "little" => Ok(ByteOrder::Little),
            "big" => Ok(ByteOrder::Big),
            _ => Err(fields.error(ErrorKind::BadValue, field, "expected little or big")),
        },
        None if kind.size() == 1 => Ok(ByteOrder::Little),
        None => fields.need("endian").map(|_| ByteOrder::Little),
    }
}

/// Files of `data file`, none where the samples are in this one.
fn data_files(header: &Header) -> Result<Option<Vec<std::path::PathBuf>>, ParseError> {
    let fields = &header.fields;
    let Some(field) = fields.find("data file") else {
        return Ok(None);
    };
    let words: Vec<&str> = field.value.split_whitespace().collect();
    let numbers: Vec<i64> = words.iter().skip(1).flat_map(|w| w.parse().ok()).collect();
    let names = match (&words[..], &numbers[..]) {
        (["LIST", ..], _) => header.list.clone(),
        ([pattern, _, _, _, ..], [first, last, step, ..]) if pattern.contains('%') => {
            detached::numbered(pattern, [*first, *last, *step]).ok_or_else(|| {
                let message = "expected a pattern such as slice%03d.raw, and first, last and step";
                fields.error(ErrorKind::BadValue, field, message)
            })?
        }
        _ => vec![field.value.clone()],
    };
    let at = At::Line {
        line: field.line,
        column: 1,
    };
    detached::files(fields.source, &names, at, "data file").map(Some)
}

fn samples(header: &Header, shape: &Shape, kind: SampleType) -> Result<Store, ParseError> {
    let fields = &header.fields;
    let encoding = fields.need("encoding")?;
    let count = shape.samples * (shape.inner * shape.outer) as u64;
    let length = count * kind.size() as u64;
    let skip = fields.whole::<i64>("byte skip", 0)?;
    let files = data_files(header)?;
    let mut placing = Placing {
        lines: fields.whole("line skip", 0)?,
        bytes: u64::try_from(skip).ok(),
        packing: None,
    };
    let source = fields.source;
    match encoding.value.to_ascii_lowercase().as_str() {
        "raw" => {}
        "gzip" | "gz" => placing.packing = Some(Packing::Gzip),
        "txt" | "text" | "ascii" => {
            let (source, start) = match files.as_deref() {
                None => (source.clone(), header.end),
                Some([file]) => (Source::open(file)?, 0),
                Some(_) => {
                    let message = "text in several files is not read: join them";
                    return Err(fields.error(ErrorKind::Unsupported, encoding, message));
                }
            };
            let start = detached::skip_lines(&source, start, placing.lines)?;
            let start = start.saturating_add(placing.bytes.unwrap_or(0));
            return store::numbers(&source, [start, source.length()], count, kind);
        }
        other => {
            let message =
                format!("the encoding '{other}' is not read: save the file as raw or gzip");
            return Err(fields.error(ErrorKind::Unsupported, encoding, message));
        }
    }
    match files {
        Some(files) => detached::parts(source, &files, length, placing),
        None => detached::store(source, header.end, length, placing),
    }
}

pub(super) fn read(
    source: &Source,
    head: &[u8],
    options: &Options,
) -> Result<VolumeFile, ParseError> {
    let header = header(source, head)?;
    let fields = &header.fields;
    let kind = sample_type(fields)?;
    let shape = shape(fields, options)?;
    let lattice = lattice(fields, &shape)?;
    let store = samples(&header, &shape, kind)?;
    let order = match store {
        Store::Memory(_) => ByteOrder::Little,
        _ => byte_order(fields, kind)?,
    };
    let size = kind.size();
    let (inside, behind) = (
        options.component % shape.inner,
        (options.component / shape.inner) as u64,
    );
    let rows = Samples::Rows {
        store,
        stride: size * shape.inner,
        first: (inside * size) as u64 + behind * shape.samples * size as u64,
    };
    let coding = Coding { kind, order };
    let mut volume = VolumeFile::new(Format::Nrrd, source, lattice, coding, rows);
    let components = shape.inner * shape.outer;
    if components > 1 {
        let message = format!(
            "has {components} components: {} (from 0) is read",
            options.component
        );
        volume.notes.push(source.path(), At::File, message);
    }
    let [labels, units] = ["labels", "units"].map(|key| quoted(fields.text(key)));
    let common = quoted(fields.text("space units"));
    for (n, axis) in volume.axes.iter_mut().enumerate() {
        let word = |words: &[String], n: usize| words.get(n).cloned().unwrap_or_default();
        *axis = Axis {
            name: word(&labels, shape.first + n),
            unit: match units.is_empty() {
                true => word(&common, n),
                false => word(&units, shape.first + n),
            },
        };
    }
    volume.frame = fields.text("space").to_owned();
    volume.name = fields.text("content").to_owned();
    volume.unit = fields.text("sample units").trim_matches('"').to_owned();
    volume.header = header.notes;
    Ok(volume)
}

fn type_name(kind: SampleType) -> Option<&'static str> {
    Some(match kind {
        SampleType::I8 => "int8",
        SampleType::U8 => "uint8",
        SampleType::I16 => "int16",
        SampleType::U16 => "uint16",
        SampleType::I32 => "int32",
        SampleType::U32 => "uint32",
        SampleType::I64 => "int64",
        SampleType::U64 => "uint64",
        SampleType::F32 => "float",
        SampleType::F64 => "double",
        SampleType::I24 | SampleType::U24 | SampleType::Ibm32 => return None,
    })
}

/// Writes a volume, raw or compressed by gzip; `values` are in natural order, i fastest.
///
/// # Errors
/// When writing fails, the format has no such type, or the values are not as many as the samples, or none of the type.
pub fn write<W: Write>(
    mut out: W,
    contents: &Contents,
    is_packed: bool,
    values: impl IntoIterator<Item = f64>,
) -> io::Result<W> {
    let kind = type_name(contents.sample).ok_or_else(|| contents.refuse_type("NRRD"))?;
    let lattice = &contents.lattice;
    let vector = |v: [f64; 3]| format!("({},{},{})", v[0], v[1], v[2]);
    let [ni, nj, nk] = lattice.dims;
    let order = match contents.byte_order {
        ByteOrder::Little => "little",
        ByteOrder::Big => "big",
    };
    let edges = lattice.edges.map(vector).join(" ");
    let encoding = if is_packed { "gzip" } else { "raw" };
    write!(
        out,
        "NRRD0005\ntype: {kind}\ndimension: 3\nspace dimension: 3\nsizes: {ni} {nj} {nk}\n\
         space directions: {edges}\nspace origin: {}\nendian: {order}\nencoding: {encoding}\n",
        vector(lattice.origin)
    )?;
    if !contents.name.is_empty() {
        writeln!(out, "content: {}", write::one_line(&contents.name))?;
    }
    writeln!(out)?;
    if is_packed {
        let mut packed = GzEncoder::new(out, Compression::default());
        write::samples(&mut packed, contents, values)?;
        return packed.finish();
    }
    write::samples(&mut out, contents, values)?;
    Ok(out)
}
