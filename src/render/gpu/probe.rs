//! Point location on the device, for many points at once.

use std::sync::Arc;

use glam::DVec3;

use super::device::Gpu;
use super::grid_upload::{Constants, GpuGrid};
use super::pipeline::Pipeline;
use crate::model::{Grid, Ijk};
use crate::render::plan::layout::{self, Found, NOT_FOUND};
use crate::render::{Located, RenderError};
use crate::scene::Interpolation;

/// Points of one submission: short enough for slow adapters.
const BATCH: usize = 16 * 1024;

/// Locates points given in grid space; `None` where a point lies in no drawn cell.
///
/// # Errors
/// When the device reports an error.
pub fn locate(
    gpu: &Gpu,
    gpu_grid: &GpuGrid,
    grid: &Grid,
    points_in_grid: &[DVec3],
    interpolation: Interpolation,
) -> Result<Vec<Option<Located>>, RenderError> {
    Probe::new(gpu, gpu_grid)?.locate(gpu, gpu_grid, grid, points_in_grid, interpolation)
}

/// The compiled shader, for those who locate points again and again.
pub struct Probe {
    pipeline: Arc<Pipeline>,
    constants: Constants,
}

impl Probe {
    /// Compiles the shader for a grid.
    ///
    /// # Errors
    /// When the driver refuses it.
    pub fn new(gpu: &Gpu, gpu_grid: &GpuGrid) -> Result<Self, RenderError> {
        let constants = gpu_grid.constants();
        Ok(Self {
            pipeline: Pipeline::variant(gpu, "probe", "main", &constants.pairs())?,
            constants,
        })
    }

    /// True where it was compiled for a grid like this one.
    pub fn fits(&self, gpu_grid: &GpuGrid) -> bool {
        self.constants == gpu_grid.constants()
    }

    /// Locates points given in grid space; `None` where a point lies in no drawn cell.
    ///
    /// # Errors
    /// When the device reports an error.
    pub fn locate(
        &self,
        gpu: &Gpu,
        gpu_grid: &GpuGrid,
        grid: &Grid,
        points_in_grid: &[DVec3],
        interpolation: Interpolation,
    ) -> Result<Vec<Option<Located>>, RenderError> {
        let grid_group = gpu_grid.bind(gpu);
        let mut located = Vec::with_capacity(points_in_grid.len());
        for batch in points_in_grid.chunks(BATCH) {
            let points: Vec<[[f32; 4]; 2]> = batch
                .iter()
                .map(|&p| split(p - gpu_grid.facts.origin))
                .collect();
            let interpolation = layout::interpolation(interpolation);
            let info = gpu.uniform("points", &[interpolation, batch.len() as u32, 0, 0]);
            let points = gpu.storage("points", &points)?;
            let bytes = (batch.len() * size_of::<Found>()) as u64;
            let found = gpu.scratch("found", bytes);
            let own_group = gpu.bind(
                &self.pipeline.own,
                &[
                    info.as_entire_binding(),
                    points.as_entire_binding(),
                    found.as_entire_binding(),
                ],
            );
            let mut encoder = gpu
                .device
                .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let groups = [(1, &grid_group), (3, &own_group)];
            self.pipeline
                .dispatch(&mut encoder, &groups, [batch.len() as u32, 1, 1]);
            gpu.queue.submit([encoder.finish()]);
            let found: Vec<Found> = bytemuck::pod_collect_to_vec(&gpu.read(&found, bytes)?);
            located.extend(found.iter().map(|f| from_device(f, grid)));
        }
        Ok(located)
    }
}

/// A point as f32, and what rounding cut off.
fn split(point: DVec3) -> [[f32; 4]; 2] {
    let high = point.as_vec3();
    let low = (point - high.as_dvec3()).as_vec3();
    [high.extend(0.0).to_array(), low.extend(0.0).to_array()]
}

fn from_device(found: &Found, grid: &Grid) -> Option<Located> {
    (found.column != NOT_FOUND).then(|| Located {
        ijk: Ijk {
            i: found.column as usize % grid.dims().ni,
            j: found.column as usize / grid.dims().ni,
            k: found.layer as usize,
        },
        parameters: glam::Vec3::from_array(found.parameters).as_dvec3(),
        value: f64::from(found.value),
    })
}
