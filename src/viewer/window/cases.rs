//! Several open cases on one grid: stepping through them as through time, and statistics over them.

use eframe::egui::Context;

use super::Window;
use crate::case::load::CasePaths;
use crate::case::{Case, distinct_names, of_date};
use crate::scene::{Coloring, RangeSpec, Scene, StepSpec};
use crate::viewer::action::Action;
use crate::viewer::document::Document;

impl Window {
    /// What the tabs are called: of cases with one name, such as realizations, with the folder in which they differ.
    pub(super) fn titles(&self) -> Vec<String> {
        let cases = self.documents.iter().filter_map(single);
        let cases: Vec<&Case> = cases.collect();
        let mut names = distinct_names(&cases).into_iter();
        let title = |d: &Document| {
            let name = single(d).and_then(|_| names.next());
            name.unwrap_or_else(|| d.title())
        };
        self.documents.iter().map(title).collect()
    }

    /// Brings the next tab to the front, or one before it, and shows it as this one is shown: the same property on the same
    /// date in the same colors from the same camera, where its grid has as many cells.
    pub(super) fn step_case(&mut self, by: isize) {
        let count = self.documents.len();
        if count < 2 {
            self.tell("open further cases to step through them");
            return;
        }
        let next = (self.current as isize + by).rem_euclid(count as isize) as usize;
        let mut seen = seen_alike(&self.documents[self.current], &self.documents[next]);
        if let (Ok(scene), Some(range)) = (&mut seen, self.range_shown()) {
            scene.range = RangeSpec::Fixed(range);
        }
        let state = self.documents[self.current].state.clone();
        self.current = next;
        let told = format!("case {} of {count}: {}", next + 1, self.titles()[next]);
        let document = &mut self.documents[next];
        match seen {
            Err(why) => self.tell(format!("{told}, as it was: {why}")),
            Ok(scene) => {
                document.history.end_gesture();
                document.apply(Action::Scene(Box::new(scene)));
                document.state.setup.looks.extend(state.setup.looks);
                document.state.curves = state.curves;
                document.state.slicing = state.slicing;
                document.state.selected = state.selected;
                self.tell(told);
            }
        }
    }

    /// The ends of the colors shown where they are found from the values of the case: those of another one differ, and its
    /// colors would mean others.
    fn range_shown(&self) -> Option<[f64; 2]> {
        let scene = &self.document()?.state.setup.scene;
        let (picture, _) = self.picture(0)?;
        let shown = &picture.view.shown.property;
        let is_found = matches!(scene.range, RangeSpec::Own(_))
            && scene.transfer.coloring != Coloring::Categories
            && scene.property.as_ref() == Some(shown);
        is_found.then(|| picture.view.style.transfer.true_range())
    }

    /// Opens the cases that have as many cells as the one in front as one, in a tab of its own.
    pub(super) fn open_ensemble(&mut self, ctx: &Context) {
        let dims = |d: &Document| d.case.as_ref().map(|case| case.grid.main_dims());
        let Some(front) = self.document().filter(|d| d.case.is_some()) else {
            self.fail("open the cases first");
            return;
        };
        let others =
            self.documents.iter().enumerate().filter(|(n, d)| {
                *n != self.current && d.others.is_empty() && dims(d) == dims(front)
            });
        let others: Vec<CasePaths> = others.map(|(_, d)| d.paths()).collect();
        if others.is_empty() || !front.others.is_empty() {
            self.fail(
                "open two or more cases on one grid first, and bring one of them to the front",
            );
            return;
        }
        let paths = CasePaths {
            others,
            ..front.paths()
        };
        self.show_case(ctx, paths);
    }
}

/// The case of a tab that has one alone.
fn single(document: &Document) -> Option<&Case> {
    let case = document.case.as_deref();
    case.filter(|_| document.others.is_empty())
}

/// The scene of a tab for another one, or why that cannot be seen in the same way, as part of a sentence.
fn seen_alike(from: &Document, to: &Document) -> Result<Scene, String> {
    let (Some(a), Some(b)) = (&from.case, &to.case) else {
        return Err("it is not open yet".into());
    };
    if a.grid.main_dims() != b.grid.main_dims() {
        return Err("its grid has other dimensions".into());
    }
    let mut scene = from.state.setup.scene.clone();
    if let Some(name) = &scene.property
        && b.property(name).is_err()
        && b.difference(name).is_none()
    {
        return Err(format!("it has no {name}"));
    }
    if let Some(step) = step_of(a, &scene.step) {
        let there = of_date(step, &b.steps);
        let there = there.ok_or_else(|| format!("it has no step of {}", step.when()))?;
        scene.step = StepSpec::Index(there);
    }
    Ok(scene)
}

fn step_of<'a>(case: &'a Case, step: &StepSpec) -> Option<&'a crate::case::Step> {
    let number = match step {
        StepSpec::Index(n) => *n,
        StepSpec::Name(name) => case.step(name).ok()?,
    };
    case.steps.get(number)
}
