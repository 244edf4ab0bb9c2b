//! Pyramids over a resampled volume: averages, and how rays may pass its bricks.

use super::device::Gpu;
use super::pipeline::Pipeline;
use crate::render::RenderError;
use crate::render::plan::layout::{BRICK, BricksInfo, LUT_SIZE, Slab};
use crate::render::plan::transfer::extinctions;

use super::slabs::Slabs;
use super::volume::Volume;
use crate::transfer::TransferFunction;
use crate::view::voxels::Voxel;

/// Bytes of a part of the pyramid: range, presence, extinction.
const PART_BYTES: u64 = 16;
/// Levels of [`range_maxima`].
const MAXIMA_LEVELS: u32 = LUT_SIZE.ilog2() + 1;

/// Loop iterations that a voxel of an average costs, about: it covers two or three voxels along each axis.
const AVERAGE_WORK: u64 = 16;

/// What bricks are classified by; each negative for never.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Largest extinction of what is passed at once.
    pub empty: f64,
    /// Largest range, as a part of the transfer function's, of what is passed in one step.
    pub even: f64,
    /// Largest extinction of what is sampled from the average pyramid.
    pub thin: f64,
}

impl Limits {
    /// True where nothing is ever classified.
    pub fn are_never(&self) -> bool {
        self.empty < 0.0 && self.even < 0.0 && self.thin < 0.0
    }
}

/// Shaders that make the pyramids.
pub struct PyramidMaker {
    /// For voxels of one word and of two.
    average: [Pipeline; 2],
    summarize: Pipeline,
    /// Where absent voxels count as zero, and where values are divided by presence.
    weigh: [Pipeline; 2],
    reduce: Pipeline,
    classify: Pipeline,
}

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
        Self::with_room(gpu, size, Self::room(size))
    }

    /// No pyramid: what shaders are bound to where they do not ask for it.
    pub fn unused(gpu: &Gpu, size: [u32; 3]) -> Self {
        Self::with_room(gpu, size, [UNUSED_BYTES; 3])
    }

    fn with_room(gpu: &Gpu, size: [u32; 3], [parts, passes, maxima]: [u64; 3]) -> Self {
        let count = bricks_of(size);
        let shape = BricksInfo {
            count,
            levels: levels(count).count() as u32,
            ..bytemuck::Zeroable::zeroed()
        };
        Self {
            info: gpu.uniform("bricks", &shape),
            shape,
            parts: gpu.scratch("parts", parts),
            passes: gpu.scratch("passes", passes),
            maxima: gpu.scratch("range maxima", maxima),
        }
    }

    /// Bytes of the pyramid, of what is kept of each brick, and of the table of maxima.
    fn room(size: [u32; 3]) -> [u64; 3] {
        let number = |count: [u32; 3]| count.map(u64::from).iter().product::<u64>();
        let count = bricks_of(size);
        [
            PART_BYTES * levels(count).map(number).sum::<u64>(),
            4 * number(count),
            u64::from(4 * MAXIMA_LEVELS * LUT_SIZE),
        ]
    }

    /// Bytes that a pyramid of so many voxels takes.
    pub fn most_bytes(size: [u32; 3]) -> u64 {
        Self::room(size).iter().sum()
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

fn bricks_of(size: [u32; 3]) -> [u32; 3] {
    size.map(|n| n.div_ceil(BRICK))
}

/// Parts along each axis, level by level, up to the one that is the whole.
fn levels(bricks: [u32; 3]) -> impl Iterator<Item = [u32; 3]> {
    std::iter::successors(Some(bricks), |size| {
        (*size != [1; 3]).then(|| size.map(|n| n.div_ceil(2)))
    })
}

/// Largest extinctions of a table: entry n of level l is that of 2^l entries from n on.
fn range_maxima(transfer: &TransferFunction) -> Vec<f32> {
    let entries = extinctions(transfer);
    let wider = |(level, below): &(u32, Vec<f32>)| {
        let half = 1 << level;
        let maximum = |n: usize| below[n].max(*below.get(n + half).unwrap_or(&0.0));
        Some((level + 1, (0..below.len()).map(maximum).collect()))
    };
    std::iter::successors(Some((0, entries)), wider)
        .take(MAXIMA_LEVELS as usize)
        .flat_map(|(_, level)| level)
        .collect()
}

impl PyramidMaker {
    /// Compiles the shaders.
    ///
    /// # Errors
    /// When the driver refuses one.
    pub fn new(gpu: &Gpu) -> Result<Self, RenderError> {
        let entry = |name| Pipeline::variant(gpu, "pyramids", name, &[]);
        let both = |entry, constant| -> Result<_, RenderError> {
            let variant = |value| Pipeline::variant(gpu, "pyramids", entry, &[(constant, value)]);
            Ok([variant(0.0)?, variant(1.0)?])
        };
        Ok(Self {
            average: both("average", "WIDE")?,
            summarize: entry("summarize")?,
            weigh: both("weigh", "WEIGHTED")?,
            reduce: entry("reduce")?,
            classify: entry("classify")?,
        })
    }

    fn record(
        &self,
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
        &self,
        slabs: &mut Slabs<'_>,
        volume: &Volume,
        bricks: &Bricks,
    ) -> Result<(), RenderError> {
        let gpu = slabs.gpu;
        let average = &self.average[usize::from(volume.shape.voxel == Voxel::Quad)];
        for level in 1..volume.shape.levels {
            let finer = volume.level(level - 1);
            let dispatch = |encoder: &mut wgpu::CommandEncoder, slab: &Slab, voxels: &_| {
                let what = What {
                    slab: *slab,
                    volume: &finer,
                    voxels,
                    size: slab.size,
                };
                self.record(average, gpu, encoder, bricks, &what);
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
        &self,
        slabs: &mut Slabs<'_>,
        volume: &Volume,
        bricks: &Bricks,
    ) -> Result<(), RenderError> {
        let gpu = slabs.gpu;
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
            self.record(&self.summarize, gpu, encoder, bricks, &what);
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
        &self,
        gpu: &Gpu,
        volume: &Volume,
        bricks: &Bricks,
        by: &Classifier<'_>,
    ) -> Result<(), RenderError> {
        let info = by.info(volume, bricks);
        gpu.queue
            .write_buffer(&bricks.info, 0, bytemuck::bytes_of(&info));
        if by.limits.are_never() {
            return Ok(());
        }
        let maxima = range_maxima(by.transfer);
        gpu.queue
            .write_buffer(&bricks.maxima, 0, bytemuck::cast_slice(&maxima));
        let finest = volume.level(0);
        let unused = gpu.scratch("no voxels", UNUSED_BYTES);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut record = |pipeline, level, size| {
            let what = What {
                slab: Slab {
                    level,
                    ..bytemuck::Zeroable::zeroed()
                },
                volume: &finest,
                voxels: &unused,
                size,
            };
            self.record(pipeline, gpu, &mut encoder, bricks, &what);
        };
        record(&self.weigh[usize::from(by.weighted)], 0, bricks.shape.count);
        for (level, size) in (0..).zip(levels(bricks.shape.count).skip(1)) {
            record(&self.reduce, level, size);
        }
        record(&self.classify, 0, bricks.shape.count);
        gpu.queue.submit([encoder.finish()]);
        gpu.wait()
    }
}

/// What a dispatch works on, beside the bricks.
struct What<'a> {
    slab: Slab,
    volume: &'a wgpu::TextureView,
    voxels: &'a wgpu::Buffer,
    size: [u32; 3],
}

/// What bricks are classified by.
#[derive(Debug, Clone, Copy)]
pub struct Classifier<'a> {
    /// Value to color and extinction.
    pub transfer: &'a TransferFunction,
    /// The values that are stored as 0 and 1.
    pub range: [f64; 2],
    /// Values are divided by presence when they are sampled.
    pub weighted: bool,
    /// What is special.
    pub limits: Limits,
}

impl Classifier<'_> {
    fn info(&self, volume: &Volume, bricks: &Bricks) -> BricksInfo {
        let [low, scale] = self.transfer.positions(self.range);
        let limits = self.limits;
        BricksInfo {
            position_low: low as f32,
            position_scale: scale as f32,
            empty: limits.empty as f32,
            even: limits.even as f32,
            thin: limits.thin as f32,
            averages: volume.shape.levels - 1,
            ..bricks.shape
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn range_maxima_are_those_of_every_range() {
        let transfer = TransferFunction {
            color: vec![(0.0, [1.0; 3])],
            opacity: vec![(0.0, 0.3), (0.4, 0.0), (0.7, 0.9), (1.0, 0.1)],
            range: [0.0, 1.0],
            scale: crate::transfer::Scale::Linear,
            bands: None,
            reference_length: 1.0,
        };
        let entries = extinctions(&transfer);
        let maxima = range_maxima(&transfer);
        let mut random = fastrand::Rng::with_seed(3);
        let mut unlike_first = 0;
        for _ in 0..2000 {
            let first = random.usize(0..entries.len());
            let last = random.usize(first..entries.len());
            let level = (last - first + 1).ilog2() as usize;
            let at = |n: usize| maxima[level * entries.len() + n];
            let found = at(first).max(at(last + 1 - (1 << level)));
            let expected = entries[first..=last].iter().copied().fold(0.0, f32::max);
            assert_eq!(found, expected, "{first} {last}");
            unlike_first += usize::from(found != entries[first]);
        }
        assert!(unlike_first > 500);
    }

    #[test]
    fn levels_end_with_the_whole() {
        let found: Vec<_> = levels([5, 1, 3]).collect();
        assert_eq!(found, [[5, 1, 3], [3, 1, 2], [2, 1, 1], [1, 1, 1]]);
        assert_eq!(levels([1; 3]).count(), 1);
    }
}
