//! The line below a picture: its numbers against sums over the arrays of the files.

use crate::common;
use crate::common::shape::Shape;
use strataray::case::{Case, Weighting, load};
use strataray::picture::{Annotations, Shot};
use strataray::scene::{self, ClipSpec, CutFace, Filter, PropertyFilter, Scene, StrategyKind};
use strataray::view::{self, Facts};
use strataray_parsers::records::RecordFile;

/// The arrays of a name in a file of the sample, one for each step.
fn arrays(file: &str, name: &str) -> Vec<Vec<f64>> {
    let path = common::sample().with_extension(file);
    let records = RecordFile::open(&path).unwrap();
    let entries = records.entries().iter().filter(|e| e.name() == name);
    let values = entries.map(|e| match records.f64s(e) {
        Ok(values) => values,
        Err(_) => records
            .f32s(e)
            .unwrap()
            .into_iter()
            .map(f64::from)
            .collect(),
    });
    values.collect()
}

/// Active cells of the sample by natural order, and what its files say of them.
struct Raw {
    ijk: Vec<[usize; 3]>,
    pores: Vec<f64>,
    water: Vec<Vec<f64>>,
}

impl Raw {
    fn new() -> Self {
        let path = common::sample();
        let grid = RecordFile::open(&path).unwrap();
        let active = grid.i32s(grid.find("ACTNUM").unwrap()).unwrap();
        let [ni, nj] = [40, 30];
        let cells: Vec<usize> = (0..active.len()).filter(|n| active[*n] != 0).collect();
        let pores = arrays("INIT", "PORV").remove(0);
        Self {
            // PORV is the one array that has a value for each cell, active or not.
            pores: match pores.len() == active.len() {
                true => cells.iter().map(|n| pores[*n]).collect(),
                false => pores,
            },
            ijk: cells
                .iter()
                .map(|n| [n % ni + 1, n / ni % nj + 1, n / (ni * nj) + 1])
                .collect(),
            water: arrays("UNRST", "SWAT"),
        }
    }

    /// Count, smallest, largest and pore-volume-weighted mean oil saturation at a step.
    fn oil(&self, step: usize, keeps: impl Fn([usize; 3], f64) -> bool) -> (usize, [f64; 3]) {
        let (mut count, mut sum, mut weight) = (0, 0.0, 0.0);
        let (mut min, mut max) = (f64::INFINITY, f64::NEG_INFINITY);
        for (n, water) in self.water[step].iter().enumerate() {
            let oil = 1.0 - water;
            if keeps(self.ijk[n], oil) {
                count += 1;
                (min, max) = (min.min(oil), max.max(oil));
                sum += oil * self.pores[n];
                weight += self.pores[n];
            }
        }
        (count, [min, max, sum / weight])
    }
}

fn facts(scene: &Scene, case: &Case) -> Facts {
    Facts::clone(&view::resolve(scene, case).unwrap().notes.facts.unwrap())
}

fn line(scene: &Scene, case: &Case) -> String {
    let view = view::resolve(scene, case).unwrap();
    Annotations::of(case, &view).info.unwrap().whole()
}

fn oil() -> Scene {
    Scene {
        property: Some("SOIL".into()),
        size: [400, 300],
        ..Scene::default()
    }
}

#[test]
fn numbers_are_those_of_what_is_drawn() {
    let case = load::open(&common::sample()).unwrap();
    let raw = Raw::new();
    let mut scene = oil();
    let filtered = Filter {
        i: Some([5, 22].into()),
        k: Some([2, 6].into()),
        properties: vec![PropertyFilter {
            min: Some(0.35),
            max: Some(1.0),
            ..PropertyFilter::open("SOIL")
        }],
        ..Filter::default()
    };
    for (step, filter) in [
        (20, Filter::default()),
        (3, Filter::default()),
        (20, filtered.clone()),
        (3, filtered),
    ] {
        let keeps = |[i, _, k]: [usize; 3], oil: f64| {
            filter.properties.is_empty()
                || (5..=22).contains(&i) && (2..=6).contains(&k) && oil >= 0.35
        };
        let (count, expected) = raw.oil(step, keeps);
        scene.step = scene::StepSpec::Index(step);
        scene.filter = filter.clone();
        let found = facts(&scene, &case);
        assert_eq!((found.drawn, found.active), (count, 9501), "{step}");
        let values = found.values.unwrap();
        let (mean, weights) = values.mean.unwrap();
        assert_eq!(weights, Weighting::PoreVolume);
        for (a, b) in [values.min, values.max, mean].into_iter().zip(expected) {
            assert!((a - b).abs() < 2e-6, "{step}: {a} {b}");
        }
        let text = line(&scene, &case);
        let (_, said) = text.split_once("mean ").unwrap();
        let said: f64 = said.split(' ').next().unwrap().parse().unwrap();
        assert!((said - mean).abs() < 6e-4, "{text} {mean}");
        assert!(text.contains("of 9,501 cells"), "{text}");
        assert_eq!(
            text.contains("filter: I 5-22, K 2-6, SOIL 0.35 to 1"),
            found.drawn != 9501
        );
    }
    // The twin: the mean of all cells alike is another number.
    let (_, [.., weighted]) = raw.oil(20, |_, _| true);
    let water = &raw.water[20];
    let plain = 1.0 - water.iter().sum::<f64>() / water.len() as f64;
    assert!((plain - weighted).abs() > 1e-3, "{plain} {weighted}");
}

#[test]
fn cells_that_are_cut_away_do_not_count() {
    let case = load::open(&common::sample()).unwrap();
    let mut scene = oil();
    let whole = facts(&scene, &case);
    let view = view::resolve(&scene, &case).unwrap();
    let plane = |normal: [f64; 3]| ClipSpec {
        point: view.world.subject.middle.to_array(),
        normal,
        face: CutFace::Open,
    };
    let halves = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]].map(|normal| {
        scene.clip = vec![plane(normal)];
        assert!(line(&scene, &case).contains("cut by a plane"));
        facts(&scene, &case)
    });
    let [a, b] = halves.each_ref().map(|h| h.drawn);
    assert!(a < whole.drawn && b < whole.drawn && a > 1000 && b > 1000);
    // Cells on the plane are in both.
    assert!(
        a + b >= whole.drawn && a + b < whole.drawn + 1000,
        "{a} {b}"
    );
    let means = halves.map(|h| h.values.unwrap().mean.unwrap().0);
    assert!((means[0] - means[1]).abs() > 1e-3);
}

/// Layers of 10, 20 and 30 m whose values are 1, 2 and 3.
fn layers(keywords: &str) -> Case {
    let tops = [1000.0, 1010.0, 1030.0, 1060.0];
    Shape {
        dims: [2, 2, 3],
        depth: &|[_, _, k], [_, _, dk]| tops[k + dk],
        value: &|[_, _, k]| (k + 1) as f64,
        keywords,
        ..Shape::default()
    }
    .case()
}

#[test]
fn without_pore_volumes_porosity_times_volume_counts_and_else_the_volume() {
    let scene = Scene {
        property: Some("VALUE".into()),
        ..Scene::default()
    };
    let mean = |case: &Case| facts(&scene, case).values.unwrap().mean.unwrap();
    let bulk = layers("");
    let (value, weights) = mean(&bulk);
    assert_eq!(weights, Weighting::BulkVolume);
    assert!(
        (value - (10.0 + 40.0 + 90.0) / 60.0).abs() < 1e-5,
        "{value}"
    );
    assert!(line(&scene, &bulk).contains("volume-weighted mean 2.333"));
    let porous = layers("PORO\n 4*0.3 4*0.1 4*0.2 /\n");
    let (value, weights) = mean(&porous);
    assert_eq!(weights, Weighting::PorosityVolume);
    let expected = (3.0 + 2.0 * 2.0 + 3.0 * 6.0) / (3.0 + 2.0 + 6.0);
    assert!((value - expected).abs() < 1e-5, "{value}");
    let text = line(&scene, &porous);
    assert!(
        text.contains("VALUE 1 to 3, pore-volume-weighted mean"),
        "{text}"
    );
}

#[test]
fn a_constant_and_regions_are_said_to_be_so() {
    let case = layers("SGAS\n 12*0 /\nFIPNUM\n 4*1 4*2 4*5 /\n");
    let text = |property: &str, k: Option<[usize; 2]>| {
        let scene = Scene {
            property: Some(property.into()),
            filter: Filter {
                k: k.map(Into::into),
                ..Filter::default()
            },
            ..Scene::default()
        };
        line(&scene, &case)
    };
    assert!(text("SGAS", None).contains("SGAS is 0 everywhere"));
    assert!(text("VALUE", Some([2, 2])).contains("4 of 12 cells  ·  VALUE is 2 in all of them"));
    let regions = text("FIPNUM", None);
    assert!(
        regions.contains("FIPNUM 1 to 5") && !regions.contains("mean"),
        "{regions}"
    );
}

#[test]
fn the_line_can_be_hidden_and_its_room_is_the_models() {
    let case = load::open(&common::sample()).unwrap();
    let mut scene = oil();
    let with = Shot::of(&scene, &case, false).unwrap();
    scene.show.info = false;
    let without = Shot::of(&scene, &case, false).unwrap();
    assert!(without.view.notes.facts.is_none() && without.layout.info.is_none());
    assert!(without.layout.volume_size()[1] > with.layout.volume_size()[1]);
    let text = serde_json::to_string(&scene).unwrap();
    assert!(text.contains(r#""info":false"#), "{text}");
    let shown: Scene = serde_json::from_str("{}").unwrap();
    assert!(shown.show.info);
}

#[test]
fn the_strategy_is_named_where_it_is_approximate() {
    let case = load::open(&common::sample()).unwrap();
    for strategy in StrategyKind::ALL {
        let is_said = strategy == StrategyKind::Srg;
        let scene = Scene { strategy, ..oil() };
        let text = line(&scene, &case);
        assert_eq!(text.contains("SRG: resampled"), is_said, "{text}");
        assert!(text.contains("Z x 3"), "{text}");
    }
}
