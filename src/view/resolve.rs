//! A scene against a case: every default filled in, every value checked.

use std::sync::Arc;

use glam::DVec3;

use super::bounds::{automatic_exaggeration, bounds_of, box_corners, box_edges};
use super::colors::{self, ColorRequest, Colors, interpolation};
use super::error::{SceneError, positive, wrong};
use super::facts::{self, Facts};
use super::framing::{self, Direction, Subject};
use super::ghosts::Ghosts;
use super::grids::ShownGrids;
use super::lighting::{self, Lighting};
use super::look::default_property;
use super::step::step_of;
use super::voxels::Shape;
use super::wells::Measures;
use super::{
    Camera, ClipPlane, Notes, Sampling, Shown, ShownCells, ShownCube, Style, Surfaces, View, World,
    clip, cube, filter, surfaces, wells,
};
use crate::case::Case;
use crate::model::{CellField, Dims, Grid, Ijk, Space, Spaces};
use crate::scene::{CameraSpec, Inactive, Mode, Scene, SrgSettings};
use crate::transfer::presets;

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
    check_space(scene, case)?;
    let exaggeration = exaggeration(scene, active_bounds(case)?)?;
    let spaces = Spaces::new(case.grid.map_axes(), exaggeration);
    let edges = case.mean_edges(exaggeration);
    let (property, step) = shown_values(scene, case)?;
    let field = case.field(&property, step)?;
    let asked = ColorRequest {
        scene,
        case,
        property: &property,
        range,
        mean_edge: edges.element_sum() / 3.0,
        exaggeration,
        thinnest: filter::thinnest(&scene.filter, case.grid.main_dims(), edges)?,
    };
    let Colors {
        field: in_scale,
        transfer,
        beyond,
    } = colors::resolve(&asked, &field)?;
    let clip = clip::planes(&scene.clip, scene.mode)?;
    let Cells {
        drawn,
        ghosts,
        connections,
        facts,
        subject,
        box_corners,
        are_all_grids,
    } = cells(&asked, [&field, &in_scale], &spaces, &clip)?;
    let world_bounds = bounds_of(&box_corners);
    let wells = wells::shown(scene, case, &Measures::of(&spaces, &box_corners, edges))?;
    let size = checked_size(scene.size, scene.supersample)?;
    let sampling = sampling(scene, case.grid.main_dims(), edges, world_bounds)?;
    let cube = cube::shown(scene, case, &spaces, sampling.step)?;
    let sampling = sampling.beside(cube.as_deref());
    let framed = Framed::new(&subject, &box_corners, cube.as_deref());
    Ok(View {
        size,
        camera: camera(&scene.camera, size, &framed, scene.show.r#box)?,
        sampling,
        style: Style {
            background: background(scene)?,
            transfer,
            beyond,
            blending: scene.blending,
            surfaces: wells.among(Surfaces::of(scene)),
            lighting: lighting(scene, case, &box_corners)?,
        },
        shown: Shown {
            property,
            step,
            cells: ShownCells {
                field: in_scale,
                interpolation: interpolation(scene),
                drawn: Arc::new(drawn),
                is_filtered: scene.filter.limits() || !are_all_grids,
                ghosts,
            },
            clip,
            connections,
            wells,
            named_faults: case.fault_faces.clone(),
            chosen_faults: surfaces::chosen(&scene.show.faults, case)?,
            cube,
        },
        world: World {
            spaces,
            vertical_exaggeration: exaggeration,
            space: scene.space.into(),
            bounds: world_bounds,
            corners: box_corners,
            subject: Arc::new(subject),
        },
        notes: notes(scene, case, facts)?,
    })
}

/// The property and the step of a scene.
fn shown_values(scene: &Scene, case: &Case) -> Result<(String, usize), SceneError> {
    let named = scene.property.clone();
    let property = named.unwrap_or_else(|| default_property(case));
    let step = step_of(case, &scene.step, case.is_dynamic(&property))?;
    Ok((property, step))
}

fn notes(scene: &Scene, case: &Case, facts: Option<Arc<Facts>>) -> Result<Notes, SceneError> {
    Ok(Notes {
        has_box: scene.show.r#box,
        has_legend: scene.show.legend,
        facts,
        units: scene.units.into(),
        warnings: warnings(scene, case)?,
    })
}

/// What a scene asks for in vain, and what was guessed, one sentence each.
///
/// # Errors
/// When a file cannot be read.
pub fn warnings(scene: &Scene, case: &Case) -> Result<Vec<String>, SceneError> {
    let mut warnings = wells::warnings(scene, case)?;
    warnings.extend(cube::warnings(scene, case)?);
    Ok(warnings)
}

fn background(scene: &Scene) -> Result<[f64; 3], SceneError> {
    let color = presets::parse_color(&scene.background);
    color.ok_or_else(|| wrong("background", "must be a color like #ffffff"))
}

fn sampling(
    scene: &Scene,
    dims: Dims,
    edges: DVec3,
    bounds: [DVec3; 2],
) -> Result<Sampling, SceneError> {
    Ok(Sampling {
        strategy: scene.strategy,
        step: sampling_step(scene, edges, bounds)?,
        early_termination: early_termination(scene)?,
        supersample: scene.supersample,
        libc: scene.libc,
        plts: scene.plts,
        srg: srg(scene, dims)?,
        storage: scene.storage,
    })
}

/// The box in grid space of the cells that can be shown.
fn active_bounds(case: &Case) -> Result<[DVec3; 2], SceneError> {
    let grid = &case.grid;
    match grid.bounds() {
        None => Err(SceneError::Empty),
        Some(_) if !grid.thick().contains(&true) => Err(SceneError::Flat),
        Some(bounds) => Ok(bounds),
    }
}

fn lighting(scene: &Scene, case: &Case, corners: &[DVec3; 8]) -> Result<Lighting, SceneError> {
    let cells = case.grid.main_dims().cells();
    let lighting = lighting::resolve(&scene.lighting, box_edges(corners), cells)?;
    Ok(match scene.mode {
        Mode::Cells => lighting.on_solid_cells(),
        Mode::Volume => lighting,
    })
}

fn exaggeration(scene: &Scene, bounds: [DVec3; 2]) -> Result<f64, SceneError> {
    match scene.vertical_exaggeration {
        Some(v) => positive("vertical_exaggeration", v),
        None => Ok(automatic_exaggeration(bounds, scene.space.into())),
    }
}

fn check_version(scene: &Scene) -> Result<(), SceneError> {
    if scene.version != 1 {
        let problem = format!("{} is not known; this is version 1", scene.version);
        return Err(wrong("version", problem));
    }
    Ok(())
}

fn check_space(scene: &Scene, case: &Case) -> Result<(), SceneError> {
    match Space::from(scene.space) == case.grid.space() {
        true => Ok(()),
        false => Err(wrong(
            "space",
            "is another one than that of the case; take it by Case::in_space",
        )),
    }
}

fn early_termination(scene: &Scene) -> Result<f64, SceneError> {
    match (0.0..1.0).contains(&scene.early_termination) {
        true => Ok(scene.early_termination),
        false => Err(wrong("early_termination", "must be at least 0 and below 1")),
    }
}

/// Rays of an image each way, at most.
const MOST_RAYS: u32 = 16384;

/// Rays along each axis of a pixel, at most.
const MOST_SUPERSAMPLES: u32 = 8;

pub(super) fn checked_size(size: [u32; 2], supersample: u32) -> Result<[u32; 2], SceneError> {
    if !(1..=MOST_SUPERSAMPLES).contains(&supersample) {
        let problem = format!("must be 1 to {MOST_SUPERSAMPLES} rays along each axis of a pixel");
        return Err(wrong("supersample", problem));
    }
    let most = MOST_RAYS / supersample;
    match (size.iter().all(|n| (1..=most).contains(n)), supersample) {
        (true, _) => Ok(size),
        (false, 1) => Err(wrong(
            "size",
            format!("must be 1 to {most} pixels each way"),
        )),
        (false, n) => {
            let problem = format!("must be 1 to {most} pixels each way with \"supersample\": {n}");
            Err(wrong("size", problem))
        }
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
        let budget = settings.budget_bytes();
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

/// Which cells are drawn, and what follows from that.
struct Cells {
    drawn: Vec<bool>,
    ghosts: Option<Arc<Ghosts>>,
    connections: Arc<Vec<[DVec3; 2]>>,
    facts: Option<Arc<Facts>>,
    subject: Subject,
    /// Of all cells that could be drawn.
    box_corners: [DVec3; 8],
    /// No grid is hidden, and none refines another.
    are_all_grids: bool,
}

/// The cells of a scene, from the values of the property: true ones, and those in the scale of its colors.
fn cells(
    asked: &ColorRequest<'_>,
    [values, in_scale]: [&CellField; 2],
    spaces: &Spaces,
    clip: &[ClipPlane],
) -> Result<Cells, SceneError> {
    let ColorRequest { scene, case, .. } = *asked;
    let grids = ShownGrids::of(&scene.grids, &case.grid)?;
    let drawn = filter::drawn(case, in_scale, &grids, &scene.filter, &scene.step)?;
    let framed = match framing::still(&scene.filter, case) {
        Some(still) => filter::drawn(case, values, &grids, &still, &scene.step)?,
        None => drawn.clone(),
    };
    let facts = scene.show.info.then(|| {
        let seen = facts::uncut(&case.grid, &drawn, clip, spaces);
        Arc::new(Facts::of(
            case,
            asked.property,
            values,
            (&seen, &grids),
            scene,
        ))
    });
    let connections = match scene.show.nnc {
        true => connections(case, spaces, &drawn),
        false => Vec::new(),
    };
    let ghosts = match scene.show.inactive {
        Inactive::Hidden => None,
        Inactive::Ghost => Some(Arc::new(Ghosts::new(&case.grid, &grids, &drawn))),
    };
    let (grid, framed): (&Grid, _) = match &ghosts {
        None => (&case.grid, framed),
        Some(ghosts) => (&ghosts.grid, ghosts.with(&case.grid, &framed)),
    };
    let subject = Subject::of(grid, &framed, spaces).ok_or(SceneError::Empty)?;
    let bounds = grid.bounds().ok_or(SceneError::Empty)?;
    Ok(Cells {
        box_corners: box_corners(spaces, bounds),
        drawn,
        ghosts,
        connections: Arc::new(connections),
        facts,
        subject,
        are_all_grids: grids.are_all(),
    })
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

/// What a camera frames, and what must lie before it.
pub(super) struct Framed<'a> {
    /// What it frames.
    pub subject: &'a Subject,
    /// Corners of the model's box.
    pub corners: &'a [DVec3; 8],
    /// What is drawn beside the model.
    pub cube: Option<&'a ShownCube>,
}

impl<'a> Framed<'a> {
    /// A subject, corners and cube.
    pub fn new(subject: &'a Subject, corners: &'a [DVec3; 8], cube: Option<&'a ShownCube>) -> Self {
        Self {
            subject,
            corners,
            cube,
        }
    }
}

/// The camera that a scene asks for.
pub(super) fn camera(
    spec: &CameraSpec,
    size: [u32; 2],
    framed: &Framed<'_>,
    has_box: bool,
) -> Result<Camera, SceneError> {
    let subject = framed.subject;
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let framing = |from, zoom| -> Result<Option<Camera>, SceneError> {
        let zoom = positive("camera.zoom", zoom)?;
        let camera = subject.camera(from, zoom, spec.projection(), aspect, has_box);
        // The plane of a parallel one stays before all that is drawn, of which only a part may be framed.
        let cube = framed.cube.map(ShownCube::corners);
        let before = |c: Camera| {
            cube.iter()
                .fold(c.before(framed.corners), |c, all| c.before(all))
        };
        Ok(camera.map(before))
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
