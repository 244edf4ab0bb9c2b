//! Writing GRDECL text: numbers in their shortest exact form, runs of equal values as `n*value`.

use std::io::{self, BufWriter, Write};

use super::GridUnit;
use crate::records::refused;
use crate::{geometry, parallel};

/// Values that a thread turns into text at a time.
const PIECE: usize = 1 << 16;
/// Bytes of text for a value, for sizing a piece.
const BYTES_PER_VALUE: usize = 10;
/// Longest line; simulators read 128 characters.
const LINE: usize = 80;

/// A number that a deck can hold.
pub trait Number: Copy + Send + Sync + private::Sealed {}

impl<T: Copy + Send + Sync + private::Sealed> Number for T {}

mod private {
    pub trait Sealed {
        /// Appends the shortest text that reads as this number.
        fn append(self, text: &mut Vec<u8>);
        /// True where one repeat count can stand for both.
        fn same(self, other: Self) -> bool;
        /// NaN, which is written as a default; infinite numbers cannot be written.
        fn is_undefined(&self) -> bool;
        fn is_infinite(&self) -> bool;
    }

    macro_rules! real {
        ($real:ty) => {
            impl Sealed for $real {
                fn append(self, text: &mut Vec<u8>) {
                    text.extend_from_slice(zmij::Buffer::new().format_finite(self).as_bytes());
                }
                fn same(self, other: Self) -> bool {
                    self.to_bits() == other.to_bits() || self.is_nan() && other.is_nan()
                }
                fn is_undefined(&self) -> bool {
                    self.is_nan()
                }
                fn is_infinite(&self) -> bool {
                    <$real>::is_infinite(*self)
                }
            }
        };
    }
    real!(f32);
    real!(f64);

    impl Sealed for i32 {
        fn append(self, text: &mut Vec<u8>) {
            text.extend_from_slice(itoa::Buffer::new().format(self).as_bytes());
        }
        fn same(self, other: Self) -> bool {
            self == other
        }
        fn is_undefined(&self) -> bool {
            false
        }
        fn is_infinite(&self) -> bool {
            false
        }
    }
}

/// A corner-point grid to write; shapes and units as in [`super::Grdecl`].
#[derive(Debug, Clone, Copy)]
pub struct GridText<'a, T> {
    /// Cells along i, j and k.
    pub dims: [usize; 3],
    /// Pillar ends.
    pub coord: &'a [T],
    /// Corner depths.
    pub zcorn: &'a [T],
    /// Activity, absent = all active.
    pub actnum: Option<&'a [i32]>,
    /// MAPAXES.
    pub map_axes: Option<[f64; 6]>,
    /// MAPUNITS.
    pub map_units: Option<&'a str>,
    /// GRIDUNIT.
    pub grid_unit: Option<&'a GridUnit>,
}

/// Writes a grid and its properties as text, converting in parallel.
///
/// Call [`Self::finish`] at the end: it is what reports a failure to write the last bytes.
#[derive(Debug)]
pub struct DeckWriter<W: Write> {
    out: BufWriter<W>,
}

impl<W: Write> DeckWriter<W> {
    /// A writer to `out`, which needs no buffer of its own.
    pub fn new(out: W) -> Self {
        let out = BufWriter::new(out);
        Self { out }
    }

    /// Writes MAPUNITS, MAPAXES, GRIDUNIT, SPECGRID, COORD, ZCORN and ACTNUM.
    ///
    /// # Errors
    /// When writing fails, an array has the wrong length, or a coordinate is not finite.
    pub fn grid<T: Number>(&mut self, grid: &GridText<'_, T>) -> io::Result<()> {
        let finite = |v: &T| !v.is_infinite() && !v.is_undefined();
        geometry::check(grid.dims, grid.coord, grid.zcorn, grid.actnum, finite)?;
        if let Some(units) = grid.map_units {
            writeln!(self.out, "MAPUNITS\n  {} /\n", quoted(units)?)?;
        }
        if let Some(axes) = grid.map_axes {
            self.array("MAPAXES", &axes)?;
        }
        if let Some(GridUnit { name, is_map }) = grid.grid_unit {
            let system = if *is_map { "MAP" } else { "" };
            writeln!(self.out, "GRIDUNIT\n  {} '{system}' /\n", quoted(name)?)?;
        }
        let [ni, nj, nk] = grid.dims;
        writeln!(self.out, "SPECGRID\n  {ni} {nj} {nk} 1 F /\n")?;
        self.array("COORD", grid.coord)?;
        self.array("ZCORN", grid.zcorn)?;
        match grid.actnum {
            Some(actnum) => self.array("ACTNUM", actnum),
            None => Ok(()),
        }
    }

    /// Writes a property with one value for each of all cells; NaN becomes a default (`1*`).
    ///
    /// # Errors
    /// When writing fails, a value is infinite, or `name` is not a keyword of at most 8 characters
    /// that starts with a letter; `-` may be its last one, as in `MULTX-`.
    pub fn property<T: Number>(&mut self, name: &str, values: &[T]) -> io::Result<()> {
        let starts = name.starts_with(|c: char| c.is_ascii_alphabetic());
        let body = name.strip_suffix('-').unwrap_or(name);
        let spelled = body.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
        if !starts || !spelled || name.len() > 8 {
            return Err(refused(format!("{name:?} is not a keyword")));
        }
        if let Some(number) = geometry::first_not(values, |v| !v.is_infinite()) {
            return Err(refused(format!("{name}: value {number} is infinite")));
        }
        self.array(name, values)
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

    fn array<T: Number>(&mut self, name: &str, values: &[T]) -> io::Result<()> {
        writeln!(self.out, "{name}")?;
        // A few pieces per thread at a time, so that the text of no more is in memory.
        for group in values.chunks(4 * PIECE * parallel::threads()) {
            for text in parallel::map(group.chunks(PIECE).collect(), text) {
                self.out.write_all(&text)?;
            }
        }
        writeln!(self.out, "/\n")
    }
}

fn quoted(word: &str) -> io::Result<String> {
    match word.contains(|c: char| c == '\'' || c.is_control()) {
        true => Err(refused(format!("{word:?} cannot be quoted"))),
        false => Ok(format!("'{word}'")),
    }
}

/// Lines of text for some values.
fn text<T: Number>(values: &[T]) -> Vec<u8> {
    let mut text = Vec::with_capacity(values.len() * BYTES_PER_VALUE);
    let mut token = Vec::new();
    let mut line = 0;
    for run in values.chunk_by(|a, b| a.same(*b)) {
        token.clear();
        let undefined = run[0].is_undefined();
        if run.len() > 1 || undefined {
            token.extend_from_slice(itoa::Buffer::new().format(run.len()).as_bytes());
            token.push(b'*');
        }
        if !undefined {
            run[0].append(&mut token);
        }
        if line + 1 + token.len() > LINE {
            text.push(b'\n');
            line = 0;
        }
        text.push(b' ');
        text.extend_from_slice(&token);
        line += 1 + token.len();
    }
    text.push(b'\n');
    text
}
