//! The structure of a faulted field: a dipping dome, faults, sloping pillars, layers.
//!
//! Everything is a function of the place in plan, in units of the field's longer side, so that a
//! model of any dimensions has the same structure.

use glam::DVec2;
use rayon::prelude::*;

use super::Shape;
use super::noise::Noise;
use crate::model::Dims;

/// Lateral edge of a cell in meters.
const EDGE: f64 = 75.0;
/// Depth of the top where the surface is neither raised nor dipping.
const TOP: f64 = 2200.0;
/// Relief of the top surface, as parts of the longer side.
const DIP: f64 = 0.035;
const DOME: f64 = 0.035;
const UNDULATION: f64 = 0.004;
/// How far from a fault its block is displaced, and its pillars lean, in parts of the longer side.
const REACH: f64 = 0.35;
const LEAN_REACH: f64 = 0.15;
/// How far from the crest gaps between layers are open, in parts of the longer side.
const GAP_REACH: f64 = 0.25;
/// Steepest lean of a pillar: horizontal meters a meter of depth.
const STEEPEST: f64 = 0.3;

/// A fault: a bent trace in plan and the throw along it.
#[derive(Debug)]
pub(super) struct Fault {
    center: DVec2,
    along: DVec2,
    bend: f64,
    half_length: f64,
    /// Largest throw in meters.
    throw: f64,
    /// The throw changes its sign at the center.
    scissor: bool,
}

impl Fault {
    /// Signed distance from the trace, and the place along it: -1 and 1 at the tips.
    pub(super) fn locate(&self, p: DVec2) -> (f64, f64) {
        let d = p - self.center;
        let t = d.dot(self.along);
        let across = d.dot(self.along.perp()) - self.bend * t * t;
        (across, t / self.half_length)
    }

    /// How strong the fault is at a place along it: 1 in the middle, 0 at the tips and beyond.
    pub(super) fn strength(place: f64) -> f64 {
        (1.0 - place * place).max(0.0)
    }

    fn throw_at(&self, place: f64) -> f64 {
        // 2.6 makes the larger half of the scissor's throw as large as a plain one.
        let profile = if self.scissor { 2.6 * place } else { 1.0 };
        self.throw * profile * Self::strength(place)
    }

    /// Displacement at `p` of the block that `side` (-1 or 1) of the trace belongs to.
    fn displacement(&self, p: DVec2, side: f64) -> f64 {
        let (across, place) = self.locate(p);
        let near = (1.0 - across.abs() / REACH).max(0.0);
        0.5 * side * self.throw_at(place) * near * near
    }
}

/// A layer: its thickness is `mean * max(0, bias + weights * shapes)`.
#[derive(Debug)]
struct Layer {
    mean: f64,
    bias: f64,
    weights: [f64; SHAPES],
    /// Most meters below it that belong to no layer.
    gap: f64,
}

/// Smooth functions that all layers' thicknesses are mixed from.
const SHAPES: usize = 3;

/// What lies on a pillar: what shapes the layers there, and their thickness so far.
struct Stack {
    shapes: [f64; SHAPES],
    /// Gaps are open by this part of their full thickness.
    opening: f64,
    depth: f64,
}

/// The structure of a field.
#[derive(Debug)]
pub(super) struct Structure {
    pub(super) dims: Dims,
    pub(super) faults: Vec<Fault>,
    noise: Noise,
    dip: DVec2,
    crest: DVec2,
    layers: Vec<Layer>,
}

impl Structure {
    pub(super) fn new(dims: Dims, shape: Shape, random: &mut fastrand::Rng) -> Self {
        let mut structure = Self {
            dims,
            faults: Vec::new(),
            noise: Noise::new(random),
            dip: DVec2::from_angle(random.f64() * std::f64::consts::TAU),
            crest: DVec2::new(0.35 + 0.3 * random.f64(), 0.35 + 0.3 * random.f64()),
            layers: Vec::new(),
        };
        structure.crest *= structure.extent();
        let thickness = 60.0 + 3.0 * dims.nk as f64;
        structure.layers = layers(dims.nk, thickness, shape, random);
        let throw = thickness.min(0.05 * structure.side());
        structure.faults = (0..shape.faults)
            .map(|n| fault(n, shape.faults, structure.extent(), throw, random))
            .collect();
        structure
    }

    /// Metres of the longer side.
    pub(super) fn side(&self) -> f64 {
        EDGE * self.longer()
    }

    fn longer(&self) -> f64 {
        self.dims.ni.max(self.dims.nj) as f64
    }

    /// The far corner of the field in plan.
    pub(super) fn extent(&self) -> DVec2 {
        self.plan(self.dims.ni as f64, self.dims.nj as f64)
    }

    /// Place in plan of a position counted in pillars.
    fn plan(&self, i: f64, j: f64) -> DVec2 {
        DVec2::new(i, j) / self.longer()
    }

    /// Place in plan of a column's center.
    pub(super) fn center(&self, column: usize) -> DVec2 {
        let (i, j) = (column % self.dims.ni, column / self.dims.ni);
        self.plan(i as f64 + 0.5, j as f64 + 0.5)
    }

    /// Depth of the top surface before any fault.
    pub(super) fn top(&self, p: DVec2) -> f64 {
        let dip = DIP * self.dip.dot(p - 0.5);
        let from_crest = 4.0 * p.distance(self.crest);
        let dome = DOME / (1.0 + from_crest * from_crest);
        let undulation = UNDULATION * self.noise.at(4.0 * p);
        TOP + self.side() * (dip - dome + undulation)
    }

    /// ZCORN, layer by layer.
    pub(super) fn zcorn(&self) -> Vec<f32> {
        let Dims { ni, nj, .. } = self.dims;
        let tops = self.column_tops();
        let mut stacks: Vec<Stack> = (0..self.dims.pillars())
            .into_par_iter()
            .map(|pillar| self.stack(self.pillar_place(pillar)))
            .collect();
        let mut zcorn = vec![0.0; 8 * self.dims.cells()];
        let planes = zcorn.chunks_exact_mut(8 * ni * nj);
        for (layer, planes) in self.layers.iter().zip(planes) {
            let (top, bottom) = planes.split_at_mut(4 * ni * nj);
            self.fill(top, &tops, &stacks);
            stacks
                .par_iter_mut()
                .for_each(|s| s.depth += layer.thickness(&s.shapes));
            self.fill(bottom, &tops, &stacks);
            if layer.gap > 0.0 {
                stacks
                    .par_iter_mut()
                    .for_each(|s| s.depth += layer.gap * s.opening);
            }
        }
        zcorn
    }

    /// Depths of one plane of corners: each column's top and what lies above on its pillars.
    fn fill(&self, plane: &mut [f32], tops: &[f64], stacks: &[Stack]) {
        let row = 2 * self.dims.ni;
        let rows = plane.par_chunks_exact_mut(row).zip(tops.par_chunks(row));
        rows.enumerate().for_each(|(y, (depths, tops))| {
            let on_row = &stacks[y.div_ceil(2) * (self.dims.ni + 1)..];
            for (x, (depth, top)) in depths.iter_mut().zip(tops).enumerate() {
                *depth = (top + on_row[x.div_ceil(2)].depth) as f32;
            }
        });
    }

    /// Depth of the top at each column corner (`2i+di + 2ni(2j+dj)`), with the displacement of the
    /// blocks that the column belongs to.
    fn column_tops(&self) -> Vec<f64> {
        let row = 2 * self.dims.ni;
        let mut tops = vec![0.0; 4 * self.dims.columns()];
        let rows = tops.par_chunks_exact_mut(row);
        rows.enumerate().for_each(|(y, tops)| {
            for (x, top) in tops.iter_mut().enumerate() {
                let center = self.center(x / 2 + self.dims.ni * (y / 2));
                let p = self.plan(x.div_ceil(2) as f64, y.div_ceil(2) as f64);
                let faults = self.faults.iter();
                let side = |f: &Fault| f.locate(center).0.signum();
                *top = self.top(p) + faults.map(|f| f.displacement(p, side(f))).sum::<f64>();
            }
        });
        tops
    }

    /// COORD: pillars through the whole range of depths, leaning along the faults.
    pub(super) fn coord(&self, zcorn: &[f32]) -> Vec<f32> {
        let (low, high) = zcorn
            .par_iter()
            .fold(|| (f32::MAX, f32::MIN), |(a, b), &z| (a.min(z), b.max(z)))
            .reduce(|| (f32::MAX, f32::MIN), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        let (low, high) = (f64::from(low).floor() - 1.0, f64::from(high).ceil() + 1.0);
        // Neighboring pillars must not cross within the range.
        let steepest = STEEPEST.min(0.2 * LEAN_REACH * self.side() / (high - low));
        let pillar = |pillar: usize| {
            let p = self.pillar_place(pillar);
            let bent = DVec2::new(self.noise.at(2.0 * p + 11.0), self.noise.at(2.0 * p + 23.0));
            let middle = self.side() * (p + 0.02 * bent);
            let half = 0.5 * (high - low) * steepest * self.lean(p);
            let (a, b) = (middle - half, middle + half);
            [a.x, a.y, low, b.x, b.y, high].map(|v| v as f32)
        };
        let pillars = (0..self.dims.pillars()).into_par_iter();
        pillars.map(pillar).flatten_iter().collect()
    }

    /// Lean of a pillar as a part of the steepest: toward the lower block near a fault.
    fn lean(&self, p: DVec2) -> DVec2 {
        let mut lean = DVec2::new(0.2, 0.1);
        for fault in &self.faults {
            let (across, place) = fault.locate(p);
            let near = (1.0 - across.abs() / LEAN_REACH).max(0.0);
            lean += fault.along.perp() * near * near * Fault::strength(place);
        }
        lean.clamp_length_max(1.0)
    }

    fn pillar_place(&self, pillar: usize) -> DVec2 {
        let row = self.dims.ni + 1;
        self.plan((pillar % row) as f64, (pillar / row) as f64)
    }

    fn stack(&self, p: DVec2) -> Stack {
        Stack {
            shapes: std::array::from_fn(|n| self.noise.at(3.0 * p + 31.0 * (n + 1) as f64)),
            opening: (1.0 - p.distance(self.crest) / GAP_REACH).max(0.0),
            depth: 0.0,
        }
    }
}

impl Layer {
    fn thickness(&self, shapes: &[f64; SHAPES]) -> f64 {
        let mixed: f64 = self.weights.iter().zip(shapes).map(|(w, s)| w * s).sum();
        self.mean * (self.bias + mixed).max(0.0)
    }
}

fn layers(nk: usize, thickness: f64, shape: Shape, random: &mut fastrand::Rng) -> Vec<Layer> {
    let layer = |k: usize| {
        let mean = thickness / nk as f64 * (0.5 + random.f64());
        let pinches = shape.pinching_every > 0 && k % shape.pinching_every == 2;
        // Gaps lie at a third and at two thirds of the layers.
        let gap = shape.gaps && nk >= 4 && (k + 1).is_multiple_of(nk.div_ceil(3)) && k + 1 < nk;
        let (bias, weight) = if pinches { (0.3, 0.1) } else { (1.0, 0.25) };
        let mut weights = std::array::from_fn(|_| weight * (2.0 * random.f64() - 1.0));
        if pinches {
            weights[random.usize(..SHAPES)] = 1.3;
        }
        Layer {
            mean,
            bias,
            weights,
            gap: if gap { 5.0 } else { 0.0 },
        }
    };
    (0..nk).map(layer).collect()
}

/// Fault `n` of `count`: spread over the field, most of them across its first axis.
fn fault(n: usize, count: usize, extent: DVec2, throw: f64, random: &mut fastrand::Rng) -> Fault {
    let mut jitter = |range: f64| range * (2.0 * random.f64() - 1.0);
    let place = (n as f64 + 0.5 + jitter(0.2)) / count as f64;
    let center = DVec2::new(place, 0.5 + jitter(0.2)) * extent;
    let crosses = n % 3 == 1;
    let degrees: f64 = if crosses { 10.0 } else { 80.0 } + jitter(20.0);
    Fault {
        center,
        along: DVec2::from_angle(degrees.to_radians()),
        bend: jitter(0.5),
        half_length: 0.35 + jitter(0.1),
        throw: throw * (0.65 + jitter(0.35)),
        scissor: n % 3 == 2,
    }
}
