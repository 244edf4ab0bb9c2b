//! The player: time steps by date, number and slider, and how they play.

use eframe::egui::{self, Ui};

use super::controls::show_chosen;
use crate::viewer::action::Action;
use crate::viewer::document::Document;
use crate::viewer::keys::Command;

/// What the user asked the player for.
pub enum Asked {
    /// What keys do too.
    Do(Command),
    /// A change.
    Change(Action),
}

/// Draws the player; nothing where there are no steps.
pub fn player(ui: &mut Ui, document: &Document) -> Option<Asked> {
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
                asked = Some(Asked::Do(does));
            }
        }
        let mut pace = document.state.pace;
        ui.checkbox(&mut pace.repeats, "Repeat")
            .on_hover_text("After the last step comes the first");
        let speed = egui::DragValue::new(&mut pace.steps_a_second)
            .range(0.1..=30.0)
            .speed(0.05)
            .max_decimals(1)
            .suffix(" steps/s");
        ui.add(speed)
            .on_hover_text("Steps a second, at most: each stays until its picture is there");
        if pace != document.state.pace {
            asked = Some(Asked::Change(Action::Pace(pace)));
        }
        let mut wanted = step;
        let slider = egui::Slider::new(&mut wanted, 0..=count - 1).show_value(false);
        let slider = ui.add(slider).on_hover_text("Time step");
        slider.widget_info(|| egui::WidgetInfo::slider(true, wanted as f64, "Time step"));
        let at = |n: usize| {
            let at = &case.steps[n];
            format!("{}   report {}   day {:.0}", at.date, at.report, at.days)
        };
        egui::ComboBox::from_id_salt("step")
            .width(230.0)
            .selected_text(at(step))
            .show_ui(ui, |ui| {
                for n in 0..count {
                    let entry = ui.selectable_value(&mut wanted, n, at(n));
                    if n == step {
                        show_chosen(ui, &entry);
                    }
                }
            })
            .response
            .on_hover_text("Date, report number and days since the start");
        ui.weak(format!("{} of {count}", step + 1));
        if wanted != step {
            asked = Some(Asked::Change(Action::Step(wanted)));
        }
    });
    asked
}
