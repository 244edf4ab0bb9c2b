//! A cube beside the model: its samples on a ray, blended between what else the ray meets. The twin of
//! `shaders/shared/cube.wgsl`; `ShownCube` in view/cube.rs says what is seen.

use glam::{Vec3A, Vec4};

use super::frame::{Frame, PixelRay};
use super::kept::Kept;
use super::transfer::{Accumulated, Tables, passed};
use super::volume::{ONE_PART, Voxels, in_parts};
use crate::case;
use crate::render::plan::GridFacts;
use crate::render::plan::cube::{CubeNumbers, cube_range, cube_table};
use crate::render::revisions::Revisions;
use crate::view::View;

/// Value, as a part of the range of all values, times presence; and presence.
pub type CubeVoxels = Voxels<[u16; 2]>;

/// The voxels of a cube.
fn voxels(cube: &case::Cube) -> CubeVoxels {
    let [low, high] = cube_range(cube);
    let mut voxels = Voxels::new(cube.size.map(|n| n as u32));
    for (voxel, value) in voxels.data.iter_mut().zip(&cube.values) {
        if !value.is_nan() {
            let part = (f64::from(*value) - low) / (high - low);
            *voxel = [in_parts(part as f32), u16::MAX];
        }
    }
    voxels
}

/// What is kept of a cube from image to image.
#[derive(Default)]
pub struct KeptCube {
    voxels: Kept<CubeVoxels>,
    tables: Kept<Tables>,
}

impl KeptCube {
    /// The cube that a view of a grid shows; `None` where there is none, of which nothing is kept.
    pub fn update(&mut self, grid: &GridFacts, view: &View, now: Revisions) -> Option<Cube<'_>> {
        let Some(shown) = &view.shown.cube else {
            *self = Self::default();
            return None;
        };
        if !self.voxels.is_of(now.cube) {
            self.voxels.keep(now.cube, voxels(&shown.cube));
        }
        if !self.tables.is_of(now.cube_look) {
            let tables = Tables::of(&cube_table(view, shown));
            self.tables.keep(now.cube_look, tables);
        }
        Some(Cube {
            voxels: self.voxels.get()?,
            tables: self.tables.get()?,
            numbers: CubeNumbers::new(grid, view, shown, cube_range(&shown.cube)),
        })
    }
}

/// What rays sample.
pub struct Cube<'a> {
    /// The voxels.
    pub voxels: &'a CubeVoxels,
    /// Colors and extinctions.
    pub tables: &'a Tables,
    /// Where it is.
    pub numbers: CubeNumbers,
}

/// The samples that a ray has not passed yet.
#[derive(Debug, Clone, Copy)]
pub struct March {
    /// Numbers of the next sample and of the last one.
    next: f32,
    last: f32,
    /// Place in the box of the ray's origin, and what a unit of distance adds.
    origin: Vec3A,
    along: Vec3A,
}

impl Cube<'_> {
    /// The samples of a ray; `None` where it meets nothing of the cube.
    pub fn march(&self, frame: &Frame, ray: &PixelRay) -> Option<March> {
        let rows = self.numbers.box_from_grid.map(Vec4::from);
        let origin = ray.origin.extend(1.0);
        let direction = ray.direction.extend(0.0);
        let origin = Vec3A::from_array(rows.map(|row| row.dot(origin)));
        let along = Vec3A::from_array(rows.map(|row| row.dot(direction)));
        let tiny = Vec3A::splat(1e-12);
        let safe = Vec3A::select(along.abs().cmplt(tiny), tiny, along);
        let a = (Vec3A::from(self.numbers.low) - origin) / safe;
        let b = (Vec3A::from(self.numbers.high) - origin) / safe;
        let [enter, leave] = frame.kept(ray);
        let enter = a.min(b).max_element().max(enter);
        let leave = a.max(b).min_element().min(leave);
        let step = self.numbers.step;
        let march = March {
            next: (enter / step).ceil().max(1.0),
            last: (leave / step).floor(),
            origin,
            along,
        };
        (march.next <= march.last).then_some(march)
    }

    /// Distance of the next sample.
    pub fn next(&self, march: &March) -> f32 {
        match march.next <= march.last {
            true => march.next * self.numbers.step,
            false => f32::INFINITY,
        }
    }

    /// Blends the samples up to a distance; returns how many there were.
    pub fn blend_until(
        &self,
        march: &mut March,
        sum: &mut Accumulated,
        distance: f32,
        is_open: impl Fn(&Accumulated) -> bool,
    ) -> u64 {
        let step = self.numbers.step;
        let [low, scale] = self.numbers.position;
        let first = march.next;
        while march.next <= march.last && march.next * step <= distance && is_open(sum) {
            let at = march.origin + march.next * step * march.along;
            march.next += 1.0;
            let [value, presence] = (ONE_PART * self.voxels.sample(at)).to_array();
            if presence > 0.0 {
                let entry = self.tables.at(low + scale * value / presence);
                if entry.w > 0.0 {
                    let opacity = presence * (1.0 - passed(entry.w * step));
                    sum.blend(Vec3A::from_vec4(entry), opacity);
                }
            }
        }
        (march.next - first) as u64
    }
}
