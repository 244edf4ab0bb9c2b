//! Writing ROFF files in binary form, in the order that their readers expect.

use std::io::{self, BufWriter, Write};

use super::{NO_VALUE, RoffGrid};
use crate::geometry::Lengths;
use crate::records::refused;

/// Writes a grid and its properties, one value per cell in natural order.
///
/// Numbers are 4 bytes long, little-endian. Call [`Self::finish`] at the end: it closes the file, and reports a failure
/// to write the last bytes.
#[derive(Debug)]
pub struct RoffWriter<W: Write> {
    out: BufWriter<W>,
    dims: [usize; 3],
}

impl<W: Write> RoffWriter<W> {
    /// A writer to `out`, which needs no buffer of its own, that begins with a grid.
    ///
    /// # Errors
    /// When writing fails, or an array of the grid has the wrong length or a number that is not finite.
    pub fn new(out: W, grid: &RoffGrid) -> io::Result<Self> {
        check(grid)?;
        let mut writer = Self {
            out: BufWriter::new(out),
            dims: grid.dims,
        };
        writer.words(&["roff-bin", "#ROFF file#", "#Creator: StrataRay#"])?;
        writer.tag("filedata", |w| {
            // Tells readers the order of bytes.
            w.int("byteswaptest", 1)?;
            w.words(&[
                "char",
                "filetype",
                "grid",
                "char",
                "creationDate",
                "UNKNOWN",
            ])
        })?;
        writer.tag("version", |w| {
            w.int("major", 2)?;
            w.int("minor", 0)
        })?;
        writer.grid(grid)?;
        Ok(writer)
    }

    /// Writes a property of real numbers; NaN becomes -999, which stands for no value.
    ///
    /// # Errors
    /// When writing fails, there is not one value for each cell, one is infinite, or the name holds a zero.
    pub fn real(&mut self, name: &str, values: &[f32]) -> io::Result<()> {
        if let Some(at) = values.iter().position(|v| v.is_infinite()) {
            return Err(refused(format!("{name}: value {} is infinite", at + 1)));
        }
        let none = NO_VALUE as f32;
        let value = |v: f32| if v.is_nan() { none } else { v };
        let values: Vec<f32> = values.iter().map(|v| value(*v)).collect();
        self.parameter(name, &[], &Values::Float(self.turned(name, &values)?))
    }

    /// Writes a property of whole numbers that stand for something, with the word for each; `None` becomes -999.
    ///
    /// # Errors
    /// As [`Self::real`].
    pub fn discrete(
        &mut self,
        name: &str,
        codes: &[(i32, String)],
        values: &[Option<i32>],
    ) -> io::Result<()> {
        let values: Vec<i32> = values
            .iter()
            .map(|v| v.unwrap_or(NO_VALUE as i32))
            .collect();
        self.parameter(name, codes, &Values::Int(self.turned(name, &values)?))
    }

    /// Closes the file and hands back the underlying writer.
    ///
    /// # Errors
    /// When writing fails.
    pub fn finish(mut self) -> io::Result<W> {
        self.tag("eof", |_| Ok(()))?;
        self.out
            .into_inner()
            .map_err(io::IntoInnerError::into_error)
    }

    fn grid(&mut self, grid: &RoffGrid) -> io::Result<()> {
        self.tag("dimensions", |w| {
            let sizes = ["nX", "nY", "nZ"].into_iter().zip(grid.dims);
            sizes.into_iter().try_for_each(|(n, v)| w.int(n, v as i32))
        })?;
        for (tag, names, values) in [
            ("translate", ["xoffset", "yoffset", "zoffset"], grid.offset),
            ("scale", ["xscale", "yscale", "zscale"], grid.scale),
        ] {
            self.tag(tag, |w| {
                let mut all = names.into_iter().zip(values);
                all.try_for_each(|(name, value)| w.float(name, value as f32))
            })?;
        }
        if !grid.subgrids.is_empty() {
            self.tag("subgrids", |w| {
                w.array("nLayers", &Values::Int(grid.subgrids.clone()))
            })?;
        }
        let floats = |values: &[f64]| Values::Float(values.iter().map(|v| *v as f32).collect());
        self.tag("cornerLines", |w| {
            w.array("data", &floats(&grid.corner_lines))
        })?;
        self.tag("zvalues", |w| {
            w.array("splitEnz", &Values::Byte(grid.splits.clone()))?;
            w.array("data", &floats(&grid.z))
        })?;
        match &grid.active {
            None => Ok(()),
            Some(active) => self.tag("active", |w| w.array("data", &Values::Bool(active.clone()))),
        }
    }

    fn parameter(
        &mut self,
        name: &str,
        codes: &[(i32, String)],
        values: &Values,
    ) -> io::Result<()> {
        let words = codes.iter().map(|(_, word)| word.as_str());
        let words: Vec<&str> = words.collect();
        if let Some(word) = words.iter().chain([&name]).find(|w| w.contains('\0')) {
            return Err(refused(format!("{word:?} holds a zero")));
        }
        self.tag("parameter", |w| {
            w.words(&["char", "name", name])?;
            if !codes.is_empty() {
                w.words(&["array", "char", "codeNames"])?;
                w.count(codes.len())?;
                w.words(&words)?;
                let numbers = codes.iter().map(|(number, _)| *number);
                w.array("codeValues", &Values::Int(numbers.collect()))?;
            }
            w.array("data", values)
        })
    }

    /// Values in the order of the file: k fastest, from the bottom, then j.
    fn turned<T: Copy>(&self, name: &str, values: &[T]) -> io::Result<Vec<T>> {
        let [ni, nj, nk] = self.dims;
        if values.len() != ni * nj * nk {
            let (expected, found) = (ni * nj * nk, values.len());
            let message = format!("{name}: expected {expected} values, found {found}");
            return Err(refused(message));
        }
        Ok(turned(self.dims, values))
    }

    fn tag(
        &mut self,
        name: &str,
        items: impl FnOnce(&mut Self) -> io::Result<()>,
    ) -> io::Result<()> {
        self.words(&["tag", name])?;
        items(self)?;
        self.words(&["endtag"])
    }

    fn words(&mut self, words: &[&str]) -> io::Result<()> {
        for word in words {
            self.out.write_all(word.as_bytes())?;
            self.out.write_all(&[0])?;
        }
        Ok(())
    }

    fn int(&mut self, name: &str, value: i32) -> io::Result<()> {
        self.words(&["int", name])?;
        self.out.write_all(&value.to_le_bytes())
    }

    fn float(&mut self, name: &str, value: f32) -> io::Result<()> {
        self.words(&["float", name])?;
        self.out.write_all(&value.to_le_bytes())
    }

    fn count(&mut self, count: usize) -> io::Result<()> {
        let count = i32::try_from(count).map_err(|_| refused(format!("{count} values")))?;
        self.out.write_all(&count.to_le_bytes())
    }

    fn array(&mut self, name: &str, values: &Values) -> io::Result<()> {
        let (kind, count) = match values {
            Values::Bool(v) => ("bool", v.len()),
            Values::Byte(v) => ("byte", v.len()),
            Values::Int(v) => ("int", v.len()),
            Values::Float(v) => ("float", v.len()),
        };
        self.words(&["array", kind, name])?;
        self.count(count)?;
        let out = &mut self.out;
        match values {
            Values::Bool(v) => v.iter().try_for_each(|v| out.write_all(&[u8::from(*v)])),
            Values::Byte(v) => out.write_all(v),
            Values::Int(v) => v.iter().try_for_each(|v| out.write_all(&v.to_le_bytes())),
            Values::Float(v) => v.iter().try_for_each(|v| out.write_all(&v.to_le_bytes())),
        }
    }
}

/// An array of an item.
enum Values {
    Bool(Vec<bool>),
    Byte(Vec<u8>),
    Int(Vec<i32>),
    Float(Vec<f32>),
}

/// From natural order to that of the file, where k runs fastest, from the bottom.
pub(super) fn turned<T: Copy>([ni, nj, nk]: [usize; 3], values: &[T]) -> Vec<T> {
    let cell = |n: usize| {
        let [i, j, k] = [n / nk / nj, n / nk % nj, nk - 1 - n % nk];
        i + ni * (j + nj * k)
    };
    (0..values.len()).map(|n| values[cell(n)]).collect()
}

fn check(grid: &RoffGrid) -> io::Result<()> {
    let [ni, nj, nk] = grid.dims;
    let Some(expected) = Lengths::of(grid.dims) else {
        return Err(refused(format!(
            "{ni} x {nj} x {nk} cells are not supported"
        )));
    };
    let z = grid.splits.iter().map(|s| usize::from(*s)).sum();
    let nodes = expected.coord / 6 * (nk + 1);
    let active = grid.active.as_ref().map_or(expected.cells, Vec::len);
    for (name, expected, found) in [
        ("cornerLines", expected.coord, grid.corner_lines.len()),
        ("splitEnz", nodes, grid.splits.len()),
        ("zvalues", z, grid.z.len()),
        ("active", expected.cells, active),
    ] {
        if expected != found {
            let message = format!("{name}: expected {expected} values, found {found}");
            return Err(refused(message));
        }
    }
    for (name, values) in [("cornerLines", &grid.corner_lines), ("zvalues", &grid.z)] {
        if let Some(at) = values.iter().position(|v| !v.is_finite()) {
            let message = format!("{name}: value {} is not a finite number", at + 1);
            return Err(refused(message));
        }
    }
    Ok(())
}
