//! Which strategy casts the rays, and its settings.

use eframe::egui::{self, Ui};

use super::PanelContext;
use super::controls::slider;
use crate::scene::{Integration, Storage, StrategyKind};
use crate::viewer::action::Action;

pub fn show(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        for kind in StrategyKind::ALL {
            let is_on = about.scene.strategy == kind;
            let label = ui.selectable_label(is_on, kind.name().to_uppercase());
            if label.on_hover_text(kind.describe()).clicked() {
                actions.push(Action::Strategy(kind));
            }
        }
    });
    let kind = about.scene.strategy;
    ui.weak(kind.describe());
    egui::CollapsingHeader::new("Sampling settings")
        .show(ui, |ui| {
            match kind {
                StrategyKind::Libc => libc(ui, about, actions),
                StrategyKind::Srg => srg(ui, about, actions),
                StrategyKind::Plts => plts(ui, about, actions),
            }
            sampling_step(ui, about, actions);
            supersample(ui, about, actions);
            storage(ui, about, actions);
        })
        .header_response
        .on_hover_text("How rays are sampled; the defaults suit most models");
}

fn sampling_step(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    if let Some(picture) = about.picture {
        let length = about.world_length();
        let mut step = length.show(picture.view.sampling.step);
        let speed = 0.01 * step;
        ui.horizontal(|ui| {
            ui.label("Sampling step");
            let drag = egui::DragValue::new(&mut step)
                .speed(speed)
                .range(0.001..=1e6);
            if ui
                .add(drag)
                .on_hover_text(format!(
                    "Distance between samples along a ray, {}",
                    length.unit
                ))
                .changed()
            {
                actions.push(Action::SamplingStep(Some(length.read(step))));
            }
            if ui.button("Default").clicked() {
                actions.push(Action::SamplingStep(None));
            }
        });
    }
}

fn supersample(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        ui.label("Rays per pixel")
            .on_hover_text("More rays make edges of cells, faults and wells smooth; images of 4 rays take four times as long");
        for across in 1..=4_u32 {
            let is_on = about.scene.supersample == across;
            let label = ui.selectable_label(is_on, (across * across).to_string());
            if label.clicked() {
                actions.push(Action::Supersample(across));
            }
        }
    });
}

fn storage(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let mut is_compact = about.scene.storage == Storage::Compact;
    let choice = ui.checkbox(&mut is_compact, "Depths and values in 16 bits");
    let what = "Half the memory on the GPU; depths are off by some millimeters";
    if choice.on_hover_text(what).changed() {
        actions.push(Action::Storage(match is_compact {
            true => Storage::Compact,
            false => Storage::Exact,
        }));
    }
}

fn libc(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let mut settings = about.scene.libc;
    integration(ui, &mut settings.integration);
    ui.checkbox(&mut settings.cross_faults, "Cross faults cell to cell")
        .on_hover_text("Rays step into the cell across a fault instead of searching for it");
    if settings != about.scene.libc {
        actions.push(Action::Libc(settings));
    }
}

fn plts(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let mut settings = about.scene.plts;
    integration(ui, &mut settings.integration);
    if settings != about.scene.plts {
        actions.push(Action::Plts(settings));
    }
}

fn integration(ui: &mut Ui, integration: &mut Integration) {
    let mut segments = *integration == Integration::Segments;
    ui.checkbox(&mut segments, "Integrate whole segments")
        .on_hover_text("Integrates the part of a ray in each cell at once instead of by samples: faster, close to exact");
    *integration = match segments {
        true => Integration::Segments,
        false => Integration::Samples,
    };
}

fn srg(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let mut settings = about.scene.srg;
    let mut budget = settings.budget_mb.unwrap_or(32);
    let of = egui::Slider::new(&mut budget, 1..=4096).logarithmic(true);
    let what = "Memory of the resampled grid";
    if slider(ui, "Grid budget", what, of.suffix(" MB")) {
        settings.budget_mb = Some(budget);
    }
    ui.checkbox(&mut settings.skip_empty, "Skip empty space")
        .on_hover_text("Rays skip blocks of the resampled grid without visible values");
    if settings != about.scene.srg {
        actions.push(Action::Srg(settings));
    }
}
