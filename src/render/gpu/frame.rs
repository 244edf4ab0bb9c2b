//! One frame: uniforms, transfer table, tiles, readback, statistics.

use std::time::{Duration, Instant};

use bytemuck::Zeroable;

use super::device::Gpu;
use super::grid_upload::GpuGrid;
use super::round::Round;
use super::surfaces::SurfacePainter;
use super::target;
use super::tiles::{self, Pace, Rect, Tiles};
use crate::image::Image;
use crate::render::RenderError;
use crate::render::gpu::strategy::RenderStrategy;
use crate::render::job::Progress;
use crate::render::plan::frame::frame_uniform;
use crate::render::plan::layout::{self, Tile};
use crate::render::stats::FrameStats;
use crate::view::View;

/// What a frame is made with.
pub struct Drawing<'a> {
    /// Bind group 2: transfer function and light.
    pub light: wgpu::BindGroup,
    /// What finds the surfaces, where some are shown.
    pub surfaces: Option<&'a mut SurfacePainter>,
    /// What casts the rays.
    pub strategy: &'a mut dyn RenderStrategy,
}

/// Makes frames with one strategy.
#[derive(Default)]
pub struct FrameRenderer {
    pace: Pace,
    /// How much of surfaces' colors fits into a submission.
    painting: Pace,
    /// Loop iterations after which rays pause in tests, where these are to pause often.
    #[cfg(test)]
    pub(super) most_work: Option<u32>,
}

/// Loop iterations after which a ray pauses at the latest: on software adapters within what llvmpipe
/// allows a group of eight rays.
const WORK_LIMIT: [u32; 2] = [6_000, 100_000];
/// Loop iterations that rasterizing the surfaces costs a pixel, about; it is done at once for a part of the
/// image that a submission has room for.
const PART_WORK: u64 = 2;
/// Bytes of the shader's counters: low and high words.
const COUNTERS: u64 = 8 * layout::COUNTERS as u64;
/// Bytes of a surface point: distance and color.
const LAYER_BYTES: u64 = 16;
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

/// Refuses images that a device cannot hold.
fn check_size(gpu: &Gpu, size: [u32; 2]) -> Result<(), RenderError> {
    let limit = gpu.device.limits().max_texture_dimension_2d;
    if size.iter().all(|&n| n <= limit) {
        return Ok(());
    }
    Err(RenderError::Unsuitable {
        adapter: gpu.info.name.clone(),
        reason: format!("images are limited to {limit} pixels in each direction"),
    })
}

impl FrameRenderer {
    /// Renders a view.
    ///
    /// # Errors
    /// When the image is too large for the adapter or the device reports an error.
    pub async fn render(
        &mut self,
        gpu: &Gpu,
        grid: &GpuGrid,
        drawing: Drawing<'_>,
        view: &View,
        progress: &Progress,
    ) -> Result<(Image, FrameStats), RenderError> {
        let start = Instant::now();
        let Drawing {
            light,
            mut surfaces,
            strategy,
        } = drawing;
        check_size(gpu, view.size)?;
        let target = target::create(gpu, view.size);
        let counters = gpu.scratch("counters", COUNTERS);
        let pixels = u64::from(view.size[0]) * u64::from(view.size[1]);
        let layers = surfaces.as_ref().map_or(0, |s| s.layers());
        let room = Room::of(gpu, pixels, strategy.ray_state_bytes(), layers);
        let states = gpu.scratch("ray states", room.rays + room.layers);
        let frame = gpu.uniform("frame", &frame_uniform(&grid.facts, view));
        let tile = gpu.uniform("tile", &Tile::zeroed());
        let texture = target.create_view(&wgpu::TextureViewDescriptor::default());
        let frame_resources = [
            frame.as_entire_binding(),
            tile.as_entire_binding(),
            wgpu::BindingResource::TextureView(&texture),
            counters.as_entire_binding(),
            states.as_entire_binding(),
        ];
        let bound = Bound {
            gpu,
            groups: [
                gpu.bind(gpu.layouts.group(0), &frame_resources),
                grid.bind(gpu),
                light,
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
        let least_work = strategy.least_work();
        let mut done = 0;
        let most = self.painting.area(PART_WORK).min(room.pixels);
        for part in bound.parts(view.size, surfaces.is_some(), most) {
            let part = Part {
                rect: part,
                layers: (room.rays / LAYER_BYTES) as u32,
            };
            if let Some(surfaces) = &mut surfaces {
                let painting = &mut self.painting;
                bound
                    .find_surfaces(surfaces, part, painting, &mut stats, progress)
                    .await?;
            }
            let most_work = self.most_work(gpu);
            let mut tiles = Tiles::of(part.rect);
            while let Some(tile) = tiles.next(self.pace.area(least_work)) {
                let pace = (&mut self.pace, most_work);
                bound
                    .draw(&mut *strategy, part.tile(tile), pace, &mut stats, progress)
                    .await?;
                done += tile.area();
                progress.reached(done as f64 / pixels as f64).await;
            }
        }
        let pixels = target::read(gpu, &target, view.size)?;
        stats.covered_pixels = pixels.iter().filter(|pixel| pixel[3] != 0.0).count() as u64;
        stats.wall = start.elapsed();
        let image = Image {
            size: view.size,
            blending: view.style.blending,
            pixels,
        };
        Ok((image, stats))
    }
}

impl FrameRenderer {
    /// Loop iterations after which a ray pauses at the latest.
    fn most_work(&self, gpu: &Gpu) -> u32 {
        #[cfg(test)]
        if let Some(most) = self.most_work {
            return most;
        }
        WORK_LIMIT[usize::from(!gpu.is_software())]
    }
}

/// What is kept on the device of the rays of a part of the image.
struct Room {
    /// Pixels of the part at most.
    pixels: u64,
    /// Bytes of the rays' states.
    rays: u64,
    /// Bytes of their layers of surfaces.
    layers: u64,
}

impl Room {
    /// Room for rays with a state of `state` bytes and so many layers, in one binding.
    fn of(gpu: &Gpu, pixels: u64, state: u64, layers: u32) -> Self {
        let layers = LAYER_BYTES * u64::from(layers);
        let limit = gpu.device.limits().max_storage_buffer_binding_size;
        let most = tiles::MAX_AREA.min(limit / (state + layers).max(1));
        let pixels = pixels.min(most);
        Self {
            pixels,
            rays: state * pixels,
            layers: layers * pixels,
        }
    }
}

/// A part of the image whose surfaces are found at once.
#[derive(Clone, Copy)]
struct Part {
    rect: Rect,
    /// Position of its layers in the ray states.
    layers: u32,
}

impl Part {
    /// A tile of it.
    fn tile(self, rect: Rect) -> Tile {
        Tile {
            origin: rect.origin,
            size: rect.size,
            layers: self.layers,
            part_width: self.rect.size[0],
            part_origin: self.rect.origin,
            ..Tile::zeroed()
        }
    }
}

impl Bound<'_> {
    /// The parts of an image, of at most so many pixels: all of it at once where no surfaces are to be found.
    fn parts(&self, size: [u32; 2], has_surfaces: bool, most: u64) -> Vec<Rect> {
        let whole = Rect {
            origin: [0, 0],
            size,
        };
        match has_surfaces {
            true => tiles::parts(whole, most),
            false => vec![whole],
        }
    }

    /// Finds the surface points of a part, and then their colors in as many submissions as these need.
    async fn find_surfaces(
        &self,
        surfaces: &mut SurfacePainter,
        part: Part,
        pace: &mut Pace,
        stats: &mut FrameStats,
        progress: &Progress,
    ) -> Result<(), RenderError> {
        let uniform = part.tile(part.rect);
        let round = self.round(&uniform, 0);
        self.submit(
            &uniform,
            |encoder| surfaces.peel(&round, part.rect.origin, encoder),
            stats,
        )?;
        let [width, height] = part.rect.size;
        let row = u64::from(width) * surfaces.work();
        for layer in 0..surfaces.layers() {
            let mut next = 0;
            while next < height {
                let count = pace.pieces(row).clamp(1, u64::from(height - next)) as u32;
                let rows = next..next + count;
                let record = |encoder: &mut _| surfaces.paint(layer, &rows, &round, encoder);
                let before = stats.work;
                let took = self.submit(&uniform, record, stats)?;
                pace.learn(took, stats.work - before);
                next += count;
                progress.rest().await;
            }
        }
        Ok(())
    }

    /// Makes one tile, in as many submissions as its rays need.
    async fn draw(
        &self,
        strategy: &mut dyn RenderStrategy,
        tile: Tile,
        (pace, most): (&mut Pace, u32),
        stats: &mut FrameStats,
        progress: &Progress,
    ) -> Result<(), RenderError> {
        let mut uniform = tile;
        let goal = stats.finished_rays + u64::from(tile.size[0]) * u64::from(tile.size[1]);
        let mut before = *stats;
        while stats.finished_rays < goal {
            let left = goal - stats.finished_rays;
            uniform.work_limit = pace.work_limit(left, strategy.least_work(), most);
            let now = *stats;
            let round = Round {
                paused: now.pauses - before.pauses,
                strayed: now.recovered_rays - before.recovered_rays,
                ..self.round(&uniform, left as u32)
            };
            let record = |encoder: &mut _| strategy.encode(&round, encoder);
            let took = self.submit(&uniform, record, stats)?;
            pace.learn(took, stats.work - now.work);
            before = now;
            uniform.resume = 1;
            if stats.finished_rays < goal {
                progress.rest().await;
            }
        }
        Ok(())
    }

    /// A round of a tile, before anything is known of its rays.
    fn round(&self, uniform: &Tile, rays_left: u32) -> Round<'_> {
        Round {
            gpu: self.gpu,
            size: uniform.size,
            starts: uniform.resume == 0,
            rays_left,
            paused: 0,
            strayed: 0,
            groups: &self.groups,
            queries: self.queries.as_ref().map(|(set, _)| set),
        }
    }

    /// Submits what `record` records, waits for it and brings the statistics up to date.
    fn submit(
        &self,
        uniform: &Tile,
        record: impl FnOnce(&mut wgpu::CommandEncoder),
        stats: &mut FrameStats,
    ) -> Result<Duration, RenderError> {
        let gpu = self.gpu;
        gpu.queue
            .write_buffer(&self.tile, 0, bytemuck::bytes_of(uniform));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        record(&mut encoder);
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
        count(stats, &bytemuck::pod_collect_to_vec(counters));
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

/// Takes over the shader's counters, pairs of low and high words.
fn count(stats: &mut FrameStats, words: &[u32]) {
    let count = |n: u32| {
        let at = 2 * n as usize;
        u64::from(words[at]) | u64::from(words[at + 1]) << 32
    };
    stats.samples = count(layout::COUNT_SAMPLES);
    stats.newton_iterations = count(layout::COUNT_ITERATIONS);
    stats.topological_steps = count(layout::COUNT_STEPS);
    stats.grid_fallbacks = count(layout::COUNT_FALLBACKS);
    stats.entries = count(layout::COUNT_ENTRIES);
    stats.point_locations = stats.grid_fallbacks + count(layout::COUNT_SECTIONS);
    stats.cell_crossings = count(layout::COUNT_CROSSINGS);
    stats.lost_samples = count(layout::COUNT_LOST_SAMPLES);
    stats.cube_samples = count(layout::COUNT_CUBE);
    stats.finished_rays = count(layout::COUNT_FINISHED);
    stats.work = count(layout::COUNT_WORK);
    stats.peels = count(layout::COUNT_PEELS);
    stats.recovered_rays = count(layout::COUNT_RECOVERED);
    stats.lost_rays = count(layout::COUNT_LOST);
    stats.pauses = count(layout::COUNT_PAUSED);
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
