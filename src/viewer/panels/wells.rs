//! The wells of the step: kind and state, which ones are drawn, and the cells that they are connected to.

use eframe::egui::{self, Color32, Role, ScrollArea, Sense, Ui, WidgetInfo, vec2};

use super::PanelContext;
use super::controls::{Choice, one_of};
use crate::case::{Well, WellKind};
use crate::model::Ijk;
use crate::scene::names::matches;
use crate::scene::{Filter, Show, ShownWells};
use crate::view::wells::well_color;
use crate::viewer::action::Action;
use crate::viewer::orbit;

/// Height of the list, in points.
const LIST: f32 = 220.0;
/// Kinds in the order of the list.
const KINDS: [WellKind; 6] = [
    WellKind::Producer,
    WellKind::WaterInjector,
    WellKind::GasInjector,
    WellKind::OilInjector,
    WellKind::Unknown,
    WellKind::Path,
];

/// Which wells the user looks for.
#[derive(Debug, Clone, Default)]
struct Sought {
    text: String,
    kind: Option<WellKind>,
    is_open: Option<bool>,
}

impl Sought {
    fn fits(&self, well: &Well) -> bool {
        let text = self.text.trim();
        let is_named = match text.contains(['*', '?']) {
            true => matches(text, &well.name),
            false => well.name.to_lowercase().contains(&text.to_lowercase()),
        };
        is_named
            && self.kind.is_none_or(|kind| kind == well.kind)
            && self.is_open.is_none_or(|is_open| is_open == well.is_open)
    }
}

pub fn show(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    if about.case.about.wells.is_empty() {
        ui.weak("The files name no wells. Files with paths (.dev) and decks can be dropped on the window.");
        return;
    }
    let Some(wells) = about.wells else {
        ui.weak("The wells of this step are being read.");
        return;
    };
    let id = ui.scope_id().with("sought");
    let mut sought: Sought = ui.data(|d| d.get_temp(id)).unwrap_or_default();
    search(ui, wells, &mut sought);
    let found: Vec<&Well> = wells.iter().filter(|well| sought.fits(well)).collect();
    let mut shown = about.scene.show.wells.clone();
    buttons(ui, about, &found, &mut shown, actions);
    ScrollArea::vertical()
        .max_height(LIST)
        .auto_shrink([false, true])
        .show(ui, |ui| {
            for well in &found {
                row(ui, about, well, &mut shown, actions);
            }
        });
    let part = match found.len() == wells.len() {
        true => format!("{} wells at this step", wells.len()),
        false => format!("{} of {} wells at this step", found.len(), wells.len()),
    };
    ui.weak(part);
    for warning in about.picture.iter().flat_map(|p| &p.view.notes.warnings) {
        ui.colored_label(ui.visuals().warn_fg_color, warning);
    }
    ui.data_mut(|d| d.insert_temp(id, sought));
    if shown != about.scene.show.wells {
        actions.push(Action::Show(Show {
            wells: shown,
            ..about.scene.show.clone()
        }));
    }
}

/// By name, kind and state.
fn search(ui: &mut Ui, wells: &[Well], sought: &mut Sought) {
    let edit = egui::TextEdit::singleline(&mut sought.text)
        .hint_text("Filter, such as OP or OP_*")
        .desired_width(f32::INFINITY);
    let edit = ui.add(edit);
    edit.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Filter wells"));
    let there = KINDS
        .into_iter()
        .filter(|kind| wells.iter().any(|well| well.kind == *kind));
    let kinds: Vec<Choice<'_, Option<WellKind>>> = [(None, "all", "Wells of all kinds")]
        .into_iter()
        .chain(there.map(|kind| (Some(kind), kind.name(), "Wells of this kind")))
        .collect();
    if let Some(kind) = one_of(ui, "Kind", sought.kind, &kinds) {
        sought.kind = kind;
    }
    let states = [
        (None, "all", "Open and shut wells"),
        (Some(true), "open", "Wells that flow"),
        (Some(false), "shut", "Wells that do not flow"),
    ];
    if let Some(state) = one_of(ui, "State", sought.is_open, &states) {
        sought.is_open = state;
    }
}

/// What is done to all wells of the list.
fn buttons(
    ui: &mut Ui,
    about: &PanelContext<'_>,
    found: &[&Well],
    shown: &mut ShownWells,
    actions: &mut Vec<Action>,
) {
    ui.horizontal_wrapped(|ui| {
        for (name, is_on, what) in [
            ("Show", true, "Draws the wells listed"),
            ("Hide", false, "Does not draw the wells listed"),
        ] {
            let button = ui.button(name);
            let full = format!("{name} the wells listed");
            button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &full));
            if button.on_hover_text(what).clicked() {
                let is_listed = |name: &str| found.iter().any(|well| well.name == name);
                *shown = changed(about, shown, |name| is_listed(name).then_some(is_on));
            }
        }
        let filter = &about.scene.filter;
        let is_on = !filter.wells.is_empty();
        let button = ui.selectable_label(is_on, "Only connected cells");
        let what = "Draws only the cells that the selected well is connected to, or else all wells listed; of a well without connections those on its path; click again for all cells";
        if button.on_hover_text(what).clicked() {
            actions.push(Action::Filter(Filter {
                wells: match is_on {
                    true => Vec::new(),
                    false => connected(about, found),
                },
                ..filter.clone()
            }));
        }
    });
}

/// The names whose cells are to be drawn.
fn connected(about: &PanelContext<'_>, found: &[&Well]) -> Vec<String> {
    let all = about.wells.map_or(0, <[Well]>::len);
    match &about.state.well {
        Some(well) => vec![well.clone()],
        None if found.len() == all => vec!["*".to_owned()],
        None => found.iter().map(|well| well.name.clone()).collect(),
    }
}

/// Which wells are drawn once `now` has said so of some.
fn changed(
    about: &PanelContext<'_>,
    shown: &ShownWells,
    now: impl Fn(&str) -> Option<bool>,
) -> ShownWells {
    // Wells that come at later steps are among those of the case.
    let of_step = about.wells.unwrap_or_default();
    let later = about.case.about.wells.iter();
    let later = later.filter(|name| of_step.iter().all(|well| well.name != **name));
    let all: Vec<&String> = of_step.iter().map(|well| &well.name).chain(later).collect();
    let is_drawn = |name: &&&String| now(name).unwrap_or_else(|| shown.shows(name));
    let drawn: Vec<&&String> = all.iter().filter(is_drawn).collect();
    match drawn.len() {
        0 => ShownWells::All(false),
        count if count == all.len() => ShownWells::All(true),
        _ => ShownWells::Named(drawn.into_iter().map(|name| (*name).clone()).collect()),
    }
}

/// A well: drawn or not, selected by a click, with the camera on it by a second one.
fn row(
    ui: &mut Ui,
    about: &PanelContext<'_>,
    well: &Well,
    shown: &mut ShownWells,
    actions: &mut Vec<Action>,
) {
    ui.horizontal(|ui| {
        let (place, _) = ui.allocate_exact_size(vec2(12.0, 12.0), Sense::hover());
        let [r, g, b] = well_color(well.kind, well.is_open).map(|v| (255.0 * v).round() as u8);
        ui.painter()
            .rect_filled(place, 2.0, Color32::from_rgb(r, g, b));
        let mut is_drawn = shown.shows(&well.name);
        let check = ui.checkbox(&mut is_drawn, "");
        let label = format!("Draw {}", well.name);
        check.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, is_drawn, &label));
        if check.on_hover_text("Draws this well").changed() {
            *shown = changed(about, shown, |name| (name == well.name).then_some(is_drawn));
        }
        let is_selected = about.state.well.as_ref() == Some(&well.name);
        let name = ui.selectable_label(is_selected, &well.name).on_hover_text(
            "Selects the well: the cells that it is connected to, or that its path goes through, and its curves; double click moves the camera to it",
        );
        ui.weak(well.in_words()).on_hover_text(details(well));
        if name.clicked() {
            actions.push(select(about, well));
        }
        if name.double_clicked() {
            actions.extend(camera_on(about, well));
        }
    });
}

/// Connections and the path of a well.
fn details(well: &Well) -> String {
    let open = well.connections.iter().filter(|c| c.is_open).count();
    let connections = format!("{open} of {} connections open", well.connections.len());
    let Some(path) = &well.path else {
        return connections;
    };
    let file = path.file.file_name().unwrap_or_default().to_string_lossy();
    let path = format!(
        "path of {} points through {} cells, from {file}",
        path.points.len(),
        path.crossings.len()
    );
    match well.connections.is_empty() {
        true => path,
        false => format!("{connections}; {path}"),
    }
}

fn cells<'a>(about: &PanelContext<'a>, well: &'a Well) -> impl Iterator<Item = Ijk> + use<'a> {
    well.finest_cells(&about.case.grid)
}

/// Selects a well and the cells that it is connected to.
fn select(about: &PanelContext<'_>, well: &Well) -> Action {
    let cells = cells(about, well).map(|cell| cell.one_based());
    Action::Well(well.name.clone(), cells.collect())
}

/// Moves the camera to the cells of a well; nothing before there is a picture.
fn camera_on(about: &PanelContext<'_>, well: &Well) -> Option<Action> {
    let view = &about.picture?.view;
    let now = view.seen_from(&about.scene.camera, view.size).ok()?;
    let camera = orbit::on_cells(&now, &about.case.grid, cells(about, well))?;
    Some(Action::Camera(orbit::spec(&camera, &now.world.corners)))
}
