//! The compact grid on the device: pillars, shared depth lists, drawn cells, values, bins.

use super::device::Gpu;
use super::pipeline::flag;
use crate::model::Grid;
use crate::render::plan::{CompactGrid, GridFacts, drawn_words, ghost_words, values};
use crate::render::revisions::Revisions;
use crate::render::{DeviceBytes, RenderError};
use crate::view::ShownCells;

/// What is constant in shaders that locate points in a grid.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Constants {
    /// All pillars are vertical.
    pub vertical: bool,
    /// Inactive cells are shown.
    pub ghosts: bool,
}

impl Constants {
    /// Names and values of the shaders' `override` constants.
    pub fn pairs(self) -> [(&'static str, f64); 2] {
        [
            ("VERTICAL", flag(self.vertical)),
            ("GHOSTS", flag(self.ghosts)),
        ]
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
    info: wgpu::Buffer,
    pillars: wgpu::Buffer,
    column_lists: wgpu::Buffer,
    depths: wgpu::Buffer,
    bins: wgpu::Buffer,
    bin_columns: wgpu::Buffer,
    drawn_cells: wgpu::Buffer,
    /// What `drawn_cells` holds.
    drawn_words: Vec<[u32; 2]>,
    values: wgpu::Buffer,
    /// Bits of the cells that are ghosts, where they are shown.
    ghost_cells: Option<wgpu::Buffer>,
    /// What is bound where they are not.
    no_ghosts: wgpu::Buffer,
}

impl GpuGrid {
    /// Uploads geometry and acceleration grid; [`Self::show`] adds values.
    ///
    /// # Errors
    /// When an array exceeds what the adapter holds.
    pub fn new(gpu: &Gpu, grid: &Grid) -> Result<Self, RenderError> {
        let compact = CompactGrid::new(grid)?;
        Ok(Self {
            facts: compact.facts,
            acceleration_time: compact.acceleration_time,
            revisions: Revisions::default(),
            drawn_words: Vec::new(),
            info: gpu.uniform("grid info", &compact.info),
            pillars: gpu.storage("pillars", &compact.pillars)?,
            column_lists: gpu.storage("column lists", &compact.column_lists)?,
            depths: gpu.storage("depth lists", &compact.depths)?,
            bins: gpu.storage("acceleration bins", &compact.bins)?,
            bin_columns: gpu.storage("acceleration columns", &compact.bin_columns)?,
            drawn_cells: gpu.storage("drawn cells", &drawn_words(grid, &[]))?,
            values: gpu.storage::<f32>("values", &[])?,
            ghost_cells: None,
            no_ghosts: gpu.storage::<u32>("ghost cells", &[])?,
        })
    }

    /// Uploads the grid that rays pass in a view of the case's grid `model`: with its inactive cells as ghosts, or
    /// without.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of(gpu: &Gpu, model: &Grid, cells: &ShownCells) -> Result<Self, RenderError> {
        let (grid, _) = cells.in_grid(model);
        let mut made = Self::new(gpu, grid)?;
        if let Some(words) = ghost_words(model, cells) {
            made.ghost_cells = Some(gpu.storage("ghost cells", &words)?);
        }
        Ok(made)
    }

    /// Puts the drawn cells and their values on the device; `model` is the case's grid.
    ///
    /// # Errors
    /// When the values exceed what the adapter holds.
    pub fn show(&mut self, gpu: &Gpu, model: &Grid, cells: &ShownCells) -> Result<(), RenderError> {
        let (grid, drawn) = cells.in_grid(model);
        let words = drawn_words(grid, drawn);
        if words != self.drawn_words {
            self.drawn_cells = gpu.storage("drawn cells", &words)?;
            self.drawn_words = words;
        }
        self.values = gpu.storage("values", &values(model, cells))?;
        Ok(())
    }

    /// The bind group of the grid.
    pub fn bind(&self, gpu: &Gpu) -> wgpu::BindGroup {
        let buffers = [
            &self.info,
            &self.pillars,
            &self.column_lists,
            &self.depths,
            &self.drawn_cells,
            &self.values,
            &self.bins,
            &self.bin_columns,
            self.ghost_cells.as_ref().unwrap_or(&self.no_ghosts),
        ];
        let resources = buffers.map(wgpu::Buffer::as_entire_binding);
        gpu.bind(gpu.layouts.group(1), &resources)
    }

    /// Values of the constants of shaders that locate points.
    pub fn constants(&self) -> Constants {
        Constants {
            vertical: self.facts.vertical,
            ghosts: self.ghost_cells.is_some(),
        }
    }

    /// Empties the bins of the lower half of x, so that tests have a grid in which points are lost.
    #[cfg(test)]
    pub(crate) fn lose_half(&mut self, gpu: &Gpu, grid: &Grid) -> Result<(), RenderError> {
        let mut compact = CompactGrid::new(grid)?;
        compact.lose_half();
        self.bins = gpu.storage("acceleration bins", &compact.bins)?;
        Ok(())
    }

    /// Bytes by purpose.
    pub fn bytes(&self) -> DeviceBytes {
        let sum = |buffers: &[&wgpu::Buffer]| buffers.iter().map(|b| b.size()).sum();
        DeviceBytes {
            geometry: sum(&[
                &self.info,
                &self.pillars,
                &self.column_lists,
                &self.depths,
                &self.drawn_cells,
            ]) + self.ghost_cells.as_ref().map_or(0, wgpu::Buffer::size),
            acceleration: sum(&[&self.bins, &self.bin_columns]),
            property: sum(&[&self.values]),
            ..DeviceBytes::default()
        }
    }
}
