//! Pyramids over a resampled volume: averages, and how rays may pass its bricks.

use super::device::Gpu;
use super::pipeline::{Pipeline, flag};
use crate::render::RenderError;
use crate::render::plan::bricks::{Classifier, bricks_of_volume, levels, room};
use crate::render::plan::layout::{BRICK, BricksInfo, Slab};
use crate::render::plan::majorants::Majorants;

use super::slabs::Slabs;
use super::volume::Volume;
use crate::view::voxels::Voxel;

/// Loop iterations that a voxel of an average costs, about: it covers two or three voxels along each axis.
const AVERAGE_WORK: u64 = 16;

/// The pyramid of a volume's bricks.
pub struct Bricks {
    /// Number of bricks and of levels; the rest is zero.
    shape: BricksInfo,
    /// What shaders know of it: a [`BricksInfo`].
    pub info: wgpu::Buffer,
    /// How rays pass each brick.
    pub passes: wgpu::Buffer,
    parts: wgpu::Buffer,
    maxima: wgpu::Buffer,
}

impl Bricks {
    /// Room for the pyramid of a volume of so many voxels.
    pub fn new(gpu: &Gpu, size: [u32; 3]) -> Self {
        Self::with_room(gpu, size, room(size))
    }

    /// No pyramid: what shaders are bound to where they do not ask for it.
    pub fn unused(gpu: &Gpu, size: [u32; 3]) -> Self {
        Self::with_room(gpu, size, [UNUSED_BYTES; 3])
    }

    fn with_room(gpu: &Gpu, size: [u32; 3], [parts, passes, maxima]: [u64; 3]) -> Self {
        let shape = bricks_of_volume(size);
        Self {
            info: gpu.uniform("bricks", &shape),
            shape,
            parts: gpu.scratch("parts", parts),
            passes: gpu.scratch("passes", passes),
            maxima: gpu.scratch("range maxima", maxima),
        }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        let buffers = [&self.parts, &self.passes, &self.maxima];
        buffers.iter().map(|b| b.size()).sum()
    }

    /// True where there is a pyramid.
    pub fn are_used(&self) -> bool {
        self.maxima.size() > UNUSED_BYTES
    }
}

/// Bytes of a buffer that is only there to be bound.
const UNUSED_BYTES: u64 = 16;

fn record(
    pipeline: &Pipeline,
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    bricks: &Bricks,
    what: &What<'_>,
) {
    let slab = gpu.uniform("slab", &what.slab);
    let own = [
        bricks.info.as_entire_binding(),
        slab.as_entire_binding(),
        wgpu::BindingResource::TextureView(what.volume),
        what.voxels.as_entire_binding(),
        bricks.parts.as_entire_binding(),
        bricks.passes.as_entire_binding(),
        bricks.maxima.as_entire_binding(),
    ];
    let groups = [(3, &gpu.bind(&pipeline.own, &own))];
    pipeline.dispatch(encoder, &groups, what.size);
}

/// Makes the coarser levels of a volume, each from the one below.
///
/// # Errors
/// When the device reports an error.
pub async fn average(
    slabs: &mut Slabs<'_>,
    volume: &Volume,
    bricks: &Bricks,
) -> Result<(), RenderError> {
    let gpu = slabs.gpu;
    let wide = [("WIDE", flag(volume.shape.voxel == Voxel::Quad))];
    let average = Pipeline::variant(gpu, "pyramids", "average", &wide)?;
    for level in 1..volume.shape.levels {
        let finer = volume.level(level - 1);
        let dispatch = |encoder: &mut wgpu::CommandEncoder, slab: &Slab, voxels: &_| {
            let what = What {
                slab: *slab,
                volume: &finer,
                voxels,
                size: slab.size,
            };
            record(&average, gpu, encoder, bricks, &what);
        };
        volume
            .make_level(slabs, level, AVERAGE_WORK, &dispatch)
            .await?;
    }
    Ok(())
}

/// Finds range and presence of each brick.
///
/// # Errors
/// When the device reports an error.
pub async fn summarize(
    slabs: &mut Slabs<'_>,
    volume: &Volume,
    bricks: &Bricks,
) -> Result<(), RenderError> {
    let gpu = slabs.gpu;
    let summarize = Pipeline::variant(gpu, "pyramids", "summarize", &[])?;
    let finest = volume.level(0);
    let unused = gpu.scratch("no voxels", UNUSED_BYTES);
    let work = u64::from(BRICK + 2).pow(3);
    let record = |encoder: &mut wgpu::CommandEncoder, slab: &Slab| {
        let what = What {
            slab: *slab,
            volume: &finest,
            voxels: &unused,
            size: slab.size,
        };
        record(&summarize, gpu, encoder, bricks, &what);
    };
    slabs
        .cover(bricks.shape.count, [u32::MAX, 1], work, &record)
        .await
}

/// Weighs the bricks by a transfer function and classifies them.
///
/// `range` has the values that are stored as 0 and 1; `weighted` says that values are divided by
/// presence when they are sampled.
///
/// # Errors
/// When the device reports an error.
pub fn classify(
    gpu: &Gpu,
    volume: &Volume,
    bricks: &Bricks,
    by: &Classifier<'_>,
) -> Result<(), RenderError> {
    let info = by.info(bricks.shape, volume.shape.levels - 1);
    gpu.queue
        .write_buffer(&bricks.info, 0, bytemuck::bytes_of(&info));
    if by.limits.are_never() {
        return Ok(());
    }
    let weighted = [("WEIGHTED", flag(by.weighted))];
    let wanted: [(_, &[_]); 3] = [("weigh", &weighted), ("reduce", &[]), ("classify", &[])];
    let [weigh, reduce, classify] = Pipeline::variants(gpu, "pyramids", wanted);
    let majorants = Majorants::new(by.transfer);
    gpu.queue
        .write_buffer(&bricks.maxima, 0, bytemuck::cast_slice(majorants.table()));
    let finest = volume.level(0);
    let unused = gpu.scratch("no voxels", UNUSED_BYTES);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut dispatch = |pipeline: &Pipeline, level, size| {
        let what = What {
            slab: Slab {
                level,
                ..bytemuck::Zeroable::zeroed()
            },
            volume: &finest,
            voxels: &unused,
            size,
        };
        record(pipeline, gpu, &mut encoder, bricks, &what);
    };
    dispatch(&*weigh?, 0, bricks.shape.count);
    let reduce = reduce?;
    for (level, size) in (0..).zip(levels(bricks.shape.count).skip(1)) {
        dispatch(&reduce, level, size);
    }
    dispatch(&*classify?, 0, bricks.shape.count);
    gpu.queue.submit([encoder.finish()]);
    gpu.wait()
}

/// What a dispatch works on, beside the bricks.
struct What<'a> {
    slab: Slab,
    volume: &'a wgpu::TextureView,
    voxels: &'a wgpu::Buffer,
    size: [u32; 3],
}
