//! The opacity curve over the histogram of what is drawn: points to move by pointer or keyboard.

use std::sync::{Arc, Weak};

use eframe::egui::{
    self, Color32, Id, Key, Modifiers, Pos2, Rect, Response, Sense, Stroke, Ui, vec2,
};

use super::controls::significant;
use crate::case::Measure;
use crate::model::CellField;
use crate::view::View;
use crate::viewer::overlay;

const BINS: usize = 64;
/// Points nearer than this to the pointer are taken, in points of the screen.
const GRIP: f32 = 10.0;
/// How far an arrow key moves a point.
const NUDGE: f64 = 0.01;
/// Height of the curve, and of the strip of colors below it.
const HEIGHTS: [f32; 2] = [120.0, 10.0];
/// Room left of the curve and right of it.
const ENDS: egui::Vec2 = vec2(5.0, 0.0);
const HELP: &str = "Drag points, double-click to add one, right-click to remove one. With the keyboard: arrows choose a point, Shift and arrows move it, Insert adds one, Delete removes it";

/// Draws the curve and lets it be changed; true where it was.
pub fn show(ui: &mut Ui, view: &View, measure: &Measure, points: &mut Vec<[f64; 2]>) -> bool {
    let [curve, strip] = HEIGHTS.map(|height| vec2(ui.available_width(), height));
    let (whole, response) = ui.allocate_exact_size(curve, Sense::click_and_drag());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Canvas, ui.is_enabled(), "opacity curve")
    });
    // Room for points at both ends.
    let rect = whole.shrink2(ENDS);
    let painter = ui.painter_at(whole);
    painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    let (strip, _) = ui.allocate_exact_size(strip, Sense::hover());
    overlay::color_bar(ui.painter(), strip.shrink2(ENDS), |p| {
        view.style.transfer.srgb(p)
    });
    histogram(&painter, rect, &bins(ui, response.id, view), view);
    let chosen_id = response.id.with("chosen");
    let mut chosen: usize = ui.data(|d| d.get_temp(chosen_id)).unwrap_or(0);
    let by_pointer = pointed(ui, &response, rect, points, &mut chosen);
    let by_key = response.has_focus() && typed(ui, &response, points, &mut chosen);
    chosen = chosen.min(points.len().saturating_sub(1));
    ui.data_mut(|d| d.insert_temp(chosen_id, chosen));
    draw(ui, rect, points, response.has_focus().then_some(chosen));
    let tells = response.dragged() || response.has_focus();
    match points.get(chosen).filter(|_| tells) {
        Some(point) => tip(ui, rect, view, measure, *point),
        None => {
            response.on_hover_text(HELP);
        }
    }
    by_pointer || by_key
}

/// Where a point of the curve is on the screen.
fn place(rect: Rect, point: [f64; 2]) -> Pos2 {
    rect.lerp_inside(vec2(point[0] as f32, 1.0 - point[1] as f32))
}

fn draw(ui: &Ui, rect: Rect, points: &[[f64; 2]], chosen: Option<usize>) {
    let visuals = ui.visuals();
    let ink = visuals.text_color();
    let painter = ui.painter_at(rect.expand(6.0));
    let line: Vec<Pos2> = points.iter().map(|p| place(rect, *p)).collect();
    // Before the first point and after the last one the curve is level.
    let ends = [line.first(), line.last()].map(|p| p.map_or(rect.bottom(), |p| p.y));
    let start = Pos2::new(rect.left(), ends[0]);
    let end = Pos2::new(rect.right(), ends[1]);
    let whole = std::iter::once(start).chain(line.iter().copied());
    painter.line(whole.chain([end]).collect(), Stroke::new(2.0, ink));
    for (n, point) in line.iter().enumerate() {
        let fill = match chosen == Some(n) {
            true => visuals.selection.stroke.color,
            false => visuals.extreme_bg_color,
        };
        painter.circle(*point, 4.0, fill, Stroke::new(2.0, ink));
    }
    if chosen.is_some() {
        let stroke = visuals.selection.stroke;
        painter.rect_stroke(rect, 2.0, stroke, egui::StrokeKind::Inside);
    }
}

/// Tells the value and the opacity of a point.
fn tip(ui: &Ui, rect: Rect, view: &View, measure: &Measure, point: [f64; 2]) {
    let [low, high] = view.style.transfer.range;
    let value = measure.show(view.true_value(low + (high - low) * point[0]));
    let text = format!("{} {}", significant(value), measure.unit);
    let text = format!("{}: opacity {:.2}", text.trim_end(), point[1]);
    let at = place(rect, point);
    // Above the point, on the side where there is room.
    let right = at.x < rect.center().x;
    let at = at + vec2(if right { 6.0 } else { -150.0 }, -32.0);
    let at = at.clamp(rect.min + vec2(4.0, 4.0), rect.max - vec2(4.0, 20.0));
    overlay::tip(ui, at, &text);
}

/// Numbers of drawn cells by position in the range, and what they were counted of, which may be gone.
#[derive(Clone)]
struct Counted {
    field: Weak<CellField>,
    drawn: Weak<Vec<bool>>,
    range: [f64; 2],
    bins: Arc<[u32]>,
}

/// The histogram, counted anew only where field, selection or range changed.
fn bins(ui: &Ui, id: Id, view: &View) -> Arc<[u32]> {
    let id = id.with("histogram");
    let range = view.style.transfer.range;
    let known: Option<Counted> = ui.data(|d| d.get_temp(id));
    let is_same = |c: &Counted| {
        std::ptr::eq(c.field.as_ptr(), Arc::as_ptr(&view.shown.cells.field))
            && std::ptr::eq(c.drawn.as_ptr(), Arc::as_ptr(&view.shown.cells.drawn))
            && c.range == range
    };
    if let Some(known) = known.filter(is_same) {
        return known.bins;
    }
    let counted = Counted {
        field: Arc::downgrade(&view.shown.cells.field),
        drawn: Arc::downgrade(&view.shown.cells.drawn),
        range,
        bins: count(
            view.shown.cells.field.values(),
            &view.shown.cells.drawn,
            range,
        )
        .into(),
    };
    let bins = counted.bins.clone();
    ui.data_mut(|d| d.insert_temp(id, counted));
    bins
}

fn count(values: &[f32], drawn: &[bool], [low, high]: [f64; 2]) -> [u32; BINS] {
    let mut bins = [0u32; BINS];
    let scale = BINS as f64 / (high - low).max(1e-30);
    for (value, _) in values.iter().zip(drawn).filter(|(_, drawn)| **drawn) {
        let at = (f64::from(*value) - low) * scale;
        // Values outside the range, and NaN, are in no bin.
        if (0.0..=BINS as f64).contains(&at) {
            bins[(at as usize).min(BINS - 1)] += 1;
        }
    }
    bins
}

fn histogram(painter: &egui::Painter, rect: Rect, bins: &[u32], view: &View) {
    // By the root, so that few cells are seen beside many.
    let most = f64::from(bins.iter().copied().max().unwrap_or(1).max(1)).sqrt();
    for (n, count) in bins.iter().enumerate() {
        let part = |n: usize| n as f32 / BINS as f32;
        let height = (f64::from(*count).sqrt() / most) as f32;
        let bar = Rect::from_min_max(
            rect.lerp_inside(vec2(part(n), 1.0 - height)),
            rect.lerp_inside(vec2(part(n + 1), 1.0)),
        );
        let color = view.style.transfer.srgb((n as f64 + 0.5) / BINS as f64);
        let [r, g, b] = color.map(|v| (255.0 * v) as u8);
        painter.rect_filled(bar, 0.0, Color32::from_rgb(r, g, b));
    }
}

/// Lets the pointer change the points; true where it did.
fn pointed(
    ui: &Ui,
    response: &Response,
    rect: Rect,
    points: &mut Vec<[f64; 2]>,
    chosen: &mut usize,
) -> bool {
    let id = response.id.with("grabbed");
    let Some(pointer) = response.interact_pointer_pos() else {
        ui.data_mut(|d| d.remove::<usize>(id));
        return false;
    };
    let part = (pointer - rect.min) / rect.size();
    let at = [part.x, 1.0 - part.y].map(|v| f64::from(v.clamp(0.0, 1.0)));
    // A drag begins some way from where the button went down.
    let pressed = ui.input(|i| i.pointer.press_origin());
    let aimed = pressed
        .filter(|_| response.drag_started())
        .unwrap_or(pointer);
    let distance = |n: &usize| place(rect, points[*n]).distance(aimed);
    let nearest = (0..points.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
    let nearest = nearest.filter(|n| distance(n) < GRIP);
    if response.clicked() || response.drag_started() {
        response.request_focus();
        *chosen = nearest.unwrap_or(*chosen);
    }
    if response.double_clicked() && nearest.is_none() {
        *chosen = insert(points, at);
        return true;
    }
    if response.secondary_clicked() {
        return nearest.is_some_and(|n| remove(points, n));
    }
    if let Some(n) = nearest.filter(|_| response.drag_started()) {
        ui.data_mut(|d| d.insert_temp(id, n));
    }
    let grabbed: Option<usize> = ui.data(|d| d.get_temp(id));
    match grabbed.filter(|n| *n < points.len() && response.dragged()) {
        Some(n) => move_to(points, n, at),
        None => false,
    }
}

/// Lets the keyboard change the points; true where it did.
fn typed(ui: &Ui, response: &Response, points: &mut Vec<[f64; 2]>, chosen: &mut usize) -> bool {
    let filter = egui::EventFilter {
        horizontal_arrows: true,
        vertical_arrows: true,
        ..Default::default()
    };
    ui.memory_mut(|m| m.set_focus_lock_filter(response.id, filter));
    let pressed = |modifiers, key| ui.input_mut(|i| i.consume_key(modifiers, key));
    let mut changed = false;
    // With Shift first: without it, keys count whether Shift is held or not.
    for (key, by) in [
        (Key::ArrowLeft, [-NUDGE, 0.0]),
        (Key::ArrowRight, [NUDGE, 0.0]),
        (Key::ArrowDown, [0.0, -NUDGE]),
        (Key::ArrowUp, [0.0, NUDGE]),
    ] {
        if pressed(Modifiers::SHIFT, key)
            && let Some([x, y]) = points.get(*chosen).copied()
        {
            changed |= move_to(points, *chosen, [x + by[0], y + by[1]]);
        }
    }
    if pressed(Modifiers::NONE, Key::ArrowLeft) {
        *chosen = chosen.saturating_sub(1);
    }
    if pressed(Modifiers::NONE, Key::ArrowRight) {
        *chosen = (*chosen + 1).min(points.len().saturating_sub(1));
    }
    if pressed(Modifiers::NONE, Key::Delete) {
        changed |= remove(points, *chosen);
    }
    if pressed(Modifiers::NONE, Key::Insert)
        && let Some(between) = halfway(points, *chosen)
    {
        *chosen = insert(points, between);
        changed = true;
    }
    changed
}

/// Adds a point; its number.
fn insert(points: &mut Vec<[f64; 2]>, at: [f64; 2]) -> usize {
    let after = points.partition_point(|p| p[0] <= at[0]);
    points.insert(after, at);
    after
}

/// Takes a point away, unless it is the only one.
fn remove(points: &mut Vec<[f64; 2]>, n: usize) -> bool {
    let may = points.len() > 1 && n < points.len();
    if may {
        points.remove(n);
    }
    may
}

/// Halfway from a point to the next one, of the last one to the end of the range.
fn halfway(points: &[[f64; 2]], n: usize) -> Option<[f64; 2]> {
    let [x, y] = *points.get(n)?;
    let next = points.get(n + 1).copied().unwrap_or([1.0, y]);
    Some([0.5 * (x + next[0]), 0.5 * (y + next[1])])
}

/// Moves a point, not past its neighbors; true where it moved.
fn move_to(points: &mut [[f64; 2]], n: usize, [x, y]: [f64; 2]) -> bool {
    let low = n.checked_sub(1).map_or(0.0, |before| points[before][0]);
    let high = points.get(n + 1).map_or(1.0, |p| p[0]);
    let to = [x.max(low).min(high), y.clamp(0.0, 1.0)];
    let moved = points[n] != to;
    points[n] = to;
    moved
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_drawn_cells_within_the_range_are_counted() {
        let values = [0.0, 0.5, 1.0, 1.5, f32::NAN, 0.5];
        let drawn = [true, true, true, true, true, false];
        let bins = count(&values, &drawn, [0.0, 1.0]);
        assert_eq!(bins.iter().sum::<u32>(), 3);
        assert_eq!((bins[0], bins[BINS / 2], bins[BINS - 1]), (1, 1, 1));
        assert_eq!(count(&values, &[true; 6], [0.0, 1.0])[BINS / 2], 2);
        assert_eq!(
            count(&values, &[true; 6], [0.5, 0.5]).iter().sum::<u32>(),
            2
        );
    }

    #[test]
    fn points_stay_in_order() {
        let mut points = vec![[0.0, 0.1], [0.5, 0.5], [1.0, 0.9]];
        assert!(move_to(&mut points, 1, [2.0, -1.0]));
        assert_eq!(points[1], [1.0, 0.0]);
        assert!(!move_to(&mut points, 1, [1.5, 0.0]));
        assert_eq!(insert(&mut points, [0.3, 0.2]), 1);
        assert_eq!(halfway(&points, 0), Some([0.5 * 0.3, 0.5 * (0.1 + 0.2)]));
        assert!(remove(&mut points, 3) && points.len() == 3);
        let mut one = vec![[0.5, 0.5]];
        assert!(!remove(&mut one, 0) && !remove(&mut one, 7));
        assert_eq!(halfway(&one, 0), Some([0.75, 0.5]));
        assert_eq!(halfway(&one, 1), None);
        assert!(points.is_sorted_by(|a, b| a[0] <= b[0]));
    }
}
