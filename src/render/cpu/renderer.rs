//! Images of one grid.

use std::sync::Arc;
use std::time::Instant;

use glam::{DVec3, Vec3A, Vec4};

use super::frame::Frame as FrameOfRays;
use super::grid::Grid;
use super::locate::{Query, locate};
use super::picture::{Picture, Strategy};
use super::scene::Scene;
use super::shading::Shading;
use super::surfaces::SurfaceFaces;
use super::transfer::{Tables, Transfer};
use crate::model::{CellField, Grid as Model, Ijk};
use crate::render::job::{Job, Progress};
use crate::render::plan::faces::face_numbers;
use crate::render::plan::frame::{frame_uniform, ghost};
use crate::render::{DeviceBytes, Frame, LightTimes, Located, RenderError, Renderer, SetupTimes};
use crate::scene::{Interpolation, StrategyKind};
use crate::view::View;
use crate::view::ghosts::{Ghosts, shown_grid};

/// Newton steps below this end a location that was asked for.
const PROBE_ENOUGH: f32 = 5e-6;

/// Makes images of one grid.
pub struct CpuRenderer {
    model: Arc<Model>,
    times: SetupTimes,
    grid: Grid,
    shown: Option<Shown>,
    tables: Option<Tables>,
    /// Boundary faces of the drawn cells, once a ray needs them.
    boundary: Option<Vec<u32>>,
    surfaces: Option<ShownSurfaces>,
}

/// The field and selection that are in memory.
#[derive(Clone, PartialEq)]
struct Shown {
    field: Arc<CellField>,
    drawn: Arc<Vec<bool>>,
    interpolation: Interpolation,
    ghosts: Option<Arc<Ghosts>>,
}

/// The faces of surfaces, and what they are those of.
struct ShownSurfaces {
    faces: SurfaceFaces,
    drawn: Arc<Vec<bool>>,
    has_hull: bool,
    has_faults: bool,
    chosen: Option<Arc<[bool]>>,
}

impl ShownSurfaces {
    fn new(model: &Model, view: &View) -> Result<Self, RenderError> {
        Ok(Self {
            faces: SurfaceFaces::new(model, view)?,
            drawn: view.shown.drawn.clone(),
            has_hull: view.style.surfaces.has_hull(),
            has_faults: view.style.surfaces.faults,
            chosen: view.shown.chosen_faults.clone(),
        })
    }

    fn are_of(&self, view: &View) -> bool {
        self.drawn == view.shown.drawn
            && self.has_hull == view.style.surfaces.has_hull()
            && self.has_faults == view.style.surfaces.faults
            && self.chosen == view.shown.chosen_faults
    }
}

impl CpuRenderer {
    /// Brings a grid into compact form.
    ///
    /// # Errors
    /// When it cannot be numbered.
    pub fn new(model: &Arc<Model>) -> Result<Self, RenderError> {
        let start = Instant::now();
        let grid = Grid::new(model, None)?;
        let acceleration = grid.compact.acceleration_time;
        Ok(Self {
            model: model.clone(),
            times: SetupTimes {
                upload: start.elapsed().saturating_sub(acceleration),
                acceleration,
            },
            grid,
            shown: None,
            tables: None,
            boundary: None,
            surfaces: None,
        })
    }

    async fn frame(&mut self, view: &View, progress: Progress) -> Result<Frame, RenderError> {
        let start = Instant::now();
        let strategy = supported(view)?;
        self.prepare(view)?;
        if !self.tables.as_ref().is_some_and(|t| t.are_of(view)) {
            self.tables = None;
        }
        let tables = self.tables.get_or_insert_with(|| Tables::new(view));
        let shown = shown_grid(&self.model, view.shown.ghosts.as_ref());
        let boundary = match self.boundary.take() {
            Some(known) => known,
            None => face_numbers(shown, &shown.boundary_faces(&view.shown.drawn))?,
        };
        let boundary = &*self.boundary.insert(boundary);
        let surfaces = match self.surfaces.take().filter(|s| s.are_of(view)) {
            Some(known) => known,
            None => ShownSurfaces::new(&self.model, view)?,
        };
        let surfaces = &self.surfaces.insert(surfaces).faces;
        let scene = Scene {
            frame: FrameOfRays::new(frame_uniform(&self.grid.compact.facts, view)),
            grid: &self.grid,
            transfer: Transfer::new(tables, view),
            ghost: Vec4::from(ghost(view)),
            shading: Shading::of(&view.style.lighting),
            surfaces: view.style.surfaces,
        };
        let prepare = start.elapsed();
        let picture = Picture {
            scene: &scene,
            view,
            strategy,
            boundary,
            surfaces,
        };
        let (image, stats) = picture.render(&progress).await;
        let lists = boundary.len() + surfaces.hull.len() + 2 * surfaces.faults.len();
        Ok(Frame {
            image,
            stats,
            prepare,
            light: LightTimes::default(),
            bytes: self.grid.bytes()
                + DeviceBytes {
                    geometry: 4 * lists as u64,
                    targets: stats.target_bytes,
                    ..DeviceBytes::default()
                },
        })
    }
}

/// What casts the rays of a view.
///
/// # Errors
/// When the view asks for what there is not.
fn supported(view: &View) -> Result<Strategy, RenderError> {
    let lighting = &view.style.lighting;
    if lighting.occlusion.is_some() || !lighting.lights.is_empty() {
        return Err(RenderError::Unsupported {
            what: "occlusion and lights",
        });
    }
    match view.sampling.strategy {
        _ if !view.casts_rays() => Ok(Strategy::Solid),
        StrategyKind::Plts => Ok(Strategy::Plts),
        StrategyKind::Libc => Ok(Strategy::Libc),
        StrategyKind::Srg => Err(RenderError::Unsupported {
            what: "the strategy srg",
        }),
    }
}

impl Renderer for CpuRenderer {
    fn grid(&self) -> &Arc<Model> {
        &self.model
    }

    fn setup_times(&self) -> SetupTimes {
        self.times
    }

    fn prepare(&mut self, view: &View) -> Result<(), RenderError> {
        let model = shown_grid(&self.model, view.shown.ghosts.as_ref());
        let wanted = Shown {
            field: view.shown.field.clone(),
            drawn: view.shown.drawn.clone(),
            interpolation: view.shown.interpolation,
            ghosts: view.shown.ghosts.clone(),
        };
        let known = self.shown.as_ref();
        if known == Some(&wanted) {
            return Ok(());
        }
        let ghosts_now = known.and_then(|s| s.ghosts.as_ref());
        if ghosts_now != wanted.ghosts.as_ref() {
            let is_ghost = wanted.ghosts.as_ref().map(|g| g.is_ghost.as_slice());
            self.grid = Grid::new(model, is_ghost)?;
            self.boundary = None;
        }
        if known.is_none_or(|s| s.drawn != wanted.drawn) {
            self.boundary = None;
        }
        self.grid
            .show(model, &wanted.field, &wanted.drawn, wanted.interpolation);
        self.shown = Some(wanted);
        Ok(())
    }

    fn start<'a>(&'a mut self, view: &'a View) -> Job<'a, Frame> {
        Job::new(|progress| Box::pin(self.frame(view, progress)))
    }

    fn locate(
        &mut self,
        view: &View,
        points: &[DVec3],
    ) -> Result<Vec<Option<Located>>, RenderError> {
        self.prepare(view)?;
        let grid = &self.grid;
        let ni = self.model.dims().ni;
        let locate = |world: &DVec3| {
            let in_grid = view.world.spaces.grid_from_world.transform_point3(*world);
            let point = in_grid - grid.compact.facts.origin;
            let rounded = point.as_vec3a();
            let query = Query {
                point: rounded,
                low_bits: (point - rounded.as_dvec3()).as_vec3a(),
                enough: PROBE_ENOUGH,
            };
            let (cell, solution) = locate(grid, query, Vec3A::ZERO).found?;
            let inside = solution.uvw.clamp(Vec3A::ZERO, Vec3A::ONE);
            Some(Located {
                ijk: Ijk {
                    i: cell.column as usize % ni,
                    j: cell.column as usize / ni,
                    k: cell.layer as usize,
                },
                parameters: (2.0 * inside - 1.0).as_dvec3(),
                value: f64::from(cell.value(inside)),
            })
        };
        Ok(points.iter().map(locate).collect())
    }
}
