//! A column of cells with its pillars and depth lists at hand, for work that goes down all of its cells.

use glam::{DVec2, DVec3};

use super::activity::layers;
use super::corner_point::{Hexahedron, NO_THICKNESS};

/// A column of cells.
#[derive(Debug, Clone, Copy)]
pub struct Column<'a> {
    /// Along i.
    pub i: usize,
    /// Along j.
    pub j: usize,
    /// Depth grows with the layer, or stays, on all pillars.
    pub is_sorted: bool,
    pub(super) active: &'a [u64],
    pub(super) corners: [Corner<'a>; 4],
}

/// The pillar and the depths of a corner.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner<'a> {
    /// Upper end of the pillar.
    pub top: DVec3,
    pub slope: DVec2,
    /// The list of depths.
    pub depths: &'a [f64],
    /// Entries from one layer to the next.
    pub step: usize,
}

impl Corner<'_> {
    fn at(&self, depth: f64) -> DVec3 {
        (self.top.truncate() + self.slope * (depth - self.top.z)).extend(depth)
    }
}

impl Column<'_> {
    /// The layers with an active cell, downward.
    pub fn active(&self) -> impl Iterator<Item = usize> + '_ {
        layers(self.active)
    }

    /// Depth of corner `corner` (`di + 2 dj + 4 dk`) of the cell of a layer.
    pub fn depth(&self, k: usize, corner: usize) -> f64 {
        let list = &self.corners[corner & 3];
        list.depths[list.step * k + (corner >> 2)]
    }

    /// The hexahedron of the cell of a layer in grid space.
    pub fn hexahedron(&self, k: usize) -> Hexahedron {
        let corner = |c: usize| self.corners[c & 3].at(self.depth(k, c));
        Hexahedron(std::array::from_fn(corner))
    }

    /// True when at least one of a cell's four edges along the pillars has a length.
    pub fn has_thickness(&self, k: usize) -> bool {
        (0..4).any(|c| (self.depth(k, c + 4) - self.depth(k, c)).abs() > NO_THICKNESS)
    }

    /// Mean length of a cell's four edges along the pillars, measured vertically.
    pub fn thickness(&self, k: usize) -> f64 {
        let edge = |c: usize| self.depth(k, c + 4) - self.depth(k, c);
        (0..4).map(edge).sum::<f64>() / 4.0
    }

    /// Slopes of the four pillars, by corner.
    pub fn slopes(&self) -> [DVec2; 4] {
        self.corners.map(|c| c.slope)
    }

    /// The highest and the lowest corner of some layers' cells on each pillar, between which all of their others lie;
    /// `None` without layers.
    pub fn ends(&self, layers: impl IntoIterator<Item = usize>) -> Option<[[DVec3; 2]; 4]> {
        let mut layers = layers.into_iter();
        let first = layers.next()?;
        let mut depths = [[f64::INFINITY, f64::NEG_INFINITY]; 4];
        let mut add = |k: usize| {
            for corner in 0..8 {
                let [high, low] = &mut depths[corner & 3];
                let depth = self.depth(k, corner);
                (*high, *low) = (high.min(depth), low.max(depth));
            }
        };
        add(first);
        match self.is_sorted {
            true => layers.last().into_iter().for_each(add),
            false => layers.for_each(add),
        }
        let ends = |c: usize| depths[c].map(|depth| self.corners[c].at(depth));
        Some(std::array::from_fn(ends))
    }
}
