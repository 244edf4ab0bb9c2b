//! Means of cell values at vertices, pillar by pillar.

use rayon::prelude::*;

use super::depth_lists::DepthList;
use super::grid::Grid;
use super::ids::Dims;
use super::topology::COINCIDENT;

/// For each entry of the depth pool the mean of the active cells that share the vertex (same pillar, same depth), given
/// their values by active index; NaN where there is none, as cells without a value are.
pub(super) fn means(grid: &Grid, value: impl Fn(usize) -> f32 + Sync) -> Vec<f32> {
    let Dims { nj, .. } = grid.dims();
    let mut means = vec![0.0; grid.depths().len()];
    let mut rows = Vec::with_capacity(nj + 1);
    let (mut rest, mut first) = (means.as_mut_slice(), 0);
    for pj in 0..=nj {
        let end = if pj < nj {
            first_entry(grid, pj + 1)
        } else {
            first + rest.len()
        };
        let (entries, behind) = rest.split_at_mut(end - first);
        rows.push((first, entries));
        (rest, first) = (behind, end);
    }
    let rows = rows.into_par_iter().enumerate();
    rows.for_each(|(pj, (first, entries))| average_row(grid, &value, pj, (first, entries)));
    means
}

/// The first entry of the lists of a row of pillars: they lie in the order of their pillars.
fn first_entry(grid: &Grid, pj: usize) -> usize {
    let Dims { ni, nj, .. } = grid.dims();
    let before = pj.checked_sub(1).map(|j| grid.column_lists(ni * j)[2]);
    let behind = (pj < nj).then(|| grid.column_lists(ni * pj)[0]);
    let lists = before.into_iter().chain(behind);
    lists.map(DepthList::offset).min().unwrap_or(0)
}

/// Averages on the pillars of a row, whose entries begin with `first`.
fn average_row(
    grid: &Grid,
    value: impl Fn(usize) -> f32,
    pj: usize,
    (first, entries): (usize, &mut [f32]),
) {
    let Dims { ni, nj, nk } = grid.dims();
    entries.fill(f32::NAN);
    // Values of the columns behind the row of pillars and before it, a column after the other.
    let rows = [Some(pj), pj.checked_sub(1)].map(|j| {
        let j = j.filter(|j| *j < nj)?;
        let mut values = vec![f32::NAN; ni * nk];
        for k in 0..nk {
            for (i, active) in grid.active_in_row(j, k) {
                values[nk * i + k] = value(active);
            }
        }
        Some((j, values))
    });
    let mut pillar = OnPillar::default();
    for pi in 0..=ni {
        let corner = |corner: usize| {
            let i = pi.checked_sub(corner & 1).filter(|i| *i < ni)?;
            let (j, values) = rows[corner >> 1].as_ref()?;
            let list = grid.column_lists(i + ni * j)[corner];
            Some((list, &values[nk * i..][..nk]))
        };
        let corners: [Option<Around<'_>>; 4] = std::array::from_fn(corner);
        pillar.average(grid, &corners, |entry, mean| entries[entry - first] = mean);
    }
}

/// A column around a pillar: its list there, and its values by layer.
type Around<'a> = (DepthList, &'a [f32]);

/// Entries of a pillar's lists that cells with a value touch, and what was added up for vertices.
#[derive(Default)]
struct OnPillar {
    entries: Vec<Entry>,
    /// Of one list: sums of the cells that touch each entry, and how many these are.
    sums: Vec<(f64, f64)>,
    /// Vertices so far, and the last one that each cell was added to.
    vertices: usize,
    added: Vec<usize>,
}

struct Entry {
    depth: f64,
    /// In the pool, and in its list.
    at: usize,
    place: usize,
    list: DepthList,
    /// Of the cells that touch it, and how many these are.
    sum: f64,
    count: f64,
}

impl OnPillar {
    /// Tells the mean at each entry.
    fn average(
        &mut self,
        grid: &Grid,
        corners: &[Option<Around<'_>>; 4],
        mut tell: impl FnMut(usize, f32),
    ) {
        self.entries.clear();
        for (n, corner) in corners.iter().enumerate() {
            let Some((list, _)) = corner else { continue };
            let is_same = |known: &Option<Around<'_>>| known.is_some_and(|(l, _)| l == *list);
            if !corners[..n].iter().any(is_same) {
                self.add(grid, corners, *list);
            }
        }
        if !self.entries.is_sorted_by(|a, b| a.depth <= b.depth) {
            self.entries.sort_by(|a, b| a.depth.total_cmp(&b.depth));
        }
        let mut rest = self.entries.as_slice();
        while let Some(first) = rest.first() {
            let are_apart = |e: &Entry| e.depth - first.depth > COINCIDENT;
            let count = rest.iter().position(are_apart).unwrap_or(rest.len());
            let (vertex, behind) = rest.split_at(count);
            let mean = match vertex {
                [entry] => entry.sum / entry.count,
                _ => {
                    self.vertices += 1;
                    mean_of_cells(vertex, corners, self.vertices, &mut self.added)
                }
            };
            for entry in vertex {
                tell(entry.at, mean as f32);
            }
            rest = behind;
        }
    }

    /// Adds the entries of a list.
    fn add(&mut self, grid: &Grid, corners: &[Option<Around<'_>>; 4], list: DepthList) {
        let nk = grid.dims().nk;
        let entries = list.entries(nk);
        self.sums.clear();
        self.sums.resize(entries.len(), (0.0, 0.0));
        for (_, values) in corners.iter().flatten().filter(|(l, _)| *l == list) {
            for (k, value) in values.iter().enumerate().filter(|(_, v)| !v.is_nan()) {
                let top = list.step() * k;
                for (sum, count) in &mut self.sums[top..top + 2] {
                    *sum += f64::from(*value);
                    *count += 1.0;
                }
            }
        }
        let sums = self.sums.iter().enumerate();
        for (place, &(sum, count)) in sums.filter(|(_, (_, count))| *count > 0.0) {
            let at = entries.start + place;
            self.entries.push(Entry {
                depth: grid.depths()[at],
                at,
                place,
                list,
                sum,
                count,
            });
        }
    }
}

/// The layers whose cells touch an entry of a list.
fn touching(list: DepthList, place: usize, nk: usize) -> std::ops::Range<usize> {
    match list.gapped() {
        true => place / 2..place / 2 + 1,
        false => place.saturating_sub(1)..(place + 1).min(nk),
    }
}

/// The mean of the cells that touch entries of one vertex: a cell that is collapsed on the pillar counts once.
/// `added` holds the number of the last vertex that each cell was added to.
fn mean_of_cells(
    entries: &[Entry],
    corners: &[Option<Around<'_>>; 4],
    vertex: usize,
    added: &mut Vec<usize>,
) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for entry in entries {
        for (n, corner) in corners.iter().enumerate() {
            let Some((_, values)) = corner.filter(|(list, _)| *list == entry.list) else {
                continue;
            };
            added.resize(4 * values.len(), 0);
            for k in touching(entry.list, entry.place, values.len()) {
                let last = &mut added[n * values.len() + k];
                if !values[k].is_nan() && *last != vertex {
                    *last = vertex;
                    sum += f64::from(values[k]);
                    count += 1.0;
                }
            }
        }
    }
    sum / count
}
