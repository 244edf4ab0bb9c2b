//! The picture with what is drawn over it, and the pointer on it.

use std::sync::Arc;

use eframe::egui::{self, PointerButton, Rect, Sense, TextureHandle, Ui, vec2};
use glam::{DVec2, DVec3};

use super::action::Action;
use super::{orbit, overlay};
use crate::case::Case;
use crate::picture::Annotations;
use crate::scene::camera::middle;
use crate::scene::{Camera, Scene, View};

/// What the viewport keeps from frame to frame.
#[derive(Default)]
pub struct Viewport {
    /// The point that the drag in progress turns around.
    pivot: Option<DVec3>,
}

/// What the pointer did.
#[derive(Default)]
pub struct Touched {
    /// Changes of the scene.
    pub actions: Vec<Action>,
    /// A place was clicked, 0 to 1 to the right and down.
    pub pick: Option<DVec2>,
}

impl Touched {
    /// Adds what the pointer did to another picture, but for what was clicked there.
    pub fn join(&mut self, other: Self) {
        self.actions.extend(other.actions);
    }
}

/// Zoom of a turn of the wheel by a point.
const WHEEL: f64 = 0.004;

impl Viewport {
    /// Draws the last picture and takes the pointer's input.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        case: &Case,
        scene: &Scene,
        shown: Option<(&TextureHandle, &Arc<View>)>,
    ) -> Touched {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let mut touched = Touched::default();
        let painter = ui.painter_at(rect);
        let Some((texture, view)) = shown else {
            ui.put(rect, egui::Spinner::new());
            return touched;
        };
        let uv = Rect::from_min_max(egui::Pos2::ZERO, egui::pos2(1.0, 1.0));
        painter.image(texture.id(), rect, uv, egui::Color32::WHITE);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "volume"));
        // The camera of the scene as it is now; the picture may lag behind.
        let size = [rect.width().max(1.0) as u32, rect.height().max(1.0) as u32];
        let now = view.seen_from(&scene.camera, size);
        let now = now.map_or_else(|_| view.clone(), Arc::new);
        overlay::draw(&painter, rect, &now, &Annotations::of(case, &now));
        let input = Input::of(ui, &response, rect);
        if let Some(camera) = self.moved(&input, &now) {
            touched.actions.push(Action::Camera(orbit::spec(
                &camera,
                middle(&now.box_corners),
            )));
        }
        if response.clicked() {
            touched.pick = input.at;
        }
        touched
    }

    /// The camera after what the pointer did; `None` where it did nothing to it.
    fn moved(&mut self, input: &Input, view: &View) -> Option<Camera> {
        let camera = &view.camera;
        let under = |at: DVec2| orbit::point_under(camera, at, view.aspect(), &view.box_corners);
        if input.drag.is_none() {
            self.pivot = None;
        }
        if let (Some(drag), Some(at)) = (input.drag, input.at) {
            let pivot = *self.pivot.get_or_insert_with(|| under(at));
            return match drag {
                Drag::Rotate(by) => Some(orbit::rotate(camera, pivot, by)),
                Drag::Pan(by) => Some(orbit::pan(camera, pivot, by)),
            }
            .filter(|c| c != camera);
        }
        let (zoom, at) = (input.zoom?, input.at?);
        Some(orbit::zoom(camera, under(at), zoom))
    }
}

#[derive(Clone, Copy)]
enum Drag {
    Rotate(DVec2),
    Pan(DVec2),
}

/// The pointer in terms of the picture.
struct Input {
    at: Option<DVec2>,
    drag: Option<Drag>,
    zoom: Option<f64>,
}

impl Input {
    fn of(ui: &Ui, response: &egui::Response, rect: Rect) -> Self {
        let pointer = response.hover_pos().or(response.interact_pointer_pos());
        let at = pointer.map(|p| {
            let at = (p - rect.min) / rect.size();
            DVec2::new(f64::from(at.x), f64::from(at.y))
        });
        let shift = ui.input(|i| i.modifiers.shift);
        let by = response.drag_delta() / rect.height().max(1.0);
        let by = DVec2::new(f64::from(by.x), f64::from(by.y));
        let drag = if response.dragged_by(PointerButton::Middle)
            || (shift && response.dragged_by(PointerButton::Primary))
        {
            Some(Drag::Pan(by))
        } else if response.dragged_by(PointerButton::Primary) {
            Some(Drag::Rotate(by))
        } else {
            None
        };
        let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta, i.zoom_delta()));
        let factor = f64::from(pinch) * (WHEEL * f64::from(scroll.y)).exp();
        let zoom = (response.hovered() && factor != 1.0).then_some(factor);
        Self { at, drag, zoom }
    }
}

/// Pixels of a picture that fills a rectangle, at a part of full resolution along each side.
pub fn pixels(rect: Rect, pixels_per_point: f32, part: f32) -> [u32; 2] {
    let size = rect.size() * pixels_per_point * part;
    let size = size.max(vec2(16.0, 16.0)).min(vec2(8192.0, 8192.0));
    [size.x.round() as u32, size.y.round() as u32]
}
