//! The viewer's window without a display: the real interface, driven by its labels, keys and pointer.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use eframe::egui::{self, Key, Modifiers, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use strataray::image::Rgb8;
use strataray::scene::Scene;
use strataray::transfer::presets::parse_color;
use strataray::viewer::{Document, Settings, Window};

/// Longest wait for anything: software adapters on busy machines are slow.
const PATIENCE: Duration = Duration::from_secs(120);

/// A window that is being used.
pub struct Driven {
    pub harness: Harness<'static, Window>,
    /// Where it remembers things.
    pub folder: tempfile::TempDir,
    /// Points of the window.
    size: [f32; 2],
}

impl Driven {
    /// A window of 1280 by 800 points on some cases.
    pub fn open(cases: &[PathBuf]) -> Self {
        Self::sized(cases, [1280.0, 800.0], false)
    }

    pub fn sized(cases: &[PathBuf], size: [f32; 2], watches: bool) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let settings = Settings::in_file(folder.path().join("settings.json"));
        let cases = cases.to_vec();
        let harness = Harness::builder()
            .with_size(vec2(size[0], size[1]))
            .build_eframe(move |cc| Window::new(&cc.egui_ctx, cases, watches, settings));
        Self {
            harness,
            folder,
            size,
        }
    }

    /// A window that shows the final picture of a case.
    pub fn showing(case: PathBuf) -> Self {
        let mut driven = Self::open(&[case]);
        driven.wait_final();
        driven
    }

    /// A frame.
    pub fn step(&mut self) {
        self.harness.step();
    }

    /// Frames until something holds.
    pub fn wait(&mut self, what: &str, holds: impl Fn(&Window) -> bool) {
        let start = Instant::now();
        loop {
            self.step();
            if holds(self.harness.state()) {
                return;
            }
            let message = self.harness.state().message();
            assert!(start.elapsed() < PATIENCE, "waited for {what}; {message:?}");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Frames until all that is asked for is shown in full.
    pub fn wait_final(&mut self) {
        // What was just done must have been seen.
        self.step();
        self.step();
        self.wait("the final picture", |w| {
            w.picture(0).is_some_and(|(_, f)| f)
        });
    }

    pub fn document(&self) -> &Document {
        self.harness.state().document().unwrap()
    }

    pub fn scene(&self) -> &Scene {
        &self.document().state.setup.scene
    }

    /// The picture of a side, as it is shown.
    pub fn picture(&self, side: usize) -> Rgb8 {
        let (picture, _) = self.harness.state().picture(side).unwrap();
        (*picture.rgb).clone()
    }

    /// Part of the pixels of the picture shown that are not of the background.
    pub fn covered(&self) -> f64 {
        self.covered_by(0)
    }

    /// The same of a side.
    pub fn covered_by(&self, side: usize) -> f64 {
        let picture = self.picture(side);
        let background = parse_color(&self.scene().background).unwrap();
        let background = background.map(|v| (255.0 * v).round() as u8);
        let count = picture.pixels.iter().filter(|p| **p != background).count();
        count as f64 / picture.pixels.len() as f64
    }

    /// Clicks what has a label, which is scrolled to where it lies outside the window.
    pub fn click(&mut self, label: &str) {
        let place = self.place(label);
        // What lies near the lower edge may be covered by the player.
        let window = egui::Rect::from_min_size(Pos2::ZERO, self.size.into());
        if !window.shrink2(vec2(0.0, 60.0)).contains_rect(place) && place.top() > 60.0 {
            self.harness.get_by_label(label).scroll_to_me();
            self.wait_settled();
        }
        self.harness.get_by_label(label).click();
        self.step();
        self.step();
    }

    pub fn press(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.step();
        self.step();
    }

    /// Frames until what opens or closes has done so.
    pub fn wait_settled(&mut self) {
        for _ in 0..20 {
            self.step();
            std::thread::sleep(Duration::from_millis(15));
        }
    }

    /// Where everything with a label is.
    pub fn places(&self, label: &str) -> Vec<egui::Rect> {
        self.harness
            .get_all_by_label(label)
            .map(|n| n.rect())
            .collect()
    }

    /// Where the last thing with a label is, of several.
    pub fn last_place(&self, label: &str) -> egui::Rect {
        self.places(label).pop().unwrap()
    }

    /// Where something with a label is.
    pub fn place(&self, label: &str) -> egui::Rect {
        self.harness.get_by_label(label).rect()
    }

    /// Drags with the left button, in some frames.
    pub fn drag(&mut self, from: Pos2, to: Pos2) {
        self.harness.hover_at(from);
        self.step();
        self.harness.drag_at(from);
        self.step();
        for n in 1..=4 {
            self.harness.hover_at(from.lerp(to, n as f32 / 4.0));
            self.step();
        }
        self.harness.drop_at(to);
        self.step();
    }

    /// Clicks a place.
    pub fn click_at(&mut self, at: Pos2, modifiers: Modifiers) {
        self.harness.hover_at(at);
        self.step();
        for pressed in [true, false] {
            let event = egui::Event::PointerButton {
                pos: at,
                button: egui::PointerButton::Primary,
                pressed,
                modifiers,
            };
            self.harness.event_modifiers(event, modifiers);
            self.step();
        }
    }
}
