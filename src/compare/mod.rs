//! Strategies side by side: the same views by each, measured against one reference.
//!
//! A [`Plan`] says what is compared, a [`Comparer`] makes the pictures and figures of one view after
//! another, and a [`Report`] writes them into a folder for people and for programs.

pub mod markdown;
mod plots;
mod report;
mod row;
mod sheet;
mod tables;

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::image::metrics::{Comparison, ciede2000_map};
use crate::image::{Image, Rgb8};
use crate::model::Grid;
use crate::reference;
use crate::render::{Executor, Frame, RenderError, Renderer};
use crate::scene::StrategyKind;
use crate::view::{NamedView, View};

pub use report::{Report, ReportError};
pub use row::Row;
pub use tables::{Setting, summary};

/// What the pictures are measured against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// The f64 reference on the CPU.
    Cpu,
    /// The pictures of a strategy, whose own figures are perfect then.
    Strategy(StrategyKind),
}

impl Reference {
    /// Its name in rows and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Strategy(kind) => kind.name(),
        }
    }

    /// True where this strategy is the reference.
    pub fn is(self, strategy: StrategyKind) -> bool {
        self == Self::Strategy(strategy)
    }
}

/// What is compared.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The strategies, each once.
    pub strategies: Vec<StrategyKind>,
    /// What they are measured against.
    pub reference: Reference,
    /// The views, all of the same size and the same cells and values; their strategy does not matter.
    pub views: Vec<NamedView>,
    /// Frames to time for each picture, after one to warm up.
    pub frames: usize,
}

/// All pictures of one view.
pub struct Compared {
    /// Number of the view in the plan.
    pub view: usize,
    /// The reference, or the sentence that says why there is none.
    pub reference: Result<Rgb8, String>,
    /// What the reference took.
    pub reference_time: Duration,
    /// One for each strategy, in the plan's order.
    pub outcomes: Vec<Outcome>,
}

/// What a strategy made of a view.
pub struct Outcome {
    /// Its figures.
    pub row: Row,
    /// Its picture over the background; `None` where it failed.
    pub picture: Option<Rgb8>,
    /// CIEDE2000 difference of each pixel to the reference; `None` where there is nothing to compare
    /// or this is the reference itself.
    pub differences: Option<Vec<f64>>,
}

/// Makes the pictures of a plan.
pub struct Comparer<'a> {
    plan: &'a Plan,
    renderer: Box<dyn Renderer>,
    /// What the first preparation of each strategy took.
    prepared: Vec<(StrategyKind, Duration)>,
}

/// Is told the fraction done and returns false to cancel.
type Told<'a> = dyn Fn(f64) -> bool + Sync + 'a;

impl<'a> Comparer<'a> {
    /// Uploads the grid with the values of the views, so that no strategy's preparation has to.
    ///
    /// # Errors
    /// When the adapter cannot hold them.
    pub fn new(
        executor: &dyn Executor,
        grid: &Arc<Grid>,
        plan: &'a Plan,
    ) -> Result<Self, RenderError> {
        let mut renderer = executor.renderer(grid)?;
        if let Some(first) = plan.views.first() {
            renderer.prepare(&first.view)?;
        }
        Ok(Self {
            plan,
            renderer,
            prepared: Vec::new(),
        })
    }

    /// Makes the pictures of view number `n`; `None` where `progress`, which is told the fraction done,
    /// returned false, or where there is no such view. A strategy that fails has a row that says so.
    pub fn view(&mut self, n: usize, progress: &Told) -> Option<Compared> {
        let plan = self.plan;
        let view = &plan.views.get(n)?.view;
        let mut pictures = Pictures {
            done: 0,
            all: plan.images_per_view(),
            progress,
        };
        let mut shots = Vec::new();
        for &kind in &plan.strategies {
            shots.push((kind, self.timed(view, kind, &mut pictures)?));
        }
        let (reference, reference_time) = self.reference(view, &shots, &mut pictures)?;
        let outcome = |(kind, shot)| self.outcome(n, kind, shot, reference.as_ref());
        Some(Compared {
            view: n,
            outcomes: shots.into_iter().map(outcome).collect(),
            reference,
            reference_time,
        })
    }

    /// The median frame of a strategy after one to warm up.
    fn timed(
        &mut self,
        view: &View,
        kind: StrategyKind,
        pictures: &mut Pictures,
    ) -> Option<Attempt> {
        let mut frames = Vec::new();
        for n in 0..=self.plan.frames.max(1) {
            match self.frame(view, kind, pictures)? {
                Err(error) => {
                    pictures.done += self.plan.frames.max(1) - n;
                    return Some(Err(error));
                }
                Ok(frame) if n == 0 => self.remember(kind, frame.prepare),
                Ok(frame) => frames.push(frame),
            }
        }
        Some(Frame::median(frames).ok_or_else(|| "no frame was timed".into()))
    }

    fn frame(
        &mut self,
        view: &View,
        kind: StrategyKind,
        pictures: &mut Pictures,
    ) -> Option<Attempt> {
        let view = view.by(kind);
        let progress = pictures.next();
        match self.renderer.render(&view, &progress) {
            Err(RenderError::Canceled) => None,
            rendered => Some(rendered.map_err(|error| error.to_string())),
        }
    }

    fn remember(&mut self, kind: StrategyKind, prepare: Duration) {
        if self.prepared(kind).is_none() {
            self.prepared.push((kind, prepare));
        }
    }

    fn prepared(&self, kind: StrategyKind) -> Option<Duration> {
        let found = self.prepared.iter().find(|(k, _)| *k == kind);
        found.map(|(_, prepare)| *prepare)
    }

    /// The reference of a view and what it took.
    fn reference(
        &mut self,
        view: &View,
        shots: &[(StrategyKind, Attempt)],
        pictures: &mut Pictures,
    ) -> Option<(Result<Rgb8, String>, Duration)> {
        let of_frame = |shot: &Attempt| match shot {
            Ok(frame) => (Ok(finished(&frame.image, view)), frame.stats.frame),
            Err(error) => (Err(error.clone()), Duration::ZERO),
        };
        let Reference::Strategy(kind) = self.plan.reference else {
            let start = Instant::now();
            let image = reference::render(self.renderer.grid(), view, &pictures.next())?;
            return Some((Ok(finished(&image, view)), start.elapsed()));
        };
        Some(match shots.iter().find(|(k, _)| *k == kind) {
            Some((_, shot)) => of_frame(shot),
            None => of_frame(&self.frame(view, kind, pictures)?),
        })
    }

    fn outcome(
        &self,
        n: usize,
        kind: StrategyKind,
        shot: Attempt,
        reference: Result<&Rgb8, &String>,
    ) -> Outcome {
        let named = &self.plan.views[n];
        let mut row = Row::of(kind, n, &named.name, self.plan.reference);
        row.prepare_ms = self.prepared(kind).map(row::ms);
        let frame = match shot {
            Ok(frame) => frame,
            Err(error) => {
                row.error = Some(error);
                return Outcome {
                    row,
                    picture: None,
                    differences: None,
                };
            }
        };
        row.cost(&frame);
        let picture = finished(&frame.image, &named.view);
        match quality(&picture, reference) {
            Ok(quality) => row.quality(&quality),
            Err(error) => row.error = Some(error),
        }
        let other = reference.ok().filter(|_| !row.is_reference());
        Outcome {
            row,
            differences: other.and_then(|r| ciede2000_map(&picture.pixels, &r.pixels)),
            picture: Some(picture),
        }
    }
}

fn quality(picture: &Rgb8, reference: Result<&Rgb8, &String>) -> Result<Comparison, String> {
    let reference = reference.map_err(|error| format!("there is no reference: {error}"))?;
    Comparison::of(picture, reference).map_err(|error| error.to_string())
}

/// A frame, or the sentence that says why there is none.
type Attempt = Result<Frame, String>;

/// The picture over the view's background, without annotations: they would be equal in all.
fn finished(image: &Image, view: &View) -> Rgb8 {
    Rgb8 {
        size: image.size,
        pixels: image.over_background_8bit(view.style.background),
    }
}

impl Plan {
    /// True where the reference is one of the strategies compared, so that it has rows.
    fn has_reference(&self) -> bool {
        self.strategies.iter().any(|k| self.reference.is(*k))
    }

    fn images_per_view(&self) -> usize {
        let frames = 1 + self.frames.max(1);
        self.strategies.len() * frames + usize::from(!self.has_reference())
    }
}

/// Told over pictures that count the same.
struct Pictures<'a> {
    done: usize,
    all: usize,
    progress: &'a Told<'a>,
}

impl<'a> Pictures<'a> {
    /// Told of the next picture.
    fn next(&mut self) -> impl Fn(f64) -> bool + Sync + use<'a> {
        let (before, all, progress) = (self.done as f64, self.all as f64, self.progress);
        self.done += 1;
        move |fraction| progress((before + fraction) / all)
    }
}
