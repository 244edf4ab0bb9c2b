//! The extinction pyramid against sums over all voxels in f64.

use crate::common;
use crate::common::light::{Block, Space, bits, lighting, render, scene};
use crate::common::shape::Shape;
use glam::DVec3;
use serde_json::json;

use strataray::render::gpu::GpuRenderer;
use strataray::scene::{ClipSpec, CutFace, Inactive, Scene};
use strataray::view::View;

/// Opacities a length of 10: nothing, a ramp, nearly opaque.
const OPACITY: [[f64; 2]; 4] = [[0.0, 0.0], [0.3, 0.0], [0.5, 0.35], [1.0, 0.97]];
/// Differences of opacity that half floats make, in the volumes between three passes and in the pyramid.
const HALVES: f64 = 1.0 / 1024.0;
/// What a Gaussian has beyond three standard deviations and half a voxel, along three axes.
const TAIL: f64 = 0.003;
/// A Gaussian's reach that is as good as endless.
const ENDLESS: f64 = 9.0;

/// What a voxel of the volume of values holds: how much of it cells cover, the value as a part of the range,
/// and whether they are inactive.
struct Held {
    coverage: f64,
    value: f64,
    is_ghost: bool,
}

impl Held {
    /// From 16 bits, of which the upper 5 are coverage and the lower 11 the value, or all set in a ghost.
    fn new(bits: u16) -> Self {
        let value = bits & 0x7ff;
        Self {
            coverage: f64::from(bits >> 11) / 31.0,
            value: f64::from(value) / 2046.0,
            is_ghost: value == 0x7ff,
        }
    }
}

/// A model of cells of 10 x 10 x 10, and what of its values is in the light.
struct Found {
    view: View,
    space: Space,
    field: Vec<Held>,
    pyramid: Vec<Block>,
}

impl Found {
    fn new(shape: &Shape, scene: &Scene) -> Option<Self> {
        let gpu = common::gpu()?;
        let case = shape.case();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        let (view, _) = render(&mut renderer, &case, scene);
        let light = renderer.light();
        let pyramid = Block::levels(&gpu, light.pyramid().unwrap());
        Some(Self {
            field: bits(&gpu, light.field().unwrap(), 0)
                .into_iter()
                .map(Held::new)
                .collect(),
            space: Space::new(&view, pyramid[0].size),
            view,
            pyramid,
        })
    }

    /// Opacities of a unit of length before any blur.
    fn opacities(&self) -> Block {
        let statistics = self.view.shown.cells.field.statistics().unwrap();
        let transfer = &self.view.style.transfer;
        let [low, high] = [statistics.min, statistics.max];
        let mut block = self.pyramid[0].clone();
        for (at, held) in self.pyramid[0].voxels().zip(&self.field) {
            let value = low + held.value * (high - low);
            let extinction = match held.is_ghost {
                true => transfer.extinction_of(0.012),
                false => transfer.extinction(transfer.position(value)),
            };
            let point = self.space.world(block.middle(at));
            let mut planes = self.view.shown.clip.iter();
            let is_kept = planes.all(|c| c.normal.dot(point - c.point) >= 0.0);
            let kept = f64::from(u8::from(is_kept)) * held.coverage;
            *block.at_mut(at) = kept * -(-extinction * self.space.sigma).exp_m1();
        }
        block
    }

    /// Standard deviation of the finest level in voxels of a level.
    fn deviation(&self, level: usize) -> DVec3 {
        let voxels = DVec3::from_array(self.pyramid[level].size.map(|n| n as f64));
        voxels / self.space.size()
    }

    /// Compares each level with the Gaussian of the means that it is made from, and with that of the
    /// opacities for which cones take it.
    fn check(&self, name: &str) {
        println!("| model | level | voxels | error | of endless | if wider | direct | kept |");
        let sharp = self.opacities();
        let mut means = sharp.clone();
        for (level, found) in self.pyramid.iter().enumerate() {
            let found = found.opacities();
            let size = sharp.size.map(|n| (n >> level).max(1));
            assert_eq!(found.size, size);
            if level > 1 {
                means = means.means(sharp.size.map(|n| (n >> (level - 1)).max(1)));
            }
            let deviation = self.rest(level, means.size);
            let apart = |wider, reach| found.apart(&means.blurred(size, wider * deviation, reach));
            let [error, endless, twin] =
                [(1.0, 3.0), (1.0, ENDLESS), (1.15, 3.0)].map(|(w, r)| apart(w, r));
            let sigma = f64::from(level as u32).exp2();
            let direct = |wider| sharp.blurred(size, wider * sigma * self.deviation(0), ENDLESS);
            let [direct, direct_twin] = [1.0, 1.25].map(direct);
            let (most, most_twin) = (found.apart(&direct), found.apart(&direct_twin));
            let kept = found.sum() / direct.sum();
            println!(
                "| {name} | {level} | {} | {error:.5} | {endless:.5} | {twin:.4} | {most:.4} | {kept:.3} |",
                size.map(|n| n.to_string()).join(" x "),
            );
            assert!(error < HALVES && endless < HALVES + TAIL, "{name} {level}");
            assert!(
                twin > 4.0 * error && (level > 2 || twin > 2.0 * HALVES),
                "{name} {level}"
            );
            assert!(
                most < 0.02 && most < most_twin,
                "{name} {level}: {most_twin}"
            );
            assert!((0.95..1.15).contains(&kept), "{name} {level}");
        }
    }

    /// Standard deviation of a level's Gaussian in voxels of the means, each of which has a part of it.
    fn rest(&self, level: usize, means: [usize; 3]) -> DVec3 {
        let finest = DVec3::from_array(self.pyramid[0].size.map(|n| n as f64));
        let in_each = finest / DVec3::from_array(means.map(|n| n as f64));
        let edge = self.deviation(0).recip();
        let wanted = DVec3::splat(f64::from(2 * level as u32).exp2());
        let had = (in_each * in_each - 1.0) / 12.0 * edge * edge;
        let variance = wanted - had;
        DVec3::from_array(variance.to_array().map(f64::sqrt)) / (in_each * edge)
    }
}

/// A number from 0 to 1 by a cell's place.
fn hash(ijk: [usize; 3]) -> f64 {
    let seed = ijk[0] + 101 * ijk[1] + 10_007 * ijk[2];
    fastrand::Rng::with_seed(seed as u64).f64()
}

fn shape<'a>(dims: [usize; 3], value: &'a dyn Fn([usize; 3]) -> f64) -> Shape<'a> {
    Shape {
        dims,
        pillar: &|i, j| [900.0, 1500.0].map(|d| [10.0 * i as f64, 10.0 * j as f64, d]),
        depth: &|[_, _, k], [_, _, dk]| 1000.0 + 10.0 * (k + dk) as f64,
        value,
        ..Shape::default()
    }
}

/// A scene whose extinction volume has `size` voxels.
fn of_size(size: [usize; 3]) -> Scene {
    let spec = json!({"occlusion": {}, "volume": {"size": size, "light_size": [2, 2, 2]}});
    scene(&OPACITY, 10.0, lighting(spec))
}

#[test]
fn values_by_chance_are_blurred_in_cubes() {
    for dims in [[24, 24, 24], [23, 17, 9], [27, 22, 3]] {
        let Some(found) = Found::new(&shape(dims, &hash), &of_size(dims)) else {
            return;
        };
        // One cell a voxel: the volume has their values.
        let statistics = found.view.shown.cells.field.statistics().unwrap();
        let part = |v: f64| (v - statistics.min) / (statistics.max - statistics.min);
        for (at, held) in found.pyramid[0].voxels().zip(&found.field) {
            let error = (held.value - part(hash(at))).abs();
            assert!(held.coverage == 1.0 && error < HALVES, "{at:?}: {error}");
        }
        found.check(&format!("chance, {} deep", dims[2]));
    }
}

#[test]
fn values_by_chance_are_blurred_in_voxels_that_are_no_cubes() {
    let mut scene = of_size([26, 9, 15]);
    scene.vertical_exaggeration = Some(1.7);
    let Some(found) = Found::new(&shape([16, 12, 8], &hash), &scene) else {
        return;
    };
    let deviation = found.deviation(0);
    assert!(deviation.max_element() > 1.5 * deviation.min_element());
    found.check("oblong");
}

#[test]
fn an_opaque_half_is_blurred() {
    let half = |ijk: [usize; 3]| f64::from(u8::from(ijk[0] + ijk[2] > 14));
    let dims = [17, 10, 13];
    let Some(found) = Found::new(&shape(dims, &half), &of_size(dims)) else {
        return;
    };
    found.check("half");
}

#[test]
fn clip_planes_and_inactive_cells_reach_the_pyramid() {
    let dims = [15, 14, 11];
    let holes = Shape {
        active: &|[i, j, _]| i + j > 9,
        ..shape(dims, &hash)
    };
    let mut scene = of_size(dims);
    let Some(hidden) = Found::new(&holes, &scene) else {
        return;
    };
    hidden.check("hidden");
    scene.show.inactive = Inactive::Ghost;
    let ghosts = Found::new(&holes, &scene).unwrap();
    ghosts.check("ghosts");
    let count = |found: &Found, what: fn(&&Held) -> bool| found.field.iter().filter(what).count();
    let number = count(&ghosts, |h| h.is_ghost);
    assert!(number > 300 && count(&hidden, |h| h.is_ghost) == 0);
    assert_eq!(number, count(&hidden, |h| h.coverage == 0.0));
    scene.clip = vec![ClipSpec {
        point: [70.0, 75.0, -1050.0],
        normal: [1.0, -0.4, 0.7],
        face: CutFace::Open,
    }];
    let clipped = Found::new(&holes, &scene).unwrap();
    clipped.check("clipped");
    // The twins: what one of the three has is not what another has.
    for (a, b) in [(&hidden, &ghosts), (&ghosts, &clipped)] {
        let most = a.pyramid[0].opacities().apart(&b.pyramid[0].opacities());
        assert!(most > 4.0 * HALVES, "{most}");
    }
}

#[test]
fn voxels_that_cells_cover_in_part_count_in_part() {
    let dims = [15, 8, 6];
    let top = |x: f64| 0.6 * x;
    let dipping = Shape {
        depth: &|[i, _, k], [di, _, dk]| match k + dk {
            0 => 1000.0 + top((i + di) as f64),
            n => 1000.0 + 10.0 * n as f64,
        },
        ..shape(dims, &hash)
    };
    let Some(found) = Found::new(&dipping, &of_size(dims)) else {
        return;
    };
    found.check("dipping");
    // Four samples down the voxel, or one in its middle, which is the twin.
    let wrong = |samples: u32| {
        let covered = |[x, _, z]: [usize; 3]| {
            let depth = |n: u32| 10.0 * (z as f64 + (f64::from(n) + 0.5) / f64::from(samples));
            let inside = (0..samples).filter(|n| depth(*n) > top(x as f64 + 0.5));
            inside.count() as f64 / f64::from(samples)
        };
        let voxels = found.pyramid[0].voxels().zip(&found.field);
        let wrong = voxels.filter(|(at, held)| (held.coverage - covered(*at)).abs() > 0.02);
        wrong.count()
    };
    assert!(wrong(4) == 0 && wrong(1) > 50, "{} {}", wrong(4), wrong(1));
}
