//! The pictures of docs/tour.md: a first walk through the window, from the welcome page to an answer.

use std::path::Path;
use std::time::Duration;

use eframe::egui::{Key, Modifiers, Pos2, vec2};
use strataray::model::Ijk;
use strataray::model::topology::Face;
use strataray::scene::{CameraSpec, CutFace, FramingCamera, Projection, PropertyFilter};
use strataray::viewer::{Action, CompareLayout, Comparison};

use super::common::gpu;
use super::driven::Driven;

/// Folder of the pictures.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/tour");

fn shot(driven: &mut Driven, name: &str) {
    driven.wait_settled();
    let image = driven.harness.render().unwrap();
    let size = [image.width(), image.height()];
    let rgb: Vec<[u8; 3]> = image.pixels().map(|p| [p[0], p[1], p[2]]).collect();
    std::fs::create_dir_all(FOLDER).unwrap();
    let path = Path::new(FOLDER).join(format!("{name}.png"));
    strataray::picture::write_png(&path, size, &rgb).unwrap();
}

fn apply(driven: &mut Driven, action: Action) {
    driven.harness.state_mut().apply(action);
    driven.wait_final();
}

/// Where a face of a cell is seen.
fn face_on_screen(driven: &Driven, cell: Ijk, face: Face) -> Pos2 {
    let case = driven.document().case.clone().unwrap();
    let view = driven.harness.state().picture(0).unwrap().0.view.clone();
    let corners = case.grid.hexahedron(cell).0;
    let middle = face.corners()[0]
        .iter()
        .map(|n| corners[*n])
        .sum::<glam::DVec3>()
        / 4.0;
    let world = view.world.spaces.world_from_grid.transform_point3(middle);
    let at = view.camera.project(world, view.aspect()).unwrap();
    let place = driven.place("volume");
    place.min + vec2(at.x as f32, at.y as f32) * place.size()
}

#[test]
#[ignore = "makes the pictures of docs/tour.md anew"]
fn the_tour_is_walked() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::open(&[]);
    shot(&mut driven, "1_welcome");
    driven.click("SCISSOR");
    driven.wait_final();
    shot(&mut driven, "2_first");
    // Time: the flood.
    driven.press(Modifiers::NONE, Key::Home);
    for _ in 0..8 {
        driven.press(Modifiers::NONE, Key::ArrowRight);
    }
    driven.wait_final();
    shot(&mut driven, "3_time");
    driven.press(Modifiers::NONE, Key::End);
    // From the south-east, where the oil is, with occlusion.
    let camera = CameraSpec::Framing(FramingCamera {
        azimuth_degrees: 150.0,
        elevation_degrees: 38.0,
        zoom: 1.0,
        projection: Projection::Perspective,
    });
    apply(&mut driven, Action::Camera(camera));
    driven.click("strong");
    driven.wait_final();
    shot(&mut driven, "4_oil");
    find(&mut driven);
    understand(&mut driven);
}

/// What holds the oil back, and where.
fn find(driven: &mut Driven) {
    // Faults, and the throw of the one in the way.
    driven.click("Fault surfaces");
    driven.wait_final();
    let on_fault = face_on_screen(driven, Ijk { i: 24, j: 4, k: 1 }, Face::IMinus);
    driven.harness.hover_at(on_fault);
    for _ in 0..60 {
        driven.step();
        std::thread::sleep(Duration::from_millis(20));
    }
    shot(driven, "5_fault");
    // Only the oil.
    let mut filter = driven.scene().filter.clone();
    filter.properties.push(PropertyFilter {
        min: Some(0.6),
        max: Some(1.0),
        ..PropertyFilter::open("SOIL")
    });
    apply(driven, Action::Filter(filter));
    shot(driven, "6_filter");
    driven.press(Modifiers::COMMAND, Key::Z);
    // A section across the fault.
    driven.click("Property");
    driven.wait_settled();
    driven.click("Clip planes");
    driven.wait_settled();
    driven.click("North");
    let mut clip = driven.scene().clip.clone();
    clip[0].face = CutFace::Opaque;
    clip[0].point[1] -= 700.0;
    apply(driven, Action::Clip(clip));
    driven.click("Edges of cells");
    driven.wait_final();
    shot(driven, "7_section");
    apply(driven, Action::Clip(Vec::new()));
    driven.click("Clip planes");
    driven.click("Property");
    driven.click("Edges of cells");
    driven.click("Fault surfaces");
}

/// How it came about.
fn understand(driven: &mut Driven) {
    // Two cells, one on each side of the fault, over time.
    driven.click("Transfer function");
    driven.wait_settled();
    for (n, cell) in [[23, 6, 2], [27, 6, 2]].into_iter().enumerate() {
        let beside = if n == 0 {
            strataray::viewer::Beside::Nothing
        } else {
            strataray::viewer::Beside::Others
        };
        apply(driven, Action::Select(cell, beside));
    }
    driven.wait("curves", |w| {
        let curves = w.document().and_then(|d| d.curves.as_ref());
        curves.is_some_and(|c| c.of.cells.len() == 2)
    });
    driven.wait_final();
    driven.press(Modifiers::COMMAND, Key::G);
    driven.wait_settled();
    shot(driven, "8_cells");
    driven.press(Modifiers::COMMAND, Key::G);
    driven.click("Transfer function");
    // Before and after, with a line to drag.
    let comparison = Comparison {
        layout: CompareLayout::Wipe(0.5),
        step: Some(strataray::scene::StepSpec::Index(0)),
        ..Comparison::default()
    };
    apply(driven, Action::Compare(Some(comparison)));
    shot(driven, "9_compare");
    // What the flood took, in values.
    let comparison = Comparison {
        layout: CompareLayout::Difference,
        step: Some(strataray::scene::StepSpec::Index(0)),
        ..Comparison::default()
    };
    apply(driven, Action::Compare(Some(comparison)));
    shot(driven, "10_difference");
}
