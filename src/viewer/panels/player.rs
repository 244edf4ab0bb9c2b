//! The player of time steps.

use eframe::egui::{self, Ui};

use crate::viewer::document::Document;

/// What the user asked the player for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Player {
    /// Play, or stand still.
    Toggle,
    /// Steps forward, or back.
    Move(isize),
    /// A step by number.
    Go(usize),
}

/// Draws the player; nothing where there are no steps.
pub fn player(ui: &mut Ui, document: &Document) -> Option<Player> {
    let (step, count) = document.step()?;
    let case = document.case()?;
    let mut asked = None;
    ui.horizontal(|ui| {
        let play = if document.playing.is_some() {
            "Pause"
        } else {
            "Play"
        };
        for (name, what, does) in [
            ("First", "First step (Home)", Player::Go(0)),
            ("Back", "Step back (Left)", Player::Move(-1)),
            (play, "Play or pause (Space)", Player::Toggle),
            ("Forward", "Step forward (Right)", Player::Move(1)),
            ("Last", "Last step (End)", Player::Go(count - 1)),
        ] {
            if ui.button(name).on_hover_text(what).clicked() {
                asked = Some(does);
            }
        }
        let mut wanted = step;
        let slider = egui::Slider::new(&mut wanted, 0..=count - 1).show_value(false);
        let slider = ui.add(slider.text("Time step"));
        if slider.changed() && wanted != step {
            asked = Some(Player::Go(wanted));
        }
        let at = &case.steps[step];
        ui.label(format!(
            "{} of {count}   {}   report {}   day {:.0}",
            step + 1,
            at.date,
            at.report,
            at.days
        ));
    });
    asked
}
