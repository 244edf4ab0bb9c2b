//! VTK ImageData (`.vti`): text, base64 in the file, or samples appended to it raw or in base64; compressed by zlib.
//!
//! Values of points are at the points, and those of cells in the middles of the cells. The facts are those of VTK's
//! description of its XML formats.

use std::io::{self, Write};

use super::lattice::{self, Lattice};
use super::sample::{ByteOrder, Coding, SampleType};
use super::source::Source;
use super::store::{self, Blocks, Span, Store};
use super::write::{self, Contents};
use super::xml::{self, Tag};
use super::{Format, Options, Samples, VolumeFile};
use crate::error::{At, ErrorKind, ParseError};

/// Types by the names of the format.
const TYPES: [(&str, SampleType); 10] = [
    ("Int8", SampleType::I8),
    ("UInt8", SampleType::U8),
    ("Int16", SampleType::I16),
    ("UInt16", SampleType::U16),
    ("Int32", SampleType::I32),
    ("UInt32", SampleType::U32),
    ("Int64", SampleType::I64),
    ("UInt64", SampleType::U64),
    ("Float32", SampleType::F32),
    ("Float64", SampleType::F64),
];

/// True where a file begins as one of VTK's XML formats does.
pub(super) fn is_header(start: &[u8]) -> bool {
    let start = &start[..start.len().min(4096)];
    start.starts_with(b"<") && start.windows(8).any(|word| word == b"<VTKFile")
}

/// The tags of a file.
struct Document<'a> {
    source: &'a Source,
    tags: Vec<Tag>,
    order: ByteOrder,
    /// Bytes of the numbers before samples.
    word: usize,
    is_packed: bool,
}

fn error(source: &Source, tag: &Tag, kind: ErrorKind, message: impl Into<String>) -> ParseError {
    source.error(kind, At::Byte(tag.start), &tag.name, message)
}

fn document(source: &Source) -> Result<Document<'_>, ParseError> {
    let tags = xml::tags(source, "AppendedData")?;
    let Some(file) = tags.iter().find(|tag| tag.name == "VTKFile") else {
        let message = "is no file of VTK: the tag VTKFile is missing";
        return Err(source.error(ErrorKind::NotThisFormat, At::File, "", message));
    };
    let refuse = |message: String| Err(error(source, file, ErrorKind::Unsupported, message));
    let kind = file.text("type");
    if kind != "ImageData" {
        return refuse(format!(
            "holds {kind}: of VTK's files ImageData is read, resample it to that"
        ));
    }
    let compressor = file.text("compressor");
    if !matches!(compressor, "" | "vtkZLibDataCompressor") {
        return refuse(format!(
            "compressed by {compressor}: write it with zlib or without compression"
        ));
    }
    let order = match file.text("byte_order") {
        "BigEndian" => ByteOrder::Big,
        _ => ByteOrder::Little,
    };
    Ok(Document {
        source,
        order,
        word: if file.text("header_type") == "UInt64" {
            8
        } else {
            4
        },
        is_packed: !compressor.is_empty(),
        tags,
    })
}

impl Document<'_> {
    fn find(&self, name: &str) -> Option<&Tag> {
        self.tags.iter().find(|tag| tag.name == name && !tag.is_end)
    }

    fn need(&self, name: &str) -> Result<&Tag, ParseError> {
        self.find(name).ok_or_else(|| {
            let kind = ErrorKind::MissingKeyword;
            self.source.error(kind, At::File, name, "is missing")
        })
    }

    fn numbers<const N: usize>(
        &self,
        tag: &Tag,
        key: &str,
        default: Option<[f64; N]>,
    ) -> Result<[f64; N], ParseError> {
        let text = tag.text(key);
        if let Some(default) = default.filter(|_| text.is_empty()) {
            return Ok(default);
        }
        let numbers: Option<Vec<f64>> = text.split_whitespace().map(|w| w.parse().ok()).collect();
        numbers
            .and_then(|numbers| numbers.try_into().ok())
            .ok_or_else(|| {
                let message = format!(
                    "{key} is not {N} numbers: '{}'",
                    text.chars().take(60).collect::<String>()
                );
                error(self.source, tag, ErrorKind::BadValue, message)
            })
    }

    /// The array that is asked for, and whether it is of points; names of the others.
    fn array(&self, options: &Options) -> Result<(&Tag, bool, Vec<&str>), ParseError> {
        let mut section = None;
        let mut found: Vec<(&Tag, bool, bool)> = Vec::new();
        for tag in &self.tags {
            match tag.name.as_str() {
                "PointData" | "CellData" => section = (!tag.is_end).then_some(tag),
                "DataArray" if !tag.is_end => {
                    if let Some(section) = section {
                        let is_active = section.text("Scalars") == tag.text("Name");
                        found.push((tag, section.name == "PointData", is_active));
                    }
                }
                _ => {}
            }
        }
        let chosen = match &options.array {
            Some(name) => found.iter().find(|(tag, ..)| tag.text("Name") == name),
            None => found
                .iter()
                .find(|(.., is_active)| *is_active)
                .or(found.first()),
        };
        let names = || found.iter().map(|(tag, ..)| tag.text("Name"));
        let Some((tag, is_points, _)) = chosen else {
            let message = match &options.array {
                Some(name) => {
                    let all: Vec<_> = names().collect();
                    format!("has no array {name}: it has {}", all.join(", "))
                }
                None => "has no values of points or cells".to_owned(),
            };
            let kind = ErrorKind::MissingKeyword;
            return Err(self.source.error(kind, At::File, "DataArray", message));
        };
        let others = names().filter(|name| *name != tag.text("Name")).collect();
        Ok((tag, *is_points, others))
    }

    fn lattice(&self, is_points: bool) -> Result<(Lattice, u64), ParseError> {
        let image = self.need("ImageData")?;
        let pieces = self
            .tags
            .iter()
            .filter(|tag| tag.name == "Piece" && !tag.is_end);
        let whole = self.numbers::<6>(image, "WholeExtent", None)?;
        for (n, piece) in pieces.enumerate() {
            if n > 0 || self.numbers(piece, "Extent", Some(whole))? != whole {
                let message = "files of several pieces are not read: write the image as one";
                return Err(error(self.source, piece, ErrorKind::Unsupported, message));
            }
        }
        let origin = self.numbers(image, "Origin", Some([0.0; 3]))?;
        let spacing = self.numbers(image, "Spacing", Some([1.0; 3]))?;
        let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let direction = self.numbers::<9>(image, "Direction", Some(identity))?;
        let mut dims = [0; 3];
        for (axis, dim) in dims.iter_mut().enumerate() {
            let steps = whole[2 * axis + 1] - whole[2 * axis];
            // Negative numbers and NaN become zero.
            *dim = (steps + f64::from(u8::from(is_points))) as u64;
        }
        let (dims, count) = lattice::samples(dims).ok_or_else(|| {
            let [ni, nj, nk] = dims;
            let message =
                format!("no volume of {ni} x {nj} x {nk} values can be addressed on this machine");
            error(self.source, image, ErrorKind::TooLarge, message)
        })?;
        let mut lattice = Lattice::straight(dims, origin, spacing);
        for axis in 0..3 {
            lattice.edges[axis] =
                std::array::from_fn(|row| direction[3 * row + axis] * spacing[axis]);
        }
        let middle = if is_points { 0.0 } else { 0.5 };
        let first = [whole[0], whole[2], whole[4]].map(|n| n + middle);
        lattice.origin = lattice.place(first);
        Ok((lattice, count))
    }

    /// Where the bytes of an array begin.
    fn span(&self, array: &Tag) -> Result<Span, ParseError> {
        let source = self.source;
        let refuse = |message: &str| Err(error(source, array, ErrorKind::Malformed, message));
        let (from, is_base64, skip) = match array.text("format") {
            "binary" => (array.end, true, 0),
            "appended" => {
                let appended = self.need("AppendedData")?;
                let Ok(offset) = array.text("offset").trim().parse::<u64>() else {
                    return refuse("an appended array needs an offset");
                };
                (appended.end, appended.text("encoding") != "raw", offset)
            }
            _ => return refuse("the format of an array is ascii, binary or appended"),
        };
        // Blanks, and before what is appended an underscore.
        let mut blanks = vec![0; source.length().saturating_sub(from).min(4096) as usize];
        source.read(from, &mut blanks)?;
        let mut start = blanks
            .iter()
            .take_while(|byte| byte.is_ascii_whitespace())
            .count();
        if array.text("format") == "appended" {
            if blanks.get(start) != Some(&b'_') {
                return refuse("an underscore must stand before what is appended");
            }
            start += 1;
        }
        Ok(Span {
            source: source.clone(),
            start: (from + start as u64).saturating_add(skip),
            is_base64,
        })
    }

    /// Numbers before the samples.
    fn words(&self, span: &Span, offset: u64, count: usize) -> Result<Vec<u64>, ParseError> {
        let mut bytes = vec![0; count * self.word];
        span.read(offset, &mut bytes)?;
        let words = bytes.chunks_exact(self.word).map(|word| {
            let mut wide = [0; 8];
            wide[..self.word].copy_from_slice(word);
            match self.order {
                ByteOrder::Little => u64::from_le_bytes(wide),
                ByteOrder::Big => u64::from_be_bytes(wide) >> (64 - 8 * self.word),
            }
        });
        Ok(words.collect())
    }

    fn store(&self, array: &Tag, kind: SampleType, count: u64) -> Result<Store, ParseError> {
        if array.text("format") == "ascii" {
            let next = self.tags.iter().find(|tag| tag.start >= array.end);
            let end = next.map_or(self.source.length(), |tag| tag.start);
            return store::numbers(self.source, [array.end, end], count, kind);
        }
        let span = self.span(array)?;
        let length = count * kind.size() as u64;
        let wrong = |found: u64| {
            let message = format!("the array has {found} bytes, and {length} are expected");
            error(self.source, array, ErrorKind::WrongCount, message)
        };
        if !self.is_packed {
            let found = self.words(&span, 0, 1)?[0];
            if found != length {
                return Err(wrong(found));
            }
            return self.plain(&span, length);
        }
        let head = self.words(&span, 0, 3)?;
        let [blocks, size, last] = [head[0], head[1], head[2]];
        let whole = if last == 0 {
            blocks
        } else {
            blocks.saturating_sub(1)
        };
        let found = whole.saturating_mul(size).saturating_add(last);
        if found != length || size == 0 {
            return Err(wrong(found));
        }
        let word = self.word as u64;
        let behind = blocks.saturating_add(3).saturating_mul(word);
        if behind > span.length() {
            let message = format!("the file ends before the sizes of {blocks} blocks");
            return Err(error(self.source, array, ErrorKind::Truncated, message));
        }
        let sizes = self.words(&span, 3 * word, blocks as usize)?;
        let mut starts = vec![0_u64];
        let mut end = 0_u64;
        for size in sizes {
            end = end.saturating_add(size);
            starts.push(end);
        }
        Ok(Store::Blocks(Blocks::new(
            span.behind(behind),
            starts,
            size,
            length,
        )?))
    }

    /// Samples behind the number of their bytes; both are one stream of base64.
    fn plain(&self, span: &Span, length: u64) -> Result<Store, ParseError> {
        Store::plain(span.clone(), length.saturating_add(self.word as u64))
    }
}

pub(super) fn read(source: &Source, options: &Options) -> Result<VolumeFile, ParseError> {
    let document = document(source)?;
    let (array, is_points, others) = document.array(options)?;
    let refuse = |kind, message: String| Err(error(source, array, kind, message));
    let name = array.text("type");
    let Some((_, kind)) = TYPES.iter().find(|(known, _)| *known == name) else {
        return refuse(
            ErrorKind::Unsupported,
            format!("values of the type {name} are not read"),
        );
    };
    let components = match array.text("NumberOfComponents") {
        "" => Some(1),
        text => text.parse::<u32>().ok().filter(|n| *n > 0),
    };
    let Some(components) = components.map(|n| n as usize) else {
        return refuse(
            ErrorKind::BadValue,
            "NumberOfComponents is no number above zero".into(),
        );
    };
    if options.component >= components {
        let message = format!(
            "values have {components} components: there is no component {} (from 0)",
            options.component
        );
        return refuse(ErrorKind::BadValue, message);
    }
    let (lattice, count) = document.lattice(is_points)?;
    let numbers = count
        .checked_mul(components as u64)
        .filter(|n| *n < 1 << 59);
    let Some(numbers) = numbers else {
        return refuse(
            ErrorKind::TooLarge,
            "no array of so many components can be addressed".into(),
        );
    };
    let store = document.store(array, *kind, numbers)?;
    let order = match store {
        Store::Memory(_) => ByteOrder::Little,
        _ => document.order,
    };
    let before = match store {
        Store::Plain(_) => document.word,
        _ => 0,
    };
    let rows = Samples::Rows {
        store,
        stride: kind.size() * components,
        first: (before + options.component * kind.size()) as u64,
    };
    let coding = Coding { kind: *kind, order };
    let mut volume = VolumeFile::new(Format::Vti, source, lattice, coding, rows);
    volume.name = array.text("Name").to_owned();
    let mut note = |message: String| volume.notes.push(source.path(), At::File, message);
    if components > 1 {
        note(format!(
            "{} has {components} components: {} (from 0) is read",
            array.text("Name"),
            options.component
        ));
    }
    if !others.is_empty() {
        note(format!(
            "{} is read, not {}",
            array.text("Name"),
            others.join(", ")
        ));
    }
    Ok(volume)
}

/// Writes a volume as values of points, appended raw; `values` are in natural order, i fastest.
///
/// # Errors
/// When writing fails, the format has no such type, the edges are not at right angles, or the values are not as many as
/// the samples, or none of the type.
pub fn write<W: Write>(
    mut out: W,
    contents: &Contents,
    values: impl IntoIterator<Item = f64>,
) -> io::Result<W> {
    let named = TYPES.iter().find(|(_, kind)| *kind == contents.sample);
    let (kind, _) = named.ok_or_else(|| contents.refuse_type("VTK ImageData"))?;
    let lattice = &contents.lattice;
    let units = write::directions(lattice, "VTK ImageData")?;
    let columns: Vec<f64> = (0..9).map(|n| units[n % 3][n / 3]).collect();
    let words = |v: &[f64]| v.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let extent = lattice
        .dims
        .map(|n| format!("0 {}", n - n.min(1)))
        .join(" ");
    let name = match contents.name.as_str() {
        "" => "values".to_owned(),
        name => xml::escaped(&write::one_line(name)),
    };
    let order = match contents.byte_order {
        ByteOrder::Little => "LittleEndian",
        ByteOrder::Big => "BigEndian",
    };
    let length = (lattice.samples() * contents.sample.size()) as u64;
    write!(
        out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"{order}\" header_type=\"UInt64\">\n\
         <ImageData WholeExtent=\"{extent}\" Origin=\"{}\" Spacing=\"{}\" Direction=\"{}\">\n<Piece Extent=\"{extent}\">\n\
         <PointData Scalars=\"{name}\"><DataArray type=\"{kind}\" Name=\"{name}\" format=\"appended\" offset=\"0\"/></PointData>\n\
         </Piece></ImageData>\n<AppendedData encoding=\"raw\">\n_",
        words(&lattice.origin),
        words(&lattice.spacing()),
        words(&columns),
    )?;
    out.write_all(&match contents.byte_order {
        ByteOrder::Little => length.to_le_bytes(),
        ByteOrder::Big => length.to_be_bytes(),
    })?;
    write::samples(&mut out, contents, values)?;
    write!(out, "\n</AppendedData>\n</VTKFile>\n")?;
    Ok(out)
}
