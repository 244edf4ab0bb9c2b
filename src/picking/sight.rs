//! What lies on a ray: surfaces, and the samples of the cells.

use glam::DVec3;

use super::gather::{Piece, PieceSource};
use super::ray::{Ray, Span};
use super::surfaces::Met;
use super::{Part, fault_of};
use crate::case::Case;
use crate::model::Ijk;
use crate::render::Located;
use crate::scene::Hull;
use crate::view::View;
use crate::view::ghosts;
use crate::view::surfaces::{SHEET_OPACITY, fault_color};

/// How far beside a surface its cell is located, as a part of the sampling step.
const BESIDE: f64 = 1e-3;
/// Part of a legend within which two values are the same to the eye.
const TOLD_APART: f64 = 0.01;

/// A ray of a view, and the surfaces on it.
pub(super) struct Sight<'a> {
    case: &'a Case,
    view: &'a View,
    ray: Ray,
    span: Span,
    surfaces: Vec<Surface>,
}

/// A point of a surface.
#[derive(Clone, Copy)]
enum Surface {
    /// Of the section of an opaque clip plane, at a distance.
    Section(f64),
    /// Of the hull.
    Hull(Met),
    /// Of a fault between the cells.
    Sheet(Met),
}

impl Surface {
    fn distance(self) -> f64 {
        match self {
            Self::Section(distance) => distance,
            Self::Hull(met) | Self::Sheet(met) => met.distance,
        }
    }
}

impl<'a> Sight<'a> {
    /// Along a ray that meets these points of hull or faults, whichever the view shows.
    pub fn new(case: &'a Case, view: &'a View, ray: Ray, span: Span, met: Vec<Met>) -> Self {
        let surface = match view.style.surfaces.hull {
            Hull::Opaque => Surface::Hull,
            Hull::Hidden | Hull::Faint => Surface::Sheet,
        };
        let section = span.section.map(Surface::Section);
        let surfaces = section.into_iter().chain(met.into_iter().map(surface));
        Self {
            case,
            view,
            ray,
            surfaces: surfaces.collect(),
            span,
        }
    }

    /// Points of world space whose cells have to be known: beside each surface, then the samples.
    pub fn points(&self) -> Vec<DVec3> {
        let beside = BESIDE * self.view.sampling.step;
        let surfaces = self.surfaces.iter().map(|surface| match surface {
            Surface::Hull(met) if met.is_back => met.distance - beside,
            other => other.distance() + beside,
        });
        let samples = self.span.samples.clone().map(|n| self.sample_at(n));
        let all = surfaces.chain(samples);
        all.map(|distance| self.at(distance)).collect()
    }

    fn sample_at(&self, number: u64) -> f64 {
        (number as f64 + 0.5) * self.span.step
    }

    /// All that contributes to the pixel and all cells besides, nearest first; `located` answers
    /// [`Self::points`].
    pub fn pieces(&self, located: &[Option<Located>]) -> Vec<Piece> {
        let (beside, samples) = located.split_at(self.surfaces.len().min(located.len()));
        let surfaces = self.surfaces.iter().zip(beside);
        let surfaces = surfaces.filter_map(|(surface, located)| self.surface(*surface, *located));
        let samples = self.span.samples.clone().zip(samples);
        let samples =
            samples.filter_map(|(n, located)| self.sample(self.sample_at(n), (*located)?));
        let mut pieces: Vec<Piece> = surfaces.chain(samples).collect();
        pieces.sort_by(|a, b| a.at.total_cmp(&b.at));
        pieces
    }

    /// A point on the ray, in world space.
    pub fn at(&self, distance: f64) -> DVec3 {
        self.ray.at(distance)
    }

    /// The color of a cell's own value.
    pub fn own_color(&self, ijk: Ijk) -> Option<[f64; 3]> {
        self.own_value(ijk).map(|value| self.color(value))
    }

    /// True where a value in the scale of the view is another one than a cell's own by what a legend tells
    /// apart.
    pub fn is_apart(&self, ijk: Ijk, value: f64) -> bool {
        let position = |value| self.view.style.transfer.position(value);
        let own = self.own_value(ijk);
        own.is_some_and(|own| (position(own) - position(value)).abs() >= TOLD_APART)
    }

    /// The color of a value in the scale of the view.
    fn color(&self, value: f64) -> [f64; 3] {
        let transfer = &self.view.style.transfer;
        transfer.srgb(transfer.position(value))
    }

    fn sample(&self, at: f64, located: Located) -> Option<Piece> {
        let transfer = &self.view.style.transfer;
        let (extinction, color, of) = match self.is_ghost(located.ijk) {
            true => (
                transfer.extinction_of(ghosts::OPACITY),
                ghosts::COLOR,
                PieceSource::Ghost,
            ),
            false if located.value.is_nan() => return None,
            false => (
                transfer.extinction(transfer.position(located.value)),
                self.color(located.value),
                PieceSource::Cell {
                    ijk: located.ijk,
                    value: located.value,
                    part: Part::Inside,
                },
            ),
        };
        let opacity = match self.is_before_hull(at) {
            true => 0.0,
            false => -(-extinction * self.span.step).exp_m1(),
        };
        Some(Piece {
            at,
            reach: 0.5 * self.span.step,
            opacity,
            color,
            of,
        })
    }

    /// Nothing is drawn before the hull where a ray comes from outside: a sample there is rounding.
    fn is_before_hull(&self, at: f64) -> bool {
        let hull = self.surfaces.iter().find(|s| matches!(s, Surface::Hull(_)));
        let has_more = self.span.starts_inside || self.view.shown.cells.ghosts.is_some();
        hull.is_some_and(|hull| !has_more && at < hull.distance())
    }

    fn surface(&self, surface: Surface, located: Option<Located>) -> Option<Piece> {
        let (opacity, color, of) = match surface {
            Surface::Section(_) => {
                let located = located.filter(|l| !self.is_ghost(l.ijk))?;
                let of = PieceSource::Cell {
                    ijk: located.ijk,
                    value: located.value,
                    part: Part::Section,
                };
                (1.0, self.color(located.value), of)
            }
            Surface::Hull(met) => {
                let inside = located.filter(|l| l.ijk == met.cell);
                let value = inside.map_or_else(|| self.own_value(met.cell), |l| Some(l.value))?;
                let fault = fault_of(self.case, met);
                let of = PieceSource::Cell {
                    ijk: met.cell,
                    value,
                    part: fault.map_or(Part::Face(met.face), Part::Fault),
                };
                (1.0, self.color(value), of)
            }
            Surface::Sheet(met) => {
                let color = fault_color(self.view.shown.named_faults.fault_of(met.cell, met.face));
                (SHEET_OPACITY, color, PieceSource::Sheet(met))
            }
        };
        Some(Piece {
            at: surface.distance(),
            reach: 0.0,
            opacity,
            color,
            of,
        })
    }

    /// A cell's value in the scale of the view.
    fn own_value(&self, ijk: Ijk) -> Option<f64> {
        let grid = &self.case.grid;
        let value = self
            .view
            .shown
            .cells
            .field
            .value(grid, grid.dims().cell(ijk));
        value.map(f64::from)
    }

    fn is_ghost(&self, ijk: Ijk) -> bool {
        self.view.shown.cells.ghosts.is_some() && !self.case.grid.is_active(ijk)
    }
}
