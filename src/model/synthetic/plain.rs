//! The box: equal cells, vertical pillars, every cell active, and fields with known answers.

use rayon::prelude::*;

use super::{Fields, Geometry};
use crate::model::{CellIndex, Dims};

/// Edges of a cell in meters, and the depth of the top.
const EDGES: [f32; 3] = [100.0, 100.0, 10.0];
const TOP: f32 = 2000.0;

/// Values that are linear in the place of a cell's center, (u, v, w) in 0..1 along i, j and k.
#[derive(Debug)]
pub struct Linear {
    dims: Dims,
}

pub(super) fn build(dims: Dims) -> (Geometry, Fields) {
    let Dims { ni, nj, nk } = dims;
    let bottom = TOP + EDGES[2] * nk as f32;
    let pillars = (0..=nj).flat_map(|j| (0..=ni).map(move |i| [i, j]));
    let coord = pillars.flat_map(|[i, j]| {
        let (x, y) = (EDGES[0] * i as f32, EDGES[1] * j as f32);
        [x, y, TOP, x, y, bottom]
    });
    let mut zcorn = vec![0.0; 8 * dims.cells()];
    let planes = zcorn.par_chunks_exact_mut(4 * dims.columns()).enumerate();
    planes.for_each(|(n, plane)| plane.fill(TOP + EDGES[2] * n.div_ceil(2) as f32));
    let geometry = Geometry {
        dims,
        coord: coord.collect(),
        zcorn,
        actnum: vec![1; dims.cells()],
        map_axes: None,
    };
    (geometry, Fields::Linear(Linear { dims }))
}

impl Linear {
    pub(super) fn values(&self, name: &str, time: f64) -> Option<Vec<f32>> {
        let of: &(dyn Fn([f64; 3]) -> f64 + Sync) = match name {
            "PORO" => &|[u, _, _]| 0.1 + 0.2 * u,
            "NTG" => &|[_, _, w]| 0.5 + 0.5 * w,
            "PERMX" => &|[_, v, _]| 100.0 + 900.0 * v,
            "PERMY" => &|[u, v, _]| 100.0 + 450.0 * (u + v),
            "PERMZ" => &|[_, _, w]| 10.0 + 90.0 * w,
            "PRESSURE" => &|[_, _, w]| 200.0 + 50.0 * w - 20.0 * time,
            "SWAT" => &|[u, _, _]| 0.2 + 0.3 * u + 0.3 * time,
            "SGAS" => &|[_, v, _]| 0.1 * v,
            _ => return None,
        };
        let Dims { ni, nj, nk } = self.dims;
        let place = |n: usize, of: usize| (n as f64 + 0.5) / of as f64;
        let cells = (0..self.dims.cells() as u32).into_par_iter();
        let values = cells.map(|cell| {
            let ijk = self.dims.ijk(CellIndex(cell));
            of([place(ijk.i, ni), place(ijk.j, nj), place(ijk.k, nk)]) as f32
        });
        Some(values.collect())
    }
}
