//! Writing arrays in the conventional block sizes, or as text in the conventional columns.

use std::io::{self, BufWriter, Write};

use super::{Form, Kind};

/// Bytes gathered before they go to the underlying writer.
const BUFFER: usize = 1 << 18;

/// Writes arrays one after the other, in blocks of 1000 numbers or 105 strings: binary, or formatted as text.
///
/// Text has as many digits as its readers need to get the same value, but where a DOUB does not fit its column of 23
/// characters: then its last of 17 digits may be missing.
///
/// Call [`Self::finish`] at the end: it is what reports a failure to write the last bytes.
#[derive(Debug)]
pub struct RecordWriter<W: Write> {
    out: BufWriter<W>,
    form: Form,
    block: Vec<u8>,
}

impl<W: Write> RecordWriter<W> {
    /// A writer of a binary file to `out`, which needs no buffer of its own.
    pub fn new(out: W) -> Self {
        Self::of(Form::Binary, out)
    }

    /// A writer of a formatted file to `out`, which needs no buffer of its own.
    pub fn formatted(out: W) -> Self {
        Self::of(Form::Formatted, out)
    }

    fn of(form: Form, out: W) -> Self {
        Self {
            out: BufWriter::with_capacity(BUFFER, out),
            form,
            block: Vec::new(),
        }
    }

    /// Writes an INTE array.
    ///
    /// # Errors
    /// When `name` is not a keyword of at most 8 ASCII characters, or writing fails.
    pub fn inte(&mut self, name: &str, values: &[i32]) -> io::Result<()> {
        self.numbers(name, Kind::Inte, values, i32::to_be_bytes, |v| {
            v.to_string()
        })
    }

    /// Writes a REAL array.
    ///
    /// # Errors
    /// As [`Self::inte`].
    pub fn real(&mut self, name: &str, values: &[f32]) -> io::Result<()> {
        self.numbers(name, Kind::Real, values, f32::to_be_bytes, |v| {
            format!("{v:E}")
        })
    }

    /// Writes a DOUB array.
    ///
    /// # Errors
    /// As [`Self::inte`].
    pub fn doub(&mut self, name: &str, values: &[f64]) -> io::Result<()> {
        self.numbers(name, Kind::Doub, values, f64::to_be_bytes, doub_text)
    }

    /// Writes a LOGI array.
    ///
    /// # Errors
    /// As [`Self::inte`].
    pub fn logi(&mut self, name: &str, values: &[bool]) -> io::Result<()> {
        let bytes = |value: bool| if value { [0xff; 4] } else { [0; 4] };
        let text = |value: bool| if value { "T" } else { "F" }.to_owned();
        self.numbers(name, Kind::Logi, values, bytes, text)
    }

    /// Writes a CHAR array: strings of at most 8 bytes, padded with blanks.
    ///
    /// # Errors
    /// As [`Self::inte`], and when a string is too long.
    pub fn chars<S: AsRef<str>>(&mut self, name: &str, values: &[S]) -> io::Result<()> {
        self.text(name, 8, values)
    }

    /// Writes strings of at most `width` bytes: CHAR where that is 8, else C0nn.
    ///
    /// # Errors
    /// As [`Self::chars`], and when `width` is not 1 to 999.
    pub fn text<S: AsRef<str>>(&mut self, name: &str, width: u16, values: &[S]) -> io::Result<()> {
        let too_long = |s: &&S| s.as_ref().len() > usize::from(width);
        if let Some(s) = values.iter().find(too_long) {
            let s = s.as_ref();
            return Err(refused(format!("{name}: {s:?} is longer than {width}")));
        }
        let padded = |s: &S, block: &mut Vec<u8>| {
            let s = s.as_ref().as_bytes();
            block.extend_from_slice(s);
            block.resize(block.len() + usize::from(width) - s.len(), b' ');
        };
        let quoted = |s: &S, line: &mut Vec<u8>| {
            line.extend(b" '");
            padded(s, line);
            line.push(b'\'');
        };
        let is_line = |s: &&S| s.as_ref().contains(['\n', '\r']);
        if let (Form::Formatted, Some(s)) = (self.form, values.iter().find(is_line)) {
            let s = s.as_ref();
            return Err(refused(format!("{name}: {s:?} has a line break")));
        }
        self.array(name, Kind::Text(width), values, padded, quoted)
    }

    /// Writes a MESS: a name without data.
    ///
    /// # Errors
    /// As [`Self::inte`].
    pub fn mess(&mut self, name: &str) -> io::Result<()> {
        self.header(name, 0, "MESS")
    }

    /// Writes what is still in the buffer and hands back the underlying writer.
    ///
    /// # Errors
    /// When writing fails.
    pub fn finish(self) -> io::Result<W> {
        self.out
            .into_inner()
            .map_err(io::IntoInnerError::into_error)
    }

    fn numbers<T: Copy, const N: usize>(
        &mut self,
        name: &str,
        kind: Kind,
        values: &[T],
        bytes: impl Fn(T) -> [u8; N],
        text: impl Fn(T) -> String,
    ) -> io::Result<()> {
        let (_, width) = columns(kind);
        let append = |v: &T, block: &mut Vec<u8>| block.extend(bytes(*v));
        let aligned = |v: &T, line: &mut Vec<u8>| {
            let text = text(*v);
            // With a blank at least, whatever the number.
            line.resize(line.len() + width.saturating_sub(text.len()).max(1), b' ');
            line.extend(text.as_bytes());
        };
        self.array(name, kind, values, append, aligned)
    }

    fn array<T>(
        &mut self,
        name: &str,
        kind: Kind,
        values: &[T],
        append: impl Fn(&T, &mut Vec<u8>),
        append_text: impl Fn(&T, &mut Vec<u8>),
    ) -> io::Result<()> {
        let code = match kind {
            Kind::Inte => "INTE".into(),
            Kind::Real => "REAL".into(),
            Kind::Doub => "DOUB".into(),
            Kind::Logi => "LOGI".into(),
            Kind::Mess => "MESS".into(),
            Kind::Text(8) => "CHAR".into(),
            Kind::Text(width @ 1..=999) => format!("C{width:03}"),
            Kind::Text(width) => {
                return Err(refused(format!("{name}: no strings of {width} bytes")));
            }
        };
        // 2^31 elements or more do not fit the header's count.
        let high = values.len() >> 31;
        if high > 0 {
            self.header(name, -(high as i64), "X231")?;
        }
        self.header(name, (values.len() & 0x7fff_ffff) as i64, &code)?;
        for chunk in values.chunks(kind.block() as usize) {
            self.block.clear();
            if self.form == Form::Formatted {
                for line in chunk.chunks(columns(kind).0) {
                    line.iter().for_each(|v| append_text(v, &mut self.block));
                    self.block.push(b'\n');
                }
                self.out.write_all(&self.block)?;
                continue;
            }
            for value in chunk {
                append(value, &mut self.block);
            }
            let marker = (self.block.len() as u32).to_be_bytes();
            self.out.write_all(&marker)?;
            self.out.write_all(&self.block)?;
            self.out.write_all(&marker)?;
        }
        Ok(())
    }

    fn header(&mut self, name: &str, count: i64, kind: &str) -> io::Result<()> {
        let is_keyword =
            (1..=8).contains(&name.len()) && name.bytes().all(|b| b.is_ascii_graphic());
        if !is_keyword {
            return Err(refused(format!("{name:?} is not a keyword")));
        }
        let count = i32::try_from(count).map_err(|e| refused(format!("{name}: {e}")))?;
        if self.form == Form::Formatted {
            return writeln!(self.out, " '{name:<8}' {count:>11} '{kind}'");
        }
        self.out.write_all(&16i32.to_be_bytes())?;
        write!(self.out, "{name:<8}")?;
        self.out.write_all(&count.to_be_bytes())?;
        self.out.write_all(kind.as_bytes())?;
        self.out.write_all(&16i32.to_be_bytes())
    }
}

/// Values in a line of text, and the characters that each takes, as simulators write them.
fn columns(kind: Kind) -> (usize, usize) {
    match kind {
        Kind::Inte => (6, 12),
        Kind::Real => (4, 17),
        Kind::Doub => (3, DOUB_WIDTH),
        Kind::Logi => (25, 3),
        Kind::Text(width) => {
            let width = usize::from(width) + 3;
            ((80 / width).max(1), width)
        }
        Kind::Mess => (1, 0),
    }
}

const DOUB_WIDTH: usize = 23;

/// A double with all of its digits where they fit the column, else with 16.
fn doub_text(value: f64) -> String {
    let text = format!("{value:E}");
    let fits = text.len() < DOUB_WIDTH;
    let text = if fits { text } else { format!("{value:.15E}") };
    text.replace('E', "D")
}

/// The error of a writer that was given what a file cannot hold.
pub(crate) fn refused(message: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, message)
}
