//! Which picture is asked for when, and which ones are shown.

use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::{Context, TextureHandle};
use glam::DVec2;

use super::budget::{DraftSize, PLAY_MS, TURN_MS};
use super::drafts::{Due, ShownImage, ShownSide, texture};
use super::job::{Answer, ImageDifference, ImageJob, PickPurpose, RenderRequest};
use super::worker::Worker;
use crate::case::Case;
use crate::picking::Pick;

/// A final picture is made where nothing has changed for so long.
const REST: Duration = Duration::from_millis(150);

/// The pictures of both sides.
pub struct Pictures {
    worker: Worker,
    flight: Option<Flight>,
    sides: [ShownSide; 2],
    difference: Option<ShownDifference>,
    /// When what is wanted changed last, and what it was.
    changed: Instant,
    wanted: Vec<RenderRequest>,
    /// Drafts so far.
    pub drafts: DraftCount,
    /// Part of the picture on its way that is done.
    pub progress: Option<f32>,
    /// The adapter's name, and whether it computes on the CPU.
    pub adapter: Option<(String, bool)>,
}

/// How many drafts were asked for, and came.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct DraftCount {
    /// Asked for.
    pub asked: u64,
    /// Came.
    pub made: u64,
}

/// How far the pictures are apart, and the texture of the map.
pub struct ShownDifference {
    /// Map and figures.
    pub difference: ImageDifference,
    /// Its texture.
    pub texture: TextureHandle,
}

/// The picture on its way.
struct Flight {
    side: usize,
    /// In full size.
    wanted: RenderRequest,
    is_draft: bool,
    /// It takes longer than a draft may.
    is_slow: bool,
    is_canceled: bool,
    /// Its case was closed.
    is_forgotten: bool,
}

/// What happened that concerns more than the pictures.
pub enum Event {
    /// What is seen at a place that was asked for.
    Picked(PickPurpose, Box<Pick>),
    /// A picture came.
    Came,
    /// Why one did not.
    Failed(String),
}

impl Pictures {
    /// None yet; `wake` is called on the thread that makes them when one comes.
    pub fn new(wake: impl Fn() + Send + 'static) -> Self {
        Self {
            worker: Worker::start(wake),
            flight: None,
            sides: [ShownSide::default(), ShownSide::default()],
            difference: None,
            changed: Instant::now(),
            wanted: Vec::new(),
            drafts: DraftCount::default(),
            progress: None,
            adapter: None,
        }
    }

    /// The picture of a side, if it is of this case.
    pub fn shown(&self, side: usize, case: &Arc<Case>) -> Option<&ShownImage> {
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
        let mut finished = sides.map(|(w, side)| side.is_finished(w));
        !self.wanted.is_empty() && finished.all(|f| f)
    }

    /// True while a picture is on its way; a final one where `Some(true)`.
    pub fn on_its_way(&self) -> Option<bool> {
        self.flight.as_ref().map(|f| !f.is_draft)
    }

    /// Asks what is seen at a place. For a click a final picture on its way is left, to be begun again after
    /// it; a pointer that rests waits for the picture.
    pub fn pick(&mut self, side: usize, wanted: RenderRequest, at: DVec2, why: PickPurpose) {
        let is_slow = |f: &&mut Flight| f.is_slow && why != PickPurpose::Hover;
        if let Some(flight) = self.flight.as_mut().filter(is_slow) {
            flight.is_canceled = true;
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
            self.worker.ask(ImageJob::Difference([a, b]));
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
            Answer::Canceled => {
                self.land();
            }
            Answer::Failed(error) => {
                // Not asked for again before the scene changes.
                if let Some(flight) = self.land() {
                    self.sides[flight.side].refuse(flight.wanted);
                }
                return Some(Event::Failed(error));
            }
            // The picture on its way, if there is one, still comes.
            Answer::Refused(error) => return Some(Event::Failed(error)),
            Answer::Picked(why, pick) => return Some(Event::Picked(why, pick)),
            Answer::Picture(side, picture) => {
                if let Some(flight) = self.land().filter(|f| !f.is_forgotten) {
                    self.drafts.made += u64::from(picture.is_draft);
                    self.sides[side].arrive(ctx, *picture, flight.wanted);
                }
                return Some(Event::Came);
            }
            Answer::Forgotten => {}
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
    pub fn schedule(
        &mut self,
        ctx: &Context,
        wanted: Vec<RenderRequest>,
        is_busy: bool,
        plays: bool,
    ) {
        if self.wanted != wanted {
            self.changed = Instant::now();
            self.wanted = wanted;
        }
        if let Some(flight) = &mut self.flight {
            let is_wanted = self.wanted.get(flight.side) == Some(&flight.wanted);
            // Time that plays does not wait for final pictures.
            if flight.is_slow && !flight.is_canceled && (!is_wanted || plays) {
                flight.is_canceled = true;
                self.worker.cancel();
            }
            return;
        }
        let goal_ms = if plays { PLAY_MS } else { TURN_MS } / self.wanted.len().max(1) as f64;
        let is_software = self.is_software();
        let sides = self.wanted.iter().zip(&self.sides);
        let dues: Vec<Due> = sides.map(|(w, s)| s.due(w, goal_ms, is_software)).collect();
        let next = match dues.iter().position(|d| matches!(d, Due::Quick(_))) {
            Some(side) => Some(side),
            None => dues.iter().position(|d| matches!(d, Due::Slow)),
        };
        let Some(side) = next else { return };
        let draft = match dues[side] {
            Due::Quick(draft) => draft,
            _ if is_busy || plays || self.changed.elapsed() < REST => {
                ctx.request_repaint_after(REST);
                return;
            }
            _ => None,
        };
        let is_slow = matches!(dues[side], Due::Slow);
        self.send(side, draft, is_slow);
    }

    /// Asks for a side's picture, smaller where it is a draft.
    fn send(&mut self, side: usize, draft: Option<DraftSize>, is_slow: bool) {
        let wanted = self.wanted[side].clone();
        let mut job = wanted.clone();
        if let Some(draft) = draft {
            self.sides[side].make_draft(&mut job, draft, self.is_software());
            self.drafts.asked += 1;
        }
        self.worker.ask(ImageJob::Picture {
            side,
            wanted: job,
            is_draft: draft.is_some(),
        });
        self.flight = Some(Flight {
            side,
            wanted,
            is_draft: draft.is_some(),
            is_slow,
            is_canceled: false,
            is_forgotten: false,
        });
    }

    /// True where pictures are computed on the CPU, as far as is known.
    fn is_software(&self) -> bool {
        self.adapter.as_ref().is_none_or(|a| a.1)
    }

    /// Lets go of all that is kept of a case, here and on the device.
    pub fn forget(&mut self, case: &Arc<Case>) {
        let is_of = |wanted: &RenderRequest| Arc::ptr_eq(&wanted.case, case);
        if let Some(flight) = self.flight.as_mut().filter(|f| is_of(&f.wanted)) {
            flight.is_forgotten = true;
            flight.is_canceled = true;
            self.worker.cancel();
        }
        for side in &mut self.sides {
            side.forget(case);
        }
        self.wanted.retain(|wanted| !is_of(wanted));
        self.difference = None;
        self.worker.forget(case);
    }
}

#[cfg(test)]
mod tests;
