//! The compact grid on the device: pillars, shared depth lists, drawn cells, values, bins.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::accel::AccelGrid;
use super::columns::{self, ColumnShape};
use super::device::Gpu;
use super::layout::{COLUMN_FLAG, GridInfo, LIST_GAPPED, LIST_OFFSET};
use super::pipeline::flag;
use crate::model::{Grid, Ijk, VertexField};
use crate::render::revisions::Revisions;
use crate::render::{DeviceBytes, RenderError};
use crate::scene::Interpolation;
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
    /// Origin of the device's coordinates in grid space.
    pub origin: DVec3,
    /// Box of the active cells relative to the origin.
    pub bounds: [DVec3; 2],
    /// True where all pillars are vertical, so that points are located in closed form.
    pub vertical: bool,
    /// True where the layers of some column cross, so that cells may overlap.
    pub layers_cross: bool,
    /// +1 where the cells are right-handed in grid space, else -1.
    pub handedness: f32,
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
        let bounds = grid.bounds().unwrap_or([DVec3::ZERO, DVec3::ONE]);
        let origin = round_origin(bounds);
        let start = std::time::Instant::now();
        let shapes = columns::shapes(grid);
        let accel = AccelGrid::new(grid, &shapes, origin);
        let acceleration_time = start.elapsed();
        let dims = grid.dims();
        if grid.depths().len() > LIST_OFFSET as usize {
            return Err(RenderError::TooLarge {
                what: "depth lists",
                needed: 4 * grid.depths().len() as u64,
                limit: 4 * u64::from(LIST_OFFSET),
            });
        }
        let info = GridInfo {
            ni: dims.ni as u32,
            nj: dims.nj as u32,
            nk: dims.nk as u32,
            bins_x: accel.size[0],
            bins_y: accel.size[1],
            reserved: 0,
            bin_origin: accel.origin.as_vec2().to_array(),
            bin_size: accel.bin.as_vec2().to_array(),
            depth_low: accel.depth[0] as f32,
            depth_scale: accel.depth[1] as f32,
        };
        let pillars: Vec<[[f32; 2]; 3]> = grid
            .pillars()
            .iter()
            .map(|p| {
                let at = (p.at(origin.z) - origin).truncate();
                let low_bits = at - at.as_vec2().as_dvec2();
                [at, low_bits, p.slope()].map(|v| v.as_vec2().to_array())
            })
            .collect();
        let depths: Vec<f32> = grid
            .depths()
            .par_iter()
            .map(|d| (d - origin.z) as f32)
            .collect();
        let lists = column_lists(grid, &shapes);
        Ok(Self {
            origin,
            bounds: bounds.map(|b| b - origin),
            vertical: grid.pillars().iter().all(|p| p.slope() == DVec2::ZERO),
            layers_cross: shapes.iter().any(|s| s.layers_cross),
            handedness: if grid.signed_bulk_volume() < 0.0 {
                -1.0
            } else {
                1.0
            },
            acceleration_time,
            revisions: Revisions::default(),
            drawn_words: Vec::new(),
            info: gpu.uniform("grid info", &info),
            pillars: gpu.storage("pillars", &pillars)?,
            column_lists: gpu.storage("column lists", &lists)?,
            depths: gpu.storage("depth lists", &depths)?,
            bins: gpu.storage("acceleration bins", &accel.bins)?,
            bin_columns: gpu.storage("acceleration columns", &accel.columns)?,
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
        if cells.ghosts.is_some() {
            let cells = grid.active_cells().iter();
            let is_ghost: Vec<bool> = cells.map(|c| model.active_index(*c).is_none()).collect();
            let words = drawn_words(grid, &is_ghost);
            let bits: Vec<u32> = words.iter().map(|w| w[0]).collect();
            made.ghost_cells = Some(gpu.storage("ghost cells", &bits)?);
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
        let values = match cells.interpolation {
            Interpolation::Cell => column_major(model, cells),
            // Entries that no drawn cell touches are never read; NaN stays off the device.
            Interpolation::Vertex => {
                VertexField::of(model, &cells.field, cells.valued()).into_defined()
            }
        };
        self.values = gpu.storage("values", &values)?;
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
            vertical: self.vertical,
            ghosts: self.ghost_cells.is_some(),
        }
    }

    /// Empties the bins of the lower half of x, so that tests have a grid in which points are lost.
    #[cfg(test)]
    pub(crate) fn lose_half(&mut self, gpu: &Gpu, grid: &Grid) -> Result<(), RenderError> {
        let mut accel = AccelGrid::new(grid, &columns::shapes(grid), self.origin);
        for row in accel.bins.chunks_exact_mut(accel.size[0] as usize) {
            let half = row.len() / 2;
            let next = row[half][0];
            row[..half].iter_mut().for_each(|bin| bin[0] = next);
        }
        self.bins = gpu.storage("acceleration bins", &accel.bins)?;
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

/// The middle of the model, rounded so coarsely that coordinates that were f32 in the file stay
/// exact when it is subtracted.
fn round_origin([low, high]: [DVec3; 2]) -> DVec3 {
    let extent = (high - low).max_element().max(1e-6);
    let grain = (extent.log2().floor() - 10.0).min(0.0).exp2();
    (0.5 * (low + high) / grain).round() * grain
}

fn column_lists(grid: &Grid, shapes: &[ColumnShape]) -> Vec<[u32; 4]> {
    shapes
        .par_iter()
        .enumerate()
        .map(|(column, shape)| {
            let mut lists = grid
                .column_lists(column)
                .map(|list| list.offset() as u32 | if list.gapped() { LIST_GAPPED } else { 0 });
            if shape.layers_cross {
                lists[0] |= COLUMN_FLAG;
            }
            for bit in 0..3 {
                if shape.margin_level >> bit & 1 == 1 {
                    lists[bit + 1] |= COLUMN_FLAG;
                }
            }
            lists
        })
        .collect()
}

/// Slots column by column, layers fastest: bits of the drawn cells and the count before each word.
fn drawn_words(grid: &Grid, drawn: &[bool]) -> Vec<[u32; 2]> {
    let dims = grid.dims();
    let mut words = vec![[0u32; 2]; dims.cells().div_ceil(32)];
    for (&cell, _) in grid.active_cells().iter().zip(drawn).filter(|(_, d)| **d) {
        let ijk = dims.ijk(cell);
        let slot = (ijk.i + dims.ni * ijk.j) * dims.nk + ijk.k;
        words[slot / 32][0] |= 1 << (slot % 32);
    }
    let mut before = 0;
    for word in &mut words {
        word[1] = before;
        before += word[0].count_ones();
    }
    words
}

/// Values of the drawn cells in slot order; ghosts have none, and NaN stays off the device.
fn column_major(model: &Grid, cells: &ShownCells) -> Vec<f32> {
    let (grid, drawn) = cells.in_grid(model);
    let dims = grid.dims();
    let mut values = Vec::new();
    for column in 0..dims.columns() {
        for k in 0..dims.nk {
            let ijk = Ijk {
                i: column % dims.ni,
                j: column / dims.ni,
                k,
            };
            let cell = dims.cell(ijk);
            let active = grid.active_index(cell).map(|a| a.0 as usize);
            if active.is_some_and(|a| drawn.get(a) == Some(&true)) {
                values.push(cells.field.value(model, cell).unwrap_or(0.0));
            }
        }
    }
    values
}
