//! ZCORN to shared depth lists, in parallel over bands of pillar rows.

use std::ops::Range;

use rayon::prelude::*;

use super::ids::Dims;

/// A list of depths in the pool: `nk + 1` where layers touch, `2 nk` where there are gaps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DepthList(u32);

impl DepthList {
    const GAPPED: u32 = 1 << 31;

    pub(super) fn new(offset: usize, gapped: bool) -> Self {
        Self(offset as u32 | if gapped { Self::GAPPED } else { 0 })
    }

    /// First entry in the pool.
    pub fn offset(self) -> usize {
        (self.0 & !Self::GAPPED) as usize
    }

    /// True when top and bottom of every layer are listed apart.
    pub fn gapped(self) -> bool {
        self.0 & Self::GAPPED != 0
    }

    /// Entries from one layer to the next.
    pub fn step(self) -> usize {
        if self.gapped() { 2 } else { 1 }
    }

    /// Pool positions of all entries, given the number of layers.
    pub fn entries(self, nk: usize) -> Range<usize> {
        let count = if self.gapped() { 2 * nk } else { nk + 1 };
        self.offset()..self.offset() + count
    }

    /// Pool position of the top (`dk` 0) or bottom (`dk` 1) of layer `k`.
    pub fn entry(self, k: usize, dk: usize) -> usize {
        self.offset() + self.step() * k + dk
    }
}

/// The part of the pool of depth lists that some columns need: only their lists, without gaps between them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UsedDepths {
    /// Ranges of the pool, rising, with the number of entries before each in the used part.
    ranges: Vec<(Range<usize>, usize)>,
    /// Entries of the used part.
    count: usize,
}

impl UsedDepths {
    /// Of lists, in any order, in columns of so many layers.
    pub(super) fn new(mut lists: Vec<DepthList>, nk: usize) -> Self {
        lists.par_sort_unstable_by_key(|list| list.offset());
        let mut made = Self {
            ranges: Vec::new(),
            count: 0,
        };
        for list in lists {
            let entries = list.entries(nk);
            match made.ranges.last_mut() {
                Some((last, _)) if last.end > entries.start => {}
                Some((last, _)) if last.end == entries.start => {
                    made.count += entries.len();
                    last.end = entries.end;
                }
                _ => {
                    let before = made.count;
                    made.count += entries.len();
                    made.ranges.push((entries, before));
                }
            }
        }
        made
    }

    /// Entries of the used part.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The entries of a pool that are used.
    ///
    /// **Shape**: `pool` has one value for each entry of the pool.
    pub fn of<'a, T>(&self, pool: &'a [T]) -> impl Iterator<Item = &'a [T]> + use<'_, 'a, T> {
        self.ranges.iter().map(|(range, _)| &pool[range.clone()])
    }

    /// Where a list of the pool begins in the used part; `None` of one that is not used.
    pub fn offset(&self, list: DepthList) -> Option<usize> {
        let at = list.offset();
        let behind = self.ranges.partition_point(|(range, _)| range.start <= at);
        let (range, before) = &self.ranges[behind.checked_sub(1)?];
        range.contains(&at).then(|| before + at - range.start)
    }
}

/// Depths of one row of columns: `[i][corner][2 nk]`, top and bottom of each layer in turn.
struct Row<Z> {
    depths: Vec<Z>,
    layers: usize,
}

impl<Z: Copy> Row<Z> {
    fn read(dims: Dims, zcorn: &[Z], j: usize) -> Self {
        let layers = 2 * dims.nk;
        let mut depths = vec![zcorn[0]; dims.ni * 4 * layers];
        for plane in 0..layers {
            for dj in 0..2 {
                let at = 2 * dims.ni * (2 * j + dj + 2 * dims.nj * plane);
                for (x, &z) in zcorn[at..at + 2 * dims.ni].iter().enumerate() {
                    depths[(4 * (x / 2) + x % 2 + 2 * dj) * layers + plane] = z;
                }
            }
        }
        Self { depths, layers }
    }

    fn corner(&self, i: usize, corner: usize) -> &[Z] {
        &self.depths[(4 * i + corner) * self.layers..][..self.layers]
    }
}

/// Lists of a band of pillar rows, with offsets into the band's own pool.
#[derive(Default)]
struct Band {
    /// Column corner (`4 * column + corner`), and its list.
    lists: Vec<(usize, Stored)>,
    depths: Vec<f64>,
}

/// A list in the pool of a band.
#[derive(Clone, Copy)]
struct Stored {
    offset: usize,
    is_gapped: bool,
    is_sorted: bool,
}

impl Band {
    /// Stores `depths` of a column corner, sharing a list that this pillar has already.
    fn add<Z: Copy + Into<f64>>(&mut self, depths: &[Z], seen: &mut Vec<Stored>) -> Stored {
        let depth = |plane: usize| -> f64 { depths[plane].into() };
        let bottoms = (1..depths.len() - 1).step_by(2);
        let is_gapped = bottoms
            .clone()
            .any(|plane| depth(plane) != depth(plane + 1));
        let planes =
            || (0..depths.len()).filter(|plane| is_gapped || *plane == 0 || plane % 2 == 1);
        for &stored in seen.iter().filter(|stored| stored.is_gapped == is_gapped) {
            let list = self.depths[stored.offset..].iter();
            if list
                .zip(planes())
                .all(|(known, plane)| *known == depth(plane))
            {
                return stored;
            }
        }
        let offset = self.depths.len();
        self.depths.extend(planes().map(depth));
        let stored = Stored {
            offset,
            is_gapped,
            is_sorted: self.depths[offset..].is_sorted(),
        };
        seen.push(stored);
        stored
    }
}

/// The depth lists of a grid.
pub(super) struct Lists {
    /// The four of every column.
    pub lists: Vec<DepthList>,
    /// The pool that they point into, where they lie in the order of their pillars.
    pub depths: Vec<f64>,
    /// By column: true where depth grows with the layer, or stays, on all pillars.
    pub sorted: Vec<bool>,
}

/// The depth lists of ZCORN.
pub(super) fn build<Z: Copy + Into<f64> + Sync + Send>(dims: Dims, zcorn: &[Z]) -> Lists {
    let rows = dims.nj + 1;
    let band_rows = rows.div_ceil(4 * rayon::current_num_threads()).max(1);
    let bands: Vec<Band> = (0..rows.div_ceil(band_rows))
        .into_par_iter()
        .map(|band| {
            let end = ((band + 1) * band_rows).min(rows);
            read_band(dims, zcorn, band * band_rows..end)
        })
        .collect();
    let mut lists = vec![DepthList::new(0, false); 4 * dims.columns()];
    let mut sorted = vec![true; dims.columns()];
    let mut depths = vec![0.0; bands.iter().map(|b| b.depths.len()).sum()];
    let mut places = Vec::with_capacity(bands.len());
    let (mut rest, mut base) = (depths.as_mut_slice(), 0);
    for band in &bands {
        for &(at, stored) in &band.lists {
            lists[at] = DepthList::new(base + stored.offset, stored.is_gapped);
            sorted[at / 4] &= stored.is_sorted;
        }
        let (place, behind) = rest.split_at_mut(band.depths.len());
        places.push(place);
        (rest, base) = (behind, base + band.depths.len());
    }
    let copies = bands.into_par_iter().zip(places);
    copies.for_each(|(band, place)| place.copy_from_slice(&band.depths));
    Lists {
        lists,
        depths,
        sorted,
    }
}

fn read_band<Z: Copy + Into<f64>>(dims: Dims, zcorn: &[Z], pillar_rows: Range<usize>) -> Band {
    let mut band = Band::default();
    // Rows of columns before (j - 1) and behind (j) the current row of pillars.
    let row = |j: usize| (j < dims.nj).then(|| Row::read(dims, zcorn, j));
    let mut before = pillar_rows.start.checked_sub(1).and_then(row);
    for pj in pillar_rows {
        let behind = row(pj);
        for pi in 0..=dims.ni {
            let mut seen = Vec::with_capacity(4);
            // The up to four columns around pillar (pi, pj), each with its corner on it.
            for (row, j, dj) in [(&before, pj.wrapping_sub(1), 1), (&behind, pj, 0)] {
                let Some(row) = row else { continue };
                for (i, di) in [(pi.wrapping_sub(1), 1), (pi, 0)] {
                    if i < dims.ni {
                        let corner = di + 2 * dj;
                        let stored = band.add(row.corner(i, corner), &mut seen);
                        band.lists.push((4 * (i + dims.ni * j) + corner, stored));
                    }
                }
            }
        }
        before = behind;
    }
    band
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_give_back_every_zcorn_value() {
        let dims = Dims {
            ni: 7,
            nj: 5,
            nk: 4,
        };
        let mut random = fastrand::Rng::with_seed(3);
        // Few distinct values, so that sharing, touching layers and gaps all occur.
        let zcorn: Vec<f64> = (0..8 * dims.cells())
            .map(|at| {
                let plane = at / (4 * dims.columns());
                let jitter = if random.u32(0..20) == 0 { 0.25 } else { 0.0 };
                (plane.div_ceil(2)) as f64 + jitter
            })
            .collect();
        let Lists { lists, depths, .. } = build(dims, &zcorn);
        let mut gapped = 0;
        for (at, &z) in zcorn.iter().enumerate() {
            let (x, y) = (at % (2 * dims.ni), at / (2 * dims.ni) % (2 * dims.nj));
            let plane = at / (4 * dims.columns());
            let column = x / 2 + dims.ni * (y / 2);
            let list = lists[4 * column + x % 2 + 2 * (y % 2)];
            gapped += usize::from(list.gapped());
            assert_eq!(depths[list.entry(plane / 2, plane % 2)], z, "value {at}");
        }
        assert!(gapped > 0 && depths.len() < zcorn.len() * 3 / 4);
    }
}
