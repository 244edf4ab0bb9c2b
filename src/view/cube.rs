//! A regular volume beside the model, such as seismic, drawn together with it.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};

use super::colors;
use super::error::{SceneError, positive, wrong};
use crate::case::load;
use crate::case::{Case, Cube, CubeFile, Quantiles, VerticalAxis};
use crate::model::{Space, Spaces};
use crate::scene::{
    ColorSpec, Coloring, CropSpec, OpacitySpec, ScaleSpec, Scene, TransferSpec, VerticalSpec,
    VolumeSpec,
};
use crate::transfer::{Scale, TransferFunction};

/// A cube that a view shows.
///
/// It is the samples of its file and all between them: a sample stands for a parallelepiped around it, so that the cube
/// reaches half a step beyond the outermost ones. At a place let `p` be the trilinear interpolation of presence, 1 at
/// samples with a value and 0 at all others, and `v` that of value times presence, divided by `p`. Beyond the outermost
/// samples both are as there.
///
/// Rays sample it on the lattice of distances of all strategies, at the borders between samples of cells, so that
/// both alternate: at `n * stride * step`, n being 1, 2 and so on, inside of the crop and on the kept side of all
/// clip planes. A sample covers what is behind it by `p (1 - exp(-tau * stride * step))`, where `tau` is the extinction at
/// `v`. What lies between two such samples is blended in the order of the distances: cells, surfaces and cube.
///
/// Its samples have their colors by themselves: no light shades them, and they cast no shadow.
#[derive(Debug, Clone)]
pub struct ShownCube {
    /// Its values.
    pub cube: Arc<Cube>,
    /// From numbers of samples to world space.
    pub world_from_sample: DAffine3,
    /// Smallest and largest number of a sample along each axis of what is drawn; samples are whole numbers.
    pub crop: [DVec3; 2],
    /// Value to color and extinction.
    pub transfer: TransferFunction,
    /// Values lie below the range, and above.
    pub beyond: [bool; 2],
    /// Steps of the lattice from one sample to the next.
    pub stride: u32,
}

/// Part of the shortest edge of a voxel that lies between two samples of a ray, at most.
const PART_OF_EDGE: f64 = 0.5;
/// Samples that a ray takes at most: shaders in software end after 65,535 iterations of all loops.
const MOST_SAMPLES: f64 = 8192.0;

impl ShownCube {
    /// Corners in world space; bit n of the index is the end along axis n.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|c| {
            let at = DVec3::from_array(std::array::from_fn(|axis| self.crop[c >> axis & 1][axis]));
            self.world_from_sample.transform_point3(at)
        })
    }

    /// Distance between two samples of a ray, given that of the lattice.
    pub fn step(&self, lattice: f64) -> f64 {
        f64::from(self.stride) * lattice
    }

    /// The samples that a ray of world space takes, given the step of the lattice: distance, value and presence of those
    /// with a value.
    pub fn along(
        &self,
        origin: DVec3,
        direction: DVec3,
        lattice: f64,
    ) -> impl Iterator<Item = (f64, f64, f64)> {
        let step = self.step(lattice);
        let sample_from_world = self.world_from_sample.inverse();
        let from = sample_from_world.transform_point3(origin);
        let along = sample_from_world.transform_vector3(direction);
        let [low, high] = self.crop.map(|corner| (corner - from) / along);
        // A ray along a side gives 0 / 0, which `min` and `max` pass over.
        let enter = low.min(high).to_array().into_iter().fold(0.0, f64::max);
        let leave = low.max(high).to_array();
        let leave = leave.into_iter().fold(f64::INFINITY, f64::min);
        let last = match leave.is_finite() {
            true => (leave / step).floor().max(0.0) as u64,
            false => 0,
        };
        let first = ((enter / step).ceil() as u64).max(1);
        (first..=last).filter_map(move |n| {
            let distance = n as f64 * step;
            let (value, presence) = self.interpolated(from + distance * along);
            (presence > 0.0).then_some((distance, value, presence))
        })
    }

    /// Value and presence at a place in numbers of samples.
    fn interpolated(&self, sample: DVec3) -> (f64, f64) {
        let size = self.cube.size;
        let last = DVec3::from_array(size.map(|n| n as f64 - 1.0));
        let place = sample.clamp(DVec3::ZERO, last);
        let (mut value, mut presence) = (0.0, 0.0);
        for corner in 0..8 {
            let mut weight = 1.0;
            let mut index = [0; 3];
            for axis in 0..3 {
                let low = place[axis].floor();
                let part = place[axis] - low;
                let up = corner >> axis & 1;
                weight *= if up == 1 { part } else { 1.0 - part };
                index[axis] = (low as usize + up).min(size[axis] - 1);
            }
            let [i, j, k] = index;
            let found = self.cube.values[i + size[0] * (j + size[1] * k)];
            if weight > 0.0 && !found.is_nan() {
                value += weight * f64::from(found);
                presence += weight;
            }
        }
        (value / presence.max(1e-30), presence)
    }
}

/// What a scene asks of volumes in vain, and what was guessed of their files, one sentence each.
///
/// # Errors
/// When a file cannot be read.
pub fn warnings(scene: &Scene, case: &Case) -> Result<Vec<String>, SceneError> {
    let Some(spec) = asked(scene)? else {
        return Ok(Vec::new());
    };
    if !Space::from(scene.space).is_map() {
        return Ok(vec![format!(
            "{} is not drawn by I, J and K: it has no place there",
            spec.file.display()
        )]);
    }
    Ok(read(spec, case)?.notes.clone())
}

/// The one volume that is drawn.
fn asked(scene: &Scene) -> Result<Option<&VolumeSpec>, SceneError> {
    let mut shown = scene.volumes.iter().filter(|volume| volume.show);
    let first = shown.next();
    match shown.next() {
        None => Ok(first),
        Some(_) => {
            let problem = "one volume at a time is drawn; say \"show\": false in all others";
            Err(wrong("volumes", problem))
        }
    }
}

fn read(spec: &VolumeSpec, case: &Case) -> Result<Arc<Cube>, SceneError> {
    let vertical = match (spec.velocity, spec.vertical) {
        (Some(velocity), None) => VerticalAxis::Time(positive("volumes.velocity", velocity)?),
        (Some(_), Some(_)) => {
            let problem = "is for time, and \"vertical\" says that there is none; leave one out";
            return Err(wrong("volumes.velocity", problem));
        }
        (None, Some(VerticalSpec::Depth)) => VerticalAxis::Depth,
        (None, Some(VerticalSpec::Elevation)) => VerticalAxis::Elevation,
        (None, None) => VerticalAxis::OfFormat,
    };
    let folder = case.about.files.first().and_then(|file| file.parent());
    let path = folder.map_or_else(|| spec.file.clone(), |folder| folder.join(&spec.file));
    Ok(case
        .cubes
        .get(&CubeFile { path, vertical }, load::cube::read)?)
}

/// The cube of a scene in a picture whose rays take samples at this distance.
pub(super) fn shown(
    scene: &Scene,
    case: &Case,
    spaces: &Spaces,
    step: f64,
) -> Result<Option<Arc<ShownCube>>, SceneError> {
    let Some(spec) = asked(scene)?.filter(|_| case.grid.space().is_map()) else {
        return Ok(None);
    };
    let cube = read(spec, case)?;
    let world_from_sample = spaces.map_to_world() * cube.map_from_sample;
    let edges = edges(world_from_sample.matrix3);
    let (transfer, beyond) = transfer(spec, cube.quantiles, edges.element_sum() / 3.0)?;
    let mut shown = ShownCube {
        crop: crop(&spec.crop, &cube)?,
        cube,
        world_from_sample,
        transfer,
        beyond,
        stride: 1,
    };
    let corners = shown.corners();
    let diagonals = (0..4).map(|c| corners[c].distance(corners[7 - c]));
    let longest = diagonals.fold(0.0, f64::max);
    let wanted = (PART_OF_EDGE * edges.min_element() / step).floor();
    let stride = wanted.max((longest / (MOST_SAMPLES * step)).ceil());
    shown.stride = stride.clamp(1.0, f64::from(1 << 20)) as u32;
    Ok(Some(Arc::new(shown)))
}

/// Lengths of the columns.
fn edges(matrix: DMat3) -> DVec3 {
    DVec3::new(
        matrix.x_axis.length(),
        matrix.y_axis.length(),
        matrix.z_axis.length(),
    )
}

/// The crop in numbers of samples of the cube, which may be fewer than those of the file.
fn crop(spec: &CropSpec, cube: &Cube) -> Result<[DVec3; 2], SceneError> {
    let mut crop = [DVec3::ZERO; 2];
    let axes = [
        ("volumes.crop.i", spec.i),
        ("volumes.crop.j", spec.j),
        ("volumes.crop.k", spec.k),
    ];
    for (axis, (field, ends)) in axes.into_iter().enumerate() {
        let count = cube.size[axis];
        let reduced = cube.reduced as f64;
        let [low, high] = match ends {
            None => [0.0, count as f64],
            Some([first, last]) if 1 <= first && first <= last && last <= count * cube.reduced => {
                [(first as f64 - 1.0) / reduced, last as f64 / reduced]
            }
            Some(_) => {
                let last = count * cube.reduced;
                let problem = format!("must be [first, last] with 1 <= first <= last <= {last}");
                return Err(wrong(field, problem));
            }
        };
        // Each sample stands for half a step to both sides.
        (crop[0][axis], crop[1][axis]) = (low - 0.5, high - 0.5);
    }
    Ok(crop)
}

/// Colors and opacities, and whether values lie below or above their range.
fn transfer(
    spec: &VolumeSpec,
    quantiles: Option<Quantiles>,
    mean_edge: f64,
) -> Result<(TransferFunction, [bool; 2]), SceneError> {
    let values = quantiles.unwrap_or(Quantiles {
        min: 0.0,
        low: 0.0,
        high: 1.0,
        max: 1.0,
    });
    let is_signed = values.low < 0.0 && values.high > 0.0;
    let range = match spec.range {
        Some([low, high]) if low.is_finite() && high.is_finite() && low < high => [low, high],
        Some(_) => {
            return Err(wrong(
                "volumes.range",
                "must be two numbers, the smaller first",
            ));
        }
        None if is_signed => {
            let most = values.high.max(-values.low);
            [-most, most]
        }
        None if values.low < values.high => [values.low, values.high],
        None => [values.low - 0.5, values.low + 0.5],
    };
    let look = match (&spec.transfer, is_signed) {
        (Some(look), _) => look.clone(),
        // Strong values of both signs are what one looks for.
        (None, true) => look(
            "redblue",
            &[[0.0, 0.2], [0.15, 0.0], [0.85, 0.0], [1.0, 0.2]],
        ),
        (None, false) => look("gray", &[[0.0, 0.0], [0.5, 0.02], [1.0, 0.2]]),
    };
    let (color, bands) = match (look.scale, look.coloring) {
        (ScaleSpec::Log, _) => {
            let problem = "of a volume must be \"linear\"";
            return Err(wrong("volumes.transfer.scale", problem));
        }
        (_, Coloring::Categories) => {
            let problem = "of a volume must be \"continuous\" or \"banded\"";
            return Err(wrong("volumes.transfer.coloring", problem));
        }
        _ => colors::colors(&look, &Scale::Linear)?,
    };
    let opacity = match &look.opacity {
        None => colors::default_opacity(&Scale::Linear),
        Some(OpacitySpec::Points(points)) => colors::checked(points)?,
        Some(OpacitySpec::Found(_)) => {
            let problem = "of a volume must be points [[position, opacity], ...]";
            return Err(wrong("volumes.transfer.opacity", problem));
        }
    };
    let reference_length = match look.reference_length {
        Some(length) => positive("volumes.transfer.reference_length", length)?,
        None => mean_edge,
    };
    let transfer = TransferFunction {
        color,
        opacity,
        range,
        scale: Scale::Linear,
        bands,
        reference_length,
    };
    Ok((transfer, [values.min < range[0], values.max > range[1]]))
}

/// Colors of a map, and opacities.
fn look(color: &str, opacity: &[[f64; 2]]) -> TransferSpec {
    TransferSpec {
        color: ColorSpec::Name(color.into()),
        opacity: Some(OpacitySpec::Points(opacity.to_vec())),
        ..TransferSpec::default()
    }
}

#[cfg(test)]
mod tests {
    /// How much of the light the cells add where two even media of optical depth 2 lie in one place, in so many steps.
    /// Samples of the cube lie between those of the cells, or with them.
    fn of_cells(steps: usize, alternate: bool) -> f64 {
        let depth = 2.0 / steps as f64;
        let (mut transmittance, mut cells) = (1.0, 0.0);
        let mut pass = |depth: f64, is_cell: bool| {
            let opacity = 1.0 - (-depth).exp();
            if is_cell {
                cells += transmittance * opacity;
            }
            transmittance *= 1.0 - opacity;
        };
        for n in 0..steps {
            if alternate {
                // Half of the first one lies before the media, as half of the last one behind them.
                pass(if n == 0 { 0.5 * depth } else { depth }, false);
                pass(depth, true);
            } else {
                pass(depth, true);
                pass(depth, false);
            }
        }
        cells
    }

    #[test]
    fn alternate_samples_are_wrong_by_the_square_of_a_step() {
        // Of even media each adds its part of the optical depth.
        let exact = 0.5 * (1.0 - (-4.0f64).exp());
        let error = |steps, alternate| (of_cells(steps, alternate) - exact).abs();
        for steps in [5, 10, 20, 40] {
            let [fine, coarse] = [2 * steps, steps].map(|n| error(n, true));
            let twins = [2 * steps, steps].map(|n| error(n, false));
            println!("{:.2} {coarse:.5} {:.5}", 4.0 / steps as f64, twins[1]);
            assert!((coarse / fine - 4.0).abs() < 0.1, "{coarse} {fine}");
            assert!((twins[1] / twins[0] - 2.0).abs() < 0.1, "{twins:?}");
        }
    }
}
