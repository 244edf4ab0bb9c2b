//! Selecting: filters, clip planes, cells.

use eframe::egui::{Key, Modifiers, pos2, vec2};
use egui_kittest::kittest::Queryable;
use strataray::model::Ijk;
use strataray::picking::Part;
use strataray::scene::{Hull, Show};
use strataray::viewer::{Action, Beside, Comparison, Layout};

use super::common::{gpu, sample};
use super::driven::{Driven, covered};

#[test]
fn filters_take_cells_away() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let all = covered(&driven.picture(0), [255; 3]);
    let count = driven.document().case.as_ref().unwrap().grid.dims().ni;
    // The number stands right of its slider.
    let number = driven.place(&format!("The last I drawn, 1 to {count}"));
    driven.click_at(number.left_center() - vec2(40.0, 0.0), Modifiers::NONE);
    let [first, last] = driven.scene().filter.i.unwrap();
    assert!(first == 1 && last < count, "{first} {last}");
    driven.wait_final();
    let some = covered(&driven.picture(0), [255; 3]);
    assert!(some < 0.9 * all, "{some} {all}");
    driven.click("All cells");
    driven.wait_final();
    assert_eq!(covered(&driven.picture(0), [255; 3]), all);
    driven.click("Property filters");
    driven.wait_settled();
    driven.click("Add a filter");
    let filter = driven.scene().filter.properties[0].clone();
    assert!(filter.min < filter.max);
    driven.wait_final();
    driven.harness.get_by_label("Smallest value drawn");
}

#[test]
fn a_clip_plane_is_moved_by_its_handle() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let all = covered(&driven.picture(0), [255; 3]);
    driven.click("Clip planes");
    driven.wait_settled();
    driven.click("East");
    driven.wait_final();
    let half = covered(&driven.picture(0), [255; 3]);
    assert!(half < 0.95 * all, "{half} {all}");
    let plane = driven.scene().clip[0].clone();
    let handle = driven.place("move plane 1").center();
    let tip = driven.place("lean plane 1").center();
    driven.drag(handle, handle + 2.0 * (tip - handle));
    let moved = driven.scene().clip[0].clone();
    assert_eq!(moved.normal, plane.normal);
    assert!(moved.point[0] > plane.point[0] + 1.0, "{moved:?} {plane:?}");
    driven.wait_final();
    assert!(covered(&driven.picture(0), [255; 3]) < half);
    // The other one leans it.
    let tip = driven.place("lean plane 1").center();
    driven.drag(tip, tip + vec2(0.0, -60.0));
    assert_ne!(driven.scene().clip[0].normal, plane.normal);
    // A drag of a handle leaves the camera alone.
    for _ in 0..3 {
        driven.press(Modifiers::COMMAND, Key::Z);
    }
    assert!(driven.scene().clip.is_empty());
    assert_eq!(
        driven.scene().camera,
        strataray::scene::CameraSpec::default()
    );
}

#[test]
fn a_picked_cell_tells_its_values() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    // From above, on opaque faces, the cell under a place is known from the grid alone.
    let show = Show {
        hull: Hull::Opaque,
        ..Show::default()
    };
    driven.harness.state_mut().apply(Action::Show(show));
    driven.press(Modifiers::COMMAND.plus(Modifiers::ALT), Key::T);
    driven.wait_final();
    let case = driven.document().case.clone().unwrap();
    let grid = &case.grid;
    let dims = grid.dims();
    let column = (0..dims.nk).map(|k| Ijk {
        i: dims.ni / 4,
        j: dims.nj / 3,
        k,
    });
    let cell = column.into_iter().find(|c| grid.is_active(*c)).unwrap();
    let view = driven.harness.state().picture(0).unwrap().0.view.clone();
    let corners = grid.hexahedron(cell).0;
    let top = (corners[0] + corners[1] + corners[2] + corners[3]) / 4.0;
    let world = view.spaces.world_from_grid.transform_point3(top);
    let at = view.camera.project(world, view.aspect()).unwrap();
    let place = driven.place("volume");
    let at = pos2(at.x as f32, at.y as f32).to_vec2() * place.size() + place.min.to_vec2();
    driven.click_at(at.to_pos2(), Modifiers::NONE);
    driven.wait("the cell", |w| {
        w.document().is_some_and(|d| d.table.is_some())
    });
    assert_eq!(
        driven.document().state.selected,
        [[cell.i + 1, cell.j + 1, cell.k + 1]]
    );
    // What is said is what the file has.
    let table = driven.document().table.clone().unwrap();
    let told = |name: &str| table.rows.iter().find(|r| r.0 == name).unwrap().2[0];
    let step = driven.document().step().unwrap().0;
    for name in ["PORO", "PRESSURE", "DEPTH"] {
        let field = case.field(name, step).unwrap();
        assert_eq!(told(name), field.value(grid, dims.cell(cell)), "{name}");
    }
    driven.wait("curves", |w| {
        w.document().is_some_and(|d| d.curves.is_some())
    });
    let curves = driven.document().curves.clone().unwrap();
    assert_eq!(curves.points[0].len(), case.steps.len());
    // Another one beside it, then only what is like it.
    driven.click_at(place.center(), Modifiers::COMMAND);
    driven.wait("two cells", |w| {
        w.document().is_some_and(|d| d.state.selected.len() == 2)
    });
    let of_two = |w: &strataray::viewer::Window| {
        let table = w.document().and_then(|d| d.table.as_ref());
        table.is_some_and(|t| t.of.cells.len() == 2)
    };
    driven.wait("both tables", of_two);
    let before = covered(&driven.picture(0), [255; 3]);
    // Room for the panel of selected cells.
    driven.click("Transfer function");
    driven.wait_settled();
    driven.click("Only alike");
    assert_eq!(driven.scene().filter.properties.len(), 1);
    driven.wait_final();
    assert!(covered(&driven.picture(0), [255; 3]) < before);
    driven.press(Modifiers::NONE, Key::Escape);
    assert!(driven.document().state.selected.is_empty());
}

#[test]
fn a_pointer_that_rests_reads_the_cell_and_disturbs_no_picture() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let place = driven.place("volume");
    driven.harness.hover_at(place.center());
    driven.wait("the cell", |w| w.hovered().is_some());
    let pick = driven.harness.state().hovered().unwrap().clone();
    let hit = pick.hit.unwrap();
    // What a click takes, with the value of the file.
    let case = driven.document().case.clone().unwrap();
    let field = case.field("SOIL", pick.step).unwrap();
    let value = field.value(&case.grid, case.grid.dims().cell(hit.ijk));
    assert_eq!(
        (pick.property.as_str(), value.map(f64::from)),
        ("SOIL", Some(hit.value))
    );
    assert!(driven.harness.state().picture(0).unwrap().1, "still final");
    driven.click_at(place.center(), Modifiers::NONE);
    driven.wait("the selection", |w| {
        w.document().is_some_and(|d| !d.state.selected.is_empty())
    });
    assert_eq!(driven.document().state.selected, [hit.ijk.one_based()]);
    // Another step has other values: what was read does not stay.
    driven.press(Modifiers::NONE, Key::Home);
    assert!(driven.harness.state().hovered().is_none());
    driven.wait("the value of the first step", |w| {
        w.hovered().is_some_and(|pick| pick.step == 0)
    });
    // In the other mode too.
    let show = Show {
        hull: Hull::Opaque,
        ..Show::default()
    };
    driven.harness.state_mut().apply(Action::Show(show));
    driven.wait("the outer face", |w| {
        let hit = w.hovered().and_then(|pick| pick.hit.as_ref());
        hit.is_some_and(|h| matches!(h.part, Part::Face(_) | Part::Fault(_)))
    });
}

#[test]
fn right_of_a_wipe_the_second_picture_is_read() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    driven
        .harness
        .state_mut()
        .apply(Action::Compare(Some(Comparison {
            property: Some("PORO".into()),
            layout: Layout::Wipe(0.5),
            ..Comparison::default()
        })));
    driven.wait_final();
    let place = driven.place("volume");
    for (x, property) in [(0.45, "SOIL"), (0.55, "PORO")] {
        let at = place.min + vec2(x, 0.5) * place.size();
        driven.click_at(at, Modifiers::NONE);
        driven.wait("the pick", |w| {
            let pick = w.document().and_then(|d| d.pick.as_ref());
            pick.is_some_and(|p| p.property == property)
        });
        driven.harness.hover_at(at + vec2(0.0, 3.0));
        driven.wait("the reading", |w| {
            w.hovered().is_some_and(|p| p.property == property)
        });
    }
}

#[test]
fn keys_and_buttons_step_along_the_line_of_sight() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    // Nothing to step along yet.
    driven.press(Modifiers::NONE, Key::Period);
    assert!(
        driven
            .harness
            .state()
            .message()
            .is_some_and(|m| m.0.contains("click a cell first"))
    );
    let place = driven.place("volume");
    driven.click_at(place.center(), Modifiers::NONE);
    driven.wait("the selection", |w| {
        w.document().is_some_and(|d| d.pick.is_some())
    });
    let pick = driven.document().pick.clone().unwrap();
    let cells: Vec<[usize; 3]> = pick.cells.iter().map(|c| c.ijk.one_based()).collect();
    let [before, behind] = pick.around(pick.hit.as_ref().unwrap().ijk).unwrap();
    driven.wait_settled();
    driven.harness.get_by_label(&told(before, behind));
    assert!(before + behind > 1);
    for _ in 0..before {
        driven.press(Modifiers::NONE, Key::Comma);
    }
    assert_eq!(driven.document().state.selected, [cells[0]]);
    driven.press(Modifiers::NONE, Key::Comma);
    assert_eq!(driven.document().state.selected, [cells[0]]);
    for cell in &cells[1..] {
        driven.press(Modifiers::NONE, Key::Period);
        assert_eq!(driven.document().state.selected, [*cell]);
    }
    driven.wait_settled();
    driven.harness.get_by_label(&told(cells.len() - 1, 0));
    driven.click("Cell in front, along the line of sight (,)");
    assert_eq!(driven.document().state.selected, [cells[cells.len() - 2]]);
    // Of several cells the last one steps.
    let kept = cells[0];
    for cell in [kept, cells[1]] {
        let beside = if cell == kept {
            Beside::Nothing
        } else {
            Beside::Others
        };
        driven
            .harness
            .state_mut()
            .apply(Action::Select(cell, beside));
    }
    driven.press(Modifiers::NONE, Key::Period);
    assert_eq!(driven.document().state.selected, [kept, cells[2]]);
}

fn told(before: usize, behind: usize) -> String {
    let cells = if before == 1 { "cell" } else { "cells" };
    format!("{before} {cells} in front, {behind} behind")
}

#[test]
fn a_pointer_that_rests_on_a_fault_reads_its_throw() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    driven.click("Fault surfaces");
    driven.press(Modifiers::COMMAND.plus(Modifiers::ALT), Key::E);
    driven.wait_final();
    // F2 lies between columns 24 and 25 and is seen from the west there.
    let case = driven.document().case.clone().unwrap();
    let grid = &case.grid;
    let (cell, beyond) = (Ijk { i: 23, j: 5, k: 0 }, Ijk { i: 24, j: 5, k: 0 });
    let view = driven.harness.state().picture(0).unwrap().0.view.clone();
    let corners = grid.hexahedron(cell).0;
    let face = [1, 3, 5, 7].map(|n: usize| corners[n]);
    let world = view
        .spaces
        .world_from_grid
        .transform_point3(face.iter().sum::<glam::DVec3>() / 4.0);
    let at = view.camera.project(world, view.aspect()).unwrap();
    let place = driven.place("volume");
    let at = place.min + vec2(at.x as f32, at.y as f32) * place.size();
    driven.harness.hover_at(at);
    driven.wait("the fault", |w| w.hovered().is_some());
    let pick = driven.harness.state().hovered().unwrap().clone();
    let fault = pick.fault.clone().unwrap();
    assert!(fault.name.is_some_and(|n| n.starts_with('F')));
    assert!(fault.near.i < fault.far.i || fault.near.j != fault.far.j);
    // The throw of whatever face it is, from the depths of both cells alone.
    let [low, high] = [[0, 2], [1, 3]];
    let sides = if fault.near.i < fault.far.i {
        [high, low]
    } else {
        [low, high]
    };
    if fault.near.j == fault.far.j {
        let depth = |cell: Ijk, corners: [usize; 2]| {
            let all = corners.into_iter().flat_map(|c| [c, c + 4]);
            all.map(|c| grid.corner_depth(cell, c)).sum::<f64>() / 4.0
        };
        let drop = depth(fault.far, sides[1]) - depth(fault.near, sides[0]);
        assert!((drop - fault.throw).abs() < 1e-9, "{drop} {}", fault.throw);
        assert!(fault.throw.abs() > 1.0);
    }
    assert!(grid.is_active(cell) && grid.is_active(beyond));
    // Away from it, nothing is read.
    driven.harness.hover_at(place.left_top() + vec2(5.0, 5.0));
    driven.wait_settled();
    driven.wait_settled();
    assert!(driven.harness.state().hovered().is_none());
}
