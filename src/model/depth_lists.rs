//! ZCORN to shared depth lists, in parallel over bands of pillar rows.

use rayon::prelude::*;

use super::ids::Dims;

/// A list of depths in the pool: `nk + 1` where layers touch, `2 nk` where there are gaps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DepthList(u32);

impl DepthList {
    const GAPPED: u32 = 1 << 31;

    fn new(offset: usize, gapped: bool) -> Self {
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
    pub fn entries(self, nk: usize) -> std::ops::Range<usize> {
        let count = if self.gapped() { 2 * nk } else { nk + 1 };
        self.offset()..self.offset() + count
    }

    /// Pool position of the top (`dk` 0) or bottom (`dk` 1) of layer `k`.
    pub fn entry(self, k: usize, dk: usize) -> usize {
        self.offset() + self.step() * k + dk
    }
}

/// Depths of one row of columns: `[i][corner][2 nk]`, top and bottom of each layer in turn.
struct Row {
    depths: Vec<f64>,
    layers: usize,
}

impl Row {
    fn read<Z: Copy + Into<f64>>(dims: Dims, zcorn: &[Z], j: usize) -> Self {
        let layers = 2 * dims.nk;
        let mut depths = vec![0.0; dims.ni * 4 * layers];
        for plane in 0..layers {
            for dj in 0..2 {
                let at = 2 * dims.ni * (2 * j + dj + 2 * dims.nj * plane);
                for (x, &z) in zcorn[at..at + 2 * dims.ni].iter().enumerate() {
                    depths[(4 * (x / 2) + x % 2 + 2 * dj) * layers + plane] = z.into();
                }
            }
        }
        Self { depths, layers }
    }

    fn corner(&self, i: usize, corner: usize) -> &[f64] {
        &self.depths[(4 * i + corner) * self.layers..][..self.layers]
    }
}

/// Lists of a band of pillar rows, with offsets into the band's own pool.
#[derive(Default)]
struct Band {
    /// Column corner (`4 * column + corner`), list offset in the band, gapped.
    lists: Vec<(usize, usize, bool)>,
    depths: Vec<f64>,
}

impl Band {
    /// Stores `depths` of a column corner, sharing a list that this pillar has already.
    fn add(&mut self, depths: &[f64], seen: &mut Vec<(usize, usize, bool)>) -> (usize, bool) {
        let gapped = depths[1..depths.len() - 1]
            .chunks_exact(2)
            .any(|pair| pair[0] != pair[1]);
        for &(start, end, seen_gapped) in seen.iter() {
            if seen_gapped == gapped && same(&self.depths[start..end], depths, gapped) {
                return (start, gapped);
            }
        }
        let start = self.depths.len();
        if gapped {
            self.depths.extend_from_slice(depths);
        } else {
            self.depths.push(depths[0]);
            self.depths.extend(depths.iter().skip(1).step_by(2));
        }
        seen.push((start, self.depths.len(), gapped));
        (start, gapped)
    }
}

fn same(list: &[f64], depths: &[f64], gapped: bool) -> bool {
    if gapped {
        return list == depths;
    }
    list[0] == depths[0] && list[1..].iter().eq(depths.iter().skip(1).step_by(2))
}

/// The four lists of every column and the pool they point into, where lists lie in the order of their pillars.
pub(super) fn build<Z: Copy + Into<f64> + Sync>(
    dims: Dims,
    zcorn: &[Z],
) -> (Vec<DepthList>, Vec<f64>) {
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
    let mut depths = vec![0.0; bands.iter().map(|b| b.depths.len()).sum()];
    let mut places = Vec::with_capacity(bands.len());
    let (mut rest, mut base) = (depths.as_mut_slice(), 0);
    for band in &bands {
        for &(at, offset, gapped) in &band.lists {
            lists[at] = DepthList::new(base + offset, gapped);
        }
        let (place, behind) = rest.split_at_mut(band.depths.len());
        places.push(place);
        (rest, base) = (behind, base + band.depths.len());
    }
    let copies = bands.into_par_iter().zip(places);
    copies.for_each(|(band, place)| place.copy_from_slice(&band.depths));
    (lists, depths)
}

fn read_band<Z: Copy + Into<f64>>(
    dims: Dims,
    zcorn: &[Z],
    pillar_rows: std::ops::Range<usize>,
) -> Band {
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
                        let (offset, gapped) = band.add(row.corner(i, corner), &mut seen);
                        band.lists
                            .push((4 * (i + dims.ni * j) + corner, offset, gapped));
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
        let (lists, depths) = build(dims, &zcorn);
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
