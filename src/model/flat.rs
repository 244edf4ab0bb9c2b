//! The same model with flat layers and square columns, by I, J and K: index space, also called simbox.
//!
//! Cell (i, j, k), from 0, spans i + 0.5 to i + 1.5 and so on, so that its middle has its numbers from 1 as coordinates.
//! Cells of a local grid divide their hosts evenly. Cells without thickness have one here, and no fault has a throw.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::depth_lists::DepthList;
use super::grid::{Flat, Found, Grid, Pillar};
use super::ids::{CellIndex, Dims, Ijk};
use super::patches::Patch;
use super::spaces::{MapAxes, Space};

/// Where the cells of a patch begin and end along I, J and K: one number more than cells.
type Edges = [Vec<f64>; 3];

impl Grid {
    /// The space that the geometry is in.
    pub fn space(&self) -> Space {
        match self.flat {
            None => Space::Map,
            Some(_) => Space::Ijk,
        }
    }

    /// The grid with the true depths and volumes: of one in index space that of which it was made, else the grid itself.
    pub fn in_map_space(&self) -> &Self {
        self.flat.as_ref().map_or(self, |flat| &flat.of)
    }

    /// True of a grid of the model that has no place in index space, because its rows do not follow those of its hosts.
    pub fn leaves_out(&self, patch: usize) -> bool {
        let flat = self.flat.as_ref();
        flat.is_some_and(|flat| flat.left_out.get(patch) == Some(&true))
    }

    /// The cell that stands for one: itself, or, of a grid that is left out, the one that it lies in.
    pub fn placed(&self, at: Ijk) -> Ijk {
        let is_left_out = |cell: Ijk| {
            let patch = self.patch_of(cell);
            patch.is_some_and(|patch| self.leaves_out(patch))
        };
        let mut cell = at;
        while let Some(host) = self.host(cell).filter(|_| is_left_out(cell)) {
            cell = host;
        }
        cell
    }

    /// The same cells in index space.
    ///
    /// J runs so that the handedness of the model on the map is kept; there are no other map axes.
    pub fn flattened(self: &Arc<Self>) -> Self {
        let dims = self.dims();
        let edges = self.edges_of_patches();
        let mut pillars = vec![column_line(0.5, 0.5, [0.5, 0.5]); dims.pillars()];
        // A list for each pillar: values at vertices are by place in the pool. There are no more of them than in the
        // grid itself, where columns around a pillar may differ.
        let count = dims.nk + 1;
        let mut depths = vec![0.5; count * pillars.len()];
        for (patch, edges) in self.patches().iter().zip(&edges) {
            // What has no place is a point, which is not drawn.
            let Some([x, y, z]) = edges else { continue };
            let ends = [z[0], z[patch.dims.nk]];
            for (j, y) in y.iter().enumerate() {
                for (i, x) in x.iter().enumerate() {
                    let first = patch.to_lattice(Ijk { i, j, k: 0 });
                    let pillar = first.i + (dims.ni + 1) * first.j;
                    pillars[pillar] = column_line(*x, *y, ends);
                    let own = &mut depths[count * pillar..][..count];
                    own.fill(ends[1]);
                    own[..z.len()].copy_from_slice(z);
                }
            }
        }
        let list = |n: usize| {
            let (i, j) = (n / 4 % dims.ni, n / 4 / dims.ni);
            DepthList::new(count * self.pillar_index(i, j, n % 4), false)
        };
        Self {
            dims,
            slopes: vec![DVec2::ZERO; pillars.len()].into(),
            pillars: pillars.into(),
            lists: Arc::new((0..4 * dims.columns()).map(list).collect()),
            depths: Arc::new(depths),
            sorted: Arc::new(vec![true; dims.columns()]),
            active_cells: self.active_cells.clone(),
            activity: self.activity.clone(),
            map_axes: self.flat_axes(),
            patches: self.patches.clone(),
            flat: Some(Arc::new(Flat {
                of: self.clone(),
                left_out: edges.iter().map(Option::is_none).collect(),
            })),
            found: Found::default(),
        }
    }

    /// Map axes that turn J around where the model is left-handed on the map.
    fn flat_axes(&self) -> Option<MapAxes> {
        let turn = self
            .map_axes()
            .map_or(1.0, |axes| axes.ex.perp_dot(axes.ey));
        (self.signed_bulk_volume() * turn < 0.0).then_some(MapAxes {
            origin: DVec2::ZERO,
            ex: DVec2::X,
            ey: -DVec2::Y,
            unit: None,
        })
    }

    /// By patch its edges; `None` where it has no place.
    fn edges_of_patches(&self) -> Vec<Option<Edges>> {
        let mut made: Vec<Option<Edges>> = Vec::new();
        for patch in self.patches() {
            let edges = match made.get(patch.parent) {
                // Parents come first; the main grid is its own.
                None => Some(main_edges(patch.dims)),
                Some(of_parent) => {
                    let dims = self.patches()[patch.parent].dims;
                    of_parent.as_ref().and_then(|e| edges_in(patch, dims, e))
                }
            };
            made.push(edges);
        }
        made
    }
}

fn column_line(x: f64, y: f64, [top, bottom]: [f64; 2]) -> Pillar {
    Pillar {
        top: DVec3::new(x, y, top),
        bottom: DVec3::new(x, y, bottom),
    }
}

fn main_edges(dims: Dims) -> Edges {
    [dims.ni, dims.nj, dims.nk].map(|count| (0..=count).map(|n| n as f64 + 0.5).collect())
}

/// The edges of a local grid in those of its parent.
fn edges_in(patch: &Patch, parent: Dims, of_parent: &Edges) -> Option<Edges> {
    let hosts = patch.hosts_along(parent)?;
    let [x, y, z] = [0, 1, 2].map(|axis| divided(&hosts[axis], &of_parent[axis]));
    Some([x?, y?, z?])
}

/// Edges of rows that divide their hosts evenly; `None` where the hosts do not follow one another.
fn divided(hosts: &[usize], of_parent: &[f64]) -> Option<Vec<f64>> {
    let runs: Vec<&[usize]> = hosts.chunk_by(|a, b| a == b).collect();
    if runs.windows(2).any(|pair| pair[0][0] + 1 != pair[1][0]) {
        return None;
    }
    let mut edges = vec![*of_parent.get(*hosts.first()?)?];
    for run in runs {
        let (low, high) = (of_parent[run[0]], *of_parent.get(run[0] + 1)?);
        let within = |n: usize| low + (high - low) * n as f64 / run.len() as f64;
        // As coordinates of files: devices know no more digits.
        edges.extend((1..run.len()).map(|n| f64::from(within(n) as f32)));
        edges.push(high);
    }
    Some(edges)
}

impl Patch {
    /// By axis the parent's row of each of its rows; `None` where cells of one row lie in several.
    fn hosts_along(&self, parent: Dims) -> Option<[Vec<usize>; 3]> {
        let counts = [self.dims.ni, self.dims.nj, self.dims.nk];
        let mut rows = counts.map(|count| vec![None; count]);
        for (own, host) in self.hosts().iter().enumerate() {
            let own = self.dims.ijk(CellIndex(own as u32));
            let host = parent.ijk(*host);
            let pairs = [(own.i, host.i), (own.j, host.j), (own.k, host.k)];
            for (rows, (own, host)) in rows.iter_mut().zip(pairs) {
                if *rows[own].get_or_insert(host) != host {
                    return None;
                }
            }
        }
        let [i, j, k] = rows.map(|rows| rows.into_iter().collect::<Option<Vec<usize>>>());
        Some([i?, j?, k?])
    }
}
