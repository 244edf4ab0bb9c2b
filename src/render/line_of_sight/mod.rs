//! What lies on the ray through a place in an image: samples in cells, and points of surfaces.
//!
//! The ray takes the same samples as the image, with the same clip planes and interpolation, and meets the same
//! surfaces. Whoever makes images answers with what it finds in its own cells, so that what is picked is what is
//! drawn.

mod ray;
mod surfaces;

use glam::{DVec2, DVec3};

pub use ray::{Ray, Span};
pub use surfaces::SurfaceTree;

pub use super::plan::tubes::{TubePoint, tube_at};

use super::Located;
use crate::model::{FaceHit, Grid};
use crate::scene::Hull;
use crate::view::View;

/// How far beside a surface its cell is located, as a part of the sampling step.
const BESIDE: f64 = 1e-3;

/// All that lies on a ray.
#[derive(Debug, Clone)]
pub struct LineOfSight {
    /// The ray.
    pub ray: Ray,
    /// The part of it on which samples lie.
    pub span: Span,
    /// Points of surfaces, with the drawn cell that is seen there.
    pub surfaces: Vec<(SurfacePoint, Option<Located>)>,
    /// Distances of the samples that lie in drawn cells, nearest first, with these.
    pub samples: Vec<(f64, Located)>,
}

/// A point of a surface on a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SurfacePoint {
    /// Of the section of an opaque clip plane, at a distance.
    Section(f64),
    /// Of an opaque hull.
    Hull(FaceHit),
    /// Of a fault between the cells.
    Sheet(FaceHit),
}

impl SurfacePoint {
    /// Distance along the ray.
    pub fn distance(self) -> f64 {
        match self {
            Self::Section(distance) => distance,
            Self::Hull(hit) | Self::Sheet(hit) => hit.distance,
        }
    }
}

/// A line of sight whose points are still to be located.
pub struct Sighting {
    ray: Ray,
    span: Span,
    surfaces: Vec<SurfacePoint>,
    beside: f64,
}

impl Sighting {
    /// Along the ray through a place in the image (0 to 1, right and down) of a view of `grid`, the case's; `None`
    /// where the ray misses all that is kept.
    pub fn through(
        grid: &Grid,
        view: &View,
        at: DVec2,
        surfaces: &mut SurfaceTree,
    ) -> Option<Self> {
        let ray = Ray::through(view, at);
        let span = ray.span(view)?;
        let surface = match view.style.surfaces.hull {
            Hull::Opaque => SurfacePoint::Hull,
            Hull::Hidden | Hull::Faint => SurfacePoint::Sheet,
        };
        let section = span.section.map(SurfacePoint::Section).into_iter();
        let met = surfaces.seen(grid, view, &ray).into_iter().map(surface);
        Some(Self {
            surfaces: section.chain(met).collect(),
            beside: BESIDE * view.sampling.step,
            ray,
            span,
        })
    }

    /// Points of world space whose cells have to be known: beside each surface, then the samples.
    pub fn points(&self) -> Vec<DVec3> {
        let surfaces = self.surfaces.iter().map(|surface| match surface {
            SurfacePoint::Hull(hit) if hit.is_exit => hit.distance - self.beside,
            other => other.distance() + self.beside,
        });
        let samples = self.span.samples.clone().map(|n| self.span.distance(n));
        let all = surfaces.chain(samples);
        all.map(|distance| self.ray.at(distance)).collect()
    }

    /// The line of sight, given what [`Self::points`] lie in.
    pub fn located(self, located: &[Option<Located>]) -> LineOfSight {
        let (beside, inside) = located.split_at(self.surfaces.len().min(located.len()));
        let samples = self.span.samples.clone().zip(inside);
        let samples = samples.filter_map(|(n, found)| Some((self.span.distance(n), (*found)?)));
        LineOfSight {
            samples: samples.collect(),
            surfaces: self
                .surfaces
                .into_iter()
                .zip(beside.iter().copied())
                .collect(),
            ray: self.ray,
            span: self.span,
        }
    }
}
