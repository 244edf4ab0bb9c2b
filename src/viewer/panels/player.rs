//! The player: time steps by date, number and slider, and how they play.

use eframe::egui::{self, Ui};

use super::controls::{show_chosen, significant};
use crate::viewer::action::Action;
use crate::viewer::document::Document;
use crate::viewer::keys::Command;

/// What the user asked the player for.
pub enum PlayerRequest {
    /// What keys do too.
    Do(Command),
    /// A change.
    Change(Action),
}

/// Draws the player; nothing where there are no steps.
pub fn player(ui: &mut Ui, document: &Document) -> Option<PlayerRequest> {
    let (step, count) = document.step()?;
    let case = document.case.as_ref()?;
    let mut asked = None;
    ui.horizontal_wrapped(|ui| {
        let play = if document.playing.is_some() {
            "Pause"
        } else {
            "Play"
        };
        for (name, what, does) in [
            ("First", "First step (Home)", Command::End(false)),
            ("Back", "Step back (Left)", Command::Step(-1)),
            (play, "Play or pause (Space)", Command::Play),
            ("Forward", "Step forward (Right)", Command::Step(1)),
            ("Last", "Last step (End)", Command::End(true)),
        ] {
            if ui.button(name).on_hover_text(what).clicked() {
                asked = Some(PlayerRequest::Do(does));
            }
        }
        let mut pace = document.state.pace;
        ui.checkbox(&mut pace.repeats, "Repeat")
            .on_hover_text("Starts over after the last step");
        let speed = egui::DragValue::new(&mut pace.steps_per_second)
            .range(0.1..=30.0)
            .speed(0.05)
            .max_decimals(1)
            .suffix(" steps/s");
        ui.add(speed)
            .on_hover_text("Steps per second at most; each stays until its image is drawn");
        if pace != document.state.pace {
            asked = Some(PlayerRequest::Change(Action::Playback(pace)));
        }
        let mut wanted = step;
        let slider = egui::Slider::new(&mut wanted, 0..=count - 1).show_value(false);
        let slider = ui.add(slider).on_hover_text("Time step");
        slider.widget_info(|| egui::WidgetInfo::slider(true, wanted as f64, "Time step"));
        // The date alone names a step; its numbers are told on request.
        let told = |n: usize| {
            let at = &case.steps[n];
            let days = significant(at.days);
            format!(
                "Step {} of {count}, report {}, day {days}",
                n + 1,
                at.report
            )
        };
        egui::ComboBox::from_id_salt("step")
            .width(150.0)
            .selected_text(&case.steps[step].date)
            .show_ui(ui, |ui| {
                for n in 0..count {
                    let entry = ui.selectable_value(&mut wanted, n, &case.steps[n].date);
                    let entry = entry.on_hover_text(told(n));
                    if n == step {
                        show_chosen(ui, &entry);
                    }
                }
            })
            .response
            .on_hover_text(told(step));
        if wanted != step {
            asked = Some(PlayerRequest::Change(Action::Step(wanted)));
        }
    });
    asked
}
