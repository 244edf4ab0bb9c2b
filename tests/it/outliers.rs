//! Cells at damaged numbers of a grid file: left out and named, and all else as it was, in no more time.

use std::path::Path;

use crate::common;
use serde_json::json;
use strataray::case::{Case, load};
use strataray::image::metrics::psnr_8bit;
use strataray::model::{Grid, GridInput, Ijk};
use strataray::parsers::Warnings;
use strataray::parsers::egrid::Egrid;
use strataray::render::cpu::CpuExecutor;
use strataray::render::{Executor, Frame};
use strataray::view::{self, View};

/// Values of a block of an array, and bytes of a block.
const BLOCK: [usize; 2] = [1000, 4008];

/// The case with some numbers of its grid changed; its results are the same.
fn damaged(folder: &Path, model: &Path, keyword: &str, numbers: &[(usize, f32)]) -> Case {
    for file in std::fs::read_dir(model.parent().unwrap()).unwrap() {
        let file = file.unwrap().path();
        if file.is_file() {
            std::fs::copy(&file, folder.join(file.file_name().unwrap())).unwrap();
        }
    }
    let path = folder.join(model.file_name().unwrap());
    let mut bytes = std::fs::read(&path).unwrap();
    let name = format!("{keyword:<8}");
    let at = bytes.windows(8).position(|w| w == name.as_bytes()).unwrap();
    for (number, value) in numbers {
        let place = at + 24 + number / BLOCK[0] * BLOCK[1] + 4 * (number % BLOCK[0]);
        bytes[place..place + 4].copy_from_slice(&value.to_be_bytes());
    }
    std::fs::remove_file(&path).unwrap();
    std::fs::write(&path, bytes).unwrap();
    load::open(&path).unwrap()
}

fn view(case: &Case, strategy: &str) -> View {
    let written =
        json!({"size": [120, 90], "mode": "volume", "property": "PORO", "strategy": strategy});
    let scene = view::look::opening(case, &written).unwrap();
    view::resolve(&scene, case).unwrap()
}

fn frame(case: &Case, view: &View) -> Frame {
    let mut renderer = CpuExecutor::default().renderer(&case.grid).unwrap();
    renderer.render(view, &|_| true).unwrap()
}

/// Values of a property by cell of the file.
fn values(case: &Case, name: &str, step: usize) -> Vec<(u32, f32)> {
    let field = case.field(name, step).unwrap();
    let cells = case.grid.active_cells().iter().map(|cell| cell.0);
    cells.zip(field.values().iter().copied()).collect()
}

/// An active cell in the middle of the model, and the number of the first corner of its top in ZCORN.
fn middle(case: &Case) -> (Ijk, usize) {
    let dims = case.grid.dims();
    let cells = case.grid.active_cells();
    let thick = case.grid.thick();
    let n = (cells.len() / 2..).find(|n| thick[*n]).unwrap();
    let cell = dims.ijk(cells[n]);
    let Ijk { i, j, k } = cell;
    (cell, 2 * i + 2 * dims.ni * (2 * j + 2 * dims.nj * 2 * k))
}

#[test]
fn one_wild_number_leaves_the_rest_of_the_picture_as_it_was() {
    let Some(model) = common::data("reek/REEK.EGRID") else {
        return;
    };
    let sound = load::open(&model).unwrap();
    let (cell, corner) = middle(&sound);
    let dims = sound.grid.dims();
    let pillar = 6 * (cell.i + (dims.ni + 1) * cell.j);
    let frames = ["plts", "libc", "srg"].map(|by| frame(&sound, &view(&sound, by)));
    for (keyword, number, value) in [
        ("ZCORN", corner, 1e30),
        ("ZCORN", corner, f32::NEG_INFINITY),
        ("COORD", pillar, 1e30),
        ("COORD", pillar + 4, f32::NAN),
        ("COORD", pillar + 5, 1e30),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let case = damaged(folder.path(), &model, keyword, &[(number, value)]);
        let told = case
            .about
            .notes
            .iter()
            .find(|n| n.contains("times the extent"));
        let told = told.unwrap();
        let left_out = sound.grid.active_cells().len() - case.grid.active_cells().len();
        assert!(
            told.contains(&format!("left out: {left_out} of them")),
            "{told}"
        );
        assert!(!case.grid.is_active(cell));
        let [i, j, k] = cell.one_based();
        match keyword {
            "ZCORN" => assert!(left_out == 1 && told.contains(&format!("({i},{j},{k})"))),
            _ => assert!((2..=4 * dims.nk).contains(&left_out), "{told}"),
        }
        // Each cell that is left has its own values.
        for (name, step) in [("PORO", 0), ("PRESSURE", 1)] {
            let [all, rest] = [&sound, &case].map(|case| values(case, name, step));
            let of_rest = |cell: &(u32, f32)| {
                case.grid
                    .active_index(strataray::model::CellIndex(cell.0))
                    .is_some()
            };
            let kept: Vec<_> = all.into_iter().filter(of_rest).collect();
            assert!(kept == rest, "{keyword} {name}");
        }
        for (by, before) in ["plts", "libc", "srg"].into_iter().zip(&frames) {
            let view = view(&case, by);
            let now = frame(&case, &view);
            assert_eq!(now.stats.lost_samples + now.stats.lost_rays, 0);
            let work = now.stats.work as f64 / before.stats.work as f64;
            assert!((0.8..1.2).contains(&work), "{by} {keyword} {value}: {work}");
            let covered = now.stats.covered_pixels as f64 / before.stats.covered_pixels as f64;
            assert!(
                (0.98..1.02).contains(&covered),
                "{by} {keyword} {value}: {covered}"
            );
            let [a, b] = [&before.image, &now.image]
                .map(|image| image.over_background_8bit(view.style.background));
            let near = psnr_8bit(a.as_flattened(), b.as_flattened());
            assert!(near > 25.0, "{by} {keyword} {value}: {near} dB");
        }
    }
}

#[test]
fn without_that_one_wild_number_is_all_that_is_framed() {
    let Some(model) = common::data("reek/REEK.EGRID") else {
        return;
    };
    let mut case = load::open(&model).unwrap();
    let size = |case: &Case| {
        view(case, "plts")
            .world
            .subject
            .extents
            .lengths
            .max_element()
    };
    assert!(size(&case) < 1e5);
    let mut egrid = Egrid::read(&model, &mut Warnings::default()).unwrap();
    egrid.zcorn[middle(&case).1] = 1e30;
    let [ni, nj, nk] = egrid.dims;
    let wild = Grid::new(&GridInput {
        dims: strataray::model::Dims { ni, nj, nk },
        coord: &egrid.coord,
        zcorn: &egrid.zcorn,
        actnum: egrid.actnum.as_deref(),
        map_axes: None,
    });
    case.grid = wild.unwrap().into();
    assert!(size(&case) > 1e20);
}

#[test]
fn models_at_hand_lose_no_cells() {
    for model in common::models() {
        let case = load::open(&model).unwrap();
        let told = |note: &&String| note.contains("times the extent") || note.contains("finite");
        assert_eq!(
            case.about.notes.iter().find(told),
            None,
            "{}",
            model.display()
        );
    }
}
