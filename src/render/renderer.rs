//! A device with one grid on it, which makes pictures of views and remakes only what a view changes.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec3;

use crate::image::Image;
use crate::model::{CellField, Grid};
use crate::render::gpu::faces::{BoundaryFaces, FaceList};
use crate::render::gpu::illumination::{Illumination, LightTimes};
use crate::render::gpu::probe::{Located, Probe};
use crate::render::gpu::strategies::solid::Solid;
use crate::render::gpu::strategies::{self};
use crate::render::gpu::strategy::{Preparation, RenderStrategy};
use crate::render::gpu::surfaces::SurfacePainter;
use crate::render::gpu::transfer_tables::TransferTables;
use crate::render::gpu::{Drawing, FrameRenderer, FrameStats, Gpu, GpuBytes, GpuError, GpuGrid};
use crate::scene::{Interpolation, StrategyKind};
use crate::view::View;
use crate::view::ghosts::{Ghosts, shown_grid};

/// Makes pictures of one grid.
pub struct Renderer {
    gpu: Arc<Gpu>,
    grid: GpuGrid,
    frames: FrameRenderer,
    tables: Option<TransferTables>,
    light: Illumination,
    faces: BoundaryFaces,
    /// Made when surfaces are first shown.
    surfaces: Option<SurfacePainter>,
    strategies: Vec<(StrategyKind, Box<dyn RenderStrategy>)>,
    /// Made when cells are first shown as solid.
    solid: Option<Solid>,
    /// Made when points are first located.
    probe: Option<Probe>,
    shown: Option<Shown>,
}

/// The field and selection that are on the device.
#[derive(Clone, PartialEq)]
struct Shown {
    field: Arc<CellField>,
    drawn: Arc<Vec<bool>>,
    interpolation: Interpolation,
    ghosts: Option<Arc<Ghosts>>,
}

/// A picture and what it cost.
pub struct Frame {
    /// The picture.
    pub image: Image,
    /// What its rays cost.
    pub stats: FrameStats,
    /// Time to bring field, selection and what the strategy keeps up to date.
    pub prepare: Duration,
    /// Of it, what bringing the light up to date took.
    pub light: LightTimes,
    /// Bytes on the device by purpose.
    pub bytes: GpuBytes,
}

impl Frame {
    /// The frame whose rays took the median time; `None` of none.
    pub fn median(mut frames: Vec<Self>) -> Option<Self> {
        frames.sort_by_key(|f| f.stats.frame);
        let middle = frames.len() / 2;
        (middle < frames.len()).then(|| frames.swap_remove(middle))
    }
}

impl Renderer {
    /// Uploads a grid.
    ///
    /// # Errors
    /// When the adapter cannot hold it.
    pub fn new(gpu: Arc<Gpu>, grid: &Grid) -> Result<Self, GpuError> {
        Ok(Self {
            grid: GpuGrid::new(&gpu, grid)?,
            light: Illumination::new(&gpu)?,
            tables: None,
            faces: BoundaryFaces::default(),
            surfaces: None,
            gpu,
            frames: FrameRenderer::default(),
            strategies: Vec::new(),
            solid: None,
            probe: None,
            shown: None,
        })
    }

    /// Time that building the acceleration grid took.
    pub fn acceleration_time(&self) -> Duration {
        self.grid.acceleration_time
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Renders a view of `grid` (the one given to [`Self::new`]); `None` where `progress`, which is
    /// told the fraction done, returned false.
    ///
    /// # Errors
    /// When the picture or the values are too large for the adapter, or the device reports an error.
    pub fn render(
        &mut self,
        grid: &Grid,
        view: &View,
        progress: &dyn Fn(f64) -> bool,
    ) -> Result<Option<Frame>, GpuError> {
        let start = Instant::now();
        self.gpu.check()?;
        self.show(grid, view)?;
        let (of_case, grid) = (grid, shown_grid(grid, view.ghosts.as_ref()));
        let Self {
            gpu,
            grid: on_device,
            frames,
            tables,
            light,
            faces,
            surfaces,
            ..
        } = self;
        let tables = match tables.take().filter(|t| t.are_of(view)) {
            Some(known) => tables.insert(known),
            None => tables.insert(TransferTables::new(gpu, view)?),
        };
        if !light.update(gpu, on_device, view, tables, progress)? {
            return Ok(None);
        }
        let strategy = match view.casts_rays() {
            true => strategy(gpu, &mut self.strategies, view.strategy)?,
            false => solid(gpu, &mut self.solid)?,
        };
        let faces = match strategy.draws_faces() || SurfacePainter::shares_faces(view) {
            true => Some(faces.update(gpu, grid, on_device, &view.drawn)?),
            false => None,
        };
        let mut surfaces = surfaces_of(gpu, surfaces, view)?;
        if let Some(surfaces) = &mut surfaces {
            surfaces.update(gpu, of_case, on_device, view, faces, light.work())?;
        }
        let preparation = Preparation {
            gpu,
            model: grid,
            grid: on_device,
            view,
            faces,
            progress,
        };
        if !strategy.prepare(&preparation)? {
            return Ok(None);
        }
        gpu.wait()?;
        let prepare = start.elapsed();
        let lists = surfaces.as_ref().map_or(0, |s| s.bytes(view));
        let drawing = Drawing {
            light: light.bind(gpu, tables),
            surfaces,
            strategy,
        };
        let made = frames.render(gpu, on_device, drawing, view, progress)?;
        Ok(made.map(|(image, stats)| Frame {
            image,
            stats,
            prepare,
            light: light.times,
            bytes: on_device.bytes()
                + strategy.bytes()
                + GpuBytes {
                    geometry: faces.map_or(0, FaceList::bytes) + lists,
                    targets: stats.target_bytes,
                    lighting: light.bytes(),
                    ..GpuBytes::default()
                },
        }))
    }

    /// The light, as the last picture had it.
    pub fn light(&self) -> &Illumination {
        &self.light
    }

    /// Locates points of world space in the drawn cells of a view of `grid` (the one given to [`Self::new`]);
    /// `None` where a point lies in none.
    ///
    /// # Errors
    /// When the device reports an error.
    pub fn locate(
        &mut self,
        grid: &Grid,
        view: &View,
        points: &[DVec3],
    ) -> Result<Vec<Option<Located>>, GpuError> {
        self.show(grid, view)?;
        let grid = shown_grid(grid, view.ghosts.as_ref());
        let probe = match self.probe.take().filter(|p| p.fits(&self.grid)) {
            Some(known) => self.probe.insert(known),
            None => self.probe.insert(Probe::new(&self.gpu, &self.grid)?),
        };
        let to_grid = |p: &DVec3| view.spaces.grid_from_world.transform_point3(*p);
        let points: Vec<DVec3> = points.iter().map(to_grid).collect();
        probe.locate(&self.gpu, &self.grid, grid, &points, view.interpolation)
    }

    /// Brings field and selection of a view of `grid`, the one given to [`Self::new`], to the device.
    /// Rendering does so by itself; done before,
    /// it is no part of what the first picture takes.
    ///
    /// # Errors
    /// When the values are too large for the adapter.
    pub fn show(&mut self, grid: &Grid, view: &View) -> Result<(), GpuError> {
        let grid = shown_grid(grid, view.ghosts.as_ref());
        let wanted = Shown {
            field: view.field.clone(),
            drawn: view.drawn.clone(),
            interpolation: view.interpolation,
            ghosts: view.ghosts.clone(),
        };
        let ghosts_now = self.shown.as_ref().and_then(|s| s.ghosts.as_ref());
        if ghosts_now != wanted.ghosts.as_ref() {
            let is_ghost = wanted.ghosts.as_ref().map(|g| g.is_ghost.as_slice());
            self.grid = self.grid.remade(&self.gpu, grid, is_ghost)?;
        }
        if self.shown.as_ref() != Some(&wanted) {
            let Shown {
                field,
                drawn,
                interpolation,
                ..
            } = &wanted;
            self.grid
                .show(&self.gpu, grid, field, drawn, *interpolation)?;
            self.shown = Some(wanted);
        }
        Ok(())
    }
}

/// What finds the surfaces of a view, compiled when it is first asked for; `None` where it shows none.
fn surfaces_of<'a>(
    gpu: &Gpu,
    compiled: &'a mut Option<SurfacePainter>,
    view: &View,
) -> Result<Option<&'a mut SurfacePainter>, GpuError> {
    if !view.surfaces.are_shown() {
        return Ok(None);
    }
    let painter = match compiled.take() {
        Some(known) => known,
        None => SurfacePainter::new(gpu)?,
    };
    Ok(Some(compiled.insert(painter)))
}

/// What draws solid cells, compiled when it is first asked for.
fn solid<'a>(
    gpu: &Gpu,
    compiled: &'a mut Option<Solid>,
) -> Result<&'a mut dyn RenderStrategy, GpuError> {
    let solid = match compiled.take() {
        Some(known) => known,
        None => Solid::new(gpu)?,
    };
    Ok(compiled.insert(solid))
}

/// The strategy of a kind, compiled when it is first asked for.
fn strategy<'a>(
    gpu: &Gpu,
    compiled: &'a mut Vec<(StrategyKind, Box<dyn RenderStrategy>)>,
    kind: StrategyKind,
) -> Result<&'a mut dyn RenderStrategy, GpuError> {
    let at = match compiled.iter().position(|(k, _)| *k == kind) {
        Some(at) => at,
        None => {
            compiled.push((kind, strategies::create(kind, gpu)?));
            compiled.len() - 1
        }
    };
    Ok(compiled[at].1.as_mut())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Case, load};
    use crate::scene::{CameraSpec, ExplicitCamera, Projection, Scene};
    use crate::view;

    /// One cell of 100 x 100 x 100.
    fn one_cell() -> Case {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cell.grdecl");
        let mut text = String::from("SPECGRID\n 1 1 1 1 F /\nCOORD\n");
        for [x, y] in [[0, 0], [100, 0], [0, 100], [100, 100]] {
            text += &format!("{x} {y} 1000 {x} {y} 1100\n");
        }
        text += "/\nZCORN\n 4*1000 4*1100 /\nPORO\n 0.2 /\n";
        std::fs::write(&path, text).unwrap();
        load::open(&path).unwrap()
    }

    #[test]
    fn samples_that_the_acceleration_grid_lacks_are_counted_as_lost() {
        let gpu = match Gpu::new(None) {
            Ok(gpu) => Arc::new(gpu),
            Err(error) => {
                assert!(std::env::var("REQUIRE_GPU").is_err(), "{error}");
                eprintln!("SKIPPED: {error}");
                return;
            }
        };
        let case = one_cell();
        // Parallel and along x: all rays come in where nothing will be found, and leave where all is.
        let scene = Scene {
            size: [60, 60],
            strategy: StrategyKind::Plts.name().into(),
            camera: CameraSpec::Explicit(ExplicitCamera {
                eye: [-300.0, 50.0, -1050.0],
                target: [50.0, 50.0, -1050.0],
                up: [0.0, 0.0, 1.0],
                fovy_degrees: 20.0,
                projection: Projection::Parallel,
            }),
            vertical_exaggeration: Some(1.0),
            early_termination: 0.0,
            ..Scene::default()
        };
        let view = view::resolve(&scene, &case).unwrap();
        let view = View {
            sampling_step: 3.0,
            ..view
        };
        let mut renderer = Renderer::new(gpu, &case.grid).unwrap();
        let stats = |renderer: &mut Renderer| {
            let frame = renderer.render(&case.grid, &view, &|_| true).unwrap();
            frame.unwrap().stats
        };
        let whole = stats(&mut renderer);
        assert!(
            whole.samples > 10_000 && whole.lost_samples == 0,
            "{whole:?}"
        );
        let gpu = renderer.gpu.clone();
        renderer.grid.lose_half(&gpu, &case.grid).unwrap();
        let halved = stats(&mut renderer);
        let missing = whole.samples - halved.samples;
        let lost = halved.lost_samples;
        assert!(4 * missing > whole.samples, "{whole:?} {halved:?}");
        assert!(
            lost <= missing && 10 * lost > 9 * missing,
            "{lost} of {missing}"
        );
        assert_eq!(whole.entries, whole.covered_pixels);
    }
}
