//! Selecting: filters, clip planes, cells.

use eframe::egui::{self, Key, Modifiers, pos2, vec2};
use egui_kittest::kittest::Queryable;
use strataray::model::Ijk;
use strataray::picking::Part;
use strataray::scene::{Hull, OpacitySpec, Show};
use strataray::viewer::{Action, Beside, CompareLayout, Comparison, CurvePlots};

use super::common::{gpu, sample};
use super::driven::Driven;

#[test]
fn a_clip_plane_is_moved_by_its_handle() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let all = driven.covered();
    driven.click("Clip planes");
    driven.wait_settled();
    driven.click("East");
    driven.wait_final();
    let half = driven.covered();
    assert!(half < 0.95 * all, "{half} {all}");
    let plane = driven.scene().clip[0].clone();
    let handle = driven.place("move plane 1").center();
    let tip = driven.place("lean plane 1").center();
    driven.drag(handle, handle + 2.0 * (tip - handle));
    let moved = driven.scene().clip[0].clone();
    assert_eq!(moved.normal, plane.normal);
    assert!(moved.point[0] > plane.point[0] + 1.0, "{moved:?} {plane:?}");
    driven.wait_final();
    assert!(driven.covered() < half);
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
    let world = view.world.spaces.world_from_grid.transform_point3(top);
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
    assert_eq!(curves.curves[0].points[0].len(), case.steps.len());
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
    let before = driven.covered();
    // Room for the panel of selected cells.
    driven.click("Transfer function");
    driven.wait_settled();
    driven.click("Filter to similar values");
    assert_eq!(driven.scene().filter.properties.len(), 1);
    driven.wait_final();
    assert!(driven.covered() < before);
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
            layout: CompareLayout::Wipe(0.5),
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
    // Cells that hide no fault.
    let mut transfer = driven.scene().transfer.clone();
    transfer.opacity = Some(OpacitySpec::Points(vec![[0.0, 0.01], [1.0, 0.01]]));
    driven.harness.state_mut().apply(Action::Transfer(transfer));
    driven.wait_final();
    // F2 lies between columns 24 and 25 and is seen from the west there.
    let case = driven.document().case.clone().unwrap();
    let grid = &case.grid;
    let (cell, beyond) = (Ijk { i: 23, j: 5, k: 0 }, Ijk { i: 24, j: 5, k: 0 });
    let view = driven.harness.state().picture(0).unwrap().0.view.clone();
    let corners = grid.hexahedron(cell).0;
    let face = [1, 3, 5, 7].map(|n: usize| corners[n]);
    let world = view
        .world
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

/// Selects some cells and waits for their values.
fn select(driven: &mut Driven, cells: &[[usize; 3]]) {
    for (n, cell) in cells.iter().enumerate() {
        let beside = if n == 0 {
            Beside::Nothing
        } else {
            Beside::Others
        };
        driven
            .harness
            .state_mut()
            .apply(Action::Select(*cell, beside));
    }
    let count = cells.len();
    driven.wait("values and curves", |w| {
        let document = w.document().unwrap();
        let table = document.table.as_ref();
        let curves = document.curves.as_ref();
        table.is_some_and(|t| t.of.cells.len() == count)
            && curves.is_some_and(|c| c.of.cells.len() == count)
    });
    driven.step();
}

#[test]
fn many_cells_are_a_table_that_scrolls() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    // Room for the panel of selected cells.
    driven.click("Transfer function");
    driven.wait_settled();
    let cells: Vec<[usize; 3]> = (1..=12).map(|i| [i + 8, 9, 1]).collect();
    select(&mut driven, &cells);
    driven.wait_settled();
    let window = egui::Rect::from_min_size(egui::Pos2::ZERO, vec2(1280.0, 800.0));
    let head = |cell: &[usize; 3]| format!("{}, {}, {}", cell[0], cell[1], cell[2]);
    assert!(window.contains_rect(driven.place(&head(&cells[0]))));
    assert!(driven.harness.query_by_label(&head(&cells[11])).is_none());
    // To the right and down; heads and names stay.
    let names = driven.last_place("PORO");
    driven
        .harness
        .hover_at(driven.place(&head(&cells[0])).center() + vec2(0.0, 60.0));
    driven.step();
    let scroll = |delta| egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta,
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    };
    driven.harness.event(scroll(vec2(-5000.0, 0.0)));
    driven.wait_settled();
    let last = driven.place(&head(&cells[11]));
    assert!(window.contains_rect(last), "{last:?}");
    assert_eq!(driven.last_place("PORO"), names);
    let top = last.top();
    driven.harness.event(scroll(vec2(0.0, -60.0)));
    driven.wait_settled();
    assert_eq!(driven.place(&head(&cells[11])).top(), top);
}

#[test]
fn curves_have_a_window_with_dates_and_several_properties() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    select(&mut driven, &[[23, 6, 2], [27, 6, 2]]);
    driven.press(Modifiers::COMMAND, Key::G);
    assert!(driven.document().state.curves.is_open);
    let plots = CurvePlots {
        is_open: true,
        properties: vec!["SWAT".into(), "PRESSURE".into()],
        vectors: Vec::new(),
    };
    driven.harness.state_mut().apply(Action::Curves(plots));
    driven.wait("both curves", |w| {
        let curves = w.document().and_then(|d| d.curves.as_ref());
        curves.is_some_and(|c| c.curves.len() == 2)
    });
    driven.wait_settled();
    // The values at the pointer, at the step that it is nearest to, in all plots.
    let case = driven.document().case.clone().unwrap();
    let shown = driven.document().step().unwrap().0;
    let at = |step: usize| format!("{}   day {}", case.steps[step].date, case.steps[step].days);
    driven.harness.get_by_label(&at(shown));
    let first = driven.last_place("SWAT");
    driven
        .harness
        .hover_at(first.left_bottom() + vec2(150.0, 50.0));
    driven.wait_settled();
    assert!(driven.harness.query_by_label(&at(shown)).is_none());
    let told: Vec<usize> = (0..case.steps.len())
        .filter(|n| driven.harness.query_by_label(&at(*n)).is_some())
        .collect();
    assert_eq!(told.len(), 1, "{told:?}");
    for (n, name) in ["SWAT", "PRESSURE"].into_iter().enumerate() {
        let field = case.field(name, told[0]).unwrap();
        let dims = case.grid.dims();
        let value = field.value(&case.grid, dims.cell(dims.one_based([23, 6, 2]).unwrap()));
        let curves = driven.document().curves.clone().unwrap();
        let read = curves.curves[n].points[0].iter().find(|p| p.0 == told[0]);
        assert_eq!(read.map(|p| p.1), value);
    }
    // Closed and opened again.
    driven.press(Modifiers::COMMAND, Key::G);
    driven.wait_settled();
    assert_eq!(
        driven.places("SWAT").len(),
        1,
        "the list of properties has it"
    );
    driven.click("Curves ...");
    driven.wait_settled();
    assert_eq!(driven.places("SWAT").len(), 2);
}

#[test]
fn cells_are_saved_as_one_tidy_table() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let cells = [[23, 6, 2], [27, 6, 2]];
    select(&mut driven, &cells);
    let file = driven.folder.path().join("cells.csv");
    driven.harness.state().save_table(&file).unwrap();
    let mut reader = csv::Reader::from_path(&file).unwrap();
    let heads: Vec<String> = reader.headers().unwrap().iter().map(String::from).collect();
    assert_eq!(
        heads.join(","),
        "case,grid,i,j,k,date,step,property,value,unit"
    );
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let case = driven.document().case.clone().unwrap();
    let document = driven.document();
    let shown = document.step().unwrap().0;
    let mut seen = std::collections::BTreeSet::new();
    for row in &rows {
        assert_eq!((&row[0], &row[1]), ("SCISSOR", "global"));
        let cell = [2, 3, 4].map(|n: usize| row[n].parse::<usize>().unwrap());
        assert!(cells.contains(&cell));
        let step = row[6].parse::<usize>().ok();
        assert_eq!(step.is_some(), case.is_dynamic(&row[7]), "{row:?}");
        let date = step.map_or("", |n| case.steps[n].date.as_str());
        assert_eq!((&row[5], &row[9]), (date, case.unit(&row[7])));
        let field = case.field(&row[7], step.unwrap_or(shown)).unwrap();
        let dims = case.grid.dims();
        let value = field.value(&case.grid, dims.cell(dims.one_based(cell).unwrap()));
        assert_eq!(row[8].parse::<f32>().ok(), value);
        assert!(
            seen.insert((cell, step, row[7].to_owned())),
            "{row:?} is there twice"
        );
    }
    // The property shown at every step, the others at the one that is shown.
    let property = document.state.setup.scene.property.clone().unwrap();
    let of = |name: &str| rows.iter().filter(|r| &r[7] == name).count();
    assert_eq!(of(&property), 2 * case.steps.len());
    assert_eq!((of("PORO"), of("PRESSURE")), (2, 2));
}
