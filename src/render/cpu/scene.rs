//! What all rays of a frame read.

use glam::Vec4;

use super::cube::Cube;
use super::frame::Frame;
use super::grid::Grid;
use super::shading::Shading;
use super::transfer::Transfer;
use crate::scene::Interpolation;
use crate::view::Surfaces;

/// What all rays of a frame read.
pub struct Scene<'a> {
    /// Camera and lattice.
    pub frame: Frame,
    /// The grid with what is shown of it.
    pub grid: &'a Grid,
    /// Bits of the cells that rays meet, by slot; `None` where these are all drawn cells.
    pub visible: Option<&'a [u32]>,
    /// Colors and extinctions.
    pub transfer: Transfer<'a>,
    /// Color and extinction of inactive cells.
    pub ghost: Vec4,
    /// Light.
    pub shading: Shading<'a>,
    /// Which surfaces are shown.
    pub surfaces: Surfaces,
    /// What is shown beside the model.
    pub cube: Option<Cube<'a>>,
}

impl Scene<'_> {
    /// Color and extinction of a cell, where they are the same all over it.
    #[inline]
    pub fn entry_of(&self, column: u32, layer: u32) -> Option<Vec4> {
        match self.grid.interpolation {
            _ if self.grid.is_ghost(column, layer) => Some(self.ghost),
            Interpolation::Cell => Some(self.transfer.of(self.grid.cell_value(column, layer))),
            Interpolation::Vertex => None,
        }
    }

    /// True where rays meet a cell.
    #[inline]
    pub fn is_met(&self, column: u32, layer: u32) -> bool {
        self.grid.is_met(self.visible, column, layer)
    }
}
