//! Paths of wells in the space of the grid, and the cells that they go through.

use std::path::PathBuf;

use glam::DVec3;

use crate::model::{Crossing, Grid, Ijk};

/// The path of a well.
#[derive(Debug, Clone, PartialEq)]
pub struct WellPath {
    /// Its name.
    pub name: String,
    /// The file that it is from.
    pub file: PathBuf,
    /// What the third coordinate of the file was taken for, such as `depth`.
    pub vertical: &'static str,
    /// Points in the (map) space of the grid, from the head on.
    pub points: Vec<DVec3>,
    /// Measured depth of each point, as the file has it.
    pub measured: Option<Vec<f64>>,
    /// The active cells that it goes through, in its order; those that local grids refine are there too.
    pub crossings: Vec<Crossing>,
}

impl WellPath {
    /// The parts in cells, of which those that a local grid refines are left out where it goes through that grid.
    pub fn finest_crossings(&self, grid: &Grid) -> impl Iterator<Item = &Crossing> {
        let hosts = self.crossings.iter().filter_map(|c| grid.host(c.cell));
        let mut refined: Vec<Ijk> = hosts.collect();
        refined.sort_unstable_by_key(|cell| grid.dims().cell(*cell));
        refined.dedup();
        let crossings = self.crossings.iter();
        crossings.filter(move |c| !refined.contains(&c.cell))
    }

    /// True where a name means the same well: letter case, blanks, `-` and `_` make no difference.
    pub fn is_of(&self, well: &str) -> bool {
        is_same_name(&self.name, well)
    }
}

fn is_same_name(a: &str, b: &str) -> bool {
    let plain = |c: char| match c {
        ' ' | '-' => '_',
        c => c.to_ascii_uppercase(),
    };
    a.trim().chars().map(plain).eq(b.trim().chars().map(plain))
}

#[cfg(test)]
mod tests {
    use super::is_same_name;

    #[test]
    fn names_are_the_same_whatever_parts_them() {
        assert!(is_same_name("OP_1", "op-1") && is_same_name(" A 1", "A_1 "));
        assert!(!is_same_name("OP_1", "OP1") && !is_same_name("OP_1", "OP_12"));
    }
}
