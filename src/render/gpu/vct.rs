//! The pyramid of values and the opacities of what it holds, for light along cones through values
//! (`src/render/plan/vct.rs` says how).

use super::device::Gpu;
use super::pipeline::{Pipeline, flag};
use super::slabs::Slabs;
use super::volume::Volume;
use crate::render::RenderError;
use crate::render::plan::extinction::Blur;
use crate::render::plan::layout::Slab;
use crate::render::plan::vct::{OpacityTable, shape};
use crate::view::View;
use crate::view::voxels::{Shape, Voxel};

/// Loop iterations that a voxel of a level costs, about: it covers two or three voxels along each axis, twice.
const MOMENTS_WORK: u64 = 32;

/// The pyramid, and the revision that it was made of.
pub struct ValuePyramid {
    /// See [`crate::render::plan::vct`].
    pub volume: Volume,
    /// See [`crate::render::revisions::Revisions::placed`].
    pub revision: u64,
}

impl ValuePyramid {
    /// Makes a pyramid in the place of an existing one, given bind group 2 with the values.
    ///
    /// # Errors
    /// When the device reports an error.
    pub async fn make(
        slabs: &mut Slabs<'_>,
        blur: &Blur,
        revision: u64,
        group: &wgpu::BindGroup,
        before: Option<Self>,
    ) -> Result<Self, RenderError> {
        let gpu = slabs.gpu;
        let shape = shape(blur.size);
        let volume = match before.filter(|p| p.volume.shape == shape) {
            Some(before) => before.volume,
            None => Volume::new(gpu, shape),
        };
        let info = gpu.uniform("blur", &blur.numbers());
        let nothing = Volume::new(
            gpu,
            Shape {
                voxel: Voxel::Quad,
                ..Shape::single([1; 3], 1)
            },
        );
        for level in 0..shape.levels {
            let constants = [
                ("FINEST", flag(level == 0)),
                ("CLIPS", flag(blur.clip_count > 0)),
            ];
            let pipeline = Pipeline::variant(gpu, "moments", "main", &constants)?;
            let below = match level {
                0 => nothing.level(0),
                _ => volume.level(level - 1),
            };
            let dispatch =
                |encoder: &mut wgpu::CommandEncoder, slab: &Slab, voxels: &wgpu::Buffer| {
                    let slab_info = gpu.uniform("slab", slab);
                    let own = [
                        info.as_entire_binding(),
                        slab_info.as_entire_binding(),
                        wgpu::BindingResource::TextureView(&below),
                        voxels.as_entire_binding(),
                    ];
                    let groups = [(2, group), (3, &gpu.bind(&pipeline.own, &own))];
                    pipeline.dispatch(encoder, &groups, slab.size);
                };
            volume
                .make_level(slabs, level, MOMENTS_WORK, &dispatch)
                .await?;
        }
        Ok(Self { volume, revision })
    }
}

/// Opacities by mean and deviation, and the revision of the extinction that they were made of.
pub struct ValueOpacities {
    /// Texels of [`OpacityTable`].
    pub table: wgpu::TextureView,
    /// See [`crate::render::revisions::Revisions::extinction`].
    pub revision: u64,
}

impl ValueOpacities {
    /// Those of a view whose pyramid has the values of `range` as 0 and 1.
    ///
    /// # Errors
    /// When the device refuses the table.
    pub fn new(
        gpu: &Gpu,
        view: &View,
        range: [f64; 2],
        revision: u64,
    ) -> Result<Self, RenderError> {
        let texels = OpacityTable::new(view, range).texels();
        let format = wgpu::TextureFormat::Rgba32Float;
        Ok(Self {
            table: gpu.table("opacities of values", format, &texels)?,
            revision,
        })
    }
}
