//! A scene against a case: every default filled in, every value checked.

use std::sync::Arc;

use glam::{DVec3, DVec4};
use rayon::prelude::*;

use super::colors::{self, Asked, Colors, interpolation};
use super::facts::{self, Facts};
use super::framing::{self, Direction, Subject};
use super::ghosts::{Ghosts, shown_grid};
use super::lighting::{self, Lighting};
use super::look::default_property;
use super::{
    Blending, Camera, CameraSpec, ClipSpec, CutFace, Inactive, Interpolation, LibcSettings, Mode,
    Scene, SrgSettings, StepSpec, Surfaces, filter, surfaces,
};
use crate::case::{Case, CaseError};
use crate::gpu::volume::Shape;
use crate::model::{CellField, CellIndex, Dims, FaultFaces, Grid, Ijk, Spaces};
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
    /// A key is unknown or its value has another form.
    #[error("scene: {0}")]
    Text(String),
    /// The case cannot give what the scene asks for.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// No cell is active.
    #[error("the case has no active cell to show")]
    Empty,
    /// No active cell has a thickness.
    #[error("all active cells of the case have zero thickness; there is nothing to show")]
    Flat,
    /// The property is the same at all steps.
    #[error(
        "{0} is static, so there is no animation over its steps; name a property that changes with time, or animate over the orbit"
    )]
    Static(String),
    /// The steps of a film are not what they should be.
    #[error("steps: {0}")]
    Steps(String),
    /// A turn of the camera is not what it should be.
    #[error("a rotation needs at least one view and a finite number of degrees")]
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
    /// The cells that cameras frame.
    pub subject: Arc<Subject>,
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
    /// Values of the step shown lie below its range, and above.
    pub beyond: [bool; 2],
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
    /// By number of the named faults: true where the fault is drawn, of which those without a name are none;
    /// all faults where absent.
    pub chosen_faults: Option<Arc<[bool]>>,
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
    /// What is drawn in numbers, for the line below the picture; `None` where that is hidden.
    pub facts: Option<Arc<Facts>>,
}

impl View {
    /// The same view from another camera, in another size; nothing is read.
    ///
    /// # Errors
    /// When camera or size are not allowed.
    pub fn seen_from(&self, camera_spec: &CameraSpec, size: [u32; 2]) -> Result<Self, SceneError> {
        let size = checked_size(size)?;
        let of = (&*self.subject, &self.box_corners);
        let camera = camera(camera_spec, size, of, self.show_box)?;
        Ok(Self {
            size,
            camera,
            ..self.clone()
        })
    }

    /// The same view for the adapter that renders it: where the scene leaves the extinction volume open, a GPU has
    /// more voxels of it. A resolved view has those of an adapter in software.
    #[must_use]
    pub fn for_adapter(self, is_software: bool) -> Self {
        Self {
            lighting: self.lighting.for_adapter(is_software),
            ..self
        }
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
    let exaggeration = exaggeration(scene, active_bounds(case)?)?;
    let spaces = Spaces::new(case.grid.map_axes(), exaggeration);
    let edges = mean_world_edges(case, exaggeration);
    let property = match &scene.property {
        Some(name) => name.clone(),
        None => default_property(case),
    };
    let step = step_of(case, &scene.step, case.is_dynamic(&property))?;
    let field = case.field(&property, step)?;
    let asked = Asked {
        scene,
        case,
        property: &property,
        range,
        mean_edge: edges.element_sum() / 3.0,
        exaggeration,
        thinnest: scene.filter.thinnest(case.grid.dims(), edges)?,
    };
    let Colors {
        field: shown,
        transfer,
        beyond,
    } = colors::resolve(&asked, &field)?;
    let clip = clip(&scene.clip, scene.mode)?;
    let Cells {
        field,
        drawn,
        ghosts,
        connections,
        facts,
        subject,
        box_corners,
    } = cells(&asked, [field, shown], &spaces, &clip)?;
    let world_bounds = bounds_of(&box_corners);
    let size = checked_size(scene.size)?;
    Ok(View {
        size,
        background: presets::parse_color(&scene.background)
            .ok_or_else(|| wrong("background", "must be a color like #ffffff"))?,
        camera: camera(
            &scene.camera,
            size,
            (&subject, &box_corners),
            scene.show.r#box,
        )?,
        spaces,
        vertical_exaggeration: exaggeration,
        world_bounds,
        box_corners,
        subject: Arc::new(subject),
        strategy: strategy(scene)?,
        step,
        interpolation: interpolation(scene),
        transfer,
        beyond,
        blending: scene.blending,
        sampling_step: sampling_step(scene, edges, world_bounds)?,
        early_termination: early_termination(scene)?,
        property,
        field,
        drawn: Arc::new(drawn),
        ghosts,
        clip,
        surfaces: Surfaces::of(scene),
        connections,
        named_faults: case.fault_faces.clone(),
        chosen_faults: surfaces::chosen(&scene.show.faults, case)?,
        lighting: lighting(scene, case, &box_corners)?,
        libc: scene.libc,
        srg: srg(scene, case.grid.dims())?,
        show_box: scene.show.r#box,
        show_legend: scene.show.legend,
        facts,
    })
}

/// The box in grid space of the cells that can be shown.
fn active_bounds(case: &Case) -> Result<[DVec3; 2], SceneError> {
    let grid = &case.grid;
    let has_thickness = |c: &CellIndex| grid.has_thickness(grid.dims().ijk(*c));
    match grid.bounds() {
        None => Err(SceneError::Empty),
        Some(_) if !grid.active_cells().iter().any(has_thickness) => Err(SceneError::Flat),
        Some(bounds) => Ok(bounds),
    }
}

fn lighting(scene: &Scene, case: &Case, corners: &[DVec3; 8]) -> Result<Lighting, SceneError> {
    let cells = case.grid.dims().cells();
    let lighting = lighting::resolve(&scene.lighting, box_edges(corners), cells)?;
    Ok(match scene.mode {
        Mode::Cells => lighting.on_solid_cells(),
        Mode::Volume => lighting,
    })
}

fn exaggeration(scene: &Scene, bounds: [DVec3; 2]) -> Result<f64, SceneError> {
    match scene.vertical_exaggeration {
        Some(v) => positive("vertical_exaggeration", v),
        None => Ok(automatic_exaggeration(bounds)),
    }
}

fn bounds_of(points: &[DVec3]) -> [DVec3; 2] {
    let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    points
        .iter()
        .fold(start, |[a, b], p| [a.min(*p), b.max(*p)])
}

fn check_version(scene: &Scene) -> Result<(), SceneError> {
    if scene.version != 1 {
        let problem = format!("{} is not known; this is version 1", scene.version);
        return Err(wrong("version", problem));
    }
    Ok(())
}

fn strategy(scene: &Scene) -> Result<StrategyKind, SceneError> {
    let kind = StrategyKind::from_name(&scene.strategy);
    kind.ok_or_else(|| wrong("strategy", StrategyKind::refusal(&scene.strategy)))
}

fn early_termination(scene: &Scene) -> Result<f64, SceneError> {
    match (0.0..1.0).contains(&scene.early_termination) {
        true => Ok(scene.early_termination),
        false => Err(wrong("early_termination", "must be at least 0 and below 1")),
    }
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
pub(super) fn box_corners(spaces: &Spaces, [low, high]: [DVec3; 2]) -> [DVec3; 8] {
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

/// The step that a scene names, of what changes with time; else 0.
pub(super) fn step_of(case: &Case, spec: &StepSpec, dynamic: bool) -> Result<usize, SceneError> {
    if !dynamic {
        return Ok(0);
    }
    Ok(match spec {
        StepSpec::Index(n) => case.step(&n.to_string())?,
        StepSpec::Name(name) => case.step(name)?,
    })
}

/// Which cells are drawn, and what follows from that.
struct Cells {
    field: Arc<CellField>,
    drawn: Vec<bool>,
    ghosts: Option<Arc<Ghosts>>,
    connections: Arc<Vec<[DVec3; 2]>>,
    facts: Option<Arc<Facts>>,
    subject: Subject,
    /// Of all cells that could be drawn.
    box_corners: [DVec3; 8],
}

/// The cells of a scene, from the values of the property: true ones, and those in the scale of its colors.
fn cells(
    asked: &Asked<'_>,
    [values, field]: [Arc<CellField>; 2],
    spaces: &Spaces,
    clip: &[ClipPlane],
) -> Result<Cells, SceneError> {
    let Asked { scene, case, .. } = *asked;
    let (field, drawn) = filtered(case, field, scene)?;
    let framed = match framing::still(&scene.filter, case) {
        Some(still) => filter::drawn(case, &values, &still, &scene.step)?,
        None => drawn.clone(),
    };
    let facts = scene.show.info.then(|| {
        let seen = facts::uncut(&case.grid, &drawn, clip, spaces);
        Arc::new(Facts::of(case, asked.property, &values, &seen, scene))
    });
    let connections = match scene.show.nnc {
        true => connections(case, spaces, &drawn),
        false => Vec::new(),
    };
    let (ghosts, field, drawn, framed) = match scene.show.inactive {
        Inactive::Hidden => (None, field, drawn, framed),
        Inactive::Ghost => {
            let (ghosts, field, drawn) = Ghosts::new(&case.grid, &field, &drawn);
            let framed = ghosts.with(&case.grid, &framed);
            (Some(Arc::new(ghosts)), Arc::new(field), drawn, framed)
        }
    };
    let grid = shown_grid(&case.grid, ghosts.as_ref());
    let subject = Subject::of(grid, &framed, spaces).ok_or(SceneError::Empty)?;
    let bounds = grid.bounds().ok_or(SceneError::Empty)?;
    Ok(Cells {
        box_corners: box_corners(spaces, bounds),
        field,
        drawn,
        ghosts,
        connections: Arc::new(connections),
        facts,
        subject,
    })
}

/// Which cells are drawn, and their values: averages at vertices are of drawn cells, so that no color of a cell
/// shows that is filtered away.
fn filtered(
    case: &Case,
    field: Arc<CellField>,
    scene: &Scene,
) -> Result<(Arc<CellField>, Vec<bool>), SceneError> {
    let drawn = filter::drawn(case, &field, &scene.filter, &scene.step)?;
    let field = match scene.filter.limits() {
        true => Arc::new(only(&field, &drawn)),
        false => field,
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

/// The camera that a scene asks for, given what it frames and the corners of the model's box.
fn camera(
    spec: &CameraSpec,
    size: [u32; 2],
    (subject, corners): (&Subject, &[DVec3; 8]),
    has_box: bool,
) -> Result<Camera, SceneError> {
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let framing = |from, zoom| -> Result<Option<Camera>, SceneError> {
        let zoom = positive("camera.zoom", zoom)?;
        let camera = subject.camera(from, zoom, spec.projection(), aspect, has_box);
        // The plane of a parallel one stays before the whole model, of which only a part may be framed.
        Ok(camera.map(|c| c.before(corners)))
    };
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
            let from = Direction {
                azimuth: c.azimuth_degrees,
                elevation: c.elevation_degrees,
            };
            framing(Some(from), c.zoom)?
        }
        CameraSpec::Automatic(c) => framing(None, c.zoom)?,
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
