//! Rings and sectors of a radial local grid, as grid files have them: pillars by radius and angle around the middle of one
//! column (RADFIN) or of two by two (RADFIN4).
//!
//! As in the files of a simulator (LGR_TESTMOD of Eclipse), angles run from the side of I + to that of J -, the edges of
//! sectors that are all the same reach corners and middles of sides, and the outermost ring is as large as the cells that
//! it refines, whatever its radius.

use std::f64::consts::PI;
use std::ops::Range;

use super::corners::{Corners, Share, part, place_at};
use super::{DIVISIONS, Refinement};
use crate::error::Warnings;

/// How far edges of sectors may be off, in degrees.
const NEAR: f64 = 1e-3;

/// Where the rings of a grid end.
enum Radii {
    /// From the innermost to the outermost radius.
    Given(Vec<f64>),
    /// By the innermost and the outermost radius, if that is given: each one is the one before times the same factor.
    Growing(f64, Option<f64>),
}

/// The cells of a radial local grid.
pub(super) struct Rings {
    radii: Radii,
    rings: usize,
    /// Angles of the edges of sectors, in degrees from 0 to 360.
    angles: Vec<f64>,
    /// True where they are those of the deck, else they are of a square.
    are_given: bool,
    /// The first column that is refined, and how many are along I and J.
    first: [usize; 2],
    columns: usize,
    pub(super) along_k: Vec<Share>,
}

impl Rings {
    /// Of cells along radius, angle and k, in the hosts of these ranges.
    pub(super) fn of(
        refinement: &Refinement,
        [rings, sectors, _]: [usize; 3],
        ranges: &[Range<usize>; 3],
        along_k: Vec<Share>,
        warnings: &mut Warnings,
    ) -> Result<Self, String> {
        let columns = if refinement.place.keyword == "RADFIN" {
            1
        } else {
            2
        };
        if ranges[..2].iter().any(|range| range.len() != columns) {
            return Err("RADFIN4 refines two columns along I and two along J".into());
        }
        let unused = DIVISIONS[..2].as_flattened();
        let unused = refinement
            .divisions
            .iter()
            .find(|b| unused.contains(&b.name.as_str()));
        if let Some(block) = unused {
            let message = format!(
                "{} is not used: local grid {} is radial",
                block.name, refinement.name
            );
            block.place().warn(warnings, message);
        }
        let radii = refinement.radii(rings, warnings)?;
        let given = refinement.sizes("DTHETAV", ["DTHETA", "sectors"], [rings, sectors], 1)?;
        let are_given = given.is_some();
        #[allow(clippy::cast_precision_loss, reason = "sectors are few")]
        let even = || vec![360.0 / sectors as f64; sectors];
        let mut angles = sums(0.0, &given.unwrap_or_else(even));
        let whole = angles[sectors];
        if (whole - 360.0).abs() > NEAR {
            return Err(format!(
                "its sectors have {whole} degrees together and need 360"
            ));
        }
        angles[sectors] = 360.0;
        let is_edge = |turn: f64| angles.iter().any(|angle| (angle - turn).abs() <= NEAR);
        if columns == 2 && ![90.0, 180.0, 270.0].into_iter().all(is_edge) {
            return Err(
                "each of its sectors must lie in one column: 4 sectors, or 8, or DTHETAV with edges at 90, 180 and 270 degrees"
                    .into(),
            );
        }
        Ok(Self {
            radii,
            rings,
            angles,
            are_given,
            first: [ranges[0].start, ranges[1].start],
            columns,
            along_k,
        })
    }

    fn sectors(&self) -> usize {
        self.angles.len() - 1
    }

    /// Which column a sector lies in, along I and J, from 0.
    fn column(&self, sector: usize) -> [usize; 2] {
        if self.columns == 1 {
            return [0, 0];
        }
        let middle = 0.5 * (self.angles[sector] + self.angles[sector + 1]);
        let is_high_i = !(90.0..270.0).contains(&middle);
        let is_high_j = middle >= 180.0;
        [usize::from(is_high_i), usize::from(is_high_j)]
    }

    /// The number of the host of each cell, in a parent `ni` by `nj` cells wide.
    pub(super) fn hosts(&self, [ni, nj]: [usize; 2]) -> Vec<usize> {
        let mut hosts = Vec::with_capacity(self.rings * self.sectors() * self.along_k.len());
        for share in &self.along_k {
            for sector in 0..self.sectors() {
                let [i, j] = self.column(sector);
                let host = self.first[0] + i + ni * (self.first[1] + j + nj * share.host);
                hosts.extend(std::iter::repeat_n(host, self.rings));
            }
        }
        hosts
    }

    /// COORD and ZCORN, the first by radius and angle.
    pub(super) fn corners(&self, parent: &Corners<'_>) -> Result<[Vec<f64>; 2], String> {
        let plan = Plan::of(self, parent);
        let radii = self.radii(plan.area)?;
        let edges: Vec<Edge> = self
            .angles
            .iter()
            .map(|a| plan.edge(*a, self.are_given))
            .collect();
        if edges
            .iter()
            .any(|edge| !(edge.reach.is_finite() && edge.reach > 0.0))
        {
            return Err("the cells that it refines have no width".into());
        }
        let place = |ring: usize, edge: usize| {
            let Edge { ways, reach, .. } = edges[edge];
            let along = match ring == self.rings {
                true => 1.0,
                false => (radii[ring] / reach).min(1.0),
            };
            ways.map(|way| along * way)
        };
        let ends = [0, self.along_k.len() - 1].map(|k| self.along_k[k]);
        let mut coord = Vec::with_capacity(6 * radii.len() * edges.len());
        for (edge, line) in edges.iter().enumerate() {
            for (ring, radius) in radii.iter().enumerate() {
                let sector = edge.min(self.sectors() - 1);
                let at = place(ring, edge);
                let top = self.depth(parent, sector, at, (ends[0].host, ends[0].ends[0]));
                let bottom = self.depth(parent, sector, at, (ends[1].host, ends[1].ends[1]));
                let bottom = if bottom > top { bottom } else { top + 1.0 };
                coord.extend([*radius, line.angle, top, *radius, line.angle, bottom]);
            }
        }
        let mut zcorn = Vec::with_capacity(8 * self.rings * self.sectors() * self.along_k.len());
        for share in &self.along_k {
            for end in share.ends {
                for row in 0..2 * self.sectors() {
                    let (sector, edge) = (row / 2, row.div_ceil(2));
                    zcorn.extend((0..2 * self.rings).map(|x| {
                        let at = place(x.div_ceil(2), edge);
                        self.depth(parent, sector, at, (share.host, end))
                    }));
                }
            }
        }
        Ok([coord, zcorn])
    }

    /// The radii in cells of an area: the outermost one is that of a circle as large.
    fn radii(&self, area: f64) -> Result<Vec<f64>, String> {
        let outermost = (area / PI).sqrt();
        let mut radii = match &self.radii {
            Radii::Given(radii) => radii.clone(),
            Radii::Growing(inner, outer) => {
                #[allow(clippy::cast_precision_loss, reason = "rings are few")]
                let part = |ring: usize| ring as f64 / self.rings as f64;
                let factor = outer.unwrap_or(outermost) / inner;
                (0..=self.rings)
                    .map(|ring| inner * factor.powf(part(ring)))
                    .collect()
            }
        };
        radii[self.rings] = outermost;
        match radii[self.rings - 1] < outermost {
            true => Ok(radii),
            false => Err(format!(
                "its outermost ring begins at a radius of {}, and the cells that it refines are as large as a circle with {outermost}",
                radii[self.rings - 1]
            )),
        }
    }

    /// The depth at a place in the columns, from -1 to 1 along I and J, as a sector there has it; `k` is a host and a place
    /// in it.
    fn depth(
        &self,
        parent: &Corners<'_>,
        sector: usize,
        at: [f64; 2],
        (layer, w): (usize, f64),
    ) -> f64 {
        let column = self.column(sector);
        let [u, v] = [0, 1].map(|axis| match (self.columns, column[axis]) {
            (1, _) => 0.5 * (at[axis] + 1.0),
            (_, 0) => at[axis] + 1.0,
            _ => at[axis],
        });
        let host = [self.first[0] + column[0], self.first[1] + column[1], layer];
        let of_corner = |c: usize| {
            let weight = part(u, c & 1) * part(v, c >> 1 & 1) * part(w, c >> 2);
            weight * parent.depth(host, c)
        };
        (0..8).map(of_corner).sum()
    }
}

/// Where the edge of a sector runs.
#[derive(Clone, Copy)]
struct Edge {
    /// In degrees.
    angle: f64,
    /// Where it ends at the side of the columns, from -1 to 1 along I and J.
    ways: [f64; 2],
    /// How far that is from the middle.
    reach: f64,
}

/// The columns seen from above.
struct Plan {
    /// Corners by I and J, as those of a cell.
    corners: [[f64; 2]; 4],
    middle: [f64; 2],
    /// Half the way across, along I and J.
    half: [[f64; 2]; 2],
    area: f64,
}

impl Plan {
    fn of(rings: &Rings, parent: &Corners<'_>) -> Self {
        let layer = rings.along_k[0].host;
        let corners: [[f64; 2]; 4] = std::array::from_fn(|c| {
            let [i, j] =
                [0, 1].map(|axis| rings.first[axis] + (c >> axis & 1) * (rings.columns - 1));
            let depth = parent.depth([i, j, layer], c);
            place_at(parent.ends(i + (c & 1), j + (c >> 1)), depth)
        });
        let sum = |signs: [f64; 4]| {
            [0, 1].map(|n| (0..4).map(|c| signs[c] * corners[c][n]).sum::<f64>() / 4.0)
        };
        let [across, along] =
            [[3, 0], [2, 1]].map(|[a, b]| [0, 1].map(|n| corners[a][n] - corners[b][n]));
        Self {
            corners,
            middle: sum([1.0; 4]),
            half: [sum([-1.0, 1.0, -1.0, 1.0]), sum([-1.0, -1.0, 1.0, 1.0])],
            area: 0.5 * (across[0] * along[1] - across[1] * along[0]).abs(),
        }
    }

    /// The edge of a sector at an angle: of the columns as they are, or of a square.
    fn edge(&self, angle: f64, is_given: bool) -> Edge {
        let lengths = self.half.map(|[x, y]| x.hypot(y));
        let (sin, cos) = angle.to_radians().sin_cos();
        let way = match is_given {
            true => [cos / lengths[0], -sin / lengths[1]],
            false => [cos, -sin],
        };
        let longest = way[0].abs().max(way[1].abs());
        let ways = way.map(|part| part / longest);
        let weight =
            |c: usize| part(0.5 * (ways[0] + 1.0), c & 1) * part(0.5 * (ways[1] + 1.0), c >> 1);
        let off = [0, 1].map(|n| {
            let end: f64 = (0..4).map(|c| weight(c) * self.corners[c][n]).sum();
            end - self.middle[n]
        });
        let found = if is_given {
            angle
        } else {
            self.angle(off, angle)
        };
        Edge {
            angle: found,
            ways,
            reach: off[0].hypot(off[1]),
        }
    }

    /// The angle of a way from I + to J -, of all that it may be the nearest to `near`.
    fn angle(&self, [x, y]: [f64; 2], near: f64) -> f64 {
        let [[ix, iy], [jx, jy]] = self.half;
        // J - lies on the side of I + on which J + does not.
        let turn = -(ix * jy - iy * jx).signum();
        let angle = (turn * (ix * y - iy * x))
            .atan2(ix * x + iy * y)
            .to_degrees();
        angle + 360.0 * ((near - angle) / 360.0).round()
    }
}

impl Refinement {
    /// What the deck says of the radii of so many rings.
    fn radii(&self, rings: usize, warnings: &mut Warnings) -> Result<Radii, String> {
        let [inner, outer] = self.radii.unwrap_or_default();
        let number = |keyword: &str, of_record: Option<f64>| -> Result<Option<f64>, String> {
            let given = self.read(keyword, 1).transpose()?;
            Ok(given
                .and_then(|values| values.first().copied())
                .or(of_record))
        };
        let inner = number("INRAD", inner)?;
        let inner = inner.ok_or("INRAD, the radius of its innermost ring, is missing")?;
        if inner <= 0.0 {
            return Err(format!("INRAD needs a radius above 0, not {inner}"));
        }
        let sectors = self.dims[1];
        if let Some(sizes) = self.sizes("DRV", ["DR", "rings"], [rings, sectors], 0)? {
            return Ok(Radii::Given(sums(inner, &sizes)));
        }
        let outer = number("OUTRAD", outer)?;
        match outer {
            Some(outer) if outer <= inner => {
                return Err(format!("OUTRAD {outer} must be above INRAD {inner}"));
            }
            Some(_) => {}
            None => self.place.warn(
                warnings,
                format!(
                    "local grid {} has neither DRV nor OUTRAD: each of its rings is wider than the one before by the same factor, out to the cells that it refines, which may not be the simulator's",
                    self.name
                ),
            ),
        }
        Ok(Radii::Growing(inner, outer))
    }

    /// Sizes along the radius (axis 0) or around (1): as many as there are, by a vector or for each cell.
    fn sizes(
        &self,
        vector: &str,
        [cells, what]: [&str; 2],
        counts: [usize; 2],
        axis: usize,
    ) -> Result<Option<Vec<f64>>, String> {
        let of_vector = self.read(vector, counts[axis]).transpose()?;
        let of_cells = self.read(cells, self.dims.iter().product()).transpose()?;
        let sizes = match (of_vector, of_cells) {
            (Some(sizes), _) => sizes,
            (None, None) => return Ok(None),
            (None, Some(values)) => {
                let place = |cell: usize| [cell % counts[0], cell / counts[0] % counts[1]][axis];
                let stride = [1, counts[0]][axis];
                let sizes: Vec<f64> = (0..counts[axis]).map(|n| values[n * stride]).collect();
                let mut all = values.iter().enumerate();
                if all.any(|(cell, value)| *value != sizes[place(cell)]) {
                    return Err(format!(
                        "{cells} is not the same for all cells: give the sizes of its {what} by {vector}"
                    ));
                }
                sizes
            }
        };
        match sizes.iter().all(|size| *size > 0.0) {
            true => Ok(Some(sizes)),
            false => Err(format!("{vector} (or {cells}) needs sizes above 0")),
        }
    }
}

/// What sizes that follow each other reach from a start.
fn sums(start: f64, sizes: &[f64]) -> Vec<f64> {
    let mut sum = start;
    let ends = sizes.iter().map(|size| {
        sum += size;
        sum
    });
    std::iter::once(start).chain(ends).collect()
}
