//! Which picture is asked for when, and which ones are shown.

use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::{ColorImage, Context, TextureHandle, TextureOptions};
use glam::DVec2;

use super::worker::{Answer, Difference, Job, Picture, Wanted, Why, Worker};
use crate::case::Case;
use crate::picking::Pick;
use crate::picture::Rgb8;
use crate::scene::Scene;
use crate::strategies::StrategyKind;

/// Milliseconds that a draft may take: 30 pictures a second.
const DRAFT_MS: f64 = 30.0;
/// The same where time plays: a step stands for longer.
const PLAY_MS: f64 = 250.0;
/// A final picture is made where nothing has changed for so long.
const REST: Duration = Duration::from_millis(150);
/// Milliseconds that the light of a draft may take.
const LIGHT_MS: f64 = 12.0;
/// Parts of its voxels along each axis that a draft's light volume may have.
const LIGHT_PARTS: [u32; 3] = [1, 2, 4];
/// A draft by LIBC that takes longer, however few its pixels are, is bound by the faces it draws.
const TOO_SLOW_MS: f64 = 150.0;
/// Active cells from where that is taken for granted on a software adapter.
const MANY_CELLS: usize = 200_000;
/// Milliseconds that a pixel may take before one has been timed.
const UNKNOWN_MS: f64 = 1e-3;
/// Side of a draft, as a part of full resolution, at least.
const COARSEST: f64 = 0.12;

/// The pictures of both sides.
pub struct Pictures {
    worker: Worker,
    flight: Option<Flight>,
    sides: [Side; 2],
    difference: Option<ShownDifference>,
    /// When what is wanted changed last, and what it was.
    changed: Instant,
    wanted: Vec<Wanted>,
    /// Part of the picture on its way that is done.
    pub progress: Option<f32>,
    /// The adapter's name, and whether it computes on the CPU.
    pub adapter: Option<(String, bool)>,
}

/// What is shown of a side, and what it took.
#[derive(Default)]
struct Side {
    /// Of what the draft, and the final picture, are shown.
    drafted: Option<Wanted>,
    finished: Option<Wanted>,
    shown: Option<Shown>,
    /// What cannot be shown.
    refused: Option<Wanted>,
    /// Milliseconds that a pixel of a draft takes, once one was made.
    draft_ms: Option<f64>,
    /// The case whose drafts take too long by LIBC.
    slow: Option<Arc<Case>>,
    /// Voxels of the light volume along each axis, and the milliseconds that each voxel takes.
    light: Option<([u32; 3], f64)>,
}

/// A picture and the texture that has it.
pub struct Shown {
    /// The picture.
    pub picture: Picture,
    /// Its texture.
    pub texture: TextureHandle,
}

/// How far the pictures are apart, and the texture of the map.
pub struct ShownDifference {
    /// Map and figures.
    pub difference: Difference,
    /// Its texture.
    pub texture: TextureHandle,
}

/// The picture on its way.
struct Flight {
    side: usize,
    /// In full size.
    wanted: Wanted,
    is_draft: bool,
    /// It takes longer than a draft may.
    is_slow: bool,
    is_cancelled: bool,
}

/// What happened that concerns more than the pictures.
pub enum Event {
    /// What is seen at a place that was asked for.
    Picked(Why, Box<Pick>),
    /// A picture came.
    Came,
    /// Why one did not.
    Failed(String),
}

impl Pictures {
    /// None yet; `ctx` is waken when one comes.
    pub fn new(ctx: &Context) -> Self {
        let waker = ctx.clone();
        Self {
            worker: Worker::start(move || waker.request_repaint()),
            flight: None,
            sides: [Side::default(), Side::default()],
            difference: None,
            changed: Instant::now(),
            wanted: Vec::new(),
            progress: None,
            adapter: None,
        }
    }

    /// The picture of a side, if it is of this case.
    pub fn shown(&self, side: usize, case: &Arc<Case>) -> Option<&Shown> {
        let shown = self.sides[side].shown.as_ref();
        shown.filter(|s| Arc::ptr_eq(&s.picture.wanted.case, case))
    }

    /// How far the pictures shown are apart.
    pub fn difference(&self) -> Option<&ShownDifference> {
        let shown = [0, 1].map(|n| self.sides[n].shown.as_ref().map(|s| &s.picture.rgb));
        let is_of = |d: &&ShownDifference| {
            let pairs = d.difference.of.iter().zip(&shown);
            let mut pairs = pairs.map(|(a, b)| b.is_some_and(|b| Arc::ptr_eq(a, b)));
            pairs.all(|same| same)
        };
        self.difference.as_ref().filter(is_of)
    }

    /// True where all that is wanted is shown, in full.
    pub fn are_final(&self) -> bool {
        let sides = self.wanted.iter().zip(&self.sides);
        let mut finished = sides.map(|(w, side)| side.finished.as_ref() == Some(w));
        !self.wanted.is_empty() && finished.all(|f| f)
    }

    /// True while a picture is on its way; a final one where `Some(true)`.
    pub fn on_its_way(&self) -> Option<bool> {
        self.flight.as_ref().map(|f| !f.is_draft)
    }

    /// Asks what is seen at a place. For a click a final picture on its way is left, to be begun again after
    /// it; a pointer that rests waits for the picture.
    pub fn pick(&mut self, side: usize, wanted: Wanted, at: DVec2, why: Why) {
        let is_slow = |f: &&mut Flight| f.is_slow && why != Why::Hover;
        if let Some(flight) = self.flight.as_mut().filter(is_slow) {
            flight.is_cancelled = true;
            self.worker.cancel();
        }
        self.worker.pick(side, wanted, at, why);
    }

    /// Asks how far the pictures shown are apart, unless that is known.
    pub fn compare(&mut self) {
        let pictures = self
            .sides
            .each_ref()
            .map(|s| Some(s.shown.as_ref()?.picture.rgb.clone()));
        if let [Some(a), Some(b)] = pictures
            && self.flight.is_none()
            && self.difference().is_none()
            && a.size == b.size
        {
            self.worker.ask(Job::Difference([a, b]));
        }
    }

    /// Takes in what the worker said.
    pub fn listen(&mut self, ctx: &Context) -> Vec<Event> {
        let mut events = Vec::new();
        for answer in self.worker.poll() {
            events.extend(self.take(ctx, answer));
        }
        events
    }

    fn take(&mut self, ctx: &Context, answer: Answer) -> Option<Event> {
        match answer {
            Answer::Adapter { name, is_software } => self.adapter = Some((name, is_software)),
            Answer::Progress(part) => self.progress = Some(part),
            Answer::Cancelled => {
                self.land();
            }
            Answer::Failed(error) => {
                // Not asked for again before the scene changes.
                if let Some(flight) = self.land() {
                    self.sides[flight.side].refused = Some(flight.wanted);
                }
                return Some(Event::Failed(error));
            }
            // The picture on its way, if there is one, still comes.
            Answer::Refused(error) => return Some(Event::Failed(error)),
            Answer::Picked(why, pick) => return Some(Event::Picked(why, pick)),
            Answer::Picture(side, picture) => {
                if let Some(flight) = self.land() {
                    let is_software = self.adapter.as_ref().is_none_or(|a| a.1);
                    self.sides[side].time_light(&picture, is_software);
                    self.sides[side].arrive(ctx, *picture, flight);
                }
                return Some(Event::Came);
            }
            Answer::Difference(difference) => {
                let texture = texture(ctx, &difference.map);
                self.difference = Some(ShownDifference {
                    difference: *difference,
                    texture,
                });
            }
        }
        None
    }

    fn land(&mut self) -> Option<Flight> {
        self.progress = None;
        self.flight.take()
    }

    /// Asks for the next picture of what is wanted by each side, where one is due. While the user is busy
    /// only drafts are made; while time plays they may take longer.
    pub fn schedule(&mut self, ctx: &Context, wanted: Vec<Wanted>, is_busy: bool, plays: bool) {
        if self.wanted != wanted {
            self.changed = Instant::now();
            self.wanted = wanted;
        }
        if let Some(flight) = &mut self.flight {
            let is_wanted = self.wanted.get(flight.side) == Some(&flight.wanted);
            // Time that plays does not wait for final pictures.
            if flight.is_slow && !flight.is_cancelled && (!is_wanted || plays) {
                flight.is_cancelled = true;
                self.worker.cancel();
            }
            return;
        }
        let draft_ms = if plays { PLAY_MS } else { DRAFT_MS } / self.wanted.len().max(1) as f64;
        let dues: Vec<Due> = self
            .wanted
            .iter()
            .zip(&self.sides)
            .map(|(w, s)| s.due(w, draft_ms))
            .collect();
        let next = match dues.iter().position(|d| matches!(d, Due::Quick(_))) {
            Some(side) => Some(side),
            None => dues.iter().position(|d| matches!(d, Due::Slow)),
        };
        let Some(side) = next else { return };
        let part = match dues[side] {
            Due::Quick(part) => part,
            _ if is_busy || plays || self.changed.elapsed() < REST => {
                ctx.request_repaint_after(REST);
                return;
            }
            _ => None,
        };
        let is_slow = matches!(dues[side], Due::Slow);
        self.send(side, part, is_slow);
    }

    /// Asks for a side's picture, at a part of its size where it is a draft.
    fn send(&mut self, side: usize, part: Option<f64>, is_slow: bool) {
        let wanted = self.wanted[side].clone();
        let mut job = wanted.clone();
        if let Some(part) = part {
            job.scene.size = job
                .scene
                .size
                .map(|n| ((f64::from(n) * part).round() as u32).max(16));
            let is_software = self.adapter.as_ref().is_none_or(|a| a.1);
            self.sides[side].draft_by_points(&mut job, is_software);
            self.sides[side].thin_light(&mut job.scene);
        }
        self.worker.ask(Job::Picture {
            side,
            wanted: job,
            is_draft: part.is_some(),
        });
        self.flight = Some(Flight {
            side,
            wanted,
            is_draft: part.is_some(),
            is_slow,
            is_cancelled: false,
        });
    }
}

/// What a side needs next.
enum Due {
    Nothing,
    /// A picture that takes no longer than a draft: at a part of its size, or whole.
    Quick(Option<f64>),
    /// The final picture.
    Slow,
}

impl Side {
    fn due(&self, wanted: &Wanted, draft_ms: f64) -> Due {
        let [width, height] = wanted.scene.size.map(f64::from);
        let full_ms = self.draft_ms.unwrap_or(UNKNOWN_MS) * width * height;
        let is = |known: &Option<Wanted>| known.as_ref() == Some(wanted);
        if is(&self.finished) || is(&self.refused) {
            Due::Nothing
        } else if full_ms <= draft_ms && self.draft_ms.is_some() {
            Due::Quick(None)
        } else if !is(&self.drafted) {
            Due::Quick(Some((draft_ms / full_ms).sqrt().clamp(COARSEST, 1.0)))
        } else {
            Due::Slow
        }
    }

    /// Takes PLTS for a draft where LIBC would draw so many faces that no draft is quick: the picture is the
    /// same but for what samples leave out.
    fn draft_by_points(&self, job: &mut Wanted, is_software: bool) {
        let is_known = self
            .slow
            .as_ref()
            .is_some_and(|c| Arc::ptr_eq(c, &job.case));
        let is_large = is_software && job.case.grid.active_cells().len() > MANY_CELLS;
        if job.scene.strategy == StrategyKind::Libc.name() && (is_known || is_large) {
            job.scene.strategy = StrategyKind::Plts.name().into();
        }
    }

    /// Gives a draft a coarser light volume, where the whole one takes too long for each picture.
    fn thin_light(&self, scene: &mut Scene) {
        let Some((size, ms)) = self.light else { return };
        let voxels = f64::from(size.iter().product::<u32>());
        let fits = |part: &&u32| ms * voxels <= LIGHT_MS * f64::from(part.pow(3));
        let part = LIGHT_PARTS.iter().find(fits).or(LIGHT_PARTS.last());
        let part = part.copied().unwrap_or(1);
        if part > 1 && scene.lighting.volume.light_size.is_none() {
            scene.lighting.volume.light_size = Some(size.map(|n| n.div_ceil(part).max(2)));
        }
    }

    /// What the light of a picture took, where one was made.
    fn time_light(&mut self, picture: &Picture, is_software: bool) {
        let lighting = &picture.view.lighting;
        let size = lighting.light_size(is_software);
        let ms = 1e3 * picture.light.volumes.as_secs_f64();
        let is_whole = picture.wanted.scene.lighting.volume.light_size.is_none();
        let whole = if is_whole {
            Some(size)
        } else {
            self.light.map(|l| l.0)
        };
        if lighting.is_off() {
            self.light = None;
        } else if let (Some(whole), true) = (whole, ms > 0.0) {
            self.light = Some((whole, ms / f64::from(size.iter().product::<u32>())));
        }
    }

    fn arrive(&mut self, ctx: &Context, picture: Picture, flight: Flight) {
        let pixels = picture.rgb.size.map(f64::from);
        let ms = 1e3 * (picture.took - picture.prepare.min(picture.took)).as_secs_f64();
        let is_libc = picture.view.strategy == StrategyKind::Libc;
        // The first draft compiles too, and says nothing.
        if flight.is_draft && is_libc && ms > TOO_SLOW_MS && self.draft_ms.is_some() {
            self.slow = Some(picture.wanted.case.clone());
        }
        let ms = ms / (pixels[0] * pixels[1]);
        if flight.is_draft {
            self.draft_ms = Some(self.draft_ms.map_or(ms, |known| 0.5 * (known + ms)));
            // What is shown is no longer what was finished before.
            self.finished = None;
        } else {
            self.finished = Some(flight.wanted.clone());
        }
        self.drafted = Some(flight.wanted);
        self.shown = Some(Shown {
            texture: texture(ctx, &picture.rgb),
            picture,
        });
    }
}

fn texture(ctx: &Context, rgb: &Rgb8) -> TextureHandle {
    let size = rgb.size.map(|n| n as usize);
    let image = ColorImage::from_rgb(size, rgb.pixels.as_flattened());
    ctx.load_texture("picture", image, TextureOptions::LINEAR)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn only_clicks_take_the_place_of_a_final_picture() {
        let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/scissor/SCISSOR.EGRID");
        let wanted = Wanted {
            case: Arc::new(crate::load::open(&sample).unwrap()),
            scene: Scene {
                size: [40, 30],
                ..Scene::default()
            },
        };
        let mut pictures = Pictures::new(&Context::default());
        for (why, is_left) in [(Why::Hover, false), (Why::Select, true)] {
            pictures.flight = Some(Flight {
                side: 0,
                wanted: wanted.clone(),
                is_draft: false,
                is_slow: true,
                is_cancelled: false,
            });
            pictures.pick(0, wanted.clone(), DVec2::splat(0.5), why);
            assert_eq!(pictures.flight.as_ref().unwrap().is_cancelled, is_left);
        }
    }
}
