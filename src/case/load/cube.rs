//! From files of regular volumes to cubes in the space of the map.

use glam::{DAffine3, DVec3};
use strataray_parsers::volume::{
    self, Format, Lattice, Options, SegyOptions, Vertical, VolumeFile,
};
use strataray_parsers::{At, ErrorKind, ParseError};

use super::volume::downward;
use crate::case::{CaseError, Cube, CubeFile, Quantiles, VerticalAxis};

/// Samples of a cube at most, and along an axis: what adapters hold as a texture.
const MOST: usize = 1 << 27;
const MOST_ALONG: usize = 2048;
/// Samples that are read at a time.
const SLAB: usize = 1 << 22;

/// Reads a cube.
///
/// # Errors
/// When the file is not there, is of no known format, is damaged, or has samples that span no space.
pub fn read(file: &CubeFile) -> Result<Cube, CaseError> {
    let vertical = match file.vertical {
        VerticalAxis::Time(_) => Vertical::Time,
        _ => Vertical::Depth,
    };
    let options = Options {
        segy: SegyOptions {
            vertical,
            ..SegyOptions::default()
        },
        ..Options::default()
    };
    Ok(of(&volume::open(&file.path, &options)?, file)?)
}

fn of(source: &VolumeFile, file: &CubeFile) -> Result<Cube, ParseError> {
    let refuse = |kind, message: &str| ParseError::of(kind, &file.path, At::File, "", message);
    let stem = file.path.file_stem().unwrap_or_default().to_string_lossy();
    let mut notes: Vec<String> = source.notes.iter().map(ToString::to_string).collect();
    let map_from_sample = placed(&source.lattice, source.format, file, &mut notes);
    let volume = map_from_sample.matrix3.determinant().abs();
    if !(volume.is_normal() && map_from_sample.inverse().is_finite()) {
        let message =
            "the steps between samples along i, j and k span no space: correct the header";
        return Err(refuse(ErrorKind::BadValue, message));
    }
    let reduced = reduction(source.lattice.dims);
    let (size, values) = means(source, reduced)?;
    if reduced > 1 {
        notes.push(format!(
            "{}: {} samples are more than can be shown: each that is drawn is the mean of {reduced} along each axis",
            file.path.display(),
            source.lattice.samples()
        ));
    }
    // The first of several samples, and the middle of them.
    let middle = DAffine3::from_translation(DVec3::splat(0.5 * (reduced as f64 - 1.0)));
    let wider = DAffine3::from_scale(DVec3::splat(reduced as f64));
    Ok(Cube {
        name: match source.name.is_empty() {
            true => stem.into_owned(),
            false => source.name.clone(),
        },
        unit: source.unit.clone(),
        size,
        map_from_sample: map_from_sample * middle * wider,
        quantiles: Quantiles::of(&values),
        values,
        reduced,
        notes,
    })
}

/// From numbers of samples to the map, depth downward.
fn placed(lattice: &Lattice, format: Format, file: &CubeFile, notes: &mut Vec<String>) -> DAffine3 {
    let [i, j, k] = lattice.edges.map(DVec3::from_array);
    let in_file = DAffine3 {
        matrix3: glam::DMat3::from_cols(i, j, k),
        translation: DVec3::from_array(lattice.origin),
    };
    let down = match (file.vertical, format) {
        // Half of the way there and back.
        (VerticalAxis::Time(velocity), _) => 0.5e-3 * velocity,
        (VerticalAxis::Depth, _) => 1.0,
        (VerticalAxis::Elevation, _) => -1.0,
        (VerticalAxis::OfFormat, format) => {
            if format == Format::Segy {
                notes.push(format!(
                    "{}: the third axis was taken as depth; say \"vertical\": \"depth\" where that is right, or give \
                     \"velocity\" where it is two-way time in ms",
                    file.path.display()
                ));
            }
            downward(format)
        }
    };
    DAffine3::from_scale(DVec3::new(1.0, 1.0, down)) * in_file
}

/// Samples along each axis that one stands for, so that few enough are left.
fn reduction(dims: [usize; 3]) -> usize {
    let left = |n: usize| dims.map(|count| count.div_ceil(n));
    let fits = |n: &usize| {
        let product = left(*n)
            .iter()
            .try_fold(1, |all: usize, n| all.checked_mul(*n));
        product.is_some_and(|all| all <= MOST) && left(*n).iter().all(|n| *n <= MOST_ALONG)
    };
    (1..).find(fits).unwrap_or(1)
}

/// Means of so many samples along each axis, of those that have a value; NaN where less than half of them have one.
fn means(source: &VolumeFile, reduced: usize) -> Result<([usize; 3], Vec<f32>), ParseError> {
    let dims = source.lattice.dims;
    let size = dims.map(|n| n.div_ceil(reduced));
    let count: usize = size.iter().product();
    let mut values = Vec::new();
    let mut counts: Vec<u32> = Vec::new();
    let room = values.try_reserve_exact(count);
    let room = room.and_then(|()| counts.try_reserve_exact(if reduced > 1 { count } else { 0 }));
    room.map_err(|_| {
        let message = format!("{count} samples need more memory than there is");
        ParseError::of(ErrorKind::TooLarge, source.path(), At::File, "", message)
    })?;
    values.resize(count, if reduced > 1 { 0.0 } else { f32::NAN });
    counts.resize(if reduced > 1 { count } else { 0 }, 0);
    for slab in source.slabs(SLAB) {
        let read = source.f32s(slab)?;
        let rows = read.chunks_exact(slab.size[0].max(1));
        for (n, row) in rows.enumerate() {
            let j = (slab.start[1] + n % slab.size[1]) / reduced;
            let k = (slab.start[2] + n / slab.size[1]) / reduced;
            let first = size[0] * (j + size[1] * k);
            if reduced == 1 {
                values[first + slab.start[0]..][..row.len()].copy_from_slice(row);
                continue;
            }
            for (i, value) in (slab.start[0]..).zip(row).filter(|(_, v)| v.is_finite()) {
                values[first + i / reduced] += value;
                counts[first + i / reduced] += 1;
            }
        }
    }
    let half = reduced.pow(3).div_ceil(2);
    for (value, count) in values.iter_mut().zip(&counts) {
        *value = match *count as usize >= half {
            true => *value / *count as f32,
            false => f32::NAN,
        };
    }
    for value in values.iter_mut().filter(|v| !v.is_finite()) {
        *value = f32::NAN;
    }
    Ok((size, values))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_too_large_is_reduced() {
        assert_eq!(reduction([512, 512, 512]), 1);
        assert_eq!(reduction([513, 512, 512]), 2);
        assert_eq!(reduction([4097, 1, 1]), 3);
    }

    #[test]
    fn means_are_of_the_samples_that_have_a_value() {
        let text = "NRRD0004\ntype: float\ndimension: 3\nsizes: 3 2 2\nspacings: 1 1 1\nencoding: ascii\n\n1 2 9 3 4 9 5 6 nan 7 nan nan\n";
        let source = volume::from_bytes(("A.nrrd", text), &Options::default()).unwrap();
        let (size, values) = means(&source, 2).unwrap();
        assert_eq!(size, [2, 1, 1]);
        assert_eq!(values[0], 28.0 / 7.0);
        assert!(values[1].is_nan());
        assert_eq!(means(&source, 1).unwrap().1[..4], [1.0, 2.0, 9.0, 3.0]);
    }
}
