//! Faces by the bins of the acceleration grid that they may touch.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::layout::GridInfo;
use crate::model::topology::Face;
use crate::model::{Grid, Ijk};

/// Faces are widened by this part of a bin against rounding to f32.
const WIDENING: f64 = 1e-4;

/// A face and where it is.
struct Placed {
    number: u32,
    /// Two 16-bit numbers.
    depths: u32,
    /// First and last bin along x and y.
    bins: [[u32; 2]; 2],
}

impl Placed {
    fn new(grid: &Grid, info: &GridInfo, origin: DVec3, number: u32) -> Self {
        let corners = corners(grid, number).map(|c| c - origin);
        let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let [low, high] = corners
            .iter()
            .fold(start, |[a, b], &c| [a.min(c), b.max(c)]);
        let [bin_origin, bin_size] =
            [info.bin_origin, info.bin_size].map(|v| DVec2::from_array(v.map(f64::from)));
        let bin = |p: DVec3, off: f64| (p.truncate() - bin_origin) / bin_size + off;
        let (from, to) = (bin(low, -WIDENING), bin(high, WIDENING));
        let last = [info.bins_x - 1, info.bins_y - 1];
        let within = |at: f64, axis: usize| at.floor().clamp(0.0, f64::from(last[axis])) as u32;
        let depth = |z: f64| (z - f64::from(info.depth_low)) / f64::from(info.depth_scale);
        let packed = |z: f64| z.clamp(0.0, 65535.0) as u32;
        let shallow = packed((depth(low.z) - 0.5).floor());
        let deep = packed((depth(high.z) + 0.5).ceil());
        Self {
            number,
            depths: shallow | deep << 16,
            bins: [0, 1].map(|axis| [within(from[axis], axis), within(to[axis], axis)]),
        }
    }

    fn numbers(&self, bins_x: u32) -> impl Iterator<Item = usize> + use<> {
        let [[left, right], [top, bottom]] = self.bins;
        (top..=bottom).flat_map(move |y| (left..=right).map(move |x| (x + bins_x * y) as usize))
    }
}

/// Corners of a face by its number, `(column * nk + layer) * 6 + face`.
fn corners(grid: &Grid, number: u32) -> [DVec3; 4] {
    let dims = grid.dims();
    let [cell, side] = [number as usize / 6, number as usize % 6];
    let (column, k) = (cell / dims.nk, cell % dims.nk);
    let (i, j) = (column % dims.ni, column / dims.ni);
    let [own, _] = Face::ALL[side].corners();
    own.map(|corner| {
        let depth = grid.corner_depth(Ijk { i, j, k }, corner);
        grid.pillar(i, j, corner & 3).at(depth)
    })
}

/// First entry and end of the list of each bin of an acceleration grid, then the entries: faces of a grid by
/// [number](super::faces::face_numbers), and their depth ranges in 2 x 16 bits. Positions are relative to `origin`.
pub fn face_bins(grid: &Grid, info: &GridInfo, origin: DVec3, numbers: &[u32]) -> Vec<[u32; 2]> {
    let placed: Vec<Placed> = numbers
        .par_iter()
        .map(|&number| Placed::new(grid, info, origin, number))
        .collect();
    let bins = (info.bins_x * info.bins_y) as usize;
    let mut words = vec![[0u32; 2]; bins];
    for at in placed.iter().flat_map(|face| face.numbers(info.bins_x)) {
        words[at][1] += 1;
    }
    let mut next = bins as u32;
    for [first, end] in &mut words {
        let count = *end;
        [*first, *end] = [next; 2];
        next += count;
    }
    words.resize(next as usize, [0; 2]);
    // What is the end of a list so far is where its next entry goes.
    for face in &placed {
        for at in face.numbers(info.bins_x) {
            let end = words[at][1];
            words[end as usize] = [face.number, face.depths];
            words[at][1] = end + 1;
        }
    }
    words
}
