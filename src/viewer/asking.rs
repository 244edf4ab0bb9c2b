//! What follows from the state: the pictures and values to be asked for.

use std::sync::Arc;

use eframe::egui::Context;

use super::reader::Cells;
use super::window::Window;
use super::worker::Wanted;
use crate::case::Case;
use crate::scene::Scene;

/// What the reader was asked for last.
#[derive(Default, PartialEq)]
pub struct Asked {
    table: Option<(Cells, usize)>,
    curves: Option<(Cells, String)>,
    ahead: Option<(usize, Vec<(String, usize)>)>,
    look: Option<String>,
}

/// Steps that are read ahead.
const AHEAD: usize = 3;

impl Window {
    /// The case that the second picture is of.
    pub(super) fn other_case(&self) -> Option<Arc<Case>> {
        let document = self.document()?;
        let comparison = document.state.setup.comparison.as_ref()?;
        match &comparison.case {
            Some(path) => {
                let other = self.documents.iter().find(|d| d.path == *path);
                other.and_then(|d| d.case.clone())
            }
            None => document.case.clone(),
        }
    }

    /// What is to be shown, a scene for each side in the size of its place.
    pub(super) fn wanted(&self, ctx: &Context) -> Vec<Wanted> {
        let Some(document) = self.document() else {
            return Vec::new();
        };
        let Some(case) = document.case.clone() else {
            return Vec::new();
        };
        let setup = &document.state.setup;
        let sizes = self.sides.sizes(ctx.pixels_per_point());
        let mut wanted = Vec::new();
        if let Some(size) = sizes[0] {
            let scene = Scene {
                size,
                ..setup.scene.clone()
            };
            wanted.push(Wanted { case, scene });
        }
        if let (Some(comparison), Some(size), Some(case)) =
            (&setup.comparison, sizes[1], self.other_case())
        {
            let scene = match comparison.case {
                Some(_) => setup.compared(&self.linked(&setup.scene)),
                None => setup.compared(&setup.scene),
            };
            wanted.extend(scene.map(|scene| Wanted {
                case,
                scene: Scene { size, ..scene },
            }));
        }
        wanted
    }

    /// The scene with camera and exaggeration of the first picture, which may depend on its case.
    fn linked(&self, scene: &Scene) -> Scene {
        let Some((picture, _)) = self.picture(0) else {
            return scene.clone();
        };
        let size = picture.view.size;
        let camera = picture.view.seen_from(&scene.camera, size);
        Scene {
            camera: camera.map_or_else(
                |_| scene.camera.clone(),
                |v| super::orbit::spec(&v.camera, &v.box_corners),
            ),
            vertical_exaggeration: scene
                .vertical_exaggeration
                .or(Some(picture.view.vertical_exaggeration)),
            ..scene.clone()
        }
    }

    /// Asks for the values that panels show, and for those of the next steps.
    pub(super) fn read(&mut self) {
        let Some(document) = self.documents.get_mut(self.current) else {
            return;
        };
        let Some(case) = document.case.clone() else {
            return;
        };
        let step = document.step().map_or(0, |(step, _)| step);
        let shown = self.pictures.shown(0, &case);
        let Some(property) = shown.map(|s| s.picture.view.property.clone()) else {
            return;
        };
        let cells = document.state.selected.clone();
        let mut asked = Asked::default();
        if cells.is_empty() {
            (document.table, document.curves) = (None, None);
        } else {
            let of = Cells {
                case: case.clone(),
                cells,
            };
            asked.table = Some((of.clone(), step));
            asked.curves = Some((of, property.clone()));
        }
        let filters = document.state.setup.scene.filter.properties.iter();
        let names: Vec<String> = filters.map(|f| f.name.clone()).chain([property]).collect();
        let next = (step + 1..case.steps.len()).take(AHEAD);
        let next = next.flat_map(|s| names.iter().map(move |n| (n.clone(), s)));
        let compared = document.state.setup.comparison.as_ref();
        asked.look = compared
            .and_then(|c| c.property.clone())
            .filter(|p| document.lacks_look(p));
        asked.ahead = Some((Arc::as_ptr(&case).addr(), next.collect()));
        if asked.table != self.asked.table
            && let Some((of, step)) = &asked.table
        {
            self.reader.table(of.clone(), *step);
        }
        if asked.curves != self.asked.curves
            && let Some((of, property)) = &asked.curves
        {
            self.reader.curves(of.clone(), property.clone());
        }
        if asked.look != self.asked.look
            && let Some(property) = &asked.look
        {
            self.reader.look(case.clone(), property.clone());
        }
        if asked.ahead != self.asked.ahead
            && let Some((_, fields)) = &asked.ahead
        {
            self.reader.ahead(case, fields.clone());
        }
        self.asked = asked;
    }
}
