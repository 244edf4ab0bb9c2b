//! A scene against a case: every default filled in, every value checked.

use std::sync::Arc;

use glam::{DVec3, DVec4};
use rayon::prelude::*;

use super::colors::{self, Asked, Colors, interpolation};
use super::ghosts::{Ghosts, shown_grid};
use super::lighting::{self, Lighting};
use super::{
    Blending, Camera, CameraSpec, ClipSpec, CutFace, Filter, Inactive, Interpolation, LibcSettings,
    Mode, Scene, SrgSettings, StepSpec, Surfaces,
};
use crate::case::{Case, CaseError};
use crate::gpu::volume::Shape;
use crate::model::{CellField, Dims, FaultFaces, Grid, Ijk, Spaces};
use crate::strategies::StrategyKind;
use crate::transfer::{TransferFunction, presets};

/// Why a scene cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A field has a value that is not allowed.
    #[error("scene: {field}: {problem}")]
    Field {
        /// Name of the field, dotted.
        field: &'static str,
        /// What is wrong with it.
        problem: String,
    },
    /// The case cannot give what the scene asks for.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// No active cell has a thickness.
    #[error("the case has no active cell to show")]
    Empty,
    /// The property is the same at all steps.
    #[error(
        "{0} is static, so there is no film over its steps; name a property that changes with time, or turn the camera"
    )]
    Static(String),
    /// The steps of a film are not what they should be.
    #[error("steps: {0}")]
    Steps(String),
    /// A turn of the camera is not what it should be.
    #[error("a turn needs at least one view and a finite number of degrees")]
    Turn,
}

pub(super) fn wrong(field: &'static str, problem: impl Into<String>) -> SceneError {
    SceneError::Field {
        field,
        problem: problem.into(),
    }
}

/// All that a renderer needs beside the grid: what every strategy and the reference integrate.
///
/// **Units**: lengths in world space, the grid's length unit.
#[derive(Debug, Clone)]
pub struct View {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Background in sRGB, 0..1.
    pub background: [f64; 3],
    /// The camera in world space.
    pub camera: Camera,
    /// Grid to world and back.
    pub spaces: Spaces,
    /// Factor on depth in world space.
    pub vertical_exaggeration: f64,
    /// Box of the active cells in world space.
    pub world_bounds: [DVec3; 2],
    /// Corners of the model's box in world space; bit n of the index is the end along axis n.
    pub box_corners: [DVec3; 8],
    /// The strategy asked for.
    pub strategy: StrategyKind,
    /// Name of the property shown.
    pub property: String,
    /// Step shown.
    pub step: usize,
    /// Its values, in the scale of the transfer function; see [`Self::true_value`].
    pub field: Arc<CellField>,
    /// How values vary inside a cell.
    pub interpolation: Interpolation,
    /// Value to color and extinction.
    pub transfer: TransferFunction,
    /// The numbers in which colors are shaded and blended.
    pub blending: Blending,
    /// Samples lie at distances `(n + 1/2) * sampling_step` from where rays start.
    pub sampling_step: f64,
    /// Transmittance at which a ray ends.
    pub early_termination: f64,
    /// By active index: true where the cell is drawn (has thickness and a value, passes the filter).
    pub drawn: Arc<Vec<bool>>,
    /// Where inactive cells are shown: the grid that field and selection go by then.
    pub ghosts: Option<Arc<Ghosts>>,
    /// Planes that cut parts away.
    pub clip: Vec<ClipPlane>,
    /// Surfaces in the volume.
    pub surfaces: Surfaces,
    /// Ends in world space of the connections that are marked: those of drawn cells.
    pub connections: Arc<Vec<[DVec3; 2]>>,
    /// Which faces lie on faults that have a name.
    pub named_faults: Arc<FaultFaces>,
    /// Occlusion and lights.
    pub lighting: Lighting,
    /// Settings of the cell-to-cell strategy.
    pub libc: LibcSettings,
    /// Settings of the resampled-grid strategy.
    pub srg: SrgSettings,
    /// Draw the box and axes.
    pub show_box: bool,
    /// Draw legend and title.
    pub show_legend: bool,
}

impl View {
    /// The same view from another camera, in another size; nothing is read.
    ///
    /// # Errors
    /// When camera or size are not allowed.
    pub fn seen_from(&self, camera_spec: &CameraSpec, size: [u32; 2]) -> Result<Self, SceneError> {
        let camera = camera(camera_spec, checked_size(size)?, &self.box_corners)?;
        Ok(Self {
            size,
            camera,
            ..self.clone()
        })
    }

    /// Smallest and largest corner in grid space of the drawn cells of `grid` (the case's), ghosts aside; `None`
    /// where none is drawn.
    pub fn drawn_bounds(&self, grid: &Grid) -> Option<[DVec3; 2]> {
        let drawn = self.drawn_active(grid);
        let cells = grid.active_cells().par_iter().zip(drawn);
        grid.bounds_of(cells.filter_map(|(cell, drawn)| drawn.then(|| grid.dims().ijk(*cell))))
    }

    /// Corners in world space of a box given by its smallest and largest corner in grid space; bit n of the
    /// index is the end along axis n.
    pub fn corners_of(&self, bounds: [DVec3; 2]) -> [DVec3; 8] {
        box_corners(&self.spaces, bounds)
    }

    /// The value that a number of [`Self::field`], or between such numbers, stands for.
    pub fn true_value(&self, shown: f64) -> f64 {
        self.transfer.scale.true_value(shown)
    }

    /// True where rays pass through something: between the faces of solid cells there is nothing but ghosts.
    pub fn casts_rays(&self) -> bool {
        !self.surfaces.solid || self.ghosts.is_some()
    }

    /// Color of a position in the range of values, in the numbers that are blended.
    pub fn color_at(&self, position: f64) -> [f64; 3] {
        self.blending.of_srgb(self.transfer.srgb(position))
    }

    /// Width over height.
    pub fn aspect(&self) -> f64 {
        f64::from(self.size[0]) / f64::from(self.size[1])
    }
}

/// A plane in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClipPlane {
    /// A point of it.
    pub point: DVec3,
    /// Unit length, points to the part that is kept.
    pub normal: DVec3,
    /// Its section through the cells is opaque.
    pub opaque: bool,
}

/// Clip planes at most; what a frame's uniform has room for.
pub const MAX_CLIP_PLANES: usize = 8;

/// Fills in every default of `scene` for `case` and checks every value.
///
/// # Errors
/// When a value is out of its range, or asks for what the case or this version does not have.
pub fn resolve(scene: &Scene, case: &Case) -> Result<View, SceneError> {
    resolve_over(scene, case, None)
}

/// [`resolve`], over another range of true values where one is given.
pub(super) fn resolve_over(
    scene: &Scene,
    case: &Case,
    range: Option<[f64; 2]>,
) -> Result<View, SceneError> {
    check_version(scene)?;
    let active_bounds = case.grid.bounds().ok_or(SceneError::Empty)?;
    let exaggeration = match scene.vertical_exaggeration {
        Some(v) => positive("vertical_exaggeration", v)?,
        None => automatic_exaggeration(active_bounds),
    };
    let spaces = Spaces::new(case.grid.map_axes(), exaggeration);
    let edges = mean_world_edges(case, exaggeration);
    let property = match &scene.property {
        Some(name) => name.clone(),
        None => default_property(case),
    };
    let step = step(case, &scene.step, case.is_dynamic(&property))?;
    let field = case.field(&property, step)?;
    let asked = Asked {
        scene,
        case,
        property: &property,
        range,
        mean_edge: edges.element_sum() / 3.0,
    };
    let Colors { field, transfer } = colors::resolve(&asked, &field)?;
    let (field, drawn) = filtered(case, field, &scene.filter, step)?;
    let connections = match scene.show.nnc {
        true => connections(case, &spaces, &drawn),
        false => Vec::new(),
    };
    let (ghosts, field, drawn) = match scene.show.inactive {
        Inactive::Hidden => (None, field, drawn),
        Inactive::Ghost => {
            let (ghosts, field, drawn) = Ghosts::new(&case.grid, &field, &drawn);
            (Some(Arc::new(ghosts)), Arc::new(field), drawn)
        }
    };
    let bounds = shown_grid(&case.grid, ghosts.as_ref()).bounds();
    let box_corners = box_corners(&spaces, bounds.unwrap_or(active_bounds));
    let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let bounds = box_corners.iter();
    let world_bounds = bounds.fold(start, |[a, b], p| [a.min(*p), b.max(*p)]);
    let strategy = StrategyKind::from_name(&scene.strategy)
        .ok_or_else(|| wrong("strategy", StrategyKind::refusal(&scene.strategy)))?;
    if !(0.0..1.0).contains(&scene.early_termination) {
        return Err(wrong("early_termination", "must be at least 0 and below 1"));
    }
    let size = checked_size(scene.size)?;
    Ok(View {
        size,
        background: presets::parse_color(&scene.background)
            .ok_or_else(|| wrong("background", "must be a color like #ffffff"))?,
        camera: camera(&scene.camera, size, &box_corners)?,
        spaces,
        vertical_exaggeration: exaggeration,
        world_bounds,
        box_corners,
        strategy,
        step,
        interpolation: interpolation(scene),
        transfer,
        blending: scene.blending,
        sampling_step: sampling_step(scene, edges, world_bounds)?,
        early_termination: scene.early_termination,
        property,
        field,
        drawn: Arc::new(drawn),
        ghosts,
        clip: clip(&scene.clip, scene.mode)?,
        surfaces: Surfaces::of(scene),
        connections: Arc::new(connections),
        named_faults: case.fault_faces.clone(),
        lighting: lighting::resolve(
            &scene.lighting,
            box_edges(&box_corners),
            case.grid.dims().cells(),
        )?,
        libc: scene.libc,
        srg: srg(scene, case.grid.dims())?,
        show_box: scene.show.r#box,
        show_legend: scene.show.legend,
    })
}

fn check_version(scene: &Scene) -> Result<(), SceneError> {
    if scene.version != 1 {
        let problem = format!("{} is not known; this is version 1", scene.version);
        return Err(wrong("version", problem));
    }
    Ok(())
}

fn checked_size(size: [u32; 2]) -> Result<[u32; 2], SceneError> {
    match size.iter().all(|n| (1..=16384).contains(n)) {
        true => Ok(size),
        false => Err(wrong("size", "must be 1 to 16384 pixels each way")),
    }
}

fn sampling_step(scene: &Scene, edges: DVec3, bounds: [DVec3; 2]) -> Result<f64, SceneError> {
    let Some(step) = scene.sampling_step else {
        return Ok(edges.min_element() / 8.0);
    };
    // Below this a ray would take more samples than f32 can count.
    let least = bounds[0].distance(bounds[1]) * 1e-6;
    if step.is_finite() && step >= least {
        return Ok(step);
    }
    let problem = format!("{step} is too small; use at least {least:.3e}");
    Err(wrong("sampling_step", problem))
}

fn srg(scene: &Scene, dims: Dims) -> Result<SrgSettings, SceneError> {
    let settings = scene.srg;
    let parts = [
        ("srg.even", settings.even),
        ("srg.thin", settings.thin),
        ("srg.roulette", settings.roulette),
    ];
    if let Some((field, value)) = parts.iter().find(|p| !(0.0..1.0).contains(&p.1)) {
        let problem = format!("{value} must be at least 0, which turns it off, and below 1");
        return Err(wrong(field, problem));
    }
    if settings.budget_mb == Some(0) {
        return Err(wrong("srg.budget_mb", "must be at least 1"));
    }
    if let Some(factor) = settings.factor {
        let ghosts = scene.show.inactive == Inactive::Ghost;
        let shape = Shape::of(dims, positive("srg.factor", factor)?, ghosts);
        let budget = settings.budget_bytes(false);
        if shape.bytes() > budget {
            let problem = format!(
                "{factor} needs {} MB of the {} in srg.budget_mb; change one of them",
                shape.bytes().div_ceil(1 << 20),
                budget >> 20
            );
            return Err(wrong("srg.factor", problem));
        }
    }
    Ok(settings)
}

fn clip(planes: &[ClipSpec], mode: Mode) -> Result<Vec<ClipPlane>, SceneError> {
    if planes.len() > MAX_CLIP_PLANES {
        let problem = format!(
            "has {} planes; at most {MAX_CLIP_PLANES} are possible",
            planes.len()
        );
        return Err(wrong("clip", problem));
    }
    let resolve = |plane: &ClipSpec| {
        let point = DVec3::from_array(plane.point);
        if !point.is_finite() {
            return Err(wrong("clip.point", "must be three finite numbers"));
        }
        let normal = DVec3::from_array(plane.normal)
            .try_normalize()
            .ok_or_else(|| wrong("clip.normal", "must have a length above 0"))?;
        let opaque = plane.face == CutFace::Opaque || mode == Mode::Cells;
        Ok(ClipPlane {
            point,
            normal,
            opaque,
        })
    };
    planes.iter().map(resolve).collect()
}

pub(super) fn positive(field: &'static str, value: f64) -> Result<f64, SceneError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(wrong(field, format!("{value} must be above 0")))
    }
}

/// Corners of the model's box in world space, at a vertical exaggeration or the one that suits it; `None` of a
/// model without active cells.
pub fn model_corners(case: &Case, exaggeration: Option<f64>) -> Option<[DVec3; 8]> {
    let bounds = case.grid.bounds()?;
    let factor = exaggeration.unwrap_or_else(|| automatic_exaggeration(bounds));
    let spaces = Spaces::new(case.grid.map_axes(), factor);
    Some(box_corners(&spaces, bounds))
}

/// Makes the model a quarter as high as it is wide, in the steps that engineers use.
fn automatic_exaggeration(bounds: [DVec3; 2]) -> f64 {
    let size = bounds[1] - bounds[0];
    let wanted = 0.25 * size.x.max(size.y) / size.z.max(1e-9);
    let steps = [1.0, 2.0, 3.0, 5.0, 10.0, 15.0, 20.0, 30.0, 50.0];
    steps
        .into_iter()
        .rev()
        .find(|&s| s <= wanted)
        .unwrap_or(1.0)
}

/// Corners of the model's box, whose sides follow the grid's axes, in world space.
fn box_corners(spaces: &Spaces, [low, high]: [DVec3; 2]) -> [DVec3; 8] {
    std::array::from_fn(|c| {
        let pick = |axis: usize| {
            if c >> axis & 1 == 1 {
                high[axis]
            } else {
                low[axis]
            }
        };
        let corner = DVec3::new(pick(0), pick(1), pick(2));
        spaces.world_from_grid.transform_point3(corner)
    })
}

/// Edges of the model's box along the grid's axes, in world space.
fn box_edges(corners: &[DVec3; 8]) -> DVec3 {
    DVec3::from_array([1, 2, 4].map(|c| corners[c].distance(corners[0])))
}

/// Mean edge lengths of the drawn cells along s, t and r, in world space.
fn mean_world_edges(case: &Case, exaggeration: f64) -> DVec3 {
    let grid = &case.grid;
    let edges_and_one = |ijk: Ijk| {
        if !grid.has_thickness(ijk) {
            return DVec4::ZERO;
        }
        let mut hexahedron = grid.hexahedron(ijk);
        for corner in &mut hexahedron.0 {
            corner.z *= exaggeration;
        }
        hexahedron.mean_edges().extend(1.0)
    };
    let sum = grid.sum_active(edges_and_one);
    (sum.truncate() / sum.w.max(1.0)).max(DVec3::splat(1e-6))
}

/// The property shown where a scene names none.
pub fn default_property(case: &Case) -> String {
    let has = |name: &&str| case.properties.iter().any(|p| p.name == **name);
    ["SOIL", "SWAT", "PRESSURE", "PORO"]
        .iter()
        .find(|n| has(n))
        .map_or_else(|| "DEPTH".to_owned(), |n| (*n).to_owned())
}

fn step(case: &Case, spec: &StepSpec, dynamic: bool) -> Result<usize, SceneError> {
    if !dynamic {
        return Ok(0);
    }
    Ok(match spec {
        StepSpec::Index(n) => case.step(&n.to_string())?,
        StepSpec::Name(name) => case.step(name)?,
    })
}

fn drawn(
    case: &Case,
    field: &CellField,
    filter: &Filter,
    step: usize,
) -> Result<Vec<bool>, SceneError> {
    let grid = &case.grid;
    let dims = grid.dims();
    for (name, range, n) in [
        ("filter.i", filter.i, dims.ni),
        ("filter.j", filter.j, dims.nj),
        ("filter.k", filter.k, dims.nk),
    ] {
        if range.is_some_and(|[a, b]| a < 1 || a > b || b > n) {
            return Err(wrong(
                name,
                format!("must be two numbers from 1 to {n}, the smaller first"),
            ));
        }
    }
    let within = |range: Option<[usize; 2]>, at: usize| {
        range.is_none_or(|[a, b]| (a..=b).contains(&(at + 1)))
    };
    let passes =
        |ijk: Ijk| within(filter.i, ijk.i) && within(filter.j, ijk.j) && within(filter.k, ijk.k);
    let mut drawn: Vec<bool> = grid
        .active_cells()
        .par_iter()
        .zip(field.values())
        .map(|(&cell, value)| {
            let ijk = dims.ijk(cell);
            !value.is_nan() && passes(ijk) && grid.has_thickness(ijk)
        })
        .collect();
    for property in &filter.properties {
        let values = case.field(&property.name, step)?;
        for (d, &v) in drawn.iter_mut().zip(values.values()) {
            *d &= (property.min..=property.max).contains(&f64::from(v));
        }
    }
    Ok(drawn)
}

/// Which cells are drawn, and their values: averages at vertices are of drawn cells, so that no color of a cell
/// shows that is filtered away.
fn filtered(
    case: &Case,
    field: Arc<CellField>,
    filter: &Filter,
    step: usize,
) -> Result<(Arc<CellField>, Vec<bool>), SceneError> {
    let drawn = drawn(case, &field, filter, step)?;
    let field = match *filter == Filter::default() {
        true => field,
        false => Arc::new(only(&field, &drawn)),
    };
    Ok((field, drawn))
}

/// The values of the drawn cells; the others have none.
fn only(field: &CellField, drawn: &[bool]) -> CellField {
    let values = field.values().iter().zip(drawn);
    CellField::new(
        values
            .map(|(v, d)| if *d { *v } else { f32::NAN })
            .collect(),
    )
}

/// Middles of the cells of non-neighbor connections in world space, where both are drawn.
fn connections(case: &Case, spaces: &Spaces, drawn: &[bool]) -> Vec<[DVec3; 2]> {
    let grid = &case.grid;
    let middle = |ijk: Ijk| {
        let active = grid.active_index(grid.dims().cell(ijk))?;
        let center = grid.hexahedron(ijk).center();
        drawn[active.0 as usize].then(|| spaces.world_from_grid.transform_point3(center))
    };
    let ends = |[a, b]: &[Ijk; 2]| Some([middle(*a)?, middle(*b)?]);
    case.connections.iter().filter_map(ends).collect()
}

/// The camera that a scene asks for, given the corners of the model's box.
fn camera(spec: &CameraSpec, size: [u32; 2], corners: &[DVec3; 8]) -> Result<Camera, SceneError> {
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let camera = match spec {
        CameraSpec::Explicit(c) => {
            if !(c.fovy_degrees > 0.0 && c.fovy_degrees < 180.0) {
                return Err(wrong("camera.fovy_degrees", "must be between 0 and 180"));
            }
            let [eye, target, up] = [c.eye, c.target, c.up].map(DVec3::from_array);
            let camera = Camera::look_at(eye, target, up, c.fovy_degrees.to_radians());
            camera.map(|camera| camera.with(c.projection, target))
        }
        CameraSpec::Framing(c) => {
            let (azimuth, elevation) = (
                c.azimuth_degrees.to_radians(),
                c.elevation_degrees.to_radians(),
            );
            Camera::framing(
                corners,
                azimuth,
                elevation,
                positive("camera.zoom", c.zoom)?,
                aspect,
                c.projection,
            )
        }
    };
    camera
        .filter(|c| c.eye.is_finite() && c.forward.is_finite() && c.right.is_finite())
        .ok_or_else(|| {
            wrong(
                "camera",
                "eye, target and up must be three finite points that span a view",
            )
        })
}
