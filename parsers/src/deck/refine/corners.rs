//! Corners of cells that divide others along lines between the edges of these, as places of a trilinear map.

/// A part of a host along an axis.
#[derive(Clone, Copy)]
pub(super) struct Share {
    /// Number of the host along the axis.
    pub(super) host: usize,
    /// Where in the host it begins and ends, from 0 to 1.
    pub(super) ends: [f64; 2],
}

impl Share {
    pub(super) fn size(self) -> f64 {
        self.ends[1] - self.ends[0]
    }
}

/// Pillars and depths of a grid.
pub(in super::super) struct Corners<'a> {
    pub(in super::super) dims: [usize; 3],
    pub(in super::super) coord: &'a [f64],
    pub(in super::super) zcorn: &'a [f64],
}

/// A host along an axis, and a place in it from 0 to 1.
type Within = (usize, f64);

impl Corners<'_> {
    /// Depth of a corner of a cell, numbered along i first, then j, then k.
    pub(super) fn depth(&self, [i, j, k]: [usize; 3], corner: usize) -> f64 {
        let [ni, nj, _] = self.dims;
        let (x, y, z) = (
            2 * i + (corner & 1),
            2 * j + (corner >> 1 & 1),
            2 * k + (corner >> 2),
        );
        self.zcorn[x + 2 * ni * (y + 2 * nj * z)]
    }

    pub(super) fn ends(&self, i: usize, j: usize) -> &[f64] {
        let pillar = 6 * (i + (self.dims[0] + 1) * j);
        &self.coord[pillar..pillar + 6]
    }

    /// The pillar through a place in a column, between the pillars of the column, from the top of a layer to the bottom of
    /// another one.
    fn pillar(&self, (i, u): Within, (j, v): Within, layers: [usize; 2]) -> [f64; 6] {
        let corners = || (0..4).map(|c| (c, part(u, c & 1) * part(v, c >> 1)));
        let mut line = [0.0; 6];
        for (half, corner) in [(0, 0), (1, 4)] {
            for (c, weight) in corners() {
                let depth = self.depth([i, j, layers[half]], c + corner);
                let [x, y] = place_at(self.ends(i + (c & 1), j + (c >> 1)), depth);
                for (sum, value) in line[3 * half..].iter_mut().zip([x, y, depth]) {
                    *sum += weight * value;
                }
            }
        }
        if line[2] < line[5] {
            return line;
        }
        // Without thickness between them the ends say where the pillar goes.
        let mut line = [0.0; 6];
        for (c, weight) in corners() {
            let ends = self.ends(i + (c & 1), j + (c >> 1));
            for (sum, value) in line.iter_mut().zip(ends) {
                *sum += weight * value;
            }
        }
        line
    }

    pub(super) fn coord_of(&self, [along_i, along_j, along_k]: &[Vec<Share>; 3]) -> Vec<f64> {
        let layers = [along_k.first(), along_k.last()].map(|share| share.map_or(0, |s| s.host));
        let mut coord = Vec::with_capacity(6 * (along_i.len() + 1) * (along_j.len() + 1));
        for j in edges(along_j) {
            for i in edges(along_i) {
                coord.extend(self.pillar(i, j, layers));
            }
        }
        coord
    }

    pub(super) fn zcorn_of(&self, [along_i, along_j, along_k]: &[Vec<Share>; 3]) -> Vec<f64> {
        let both = |shares: &[Share]| -> Vec<Within> {
            let both = |share: &Share| share.ends.map(|end| (share.host, end));
            shares.iter().flat_map(both).collect()
        };
        let [along_i, along_j, along_k] = [along_i, along_j, along_k].map(|shares| both(shares));
        let mut zcorn = Vec::with_capacity(along_i.len() * along_j.len() * along_k.len());
        for (k, w) in along_k {
            for &(j, v) in &along_j {
                zcorn.extend(along_i.iter().map(|&(i, u)| {
                    let of_corner = |c: usize| {
                        let weight = part(u, c & 1) * part(v, c >> 1 & 1) * part(w, c >> 2);
                        weight * self.depth([i, j, k], c)
                    };
                    (0..8).map(of_corner).sum::<f64>()
                }));
            }
        }
        zcorn
    }
}

/// How much an end, 0 or 1, counts at a place between them.
pub(super) fn part(place: f64, end: usize) -> f64 {
    if end == 0 { 1.0 - place } else { place }
}

/// x and y of a pillar at a depth.
pub(super) fn place_at(ends: &[f64], depth: f64) -> [f64; 2] {
    let length = ends[5] - ends[2];
    let along = if length == 0.0 {
        0.0
    } else {
        (depth - ends[2]) / length
    };
    [0, 1].map(|n| ends[n] + along * (ends[n + 3] - ends[n]))
}

/// Where the pillars of cells stand along an axis.
fn edges(shares: &[Share]) -> impl Iterator<Item = Within> {
    let starts = shares.iter().map(|share| (share.host, share.ends[0]));
    starts.chain(shares.last().map(|share| (share.host, share.ends[1])))
}
