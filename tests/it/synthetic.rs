//! Synthetic models: what is written is read back, by seed, with the structure of real fields.

use std::path::{Path, PathBuf};
use std::process::Command;

use strataray::case::{Case, WellKind, load};
use strataray::export::{ExportError, synthetic};
use strataray::model::corner_point::NO_THICKNESS;
use strataray::model::synthetic::{Fields, RECIPES, Recipe, Synthetic, Well};
use strataray::model::topology::COINCIDENT;
use strataray::model::{CellIndex, Dims, Grid, GridInput, Ijk, ModelError};
use strataray::render::plan::{CompactGrid, drawn_words};
use strataray::scene::Storage;

const STEPS: usize = 10;

fn dims(ni: usize, nj: usize, nk: usize) -> Dims {
    Dims { ni, nj, nk }
}

fn build(name: &str, dims: Dims, seed: u64) -> Synthetic {
    let recipe = Recipe::named(name).unwrap();
    recipe.build(dims, seed, STEPS).unwrap()
}

fn target(folder: &Path) -> synthetic::Target<'_> {
    synthetic::Target {
        folder,
        name: "MODEL",
        text: true,
    }
}

fn write(model: Synthetic, folder: &Path) -> Vec<PathBuf> {
    synthetic::write(model, &target(folder), &|_| true).unwrap()
}

/// The grid of a model without going through files.
fn grid(name: &str, dims: Dims, seed: u64) -> Grid {
    let geometry = build(name, dims, seed).geometry;
    Grid::new(&GridInput {
        dims,
        coord: &geometry.coord,
        zcorn: &geometry.zcorn,
        actnum: Some(&geometry.actnum),
        map_axes: None,
    })
    .unwrap()
}

fn values(case: &Case, name: &str, step: usize) -> Vec<f32> {
    case.field(name, step).unwrap().values().to_vec()
}

/// Wells of all steps are those of the model, open to their cells.
fn check_wells(case: &Case, expected: &[Well]) {
    let names: Vec<&String> = expected.iter().map(|well| &well.name).collect();
    assert_eq!(case.about.wells.iter().collect::<Vec<_>>(), names);
    for step in 0..case.steps.len() {
        let wells = case.wells(step).unwrap();
        assert_eq!(wells.len(), expected.len());
        for (well, made) in wells.iter().zip(expected) {
            let kind = match made.is_injector {
                true => WellKind::WaterInjector,
                false => WellKind::Producer,
            };
            assert_eq!((well.kind, well.is_open), (kind, true));
            assert!(well.connections.iter().all(|c| c.is_open));
            let cells: Vec<Ijk> = well.cells(&case.grid).collect();
            assert_eq!(cells, made.cells);
            assert!(!cells.is_empty() && cells.iter().all(|cell| case.grid.is_active(*cell)));
        }
    }
}

#[test]
fn ok_every_model_reads_back_as_it_was_made() {
    for recipe in &RECIPES {
        let folder = tempfile::tempdir().unwrap();
        let model = build(&recipe.name.to_uppercase(), dims(14, 11, 7), 3);
        let expected = build(recipe.name, dims(14, 11, 7), 3);
        let files = write(model, &folder.path().join("made/anew"));
        assert_eq!(files.len(), 4);
        let actnum = &expected.geometry.actnum;
        let active = actnum.iter().filter(|a| **a != 0).count();
        for (grid, hides_init) in [(&files[0], false), (&files[3], true)] {
            let case = load::open(grid).unwrap();
            // Of a grid in text, the arrays in the same file stand for those of INIT.
            let is_told = |note: &String| note.ends_with("the values of the text file are shown");
            let notes = &case.about.notes;
            assert_eq!(notes.len(), usize::from(hides_init), "{notes:?}");
            assert!(notes.iter().all(is_told), "{notes:?}");
            assert_eq!(case.grid.dims(), dims(14, 11, 7));
            assert_eq!(case.grid.active_cells().len(), active);
            assert_eq!(case.about.map_axes, expected.geometry.map_axes);
            let faults = case.grid.fault_faces().iter().sum::<usize>();
            assert_eq!(
                faults > 0,
                recipe.name != "box",
                "{}: {faults}",
                recipe.name
            );
            check_wells(&case, expected.fields.wells());
            for (step, of) in case.steps.iter().zip(&expected.steps) {
                let found = (step.report, &step.date, step.days);
                assert_eq!(found, (of.report, &of.date, of.days));
                for name in Fields::DYNAMIC {
                    let made = expected.fields.values(name, of.time).unwrap();
                    assert_eq!(values(&case, name, step.report as usize), made, "{name}");
                }
            }
            assert_eq!(case.steps.len(), STEPS);
            for name in Fields::STATIC {
                let made = expected.fields.values(name, 0.0).unwrap();
                assert_eq!(values(&case, name, 0), made, "{name}");
            }
            for (corner, z) in expected.geometry.zcorn.iter().enumerate() {
                let (x, y, plane) = (corner % 28, corner / 28 % 22, corner / (28 * 22));
                let ijk = Ijk {
                    i: x / 2,
                    j: y / 2,
                    k: plane / 2,
                };
                let read = case
                    .grid
                    .corner_depth(ijk, x % 2 + 2 * (y % 2) + 4 * (plane % 2));
                assert_eq!(read as f32, *z, "{} corner {corner}", recipe.name);
            }
        }
    }
}

#[test]
fn ok_steps_have_dates_of_the_calendar() {
    let steps = |count: usize| Recipe::named("box").unwrap().build(dims(1, 1, 1), 1, count);
    let default = steps(STEPS).unwrap().steps;
    // 2000 and 2004 are leap years: 366 + 365 days, then 365 + 365.
    let days: Vec<f64> = default.iter().take(4).map(|s| s.days).collect();
    assert_eq!(days, [0.0, 731.0, 1461.0, 2192.0]);
    assert_eq!(default[9].date, "2018-01-01");
    assert_eq!((default[0].time, default[9].time), (0.0, 1.0));
    let monthly = steps(300).unwrap().steps;
    assert_eq!(
        (monthly[2].date.as_str(), monthly[2].days),
        ("2000-03-01", 60.0)
    );
    assert_eq!(
        (monthly[14].date.as_str(), monthly[14].days),
        ("2001-03-01", 425.0)
    );
    assert_eq!(monthly[299].date, "2024-12-01");
    assert_eq!(steps(1).unwrap().steps.len(), 1);
}

#[test]
fn ok_the_seed_alone_decides() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = |name: &str, seed: u64, threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let folder = folder.path().join(format!("{name}-{seed}-{threads}"));
        let make = || write(build(name, dims(20, 17, 9), seed), &folder);
        let files = pool.build().unwrap().install(make);
        files
            .iter()
            .map(|f| std::fs::read(f).unwrap())
            .collect::<Vec<_>>()
    };
    let first = bytes("faulted", 1, 1);
    assert!(first == bytes("faulted", 1, 3), "the same seed");
    for (a, b) in first.iter().zip(bytes("faulted", 2, 1)) {
        assert!(*a != b, "another seed");
    }
}

#[test]
fn ok_active_cells_are_about_those_of_the_table() {
    let is_small = |r: &&Recipe| r.dims.cells() < 10_000_000;
    for recipe in RECIPES.iter().filter(is_small) {
        let active = |dims: Dims| {
            let geometry = build(recipe.name, dims, 1).geometry;
            geometry.actnum.iter().filter(|a| **a != 0).count() as f64
        };
        let found = active(recipe.dims) / recipe.active as f64;
        assert!((found - 1.0).abs() < 0.02, "{}: {found}", recipe.name);
        // A twentieth of the layers keeps the share, and so not the number.
        let fewer = dims(recipe.dims.ni, recipe.dims.nj, recipe.dims.nk.div_ceil(20));
        let share = active(fewer) / fewer.cells() as f64;
        let expected = recipe.active as f64 / recipe.dims.cells() as f64;
        assert!((share - expected).abs() < 0.03, "{}: {share}", recipe.name);
    }
}

#[test]
fn ok_geometry_and_acceleration_take_a_quarter_of_the_published_bytes() {
    // Bytes an active cell of campagnolo-2021.
    for (name, published) in [
        ("r1", 96.0),
        ("r2", 83.0),
        ("r3", 109.0),
        ("r4", 65.0),
        ("r5", 35.5),
    ] {
        let grid = grid(name, Recipe::named(name).unwrap().dims, 1);
        let compact = CompactGrid::new(&grid, Storage::Exact).unwrap();
        let drawn = drawn_words(&grid, &[]);
        let bytes = size_of_val(&*compact.pillars)
            + size_of_val(&*compact.column_lists)
            + size_of_val(&*compact.depths)
            + size_of_val(&*compact.bins)
            + size_of_val(&*compact.bin_columns)
            + size_of_val(&*drawn);
        let each = bytes as f64 / grid.active_cells().len() as f64;
        println!("{name}: {each:.2} bytes an active cell");
        assert!(each <= published / 4.0, "{name}: {each}");
    }
}

/// How many of the active cells' neighbors, edges and interfaces are as only real fields have them.
#[derive(Debug, Default)]
struct Odd {
    inverted: usize,
    collapsed_edges: usize,
    zero_thickness: usize,
    gaps: usize,
    sloping_pillars: usize,
    /// Lateral faces whose other side lies deeper, and higher.
    throws: [usize; 2],
}

fn odd(grid: &Grid) -> Odd {
    let mut odd = Odd::default();
    let dims = grid.dims();
    for cell in 0..dims.cells() {
        let ijk = dims.ijk(CellIndex(cell as u32));
        let height = |c: usize| grid.corner_depth(ijk, c + 4) - grid.corner_depth(ijk, c);
        let collapsed = (0..4).filter(|&c| height(c) <= NO_THICKNESS).count();
        odd.zero_thickness += usize::from(collapsed == 4);
        if !grid.is_active(ijk) {
            continue;
        }
        assert!((0..4).all(|c| height(c) >= 0.0), "layers do not cross");
        odd.collapsed_edges += collapsed;
        odd.inverted += usize::from(grid.hexahedron(ijk).signed_volume() <= 0.0);
        let gap =
            |c: usize, below: Ijk| grid.corner_depth(below, c) - grid.corner_depth(ijk, c + 4);
        if ijk.k + 1 < dims.nk {
            let below = Ijk {
                k: ijk.k + 1,
                ..ijk
            };
            odd.gaps += usize::from((0..4).any(|c| gap(c, below) > COINCIDENT));
        }
        if ijk.i + 1 < dims.ni {
            let next = Ijk {
                i: ijk.i + 1,
                ..ijk
            };
            let throw = grid.corner_depth(next, 0) - grid.corner_depth(ijk, 1);
            odd.throws[0] += usize::from(throw > 1.0);
            odd.throws[1] += usize::from(throw < -1.0);
        }
    }
    let slopes = grid.pillars().iter().map(|p| p.slope().length());
    odd.sloping_pillars = slopes.filter(|s| *s > 0.01).count();
    odd
}

#[test]
fn ok_structure_of_real_fields() {
    for seed in 1..=5 {
        let field = odd(&grid("faulted", dims(40, 30, 16), seed));
        assert_eq!(field.inverted, 0, "seed {seed}");
        let Odd {
            collapsed_edges,
            zero_thickness,
            gaps,
            sloping_pillars,
            throws,
            ..
        } = field;
        let counts = [collapsed_edges, zero_thickness, gaps, sloping_pillars];
        let common = counts.iter().chain(&throws).all(|&n| n > 20);
        assert!(common, "seed {seed}: {field:?}");
    }
    let plain = odd(&grid("box", dims(40, 30, 16), 1));
    let Odd {
        collapsed_edges,
        gaps,
        sloping_pillars,
        throws,
        inverted,
        zero_thickness,
    } = plain;
    let counts = [
        collapsed_edges,
        gaps,
        sloping_pillars,
        inverted,
        zero_thickness,
    ];
    assert_eq!((counts, throws), ([0; 5], [0; 2]));
}

#[test]
fn ok_any_dimensions() {
    let shapes = [(1, 1, 1), (1, 1, 40), (40, 1, 1), (1, 40, 2), (2, 3, 300)];
    for (recipe, (ni, nj, nk)) in RECIPES.iter().flat_map(|r| shapes.map(|s| (r, s))) {
        let grid = grid(recipe.name, dims(ni, nj, nk), 5);
        let active = grid.active_cells().len();
        assert!(active > 0, "{} {ni} {nj} {nk}", recipe.name);
        assert_eq!(odd(&grid).inverted, 0, "{} {ni} {nj} {nk}", recipe.name);
        let values = build(recipe.name, dims(ni, nj, nk), 5)
            .fields
            .values("SWAT", 0.5);
        assert_eq!(values.map(|v| v.len()), Some(active));
    }
}

#[test]
fn err_impossible_dimensions() {
    let refusal = |ni, nj, nk| {
        let recipe = Recipe::named("faulted").unwrap();
        recipe.build(dims(ni, nj, nk), 1, 1).err()
    };
    for (ni, nj, nk) in [(0, 5, 5), (1 << 31, 1, 1), (1 << 40, 1 << 40, 1 << 40)] {
        assert_eq!(
            refusal(ni, nj, nk),
            Some(ModelError::Dimensions(ni, nj, nk))
        );
    }
    assert_eq!(refusal(2, 2, 1), None);
    assert!(Recipe::named("r7").is_none());
}

#[test]
fn ok_saturations_add_up_and_the_front_moves() {
    for seed in 1..=3 {
        let fields = build("r2", dims(30, 25, 12), seed).fields;
        let at = |name: &str, time: f64| fields.values(name, time).unwrap();
        let mut flooded = Vec::new();
        for time in [0.0, 0.3, 0.6, 1.0] {
            let (water, gas) = (at("SWAT", time), at("SGAS", time));
            let physical = |(w, g): (&f32, &f32)| *w > 0.05 && *g >= 0.0 && w + g < 1.0 + 1e-6;
            assert!(water.iter().zip(&gas).all(physical), "seed {seed}, {time}");
            let start = at("SWAT", 0.0);
            flooded.push(
                water
                    .iter()
                    .zip(&start)
                    .filter(|(a, b)| **a > **b + 0.05)
                    .count(),
            );
        }
        assert_eq!(flooded[0], 0);
        assert!(flooded.windows(2).all(|w| w[0] < w[1]), "{flooded:?}");
        assert_eq!(at("PORO", 0.0), at("PORO", 1.0));
    }
}

#[test]
fn ok_box_has_known_answers() {
    let folder = tempfile::tempdir().unwrap();
    let files = write(build("box", dims(10, 8, 4), 9), folder.path());
    let case = load::open(&files[0]).unwrap();
    let volume: f64 = values(&case, "CELL_VOLUME", 0)
        .iter()
        .map(|v| f64::from(*v))
        .sum();
    assert!((volume - 1000.0 * 800.0 * 40.0).abs() < 1.0, "{volume}");
    let [low, high] = case.grid.bounds().unwrap();
    assert_eq!(low.to_array(), [0.0, 0.0, 2000.0]);
    assert_eq!(high.to_array(), [1000.0, 800.0, 2040.0]);
    let cell = case.grid.dims().cell(Ijk { i: 3, j: 5, k: 1 });
    let value = |name: &str, step: usize| {
        let field = case.field(name, step).unwrap();
        f64::from(field.value(&case.grid, cell).unwrap())
    };
    let (u, v, w) = (3.5 / 10.0, 5.5 / 8.0, 1.5 / 4.0);
    for (name, step, expected) in [
        ("PORO", 0, 0.1 + 0.2 * u),
        ("PERMX", 0, 100.0 + 900.0 * v),
        ("NTG", 0, 0.5 + 0.5 * w),
        ("PRESSURE", 0, 200.0 + 50.0 * w),
        ("PRESSURE", 9, 180.0 + 50.0 * w),
        ("SWAT", 9, 0.5 + 0.3 * u),
    ] {
        assert!((value(name, step) - expected).abs() < 1e-4, "{name}@{step}");
    }
    assert!((value("SWAT", 9) - value("SWAT", 0)).abs() > 0.2);
}

fn sample(arguments: &[&str], folder: &Path) -> (bool, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_strataray"))
        .arg("sample")
        .args(arguments)
        .arg("-o")
        .arg(folder)
        .output()
        .unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|b| String::from_utf8(b).unwrap());
    assert!(!err.contains("panicked"), "{err}");
    (output.status.success(), out, err)
}

#[test]
fn command_says_which_files_it_wrote() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("new/models");
    for _ in 0..2 {
        let (ok, files, said) = sample(&["R1", "--dims", "6,5,4", "--steps", "3"], &to);
        assert!(ok && said.contains("strataray render"), "{said}");
        assert_eq!(files.lines().count(), 4);
        assert!(files.lines().all(|f| Path::new(f).exists()), "{files}");
        let case = load::open(&to.join("R1")).unwrap();
        assert_eq!((case.grid.dims(), case.steps.len()), (dims(6, 5, 4), 3));
    }
}

#[test]
fn err_command_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "no folder").unwrap();
    for (arguments, to, word) in [
        (vec!["r1", "--dims", "0,5,5"], folder.path(), "0 x 5 x 5"),
        (vec!["r1", "--dims", "5,5"], folder.path(), "220,100,50"),
        (vec!["r9"], folder.path(), "faulted"),
        (vec!["r1", "--steps", "0"], folder.path(), "--steps"),
        (vec!["box"], file.as_path(), "cannot write"),
    ] {
        let (ok, _, said) = sample(&arguments, to);
        assert!(!ok && said.contains(word), "{arguments:?}: {said}");
    }
}

#[test]
fn ok_canceled_writing_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let model = build("box", dims(2, 2, 2), 1);
    let result = synthetic::write(model, &target(folder.path()), &|done| done < 0.3);
    assert!(matches!(result, Err(ExportError::Canceled)));
}
