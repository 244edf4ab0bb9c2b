//! Selected cells in the picture: their edges, each in the color of its curve.

use std::sync::Arc;

use eframe::egui::{Color32, Rect, Stroke, Ui, vec2};
use glam::DVec2;

use crate::case::Case;
use crate::picture::{cell_edges, mark_color};
use crate::scene::Scene;
use crate::view::View;

/// Color of the selected cell at a place in a list of `count`.
pub fn color(n: usize, count: usize) -> Color32 {
    let [r, g, b] = mark_color(n, count);
    Color32::from_rgb(r, g, b)
}

/// Draws the edges of the selected cells over the picture.
pub fn show(
    ui: &Ui,
    rect: Rect,
    shown: &View,
    scene: &Scene,
    case: &Arc<Case>,
    selected: &[[usize; 3]],
) {
    let pixels = [rect.width().max(1.0) as u32, rect.height().max(1.0) as u32];
    let Ok(view) = shown.seen_from(&scene.camera, pixels) else {
        return;
    };
    let size = DVec2::new(f64::from(rect.width()), f64::from(rect.height()));
    let painter = ui.painter_at(rect);
    let grid = &case.in_space(view.world.space).grid;
    for (n, cell) in selected.iter().enumerate() {
        // A case that was read again may be smaller.
        let Some(cell) = grid.dims().one_based(*cell) else {
            continue;
        };
        for line in cell_edges(&view, grid, cell, size) {
            let line = line.map(|at| rect.min + vec2(at.x as f32, at.y as f32));
            // A light seam keeps the line apart from what is behind it.
            painter.line_segment(line, Stroke::new(3.5, Color32::from_white_alpha(160)));
            painter.line_segment(line, Stroke::new(1.8, color(n, selected.len())));
        }
    }
}
