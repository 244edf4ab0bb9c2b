//! What is compared, and how both are shown.

use eframe::egui::{self, Ui};

use super::About;
use crate::scene::StepSpec;
use crate::strategies::StrategyKind;
use crate::viewer::action::Action;
use crate::viewer::state::{Comparison, Layout};

/// Part of the width that the first picture has when a wipe begins.
const HALF: f64 = 0.5;

pub fn show(ui: &mut Ui, about: &About<'_>, actions: &mut Vec<Action>) {
    let before = &about.state.setup.comparison;
    let mut comparison = before.clone();
    ui.horizontal(|ui| {
        let layout = comparison.as_ref().map(|c| c.layout);
        let is_wipe = matches!(layout, Some(Layout::Wipe(_)));
        for (name, is_on, wanted, what) in [
            ("Off", layout.is_none(), None, "One picture"),
            (
                "Beside",
                layout == Some(Layout::Beside),
                Some(Layout::Beside),
                "Two pictures from one camera",
            ),
            (
                "Wipe",
                is_wipe,
                Some(Layout::Wipe(HALF)),
                "Both in one place, with a line to drag between them",
            ),
            (
                "Difference",
                layout == Some(Layout::Difference),
                Some(Layout::Difference),
                "How far the pictures are apart, by CIEDE2000",
            ),
        ] {
            if ui
                .selectable_label(is_on, name)
                .on_hover_text(what)
                .clicked()
                && !is_on
            {
                comparison = wanted.map(|layout| Comparison {
                    layout,
                    ..comparison
                        .clone()
                        .unwrap_or_else(|| Comparison::with_next_strategy(about.scene))
                });
            }
        }
    });
    if let Some(comparison) = &mut comparison {
        other(ui, about, comparison);
    }
    if comparison != *before {
        actions.push(Action::Compare(comparison));
    }
    if let Some(shown) = about.difference {
        let figures = shown.difference.figures;
        ui.label(format!(
            "CIEDE2000 mean {:.2}, 99 % below {:.2}",
            figures.ciede2000_mean, figures.ciede2000_p99
        ));
        ui.label(format!(
            "SSIM {:.4}, PSNR {:.1} dB",
            figures.ssim, figures.psnr_db
        ));
    }
}

/// What the second picture has of its own.
fn other(ui: &mut Ui, about: &About<'_>, comparison: &mut Comparison) {
    let strategies = StrategyKind::ALL.map(|k| (k.name().to_owned(), k.name().to_uppercase()));
    choice(
        ui,
        "Strategy",
        "Strategy of the second picture",
        &mut comparison.strategy,
        &strategies,
    );
    let properties = about.case.properties.iter();
    let properties: Vec<_> = properties
        .map(|p| (p.name.clone(), p.name.clone()))
        .collect();
    choice(
        ui,
        "Property",
        "Property of the second picture",
        &mut comparison.property,
        &properties,
    );
    let steps = about.case.steps.iter().enumerate();
    let steps: Vec<_> = steps
        .map(|(n, s)| (StepSpec::Index(n), format!("{n}   {}", s.date)))
        .collect();
    choice(
        ui,
        "Step",
        "Time step of the second picture",
        &mut comparison.step,
        &steps,
    );
    if !about.others.is_empty() || comparison.case.is_some() {
        choice(
            ui,
            "Case",
            "Another case that is open",
            &mut comparison.case,
            about.others,
        );
    }
}

/// A list to choose from; the first entry is what the first picture has.
fn choice<T: Clone + PartialEq>(
    ui: &mut Ui,
    name: &str,
    what: &str,
    value: &mut Option<T>,
    all: &[(T, String)],
) {
    let named = all.iter().find(|(v, _)| Some(v) == value.as_ref());
    let text = named.map_or("the same", |(_, text)| text.as_str());
    egui::ComboBox::from_label(name)
        .selected_text(text)
        .show_ui(ui, |ui| {
            ui.selectable_value(value, None, "the same");
            for (v, text) in all {
                ui.selectable_value(value, Some(v.clone()), text);
            }
        })
        .response
        .on_hover_text(what);
}
