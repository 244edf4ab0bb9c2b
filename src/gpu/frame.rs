//! One frame: uniforms, transfer table, tiles, readback, statistics.

use std::time::{Duration, Instant};

use glam::DVec3;

use super::device::{Gpu, GpuError};
use super::grid_upload::GpuGrid;
use super::layout::{Frame, INTERPOLATION_CELL, INTERPOLATION_VERTEX, LUT_SIZE, Tile};
use super::tiles::{Rect, Tiles};
use crate::picture::Image;
use crate::scene::{Interpolation, View};
use crate::strategies::RenderStrategy;
use crate::transfer::TransferFunction;

/// What a frame cost.
#[derive(Debug, Clone, Copy, Default)]
pub struct FrameStats {
    /// Time of the rays: by the adapter's clock where it has one, else by the host's.
    pub frame: Duration,
    /// Wall time of the frame with readback.
    pub wall: Duration,
    /// Longest single submission.
    pub longest_submission: Duration,
    /// Lattice samples inside drawn cells.
    pub samples: u64,
    /// Newton iterations.
    pub newton_iterations: u64,
    /// Steps from a cell to its neighbor.
    pub topological_steps: u64,
    /// Point locations through the acceleration grid.
    pub grid_fallbacks: u64,
    /// Bytes of the picture on the device.
    pub target_bytes: u64,
}

/// Makes frames with one strategy.
#[derive(Default)]
pub struct FrameRenderer {
    tiles: Tiles,
}

/// Objects of one frame.
struct Bound<'a> {
    gpu: &'a Gpu,
    groups: [wgpu::BindGroup; 3],
    tile: wgpu::Buffer,
    queries: Option<(wgpu::QuerySet, wgpu::Buffer, wgpu::Buffer)>,
}

impl FrameRenderer {
    /// Renders a view; `None` where `progress` cancelled it.
    ///
    /// # Errors
    /// When the picture is too large for the adapter or the device reports an error.
    pub fn render(
        &mut self,
        gpu: &Gpu,
        grid: &GpuGrid,
        strategy: &dyn RenderStrategy,
        view: &View,
        progress: &dyn Fn(f64) -> bool,
    ) -> Result<Option<(Image, FrameStats)>, GpuError> {
        let start = Instant::now();
        let limit = gpu.device.limits().max_texture_dimension_2d;
        if view.size.iter().any(|&n| n > limit) {
            return Err(GpuError::Unsuitable {
                adapter: gpu.info.name.clone(),
                reason: format!("pictures are limited to {limit} pixels each way"),
            });
        }
        let pipeline = &strategy.pipeline().pipeline;
        let target = create_target(gpu, view.size);
        let counters = gpu.storage("counters", &[0u32; 8])?;
        let counters = copyable(gpu, &counters);
        let table = gpu.storage("transfer table", &transfer_table(&view.transfer))?;
        let frame = gpu.uniform("frame", &frame_uniform(grid, view));
        let tile = gpu.uniform(
            "tile",
            &Tile {
                origin: [0; 2],
                size: [0; 2],
            },
        );
        let texture = target.create_view(&wgpu::TextureViewDescriptor::default());
        let bound = Bound {
            gpu,
            groups: [
                gpu.bind(
                    pipeline,
                    0,
                    &[
                        frame.as_entire_binding(),
                        tile.as_entire_binding(),
                        wgpu::BindingResource::TextureView(&texture),
                        counters.as_entire_binding(),
                    ],
                ),
                grid.bind(gpu, pipeline),
                gpu.bind(pipeline, 2, &[table.as_entire_binding()]),
            ],
            tile,
            queries: queries(gpu),
        };
        let mut stats = FrameStats {
            target_bytes: 16 * u64::from(view.size[0]) * u64::from(view.size[1]),
            ..FrameStats::default()
        };
        let draw = |rect| bound.draw(strategy, rect, &mut stats);
        if !self.tiles.cover(view.size, draw, progress)? {
            return Ok(None);
        }
        let pixels = read_target(gpu, &target, view.size)?;
        let counts: Vec<u32> = bytemuck::pod_collect_to_vec(&gpu.read(&counters, 32)?);
        let count = |n: usize| u64::from(counts[2 * n]) | u64::from(counts[2 * n + 1]) << 32;
        stats.samples = count(0);
        stats.newton_iterations = count(1);
        stats.topological_steps = count(2);
        stats.grid_fallbacks = count(3);
        stats.wall = start.elapsed();
        Ok(Some((
            Image {
                size: view.size,
                pixels,
            },
            stats,
        )))
    }
}

impl Bound<'_> {
    /// Submits one tile and waits for it.
    fn draw(
        &self,
        strategy: &dyn RenderStrategy,
        rect: Rect,
        stats: &mut FrameStats,
    ) -> Result<Duration, GpuError> {
        let Self {
            gpu,
            groups,
            tile,
            queries,
        } = self;
        let uniform = Tile {
            origin: rect.origin,
            size: rect.size,
        };
        gpu.queue
            .write_buffer(tile, 0, bytemuck::bytes_of(&uniform));
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let timestamp_writes =
                queries
                    .as_ref()
                    .map(|(set, ..)| wgpu::ComputePassTimestampWrites {
                        query_set: set,
                        beginning_of_pass_write_index: Some(0),
                        end_of_pass_write_index: Some(1),
                    });
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("tile"),
                timestamp_writes,
            });
            for (n, group) in (0..).zip(groups) {
                pass.set_bind_group(n, group, &[]);
            }
            strategy.encode(&mut pass, rect.size);
        }
        if let Some((set, resolve, staging)) = queries {
            encoder.resolve_query_set(set, 0..2, resolve, 0);
            encoder.copy_buffer_to_buffer(resolve, 0, staging, 0, 16);
        }
        let start = Instant::now();
        gpu.queue.submit([encoder.finish()]);
        let by_adapter = match (queries, gpu.timestamp_period_ns) {
            (Some((_, _, staging)), Some(period)) => {
                let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(&gpu.map(staging)?);
                let ns = ticks[1].saturating_sub(ticks[0]) as f64 * f64::from(period);
                Some(Duration::from_nanos(ns as u64))
            }
            _ => {
                gpu.wait()?;
                None
            }
        };
        let wall = start.elapsed();
        stats.frame += by_adapter
            .filter(|t| !t.is_zero() && *t < wall)
            .unwrap_or(wall);
        stats.longest_submission = stats.longest_submission.max(wall);
        Ok(wall)
    }
}

fn queries(gpu: &Gpu) -> Option<(wgpu::QuerySet, wgpu::Buffer, wgpu::Buffer)> {
    gpu.timestamp_period_ns?;
    let set = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
        label: Some("tile times"),
        ty: wgpu::QueryType::Timestamp,
        count: 2,
    });
    let resolve = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("tile times"),
        size: 16,
        usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    Some((set, resolve, gpu.staging(16)))
}

/// A zeroed copy of a storage buffer that can also be read back.
fn copyable(gpu: &Gpu, like: &wgpu::Buffer) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("counters"),
        size: like.size(),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    })
}

fn create_target(gpu: &Gpu, [width, height]: [u32; 2]) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("target"),
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

/// Copies the picture back in bands, so that the staging buffer stays small.
fn read_target(
    gpu: &Gpu,
    target: &wgpu::Texture,
    [width, height]: [u32; 2],
) -> Result<Vec<[f32; 4]>, GpuError> {
    const BAND_BYTES: u32 = 32 << 20;
    let row = (16 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let rows = (BAND_BYTES / row).clamp(1, height);
    let staging = gpu.staging(u64::from(row) * u64::from(rows));
    let mut pixels = Vec::with_capacity(width as usize * height as usize);
    for y in (0..height).step_by(rows as usize) {
        let count = rows.min(height - y);
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_texture_to_buffer(
            wgpu::TexelCopyTextureInfo {
                origin: wgpu::Origin3d { x: 0, y, z: 0 },
                ..target.as_image_copy()
            },
            wgpu::TexelCopyBufferInfo {
                buffer: &staging,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row),
                    rows_per_image: Some(count),
                },
            },
            wgpu::Extent3d {
                width,
                height: count,
                depth_or_array_layers: 1,
            },
        );
        gpu.queue.submit([encoder.finish()]);
        let content = gpu.map(&staging)?;
        for line in content.chunks_exact(row as usize).take(count as usize) {
            pixels.extend(bytemuck::pod_collect_to_vec::<u8, [f32; 4]>(
                &line[..16 * width as usize],
            ));
        }
    }
    Ok(pixels)
}

fn transfer_table(transfer: &TransferFunction) -> Vec<[f32; 4]> {
    (0..LUT_SIZE)
        .map(|n| {
            let position = f64::from(n) / f64::from(LUT_SIZE - 1);
            let [r, g, b] = transfer.linear_rgb(position).map(|v| v as f32);
            [r, g, b, transfer.extinction(position) as f32]
        })
        .collect()
}

fn frame_uniform(grid: &GpuGrid, view: &View) -> Frame {
    let camera = &view.camera;
    let aspect = f64::from(view.size[0]) / f64::from(view.size[1]);
    let f32s = |v: DVec3| v.as_vec3().to_array();
    let linear = view.spaces.grid_from_world.matrix3;
    let eye = view.spaces.grid_from_world.transform_point3(camera.eye) - grid.origin;
    let [low, high] = view.transfer.range;
    Frame {
        eye: f32s(eye),
        step: view.sampling_step as f32,
        forward: f32s(camera.forward),
        early_termination: view.early_termination as f32,
        right: f32s(camera.right * camera.tan_half_fovy * aspect),
        value_low: low as f32,
        up: f32s(camera.up * camera.tan_half_fovy),
        value_scale: if high > low {
            (1.0 / (high - low)) as f32
        } else {
            0.0
        },
        grid_from_world_x: f32s(linear.x_axis),
        width: view.size[0],
        grid_from_world_y: f32s(linear.y_axis),
        height: view.size[1],
        grid_from_world_z: f32s(linear.z_axis),
        interpolation: match view.interpolation {
            Interpolation::Cell => INTERPOLATION_CELL,
            Interpolation::Vertex => INTERPOLATION_VERTEX,
        },
        box_low: f32s(grid.bounds[0]),
        reserved0: 0,
        box_high: f32s(grid.bounds[1]),
        reserved1: 0,
    }
}
