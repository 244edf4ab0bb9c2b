//! Pictures are made on a thread of their own, so that the window never waits for one.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use glam::{DVec2, DVec3};

use super::orbit;
use crate::case::{Case, Property};
use crate::gpu::illumination::LightTimes;
use crate::gpu::{FrameStats, Gpu, GpuBytes};
use crate::model::Ijk;
use crate::renderer::Renderer;
use crate::scene::{self, CameraSpec, Scene, View};

/// What the thread is asked for.
pub enum Job {
    /// A picture.
    Picture(PictureJob),
    /// The cell under a place in a picture.
    Pick(PickJob),
}

/// A place in a picture: which cell is there?
pub struct PickJob {
    /// What it is of.
    pub case: Arc<Case>,
    /// How it looks.
    pub scene: Scene,
    /// Where, 0 to 1 to the right and down.
    pub at: DVec2,
}

/// A cell that was picked, and where the ray met it.
#[derive(Debug, Clone, PartialEq)]
pub struct Picked {
    /// The cell.
    pub ijk: Ijk,
    /// East, north and depth in map coordinates.
    pub map: DVec3,
    /// Value of the property shown, there.
    pub value: f64,
    /// Its name.
    pub property: String,
    /// Name, unit and value of every property of the cell at the step shown.
    pub values: Vec<(String, String, f64)>,
}

/// A picture to be made.
pub struct PictureJob {
    /// What it is of.
    pub case: Arc<Case>,
    /// How it looks; `size` is the picture's.
    pub scene: Scene,
    /// Good enough while something moves; else final.
    pub is_draft: bool,
}

/// A picture that was made.
pub struct Picture {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Red, green, blue over the scene's background, in sRGB.
    pub rgb: Vec<[u8; 3]>,
    /// What it shows.
    pub view: Arc<View>,
    /// The scene that it was made of.
    pub scene: Scene,
    /// See [`PictureJob`].
    pub is_draft: bool,
    /// What the rays cost.
    pub stats: FrameStats,
    /// What was prepared, and of it light.
    pub prepare: Duration,
    /// See [`crate::renderer::Frame`].
    pub light: LightTimes,
    /// Bytes on the device.
    pub bytes: GpuBytes,
    /// From the job's arrival to the picture's end.
    pub took: Duration,
}

/// What the thread says.
pub enum Answer {
    /// The adapter that makes the pictures.
    Adapter {
        /// Name and kind.
        name: String,
        /// It computes on the CPU.
        is_software: bool,
    },
    /// Part of the picture or of its preparation that is done.
    Progress(f32),
    /// A picture.
    Picture(Box<Picture>),
    /// It was cancelled.
    Cancelled,
    /// What lies under the place, if anything.
    Picked(Option<Picked>),
    /// Why there is none, in one sentence.
    Failed(String),
}

/// The thread that makes pictures, one at a time.
pub struct Worker {
    jobs: Sender<Job>,
    answers: Receiver<Answer>,
    cancel: Arc<AtomicBool>,
}

impl Worker {
    /// Starts it; `wake` is called with each answer.
    pub fn start(wake: impl Fn() + Send + 'static) -> Self {
        let (jobs, inbox) = channel::<Job>();
        let (outbox, answers) = channel();
        let cancel = Arc::new(AtomicBool::new(false));
        let cancelled = cancel.clone();
        std::thread::spawn(move || {
            let say = |answer| {
                let _ = outbox.send(answer);
                wake();
            };
            let mut studio = Studio::default();
            if let Err(error) = studio.open(&say) {
                say(Answer::Failed(error));
            }
            for job in inbox {
                say(match &job {
                    Job::Picture(job) => studio.make(job, &cancelled, &say),
                    Job::Pick(job) => studio.pick(job, &say),
                });
            }
        });
        Self {
            jobs,
            answers,
            cancel,
        }
    }

    /// Asks for a picture. The one before must have been answered.
    pub fn ask(&self, job: Job) {
        self.cancel.store(false, Ordering::Relaxed);
        // The thread lives as long as this; were it gone, its silence would be seen by `poll`.
        let _ = self.jobs.send(job);
    }

    /// Asks to leave the picture that is being made.
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// What has been said since the last call.
    pub fn poll(&self) -> Vec<Answer> {
        self.answers.try_iter().collect()
    }
}

/// What the thread keeps from picture to picture.
#[derive(Default)]
struct Studio {
    gpu: Option<Arc<Gpu>>,
    renderer: Option<(Arc<Case>, Renderer)>,
    resolved: Option<(Arc<Case>, Scene, Arc<View>)>,
}

impl Studio {
    fn open(&mut self, say: &dyn Fn(Answer)) -> Result<Arc<Gpu>, String> {
        if let Some(gpu) = &self.gpu {
            return Ok(gpu.clone());
        }
        let gpu = Arc::new(Gpu::new(None).map_err(|e| e.to_string())?);
        say(Answer::Adapter {
            name: gpu.describe(),
            is_software: gpu.is_software(),
        });
        self.gpu = Some(gpu.clone());
        Ok(gpu)
    }

    fn make(&mut self, job: &PictureJob, cancel: &AtomicBool, say: &dyn Fn(Answer)) -> Answer {
        match self.try_make(job, cancel, say) {
            Ok(Some(picture)) => Answer::Picture(Box::new(picture)),
            Ok(None) => Answer::Cancelled,
            Err(error) => {
                // A lost device does not come back by itself: the next picture opens a new one.
                if error.is_device {
                    *self = Self::default();
                }
                Answer::Failed(error.sentence)
            }
        }
    }

    fn try_make(
        &mut self,
        job: &PictureJob,
        cancel: &AtomicBool,
        say: &dyn Fn(Answer),
    ) -> Result<Option<Picture>, Failure> {
        let start = Instant::now();
        let gpu = self.open(say).map_err(Failure::of_device)?;
        let view = self.view(&job.case, &job.scene)?;
        let (case, mut renderer) = self.renderer(gpu, &job.case)?;
        let last_said = std::cell::Cell::new(Instant::now());
        let progress = |part: f64| {
            if last_said.get().elapsed() > Duration::from_millis(200) {
                last_said.set(Instant::now());
                say(Answer::Progress(part as f32));
            }
            !cancel.load(Ordering::Relaxed)
        };
        let frame = renderer.render(&case.grid, &view, &progress);
        let frame = frame.map_err(|e| Failure::of_device(e.to_string()))?;
        self.renderer = Some((case, renderer));
        Ok(frame.map(|frame| Picture {
            size: frame.image.size,
            rgb: frame.image.over_background_8bit(view.background),
            view,
            scene: job.scene.clone(),
            is_draft: job.is_draft,
            stats: frame.stats,
            prepare: frame.prepare,
            light: frame.light,
            bytes: frame.bytes,
            took: start.elapsed(),
        }))
    }

    /// The renderer of a case: the one at hand, or a new one.
    fn renderer(
        &mut self,
        gpu: Arc<Gpu>,
        case: &Arc<Case>,
    ) -> Result<(Arc<Case>, Renderer), Failure> {
        let same = |(kept, _): &(Arc<Case>, _)| Arc::ptr_eq(kept, case);
        if let Some(kept) = self.renderer.take().filter(same) {
            return Ok(kept);
        }
        let made = Renderer::new(gpu, &case.grid);
        let made = made.map_err(|e| Failure::of_device(e.to_string()))?;
        Ok((case.clone(), made))
    }

    fn pick(&mut self, job: &PickJob, say: &dyn Fn(Answer)) -> Answer {
        match self.try_pick(job, say) {
            Ok(picked) => Answer::Picked(picked),
            Err(error) => Answer::Failed(error.sentence),
        }
    }

    /// The first cell along the ray whose part of the picture makes it, with what is before it, opaque
    /// enough to be seen.
    fn try_pick(&mut self, job: &PickJob, say: &dyn Fn(Answer)) -> Result<Option<Picked>, Failure> {
        let gpu = self.open(say).map_err(Failure::of_device)?;
        let view = self.view(&job.case, &job.scene)?;
        let (case, mut renderer) = self.renderer(gpu, &job.case)?;
        let direction = orbit::direction(&view.camera, job.at, view.aspect());
        let found = renderer.first_seen(&case.grid, &view, direction, SEEN);
        self.renderer = Some((case.clone(), renderer));
        let found = found.map_err(|e| Failure::of_device(e.to_string()))?;
        Ok(found.map(|(world, located)| {
            let map = DVec3::new(world.x, world.y, -world.z / view.vertical_exaggeration);
            Picked {
                ijk: located.ijk,
                map,
                value: located.value,
                property: view.property.clone(),
                values: values_of(&case, located.ijk, view.step),
            }
        }))
    }

    /// The scene resolved; where only camera and size differ from the last one, without reading values.
    fn view(&mut self, case: &Arc<Case>, wanted: &Scene) -> Result<Arc<View>, Failure> {
        let of_scene = |e: scene::SceneError| Failure {
            sentence: e.to_string(),
            is_device: false,
        };
        let without_camera = |scene: &Scene| Scene {
            camera: CameraSpec::default(),
            size: [1, 1],
            ..scene.clone()
        };
        let scene = without_camera(wanted);
        let known = self.resolved.take();
        let known = known.filter(|(c, s, _)| Arc::ptr_eq(c, case) && *s == scene);
        let view = match known {
            Some((_, _, view)) => view.seen_from(&wanted.camera, wanted.size),
            None => scene::resolve(wanted, case),
        };
        let view = Arc::new(view.map_err(of_scene)?);
        self.resolved = Some((case.clone(), scene, view.clone()));
        Ok(view)
    }
}

/// Opacity that a ray must have gathered to have met something.
const SEEN: f64 = 0.1;

/// All properties of a cell at a step.
fn values_of(case: &Case, ijk: Ijk, step: usize) -> Vec<(String, String, f64)> {
    let cell = case.grid.dims().cell(ijk);
    let value = |name: &str| {
        let field = case.field(name, step).ok()?;
        field.value(&case.grid, cell).map(f64::from)
    };
    let properties = case.properties.iter();
    let row = |p: &Property| Some((p.name.clone(), p.unit.clone(), value(&p.name)?));
    properties.filter_map(row).collect()
}

/// Why a picture was not made.
struct Failure {
    sentence: String,
    is_device: bool,
}

impl Failure {
    fn of_device(sentence: String) -> Self {
        Self {
            sentence,
            is_device: true,
        }
    }
}
