//! What the thread that makes pictures keeps: the device, and for each side a grid on it.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Weak};
use std::time::{Duration, Instant};

use glam::DVec2;

use super::job::{Answer, ImageDifference, ImageJob, Picture, RenderRequest};
use crate::case::Case;
use crate::image::Rgb8;
use crate::image::metrics::{Comparison, ciede2000_map};
use crate::model::Grid;
use crate::picking::{self, Pick, PickError};
use crate::picture;
use crate::render::{self, Executor, RenderError, Renderer};
use crate::scene::{CameraSpec, Scene};
use crate::view::{self, View};

/// CIEDE2000 that has the last color of a difference map.
pub const DIFFERENCE_SCALE: f64 = 20.0;

/// What a map of color differences says above it.
pub fn difference_title(figures: &Comparison) -> String {
    format!(
        "Color difference (CIEDE2000): mean {:.2}, 99 % below {:.2}; brightest at {DIFFERENCE_SCALE} or more",
        figures.ciede2000_mean, figures.ciede2000_p99
    )
}

type Say<'a> = &'a dyn Fn(Answer);

/// The device and two sides of it.
#[derive(Default)]
pub struct RenderSession {
    executor: Option<Arc<dyn Executor>>,
    sides: [SideState; 2],
}

/// A grid on the device, and the scenes that were resolved last: of a draft and of a final picture.
#[derive(Default)]
struct SideState {
    /// Cases that share a grid share what is on the device.
    renderer: Option<Box<dyn Renderer>>,
    resolved: VecDeque<(RenderRequest, Arc<View>)>,
}

impl RenderSession {
    /// The device, opened when it is first asked for.
    ///
    /// # Errors
    /// When there is none; the sentence says what to do.
    pub fn open(&mut self, say: Say<'_>) -> Result<Arc<dyn Executor>, String> {
        if let Some(executor) = &self.executor {
            return Ok(executor.clone());
        }
        let executor = render::executor(None).map_err(|e| e.to_string())?;
        let info = executor.info();
        say(Answer::Adapter {
            name: info.adapter,
            is_software: info.is_software,
        });
        self.executor = Some(executor.clone());
        Ok(executor)
    }

    /// Does a job.
    pub fn answer(&mut self, job: ImageJob, cancel: &AtomicBool, say: Say<'_>) -> Answer {
        let is_picture = matches!(job, ImageJob::Picture { .. });
        let answer = match job {
            ImageJob::Picture {
                side,
                wanted,
                is_draft,
            } => {
                let mut made = self.make(side, &wanted, is_draft, cancel, say);
                if made.as_ref().is_err_and(|e| e.is_device) {
                    // A lost device does not come back by itself: once more with a new one.
                    *self = Self::default();
                    made = self.make(side, &wanted, is_draft, cancel, say);
                }
                made.map(|made| match made {
                    Some(picture) => Answer::Picture(side, Box::new(picture)),
                    None => Answer::Canceled,
                })
            }
            ImageJob::Pick {
                side,
                wanted,
                at,
                why,
            } => {
                let pick = self.pick(side, &wanted, at, say);
                pick.map(|pick| Answer::Picked(why, Box::new(pick)))
            }
            ImageJob::Difference(of) => difference(of).map(|d| Answer::Difference(Box::new(d))),
            ImageJob::Forget(case, grid) => self.forget(&case, &grid).map(|()| Answer::Forgotten),
        };
        answer.unwrap_or_else(|error| {
            if error.is_device {
                *self = Self::default();
            }
            match is_picture {
                true => Answer::Failed(error.sentence),
                false => Answer::Refused(error.sentence),
            }
        })
    }

    fn make(
        &mut self,
        side: usize,
        wanted: &RenderRequest,
        is_draft: bool,
        cancel: &AtomicBool,
        say: Say<'_>,
    ) -> Result<Option<Picture>, Failure> {
        let start = Instant::now();
        let executor = self.open(say).map_err(Failure::of_device)?;
        let case = wanted.seen();
        self.share(side, &case);
        let side = &mut self.sides[side];
        let view = side.view(wanted)?;
        let renderer = side.renderer(&*executor, &case)?;
        let last_said = std::cell::Cell::new(Instant::now());
        let progress = |part: f64| {
            if last_said.get().elapsed() > Duration::from_millis(200) {
                last_said.set(Instant::now());
                say(Answer::Progress(part as f32));
            }
            !cancel.load(Ordering::Relaxed)
        };
        let frame = match renderer.render(&view, &progress) {
            Err(RenderError::Canceled) => return Ok(None),
            frame => frame.map_err(|e| Failure::of_device(e.to_string()))?,
        };
        let cover = |p: &[f32; 4]| (255.0 * p[3].clamp(0.0, 1.0)).round() as u8;
        Ok(Some(Picture {
            cover: frame.image.pixels.iter().map(cover).collect(),
            rgb: Arc::new(Rgb8 {
                size: frame.image.size,
                pixels: frame.image.over_background_8bit(view.style.background),
            }),
            view,
            wanted: wanted.clone(),
            is_draft,
            stats: frame.stats,
            prepare: frame.prepare,
            light: frame.light,
            bytes: frame.bytes,
            took: start.elapsed(),
        }))
    }

    /// Frees the second side's grid where the first one shows another case alone.
    fn share(&mut self, side: usize, case: &Arc<Case>) {
        let holds_other = |s: &SideState| {
            let kept = s.renderer.as_ref();
            kept.is_some_and(|kept| !Arc::ptr_eq(kept.grid(), &case.grid))
        };
        if side == 0 && holds_other(&self.sides[0]) {
            self.sides[1] = SideState::default();
        }
    }

    /// Frees what is kept of a case.
    fn forget(&mut self, case: &Weak<Case>, grid: &Weak<Grid>) -> Result<(), Failure> {
        let is_of = |known: &Arc<Case>| std::ptr::eq(Arc::as_ptr(known), case.as_ptr());
        // Also one in index space that was made of it.
        let has = |known: &Arc<Grid>| std::ptr::eq(known.in_map_space(), grid.as_ptr());
        for side in &mut self.sides {
            side.renderer.take_if(|kept| has(kept.grid()));
            side.resolved.retain(|(wanted, _)| !is_of(&wanted.case));
        }
        // The device frees what it is done with when it is asked.
        match &self.executor {
            Some(executor) => executor
                .tidy()
                .map_err(|e| Failure::of_device(e.to_string())),
            None => Ok(()),
        }
    }

    fn pick(
        &mut self,
        side: usize,
        wanted: &RenderRequest,
        at: DVec2,
        say: Say<'_>,
    ) -> Result<Pick, Failure> {
        let executor = self.open(say).map_err(Failure::of_device)?;
        let side = &mut self.sides[side];
        let case = wanted.seen();
        let view = side.view(wanted)?;
        let renderer = side.renderer(&*executor, &case)?;
        picking::pick(renderer, &case, &view, at).map_err(|error| Failure {
            is_device: matches!(error, PickError::Render(_)),
            sentence: error.to_string(),
        })
    }
}

impl SideState {
    /// The renderer of a case: the one at hand, or a new one.
    fn renderer(
        &mut self,
        executor: &dyn Executor,
        case: &Case,
    ) -> Result<&mut dyn Renderer, Failure> {
        let kept = self.renderer.take();
        let kept = match kept.filter(|kept| Arc::ptr_eq(kept.grid(), &case.grid)) {
            Some(kept) => kept,
            None => executor
                .renderer(&case.grid)
                .map_err(|e| Failure::of_device(e.to_string()))?,
        };
        Ok(&mut **self.renderer.insert(kept))
    }

    /// The scene resolved; where only camera and size differ from a known one, without reading
    /// values.
    fn view(&mut self, wanted: &RenderRequest) -> Result<Arc<View>, Failure> {
        let of_scene = |e: view::SceneError| Failure {
            sentence: e.to_string(),
            is_device: false,
        };
        let without_camera = RenderRequest {
            case: wanted.case.clone(),
            scene: Scene {
                camera: CameraSpec::default(),
                size: [1, 1],
                ..wanted.scene.clone()
            },
        };
        let known = self
            .resolved
            .iter()
            .position(|(known, _)| *known == without_camera);
        let view = match known.and_then(|n| self.resolved.remove(n)) {
            Some((_, view)) => view.seen_from(&wanted.scene.camera, wanted.scene.size),
            None => view::resolve(&wanted.scene, &wanted.seen()),
        };
        let view = Arc::new(view.map_err(of_scene)?);
        self.resolved.push_front((without_camera, view.clone()));
        self.resolved.truncate(2);
        Ok(view)
    }
}

fn difference(of: [Arc<Rgb8>; 2]) -> Result<ImageDifference, Failure> {
    let figures = Comparison::of(&of[0], &of[1]).map_err(|e| Failure {
        sentence: e.to_string(),
        is_device: false,
    })?;
    let differences = ciede2000_map(&of[0].pixels, &of[1].pixels).unwrap_or_default();
    let map = picture::difference_colors(&differences, of[0].size, DIFFERENCE_SCALE);
    Ok(ImageDifference { of, map, figures })
}

/// Why there is no answer.
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

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use crate::render::gpu::GpuExecutor;
    use std::path::Path;

    #[test]
    fn a_lost_device_is_replaced() {
        let silent = |_| {};
        let Ok(executor) = GpuExecutor::new(None) else {
            assert!(std::env::var_os("REQUIRE_GPU").is_none());
            return;
        };
        let gpu = executor.gpu().clone();
        let mut session = RenderSession {
            executor: Some(Arc::new(executor)),
            ..RenderSession::default()
        };
        let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/scissor/SCISSOR.EGRID");
        let case = Arc::new(crate::case::load::open(&sample).unwrap());
        let mut picture = || {
            let wanted = RenderRequest {
                case: case.clone(),
                scene: Scene {
                    size: [40, 30],
                    ..Scene::default()
                },
            };
            let job = ImageJob::Picture {
                side: 0,
                wanted,
                is_draft: false,
            };
            session.answer(job, &AtomicBool::new(false), &silent)
        };
        assert!(matches!(picture(), Answer::Picture(0, _)));
        gpu.device.destroy();
        // Who holds on to the lost device is told so, in one line.
        let error = gpu.wait().unwrap_err().to_string();
        assert!(error.contains("lost") && !error.contains('\n'), "{error}");
        assert!(matches!(picture(), Answer::Picture(0, _)));
    }
}
