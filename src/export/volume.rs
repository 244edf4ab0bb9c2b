//! A synthetic volume as a file.

use std::io;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use strataray_parsers::volume::{
    ByteOrder, Contents, Lattice, SampleType, SegyLayout, SegyWriter, metaimage, nrrd, vti,
};

use super::error::{ExportError, failed};
use super::output::Output;
use crate::model::synthetic::SyntheticVolume;
use crate::model::{CellIndex, Dims};

/// Formats of volumes that are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VolumeFormat {
    /// NRRD.
    Nrrd,
    /// MetaImage with its samples in the same file.
    MetaImage,
    /// VTK ImageData.
    Vti,
    /// SEG-Y of IEEE reals.
    Segy,
}

impl VolumeFormat {
    /// All of them, with the endings of their files.
    pub const ALL: [(Self, &'static str); 4] = [
        (Self::Nrrd, "nrrd"),
        (Self::MetaImage, "mha"),
        (Self::Vti, "vti"),
        (Self::Segy, "segy"),
    ];

    /// The ending of its files.
    pub fn ending(self) -> &'static str {
        Self::ALL[self as usize].1
    }
}

/// Samples of all formats are 1 apart.
const SPACING: f64 = 1.0;
/// Place of the first sample; x and y of 0 stand for no place in SEG-Y.
const ORIGIN: [f64; 3] = [1.0, 1.0, 0.0];

/// Writes the volume `NAME.ENDING` to a folder, which is made where it is missing; returns its path.
///
/// `progress` gets the part done and returns false to cancel.
///
/// # Errors
/// When there is not enough memory for the samples, the file cannot be written, or `progress` cancels.
pub fn write(
    volume: &SyntheticVolume,
    [folder, name]: [&Path; 2],
    format: VolumeFormat,
    progress: &dyn Fn(f64) -> bool,
) -> Result<PathBuf, ExportError> {
    std::fs::create_dir_all(folder).map_err(failed(folder))?;
    let mut file_name = name.as_os_str().to_owned();
    file_name.push(format!(".{}", format.ending()));
    let path = folder.join(file_name);
    let mut output = Output::new(&[], progress);
    let dims = volume.dims();
    let Some(samples) = dims.checked_cells() else {
        let Dims { ni, nj, nk } = dims;
        let message = format!("{ni} x {nj} x {nk} samples: 1 to 2^31-1 can be numbered");
        return Err(failed(&path)(io::Error::other(message)));
    };
    // As much again to write them.
    output.expect(2 * samples);
    let values = computed(volume, samples, &mut output, &path)?;
    output.write(&path, |file| match format {
        VolumeFormat::Nrrd => nrrd::write(file, &contents(dims), false, wide(&values)).map(drop),
        VolumeFormat::MetaImage => {
            metaimage::write(file, &contents(dims), false, wide(&values)).map(drop)
        }
        VolumeFormat::Vti => vti::write(file, &contents(dims), wide(&values)).map(drop),
        VolumeFormat::Segy => traces(file, dims, &values),
    })?;
    output.advance(samples)?;
    output.keep()?;
    Ok(path)
}

/// The samples in natural order, plane by plane.
fn computed(
    volume: &SyntheticVolume,
    samples: usize,
    output: &mut Output<'_>,
    path: &Path,
) -> Result<Vec<f32>, ExportError> {
    let dims = volume.dims();
    let mut values: Vec<f32> = Vec::new();
    let room = values.try_reserve_exact(samples);
    room.map_err(|_| failed(path)(io::ErrorKind::OutOfMemory.into()))?;
    values.resize(samples, 0.0);
    let plane = dims.columns();
    for (k, values) in values.chunks_mut(plane).enumerate() {
        values.par_iter_mut().enumerate().for_each(|(n, value)| {
            let at = dims.ijk(CellIndex((plane * k + n) as u32));
            *value = volume.value(at);
        });
        output.advance(plane)?;
    }
    Ok(values)
}

fn wide(values: &[f32]) -> impl Iterator<Item = f64> + '_ {
    values.iter().map(|value| f64::from(*value))
}

fn contents(Dims { ni, nj, nk }: Dims) -> Contents {
    Contents {
        lattice: Lattice::straight([ni, nj, nk], ORIGIN, [SPACING; 3]),
        sample: SampleType::F32,
        byte_order: ByteOrder::Little,
        name: String::new(),
    }
}

/// A trace for each column, from its upper end on.
fn traces(file: std::fs::File, dims: Dims, values: &[f32]) -> io::Result<()> {
    let layout = SegyLayout {
        sample: SampleType::F32,
        byte_order: ByteOrder::Big,
        samples: dims.nk,
        interval: SPACING,
        delay: 0,
        text: "C 1 A VOLUME BY FORMULA, WRITTEN BY STRATARAY".into(),
    };
    let mut writer = SegyWriter::new(file, layout)?;
    let columns = dims.columns();
    for column in 0..columns {
        let (i, j) = (column % dims.ni, column / dims.ni);
        let trace = (0..dims.nk).rev().map(|k| values[column + columns * k]);
        let trace: Vec<f32> = trace.collect();
        let place = [
            ORIGIN[0] + i as f64 * SPACING,
            ORIGIN[1] + j as f64 * SPACING,
        ];
        writer.trace(i as i32 + 1, j as i32 + 1, place, &trace)?;
    }
    writer.finish().map(drop)
}
