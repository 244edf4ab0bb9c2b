//! Clip planes in the picture: their outlines, a handle to move and one to lean each.

use eframe::egui::{self, Color32, Pos2, Rect, Sense, Stroke, Ui, pos2, vec2};
use glam::DVec3;

use crate::scene::{ClipSpec, Scene};
use crate::view::View;

/// Half the side of a handle, in points.
const HANDLE: f32 = 7.0;
/// Length of the arrow of a plane, as a part of the diagonal of the model's box.
const ARROW: f64 = 0.08;

const MOVE: Color32 = Color32::from_rgb(240, 160, 30);
const LEAN: Color32 = Color32::from_rgb(60, 150, 240);

/// Draws the planes and takes drags of their handles; the planes where one was moved.
pub fn show(ui: &mut Ui, rect: Rect, shown: &View, scene: &Scene) -> Option<Vec<ClipSpec>> {
    if scene.clip.is_empty() {
        return None;
    }
    let size = [rect.width().max(1.0) as u32, rect.height().max(1.0) as u32];
    let view = shown.seen_from(&scene.camera, size).ok()?;
    let on_screen = |p: DVec3| -> Option<Pos2> {
        let at = view.camera.project(p, view.aspect())?;
        let at = pos2(at.x as f32, at.y as f32);
        Some(rect.lerp_inside(vec2(at.x, at.y)))
    };
    let arrow = ARROW * view.world.bounds[0].distance(view.world.bounds[1]);
    let mut planes = scene.clip.clone();
    let mut changed = false;
    let painter = ui.painter_at(rect);
    for (n, plane) in planes.iter_mut().enumerate() {
        let normal = DVec3::from_array(plane.normal).normalize_or(DVec3::X);
        let outline = outline(&view, DVec3::from_array(plane.point), normal);
        if outline.len() < 3 {
            continue;
        }
        let corners: Vec<Pos2> = outline.iter().filter_map(|p| on_screen(*p)).collect();
        painter.add(egui::Shape::closed_line(corners, Stroke::new(1.5, MOVE)));
        let middle = outline.iter().sum::<DVec3>() / outline.len() as f64;
        let tip = middle + arrow * normal;
        let (Some(at), Some(end)) = (on_screen(middle), on_screen(tip)) else {
            continue;
        };
        painter.arrow(at, end - at, Stroke::new(1.5, LEAN));
        if let Some(drag) = handle(ui, (n, "move"), at, MOVE) {
            // Along the normal, as far as the pointer went along its picture.
            let along = end - at;
            let part = f64::from(drag.dot(along) / along.length_sq().max(1.0));
            plane.point = (middle + part * arrow * normal).to_array();
            changed = true;
        }
        if let Some(drag) = handle(ui, (n, "lean"), end, LEAN) {
            let depth = view.camera.depth(tip).max(1e-9);
            let unit = 2.0 * view.camera.half_height(depth) / f64::from(rect.height());
            let moved = tip
                + unit
                    * (f64::from(drag.x) * view.camera.right - f64::from(drag.y) * view.camera.up);
            plane.normal = (moved - middle).normalize_or(normal).to_array();
            plane.point = middle.to_array();
            changed = true;
        }
    }
    changed.then_some(planes)
}

/// A handle; how far it was dragged in this frame.
fn handle(ui: &mut Ui, (n, what): (usize, &str), at: Pos2, color: Color32) -> Option<egui::Vec2> {
    let place = Rect::from_center_size(at, vec2(2.0 * HANDLE, 2.0 * HANDLE));
    let response = ui.interact(place, ui.scope_id().with(("clip", n, what)), Sense::drag());
    response.widget_info(|| {
        let name = format!("{what} plane {}", n + 1);
        egui::WidgetInfo::labeled(egui::Role::Slider, true, name)
    });
    let is_on = response.hovered() || response.dragged();
    let radius = if is_on { HANDLE } else { 0.7 * HANDLE };
    ui.painter()
        .circle(at, radius, color, Stroke::new(1.0, Color32::WHITE));
    let response = response.on_hover_cursor(egui::CursorIcon::Grab);
    (response.dragged() && response.drag_delta() != egui::Vec2::ZERO).then(|| response.drag_delta())
}

/// Corners of a plane's section through the model's box, in order around it.
fn outline(view: &View, point: DVec3, normal: DVec3) -> Vec<DVec3> {
    let corners = &view.world.corners;
    let height = |c: usize| (corners[c] - point).dot(normal);
    let mut cuts = Vec::new();
    for a in 0..8 {
        for axis in 0..3 {
            let b = a | 1 << axis;
            let (low, high) = (height(a), height(b));
            if a != b && (low < 0.0) != (high < 0.0) {
                cuts.push(corners[a].lerp(corners[b], low / (low - high)));
            }
        }
    }
    let middle = cuts.iter().sum::<DVec3>() / cuts.len().max(1) as f64;
    let across = normal.any_orthonormal_vector();
    let up = normal.cross(across);
    let angle = |p: &DVec3| (*p - middle).dot(up).atan2((*p - middle).dot(across));
    cuts.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    cuts
}
