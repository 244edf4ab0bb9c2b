//! The compact grid on the device: pillars, shared depth lists, drawn cells, values, bins.

use super::device::Gpu;
use super::pipeline::flag;
use crate::model::Grid;
use crate::render::plan::layout::GridInfo;
use crate::render::plan::packing::packed;
use crate::render::plan::visible::HeldCells;
use crate::render::plan::{CompactGrid, GridFacts, Values, cell_bits, drawn_words, ghost_words};
use crate::render::revisions::Revisions;
use crate::render::{DeviceBytes, RenderError, StorageError};
use crate::scene::{Interpolation, Storage};
use crate::view::{ShownCells, View};

/// What is constant in shaders that locate points in a grid.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Constants {
    /// All pillars are vertical.
    pub vertical: bool,
    /// Inactive cells are shown.
    pub ghosts: bool,
    /// How depths and values are held.
    pub storage: Storage,
}

impl Constants {
    /// Names and values of the shaders' `override` constants.
    pub fn pairs(self) -> [(&'static str, f64); 3] {
        [
            ("VERTICAL", flag(self.vertical)),
            ("GHOSTS", flag(self.ghosts)),
            self.storage(),
        ]
    }

    /// Of these the one of shaders that read depths or values.
    pub fn storage(self) -> (&'static str, f64) {
        ("PACKED_GRID", flag(self.storage == Storage::Compact))
    }
}

/// A grid on the device, with the field and selection that are shown now.
pub struct GpuGrid {
    /// What is true of it as a whole.
    pub facts: GridFacts,
    /// Time that building the acceleration grid took.
    pub acceleration_time: std::time::Duration,
    /// Those of what is on the device.
    pub revisions: Revisions,
    /// Sizes of it and of its acceleration grid.
    pub sizes: GridInfo,
    info: wgpu::Buffer,
    /// Pillars, columns and bins.
    words: wgpu::Buffer,
    /// Of these, bytes of the bins.
    bin_bytes: u64,
    depths: wgpu::Buffer,
    cell_bits: wgpu::Buffer,
    /// Where the bits of the cells that rays meet begin there, 0 where there are none.
    visible: u32,
    /// The drawn cells in `cell_bits`.
    drawn_words: Vec<[u32; 2]>,
    values: wgpu::Buffer,
    /// Depth lists of the columns, values and how they vary in a cell, as they are on the device.
    column_lists: Vec<[u32; 4]>,
    held_values: Values,
    storage: Storage,
    depth_error: f64,
    interpolation: Interpolation,
    /// Bits of the cells that are ghosts, where they are shown.
    ghost_words: Option<Vec<u32>>,
}

impl GpuGrid {
    /// Uploads geometry and acceleration grid; [`Self::show`] adds values.
    ///
    /// # Errors
    /// When an array exceeds what the adapter holds.
    pub fn new(gpu: &Gpu, grid: &Grid) -> Result<Self, RenderError> {
        Self::stored(gpu, grid, Storage::Exact)
    }

    /// As [`Self::new`], held in one way or the other.
    ///
    /// # Errors
    /// As there.
    pub fn stored(gpu: &Gpu, grid: &Grid, storage: Storage) -> Result<Self, RenderError> {
        let compact = CompactGrid::new(grid, storage)?;
        let words = compact.words();
        Ok(Self {
            facts: compact.facts,
            acceleration_time: compact.acceleration_time,
            revisions: Revisions::default(),
            drawn_words: Vec::new(),
            sizes: compact.info,
            info: gpu.uniform("grid info", &compact.info),
            words: gpu.storage("pillars, columns and bins", &words)?,
            bin_bytes: size_of_val(&words[compact.info.bins as usize..]) as u64,
            depths: numbers(gpu, "depth lists", &compact.depths, storage)?,
            cell_bits: gpu.storage("drawn cells", &drawn_words(grid, &[]))?,
            visible: 0,
            values: gpu.storage::<f32>("values", &[])?,
            column_lists: compact.column_lists,
            held_values: Values::default(),
            storage,
            depth_error: compact.depth_error,
            interpolation: Interpolation::Cell,
            ghost_words: None,
        })
    }

    /// Uploads the grid that rays pass in a view of the case's grid `model`: with its inactive cells as ghosts, or
    /// without.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of(gpu: &Gpu, model: &Grid, view: &View) -> Result<Self, RenderError> {
        let cells = &view.shown.cells;
        let (grid, _) = cells.in_grid(model);
        Ok(Self {
            ghost_words: ghost_words(model, cells),
            ..Self::stored(gpu, grid, view.sampling.storage)?
        })
    }

    /// Puts the drawn cells and their values on the device; `model` is the case's grid.
    ///
    /// # Errors
    /// When the values exceed what the adapter holds.
    pub fn show(&mut self, gpu: &Gpu, model: &Grid, cells: &ShownCells) -> Result<(), RenderError> {
        let (grid, drawn) = cells.in_grid(model);
        let words = drawn_words(grid, drawn);
        if words != self.drawn_words {
            self.drawn_words = words;
            self.meet(gpu, None)?;
        }
        self.held_values = Values::new(model, cells, self.storage);
        self.values = numbers(gpu, "values", &self.held_values.held, self.storage)?;
        self.interpolation = cells.interpolation;
        Ok(())
    }

    /// Puts the cells that rays meet on the device, by their bits; all drawn cells where there are none.
    ///
    /// # Errors
    /// When the bits exceed what the adapter holds.
    pub fn meet(&mut self, gpu: &Gpu, visible: Option<&[u32]>) -> Result<(), RenderError> {
        let ghosts = self.ghost_words.as_deref();
        let bits = cell_bits(&self.drawn_words, ghosts, visible);
        self.cell_bits = gpu.storage("drawn cells", &bits)?;
        let before = self.drawn_words.len() + ghosts.map_or(0, |words| words.len().div_ceil(2));
        self.visible = visible.map_or(0, |_| before as u32);
        Ok(())
    }

    /// Says whether rays meet all drawn cells from now on, or those that were put there last, if any were.
    pub fn meet_all(&mut self, gpu: &Gpu, all: bool) {
        self.sizes.visible = if all { 0 } else { self.visible };
        let info = bytemuck::bytes_of(&self.sizes);
        gpu.queue.write_buffer(&self.info, 0, info);
    }

    /// Bits of the drawn cells in which a view shows something; `None` where rays meet all drawn cells.
    pub fn visible_words(&self, view: &View) -> Option<Vec<u32>> {
        let held = HeldCells {
            nk: self.sizes.nk,
            interpolation: self.interpolation,
            lists: &self.column_lists,
            values: &self.held_values.held,
            drawn: &self.drawn_words,
            ghosts: self.ghost_words.as_deref(),
        };
        held.visible(view)
    }

    /// The bind group of the grid.
    pub fn bind(&self, gpu: &Gpu) -> wgpu::BindGroup {
        let buffers = [
            &self.info,
            &self.words,
            &self.depths,
            &self.cell_bits,
            &self.values,
        ];
        let resources = buffers.map(wgpu::Buffer::as_entire_binding);
        gpu.bind(gpu.layouts.group(1), &resources)
    }

    /// Values of the constants of shaders that locate points.
    pub fn constants(&self) -> Constants {
        Constants {
            vertical: self.facts.vertical,
            ghosts: self.ghost_words.is_some(),
            storage: self.storage,
        }
    }

    /// What rounding has changed.
    pub fn storage_error(&self) -> StorageError {
        StorageError {
            depth: self.depth_error,
            value: self.held_values.error,
        }
    }

    /// Empties the bins of the lower half of x, so that tests have a grid in which points are lost.
    #[cfg(test)]
    pub(crate) fn lose_half(&mut self, gpu: &Gpu, grid: &Grid) -> Result<(), RenderError> {
        let mut compact = CompactGrid::new(grid, self.storage)?;
        compact.lose_half();
        self.words = gpu.storage("pillars, columns and bins", &compact.words())?;
        Ok(())
    }

    /// Bytes by purpose.
    pub fn bytes(&self) -> DeviceBytes {
        let sum = |buffers: &[&wgpu::Buffer]| buffers.iter().map(|b| b.size()).sum();
        DeviceBytes {
            geometry: sum(&[&self.info, &self.words, &self.depths, &self.cell_bits])
                - self.bin_bytes,
            acceleration: self.bin_bytes,
            property: sum(&[&self.values]),
            ..DeviceBytes::default()
        }
    }
}

/// A buffer of depths or values.
fn numbers(
    gpu: &Gpu,
    what: &'static str,
    content: &[f32],
    storage: Storage,
) -> Result<wgpu::Buffer, RenderError> {
    match storage {
        Storage::Exact => gpu.storage(what, content),
        Storage::Compact => gpu.storage(what, &packed(content)),
    }
}
