//! What lies on a ray: surfaces, and the samples of the cells.

use glam::DVec3;

use super::gather::{Piece, PieceSource};
use super::{Part, fault_of};
use crate::case::Case;
use crate::model::Ijk;
use crate::render::line_of_sight::Ray;
use crate::render::{LineOfSight, Located, SurfacePoint, TubePoint};
use crate::view::surfaces::{SHEET_OPACITY, fault_color};
use crate::view::{View, ghosts};

/// Part of a legend within which two values are the same to the eye.
const TOLD_APART: f64 = 0.01;

/// A line of sight of a view, with the look of what lies on it.
pub(super) struct Sight<'a> {
    case: &'a Case,
    view: &'a View,
    line: &'a LineOfSight,
    tube: Option<TubePoint>,
}

/// What a ray meets of a volume beside the model.
pub(super) fn cube_pieces(view: &View, ray: &Ray) -> Vec<Piece> {
    let Some(shown) = &view.shown.cube else {
        return Vec::new();
    };
    let step = shown.step(view.sampling.step);
    let kept = |at: &f64| view.keeps(ray.at(*at));
    let along = shown.along(ray.origin, ray.direction, view.sampling.step);
    let piece = |(at, value, presence): (f64, f64, f64)| {
        let position = shown.transfer.position(value);
        Piece {
            at,
            reach: 0.5 * step,
            opacity: -presence * (-shown.transfer.extinction(position) * step).exp_m1(),
            color: shown.transfer.srgb(position),
            of: PieceSource::Cube(value),
        }
    };
    along.filter(|(at, ..)| kept(at)).map(piece).collect()
}

impl<'a> Sight<'a> {
    pub fn new(
        case: &'a Case,
        view: &'a View,
        line: &'a LineOfSight,
        tube: Option<TubePoint>,
    ) -> Self {
        Self {
            case,
            view,
            line,
            tube,
        }
    }

    /// All that contributes to the pixel and all cells besides, nearest first.
    pub fn pieces(&self) -> Vec<Piece> {
        let surfaces = self.line.surfaces.iter();
        let surfaces = surfaces.filter_map(|(point, located)| self.surface(*point, *located));
        let samples = self.line.samples.iter();
        let samples = samples.filter_map(|(at, located)| self.sample(*at, *located));
        let cube = cube_pieces(self.view, &self.line.ray);
        let pieces = surfaces.chain(samples).chain(self.well()).chain(cube);
        let mut pieces: Vec<Piece> = pieces.collect();
        pieces.sort_by(|a, b| a.at.total_cmp(&b.at));
        pieces
    }

    /// A point on the ray, in world space.
    pub fn at(&self, distance: f64) -> DVec3 {
        self.line.ray.at(distance)
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

    /// The well that the ray meets, which hides all behind it.
    fn well(&self) -> Option<Piece> {
        let tube = self.tube?;
        let number = tube.well as usize;
        Some(Piece {
            at: f64::from(tube.distance),
            reach: 0.0,
            opacity: 1.0,
            color: self.view.shown.wells.heads.get(number)?.color,
            of: PieceSource::Well(number),
        })
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
            false => -(-extinction * self.line.span.step).exp_m1(),
        };
        Some(Piece {
            at,
            reach: 0.5 * self.line.span.step,
            opacity,
            color,
            of,
        })
    }

    /// Nothing is drawn before the hull where a ray comes from outside: a sample there is rounding.
    fn is_before_hull(&self, at: f64) -> bool {
        let mut surfaces = self.line.surfaces.iter().map(|(point, _)| *point);
        let hull = surfaces.find(|s| matches!(s, SurfacePoint::Hull(_)));
        let has_more = self.line.span.starts_inside || self.view.shown.cells.ghosts.is_some();
        hull.is_some_and(|hull| !has_more && at < hull.distance())
    }

    fn surface(&self, surface: SurfacePoint, located: Option<Located>) -> Option<Piece> {
        let (opacity, color, of) = match surface {
            SurfacePoint::Section(_) => {
                let located = located.filter(|l| !self.is_ghost(l.ijk))?;
                let of = PieceSource::Cell {
                    ijk: located.ijk,
                    value: located.value,
                    part: Part::Section,
                };
                (1.0, self.color(located.value), of)
            }
            SurfacePoint::Hull(hit) => {
                let inside = located.filter(|l| l.ijk == hit.cell);
                let value = inside.map_or_else(|| self.own_value(hit.cell), |l| Some(l.value))?;
                let fault = fault_of(self.case, hit);
                let of = PieceSource::Cell {
                    ijk: hit.cell,
                    value,
                    part: fault.map_or(Part::Face(hit.face), Part::Fault),
                };
                (1.0, self.color(value), of)
            }
            SurfacePoint::Sheet(hit) => {
                let color = fault_color(self.view.shown.named_faults.fault_of(hit.cell, hit.face));
                (SHEET_OPACITY, color, PieceSource::Sheet(hit))
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
