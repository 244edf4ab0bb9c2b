//! Images of one grid.

use std::sync::Arc;
use std::time::Instant;

use glam::{DVec3, Vec3A, Vec4};
use rayon::prelude::*;

use super::cube::KeptCube;
use super::frame::Frame as FrameOfRays;
use super::grid::Grid;
use super::illumination::{Illumination, Source};
use super::kept::Kept;
use super::locate::{Query, locate};
use super::picture::{Picture, Strategy};
use super::scene::Scene;
use super::shading::Shading;
use super::srg::Srg;
use super::surfaces::SurfaceFaces;
use super::transfer::{Tables, Transfer};
use crate::model::{Grid as Model, Ijk};
use crate::render::job::{Progress, Work};
use crate::render::line_of_sight::SurfaceTree;
use crate::render::plan::faces::face_numbers;
use crate::render::plan::frame::{frame_uniform, ghost};
use crate::render::plan::visible::{can_be_passed, visible_faces};
use crate::render::revisions::{RevisionCounter, Revisions};
use crate::render::{DeviceBytes, Frame, Located, RenderError, Renderer, SetupTimes};
use crate::scene::{Storage, StrategyKind};
use crate::view::View;

/// Newton steps below this end a location that was asked for.
const PROBE_ENOUGH: f32 = 5e-6;

/// Makes images of one grid.
pub struct CpuRenderer {
    model: Arc<Model>,
    times: SetupTimes,
    grid: Grid,
    /// Counts the views.
    counter: RevisionCounter,
    /// Those of what the grid shows.
    revisions: Revisions,
    tables: Kept<Tables>,
    light: Illumination,
    srg: Srg,
    /// Boundary faces of the drawn cells, once a ray needs them.
    boundary: Kept<Vec<u32>>,
    /// The visible ones of them, where rays do not meet all.
    visible: Kept<Option<Visible>>,
    surfaces: Kept<SurfaceFaces>,
    cube: KeptCube,
    /// Faces of surfaces that were looked at.
    surface_tree: SurfaceTree,
}

/// The drawn cells in which something shows.
struct Visible {
    /// Their bits, by slot.
    words: Vec<u32>,
    /// Their boundary faces.
    boundary: Vec<u32>,
}

impl Visible {
    /// Those of a view of a grid; `None` where something shows in all drawn cells.
    fn of(held: &Grid, grid: &Model, view: &View) -> Result<Option<Self>, RenderError> {
        let words = held.visible_words(view);
        let with_faces = |words: Vec<u32>| {
            let boundary = visible_faces(grid, &words)?;
            Ok(Self { words, boundary })
        };
        words.map(with_faces).transpose()
    }
}

impl CpuRenderer {
    /// Brings a grid into compact form.
    ///
    /// # Errors
    /// When it cannot be numbered.
    pub fn new(model: &Arc<Model>) -> Result<Self, RenderError> {
        let start = Instant::now();
        let grid = Grid::new(model, Storage::Exact)?;
        let acceleration = grid.compact.acceleration_time;
        Ok(Self {
            model: model.clone(),
            times: SetupTimes {
                upload: start.elapsed().saturating_sub(acceleration),
                acceleration,
            },
            grid,
            counter: RevisionCounter::default(),
            revisions: Revisions::default(),
            tables: Kept::default(),
            light: Illumination::default(),
            srg: Srg::default(),
            boundary: Kept::default(),
            visible: Kept::default(),
            surfaces: Kept::default(),
            cube: KeptCube::default(),
            surface_tree: SurfaceTree::default(),
        })
    }

    async fn frame(&mut self, view: &View, progress: Progress) -> Result<Frame, RenderError> {
        let start = Instant::now();
        let strategy = strategy_of(view);
        self.prepare(view)?;
        let (model, now) = (&self.model, self.revisions);
        let tables = self.tables.update(now.transfer, || Ok(Tables::new(view)))?;
        let source = Source {
            model,
            grid: &self.grid,
            revisions: now,
            view,
            tables,
        };
        self.light.update(&source, &progress).await;
        if strategy == Strategy::Srg {
            let (grid, _) = view.shown.cells.in_grid(model);
            self.srg.update(&source, grid.main_dims(), &progress).await;
        }
        let (grid, drawn) = view.shown.cells.in_grid(model);
        let visible = match can_be_passed(view, &self.grid.compact.facts) {
            true => self
                .visible
                .update(now.visible, || Visible::of(&self.grid, grid, view))?,
            false => &None,
        };
        let boundary = match visible {
            Some(visible) => &visible.boundary,
            None => self.boundary.update(now.drawn, || {
                face_numbers(grid, &grid.boundary_faces(drawn))
            })?,
        };
        let surfaces = self
            .surfaces
            .update(now.surfaces, || SurfaceFaces::new(model, view))?;
        let cube = self.cube.update(&self.grid.compact.facts, view, now);
        let cube_bytes = cube.as_ref().map_or(0, |cube| cube.voxels.bytes());
        let scene = Scene {
            frame: FrameOfRays::new(frame_uniform(&self.grid.compact.facts, view)),
            grid: &self.grid,
            visible: visible.as_ref().map(|visible| visible.words.as_slice()),
            transfer: Transfer::new(tables, view),
            ghost: Vec4::from(ghost(view)),
            shading: Shading::new(&view.style.lighting, self.light.light()),
            surfaces: view.style.surfaces,
            cube,
        };
        let prepare = start.elapsed();
        let picture = Picture {
            scene: &scene,
            view,
            strategy,
            srg: self.srg.volume(),
            boundary,
            surfaces,
        };
        let (image, stats) = picture.render(&progress).await;
        let lists = boundary.len() + surfaces.hull.len() + 2 * surfaces.faults.len();
        Ok(Frame {
            image,
            stats,
            prepare,
            light: self.light.times,
            storage_error: self.grid.storage_error(),
            bytes: self.grid.bytes()
                + DeviceBytes {
                    geometry: 4 * lists as u64,
                    lighting: self.light.bytes(),
                    cube: cube_bytes,
                    resampled: match strategy {
                        Strategy::Srg => self.srg.bytes(),
                        _ => 0,
                    },
                    targets: stats.target_bytes,
                    ..DeviceBytes::default()
                },
        })
    }
}

/// What casts the rays of a view.
fn strategy_of(view: &View) -> Strategy {
    match view.sampling.strategy {
        _ if !view.casts_rays() => Strategy::Solid,
        StrategyKind::Plts => Strategy::Plts,
        StrategyKind::Libc => Strategy::Libc,
        StrategyKind::Srg => Strategy::Srg,
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
        let cells = &view.shown.cells;
        let wanted = self.counter.of(view);
        if self.revisions.grid != wanted.grid {
            self.grid = Grid::of(&self.model, view)?;
        }
        if self.revisions.values != wanted.values {
            self.grid.show(&self.model, cells);
        }
        self.revisions = wanted;
        Ok(())
    }

    fn cast<'a>(&'a mut self, rays: &'a View, progress: Progress) -> Work<'a, Frame> {
        Box::pin(self.frame(rays, progress))
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
        Ok(points.par_iter().map(locate).collect())
    }

    fn surface_tree(&mut self) -> &mut SurfaceTree {
        &mut self.surface_tree
    }
}
