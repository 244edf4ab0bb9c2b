//! A device with one grid on it.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;

use crate::model::Grid;
use crate::render::gpu::cube::GpuCube;
use crate::render::gpu::faces::BoundaryFaces;
use crate::render::gpu::illumination::Illumination;
use crate::render::gpu::probe::Probe;
use crate::render::gpu::strategies::solid::Solid;
use crate::render::gpu::strategy::{Preparation, RenderStrategy};
use crate::render::gpu::surfaces::SurfacePainter;
use crate::render::gpu::transfer_tables::TransferTables;
use crate::render::gpu::{Drawing, FrameRenderer, Gpu, GpuGrid, strategies};
use crate::render::job::{Progress, Work};
use crate::render::line_of_sight::SurfaceTree;
use crate::render::revisions::RevisionCounter;
use crate::render::{DeviceBytes, Frame, Located, RenderError, Renderer, SetupTimes};
use crate::scene::StrategyKind;
use crate::view::View;

/// Makes images of one grid.
pub struct GpuRenderer {
    gpu: Arc<Gpu>,
    model: Arc<Grid>,
    times: SetupTimes,
    grid: GpuGrid,
    frames: FrameRenderer,
    tables: Option<TransferTables>,
    cube: GpuCube,
    light: Illumination,
    faces: BoundaryFaces,
    /// Made when surfaces are first shown.
    surfaces: Option<SurfacePainter>,
    strategies: Vec<(StrategyKind, Box<dyn RenderStrategy>)>,
    /// For cells that are shown as solid.
    solid: Solid,
    /// Made when points are first located.
    probe: Option<Probe>,
    /// Faces of surfaces that were looked at.
    surface_tree: SurfaceTree,
    revisions: RevisionCounter,
}

impl GpuRenderer {
    /// Uploads a grid.
    ///
    /// # Errors
    /// When the adapter cannot hold it.
    pub fn new(gpu: Arc<Gpu>, grid: &Arc<Grid>) -> Result<Self, RenderError> {
        let start = Instant::now();
        let on_device = GpuGrid::new(&gpu, grid)?;
        let acceleration = on_device.acceleration_time;
        let light = Illumination::new(&gpu)?;
        Ok(Self {
            model: grid.clone(),
            times: SetupTimes {
                upload: start.elapsed().saturating_sub(acceleration),
                acceleration,
            },
            grid: on_device,
            light,
            tables: None,
            cube: GpuCube::none(&gpu)?,
            faces: BoundaryFaces::default(),
            surfaces: None,
            gpu,
            frames: FrameRenderer::default(),
            strategies: Vec::new(),
            solid: Solid::default(),
            probe: None,
            surface_tree: SurfaceTree::default(),
            revisions: RevisionCounter::default(),
        })
    }

    /// The device.
    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }

    /// The light, as the last image had it.
    pub fn light(&self) -> &Illumination {
        &self.light
    }

    async fn frame(&mut self, view: &View, progress: Progress) -> Result<Frame, RenderError> {
        let start = Instant::now();
        self.gpu.check()?;
        self.prepare(view)?;
        let Self {
            gpu,
            model,
            grid: on_device,
            frames,
            tables,
            cube,
            light,
            faces,
            surfaces,
            ..
        } = self;
        let (of_case, (grid, drawn)) = (&**model, view.shown.cells.in_grid(model));
        let revisions = on_device.revisions;
        cube.update(gpu, &on_device.facts, view, revisions)?;
        let tables = match tables.take().filter(|t| t.revision == revisions.transfer) {
            Some(known) => tables.insert(known),
            None => tables.insert(TransferTables::new(gpu, view, cube, revisions.transfer)?),
        };
        tables.cube = cube.views();
        // What is made for light is of all drawn cells.
        on_device.meet_all(gpu, true);
        let grids = (of_case, &*on_device);
        light.update(gpu, grids, view, tables, &progress).await?;
        let strategy = match view.casts_rays() {
            true => strategy(gpu, &mut self.strategies, view.sampling.strategy),
            false => &mut self.solid,
        };
        let shows_surfaces = view.style.surfaces.are_shown();
        let mut surfaces =
            shows_surfaces.then(|| surfaces.get_or_insert_with(|| SurfacePainter::new(gpu)));
        if let Some(surfaces) = &mut surfaces {
            let shared = SurfacePainter::shares_faces(view);
            let boundary = shared.then(|| faces.of_drawn(gpu, grid, on_device, drawn));
            let boundary = boundary.transpose()?;
            surfaces.update(gpu, of_case, on_device, view, boundary, light.work())?;
        }
        let met = match strategy.needs_faces() {
            true => faces.of_met(gpu, grid, on_device, drawn, view)?,
            false => None,
        };
        let preparation = Preparation {
            gpu,
            model: grid,
            grid: on_device,
            view,
            faces: met,
            progress: &progress,
        };
        strategy.prepare(&preparation).await?;
        gpu.wait()?;
        let prepare = start.elapsed();
        let lists = surfaces.as_ref().map_or(0, |s| s.bytes(view));
        let drawing = Drawing {
            light: light.bind(gpu, tables),
            surfaces,
            strategy,
        };
        let made = frames.render(gpu, on_device, drawing, view, &progress);
        let (image, stats) = made.await?;
        Ok(Frame {
            image,
            stats,
            prepare,
            light: light.times,
            storage_error: on_device.storage_error(),
            bytes: on_device.bytes()
                + strategy.bytes()
                + DeviceBytes {
                    geometry: faces.bytes() + lists,
                    targets: stats.target_bytes,
                    lighting: light.bytes(),
                    cube: cube.bytes(),
                    ..DeviceBytes::default()
                },
        })
    }
}

impl Renderer for GpuRenderer {
    fn grid(&self) -> &Arc<Grid> {
        &self.model
    }

    fn setup_times(&self) -> SetupTimes {
        self.times
    }

    fn prepare(&mut self, view: &View) -> Result<(), RenderError> {
        let (gpu, model, cells) = (&self.gpu, &self.model, &view.shown.cells);
        let (held, wanted) = (self.grid.revisions, self.revisions.of(view));
        if held.grid != wanted.grid {
            self.grid = GpuGrid::of(gpu, model, view)?;
        }
        if held.values != wanted.values {
            self.grid.show(gpu, model, cells)?;
        }
        self.grid.revisions = wanted;
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
        let (grid, _) = view.shown.cells.in_grid(&self.model);
        let probe = match self.probe.take().filter(|p| p.fits(&self.grid)) {
            Some(known) => self.probe.insert(known),
            None => self.probe.insert(Probe::new(&self.gpu, &self.grid)?),
        };
        let to_grid = |p: &DVec3| view.world.spaces.grid_from_world.transform_point3(*p);
        let points: Vec<DVec3> = points.iter().map(to_grid).collect();
        probe.locate(
            &self.gpu,
            &self.grid,
            grid,
            &points,
            view.shown.cells.interpolation,
        )
    }

    fn surface_tree(&mut self) -> &mut SurfaceTree {
        &mut self.surface_tree
    }
}

/// The strategy of a kind, made when it is first asked for.
fn strategy<'a>(
    gpu: &Gpu,
    made: &'a mut Vec<(StrategyKind, Box<dyn RenderStrategy>)>,
    kind: StrategyKind,
) -> &'a mut dyn RenderStrategy {
    let known = made.iter().position(|(k, _)| *k == kind);
    let at = known.unwrap_or_else(|| {
        made.push((kind, strategies::create(kind, gpu)));
        made.len() - 1
    });
    made[at].1.as_mut()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Case, load};
    use crate::scene::{CameraSpec, ExplicitCamera, Projection, Scene, VolumeSpec};
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

    /// An adapter; `None` where there is none and none is required.
    fn gpu() -> Option<Arc<Gpu>> {
        match Gpu::new(None) {
            Ok(gpu) => Some(Arc::new(gpu)),
            Err(error) => {
                assert!(std::env::var("REQUIRE_GPU").is_err(), "{error}");
                eprintln!("SKIPPED: {error}");
                None
            }
        }
    }

    #[test]
    fn samples_that_the_acceleration_grid_lacks_are_counted_as_lost() {
        let Some(gpu) = gpu() else {
            return;
        };
        let case = one_cell();
        // Parallel and along x: all rays come in where nothing will be found, and leave where all is.
        let scene = Scene {
            size: [60, 60],
            strategy: StrategyKind::Plts,
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
        let mut view = view::resolve(&scene, &case).unwrap();
        view.sampling.step = 3.0;
        let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
        let stats = |renderer: &mut GpuRenderer| renderer.render(&view, &|_| true).unwrap().stats;
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

    /// Layers of values that dip around the sample, as a file.
    fn cube(folder: &std::path::Path) -> std::path::PathBuf {
        let mut text = String::from(
            "NRRD0004\ntype: float\ndimension: 3\nsizes: 12 12 12\nspace dimension: 3\n\
             space directions: (500,0,0) (0,450,0) (0,0,40)\nspace origin: (460000,5932500,-2450)\nencoding: ascii\n\n",
        );
        for n in 0..12 * 12 * 12 {
            text += &format!("{} ", ((n % 12) as f32 * 0.7 + (n / 144) as f32).sin());
        }
        let path = folder.join("cube.nrrd");
        std::fs::write(&path, text).unwrap();
        path
    }

    #[test]
    fn rays_that_pause_often_make_the_same_image_of_a_volume() {
        let Some(gpu) = gpu() else {
            return;
        };
        let folder = tempfile::tempdir().unwrap();
        let sample = concat!(env!("CARGO_MANIFEST_DIR"), "/samples/scissor/SCISSOR.EGRID");
        let case = load::open(std::path::Path::new(sample)).unwrap();
        let scene = Scene {
            size: [40, 30],
            volumes: vec![VolumeSpec::of(cube(folder.path()))],
            ..Scene::default()
        };
        let view = view::resolve(&scene, &case).unwrap();
        let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
        let mut render = |view: &View, most| {
            renderer.frames.most_work = most;
            renderer.render(view, &|_| true).unwrap()
        };
        let least = |a: &Frame, b: &Frame| {
            let pairs = a.image.pixels.iter().zip(&b.image.pixels);
            let apart = pairs.flat_map(|(a, b)| [0, 1, 2, 3].map(|n| (a[n] - b[n]).abs()));
            apart.fold(0.0, f32::max)
        };
        let mut bare = view.clone();
        bare.shown.cube = None;
        for strategy in StrategyKind::ALL {
            let whole = render(&view.by(strategy), None);
            let paused = render(&view.by(strategy), Some(60));
            let [one, many] = [&whole, &paused].map(|frame| frame.stats.submissions);
            let apart = least(&whole, &paused);
            println!("{}: {one} and {many} submissions, {apart}", strategy.name());
            assert!(many > one, "{}: {many}", strategy.name());
            assert!(apart < 2e-5, "{}: {apart}", strategy.name());
            assert_eq!(whole.stats.cube_samples, paused.stats.cube_samples);
            // The twin: without the volume the image is another one.
            assert!(least(&whole, &render(&bare.by(strategy), None)) > 0.05);
        }
    }
}
