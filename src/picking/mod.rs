//! What is seen at a place in the image, and all that lies before and behind it.
//!
//! # The rule
//! The ray through the place takes the same samples as the image, with the same interpolation, transfer
//! function, clip planes and early termination, and meets the same surfaces. Each sample of extinction `tau` and
//! length `h` adds `t (1 - exp(-tau h))` to the pixel, `t` being the transmittance before it, and each surface
//! `t` times its opacity. What all of them add, without light, divided by their opacity, is the color of the
//! pixel.
//!
//! What a cell adds to that color is the sum of what its samples add, each times
//! `max(exp(-(d / 8)^2 - (e / 20)^2), 0.0001)`, `d` being the CIEDE2000 difference between the color of the sample
//! and that of the pixel, and `e` the one between the color of the cell's own value and the pixel's. Taken is the
//! cell that adds most, at the sample that adds most of it. An opaque face or section adds everything, so that it
//! is taken wherever nothing is before it. A fault's sheet, a well or a volume beside the model is taken where it adds
//! more than every cell.
//!
//! The cell that contributes most is not always the one that is seen: a pixel of orange has faint blue before
//! thin orange layers, of which each one adds less than the blue does. Nor is it enough that a color is near:
//! along a front every color is met somewhere, mostly where it adds nothing. Where values vary inside a cell,
//! a front from 0.1 to 0.9 shows 0.5 though no cell has that value; hence both are told, the value at the
//! sample and the cell's own.

mod choice;
mod gather;
mod sight;

use glam::{DVec2, DVec3};

use crate::case::{Case, CaseError, Measure};
use crate::model::topology::{Behind, Face};
use crate::model::{FaceHit, Grid, Ijk, Spaces};
use crate::render::line_of_sight::Ray;
use crate::render::{RenderError, Renderer, TubePoint, tube_at};
use crate::view::View;
use crate::view::wells::Head;

use gather::{Gathered, Passed, Piece, PieceSource};
use sight::{Sight, cube_pieces};

/// Opacity below which a pixel shows nothing but background.
const LEAST_OPACITY: f64 = 0.02;
/// Part of a pixel that a fault's sheet has to contribute to be read there.
const LEAST_SHEET: f64 = 0.02;

/// What is seen at a place in the image.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Pick {
    /// The property whose values are told.
    pub property: String,
    /// The step that they are of.
    pub step: usize,
    /// The drawn cells that the ray through the place meets, nearest first, each once.
    pub cells: Vec<CellOnRay>,
    /// What is seen; `None` where the image shows nothing but background there.
    pub hit: Option<Hit>,
    /// The nearest fault that is seen there, by itself or through the cells.
    pub fault: Option<Fault>,
    /// The well that is seen there; then no cell is.
    pub well: Option<Head>,
    /// The volume beside the model that is seen there; then no cell is.
    pub cube: Option<CubePoint>,
}

/// What is seen of a volume beside the model.
#[derive(Debug, Clone, PartialEq)]
pub struct CubePoint {
    /// Name of its values.
    pub name: String,
    /// Their unit; empty where there is none.
    pub unit: String,
    /// The value at the place that adds most to the pixel.
    pub value: f64,
    /// East and north in the unit of the map, and depth in that of the grid.
    pub map: DVec3,
}

impl CubePoint {
    fn of(view: &View, ray: &Ray, piece: &Piece) -> Option<Self> {
        let (shown, value) = match piece.of {
            PieceSource::Cube(value) => (view.shown.cube.as_ref()?, value),
            _ => return None,
        };
        Some(Self {
            name: shown.cube.name.clone(),
            unit: shown.cube.unit.clone(),
            value,
            map: view.world.spaces.map_from_world(ray.at(piece.at)),
        })
    }
}

/// A drawn cell on a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellOnRay {
    /// The cell.
    pub ijk: Ijk,
    /// Distances along the ray, in world space, at which it begins and ends, to half a sampling step.
    pub from: f64,
    /// See `from`.
    pub to: f64,
    /// Its value.
    pub value: f64,
    /// How much of the pixel it is, 0..1; 0 where it is transparent or hidden. All that a ray meets adds up to
    /// the pixel's opacity.
    pub contribution: f64,
}

/// The cell that is seen, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct Hit {
    /// The cell.
    pub ijk: Ijk,
    /// Place in world space: that of the cell which contributes most to the pixel.
    pub world: DVec3,
    /// East and north in the unit of the map, and depth in that of the grid; in index space those of the middle of the
    /// cell.
    pub map: DVec3,
    /// What of the cell is seen.
    pub part: Part,
    /// The cell's value.
    pub value: f64,
    /// The value at the place, which is interpolated where the view's values vary inside a cell.
    pub shown: f64,
    /// That is another one than the cell's by as much as the legend tells apart.
    pub is_between: bool,
    /// How much of the pixel it is, 0..1.
    pub contribution: f64,
}

/// What of a cell a ray meets.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// Its inside, which is transparent.
    Inside,
    /// Its section at an opaque clip plane.
    Section,
    /// A face of the hull.
    Face(Face),
    /// A face on a fault.
    Fault(Fault),
}

/// A face on a fault, as it is seen from the eye.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// How much deeper the same layer lies on the far side than on the near one: the mean over the face's
    /// corners, in the grid's length unit; below 0 where it lies higher.
    pub throw: f64,
    /// The cell on the side of the viewer.
    pub near: Ijk,
    /// The cell of the same layer on the far side.
    pub far: Ijk,
}

impl Fault {
    /// Name and throw, and what its sign says; `length` is how lengths are shown.
    pub fn in_words(&self, length: &Measure) -> String {
        let name = self.name.as_deref().unwrap_or("without a name");
        let side = match self.throw {
            throw if throw > 0.0 => ": far side deeper",
            throw if throw < 0.0 => ": far side shallower",
            _ => "",
        };
        let throw = length.show(self.throw.abs());
        format!("Fault {name}, throw {throw:.1} {}{side}", length.unit)
    }
}

/// Why it cannot be said what is seen.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PickError {
    /// The device reports an error.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The property's values cannot be read.
    #[error(transparent)]
    Case(#[from] CaseError),
}

impl Pick {
    /// How many cells lie before and behind a cell on the ray; `None` where the ray does not meet it.
    pub fn around(&self, ijk: Ijk) -> Option<[usize; 2]> {
        let place = self.cells.iter().position(|c| c.ijk == ijk)?;
        Some([place, self.cells.len() - 1 - place])
    }

    /// The cell that lies `by` cells behind another one on the ray, before it where `by` is below 0.
    pub fn beside(&self, ijk: Ijk, by: isize) -> Option<Ijk> {
        let [before, _] = self.around(ijk)?;
        let place = before.checked_add_signed(by)?;
        self.cells.get(place).map(|c| c.ijk)
    }
}

/// What is seen at a place in the image (0 to 1, right and down) of a view of the case whose grid the renderer has.
///
/// # Errors
/// When the renderer reports an error, or the values cannot be read.
pub fn pick(
    renderer: &mut dyn Renderer,
    case: &Case,
    view: &View,
    at: DVec2,
) -> Result<Pick, PickError> {
    let nothing = Pick {
        property: view.shown.property.clone(),
        step: view.shown.step,
        ..Pick::default()
    };
    let tube = tube_at(view, at);
    let head = |number: usize| view.shown.wells.heads.get(number).cloned();
    let Some(line) = renderer.look(view, at)? else {
        return Ok(Pick {
            property: nothing.property,
            step: nothing.step,
            ..beside_model(view, at, tube)
        });
    };
    let sight = Sight::new(case, view, &line, tube);
    let gathered = Gathered::of(sight.pieces(), view);
    let cells = cells(case, view, &gathered)?;
    let seen = match gathered.opacity < LEAST_OPACITY {
        true => None,
        false => choice::seen(&gathered, |ijk| sight.own_color(ijk)),
    };
    let well = seen.and_then(|seen| match gathered.pieces[seen].0.of {
        PieceSource::Well(number) => head(number),
        _ => None,
    });
    let cube = seen.and_then(|n| CubePoint::of(view, &line.ray, &gathered.pieces[n].0));
    let hit = seen.and_then(|seen| hit(case, view, &sight, &gathered.pieces[seen], &cells));
    let fault = match hit.as_ref().map(|h| &h.part) {
        Some(Part::Fault(fault)) => Some(fault.clone()),
        _ => sheet(&gathered).and_then(|hit| fault_of(case, hit)),
    };
    Ok(Pick {
        cells,
        hit,
        fault,
        well,
        cube,
        ..nothing
    })
}

/// What is seen where the ray misses the model: the heads of wells, and what a cube has beyond the model's box.
fn beside_model(view: &View, at: DVec2, tube: Option<TubePoint>) -> Pick {
    let ray = Ray::through(view, at);
    let before = |piece: &Piece| tube.is_none_or(|tube| piece.at < f64::from(tube.distance));
    let pieces = cube_pieces(view, &ray).into_iter().filter(before);
    let gathered = Gathered::of(pieces.collect(), view);
    let head = tube.and_then(|tube| view.shown.wells.heads.get(tube.well as usize));
    // A well is seen through what covers less than half of it.
    if let Some(well) = head.filter(|_| gathered.opacity < 0.5) {
        return Pick {
            well: Some(well.clone()),
            ..Pick::default()
        };
    }
    let seen = choice::seen(&gathered, |_| None).filter(|_| gathered.opacity >= LEAST_OPACITY);
    Pick {
        cube: seen.and_then(|n| CubePoint::of(view, &ray, &gathered.pieces[n].0)),
        ..Pick::default()
    }
}

/// The cells with their values.
fn cells(case: &Case, view: &View, gathered: &Gathered) -> Result<Vec<CellOnRay>, CaseError> {
    // Not the view's own values, which may be rounded logarithms.
    let field = case.field(&view.shown.property, view.shown.step)?;
    let grid = &case.grid;
    let valued = |passed: Passed| CellOnRay {
        ijk: passed.ijk,
        from: passed.from,
        to: passed.to,
        value: field
            .value(grid, grid.dims().cell(passed.ijk))
            .map_or(f64::NAN, f64::from),
        contribution: passed.contribution,
    };
    Ok(gathered.cells().into_iter().map(valued).collect())
}

/// The cell that is seen, given the piece that is and what that contributes.
fn hit(
    case: &Case,
    view: &View,
    sight: &Sight<'_>,
    (piece, of_piece): &(Piece, f64),
    cells: &[CellOnRay],
) -> Option<Hit> {
    let on_ray = |ijk: Ijk| cells.iter().find(|c| c.ijk == ijk);
    let (cell, part, shown, contribution) = match &piece.of {
        PieceSource::Cell { ijk, value, part } => {
            let cell = on_ray(*ijk)?;
            (cell, part.clone(), Some(*value), cell.contribution)
        }
        PieceSource::Sheet(hit) => {
            let part = Part::Fault(fault_of(case, *hit)?);
            (on_ray(hit.cell)?, part, None, *of_piece)
        }
        PieceSource::Ghost | PieceSource::Well(_) | PieceSource::Cube(_) => return None,
    };
    let world = sight.at(piece.at);
    Some(Hit {
        ijk: cell.ijk,
        world,
        map: on_map(case, view, cell.ijk, world),
        part,
        value: cell.value,
        shown: shown.map_or(cell.value, |value| view.true_value(value)),
        is_between: shown.is_some_and(|value| sight.is_apart(cell.ijk, value)),
        contribution,
    })
}

/// Where a point in a cell is on the map.
fn on_map(case: &Case, view: &View, ijk: Ijk, world: DVec3) -> DVec3 {
    if view.world.space.is_map() {
        return view.world.spaces.map_from_world(world);
    }
    let grid = case.grid.in_map_space();
    let spaces = Spaces::new(grid.map_axes(), 1.0);
    let middle = grid.hexahedron(ijk).center();
    spaces.map_from_world(spaces.world_from_grid.transform_point3(middle))
}

/// The nearest sheet that is seen.
fn sheet(gathered: &Gathered) -> Option<FaceHit> {
    let mut sheets = gathered
        .pieces
        .iter()
        .filter_map(|(piece, of_pixel)| match piece.of {
            PieceSource::Sheet(hit) => (*of_pixel >= LEAST_SHEET).then_some(hit),
            _ => None,
        });
    sheets.next()
}

/// The fault that a face lies on, if it does.
fn fault_of(case: &Case, hit: FaceHit) -> Option<Fault> {
    let FaceHit { cell, face, .. } = hit;
    if matches!(face, Face::KMinus | Face::KPlus) {
        return None;
    }
    let number = case.fault_faces.fault_of(cell, face);
    let name = number.and_then(|n| case.about.named_faults.get(n));
    // Faults have their throw in map space.
    let grid = case.grid.in_map_space();
    let beyond = match grid.behind(cell, face) {
        Behind::Displaced(beyond) => beyond,
        // Named faults need no throw.
        Behind::Neighbor(beyond) if name.is_some() => beyond,
        _ => return None,
    };
    // A ray leaves the near cell through a face that is turned away, and enters the far one otherwise.
    let drop = drop(grid, cell, face, beyond);
    let (near, far, throw) = match hit.is_exit {
        true => (cell, beyond, drop),
        false => (beyond, cell, -drop),
    };
    Some(Fault {
        name: name.map(|f| f.name.clone()),
        throw,
        near,
        far,
    })
}

/// How much deeper the corners of a face lie in the cell beyond it, in the mean.
fn drop(grid: &Grid, ijk: Ijk, face: Face, beyond: Ijk) -> f64 {
    let [mine, theirs] = face.corners();
    let pairs = mine.iter().zip(theirs);
    let drops = pairs.map(|(&a, b)| grid.corner_depth(beyond, b) - grid.corner_depth(ijk, a));
    drops.sum::<f64>() / 4.0
}
