//! What follows from the state: the pictures and values to be asked for.

use std::sync::Arc;

use eframe::egui::Context;

use super::Window;
use super::difference::same_date;
use crate::case::Case;
use crate::scene::{Scene, ShownFaults};
use crate::view::model_corners;
use crate::viewer::job::RenderRequest;
use crate::viewer::link::Link;
use crate::viewer::reader::Cells;
use crate::viewer::spread::Spread;
use crate::viewer::state::State;
use crate::viewer::vectors::VectorRequest;

/// What the reader was asked for last.
#[derive(Default, PartialEq)]
pub struct ReadRequests {
    table: Option<(Cells, usize)>,
    curves: Option<(Cells, Vec<String>)>,
    ahead: Option<(usize, Vec<(String, usize)>)>,
    look: Option<(usize, String)>,
    spreads: Vec<(String, usize)>,
    wells: WellRequest,
    vectors: VectorsRequest,
}

impl ReadRequests {
    /// The vectors are asked for once more, as their files have changed.
    pub(super) fn forget_vectors(&mut self) {
        self.vectors = None;
    }
}

/// Address of a case, and the step of the wells or which vectors.
type WellRequest = Option<(usize, usize)>;
type VectorsRequest = Option<(usize, VectorRequest)>;

/// Steps that are read ahead.
const AHEAD: usize = 3;

impl Window {
    /// The case that the second picture is of.
    pub(super) fn other_case(&self) -> Option<Arc<Case>> {
        let document = self.document()?;
        let comparison = document.state.setup.comparison.as_ref()?;
        match &comparison.case {
            Some(path) => {
                let other = self.documents.iter().find(|d| d.key() == *path);
                other.and_then(|d| d.case.clone())
            }
            None => document.case.clone(),
        }
    }

    /// What is to be shown, a scene for each side in the size of its place.
    pub(super) fn wanted(&self, ctx: &Context) -> Vec<RenderRequest> {
        let Some((case, scene)) = self.subject() else {
            return Vec::new();
        };
        let sizes = self.sides.sizes(ctx.pixels_per_point());
        let mut wanted = Vec::new();
        if let Some(size) = sizes[0].filter(|_| !self.awaits_difference()) {
            let scene = Scene { size, ..scene };
            wanted.push(RenderRequest { case, scene });
        }
        if let (Some(size), Some((case, scene))) = (sizes[1], self.other()) {
            wanted.push(RenderRequest {
                case,
                scene: Scene { size, ..scene },
            });
        }
        wanted
    }

    /// The second picture's case and scene, if there is one.
    pub(super) fn other(&self) -> Option<(Arc<Case>, Scene)> {
        let setup = &self.document()?.state.setup;
        if setup.difference().is_some() {
            return None;
        }
        let other = self.other_case()?;
        let mut scene = setup.compared(&setup.scene)?;
        let comparison = setup.comparison.as_ref()?;
        if comparison.case.is_some() {
            let case = self.document()?.case.as_ref()?;
            scene.step = same_date(case, &scene.step, &other);
            if let ShownFaults::Named(names) = &mut scene.show.faults {
                names.retain(|name| other.about.named_faults.iter().any(|f| f.name == *name));
            }
            let link = self.link()?;
            let (picture, _) = self.picture(0)?;
            let view = &picture.view;
            if link.is_one_world() {
                // One that frames its own model would not look from the same place.
                let now = view.seen_from(&scene.camera, view.size);
                scene.camera = now.map_or_else(
                    |_| scene.camera.clone(),
                    |v| crate::viewer::orbit::spec(&v.camera, &v.world.corners),
                );
                scene.vertical_exaggeration = Some(view.world.vertical_exaggeration);
            } else {
                scene.camera = link.there(&scene.camera);
            }
        }
        Some((other, scene))
    }

    /// How the worlds of both cases belong together; `None` where there is one case.
    pub(super) fn link(&self) -> Option<Link> {
        let document = self.document()?;
        document.state.setup.comparison.as_ref()?.case.as_ref()?;
        let other = self.other_case()?;
        let scene = &document.state.setup.scene;
        let corners = |case: &Arc<Case>| {
            model_corners(&case.in_space(scene.space), scene.vertical_exaggeration)
        };
        let case = document.case.as_ref()?;
        Some(Link::between(&corners(case)?, &corners(&other)?))
    }

    /// Asks for the values that panels show, and for those of the next steps.
    pub(super) fn read(&mut self) {
        let Some((case, scene)) = self.subject() else {
            return;
        };
        let awaits_difference = self.awaits_difference();
        let Some(document) = self.documents.get_mut(self.current) else {
            return;
        };
        let step = document.step().map_or(0, |(step, _)| step);
        let shown = self.pictures.shown(0, &case);
        let shown = shown.map(|s| s.picture.view.shown.property.clone());
        let Some(property) = shown.or(scene.property.filter(|_| awaits_difference)) else {
            return;
        };
        let cells = document.state.selected.clone();
        let mut asked = ReadRequests::default();
        if cells.is_empty() {
            (document.table, document.curves) = (None, None);
        } else {
            let of = Cells {
                case: case.clone(),
                cells,
            };
            asked.table = Some((of.clone(), step));
            let chosen = &document.state.curves.properties;
            asked.curves = Some((
                of,
                match chosen.is_empty() {
                    true => vec![property.clone()],
                    false => chosen.clone(),
                },
            ));
        }
        let filters = document.state.setup.scene.filter.properties.iter();
        let names: Vec<String> = filters.map(|f| f.name.clone()).chain([property]).collect();
        let next = (step + 1..case.steps.len()).take(AHEAD);
        let next = next.flat_map(|s| names.iter().map(move |n| (n.clone(), s)));
        let setup = &document.state.setup;
        let compared = setup.comparison.as_ref().and_then(|c| c.property.clone());
        let missing = match setup.difference() {
            Some(name) => Some(name).filter(|_| awaits_difference),
            None => compared.filter(|p| document.lacks_look(p)),
        };
        asked.look = missing.map(|name| (Arc::as_ptr(&case).addr(), name));
        let filters = setup.scene.filter.properties.iter();
        let wanted: Vec<_> = filters.map(|f| (f.name.clone(), step)).collect();
        let is_wanted = |s: &Arc<Spread>| wanted.iter().any(|(n, at)| s.is_of(&case, n, *at));
        document.spreads.retain(is_wanted);
        let known =
            |w: &(String, usize)| document.spreads.iter().any(|s| s.is_of(&case, &w.0, w.1));
        asked.spreads = wanted.into_iter().filter(|w| !known(w)).collect();
        asked.ahead = Some((Arc::as_ptr(&case).addr(), next.collect()));
        (asked.wells, asked.vectors) = self.read_wells(&case, step);
        if asked.table != self.asked.table
            && let Some((of, step)) = &asked.table
        {
            self.reader.table(of.clone(), *step);
        }
        if asked.curves != self.asked.curves
            && let Some((of, properties)) = &asked.curves
        {
            self.reader.curves(of.clone(), properties.clone());
        }
        if asked.look != self.asked.look
            && let Some((_, property)) = &asked.look
        {
            self.reader.look(case.clone(), property.clone());
        }
        if asked
            .spreads
            .iter()
            .any(|s| !self.asked.spreads.contains(s))
        {
            self.reader.spreads(&case, &asked.spreads);
        }
        if asked.ahead != self.asked.ahead
            && let Some((_, fields)) = &asked.ahead
        {
            self.reader.ahead(case, fields.clone());
        }
        self.asked = asked;
    }
}

impl Window {
    /// Asks for the wells of a step and for summary vectors, where they are not those asked for last.
    fn read_wells(&self, case: &Arc<Case>, step: usize) -> (WellRequest, VectorsRequest) {
        let state = self.document().map(|document| &document.state);
        let vectors = state.and_then(|state| vectors(case, state));
        let wells = wells(case, step);
        if wells.is_some() && wells != self.asked.wells {
            self.reader.wells(case.clone(), step);
        }
        if vectors != self.asked.vectors
            && let Some((_, asked)) = &vectors
        {
            self.reader.vectors(case.clone(), asked.clone());
        }
        (wells, vectors)
    }
}

/// The wells to be read, if there are some: those of a step.
fn wells(case: &Arc<Case>, step: usize) -> WellRequest {
    let has_some = !case.about.wells.is_empty();
    has_some.then(|| (Arc::as_ptr(case).addr(), step))
}

/// The summary vectors to be read, where their curves are shown.
fn vectors(case: &Arc<Case>, state: &State) -> VectorsRequest {
    let is_shown = state.curves.is_open && !case.about.summary.is_empty();
    is_shown.then(|| {
        let asked = VectorRequest {
            names: state.curves.vectors.clone(),
            well: state.well.clone(),
        };
        (Arc::as_ptr(case).addr(), asked)
    })
}
