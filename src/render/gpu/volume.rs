//! Volumes on the device over the box of the active cells, made in slabs.

use super::device::Gpu;
use super::slabs::Slabs;
use crate::render::RenderError;
use crate::render::plan::layout::{RUN, Slab, VolumeInfo};
use crate::view::voxels::{Shape, Voxel};

/// Bytes of the buffer through which voxels come into the texture: no adapter needs to write it from a
/// shader.
const SLAB_BYTES: u64 = 16 << 20;

impl Shape {
    fn format(&self) -> wgpu::TextureFormat {
        match self.voxel {
            Voxel::Single => wgpu::TextureFormat::R16Float,
            Voxel::Packed => wgpu::TextureFormat::R16Uint,
            Voxel::Word => wgpu::TextureFormat::R32Uint,
            Voxel::Pair => wgpu::TextureFormat::Rg16Float,
            Voxel::Quad => wgpu::TextureFormat::Rgba16Float,
        }
    }

    /// Voxels from one row to the next in a buffer: copies want whole multiples of 256 bytes.
    fn row(&self, level: u32) -> u32 {
        let step = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT / self.voxel_bytes();
        self.at(level)[0].next_multiple_of(step)
    }

    /// Bytes of a slab in a buffer.
    fn slab_bytes(&self, slab: &Slab) -> u64 {
        let voxels = [slab.row, slab.size[1], slab.size[2]].map(u64::from);
        u64::from(self.voxel_bytes()) * voxels.iter().product::<u64>()
    }
}

/// A texture of bytes, in a format of one byte: x fastest, then y, then depth.
pub fn of_bytes(
    gpu: &Gpu,
    format: wgpu::TextureFormat,
    size: [u32; 3],
    bytes: &[u8],
) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("bytes"),
        size: extent(size),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D3,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(size[0]),
        rows_per_image: Some(size[1]),
    };
    gpu.queue
        .write_texture(texture.as_image_copy(), bytes, layout, extent(size));
    texture.create_view(&Default::default())
}

/// A volume over the box of the active cells.
///
/// **Shape**: x fastest, then y, then depth; voxel n of N along an axis has its middle at (n + 1/2) / N of
/// the box.
pub struct Volume {
    /// Its size.
    pub shape: Shape,
    /// Its voxels.
    pub texture: wgpu::Texture,
    /// What shaders know of it: a [`VolumeInfo`].
    pub info: wgpu::Buffer,
}

impl Volume {
    /// An empty volume.
    pub fn new(gpu: &Gpu, shape: Shape) -> Self {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("volume"),
            size: extent(shape.size),
            mip_level_count: shape.levels,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: shape.format(),
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        Self {
            shape,
            texture,
            info: gpu.uniform("volume", &<VolumeInfo as bytemuck::Zeroable>::zeroed()),
        }
    }

    /// A view of one level.
    pub fn level(&self, level: u32) -> wgpu::TextureView {
        self.texture.create_view(&wgpu::TextureViewDescriptor {
            base_mip_level: level,
            mip_level_count: Some(1),
            ..Default::default()
        })
    }

    /// Copies a level back: the words of its voxels, row by row; a row of an odd number of single numbers
    /// ends in half a word that means nothing.
    ///
    /// # Errors
    /// When the device reports an error.
    pub fn read(&self, gpu: &Gpu, level: u32) -> Result<Vec<u32>, RenderError> {
        let slab = Slab {
            first: [0; 3],
            row: self.shape.row(level),
            size: self.shape.at(level),
            level,
        };
        let staging = gpu.staging(self.shape.slab_bytes(&slab));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let (texture, buffer) = self.copy_places(&slab, &staging);
        encoder.copy_texture_to_buffer(texture, buffer, extent(slab.size));
        gpu.queue.submit([encoder.finish()]);
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&gpu.map(&staging)?);
        let of = |voxels: u32| (voxels * self.shape.voxel_bytes()).div_ceil(4) as usize;
        let rows = words.chunks_exact(of(slab.row));
        Ok(rows.flat_map(|r| &r[..of(slab.size[0])]).copied().collect())
    }

    /// Makes the voxels of a level by `dispatch`, which writes a slab of them to a buffer. A voxel costs about `work` loop iterations.
    ///
    /// # Errors
    /// When the device reports an error.
    pub async fn make_level(
        &self,
        slabs: &mut Slabs<'_>,
        level: u32,
        work: u64,
        dispatch: &dyn Fn(&mut wgpu::CommandEncoder, &Slab, &wgpu::Buffer),
    ) -> Result<(), RenderError> {
        let size = self.shape.at(level);
        self.make_slices(slabs, level, [0, size[2]], work, dispatch)
            .await
    }

    /// As [`Self::make_level`], for the slices from the first of `range` to before the last alone.
    ///
    /// # Errors
    /// When the device reports an error.
    pub async fn make_slices(
        &self,
        slabs: &mut Slabs<'_>,
        level: u32,
        [from, to]: [u32; 2],
        work: u64,
        dispatch: &dyn Fn(&mut wgpu::CommandEncoder, &Slab, &wgpu::Buffer),
    ) -> Result<(), RenderError> {
        let [width, height, _] = self.shape.at(level);
        let row = self.shape.row(level);
        let bytes = |rows| {
            let slab = Slab {
                first: [0; 3],
                row,
                size: [width, rows, RUN],
                level,
            };
            self.shape.slab_bytes(&slab)
        };
        let most_rows = (SLAB_BYTES / bytes(1)).clamp(1, u64::from(height)) as u32;
        let voxels = slabs.gpu.scratch("voxels", bytes(most_rows));
        let size = [width, height, to - from];
        let record = |encoder: &mut wgpu::CommandEncoder, slab: &Slab| {
            let [x, y, z] = slab.first;
            let slab = Slab {
                first: [x, y, from + z],
                level,
                row,
                ..*slab
            };
            encoder.clear_buffer(&voxels, 0, Some(self.shape.slab_bytes(&slab)));
            dispatch(encoder, &slab, &voxels);
            self.take(&slab, &voxels, encoder);
        };
        slabs.cover(size, [most_rows, RUN], work, &record).await
    }

    /// Records the copy of a slab of voxels into its level.
    fn take(&self, slab: &Slab, voxels: &wgpu::Buffer, encoder: &mut wgpu::CommandEncoder) {
        let (texture, buffer) = self.copy_places(slab, voxels);
        encoder.copy_buffer_to_texture(buffer, texture, extent(slab.size));
    }

    fn copy_places<'a>(
        &'a self,
        slab: &Slab,
        buffer: &'a wgpu::Buffer,
    ) -> (
        wgpu::TexelCopyTextureInfo<'a>,
        wgpu::TexelCopyBufferInfo<'a>,
    ) {
        let [x, y, z] = slab.first;
        let texture = wgpu::TexelCopyTextureInfo {
            mip_level: slab.level,
            origin: wgpu::Origin3d { x, y, z },
            ..self.texture.as_image_copy()
        };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(self.shape.voxel_bytes() * slab.row),
            rows_per_image: Some(slab.size[1]),
        };
        (texture, wgpu::TexelCopyBufferInfo { buffer, layout })
    }
}

fn extent([width, height, depth_or_array_layers]: [u32; 3]) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers,
    }
}
