//! What writers of volumes write.

use std::io::{self, Write};

use super::lattice::Lattice;
use super::sample::{ByteOrder, Coding, SampleType};
use crate::records::refused;

/// What is written of a volume beside its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Contents {
    /// Where the samples are.
    pub lattice: Lattice,
    /// Type of the samples; values are rounded to it.
    pub sample: SampleType,
    /// Order of the bytes of a sample.
    pub byte_order: ByteOrder,
    /// What the values are; may be empty.
    pub name: String,
}

impl Contents {
    pub(super) fn refuse_type(&self, format: &str) -> io::Error {
        refused(format!(
            "{format} has no samples of the type {}",
            self.sample.name()
        ))
    }
}

/// Names stand on a line of their own.
pub(super) fn one_line(text: &str) -> String {
    text.replace(char::is_control, " ")
}

/// Writes samples, as many as the lattice has.
pub(super) fn samples(
    out: &mut impl Write,
    contents: &Contents,
    values: impl IntoIterator<Item = f64>,
) -> io::Result<()> {
    let coding = Coding {
        kind: contents.sample,
        order: contents.byte_order,
    };
    let (mut bytes, mut count) = (Vec::new(), 0);
    for value in values {
        count += 1;
        coding.encode(value, &mut bytes).ok_or_else(|| {
            let kind = coding.kind.name();
            refused(format!(
                "value {count}, {value}, is none of the type {kind}"
            ))
        })?;
        if bytes.len() >= 1 << 16 {
            out.write_all(&bytes)?;
            bytes.clear();
        }
    }
    out.write_all(&bytes)?;
    let samples = contents.lattice.samples();
    match count == samples {
        true => Ok(()),
        false => Err(refused(format!("{count} values for {samples} samples"))),
    }
}

/// Unit vectors of the axes.
///
/// # Errors
/// When the edges are not at right angles, which `format` cannot say, or one has no length.
pub(super) fn directions(lattice: &Lattice, format: &str) -> io::Result<[[f64; 3]; 3]> {
    let spacing = lattice.spacing();
    if let Some(axis) = spacing.iter().position(|length| *length <= 0.0) {
        return Err(refused(format!("edge {axis} of the lattice has no length")));
    }
    let mut units = lattice.edges;
    for (unit, length) in units.iter_mut().zip(spacing) {
        unit.iter_mut().for_each(|v| *v /= length);
    }
    let product = |a: usize, b: usize| (0..3).map(|n| units[a][n] * units[b][n]).sum::<f64>();
    let skew = [product(0, 1), product(0, 2), product(1, 2)];
    if skew.iter().any(|cosine| cosine.abs() > 1e-6) {
        let message = format!("{format} cannot say edges that are not at right angles: write NRRD");
        return Err(refused(message));
    }
    Ok(units)
}
