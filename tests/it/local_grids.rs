//! Local grids: drawn in place of the cells that they refine, with their own values, by every strategy.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use serde_json::{Value, json};
use strataray::case::{Case, CaseError, Source, ValueRange, load};
use strataray::image::Image;
use strataray::image::metrics::psnr_8bit;
use strataray::model::{CellIndex, Dims, Grid, GridInput, Ijk, LocalGrid};
use strataray::reference;
use strataray::render::Renderer;
use strataray::scene::StrategyKind;
use strataray::view::{self, View};
use strataray_parsers::Warnings;
use strataray_parsers::egrid::Egrid;

use crate::common::shape::parallelepipeds::{self, corner};
use crate::common::{self, tiny};

/// Cells that one is refined to along each axis.
const FINE: usize = 3;

/// The values of a case in memory.
pub struct Values(pub HashMap<String, Vec<f32>>);

impl Source for Values {
    fn values(&self, name: &str, _step: usize) -> Result<Option<Vec<f32>>, CaseError> {
        Ok(self.0.get(name).cloned())
    }
}

/// A vertex by numbers of the main grid that may lie between its own: places are linear in them.
fn vertex(at: DVec3) -> DVec3 {
    let first = corner(0, 0, 0);
    let [x, y, z] = [corner(1, 0, 0), corner(0, 1, 0), corner(0, 0, 1)].map(|p| p - first);
    first + at.x * x + at.y * y + at.z * z
}

/// A box of cells of a grid, refined.
struct Refined<'a> {
    name: &'a str,
    /// The grid: its number, its cells, where it begins in numbers of the main grid, and how large its cells are in them.
    parent: (usize, Dims, DVec3, f64),
    /// The first of its cells, and how many along each axis.
    first: [usize; 3],
    count: [usize; 3],
}

impl Refined<'_> {
    /// Where it begins in numbers of the main grid, and how large its cells are in them.
    fn place(&self) -> (DVec3, f64) {
        let (_, _, start, size) = self.parent;
        let first = DVec3::from_array(self.first.map(|n| n as f64));
        (start + size * first, size / FINE as f64)
    }

    fn dims(&self) -> Dims {
        let [ni, nj, nk] = self.count.map(|n| FINE * n);
        Dims { ni, nj, nk }
    }

    fn grid(&self) -> LocalGrid {
        let dims = self.dims();
        let Dims { ni, nj, nk } = dims;
        let (start, size) = self.place();
        let vertex =
            |i, j, k| vertex(start + size * DVec3::from_array([i, j, k].map(|n: usize| n as f64)));
        let mut coord = Vec::new();
        for j in 0..=nj {
            for i in 0..=ni {
                coord.extend([vertex(i, j, 0), vertex(i, j, nk)].map(|p| p.to_array()));
            }
        }
        let zcorn = (0..8 * dims.cells()).map(|at| {
            let (x, rest) = (at % (2 * ni), at / (2 * ni));
            let (y, z) = (rest % (2 * nj), rest / (2 * nj));
            vertex(x.div_ceil(2), y.div_ceil(2), z.div_ceil(2)).z
        });
        let zcorn: Vec<f64> = zcorn.collect();
        let grid = Grid::new(&GridInput {
            dims,
            coord: coord.as_flattened(),
            zcorn: &zcorn,
            actnum: None,
            map_axes: None,
        });
        let host = |cell: u32| {
            let own = dims.ijk(CellIndex(cell));
            self.parent.1.cell(Ijk {
                i: self.first[0] + own.i / FINE,
                j: self.first[1] + own.j / FINE,
                k: self.first[2] + own.k / FINE,
            })
        };
        LocalGrid {
            name: self.name.into(),
            parent: self.parent.0,
            grid: grid.unwrap(),
            layers: None,
            split: 1,
            is_reversed: false,
            hosts: (0..dims.cells() as u32).map(host).collect(),
        }
    }
}

/// The parallelepipeds with their linear field, of which a box in the midst is refined, and a box of that again; values
/// there are off by `off`. Values of the cells that are refined are no part of it.
pub fn case(off: f64) -> Case {
    let base = parallelepipeds::case(0.0);
    let outer = Refined {
        name: "OUTER",
        parent: (0, base.grid.dims(), DVec3::ZERO, 1.0),
        first: [2, 1, 1],
        count: [2, 3, 2],
    };
    let (start, size) = outer.place();
    let inner = Refined {
        name: "INNER",
        parent: (1, outer.dims(), start, size),
        first: [1, 2, 2],
        count: [3, 4, 2],
    };
    let locals = [outer.grid(), inner.grid()];
    let grid = Grid::clone(&base.grid).with_local_grids(&locals).unwrap();
    let finest = grid.finest().unwrap();
    let value = |(cell, is_finest): (&CellIndex, &bool)| {
        let at = grid.dims().ijk(*cell);
        let value = parallelepipeds::value(grid.hexahedron(at).center(), 0.0);
        match grid.patch_of(at) {
            _ if !is_finest => 1e3,
            Some(0) => value as f32,
            _ => (value + off) as f32,
        }
    };
    let values = grid.active_cells().iter().zip(&finest).map(value).collect();
    Case {
        grid: Arc::new(grid),
        source: Arc::new(Values(HashMap::from([("VALUE".to_owned(), values)]))),
        ..base
    }
}

/// A view of the volume, in which nothing depends on the size of the cells.
fn view(case: &Case, more: &Value) -> View {
    let mut written = json!({
        "size": [150, 110], "mode": "volume", "property": "VALUE", "range": [-6.0, 14.0],
        "vertical_exaggeration": 3.0, "sampling_step": 2.0, "lighting": {}, "show": {"hull": "hidden"},
        "transfer": {"color": "viridis", "opacity": [[0.0, 0.1], [0.5, 0.6], [1.0, 0.2]], "reference_length": 150.0},
        "camera": {"azimuth_degrees": 30, "elevation_degrees": 35},
    });
    let keys = written.as_object_mut().unwrap();
    keys.extend(more.as_object().unwrap().clone());
    let scene = view::look::opening(case, &written).unwrap();
    view::resolve(&scene, case).unwrap()
}

fn image(renderer: &mut dyn Renderer, view: &View) -> Image {
    let frame = renderer.render(view, &|_| true).unwrap();
    assert_eq!((frame.stats.lost_rays, frame.stats.lost_samples), (0, 0));
    frame.image
}

fn psnr(a: &Image, b: &Image, view: &View) -> f64 {
    let [a, b] = [a, b].map(|i| i.over_background_8bit(view.style.background));
    psnr_8bit(a.as_flattened(), b.as_flattened())
}

#[test]
fn a_box_that_is_refined_looks_as_it_did() {
    let (coarse, fine, wrong) = (parallelepipeds::case(0.0), case(0.0), case(3.0));
    for more in [
        json!({}),
        json!({"lighting": {"occlusion": {"mode": "preilluminated"}}}),
        json!({"clip": [{"point": [330.0, 250.0, -6000.0], "normal": [1.0, 0.3, 0.2]}]}),
    ] {
        let views = [&coarse, &fine, &wrong].map(|case| view(case, &more));
        for executor in common::executors() {
            let of = [&coarse, &fine, &wrong];
            let mut renderers = of.map(|case| executor.renderer(&case.grid).unwrap());
            for strategy in StrategyKind::ALL {
                let images: Vec<Image> = renderers
                    .iter_mut()
                    .zip(&views)
                    .map(|(renderer, view)| image(&mut **renderer, &view.by(strategy)))
                    .collect();
                let [same, other] = [1, 2].map(|n| psnr(&images[0], &images[n], &views[0]));
                let place = format!(
                    "{} {} {more}: {same:.1} dB, others {other:.1}",
                    executor.info().executor,
                    strategy.name()
                );
                println!("{place}");
                assert!(same >= 60.0 && other < 50.0, "{place}");
            }
        }
    }
}

#[test]
fn the_reference_sees_the_same_box() {
    let [coarse, fine] = [parallelepipeds::case(0.0), case(0.0)];
    let images = [&coarse, &fine].map(|case| {
        let view = view(case, &json!({}));
        reference::render(&case.grid, &view, &|_| true).unwrap()
    });
    let db = psnr(&images[0], &images[1], &view(&coarse, &json!({})));
    println!("reference: {db:.1} dB");
    assert!(db >= 60.0, "{db}");
}

#[test]
fn executors_see_local_grids_as_the_reference_does() {
    let mut cases = vec![case(0.7)];
    let files = ["lgr_nnc/LGR_TESTMOD.EGRID", "lgr_nnc/SIMPLE_SUMMARY2.EGRID"];
    cases.extend(
        files
            .iter()
            .filter_map(|f| Some(load::open(&common::data(f)?).unwrap())),
    );
    for case in &cases {
        let property = if case.steps.is_empty() {
            "DEPTH"
        } else {
            "SGAS"
        };
        let property = if case.property("VALUE").is_ok() {
            "VALUE"
        } else {
            property
        };
        for interpolation in ["vertex", "cell"] {
            let written = json!({
                "size": [120, 90], "mode": "volume", "lighting": {}, "property": property,
                "show": {"hull": "hidden", "wells": false}, "interpolation": interpolation,
            });
            let scene = view::look::opening(case, &written).unwrap();
            let view = view::resolve(&scene, case).unwrap();
            let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
            for executor in common::executors() {
                let mut renderer = executor.renderer(&case.grid).unwrap();
                for (strategy, least) in [(StrategyKind::Plts, 60.0), (StrategyKind::Libc, 45.0)] {
                    let db = psnr(&image(&mut *renderer, &view.by(strategy)), &truth, &view);
                    let place = format!(
                        "{} {} {} {interpolation}: {db:.1} dB",
                        executor.info().executor,
                        case.about.name,
                        strategy.name()
                    );
                    println!("{place}");
                    assert!(db >= least, "{place}");
                }
            }
        }
    }
}

#[test]
fn a_hidden_grid_leaves_the_cells_that_it_refines() {
    let case = case(3.0);
    let view = |hidden: Value| view(&case, &json!({"grids": {"hidden": hidden}}));
    let drawn = |view: &View, number: usize| {
        let drawn = &view.shown.cells.drawn;
        let cells = case.grid.active_in(number);
        cells.filter(|(active, _)| drawn[*active]).count()
    };
    let counts = |hidden: Value| {
        let view = view(hidden);
        let facts = view.notes.facts.clone().unwrap();
        let counts = [0, 1, 2].map(|number| drawn(&view, number));
        assert_eq!(facts.drawn, counts.iter().sum::<usize>());
        assert_eq!(facts.drawn, facts.active);
        counts
    };
    let (all, outer, inner) = (120, 12 * 27, 24 * 27);
    assert_eq!(counts(json!([])), [all - 12, outer - 24, inner]);
    assert_eq!(counts(json!(["inner"])), [all - 12, outer, 0]);
    // What refines a hidden grid is hidden with it.
    assert_eq!(counts(json!(["OUTER"])), [all, 0, 0]);
    let scene = json!({"grids": {"hidden": ["LGR9"]}});
    let scene = view::look::opening(&case, &scene).unwrap();
    let said = view::resolve(&scene, &case).unwrap_err().to_string();
    assert!(
        said.contains("LGR9") && said.contains("OUTER, INNER"),
        "{said}"
    );
}

#[test]
fn filters_by_index_go_by_the_cells_that_are_refined() {
    let case = case(0.0);
    let view = view(&case, &json!({"filter": {"i": [3, 3]}}));
    let cells = case
        .grid
        .active_cells()
        .iter()
        .zip(&*view.shown.cells.drawn);
    let drawn = cells.filter(|(_, drawn)| **drawn);
    let names = drawn.map(|(cell, _)| {
        let at = case.grid.dims().ijk(*cell);
        assert_eq!(case.grid.main_cell(at).i, 2);
        case.grid.cell_name(at).grid.to_owned()
    });
    let names: std::collections::HashSet<String> = names.collect();
    assert_eq!(names.len(), 3, "{names:?}");
}

#[test]
fn arrays_that_only_a_local_grid_has_are_named() {
    let Some(path) = common::data("lgr_nnc/LGR_TESTMOD.EGRID") else {
        return;
    };
    let case = load::open(&path).unwrap();
    let of = |name: &str| {
        let told = format!("of local grid {name} are not shown");
        let mut notes = case.about.notes.iter();
        notes.find(|note| note.contains(&told)).cloned()
    };
    // The radial one has permeabilities along the radius.
    let told = of("LGR2").unwrap();
    assert!(told.contains("PERMR") && !told.contains("PORO"), "{told}");
    assert_eq!(of("LGR1"), None);
    // Its connections count for the property too.
    assert!(case.property("NNC").is_ok());
}

/// The main grid of a file as a deck, with its arrays of rock, and a CARFIN for each local grid.
fn deck_of(path: &Path) -> String {
    let mut warnings = Warnings::default();
    let grid = Egrid::read(path, &mut warnings).unwrap();
    let init = strataray_parsers::init::open(&path.with_extension("INIT"), &mut warnings).unwrap();
    let [ni, nj, nk] = grid.dims;
    let [coord, zcorn] = [&grid.coord, &grid.zcorn].map(|values| tiny::numbers(values));
    let mut deck = format!(
        "GRID\nSPECGRID\n{ni} {nj} {nk} 1 F /\nGRIDUNIT\nMETRES /\nCOORD\n{coord} /\nZCORN\n{zcorn} /\n"
    );
    for local in &grid.local_grids {
        let [low, high] = local.host_box.unwrap();
        let hosts = [0, 1, 2].map(|axis| format!("{} {}", low[axis], high[axis]));
        let [ni, nj, nk] = local.dims;
        let (name, hosts) = (&local.name, hosts.join(" "));
        deck += &format!("CARFIN\n'{name}' {hosts} {ni} {nj} {nk} /\nENDFIN\n");
    }
    for name in ["PORO", "PERMX", "PERMZ", "NTG", "DX", "DZ"] {
        let values = init.values(init.find(name).unwrap()).unwrap();
        deck += &format!("{name}\n{} /\n", tiny::numbers(&values));
    }
    deck
}

#[test]
fn ranges_leave_out_cells_that_are_refined() {
    let case = case(0.0);
    let field = case.field("VALUE", 0).unwrap();
    let all = ValueRange::of(&field).unwrap();
    let range = case.range_over_steps("VALUE").unwrap().unwrap();
    assert_eq!(all.max, 1e3);
    assert!(range.max < 100.0 && range.min == all.min, "{range:?}");
}

#[test]
fn a_deck_has_the_local_grids_and_values_of_its_simulator() {
    let Some(path) = common::data("lgr_nnc/SIMPLE_SUMMARY2.EGRID") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let open =
        |name: &str, deck: &str| load::open(&tiny::write(folder.path(), name, deck)).unwrap();
    let text = deck_of(&path);
    let (simulated, case) = (load::open(&path).unwrap(), open("A.DATA", &text));
    let (a, b) = (&simulated.grid, &case.grid);
    assert_eq!(
        (a.patches(), a.active_cells()),
        (b.patches(), b.active_cells())
    );
    for cell in a.active_cells() {
        let at = a.dims().ijk(*cell);
        assert_eq!(a.cell_name(at), b.cell_name(at));
        let pairs = a.hexahedron(at).0.into_iter().zip(b.hexahedron(at).0);
        for (a, b) in pairs {
            assert!((a - b).length() < 1e-3, "{a} {b}");
        }
    }
    let values = |case: &Case, name: &str| case.field(name, 0).unwrap().values().to_vec();
    for name in ["PORO", "PERMX", "PERMZ", "NTG", "DX", "DZ"] {
        let pairs = values(&simulated, name)
            .into_iter()
            .zip(values(&case, name));
        let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 1e-3, "{name}: {off}");
    }
    // What the deck does to a local grid is seen there and nowhere else.
    let edits =
        "REFINE\nCENTER /\nEQUALS\n PERMX 7 1 20 1 20 1 3 /\n/\nACTNUM\n 3599*1 0 /\nENDFIN\n";
    let edited = open("B.DATA", &(text + edits));
    assert_eq!(edited.grid.active_cells().len(), a.active_cells().len() - 1);
    let permeabilities = values(&edited, "PERMX");
    let cells = edited.grid.active_cells().iter().zip(&permeabilities);
    let seven = cells.filter(|(_, value)| **value == 7.0);
    let names: Vec<_> = seven
        .map(|(cell, _)| edited.grid.cell_name(edited.grid.dims().ijk(*cell)))
        .collect();
    assert_eq!(names.len(), 1200);
    assert!(
        names
            .iter()
            .all(|name| name.grid == "CENTER" && name.ijk[2] <= 3)
    );
}
