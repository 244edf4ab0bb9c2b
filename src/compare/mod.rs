//! Pictures side by side: the same views by each strategy, light method or setting, measured against a truth.
//!
//! A [`Plan`] says what is compared, a [`Comparer`] makes the pictures and figures of one view after
//! another, and a [`Report`] writes them into a folder for people and for programs.

mod light;
pub mod markdown;
mod plan;
mod plots;
mod report;
mod row;
mod sheet;
mod sweep;
mod tables;

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::image::metrics::{Comparison, ciede2000_map};
use crate::image::{Image, Rgb8};
use crate::model::Grid;
use crate::reference;
use crate::render::{Executor, Frame, RenderError, Renderer};
use crate::view::View;

pub use light::LightRow;
pub use plan::{Contender, Plan, Reference, Source, Truth};
pub use report::{Report, ReportError};
pub use row::Row;
pub use sweep::{Sweep, SweepError, SweepPlanError};
pub use tables::{Setting, summary};

/// All pictures of one view.
pub struct Compared {
    /// Number of the view in the plan.
    pub view: usize,
    /// One for each truth, in the plan's order.
    pub truths: Vec<Found>,
    /// One for each contender, in the plan's order.
    pub outcomes: Vec<Outcome>,
}

/// What came of a truth in a view.
pub struct Found {
    /// Its picture, or the sentence that says why there is none.
    pub picture: Result<Rgb8, String>,
    /// Which pixels the model covers.
    covered: Vec<bool>,
    /// What it took.
    pub time: Duration,
}

/// What a contender made of a view.
pub struct Outcome {
    /// Its figures.
    pub row: Row,
    /// Its picture over the background; `None` where it failed.
    pub picture: Option<Rgb8>,
    /// CIEDE2000 difference of each pixel to its truth; `None` where there is nothing to compare
    /// or this is the truth itself.
    pub differences: Option<Vec<f64>>,
}

/// Makes the pictures of a plan.
pub struct Comparer<'a> {
    plan: &'a Plan,
    renderer: Box<dyn Renderer>,
    /// What the first preparation of each contender took.
    prepared: Vec<Option<Prepared>>,
}

/// What preparing for the first picture of a contender took.
#[derive(Debug, Clone, Copy)]
struct Prepared {
    all: Duration,
    /// Of it, extinction and light volumes; `None` without light.
    light: Option<Duration>,
}

/// Is told the fraction done and returns false to cancel.
type Told<'a> = dyn Fn(f64) -> bool + Sync + 'a;

/// Alpha above which the model covers a pixel.
const COVERED: f32 = 0.05;

impl Found {
    fn of(image: &Image, view: &View, time: Duration) -> Self {
        Self {
            picture: Ok(finished(image, view)),
            covered: image.pixels.iter().map(|p| p[3] > COVERED).collect(),
            time,
        }
    }

    fn of_attempt(attempt: &Attempt, view: &View) -> Self {
        match attempt {
            Ok(frame) => Self::of(&frame.image, view, frame.stats.frame),
            Err(error) => Self {
                picture: Err(error.clone()),
                covered: Vec::new(),
                time: Duration::ZERO,
            },
        }
    }
}

impl<'a> Comparer<'a> {
    /// Uploads the grid with the values of the views, so that nobody's preparation has to.
    ///
    /// # Errors
    /// When the adapter cannot hold them.
    pub fn new(
        executor: &dyn Executor,
        grid: &Arc<Grid>,
        plan: &'a Plan,
    ) -> Result<Self, RenderError> {
        let mut renderer = executor.renderer(grid)?;
        if let Some(first) = plan.first_view() {
            renderer.prepare(first)?;
        }
        Ok(Self {
            plan,
            renderer,
            prepared: vec![None; plan.contenders.len()],
        })
    }

    /// Makes the pictures of view number `n`; `None` where `progress`, which is told the fraction done,
    /// returned false, or where there is no such view. A contender that fails has a row that says so.
    pub fn view(&mut self, n: usize, progress: &Told) -> Option<Compared> {
        let plan = self.plan;
        plan.views.get(n)?;
        let mut pictures = Pictures {
            done: 0,
            all: plan.images_per_view(),
            progress,
        };
        let mut shots = Vec::new();
        for (number, contender) in plan.contenders.iter().enumerate() {
            shots.push(self.timed(number, contender, n, &mut pictures)?);
        }
        let mut truths = Vec::new();
        for truth in &plan.truths {
            truths.push(self.truth(truth, n, &shots, &mut pictures)?);
        }
        let contenders = plan.contenders.iter().enumerate();
        let outcome = |((number, contender), shot): ((usize, &Contender), Attempt)| {
            self.outcome(n, number, contender, shot, &truths[contender.truth])
        };
        Some(Compared {
            view: n,
            outcomes: contenders.zip(shots).map(outcome).collect(),
            truths,
        })
    }

    /// The median frame of a contender after one to warm up.
    fn timed(
        &mut self,
        number: usize,
        contender: &Contender,
        n: usize,
        pictures: &mut Pictures,
    ) -> Option<Attempt> {
        let view = &contender.views[n];
        let all = self.plan.images_of(contender);
        if self.prepared[number].is_none() && !view.style.lighting.is_off() {
            // What others have left of light would not be made for this one.
            if let Err(error) = self.renderer.render(&dark(view), &|_| true) {
                pictures.done += all;
                return Some(Err(error.to_string()));
            }
        }
        let mut frames = Vec::new();
        for done in 0..all {
            match self.frame(view, pictures)? {
                Err(error) => {
                    pictures.done += all - 1 - done;
                    return Some(Err(error));
                }
                Ok(frame) => {
                    if done == 0 {
                        self.prepared[number].get_or_insert_with(|| Prepared::of(&frame, view));
                    }
                    if done > 0 || all == 1 {
                        frames.push(frame);
                    }
                }
            }
        }
        Some(Frame::median(frames).ok_or_else(|| "no frame was timed".into()))
    }

    fn frame(&mut self, view: &View, pictures: &mut Pictures) -> Option<Attempt> {
        let progress = pictures.next();
        match self.renderer.render(view, &progress) {
            Err(RenderError::Canceled) => None,
            rendered => Some(rendered.map_err(|error| error.to_string())),
        }
    }

    /// The truth of a view and what it took.
    fn truth(
        &mut self,
        truth: &Truth,
        n: usize,
        shots: &[Attempt],
        pictures: &mut Pictures,
    ) -> Option<Found> {
        Some(match &truth.source {
            Source::Contender(of) => {
                Found::of_attempt(&shots[*of], &self.plan.contenders[*of].views[n])
            }
            Source::Executor(views) => {
                Found::of_attempt(&self.frame(&views[n], pictures)?, &views[n])
            }
            Source::Cpu(views) => {
                let start = Instant::now();
                let image = reference::render(self.renderer.grid(), &views[n], &pictures.next())?;
                Found::of(&image, &views[n], start.elapsed())
            }
        })
    }

    fn outcome(
        &self,
        n: usize,
        number: usize,
        contender: &Contender,
        shot: Attempt,
        truth: &Found,
    ) -> Outcome {
        let mut row = Row::of(self.plan, contender, n);
        if let Some(prepared) = self.prepared[number] {
            row.prepare_ms = Some(row::ms(prepared.all));
            row.light_ms = prepared.light.map(row::ms);
        }
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
        let picture = finished(&frame.image, &contender.views[n]);
        match quality(&picture, truth) {
            Ok(quality) => row.quality(&quality),
            Err(error) => row.error = Some(error),
        }
        let other = truth.picture.as_ref().ok().filter(|_| !row.is_reference());
        row.brighter = truth
            .picture
            .as_ref()
            .ok()
            .and_then(|t| brighter(&picture, t, &truth.covered));
        Outcome {
            row,
            differences: other.and_then(|r| ciede2000_map(&picture.pixels, &r.pixels)),
            picture: Some(picture),
        }
    }
}

impl Prepared {
    fn of(frame: &Frame, view: &View) -> Self {
        let light = frame.light.extinction + frame.light.volumes;
        Self {
            all: frame.prepare,
            light: (!view.style.lighting.is_off()).then_some(light),
        }
    }
}

/// The same view without light, and small.
fn dark(view: &View) -> View {
    let mut dark = view.clone();
    dark.size = [8, 8];
    dark.style.lighting.occlusion = None;
    dark.style.lighting.lights.clear();
    dark.style.lighting.blinn_phong = false;
    dark
}

fn quality(picture: &Rgb8, truth: &Found) -> Result<Comparison, String> {
    let truth = truth.picture.as_ref();
    let truth = truth.map_err(|error| format!("there is no reference: {error}"))?;
    Comparison::of(picture, truth).map_err(|error| error.to_string())
}

/// Mean of how much brighter a picture is than its truth where the model covers that, of 255; `None` where it covers
/// nothing.
fn brighter(picture: &Rgb8, truth: &Rgb8, covered: &[bool]) -> Option<f64> {
    let light = |p: &[u8; 3]| p.iter().map(|c| f64::from(*c)).sum::<f64>() / 3.0;
    let pairs = picture.pixels.iter().zip(&truth.pixels);
    let among = pairs.zip(covered).filter(|(_, covered)| **covered);
    let differences: Vec<f64> = among.map(|((a, b), _)| light(a) - light(b)).collect();
    (!differences.is_empty()).then(|| crate::image::metrics::mean(&differences))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brightness_is_signed_and_of_covered_pixels_alone() {
        let picture = |values: [u8; 3]| Rgb8 {
            size: [3, 1],
            pixels: values.map(|v| [v; 3]).to_vec(),
        };
        let (a, b) = (picture([10, 20, 200]), picture([14, 20, 0]));
        let covered = [true, true, false];
        assert_eq!(brighter(&a, &b, &covered), Some(-2.0));
        assert_eq!(brighter(&b, &a, &covered), Some(2.0));
        assert_eq!(brighter(&a, &b, &[false; 3]), None);
    }
}
