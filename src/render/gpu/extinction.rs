//! The pyramid of representative extinction: opacities blurred by Gaussians, each level twice as wide as the
//! one below (campagnolo-2021, 3.2.1 and 3.2.3).
//!
//! The paper blurs each level from the one below. Here it is blurred from means of the opacities: what a
//! blur spreads beyond the box is kept nowhere, so that a thin model would all but vanish from upper levels.

use super::device::Gpu;
use super::pipeline::{Pipeline, flag};
use super::slabs::Slabs;
use super::volume::Volume;
use crate::render::RenderError;
use crate::render::plan::extinction::{Blur, Line, MOST_LEVELS};
use crate::render::plan::layout::{Slab, WORK_GAUSSIAN, WORK_MEAN, WORK_VALUES};
use crate::view::voxels::Shape;

/// What a pyramid is made from.
#[derive(Clone)]
pub struct PyramidSource {
    /// See [`crate::render::revisions::Revisions::extinction`].
    pub revision: u64,
    /// Opacities of values, which shaders find in bind group 2, and their blur.
    pub blur: Blur,
    /// Opacities of what stands in the way beside cells, from 0 to 1, or a texture without any.
    pub occluders: wgpu::TextureView,
}

/// The pyramid, and what it was made from.
pub struct Pyramid {
    /// Optical depth of a length of one standard deviation of the finest level, level by level.
    pub volume: Volume,
    /// See [`crate::render::revisions::Revisions::extinction`].
    pub revision: u64,
}

impl Pyramid {
    fn new(gpu: &Gpu, shape: Shape, source: &PyramidSource, before: Option<Self>) -> Self {
        let volume = match before.filter(|p| p.volume.shape == shape) {
            Some(before) => before.volume,
            None => Volume::new(gpu, shape),
        };
        Self {
            volume,
            revision: source.revision,
        }
    }

    /// Makes a pyramid in the place of an existing one.
    ///
    /// `group` is bind group 2 with transfer function and values.
    ///
    /// # Errors
    /// When the device reports an error.
    pub async fn make(
        slabs: &mut Slabs<'_>,
        source: &PyramidSource,
        group: &wgpu::BindGroup,
        before: Option<Self>,
    ) -> Result<Self, RenderError> {
        let size = source.blur.size;
        let shape = Shape::single(size, MOST_LEVELS);
        let made = Self::new(slabs.gpu, shape, source, before);
        let mut below = Volume::new(slabs.gpu, Shape::single(size, 1));
        opacities(slabs, source, group, &below).await?;
        for level in 0..shape.levels {
            if level > 1 {
                // Blurred from means of what nothing has blurred: what a level loses beyond the box is not
                // lost to those above.
                let means = Volume::new(slabs.gpu, Shape::single(shape.at(level - 1), 1));
                let filter = BlurFilter::Mean;
                filtered(slabs, source, group, filter, (&below, 0), (&means, 0)).await?;
                below = means;
            }
            let filter = BlurFilter::Gaussian(level);
            let target = (&made.volume, level);
            filtered(slabs, source, group, filter, (&below, 0), target).await?;
        }
        Ok(made)
    }

    /// Makes the opacities of a unit of length, without any blur, and so many levels of their means above; otherwise as
    /// [`Self::make`].
    ///
    /// # Errors
    /// When the device reports an error.
    pub async fn make_sharp(
        slabs: &mut Slabs<'_>,
        source: &PyramidSource,
        group: &wgpu::BindGroup,
        means: u32,
        before: Option<Self>,
    ) -> Result<Self, RenderError> {
        let shape = Shape::single(source.blur.size, 1 + means);
        let made = Self::new(slabs.gpu, shape, source, before);
        opacities(slabs, source, group, &made.volume).await?;
        for level in 1..shape.levels {
            let target = (&made.volume, level);
            filtered(
                slabs,
                source,
                group,
                BlurFilter::Mean,
                (&made.volume, level - 1),
                target,
            )
            .await?;
        }
        Ok(made)
    }

    /// Number of levels.
    pub fn levels(&self) -> u32 {
        self.volume.shape.levels
    }
}

/// What a pass does and writes; its constants.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Pass {
    work: PassWork,
    writes_depths: bool,
    clips: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PassWork {
    /// Opacities from values.
    Values,
    /// A Gaussian of opacities.
    Gaussian,
    /// Means of opacities.
    Mean,
}

impl PassWork {
    /// Its number in the shader.
    fn number(self) -> u32 {
        match self {
            Self::Values => WORK_VALUES,
            Self::Gaussian => WORK_GAUSSIAN,
            Self::Mean => WORK_MEAN,
        }
    }
}

/// How opacities are filtered along all axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum BlurFilter {
    /// Their means in larger voxels.
    Mean,
    /// By the Gaussian of a level.
    Gaussian(u32),
}

/// Loop iterations that a voxel of a pass costs, about.
const BLUR_WORK: u64 = 8;

/// Opacities of a unit of length from the values.
async fn opacities(
    slabs: &mut Slabs<'_>,
    source: &PyramidSource,
    group: &wgpu::BindGroup,
    target: &Volume,
) -> Result<(), RenderError> {
    let pass = Pass {
        work: PassWork::Values,
        writes_depths: false,
        clips: source.blur.clip_count > 0,
    };
    let line = Line {
        axis: 0,
        counts: [target.shape.size[0]; 2],
        deviation: 0.0,
    };
    // Values come from the bind group.
    let read = &source.occluders;
    pass_over(slabs, source, group, pass, line, read, (target, 0)).await
}

/// Filters opacities along x, y and depth in turn: into a level of the pyramid, or into their means.
async fn filtered(
    slabs: &mut Slabs<'_>,
    source: &PyramidSource,
    group: &wgpu::BindGroup,
    filter: BlurFilter,
    (below, level_below): (&Volume, u32),
    (target, level): (&Volume, u32),
) -> Result<(), RenderError> {
    let before = below.shape.at(level_below);
    let after = target.shape.at(level);
    let partly = |axes: usize| std::array::from_fn(|a| if a < axes { after[a] } else { before[a] });
    let between = [1, 2].map(|axes| Volume::new(slabs.gpu, Shape::single(partly(axes), 1)));
    for axis in 0..3 {
        let read = match axis {
            0 => below.level(level_below),
            _ => between[axis - 1].level(0),
        };
        let (work, deviation) = match filter {
            BlurFilter::Mean => (PassWork::Mean, 0.0),
            BlurFilter::Gaussian(level) => (
                PassWork::Gaussian,
                source.blur.deviation(axis, before[axis], level),
            ),
        };
        let pass = Pass {
            work,
            writes_depths: axis == 2 && work == PassWork::Gaussian,
            clips: false,
        };
        let line = Line {
            axis: axis as u32,
            counts: [before[axis], after[axis]],
            deviation,
        };
        let to = between.get(axis).map_or((target, level), |v| (v, 0));
        pass_over(slabs, source, group, pass, line, &read, to).await?;
    }
    Ok(())
}

#[allow(clippy::too_many_arguments, reason = "what one pass reads and writes")]
async fn pass_over(
    slabs: &mut Slabs<'_>,
    source: &PyramidSource,
    group: &wgpu::BindGroup,
    pass: Pass,
    line: Line,
    read: &wgpu::TextureView,
    (target, level): (&Volume, u32),
) -> Result<(), RenderError> {
    let gpu = slabs.gpu;
    let info = gpu.uniform("blur", &source.blur.info(line));
    let constants = [
        ("WORK", f64::from(pass.work.number())),
        ("WRITES_DEPTHS", flag(pass.writes_depths)),
        ("CLIPS", flag(pass.clips)),
    ];
    let pipeline = Pipeline::variant(gpu, "extinction", "main", &constants)?;
    let dispatch = |encoder: &mut wgpu::CommandEncoder, slab: &Slab, voxels: &wgpu::Buffer| {
        let slab_info = gpu.uniform("slab", slab);
        let own = [
            info.as_entire_binding(),
            slab_info.as_entire_binding(),
            wgpu::BindingResource::TextureView(read),
            voxels.as_entire_binding(),
        ];
        let groups = [(2, group), (3, &gpu.bind(&pipeline.own, &own))];
        let [width, height, depth] = slab.size;
        pipeline.dispatch(encoder, &groups, [width.div_ceil(2), height, depth]);
    };
    target.make_level(slabs, level, BLUR_WORK, &dispatch).await
}
