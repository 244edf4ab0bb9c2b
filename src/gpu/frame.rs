//! One frame: uniforms, transfer table, tiles, readback, statistics.

use std::time::{Duration, Instant};

use bytemuck::Zeroable;
use glam::DVec3;

use super::device::{Gpu, GpuError};
use super::grid_upload::GpuGrid;
use super::layout::{Frame, INTERPOLATION_CELL, INTERPOLATION_VERTEX, LUT_SIZE, Tile};
use super::tiles::{self, Pace, Rect};
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
    /// CPU time of the process meanwhile, filled in by who measures it.
    pub cpu: Duration,
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
    /// Rays that have reached their end.
    pub finished_rays: u64,
    /// Loop iterations of all rays, about.
    pub work: u64,
    /// Number of submissions.
    pub submissions: u32,
    /// Bytes of the picture on the device.
    pub target_bytes: u64,
}

/// Makes frames with one strategy.
#[derive(Default)]
pub struct FrameRenderer {
    pace: Pace,
}

/// Loop iterations after which a ray pauses at the latest: on software adapters within what llvmpipe
/// allows a group of eight rays.
const WORK_LIMIT: [u32; 2] = [6_000, 100_000];
/// Counters of the shader: low and high words.
const COUNTERS: u64 = 12 * 4;
/// Bytes of two timestamps, in front of the counters in the staging buffer.
const TICKS: u64 = 16;

/// Objects of one frame.
struct Bound<'a> {
    gpu: &'a Gpu,
    groups: [wgpu::BindGroup; 3],
    tile: wgpu::Buffer,
    counters: wgpu::Buffer,
    staging: wgpu::Buffer,
    queries: Option<(wgpu::QuerySet, wgpu::Buffer)>,
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
        let counters = device_buffer(gpu, "counters", COUNTERS);
        let pixels = u64::from(view.size[0]) * u64::from(view.size[1]);
        let states = device_buffer(gpu, "ray states", 32 * pixels.min(tiles::MAX_AREA));
        let table = gpu.storage("transfer table", &transfer_table(&view.transfer))?;
        let frame = gpu.uniform("frame", &frame_uniform(grid, view));
        let tile = gpu.uniform("tile", &Tile::zeroed());
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
                        states.as_entire_binding(),
                    ],
                ),
                grid.bind(gpu, pipeline),
                gpu.bind(pipeline, 2, &[table.as_entire_binding()]),
            ],
            tile,
            counters,
            staging: gpu.staging(TICKS + COUNTERS),
            queries: queries(gpu),
        };
        let mut stats = FrameStats {
            target_bytes: 16 * pixels + states.size(),
            ..FrameStats::default()
        };
        let draw = |rect, pace: &mut Pace| bound.draw(strategy, rect, pace, &mut stats);
        if !tiles::cover(view.size, &mut self.pace, draw, progress)? {
            return Ok(None);
        }
        let pixels = read_target(gpu, &target, view.size)?;
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
    /// Makes one tile, in as many submissions as its rays need.
    fn draw(
        &self,
        strategy: &dyn RenderStrategy,
        rect: Rect,
        pace: &mut Pace,
        stats: &mut FrameStats,
    ) -> Result<(), GpuError> {
        let mut uniform = Tile {
            origin: rect.origin,
            size: rect.size,
            ..Tile::zeroed()
        };
        let goal = stats.finished_rays + rect.area();
        let most = WORK_LIMIT[usize::from(!self.gpu.is_software())];
        while stats.finished_rays < goal {
            uniform.work_limit = pace.work_limit(rect.area(), most);
            let before = stats.work;
            let took = self.submit(strategy, &uniform, stats)?;
            pace.learn(took, stats.work - before);
            uniform.resume = 1;
        }
        Ok(())
    }

    /// Submits one dispatch, waits for it and brings the statistics up to date.
    fn submit(
        &self,
        strategy: &dyn RenderStrategy,
        uniform: &Tile,
        stats: &mut FrameStats,
    ) -> Result<Duration, GpuError> {
        let gpu = self.gpu;
        gpu.queue
            .write_buffer(&self.tile, 0, bytemuck::bytes_of(uniform));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        {
            let queries = self.queries.as_ref();
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("tile"),
                timestamp_writes: queries.map(|(set, _)| wgpu::ComputePassTimestampWrites {
                    query_set: set,
                    beginning_of_pass_write_index: Some(0),
                    end_of_pass_write_index: Some(1),
                }),
            });
            for (n, group) in (0..).zip(&self.groups) {
                pass.set_bind_group(n, group, &[]);
            }
            strategy.encode(&mut pass, uniform.size);
        }
        if let Some((set, resolve)) = &self.queries {
            encoder.resolve_query_set(set, 0..2, resolve, 0);
            encoder.copy_buffer_to_buffer(resolve, 0, &self.staging, 0, TICKS);
        }
        encoder.copy_buffer_to_buffer(&self.counters, 0, &self.staging, TICKS, COUNTERS);
        let start = Instant::now();
        gpu.queue.submit([encoder.finish()]);
        let content = gpu.map(&self.staging)?;
        let wall = start.elapsed();
        let (ticks, counters) = content.split_at(TICKS as usize);
        stats.count(&bytemuck::pod_collect_to_vec(counters));
        let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(ticks);
        let by_adapter = gpu.timestamp_period_ns.map(|period| {
            Duration::from_nanos(
                (ticks[1].saturating_sub(ticks[0]) as f64 * f64::from(period)) as u64,
            )
        });
        // Some drivers give zero or nonsense: then the host's clock has to do.
        stats.frame += by_adapter
            .filter(|t| !t.is_zero() && *t < wall)
            .unwrap_or(wall);
        stats.submissions += 1;
        stats.longest_submission = stats.longest_submission.max(wall);
        Ok(wall)
    }
}

impl FrameStats {
    /// Takes over the shader's counters, pairs of low and high words.
    fn count(&mut self, words: &[u32]) {
        let count = |n: usize| u64::from(words[2 * n]) | u64::from(words[2 * n + 1]) << 32;
        self.samples = count(0);
        self.newton_iterations = count(1);
        self.topological_steps = count(2);
        self.grid_fallbacks = count(3);
        self.finished_rays = count(4);
        self.work = count(5);
    }
}

fn queries(gpu: &Gpu) -> Option<(wgpu::QuerySet, wgpu::Buffer)> {
    gpu.timestamp_period_ns?;
    let set = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
        label: Some("tile times"),
        ty: wgpu::QueryType::Timestamp,
        count: 2,
    });
    let resolve = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("tile times"),
        size: TICKS,
        usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    Some((set, resolve))
}

/// A zeroed buffer that shaders write and the host can copy from.
fn device_buffer(gpu: &Gpu, label: &str, size: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
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
