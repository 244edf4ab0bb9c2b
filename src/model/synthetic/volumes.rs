//! Regular volumes by formula, on which methods of light and sampling are compared.

use glam::DVec3;

use super::noise::Noise;
use crate::model::ids::{Dims, Ijk};

/// A volume by formula.
#[derive(Debug, Clone, Copy)]
pub struct VolumeRecipe {
    /// The name, in lower case.
    pub name: &'static str,
    /// Samples along each axis unless others are asked for.
    pub dims: Dims,
    /// What is in it, for help.
    pub describe: &'static str,
    formula: Formula,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Formula {
    Boxes,
    Bars,
    Shells,
    Noise,
    MarschnerLobb,
}

/// All volumes.
pub const VOLUMES: [VolumeRecipe; 5] = [
    VolumeRecipe {
        name: "boxes",
        dims: cube(128),
        describe: "twelve boxes of different heights on a floor, 2 to 20 samples apart",
        formula: Formula::Boxes,
    },
    VolumeRecipe {
        name: "bars",
        dims: Dims {
            ni: 512,
            nj: 256,
            nk: 256,
        },
        describe: "thin bars, 20 to 150 samples above a floor",
        formula: Formula::Bars,
    },
    VolumeRecipe {
        name: "shells",
        dims: cube(256),
        describe: "three nested spheres of the values 0.02, 0.2 and 0.95, of which an eighth is cut away",
        formula: Formula::Shells,
    },
    VolumeRecipe {
        name: "noise",
        dims: cube(128),
        describe: "fractal noise of five octaves above a threshold; another seed gives another one",
        formula: Formula::Noise,
    },
    VolumeRecipe {
        name: "marschner-lobb",
        dims: cube(41),
        describe: "the test signal of Marschner and Lobb (1994) for interpolation",
        formula: Formula::MarschnerLobb,
    },
];

const fn cube(n: usize) -> Dims {
    Dims {
        ni: n,
        nj: n,
        nk: n,
    }
}

/// A volume of some size, whose samples are computed when they are asked for. The third axis goes up.
#[derive(Debug, Clone, Copy)]
pub struct SyntheticVolume {
    formula: Formula,
    dims: Dims,
    noise: Noise,
}

impl VolumeRecipe {
    /// The recipe called `name`, in any letter case.
    pub fn named(name: &str) -> Option<&'static Self> {
        VOLUMES.iter().find(|v| v.name.eq_ignore_ascii_case(name))
    }

    /// The volume with so many samples; only noise depends on the seed.
    pub fn build(&self, dims: Dims, seed: u64) -> SyntheticVolume {
        SyntheticVolume {
            formula: self.formula,
            dims,
            noise: Noise::new(&mut fastrand::Rng::with_seed(seed)),
        }
    }
}

impl SyntheticVolume {
    /// Samples along each axis.
    pub fn dims(&self) -> Dims {
        self.dims
    }

    /// The value of a sample; k counts upward.
    pub fn value(&self, at: Ijk) -> f32 {
        let Dims { ni, nj, nk } = self.dims;
        let steps = DVec3::new(at.i as f64, at.j as f64, at.k as f64);
        let counts = DVec3::new(ni as f64, nj as f64, nk as f64);
        // Of a box of 1 x 1 x 1 that the samples fill, or reach the ends of.
        let middle = (steps + 0.5) / counts;
        let ends = steps / (counts - 1.0).max(DVec3::ONE);
        let value = match self.formula {
            Formula::Boxes => mask(is_in_boxes(128.0 * middle)),
            Formula::Bars => {
                let size = DVec3::new(512.0, 256.0, 256.0);
                mask(is_in_bars(middle * size, size / counts))
            }
            Formula::Shells => shells(256.0 * (middle - 0.5)),
            Formula::Noise => {
                let value = 0.5 + 0.5 * self.noise.fractal(FEATURES * middle, OCTAVES);
                if value > THRESHOLD { value } else { 0.0 }
            }
            Formula::MarschnerLobb => marschner_lobb(2.0 * ends - 1.0),
        };
        value as f32
    }
}

fn mask(is_inside: bool) -> f64 {
    if is_inside { 1.0 } else { 0.0 }
}

/// Low and high ends along x, and along y, of the boxes in a volume of 128 samples, with gaps of 2 to 20.
const BOXES_X: [[f64; 2]; 4] = [[10.0, 30.0], [32.0, 52.0], [60.0, 80.0], [100.0, 118.0]];
const BOXES_Y: [[f64; 2]; 3] = [[12.0, 36.0], [40.0, 64.0], [80.0, 112.0]];
/// Their heights, along x first.
const HEIGHTS: [f64; 12] = [
    30.0, 72.0, 48.0, 20.0, 96.0, 24.0, 64.0, 40.0, 56.0, 36.0, 110.0, 80.0,
];
/// Thickness of the floor.
const FLOOR: f64 = 6.0;

fn is_in_boxes(p: DVec3) -> bool {
    let within = |v: f64, ends: &[f64; 2]| (ends[0]..ends[1]).contains(&v);
    let x = BOXES_X.iter().position(|ends| within(p.x, ends));
    let y = BOXES_Y.iter().position(|ends| within(p.y, ends));
    let height = x.zip(y).map(|(x, y)| HEIGHTS[x + BOXES_X.len() * y]);
    p.z < FLOOR || height.is_some_and(|height| p.z < FLOOR + height)
}

/// Bars along y in a volume of 512 x 256 x 256 samples: place along x, height above the floor, thickness.
const BARS: [[f64; 3]; 7] = [
    [56.0, 20.0, 2.0],
    [120.0, 40.0, 3.0],
    [184.0, 60.0, 4.0],
    [248.0, 80.0, 5.0],
    [312.0, 100.0, 6.0],
    [376.0, 125.0, 4.0],
    [440.0, 150.0, 2.0],
];
/// Where they begin and end along y.
const BAR_ENDS: [f64; 2] = [32.0, 224.0];

/// Bars are at least one sample thick; samples are `step` apart.
fn is_in_bars(p: DVec3, step: DVec3) -> bool {
    let is_in = |[x, height, thickness]: &[f64; 3]| {
        let above = p.z - FLOOR - height;
        let is_above = (0.0..thickness.max(step.z)).contains(&above);
        (p.x - x).abs() <= 0.5 * thickness.max(step.x) && is_above
    };
    let is_along = (BAR_ENDS[0]..BAR_ENDS[1]).contains(&p.y);
    p.z < FLOOR.max(step.z) || is_along && BARS.iter().any(is_in)
}

/// Radii of the spheres in a volume of 256 samples, and the values inside of them.
const SPHERES: [(f64, f64); 3] = [(44.0, 0.95), (84.0, 0.2), (120.0, 0.02)];

/// An upper eighth is cut out of all but the innermost sphere.
fn shells(p: DVec3) -> f64 {
    let is_cut = p.x > 0.0 && p.y < 0.0 && p.z > 0.0;
    let radius = p.length();
    let within = SPHERES.iter().position(|(r, _)| radius < *r);
    match within {
        Some(0) => SPHERES[0].1,
        Some(n) if !is_cut => SPHERES[n].1,
        _ => 0.0,
    }
}

/// Features of noise across the volume, octaves, and the value from which on it is kept.
const FEATURES: f64 = 4.0;
const OCTAVES: u32 = 5;
const THRESHOLD: f64 = 0.5;

/// In a box from -1 to 1, with frequency 6 and amplitude 0.25.
fn marschner_lobb(p: DVec3) -> f64 {
    use std::f64::consts::{FRAC_PI_2, PI};
    let radius = p.x.hypot(p.y);
    let ring = (2.0 * PI * 6.0 * (FRAC_PI_2 * radius).cos()).cos();
    (1.0 - (FRAC_PI_2 * p.z).sin() + 0.25 * (1.0 + ring)) / 2.5
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    /// Share of the samples above a value.
    fn share(name: &str, seed: u64, above: f32) -> f64 {
        let recipe = VolumeRecipe::named(name).unwrap();
        let dims = cube(40);
        let volume = recipe.build(dims, seed);
        let cells = 0..dims.cells() as u32;
        let values = cells.map(|n| volume.value(dims.ijk(crate::model::CellIndex(n))));
        let values: Vec<f32> = values.collect();
        assert!(values.iter().all(|v| (0.0..=1.0).contains(v)), "{name}");
        values.iter().filter(|v| **v > above).count() as f64 / values.len() as f64
    }

    #[test]
    fn volumes_hold_what_they_promise() {
        let spheres = |radius: f64| 4.0 / 3.0 * std::f64::consts::PI * (radius / 256.0).powi(3);
        assert!((share("SHELLS", 1, 0.9) / spheres(44.0) - 1.0).abs() < 0.05);
        let middle = 0.875 * (spheres(84.0) - spheres(44.0)) + spheres(44.0);
        assert!((share("shells", 1, 0.1) / middle - 1.0).abs() < 0.05);
        // A floor of 6 in 128 and boxes of 78 x 80 that are 56 high in the mean.
        let boxes = 6.0 / 128.0 + 78.0 * 80.0 * 56.0 / 128.0_f64.powi(3);
        assert!((share("boxes", 1, 0.5) / boxes - 1.0).abs() < 0.1);
        let noise = [1, 2].map(|seed| share("noise", seed, 0.0));
        assert!(noise.iter().all(|share| (0.2..0.8).contains(share)) && noise[0] != noise[1]);
        assert_eq!(share("boxes", 1, 0.5), share("boxes", 2, 0.5));
        // A floor of one in 40 samples and seven bars along 30 of 40.
        let bars = 1.0 / 40.0 + 7.0 * 30.0 / 40.0_f64.powi(3);
        assert!((share("bars", 1, 0.5) / bars - 1.0).abs() < 0.1);
    }

    #[test]
    fn the_signal_of_marschner_and_lobb_has_its_known_values() {
        let recipe = VolumeRecipe::named("marschner-lobb").unwrap();
        let volume = recipe.build(recipe.dims, 1);
        let at = |i, j, k| f64::from(volume.value(Ijk { i, j, k }));
        // In the middle the ring has its crest: (1 + 0.25 * 2) / 2.5.
        assert!((at(20, 20, 20) - 0.6).abs() < 1e-6);
        assert!((at(20, 20, 40) - 0.2).abs() < 1e-6);
        assert!((at(20, 20, 0) - 1.0).abs() < 1e-6);
        // At a distance of 1 the cosine is 0, and of the ring 1 again.
        assert!((at(40, 20, 20) - 0.6).abs() < 1e-6);
        assert!((at(30, 20, 20) - 0.6).abs() > 0.01);
    }
}
