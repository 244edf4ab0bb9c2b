//! Two handles on one strip, over a histogram where there is one.

use eframe::egui::{
    self, Color32, CursorIcon, Key, Pos2, Rect, Response, Sense, Stroke, Ui, WidgetInfo, vec2,
};

/// Width of a handle, in points.
const HANDLE: f32 = 9.0;
/// Part of the strip that an arrow key moves a handle.
const NUDGE: f64 = 0.01;

/// A range between two handles, as parts of the strip from 0 to 1.
pub struct RangeSlider<'a> {
    /// What the handles are called: `Smallest SOIL`, `Largest SOIL`.
    pub names: [String; 2],
    /// Values at the handles, for people who do not see them.
    pub values: [f64; 2],
    /// Heights of the bars, the highest 1; no histogram where empty.
    pub bars: &'a [f32],
    /// What lies outside the handles is kept, not what lies between.
    pub inverted: bool,
    /// Height of the strip, in points.
    pub height: f32,
    /// Width of the strip, in points.
    pub width: f32,
    /// Part of the strip that an arrow key moves a handle; a hundredth where absent.
    pub nudge: Option<f64>,
}

impl RangeSlider<'_> {
    /// Draws it; true where a handle was moved.
    pub fn show(self, ui: &mut Ui, parts: &mut [f64; 2]) -> bool {
        // A click moves the nearest handle; the focus goes to the handles, which have names.
        let (place, strip) = ui.allocate_exact_size(vec2(self.width, self.height), Sense::CLICK);
        let rail = place.shrink2(vec2(0.5 * HANDLE, 0.0));
        let before = *parts;
        if let Some(at) = strip.interact_pointer_pos().filter(|_| strip.clicked()) {
            let part = part_at(rail, at);
            let nearest = usize::from((part - parts[0]).abs() > (part - parts[1]).abs());
            parts[nearest] = part;
        }
        let handles = [0, 1].map(|n| self.handle(ui, rail, &strip, parts, n));
        if ui.is_rect_visible(place) {
            self.paint(ui, rail, *parts, &handles);
        }
        *parts != before
    }

    /// Moves a handle as it is dragged or nudged; the other one gives way.
    fn handle(
        &self,
        ui: &Ui,
        rail: Rect,
        strip: &Response,
        parts: &mut [f64; 2],
        n: usize,
    ) -> Response {
        let x = rail.left() + parts[n] as f32 * rail.width();
        let size = vec2(HANDLE, rail.height());
        // Side by side where both are at one place, so that each can be caught.
        let aside = if n == 0 { -0.5 } else { 0.5 } * HANDLE;
        let center = egui::pos2(x + 0.5 * aside, rail.center().y);
        let place = Rect::from_center_size(center, size);
        let response = ui.interact(place, strip.id.with(n), Sense::click_and_drag());
        let (value, name) = (self.values[n], self.names[n].clone());
        let is_enabled = ui.is_enabled();
        response.widget_info(|| WidgetInfo::slider(is_enabled, value, &name));
        let mut moved = None;
        if let Some(at) = response
            .interact_pointer_pos()
            .filter(|_| response.dragged())
        {
            moved = Some(part_at(rail, at));
        }
        if response.has_focus() {
            let by = self.nudge.unwrap_or(NUDGE);
            let pressed = |key: Key| ui.input(|i| i.num_presses(key)) as f64;
            let steps = pressed(Key::ArrowRight) - pressed(Key::ArrowLeft);
            if steps != 0.0 {
                moved = Some(parts[n] + steps * by);
            }
        }
        if let Some(part) = moved {
            parts[n] = part.clamp(0.0, 1.0);
            parts[1 - n] = match n {
                0 => parts[1].max(parts[0]),
                _ => parts[0].min(parts[1]),
            };
        }
        response.on_hover_cursor(CursorIcon::ResizeHorizontal)
    }

    fn paint(&self, ui: &Ui, rail: Rect, parts: [f64; 2], handles: &[Response; 2]) {
        let visuals = ui.visuals();
        let painter = ui.painter();
        let kept = |part: f64| (parts[0] <= part && part <= parts[1]) != self.inverted;
        let colors = [
            visuals.weak_text_color().gamma_multiply(0.45),
            visuals.selection.bg_fill,
        ];
        let color = |part: f64| colors[usize::from(kept(part))];
        let count = self.bars.len();
        for (n, bar) in self.bars.iter().enumerate() {
            let part = |at: f32| (n as f32 + at) / count as f32;
            let [left, right] = [0.0, 1.0].map(|at| rail.left() + part(at) * rail.width());
            let top = rail.bottom() - 3.0 - bar * (rail.height() - 5.0);
            let place =
                Rect::from_min_max(Pos2::new(left, top), Pos2::new(right, rail.bottom() - 3.0));
            painter.rect_filled(place, 0.0, color(f64::from(part(0.5))));
        }
        let y = if count > 0 {
            rail.bottom() - 1.5
        } else {
            rail.center().y
        };
        let x = |part: f64| rail.left() + part as f32 * rail.width();
        let ends = [0.0, parts[0], parts[1], 1.0];
        for (n, pair) in ends.windows(2).enumerate() {
            let is_kept = (n == 1) != self.inverted;
            let stroke = Stroke::new(3.0, colors[usize::from(is_kept)]);
            painter.line_segment([Pos2::new(x(pair[0]), y), Pos2::new(x(pair[1]), y)], stroke);
        }
        for (n, handle) in handles.iter().enumerate() {
            let style = ui.style().interact(handle);
            let shape = Rect::from_center_size(
                Pos2::new(x(parts[n]), rail.center().y),
                vec2(6.0, rail.height()),
            );
            let fill = if style.bg_fill == Color32::TRANSPARENT {
                visuals.window_fill
            } else {
                style.bg_fill
            };
            painter.rect(shape, 2.0, fill, style.fg_stroke, egui::StrokeKind::Inside);
        }
    }
}

fn part_at(rail: Rect, at: Pos2) -> f64 {
    f64::from(((at.x - rail.left()) / rail.width().max(1.0)).clamp(0.0, 1.0))
}
