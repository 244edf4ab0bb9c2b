//! The summed-area table of extinction, for light along cones by boxes (`src/render/plan/sat.rs` says how).

use super::device::Gpu;
use super::pipeline::{Pipeline, flag};
use super::slabs::Slabs;
use super::volume::Volume;
use crate::render::RenderError;
use crate::render::plan::extinction::{Blur, Line};
use crate::render::plan::layout::{SUM_PARTS, Slab};
use crate::view::voxels::{Shape, Voxel};

/// Loop iterations that a voxel of a pass costs, about.
const SUM_WORK: u64 = 8;

/// The table, and what it was made of.
pub struct Sums {
    /// Sums over all voxels with smaller or equal indices.
    pub volume: Volume,
    /// See [`crate::render::revisions::Revisions::extinction`].
    pub revision: u64,
    /// Numbers that a unit of optical depth is counted in.
    pub counts: f32,
}

impl Sums {
    /// Makes a table, given bind group 2 with transfer function and values, and opacities of what stands in the way
    /// beside cells, from 0 to 255.
    ///
    /// # Errors
    /// When the device reports an error.
    pub async fn make(
        slabs: &mut Slabs<'_>,
        (blur, occluders): (&Blur, &wgpu::TextureView),
        revision: u64,
        group: &wgpu::BindGroup,
    ) -> Result<Self, RenderError> {
        let empty = |size| {
            let shape = Shape {
                voxel: Voxel::Word,
                ..Shape::single(size, 1)
            };
            Volume::new(slabs.gpu, shape)
        };
        let (mut made, mut other) = (empty(blur.size), empty(blur.size));
        let [first, next] = [true, false].map(|is_first| Pass {
            is_first,
            group,
            blur,
        });
        first.run(slabs, [0, 0], occluders, &made).await?;
        for axis in 0..3 {
            let mut apart = 1;
            while apart < blur.size[axis as usize] {
                next.run(slabs, [axis, apart], &made.level(0), &other)
                    .await?;
                std::mem::swap(&mut made, &mut other);
                apart *= SUM_PARTS;
            }
        }
        Ok(Self {
            volume: made,
            revision,
            counts: blur.counts,
        })
    }
}

/// One pass over all voxels.
struct Pass<'a> {
    is_first: bool,
    group: &'a wgpu::BindGroup,
    blur: &'a Blur,
}

impl Pass<'_> {
    /// Along an axis, of sums so many voxels apart.
    async fn run(
        &self,
        slabs: &mut Slabs<'_>,
        [axis, apart]: [u32; 2],
        source: &wgpu::TextureView,
        to: &Volume,
    ) -> Result<(), RenderError> {
        let gpu: &Gpu = slabs.gpu;
        let info = gpu.uniform(
            "blur",
            &self.blur.info(Line {
                axis,
                counts: [apart; 2],
                deviation: 0.0,
            }),
        );
        let constants = [
            ("FIRST", flag(self.is_first)),
            ("CLIPS", flag(self.is_first && self.blur.clip_count > 0)),
        ];
        let pipeline = Pipeline::variant(gpu, "sums", "main", &constants)?;
        let dispatch = |encoder: &mut wgpu::CommandEncoder, slab: &Slab, voxels: &wgpu::Buffer| {
            let slab_info = gpu.uniform("slab", slab);
            let own = [
                info.as_entire_binding(),
                slab_info.as_entire_binding(),
                wgpu::BindingResource::TextureView(source),
                voxels.as_entire_binding(),
            ];
            let groups = [(2, self.group), (3, &gpu.bind(&pipeline.own, &own))];
            pipeline.dispatch(encoder, &groups, slab.size);
        };
        to.make_level(slabs, 0, SUM_WORK, &dispatch).await
    }
}
