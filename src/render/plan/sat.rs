//! Summed-area tables of extinction (schlegel-2011) without a device: light along a cone by boxes that touch.
//!
//! A voxel of the table holds the sum of the optical depths of all voxels with smaller or equal indices, so that the
//! sum over any box is eight lookups away. Sums are whole numbers of 32 bits that wrap around: differences of them are
//! exact where the sum of the box itself fits, however large the table is.

use super::frame::ghost;
use super::transfer::extinctions;
use crate::scene::lighting::LightMethod;
use crate::view::View;
use crate::view::lighting::Cone;

/// Optical depth of a unit of length behind which nothing more is seen to change: more is counted as that.
pub const DEEPEST: f32 = 8.0;
/// Numbers that an optical depth is told apart by, at most; fewer where boxes are large.
const MOST_COUNTS: f64 = 65_535.0;
/// A curve with less shows nothing.
const LEAST_DEPTH: f64 = 1e-6;

/// A box across a cone, in standard deviations of the finest level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// From the tip to its middle.
    pub distance: f64,
    /// Edge of the cube.
    pub edge: f64,
    /// Length of the cone that it stands for.
    pub length: f64,
}

/// Cubes that touch, as wide as the cone is at their middles, at least one unit, given the finest level's standard
/// deviation in world space. The last one ends with the cone.
pub fn sections(cone: &Cone, sigma: f64) -> Vec<Section> {
    let (tangent, end) = (cone.half_angle.tan(), cone.length / sigma);
    let mut sections = Vec::new();
    let mut start = cone.gap;
    while start < end {
        // A cube about `middle` whose near face is at `start`.
        let middle = match 1.0 - tangent {
            part if part > 0.0 => (start / part).max(start + 0.5),
            _ => f64::INFINITY,
        };
        let middle = middle.min(0.5 * (start + end));
        let length = 2.0 * (middle - start);
        sections.push(Section {
            distance: middle,
            edge: (2.0 * middle * tangent).max(1.0),
            length,
        });
        // Where all that is left is one box, it ends with the cone.
        start = match middle < 0.5 * (start + end) {
            true => start + length,
            false => end,
        };
    }
    sections
}

/// Numbers that a unit of optical depth is counted in: as many as fit the largest box that the cones of a view ask for;
/// none where it asks for none.
pub fn counts(view: &View) -> f32 {
    let lighting = &view.style.lighting;
    let occlusion = lighting.occlusion.iter();
    let viewer = occlusion.filter(|o| o.method == LightMethod::Sat);
    let lights = lighting.lights.iter();
    let lights = lights.filter(|_| lighting.shadow_method == LightMethod::Sat);
    let cones = viewer.map(|o| o.cone).chain(lights.map(|l| l.cone));
    let (sigma, size) = (lighting.sigma(), lighting.size().map(f64::from));
    let voxels = |edge: f64| -> f64 {
        let along = |axis: usize| {
            let spacing = lighting.extent[axis] / size[axis] / sigma;
            (edge / spacing + 2.0).min(size[axis])
        };
        (0..3).map(along).product()
    };
    let of_cone = |cone: Cone| {
        let edges = sections(&cone, sigma).into_iter().map(|s| s.edge);
        voxels(edges.fold(1.0, f64::max))
    };
    let Some(largest) = cones.map(of_cone).reduce(f64::max) else {
        return 0.0;
    };
    let extinctions = extinctions(&view.style.transfer);
    let most = extinctions.into_iter().fold(ghost(view)[3], f32::max);
    let deepest = (f64::from(most) * sigma).clamp(LEAST_DEPTH, f64::from(DEEPEST));
    let counts = (f64::from(u32::MAX) / largest).floor().min(MOST_COUNTS) - 1.0;
    (counts / deepest) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cone(degrees: f64, length: f64) -> Cone {
        Cone {
            half_angle: degrees.to_radians(),
            splits: 1,
            attenuation: 1.0,
            gap: 3.0,
            length,
            even_media: false,
        }
    }

    #[test]
    fn boxes_touch_from_the_gap_to_the_end() {
        for degrees in [0.5, 5.0, 20.0, 40.0, 45.0] {
            let all = sections(&cone(degrees, 50.0), 1.0);
            let length: f64 = all.iter().map(|s| s.length).sum();
            assert!((length - 47.0).abs() < 1e-9, "{degrees}: {length}");
            for pair in all.windows(2) {
                let [a, b] = pair else { continue };
                let touch = a.distance + 0.5 * a.length - (b.distance - 0.5 * b.length);
                assert!(touch.abs() < 1e-9);
            }
            let (last, first) = all.split_last().unwrap_or_else(|| panic!("no box"));
            assert!(first.iter().all(|s| (s.edge - s.length).abs() < 1e-9));
            assert!(last.edge >= last.length - 1e-9);
        }
        // As wide as a voxel where the cone is narrower.
        assert_eq!(sections(&cone(0.5, 50.0), 1.0)[0].edge, 1.0);
    }
}
