//! The compact corner-point grid with what is shown of it: the only place that indexes its arrays.
//! The twin of `shaders/shared/grid.wgsl`.
//!
//! Depths and positions are grid space relative to the model's origin, depth positive down.

use glam::{Vec2, Vec4};

use super::each::Each;
use crate::model::{Grid as Model, topology};
use crate::render::plan::columns::COLUMN_MARGINS;
use crate::render::plan::layout::{COLUMN_FLAG, LIST_GAPPED};
use crate::render::plan::visible::HeldCells;
use crate::render::plan::{CompactGrid, Values, drawn_words, ghost_words, list_entry};
use crate::render::{DeviceBytes, RenderError, StorageError};
use crate::scene::{Interpolation, Storage};
use crate::view::{ShownCells, View};

/// Corners closer than this along their pillar coincide.
pub const COINCIDENT: f32 = topology::COINCIDENT as f32;

/// A grid in memory, with the field and selection that are shown now.
pub struct Grid {
    /// The geometry.
    pub compact: CompactGrid,
    /// How values vary inside a cell.
    pub interpolation: Interpolation,
    drawn_cells: Vec<[u32; 2]>,
    values: Values,
    /// Bits of the cells that are ghosts, where they are shown.
    ghost_cells: Option<Vec<u32>>,
}

/// A coordinate line.
#[derive(Clone, Copy)]
pub struct Pillar {
    /// Where it is at depth 0.
    pub at: Vec2,
    /// What rounding cut off there.
    pub low_bits: Vec2,
    /// Its change per unit of depth.
    pub slope: Vec2,
}

impl Grid {
    /// Brings the case's grid into compact form, with nothing shown of it.
    ///
    /// # Errors
    /// When it cannot be numbered.
    pub fn new(model: &Model, storage: Storage) -> Result<Self, RenderError> {
        Ok(Self {
            compact: CompactGrid::new(model, storage)?,
            interpolation: Interpolation::Cell,
            drawn_cells: drawn_words(model, &[]),
            values: Values::default(),
            ghost_cells: None,
        })
    }

    /// Brings the grid that rays pass in a view of the case's grid `model` into compact form: with its inactive cells
    /// as ghosts, or without.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of(model: &Model, view: &View) -> Result<Self, RenderError> {
        let cells = &view.shown.cells;
        let (grid, _) = cells.in_grid(model);
        Ok(Self {
            ghost_cells: ghost_words(model, cells),
            ..Self::new(grid, view.sampling.storage)?
        })
    }

    /// Takes the drawn cells and their values; `model` is the case's grid.
    pub fn show(&mut self, model: &Model, cells: &ShownCells) {
        let (grid, drawn) = cells.in_grid(model);
        self.drawn_cells = drawn_words(grid, drawn);
        self.values = Values::new(model, cells, self.compact.storage);
        self.interpolation = cells.interpolation;
    }

    /// Bytes by purpose.
    pub fn bytes(&self) -> DeviceBytes {
        let of = |words: usize| 4 * words as u64;
        let compact = &self.compact;
        DeviceBytes {
            geometry: of(6 * compact.pillars.len()
                + 4 * compact.column_lists.len()
                + compact.depths.len()
                + 2 * self.drawn_cells.len()
                + self.ghost_cells.as_ref().map_or(0, Vec::len)),
            acceleration: of(2 * compact.bins.len() + compact.bin_columns.len()),
            property: of(self.values.held.len()),
            ..DeviceBytes::default()
        }
    }

    /// What rounding has changed.
    pub fn storage_error(&self) -> StorageError {
        StorageError {
            depth: self.compact.depth_error,
            value: self.values.error,
        }
    }

    /// Layers.
    #[inline]
    pub fn nk(&self) -> u32 {
        self.compact.info.nk
    }

    /// True where inactive cells are shown.
    pub fn has_ghosts(&self) -> bool {
        self.ghost_cells.is_some()
    }

    /// The four depth lists of a column with their flags.
    #[inline]
    pub fn lists(&self, column: u32) -> [u32; 4] {
        self.compact.column_lists[column as usize]
    }

    /// A pillar by its number.
    #[inline]
    pub fn pillar(&self, number: u32) -> Pillar {
        let [at, low_bits, slope] = self.compact.pillars[number as usize].map(Vec2::from_array);
        Pillar {
            at,
            low_bits,
            slope,
        }
    }

    /// Numbers of the four pillars of a column.
    #[inline]
    pub fn pillar_index(&self, column: u32) -> [u32; 4] {
        let ni = self.compact.info.ni;
        let first = column % ni + (ni + 1) * (column / ni);
        [first, first + 1, first + ni + 1, first + ni + 2]
    }

    /// The four pillars of a column.
    #[inline]
    pub fn pillars(&self, column: u32) -> [Pillar; 4] {
        self.pillar_index(column).each(|number| self.pillar(number))
    }

    /// How far outside its column, in cell widths, a point may seem by the horizontal section.
    pub fn column_margin(lists: [u32; 4]) -> f32 {
        let bit = |n: usize| usize::from(lists[n + 1] & COLUMN_FLAG != 0) << n;
        COLUMN_MARGINS[bit(0) + bit(1) + bit(2)] as f32
    }

    #[inline]
    fn bit_of(&self, column: u32, layer: u32) -> (usize, u32) {
        let slot = column * self.nk() + layer;
        ((slot >> 5) as usize, slot & 31)
    }

    /// True where a cell is drawn.
    #[inline]
    pub fn is_drawn(&self, column: u32, layer: u32) -> bool {
        let (word, bit) = self.bit_of(column, layer);
        self.drawn_cells[word][0] >> bit & 1 == 1
    }

    /// True where rays meet a cell: where it is among those with a bit, or is drawn where no bits are given.
    #[inline]
    pub fn is_met(&self, visible: Option<&[u32]>, column: u32, layer: u32) -> bool {
        let Some(words) = visible else {
            return self.is_drawn(column, layer);
        };
        let (word, bit) = self.bit_of(column, layer);
        words[word] >> bit & 1 == 1
    }

    /// Bits of the drawn cells in which a view shows something; `None` where rays meet all drawn cells.
    pub fn visible_words(&self, view: &View) -> Option<Vec<u32>> {
        let held = HeldCells {
            nk: self.nk(),
            interpolation: self.interpolation,
            lists: &self.compact.column_lists,
            values: &self.values.held,
            drawn: &self.drawn_cells,
            ghosts: self.ghost_cells.as_deref(),
        };
        held.visible(view)
    }

    /// True where a cell is an inactive one that is shown.
    #[inline]
    pub fn is_ghost(&self, column: u32, layer: u32) -> bool {
        let (word, bit) = self.bit_of(column, layer);
        let ghosts = self.ghost_cells.as_ref();
        ghosts.is_some_and(|ghosts| ghosts[word] >> bit & 1 == 1)
    }

    /// The value of a drawn cell, where values are constant in cells.
    #[inline]
    pub fn cell_value(&self, column: u32, layer: u32) -> f32 {
        let (word, bit) = self.bit_of(column, layer);
        let [bits, before] = self.drawn_cells[word];
        let rank = before + (bits & ((1 << bit) - 1)).count_ones();
        self.values.held[rank as usize]
    }

    /// Positions in the depth lists of the four corners of a layer's top (0) or bottom (1).
    #[inline]
    pub fn layer_entries(lists: [u32; 4], layer: u32, bottom: u32) -> [u32; 4] {
        lists.each(|list| list_entry(list, layer, bottom))
    }

    /// A depth by its position in the lists.
    #[inline]
    pub fn depth(&self, entry: u32) -> f32 {
        self.compact.depths[entry as usize]
    }

    /// Depths of the four corners of a layer's top (0) or bottom (1).
    #[inline]
    pub fn layer_depths(&self, lists: [u32; 4], layer: u32, bottom: u32) -> Vec4 {
        self.depths_at(Self::layer_entries(lists, layer, bottom))
    }

    /// True where a layer lies on the next one below, without a gap.
    #[inline]
    pub fn layers_join(&self, lists: [u32; 4], upper: u32) -> bool {
        let gapped = (lists[0] | lists[1] | lists[2] | lists[3]) & LIST_GAPPED;
        let depths = |layer, bottom| self.layer_depths(lists, layer, bottom);
        gapped == 0 || all_coincide(depths(upper, 1), depths(upper + 1, 0))
    }

    /// Four depths.
    #[inline]
    pub fn depths_at(&self, entries: [u32; 4]) -> Vec4 {
        Vec4::from_array(entries.each(|entry| self.depth(entry)))
    }

    /// Values at the corners of a cell's top, and of its bottom.
    #[inline]
    pub fn corner_values(&self, column: u32, layer: u32) -> [Vec4; 2] {
        match self.interpolation {
            Interpolation::Cell => [Vec4::splat(self.cell_value(column, layer)); 2],
            Interpolation::Vertex => of_cell(&self.values.held, self.lists(column), layer),
        }
    }

    /// Depths at the corners of a cell's top, and of its bottom.
    #[inline]
    pub fn corner_depths(&self, lists: [u32; 4], layer: u32) -> [Vec4; 2] {
        of_cell(&self.compact.depths, lists, layer)
    }
}

/// Entries of depth lists, or of what is numbered as they are, at the corners of a cell's top, and of its bottom.
#[inline]
fn of_cell(entries: &[f32], lists: [u32; 4], layer: u32) -> [Vec4; 2] {
    // The two of a pillar follow each other.
    let pairs = lists.each(|list| {
        let top = list_entry(list, layer, 0) as usize;
        let pair = &entries[top..top + 2];
        [pair[0], pair[1]]
    });
    [0, 1].each(|bottom| Vec4::from_array(pairs.each(|pair| pair[bottom])))
}

/// True where corners lie on each other.
#[inline]
pub fn all_coincide(a: Vec4, b: Vec4) -> bool {
    (a - b).abs().cmple(Vec4::splat(COINCIDENT)).all()
}
