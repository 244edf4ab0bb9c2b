//! Showing: strategies, properties, time, colors.

use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use glam::DVec3;
use strataray::image::metrics::Comparison;
use strataray::scene::lighting::LightSpec;
use strataray::scene::{Hull, OpacitySpec, StepSpec};

use super::common::{gpu, sample};
use super::driven::Driven;

#[test]
fn each_strategy_shows_the_same_in_its_own_way() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let mut pictures = Vec::new();
    for (label, name) in [("LIBC", "libc"), ("PLTS", "plts"), ("SRG", "srg")] {
        driven.click(label);
        assert_eq!(driven.scene().strategy.name(), name);
        driven.wait_final();
        pictures.push(driven.picture(0));
    }
    for pair in [[0, 1], [0, 2], [1, 2]] {
        let [a, b] = pair.map(|n| &pictures[n]);
        let apart = Comparison::of(a, b).unwrap();
        assert!(a != b && apart.ciede2000_mean < 2.0, "{pair:?} {apart:?}");
    }
    // Another property is farther away than another strategy.
    driven.click("DEPTH");
    driven.wait_final();
    let other = Comparison::of(&pictures[2], &driven.picture(0)).unwrap();
    assert!(other.ciede2000_mean > 2.0, "{other:?}");
}

#[test]
fn time_plays_and_stands_still() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    driven.press(Modifiers::NONE, Key::Home);
    driven.wait_final();
    let first = driven.picture(0);
    driven.click("Play");
    driven.wait("the third step", |w| {
        w.document()
            .and_then(|d| d.step())
            .is_some_and(|s| s.0 >= 2)
    });
    driven.click("Pause");
    let at = driven.document().step().unwrap();
    driven.wait_final();
    assert!(driven.picture(0) != first);
    assert_eq!(driven.document().step().unwrap(), at);
    // Around the end, unless it is told to stop there.
    driven.press(Modifiers::NONE, Key::End);
    assert_eq!(driven.document().step().unwrap().0, at.1 - 1);
    driven.click("Play");
    driven.wait("the first step", |w| {
        w.document()
            .and_then(|d| d.step())
            .is_some_and(|s| s.0 == 0)
    });
    driven.press(Modifiers::NONE, Key::Space);
    driven.click("Repeat");
    driven.press(Modifiers::NONE, Key::End);
    driven.click("Play");
    driven.wait("the end", |w| {
        w.document().is_some_and(|d| d.playing.is_none())
    });
    assert_eq!(driven.document().step().unwrap().0, at.1 - 1);
    // Each step is one that can be undone.
    driven.press(Modifiers::COMMAND, Key::Z);
    assert_ne!(driven.scene().step, StepSpec::Index(at.1 - 1));
}

#[test]
fn the_transfer_function_is_edited_and_undone() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let (before, start) = (driven.picture(0), driven.scene().clone());
    driven.wait_settled();
    let place = driven.place("opacity curve");
    // The last point, wherever it is: the one at the right end.
    let points = driven.scene().transfer.opacity.clone();
    let shown = |d: &Driven| {
        d.harness
            .state()
            .picture(0)
            .unwrap()
            .0
            .view
            .style
            .transfer
            .opacity
            .clone()
    };
    let last = match points {
        Some(OpacitySpec::Points(points)) => points.last().map(|p| (p[0], p[1])).unwrap(),
        _ => *shown(&driven).last().unwrap(),
    };
    let from =
        place.left_top() + place.size() * eframe::egui::vec2(last.0 as f32, 1.0 - last.1 as f32);
    // Within the curve's edges, which it lies on.
    let inside = eframe::egui::vec2(-3.0, 3.0);
    driven.drag(from + inside, place.right_center() + inside);

    let edited = driven.scene().transfer.opacity.clone().unwrap();
    let OpacitySpec::Points(points) = &edited else {
        panic!("{edited:?}");
    };
    assert!(
        (points.last().unwrap()[1] - last.1).abs() > 0.2,
        "{edited:?}"
    );
    driven.wait_final();
    let changed = Comparison::of(&driven.picture(0), &before).unwrap();
    assert!(changed.ciede2000_mean > 0.01, "{changed:?}");
    driven.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(driven.scene(), &start);
    driven.wait_final();
    // Rays pause by time, so sums may round differently, in single pixels.
    let apart = |picture| Comparison::of(picture, &before).unwrap().ciede2000_mean;
    assert!(apart(&driven.picture(0)) < 1e-3);
    driven.press(Modifiers::COMMAND, Key::Y);
    assert_eq!(driven.scene().transfer.opacity, Some(edited));
}

#[test]
fn a_window_at_rest_asks_for_no_frames() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    for _ in 0..20 {
        driven.step();
    }
    let delay = |d: &Driven| {
        let outputs = d.harness.output().viewport_output.values();
        outputs.map(|o| o.repaint_delay).min().unwrap()
    };
    assert!(delay(&driven).as_secs() > 3600, "{:?}", delay(&driven));
    // The twin: while time plays, it does.
    driven.press(Modifiers::NONE, Key::Space);
    assert!(delay(&driven).as_secs() < 3600);
}

/// Sets a slider, which has its number beside it.
fn set(driven: &mut Driven, name: &str, value: f64) {
    let slider = driven.harness.get_all_by_label(name).next().unwrap();
    slider.set_value_accesskit(value);
    driven.step();
    driven.step();
}

#[test]
fn the_key_light_comes_from_where_it_is_set() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::sized(&[sample()], [1280.0, 1400.0], false);
    driven.wait_final();
    let before = driven.picture(0);
    driven.click("Key light");
    let direction = |d: &Driven| {
        let light = d.scene().lighting.lights.first().cloned();
        let Some(LightSpec::Directional {
            direction,
            intensity,
            ..
        }) = light
        else {
            panic!("{light:?}");
        };
        (direction, intensity)
    };
    let (key, strength) = direction(&driven);
    assert_eq!(strength, None);
    driven.wait_final();
    let lit = driven.picture(0);
    assert!(lit != before);
    // A slider of the direction changes it, and the picture with it.
    set(&mut driven, "Light azimuth", 90.0);
    let (east, _) = direction(&driven);
    assert!(east[0] < 0.0 && east[1].abs() < 1e-6, "{east:?}");
    assert!((east[2] - key[2] / DVec3::from_array(key).length()).abs() < 1e-3);
    driven.wait_final();
    assert!(driven.picture(0) != lit);
    set(&mut driven, "Light strength", 1.5);
    assert_eq!(direction(&driven).1, Some(1.5));
    driven.click("Key light");
    assert!(driven.scene().lighting.lights.is_empty());
    driven.wait_final();
    let apart = Comparison::of(&driven.picture(0), &before).unwrap();
    assert!(apart.ciede2000_mean < 1e-3, "{apart:?}");
}

#[test]
fn the_hull_is_none_faint_or_opaque() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let mut pictures = Vec::new();
    for (label, hull) in [
        ("Hull: None", Hull::Hidden),
        ("Hull: Faint", Hull::Faint),
        ("Hull: Opaque", Hull::Opaque),
    ] {
        driven.click(label);
        assert_eq!(driven.scene().show.hull, hull);
        driven.wait_final();
        let picture = driven.picture(0);
        assert!(!pictures.contains(&picture), "{label}");
        pictures.push(picture);
    }
}
