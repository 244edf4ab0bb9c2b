//! What stands beside the volume of each picture in the window: title, legend and facts, laid out and worded as in
//! saved pictures.

use std::sync::Arc;

use eframe::egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, pos2};
use glam::DVec2;

use super::overlay::{TEXT, ink, place, size, width, write};
use crate::case::Case;
use crate::picture::{
    Annotations, Area, GROUND, Info, Key, LINE, Layout, Legend, LegendWidths, Length, Parts, cut,
};
use crate::scene::Show;
use crate::view::View;

/// Text height; the unit of the layout.
const UNIT: f64 = TEXT as f64;
/// Widths of a legend in text heights before there is a picture: those of most.
const LEGEND: LegendWidths = LegendWidths {
    full: 8.0 * UNIT,
    narrow: 6.0 * UNIT,
};

/// A picture's place in the window, and where its parts are in that.
#[derive(Clone)]
pub struct Page {
    place: Rect,
    layout: Layout,
}

/// A view that is shown, and the case that it is of.
pub type ShownView = (Arc<View>, Arc<Case>);

impl Page {
    /// Where it is in the window.
    pub fn place(&self) -> Rect {
        self.place
    }

    /// Where the volume is.
    pub fn volume(&self) -> Rect {
        self.part(self.layout.volume)
    }

    fn part(&self, [low, high]: Area) -> Rect {
        Rect::from_min_max(place(self.place, low), place(self.place, high))
    }
}

/// The parts of two pictures in their places, all of one size; where both have the same place, that has two legends
/// if they differ.
pub fn laid_out(
    painter: &Painter,
    places: [Option<Rect>; 2],
    shown: &[Option<ShownView>; 2],
    show: &Show,
) -> [Option<Page>; 2] {
    let parts = shown.each_ref().map(|shown| {
        let (view, case) = shown.as_ref()?;
        let annotations = Annotations::of(case, view);
        let width = |text: &str| width(painter, text);
        let key = annotations.key(view, UNIT, &width);
        let height = places[0].map_or(0.0, |p| f64::from(p.height()));
        Some(annotations.parts(view, &key, height))
    });
    let usual = Parts {
        title: show.legend,
        info: show.info.then_some(Length::Usual),
        legend: show.legend.then_some(LEGEND),
        left_legend: None,
    };
    let mut all = parts[0].or(parts[1]).unwrap_or(usual);
    if let [_, Some(second)] = &parts {
        all.legend = widest([all.legend, second.legend]);
    }
    if places[0] == places[1]
        && let [Some(first), Some(second)] = shown
        && !have_one_legend([first, second])
    {
        all.left_legend = all.legend;
    }
    places.map(|place| {
        let place = place?;
        let layout = Layout::of(size(place).floor(), UNIT, &all);
        Some(Page { place, layout })
    })
}

fn widest(legends: [Option<LegendWidths>; 2]) -> Option<LegendWidths> {
    legends.into_iter().flatten().reduce(|a, b| LegendWidths {
        full: a.full.max(b.full),
        narrow: a.narrow.max(b.narrow),
    })
}

/// True where the legend of one of two pictures is that of the other.
fn have_one_legend([(a, _), (b, _)]: [&ShownView; 2]) -> bool {
    a.shown.property == b.shown.property && a.style.transfer == b.style.transfer
}

/// Draws what stands beside the volume of a picture: a title of its own or the given one, with what it does not
/// share with a second picture at its end.
pub fn draw(painter: &Painter, page: &Page, shown: &ShownView, title: Option<&str>, own: &str) {
    let (view, case) = shown;
    let annotations = Annotations::of(case, view);
    ground(painter, page, view);
    let left = match title {
        Some(title) => [title, ""],
        None => [annotations.title.as_str(), annotations.when.as_str()],
    };
    let title = left.concat();
    // What the title has already is not said twice.
    let is_said = own.split("   ").all(|fact| title.contains(fact));
    let right = if is_said { "" } else { own };
    titles(painter, page, view, left, right);
    let width = |text: &str| width(painter, text);
    let key = annotations.key(view, UNIT, &width);
    let cube = annotations.cube_key(view, &key);
    for (key, strip) in [
        (Some(&key), page.layout.legend),
        (cube.as_ref(), page.layout.left_legend),
    ] {
        if let (Some(key), Some(strip)) = (key, strip) {
            legend(painter, page, strip, view, key);
        }
    }
    if let (Some([low, high]), Some(info)) = (page.layout.info, &annotations.info) {
        facts(painter, page, view, [low.x, high.x], info);
    }
}

/// The same for two pictures in one place: at the left what is of the first one, of which the left part is seen,
/// and at the right what is of the second.
pub fn draw_shared(painter: &Painter, page: &Page, shown: [&ShownView; 2], own: &[String; 2]) {
    let annotations = shown.map(|(view, case)| Annotations::of(case, view));
    let view = &shown[0].0;
    ground(painter, page, view);
    let first = match own[0].is_empty() {
        true => &annotations[0].title,
        false => &own[0],
    };
    titles(painter, page, view, [first, ""], &own[1]);
    let strips = [page.layout.left_legend, page.layout.legend];
    for (n, strip) in strips.into_iter().enumerate() {
        if let Some(strip) = strip {
            let width = |text: &str| width(painter, text);
            let view = &shown[n].0;
            let key = annotations[n].key(view, UNIT, &width);
            legend(painter, page, strip, view, &key);
        }
    }
    if let Some([low, high]) = page.layout.info {
        let middle = 0.5 * (low.x + high.x);
        let halves = [[low.x, middle], [middle, high.x]];
        for (half, annotations) in halves.into_iter().zip(&annotations) {
            if let Some(info) = &annotations.info {
                facts(painter, page, view, half, info);
            }
        }
    }
}

/// The background of the volume goes on around it.
fn ground(painter: &Painter, page: &Page, view: &View) {
    let [r, g, b] = view.style.background.map(|v| (255.0 * v).round() as u8);
    painter.rect_filled(page.place, 0.0, Color32::from_rgb(r, g, b));
}

/// Writes a title at the left, cut where there is no room, and one at the right.
/// Writes a title at the left, of two parts of which only the first becomes shorter where there is no room, and what
/// is of a second picture at the right.
fn titles(painter: &Painter, page: &Page, view: &View, [left, end]: [&str; 2], right: &str) {
    let Some(area) = page.layout.title.map(|t| page.part(t)) else {
        return;
    };
    let margin = TEXT;
    let font = FontId::proportional(1.15 * TEXT);
    let ink = ink(view);
    let width = |text: &str| {
        let galley = painter.layout_no_wrap(text.to_owned(), font.clone(), ink);
        f64::from(galley.size().x)
    };
    let room = f64::from(area.width() - 2.0 * margin);
    let right = cut(right, room, &width);
    let taken = if right.is_empty() {
        0.0
    } else {
        width(&right) + UNIT
    };
    let left = cut(left, room - taken - width(end), &width) + end;
    let y = area.center().y;
    let ends = [
        (pos2(area.left() + margin, y), Align2::LEFT_CENTER, left),
        (pos2(area.right() - margin, y), Align2::RIGHT_CENTER, right),
    ];
    for (at, align, text) in ends {
        painter.text(at, align, text, font.clone(), ink);
    }
}

/// Writes facts between two edges of the strip at the bottom.
fn facts(painter: &Painter, page: &Page, view: &View, [left, right]: [f64; 2], info: &Info) {
    let Some(area) = page.layout.info.map(|i| page.part(i)) else {
        return;
    };
    let width = |text: &str| width(painter, text);
    let (count, is_dated) = (page.layout.info_lines, page.layout.title.is_some());
    let lines = info.lines(right - left - 2.0 * UNIT, count, is_dated, &width);
    for (n, line) in lines.iter().enumerate() {
        let y = (0.3 + LINE * n as f64) * UNIT;
        let at = pos2(
            page.place.left() + (left + UNIT) as f32,
            area.top() + y as f32,
        );
        painter.text(
            at,
            Align2::LEFT_TOP,
            line,
            FontId::proportional(TEXT),
            ink(view),
        );
    }
}

fn legend(painter: &Painter, page: &Page, strip: Area, view: &View, key: &Key<'_>) {
    draw_legend(
        painter,
        page.place,
        &key.laid_out(strip, page.layout.is_narrow),
        ink(view),
    );
}

fn draw_legend(painter: &Painter, rect: Rect, legend: &Legend, ink: Color32) {
    let part = |[low, high]: &Area| Rect::from_min_max(place(rect, *low), place(rect, *high));
    painter.rect_filled(part(&legend.ground), 0.0, ink.gamma_multiply(GROUND as f32));
    let mut mesh = eframe::egui::Mesh::default();
    for (area, [r, g, b]) in &legend.blocks {
        mesh.add_colored_rect(part(area), Color32::from_rgb(*r, *g, *b));
    }
    for area in &legend.opacities {
        mesh.add_colored_rect(part(area), ink.gamma_multiply(0.4));
    }
    painter.add(mesh);
    for ends in &legend.strokes {
        let ends: [Pos2; 2] = ends.map(|at: DVec2| place(rect, at));
        painter.line_segment(ends, Stroke::new(1.0, ink.gamma_multiply(0.8)));
    }
    for text in &legend.texts {
        write(painter, rect, text, ink);
    }
}
