//! The grid of a ROFF file, in its own form and as pillars and depths.

use super::write::turned;
use super::{RoffFile, natural};
use crate::error::{ErrorKind, ParseError};
use crate::geometry::first_not;

/// A grid as the file has it: layers from the bottom, coordinates before offset and scale.
#[derive(Debug, Clone, PartialEq)]
pub struct RoffGrid {
    /// Cells along i, j and k.
    pub dims: [usize; 3],
    /// `translate`: added to x, y, z.
    pub offset: [f64; 3],
    /// `scale`: what x, y, z are multiplied by after that. That of z is -1 as a rule, which makes depths of heights.
    pub scale: [f64; 3],
    /// **Shape**: 6 values per pillar, of which j runs fastest: x, y, z of the lower, then of the upper end.
    pub corner_lines: Vec<f64>,
    /// How many values of z there are at each node, 1, 2, 4 or 8, of which k runs fastest, then j.
    pub splits: Vec<u8>,
    /// Values of z at the nodes: of the cells below before those above, south before north, west before east.
    pub z: Vec<f64>,
    /// Which cells are active, k fastest, then j; absent = all.
    pub active: Option<Vec<bool>>,
    /// Number of layers of each subgrid, from the top.
    pub subgrids: Vec<i32>,
}

/// A grid as decks and EGRID files have it.
#[derive(Debug, Clone, PartialEq)]
pub struct Pillars {
    /// Cells along i, j and k.
    pub dims: [usize; 3],
    /// **Shape**: 6 values per pillar: x, y, depth of the upper, then of the lower end.
    pub coord: Vec<f64>,
    /// **Shape**: 8 depths per cell, index `2i+di + 2ni(2j+dj) + 4ni*nj(2k+dk)`.
    pub zcorn: Vec<f64>,
    /// One value per cell; absent = all active.
    pub actnum: Option<Vec<i32>>,
}

pub(super) fn read(file: &RoffFile) -> Result<RoffGrid, ParseError> {
    let dims = file.dims()?;
    let [ni, nj, nk] = dims;
    let pillars = (ni + 1) * (nj + 1);
    let triple = |tag: &str, names: [&str; 3], defaults: [f64; 3]| {
        let Some(tag) = file.find(tag) else {
            return Ok(defaults);
        };
        let mut values = defaults;
        for (value, name) in values.iter_mut().zip(names) {
            *value = file.number(tag, name)?.unwrap_or(*value);
        }
        Ok(values)
    };
    let array = |tag: &str, name: &str| {
        let found = file.need(tag)?.find(name);
        found.ok_or_else(|| {
            let message = format!("has no {name}");
            let at = crate::error::At::File;
            ParseError::of(ErrorKind::MissingKeyword, file.path(), at, tag, message)
        })
    };
    let finite = |tag: &str, count: usize| {
        let item = array(tag, "data")?;
        file.check_count(item, count)?;
        let values = file.f64s(item)?;
        match first_not(&values, |v| v.is_finite()) {
            None => Ok(values),
            Some(number) => {
                let message = format!("value {number} of {tag} is not a finite number");
                Err(file.error(ErrorKind::BadValue, item, message))
            }
        }
    };
    let corner_lines = finite("cornerLines", 6 * pillars)?;
    let splits = match file.need("zvalues")?.find("splitEnz") {
        None => vec![1; pillars.saturating_mul(nk + 1)],
        Some(item) => {
            file.check_count(item, pillars.saturating_mul(nk + 1))?;
            let splits: Vec<u8> = file.f64s(item)?.into_iter().map(|v| v as u8).collect();
            if let Some(number) = first_not(&splits, |s| matches!(s, 1 | 2 | 4 | 8)) {
                let message = format!("value {number} is not 1, 2, 4 or 8");
                return Err(file.error(ErrorKind::BadValue, item, message));
            }
            splits
        }
    };
    let count = splits.iter().map(|s| usize::from(*s)).sum();
    let active = match file.find("active").and_then(|tag| tag.find("data")) {
        None => None,
        Some(item) => {
            file.check_count(item, ni * nj * nk)?;
            Some(file.f64s(item)?.into_iter().map(|v| v != 0.0).collect())
        }
    };
    let layers = file.find("subgrids").and_then(|tag| tag.find("nLayers"));
    let layers = layers.map(|item| file.f64s(item)).transpose()?;
    Ok(RoffGrid {
        dims,
        offset: triple("translate", ["xoffset", "yoffset", "zoffset"], [0.0; 3])?,
        scale: triple("scale", ["xscale", "yscale", "zscale"], [1.0, 1.0, -1.0])?,
        corner_lines,
        z: finite("zvalues", count)?,
        splits,
        active,
        subgrids: layers
            .unwrap_or_default()
            .into_iter()
            .map(|v| v as i32)
            .collect(),
    })
}

impl RoffGrid {
    /// The grid as pillars and depths: layer 1 is the uppermost, coordinates are those of the map, depths grow
    /// downward.
    pub fn pillars(&self) -> Pillars {
        let [ni, nj, nk] = self.dims;
        let real = |axis: usize, value: f64| (value + self.offset[axis]) * self.scale[axis];
        let mut coord = Vec::with_capacity(6 * (ni + 1) * (nj + 1));
        for j in 0..=nj {
            for i in 0..=ni {
                let line = &self.corner_lines[6 * (i * (nj + 1) + j)..][..6];
                for end in [3, 0] {
                    coord.extend((0..3).map(|axis| real(axis, line[end + axis])));
                }
            }
        }
        let starts = self.starts();
        let mut zcorn = Vec::with_capacity(8 * ni * nj * nk);
        for plane in 0..2 * nk {
            // Layers of the file count from the bottom; the upper corners of a cell are at the node above it.
            let (k, is_upper) = (nk - 1 - plane / 2, plane % 2 == 0);
            for row in 0..2 * nj {
                for column in 0..2 * ni {
                    let node = [
                        column.div_ceil(2),
                        row.div_ceil(2),
                        k + usize::from(is_upper),
                    ];
                    // Seen from the node, the cell is to the east of its western corners.
                    let is_east = column % 2 == 0;
                    let is_north = row % 2 == 0;
                    let quadrant = usize::from(is_east) + 2 * usize::from(is_north);
                    let z = self.z_at(&starts, node, quadrant, !is_upper);
                    zcorn.push(real(2, z));
                }
            }
        }
        let actnum = self.active.as_ref();
        Pillars {
            dims: self.dims,
            coord,
            zcorn,
            actnum: actnum.map(|a| natural(self.dims, a, |active| i32::from(*active))),
        }
    }

    /// The grid of pillars and depths, whose x and y are kept relative to `origin`: the file has 4 bytes for each.
    /// Nodes have as many values as the cells around them differ. Arrays that are too short give a grid that cannot be
    /// written.
    pub fn of(pillars: &Pillars, origin: [f64; 2]) -> Self {
        let [ni, nj, nk] = pillars.dims;
        let mut corner_lines = Vec::with_capacity(pillars.coord.len());
        let (mut splits, mut z) = (Vec::new(), Vec::new());
        for i in 0..=ni {
            for j in 0..=nj {
                let line = pillars.coord.get(6 * (i + (ni + 1) * j)..).unwrap_or(&[]);
                for end in [3, 0].into_iter().filter_map(|at| line.get(at..at + 3)) {
                    corner_lines.extend([end[0] - origin[0], end[1] - origin[1], -end[2]]);
                }
                for k in 0..=nk {
                    let before = z.len();
                    pillars.add_node([i, j, k], &mut z);
                    splits.push((z.len() - before) as u8);
                }
            }
        }
        let active = |actnum: &Vec<i32>| {
            let active: Vec<bool> = actnum.iter().map(|a| *a != 0).collect();
            turned(pillars.dims, &active)
        };
        Self {
            dims: pillars.dims,
            offset: [origin[0], origin[1], 0.0],
            scale: [1.0, 1.0, -1.0],
            corner_lines,
            splits,
            z,
            active: pillars.actnum.as_ref().map(active),
            subgrids: Vec::new(),
        }
    }

    /// Where the values of each node start.
    fn starts(&self) -> Vec<usize> {
        let mut sum = 0;
        let start = |split: &u8| {
            let start = sum;
            sum += usize::from(*split);
            start
        };
        self.splits.iter().map(start).collect()
    }

    /// z of the cell that lies in `quadrant` of a node (south-west, south-east, north-west, north-east), above or
    /// below it.
    fn z_at(&self, starts: &[usize], node: [usize; 3], quadrant: usize, is_above: bool) -> f64 {
        let [_, nj, nk] = self.dims;
        let [i, j, k] = node;
        let n = (i * (nj + 1) + j) * (nk + 1) + k;
        let above = usize::from(is_above);
        let within = match self.splits[n] {
            1 => 0,
            2 => above,
            4 => quadrant,
            _ => quadrant + 4 * above,
        };
        self.z[starts[n] + within]
    }
}

impl Pillars {
    /// Appends the heights at a node, whose k counts from the bottom: one where all cells around it agree, two where
    /// those below differ from those above, four where columns differ, else eight.
    fn add_node(&self, node: [usize; 3], z: &mut Vec<f64>) {
        let around: [Option<f64>; 8] = std::array::from_fn(|n| self.height(node, n));
        let Some(some) = around.iter().copied().flatten().next() else {
            return;
        };
        // What lies outside of the grid agrees with what there is.
        let agree = |values: &[Option<f64>]| {
            let mut known = values.iter().flatten();
            let first = known.next();
            known.all(|v| Some(v) == first)
        };
        let first =
            |values: &[Option<f64>]| values.iter().copied().flatten().next().unwrap_or(some);
        let column = |n: usize| [around[n], around[n + 4]];
        let layer = |n: usize| &around[4 * n..4 * n + 4];
        if agree(&around) {
            z.push(some);
        } else if (0..2).all(|n| agree(layer(n))) {
            z.extend((0..2).map(|n| first(layer(n))));
        } else if (0..4).all(|n| agree(&column(n))) {
            z.extend((0..4).map(|n| first(&column(n))));
        } else {
            z.extend((0..8).map(|n| around[n].unwrap_or(first(&column(n % 4)))));
        }
    }

    /// Height of the corner at a node of one of the eight cells around it; `None` where there is none.
    fn height(&self, [i, j, k]: [usize; 3], n: usize) -> Option<f64> {
        let [ni, nj, nk] = self.dims;
        let (east, north, above) = (n & 1, n >> 1 & 1, n >> 2);
        let cell = [
            (i + east).checked_sub(1).filter(|i| *i < ni)?,
            (j + north).checked_sub(1).filter(|j| *j < nj)?,
            // Layers of the model count from the top.
            (nk - k).checked_sub(above).filter(|k| *k < nk)?,
        ];
        // Of a cell to the east the corner is a western one, and so on.
        let column = 2 * cell[0] + 1 - east;
        let row = 2 * cell[1] + 1 - north;
        let plane = 2 * cell[2] + above;
        let depth = self.zcorn.get(column + 2 * ni * (row + 2 * nj * plane))?;
        Some(-depth)
    }
}
