//! What else than cells stands in the way of light, as opacities of voxels, without a device: wells and sheets of faults.
//!
//! They are thinner than voxels, so that a ray which crosses a voxel meets them by chance. Over all directions a convex
//! body shows a fourth of its surface, and a sheet half of its area (Cauchy's formula).

use std::f64::consts::FRAC_PI_2;

use glam::{DVec2, DVec3};

use super::compact_grid::GridFacts;
use super::light::LightSpace;
use crate::model::Grid;
use crate::model::topology::Face;
use crate::scene::Hull;
use crate::view::View;
use crate::view::surfaces::SHEET_OPACITY;

/// Opacity of a unit of length that none exceeds: what lies in few voxels is opaque by it, and half floats tell it from
/// one.
const MOST_OPACITY: f32 = 0.95;

/// Opacities that wells and sheets add to those of cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Occluders {
    /// Voxels along the grid's x, y and depth.
    pub size: [u32; 3],
    /// Chance that they stop a ray within a unit of length, the finest level's standard deviation: 0 to 255, x fastest.
    pub opacities: Vec<u8>,
}

impl Occluders {
    /// Those of a view of a case's grid; `None` where none are shown, or cells alone cast light's shadows.
    pub fn of(facts: &GridFacts, view: &View, grid: &Grid) -> Option<Self> {
        let lighting = &view.style.lighting;
        let surfaces = view.style.surfaces;
        let has_sheets = surfaces.faults && surfaces.hull != Hull::Opaque;
        if !lighting.geometry || !(surfaces.wells || has_sheets) {
            return None;
        }
        let space = LightSpace::new(facts, view);
        let lattice = Lattice::new(lighting.size(), lighting.extent / lighting.sigma());
        let mut opacities = vec![0.0; lattice.count()];
        if has_sheets {
            for (opacity, area) in opacities
                .iter_mut()
                .zip(sheets(&lattice, &space, view, grid))
            {
                *opacity = SHEET_OPACITY as f32 * (0.5 * lattice.per_volume(area)).min(1.0);
            }
        }
        if surfaces.wells {
            let tubes = tubes(&lattice, &space, view);
            for (opacity, tube) in opacities.iter_mut().zip(tubes) {
                *opacity = 1.0 - (1.0 - *opacity) * (1.0 - tube);
            }
        }
        Some(Self {
            size: lattice.size,
            opacities: opacities
                .iter()
                .map(|o| (255.0 * o.min(MOST_OPACITY)).round() as u8)
                .collect(),
        })
    }

    /// Those of a row of voxels along x, 0 to 1.
    pub fn row(&self, y: usize, z: usize) -> impl Iterator<Item = f32> {
        let [width, height, _] = self.size.map(|n| n as usize);
        let first = width * (y + height * z);
        let row = self.opacities[first..first + width].iter();
        row.map(|part| f32::from(*part) / 255.0)
    }
}

/// Voxels of a box, in units of length.
struct Lattice {
    size: [u32; 3],
    /// Edges of a voxel.
    edges: DVec3,
}

impl Lattice {
    fn new(size: [u32; 3], extent: DVec3) -> Self {
        Self {
            size,
            edges: extent / DVec3::from_array(size.map(f64::from)),
        }
    }

    fn count(&self) -> usize {
        self.size.iter().map(|n| *n as usize).product()
    }

    /// The voxels around a point and the part of what is there that each has, so that what a voxel has does not depend
    /// on which side of its border a point happens to lie.
    fn around(&self, point: DVec3) -> impl Iterator<Item = (usize, f32)> {
        let place = point / self.edges - 0.5;
        let low = place.floor();
        let part = (place - low).to_array();
        let low = low.to_array().map(|n| n as i64);
        (0..8).filter_map(move |corner| {
            let mut weight = 1.0;
            let mut at = [0; 3];
            for axis in 0..3 {
                let up = corner >> axis & 1;
                weight *= if up == 1 {
                    part[axis]
                } else {
                    1.0 - part[axis]
                };
                let n = low[axis] + up;
                at[axis] = usize::try_from(n)
                    .ok()
                    .filter(|n| *n < self.size[axis] as usize)?;
            }
            Some((self.number(at), weight as f32))
        })
    }

    fn number(&self, [x, y, z]: [usize; 3]) -> usize {
        x + self.size[0] as usize * (y + self.size[1] as usize * z)
    }

    /// What lies in a voxel as a part of its volume.
    fn per_volume(&self, measure: f32) -> f32 {
        measure / self.edges.element_product() as f32
    }

    /// First and last voxel of a box along each axis; `None` where it lies outside.
    fn range(&self, [low, high]: [DVec3; 2]) -> Option<[[usize; 3]; 2]> {
        let last = self.size.map(|n| f64::from(n) - 1.0);
        let [low, high] = [low, high].map(|p| (p / self.edges).floor().to_array());
        let meets = |a: usize| low[a] <= last[a] && high[a] >= 0.0;
        (0..3).all(meets).then(|| {
            [low, high].map(|p| std::array::from_fn(|a| p[a].clamp(0.0, last[a]) as usize))
        })
    }
}

/// Opacities of the tubes of wells.
fn tubes(lattice: &Lattice, space: &LightSpace<'_>, view: &View) -> Vec<f32> {
    let mut opacities = vec![0.0f32; lattice.count()];
    let step = 0.25 * lattice.edges.min_element();
    for capsule in &view.shown.wells.capsules {
        let [a, b] = capsule.ends.map(|end| space.point(end).as_dvec3());
        let radius = capsule.radius / view.style.lighting.sigma();
        let steps = (a.distance(b) / step).ceil().max(1.0);
        let length = a.distance(b) / steps;
        // A fourth of the surface of so much of a cylinder.
        let shown = (FRAC_PI_2 * radius * length) as f32;
        for n in 0..steps as u64 {
            let at = a.lerp(b, (n as f64 + 0.5) / steps);
            for (voxel, part) in lattice.around(at) {
                let more = part * lattice.per_volume(shown);
                opacities[voxel] = (opacities[voxel] + more).min(1.0);
            }
        }
        if radius > 0.5 * lattice.edges.min_element() {
            cover(lattice, [a, b], radius, &mut opacities);
        }
    }
    opacities
}

/// Covers the voxels of a capsule that is thicker than they are.
fn cover(lattice: &Lattice, [a, b]: [DVec3; 2], radius: f64, opacities: &mut [f32]) {
    let around = DVec3::splat(radius) + lattice.edges;
    let Some([low, high]) = lattice.range([a.min(b) - around, a.max(b) + around]) else {
        return;
    };
    let (axis, edge) = (b - a, lattice.edges.element_sum() / 3.0);
    for z in low[2]..=high[2] {
        for y in low[1]..=high[1] {
            for x in low[0]..=high[0] {
                let at = (DVec3::from_array([x, y, z].map(|n| n as f64)) + 0.5) * lattice.edges;
                let along = (at - a).dot(axis) / axis.length_squared().max(1e-300);
                let off = at.distance(a + along.clamp(0.0, 1.0) * axis);
                let covered = ((radius - off) / edge + 0.5).clamp(0.0, 1.0) as f32;
                let opacity = &mut opacities[lattice.number([x, y, z])];
                *opacity = opacity.max(covered);
            }
        }
    }
}

/// Areas of the sheets of faults. The faces on both sides of a fault are one sheet: the larger area counts.
fn sheets(
    lattice: &Lattice,
    space: &LightSpace<'_>,
    view: &View,
    grid: &Grid,
) -> impl Iterator<Item = f32> {
    let mut sides = [0, 1].map(|_| vec![0.0f32; lattice.count()]);
    for (cell, face, _) in view.fault_faces(grid) {
        let is_second = matches!(face, Face::IPlus | Face::JPlus | Face::KPlus);
        let corners = grid.hexahedron(cell).0;
        let [mine, _] = face.corners();
        let world_from_grid = view.world.spaces.world_from_grid;
        let corners = mine.map(|n| {
            let world = world_from_grid.transform_point3(corners[n]);
            space.point(world).as_dvec3()
        });
        add_face(lattice, corners, &mut sides[usize::from(is_second)]);
    }
    let [first, second] = sides;
    first.into_iter().zip(second).map(|(a, b)| a.max(b))
}

/// Adds the area of a bilinear face to the voxels that have it.
fn add_face(lattice: &Lattice, [a, b, c, d]: [DVec3; 4], areas: &mut [f32]) {
    let steps = |edges: [DVec3; 2]| {
        let voxels = edges.map(|e| (e / lattice.edges).abs().max_element());
        (2.0 * voxels[0].max(voxels[1])).ceil().max(1.0)
    };
    let counts = DVec2::new(steps([b - a, d - c]), steps([c - a, d - b]));
    for v in 0..counts.y as u64 {
        for u in 0..counts.x as u64 {
            let at = (DVec2::new(u as f64, v as f64) + 0.5) / counts;
            let along = (b - a).lerp(d - c, at.y) / counts.x;
            let across = (c - a).lerp(d - b, at.x) / counts.y;
            let point = a.lerp(b, at.x).lerp(c.lerp(d, at.x), at.y);
            for (voxel, part) in lattice.around(point) {
                areas[voxel] += part * along.cross(across).length() as f32;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_has_its_area_in_the_voxels_that_have_it() {
        let lattice = Lattice::new([8, 4, 4], DVec3::new(8.0, 4.0, 8.0));
        let mut areas = vec![0.0; lattice.count()];
        let [a, b] = [DVec3::new(1.0, 0.5, 0.5), DVec3::new(6.0, 3.5, 0.5)];
        let down = DVec3::new(0.0, 0.0, 5.0);
        add_face(&lattice, [a, b, a + down, b + down], &mut areas);
        let sum: f32 = areas.iter().sum();
        let whole = (b - a).length() * 5.0;
        assert!((f64::from(sum) - whole).abs() < 1e-4, "{sum} {whole}");
        let middle = areas[lattice.number([3, 2, 1])];
        assert!(middle > 0.5, "{middle}");
        // The twin: beside the face there is nothing.
        assert_eq!(areas[lattice.number([1, 3, 1])], 0.0);
    }

    #[test]
    fn thick_tubes_cover_voxels() {
        let lattice = Lattice::new([9; 3], DVec3::splat(9.0));
        let mut opacities = vec![0.0; lattice.count()];
        let ends = [DVec3::new(4.5, 4.5, -2.0), DVec3::new(4.5, 4.5, 20.0)];
        cover(&lattice, ends, 2.0, &mut opacities);
        let volume: f32 = opacities.iter().sum::<f32>() / 9.0;
        assert!((volume - 12.57).abs() < 0.7, "{volume}");
        assert_eq!(opacities[lattice.number([4, 4, 0])], 1.0);
        assert_eq!(opacities[lattice.number([8, 4, 4])], 0.0);
    }
}
