//! All properties of the selected cells: a table that scrolls both ways, its heads and names staying in view.

use eframe::egui::{Align2, FontId, Label, Rect, RichText, ScrollArea, TextStyle, Ui, pos2, vec2};

use super::controls::significant;
use crate::case::Units;
use crate::viewer::marks;
use crate::viewer::reader::Table;

/// Points of a row, of the column with names, and of that of a cell.
const ROW: f32 = 18.0;
const NAMES: f32 = 104.0;
const CELL: f32 = 76.0;
/// Points of the table's height, at most.
const MOST: f32 = 240.0;

/// Draws the table, the property shown first.
pub fn show(ui: &mut Ui, table: &Table, shown: Option<&str>, units: Units) {
    let mut rows: Vec<_> = table.rows.iter().collect();
    rows.sort_by_key(|row| Some(row.0.as_str()) != shown);
    let cells = &table.of.cells;
    let size = vec2(
        NAMES + CELL * cells.len() as f32,
        ROW * (1 + rows.len()) as f32,
    );
    let area = ScrollArea::both()
        .id_salt("values of the selected cells")
        .max_height(MOST)
        .auto_shrink([false, true]);
    area.show_viewport(ui, |ui, viewport| {
        ui.set_min_size(size);
        let (origin, seen) = (ui.max_rect().min, ui.clip_rect());
        let place = |column: usize, row: usize| {
            let from = vec2(NAMES + CELL * column as f32, ROW * row as f32);
            Rect::from_min_size(origin + from, vec2(CELL, ROW))
        };
        let first = ((viewport.left() - NAMES) / CELL).max(0.0) as usize;
        let columns = first
            ..cells
                .len()
                .min(first + 2 + (viewport.width() / CELL) as usize);
        let first = (viewport.top() / ROW) as usize;
        let lines = first
            ..rows
                .len()
                .min(first + 2 + (viewport.height() / ROW) as usize);
        for n in lines.clone() {
            let measure = table.of.case.measure(&rows[n].0, units);
            for column in columns.clone() {
                let value = rows[n].2.get(column).copied().flatten();
                let text = value.map_or("-".into(), |v| significant(measure.show(f64::from(v))));
                ui.put(place(column, 1 + n), Label::new(text).truncate());
            }
        }
        let ground = ui.visuals().panel_fill;
        let names = seen.with_max_x(seen.left() + NAMES);
        ui.painter().rect_filled(names, 0.0, ground);
        for n in lines {
            let name = &rows[n].0;
            let unit = table.of.case.measure(name, units).unit;
            let at =
                Rect::from_min_size(pos2(names.left(), place(0, 1 + n).top()), vec2(NAMES, ROW));
            let text = format!("{name} {unit}");
            let text = RichText::new(text.trim_end());
            let text = if Some(name.as_str()) == shown {
                text.strong()
            } else {
                text
            };
            ui.put(at, Label::new(text).truncate());
        }
        let heads = seen.with_max_y(seen.top() + ROW);
        ui.painter().rect_filled(heads, 0.0, ground);
        for column in columns {
            let at = pos2(place(column, 0).left(), heads.top());
            let at = Rect::from_min_size(at, vec2(CELL, ROW));
            let cell = table.of.case.grid.name_of(cells[column]);
            let [i, j, k] = cell.ijk;
            let text =
                RichText::new(format!("{i}, {j}, {k}")).color(marks::color(column, cells.len()));
            ui.put(at, Label::new(text).truncate())
                .on_hover_text(cell.to_string());
        }
        let corner = heads.with_max_x(names.right());
        ui.painter().rect_filled(corner, 0.0, ground);
        let font = TextStyle::Body.resolve(ui.style());
        head(ui, corner, font);
    });
}

/// What the heads are.
fn head(ui: &Ui, corner: Rect, font: FontId) {
    let ink = ui.visuals().weak_text_color();
    let at = corner.left_center();
    ui.painter()
        .text(at, Align2::LEFT_CENTER, "I, J, K", font, ink);
}
