//! What is compared, and how both are shown.

use eframe::egui::Ui;

use super::PanelContext;
use super::controls::list;
use crate::scene::{StepSpec, StrategyKind};
use crate::viewer::action::Action;
use crate::viewer::state::{CompareLayout, Comparison};

/// Part of the width that the first picture has when a wipe begins.
const HALF: f64 = 0.5;

/// Text of the button, layout, and what it shows.
const LAYOUTS: [(&str, Option<CompareLayout>, &str); 5] = [
    ("Off", None, "One image"),
    (
        "Beside",
        Some(CompareLayout::Beside),
        "Two images from one camera",
    ),
    (
        "Wipe",
        Some(CompareLayout::Wipe(HALF)),
        "Both images in one place, with a line to drag between them",
    ),
    (
        "Difference",
        Some(CompareLayout::Difference),
        "The values of the first minus those of the second, cell by cell",
    ),
    (
        "Color difference (CIEDE2000)",
        Some(CompareLayout::ColorDifference),
        "How far apart two strategies draw the same values",
    ),
];

pub fn show(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let before = &about.state.setup.comparison;
    let mut comparison = before.clone();
    layouts(ui, about, &mut comparison);
    if let Some(comparison) = &mut comparison {
        other(ui, about, comparison);
    }
    if comparison != *before {
        actions.push(Action::Compare(comparison));
    }
    if let Some(why) = &about.refusal {
        ui.colored_label(ui.visuals().warn_fg_color, why);
    }
    if !about.case.minus.is_empty() {
        for note in &about.case.about.notes {
            ui.weak(note);
        }
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

fn layouts(ui: &mut Ui, about: &PanelContext<'_>, comparison: &mut Option<Comparison>) {
    let scene = &about.state.setup.scene;
    let current = comparison.as_ref().map(|c| c.layout);
    let kind = |layout: &Option<CompareLayout>| layout.as_ref().map(std::mem::discriminant);
    ui.horizontal_wrapped(|ui| {
        for (name, layout, what) in LAYOUTS {
            let is_on = kind(&current) == kind(&layout);
            let button = ui.selectable_label(is_on, name).on_hover_text(what);
            if button.clicked() && !is_on {
                *comparison = layout.map(|layout| {
                    let known = comparison.clone();
                    let known = known.unwrap_or_else(|| Comparison::opening(about.case, scene));
                    known.laid_out(layout, about.case, scene)
                });
            }
        }
    });
}

/// What the second image has of its own.
fn other(ui: &mut Ui, about: &PanelContext<'_>, comparison: &mut Comparison) {
    ui.weak(match comparison.layout {
        CompareLayout::Beside | CompareLayout::Wipe(_) => "The second image shows",
        CompareLayout::Difference => "The image minus",
        CompareLayout::ColorDifference => "The image against",
    });
    if comparison.layout != CompareLayout::ColorDifference {
        values(ui, about, comparison);
    }
    if comparison.layout != CompareLayout::Difference {
        let strategies = StrategyKind::ALL.map(|k| (k, k.name().to_uppercase()));
        let value = &mut comparison.strategy;
        choice(
            ui,
            "Strategy",
            "Strategy of the second image",
            value,
            &strategies,
        );
    }
}

/// What makes the values of the second image others.
fn values(ui: &mut Ui, about: &PanelContext<'_>, comparison: &mut Comparison) {
    let steps = about.case.steps.iter().enumerate();
    let steps: Vec<_> = steps
        .map(|(n, s)| (StepSpec::Index(n), format!("{n}   {}", s.date)))
        .collect();
    let what = "Time step of the second image";
    choice(ui, "Step", what, &mut comparison.step, &steps);
    let properties: Vec<_> = about
        .properties()
        .map(|p| (p.name.clone(), p.name.clone()))
        .collect();
    let what = "Property of the second image";
    choice(ui, "Property", what, &mut comparison.property, &properties);
    if !about.others.is_empty() || comparison.case.is_some() {
        let what = "Another case that is open; its image is of the step with the nearest date, a difference of the same date alone";
        choice(ui, "Case", what, &mut comparison.case, about.others);
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
    list(ui, name, what, text, |ui| {
        ui.selectable_value(value, None, "the same");
        for (v, text) in all {
            ui.selectable_value(value, Some(v.clone()), text);
        }
    });
}
