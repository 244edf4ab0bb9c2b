//! The picture with what is drawn over it, and the pointer on it.

use std::sync::{Arc, Weak};

use eframe::egui::{self, Rect, Sense, Ui, vec2};
use glam::{DVec2, DVec3};

use super::action::Action;
use super::drafts::ShownImage;
use super::mouse::{self, Input, Motion};
use super::settings::Mouse;
use super::{orbit, overlay};
use crate::case::Case;
use crate::model::Grid;
use crate::picture::Annotations;
use crate::scene::{CameraSpec, Scene};
use crate::view::{Camera, View};

/// What the viewport keeps from frame to frame.
#[derive(Default)]
pub struct Viewport {
    /// The point that the drag in progress turns around.
    pivot: Option<DVec3>,
    drawn: Option<Drawn>,
}

/// The box of the cells that are drawn, kept while these are the same.
struct Drawn {
    /// By active index: true where the cell is drawn. Gone where its case was closed.
    cells: Weak<Vec<bool>>,
    /// Smallest and largest corner in grid space; `None` where none is drawn.
    bounds: Option<[DVec3; 2]>,
}

/// What the pointer did.
#[derive(Default)]
pub struct Touched {
    /// Where the camera was moved to.
    pub camera: Option<CameraSpec>,
    /// Other changes of the scene.
    pub actions: Vec<Action>,
    /// A place was clicked, 0 to 1 to the right and down.
    pub pick: Option<DVec2>,
}

impl Viewport {
    /// Draws the last picture and takes the pointer's input.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        case: &Arc<Case>,
        scene: &Scene,
        shown: Option<&ShownImage>,
        mouse: Mouse,
    ) -> Touched {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let mut touched = Touched::default();
        let painter = ui.painter_at(rect);
        let Some(shown) = shown else {
            let line = Rect::from_center_size(rect.center(), vec2(rect.width(), 20.0));
            ui.put(line, egui::Spinner::new());
            let words = egui::Label::new("Drawing the first image ...").truncate();
            ui.put(line.translate(vec2(0.0, 28.0)), words);
            return touched;
        };
        let uv = Rect::from_min_max(egui::Pos2::ZERO, egui::pos2(1.0, 1.0));
        let view = &shown.picture.view;
        painter.image(shown.texture.id(), rect, uv, egui::Color32::WHITE);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "volume"));
        // The camera of the scene as it is now; the picture may lag behind.
        let size = [rect.width().max(1.0) as u32, rect.height().max(1.0) as u32];
        let now = view.seen_from(&scene.camera, size);
        let now = now.map_or_else(|_| view.clone(), Arc::new);
        overlay::draw(
            &painter,
            rect,
            &shown.picture,
            &now,
            &Annotations::of(case, &now),
        );
        let input = Input::of(ui, &response, rect, mouse);
        let grid = &case.in_space(now.world.space).grid;
        if let Some(camera) = self.moved(&input, &now, grid) {
            touched.camera = Some(orbit::spec(&camera, &now.world.corners));
        }
        if response.clicked() {
            touched.pick = input.at;
        }
        touched
    }

    /// The camera after what the pointer did; `None` where it did nothing to it.
    fn moved(&mut self, input: &Input, view: &View, grid: &Grid) -> Option<Camera> {
        let camera = &view.camera;
        if input.drag.is_none() {
            self.pivot = None;
        }
        if let (Some((motion, by)), Some(at)) = (input.drag, input.at) {
            let pivot = match self.pivot {
                Some(pivot) => pivot,
                None => self.under(view, grid, at),
            };
            self.pivot = Some(pivot);
            // A pointer at rest must not move the camera, not even by rounding: each camera asks for a picture.
            if by == DVec2::ZERO {
                return None;
            }
            let moved = match motion {
                Motion::Rotate => orbit::rotate(camera, pivot, by),
                Motion::Pan => orbit::pan(camera, pivot, by),
                Motion::Zoom => orbit::zoom(camera, pivot, mouse::drag_zoom(by)),
            };
            return Some(moved).filter(|c| c != camera);
        }
        let (zoom, at) = (input.zoom?, input.at?);
        Some(orbit::zoom(camera, self.under(view, grid, at), zoom))
    }

    /// A point of world space under a place in the picture.
    fn under(&mut self, view: &View, grid: &Grid, at: DVec2) -> DVec3 {
        let known = self.drawn.take();
        let known =
            known.filter(|d| std::ptr::eq(d.cells.as_ptr(), Arc::as_ptr(&view.shown.cells.drawn)));
        let drawn = known.unwrap_or_else(|| Drawn {
            cells: Arc::downgrade(&view.shown.cells.drawn),
            bounds: view.drawn_bounds(grid),
        });
        let bounds = self.drawn.insert(drawn).bounds;
        orbit::point_under(view, bounds, at)
    }
}

/// Pixels of a picture that fills a rectangle, at a part of full resolution along each side.
pub fn pixels(rect: Rect, pixels_per_point: f32, part: f32) -> [u32; 2] {
    let size = rect.size() * pixels_per_point * part;
    let size = size.max(vec2(16.0, 16.0)).min(vec2(8192.0, 8192.0));
    [size.x.round() as u32, size.y.round() as u32]
}
