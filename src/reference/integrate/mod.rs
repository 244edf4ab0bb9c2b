//! The emission-absorption integral along one ray.

mod cone;
mod cube;
mod lighting;
mod surfaces;
mod tubes;

use glam::DVec3;
use rayon::prelude::*;

use super::integrate::cube::CubeOnRay;
use super::integrate::surfaces::SurfaceFaces;
use super::locate::{Located, Locator};
use crate::model::corner_point::weights;
use crate::model::{CellField, Grid, VertexField};
use crate::scene::Interpolation;
use crate::view::{ClipPlane, View, ghosts};

/// A ray in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes, unit length.
    pub direction: DVec3,
}

impl Ray {
    /// The ray through the middle of a pixel; row 0 is at the top.
    pub fn through_pixel(view: &View, x: u32, y: u32) -> Self {
        let [width, height] = view.size.map(f64::from);
        let camera = &view.camera;
        let right = (2.0 * (f64::from(x) + 0.5) / width - 1.0) * width / height;
        let up = 1.0 - 2.0 * (f64::from(y) + 0.5) / height;
        let across = right * camera.right + up * camera.up;
        match camera.parallel {
            None => Self {
                origin: camera.eye,
                direction: (camera.forward + camera.tan_half_fovy * across).normalize(),
            },
            Some(half_height) => Self {
                origin: camera.eye + half_height * across,
                direction: camera.forward,
            },
        }
    }

    /// Distances at which the ray enters and leaves a box, none behind its origin.
    pub(super) fn within(&self, [low, high]: [DVec3; 2]) -> Option<[f64; 2]> {
        let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
        for axis in 0..3 {
            let to = |plane: DVec3| (plane[axis] - self.origin[axis]) / self.direction[axis];
            let (a, b) = (to(low), to(high));
            // A ray along a face gives 0 / 0, which `max` and `min` pass over.
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        (enter <= leave).then_some([enter, leave])
    }
}

/// Integrates rays through one view of a grid.
#[derive(Debug)]
pub struct Integrator<'a> {
    pub(super) grid: &'a Grid,
    pub(super) view: &'a View,
    locator: Locator,
    pub(super) vertices: Option<VertexField>,
    surfaces: SurfaceFaces,
}

/// What a ray has gathered, front to back.
struct Sum {
    color: DVec3,
    transmittance: f64,
}

impl Sum {
    fn add(&mut self, color: DVec3, alpha: f64) {
        self.color += self.transmittance * alpha * color;
        self.transmittance *= 1.0 - alpha;
    }
}

/// What is drawn at a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// Where it is in its cell.
    pub located: Located,
    /// The value there; inactive cells, shown as ghosts, have none.
    pub value: Option<f64>,
}

impl<'a> Integrator<'a> {
    /// Prepares the search for cells and, where asked for, the averages at the vertices.
    ///
    /// `grid` is the case's.
    pub fn new(grid: &'a Grid, view: &'a View) -> Self {
        let surfaces = SurfaceFaces::new(grid, view);
        let (cells, drawn) = view.shown.cells.in_grid(grid);
        let by_vertex = view.shown.cells.interpolation == Interpolation::Vertex;
        Self {
            grid,
            view,
            locator: Locator::of_drawn(cells, drawn),
            vertices: by_vertex
                .then(|| VertexField::of(grid, &view.shown.cells.field, view.shown.cells.valued())),
            surfaces,
        }
    }

    /// Red, green, blue, as they are blended, each times alpha, and alpha of what a ray passes through.
    pub fn ray(&self, ray: Ray) -> [f64; 4] {
        let step = self.view.sampling.step;
        // Beside the box there are the heads of wells, and what a cube has beyond it.
        let span = ray.within(self.view.world.bounds);
        let [enter, leave] = span.unwrap_or([0.0, f64::NEG_INFINITY]);
        if let Some(rgb) = self.section(ray, [enter, leave]) {
            return [rgb[0], rgb[1], rgb[2], 1.0];
        }
        let mut layers = self.layers(ray).into_iter().peekable();
        let mut cube = CubeOnRay::new(self, ray);
        let mut cube_until = |distance: f64, sum: &mut Sum| {
            if let Some(cube) = &mut cube {
                cube.add_until(distance, sum);
            }
        };
        let mut sum = Sum {
            color: DVec3::ZERO,
            transmittance: 1.0,
        };
        let is_solid = self.view.style.surfaces.solid;
        let leave = match self.view.casts_rays() {
            true => leave,
            false => enter,
        };
        let mut number = (enter / step - 0.5).ceil().max(0.0);
        while (number + 0.5) * step <= leave
            && sum.transmittance >= self.view.sampling.early_termination
        {
            let distance = (number + 0.5) * step;
            while let Some(layer) = layers.next_if(|layer| layer.distance <= distance) {
                cube_until(layer.distance, &mut sum);
                sum.add(layer.color, layer.alpha);
            }
            cube_until(distance, &mut sum);
            let position = ray.origin + distance * ray.direction;
            let absorbing = self.absorbing(position);
            let seen = absorbing.filter(|(sample, _)| !is_solid || sample.value.is_none());
            if let Some((sample, extinction)) = seen {
                let alpha = 1.0 - (-extinction * step).exp();
                sum.add(self.lit(position, &sample).into(), alpha);
            }
            number += 1.0;
        }
        for layer in layers {
            cube_until(layer.distance, &mut sum);
            sum.add(layer.color, layer.alpha);
        }
        cube_until(f64::INFINITY, &mut sum);
        let [red, green, blue] = sum.color.to_array();
        [red, green, blue, 1.0 - sum.transmittance]
    }

    /// True on the kept side of every clip plane.
    pub(super) fn is_kept(&self, position: DVec3) -> bool {
        let mut planes = self.view.shown.clip.iter();
        planes.all(|plane| (position - plane.point).dot(plane.normal) >= 0.0)
    }

    /// Color of the opaque section at which a ray enters the kept part, where there is one.
    fn section(&self, ray: Ray, [enter, leave]: [f64; 2]) -> Option<[f64; 3]> {
        let crossings = self.view.shown.clip.iter().map(|plane| {
            let rate = ray.direction.dot(plane.normal);
            let t = (plane.point - ray.origin).dot(plane.normal) / rate;
            (if rate > 0.0 { t } else { f64::MIN }, plane)
        });
        let last = crossings.max_by(|a, b| a.0.total_cmp(&b.0));
        let (t, plane) = last.filter(|(t, _)| *t > enter.max(0.0))?;
        let position = ray.origin + t * ray.direction;
        let others = |other: &&ClipPlane| *other != plane;
        let kept = self
            .view
            .shown
            .clip
            .iter()
            .filter(others)
            .all(|other| (position - other.point).dot(other.normal) >= 0.0);
        if !plane.opaque || t > leave || !kept {
            return None;
        }
        let sample = self.sample(position)?;
        sample.value?;
        let own = DVec3::from_array(self.unlit(&sample));
        let lamp = self.headlight(plane.normal, ray.direction);
        let color = self.shaded(position, (lamp * own).to_array(), Some(&sample));
        Some(self.with_section_edges(color, ray, plane, &sample))
    }

    /// What absorbs light at a point of world space, and its extinction there.
    pub(super) fn absorbing(&self, position: DVec3) -> Option<(Sample, f64)> {
        if !self.is_kept(position) {
            return None;
        }
        let sample = self.sample(position)?;
        let transfer = &self.view.style.transfer;
        let extinction = match sample.value {
            Some(value) => transfer.extinction(transfer.position(value)),
            None => transfer.extinction_of(ghosts::OPACITY),
        };
        (extinction > 0.0).then_some((sample, extinction))
    }

    /// Color of a sample without any light.
    pub(super) fn unlit(&self, sample: &Sample) -> [f64; 3] {
        let transfer = &self.view.style.transfer;
        match sample.value {
            Some(value) => self.view.color_at(transfer.position(value)),
            None => self.view.style.blending.of_srgb(ghosts::COLOR),
        }
    }

    /// What is drawn at a point of world space, clip planes aside.
    pub(super) fn sample(&self, position: DVec3) -> Option<Sample> {
        let sample = self.sample_in(self.drawn_at(position)?);
        let shown = sample.value.is_some() || self.view.shown.cells.ghosts.is_some();
        shown.then_some(sample)
    }

    /// What is at a place in a cell.
    pub(super) fn sample_in(&self, located: Located) -> Sample {
        let (field, vertices) = (&self.view.shown.cells.field, self.vertices.as_ref());
        let value = value_at(self.grid, &located, field, vertices);
        Sample { located, value }
    }

    /// The drawn cell at a point of world space.
    fn drawn_at(&self, position: DVec3) -> Option<Located> {
        let point = self
            .view
            .world
            .spaces
            .grid_from_world
            .transform_point3(position);
        self.locator.locate(point)
    }
}

/// The value at a place in a cell: interpolated between the vertices where these are given, else
/// the cell's own. `None` in a cell without a value.
pub fn value_at(
    grid: &Grid,
    located: &Located,
    field: &CellField,
    vertices: Option<&VertexField>,
) -> Option<f64> {
    let own = f64::from(field.value(grid, grid.dims().cell(located.ijk))?);
    let value = vertices.map_or(own, |vertices| {
        let corners = vertices.corners(grid, located.ijk);
        let weights = weights(located.str);
        corners.iter().zip(weights).map(|(v, w)| v * w).sum()
    });
    value.is_finite().then_some(value)
}

/// Locates points of grid space in the cells that no local grid refines, and gives the value of a field there; `None`
/// where a point lies in no active cell, or where there is no value.
pub fn values_at(
    grid: &Grid,
    field: &CellField,
    interpolation: Interpolation,
    points: &[DVec3],
) -> Vec<Option<(Located, f64)>> {
    let finest = grid.finest();
    let locator = match &finest {
        Some(finest) => Locator::of_drawn(grid, finest),
        None => Locator::new(grid),
    };
    let vertices = (interpolation == Interpolation::Vertex)
        .then(|| VertexField::of(grid, field, finest.as_deref()));
    let answer = |&point: &DVec3| {
        let located = locator.locate(point)?;
        let value = value_at(grid, &located, field, vertices.as_ref())?;
        Some((located, value))
    };
    points.par_iter().map(answer).collect()
}
