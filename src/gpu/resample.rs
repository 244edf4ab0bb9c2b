//! A field resampled on the device: a volume of value and presence over the box of the active cells.

use super::device::{Gpu, GpuError};
use super::grid_upload::GpuGrid;
use super::layout::{self, RUN, Slab, VolumeInfo};
use super::pipeline::Pipeline;
use super::slabs::Slabs;
use crate::scene::Interpolation;

/// Two half floats a voxel, which every adapter can interpolate.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg16Float;
/// Bytes of a voxel.
pub const VOXEL_BYTES: u64 = 4;
/// Bytes of the buffer through which voxels come into the texture: no adapter needs to write it from a
/// shader.
const SLAB_BYTES: u64 = 16 << 20;
/// Loop iterations that a voxel costs, about: bins, column, Newton's method.
const VOXEL_WORK: u64 = 8;

/// A volume over the box of the active cells.
///
/// **Shape**: x fastest, then y, then depth; voxel n of N along an axis has its middle at (n + 1/2) / N of
/// the box.
pub struct Volume {
    /// Voxels along x, y and depth.
    pub size: [u32; 3],
    /// Levels of the texture: the volume, and those of its average pyramid.
    pub levels: u32,
    /// Two half floats a voxel: the value, as a part of the range that it was filled with, times
    /// presence; and presence, 1 in a drawn cell and 0 elsewhere.
    pub texture: wgpu::Texture,
    /// What shaders know of it: a [`VolumeInfo`].
    pub info: wgpu::Buffer,
}

impl Volume {
    /// An empty volume.
    pub fn new(gpu: &Gpu, size: [u32; 3], levels: u32) -> Self {
        let [width, height, depth_or_array_layers] = size;
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("resampled grid"),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers,
            },
            mip_level_count: levels,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: FORMAT,
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        Self {
            size,
            levels,
            texture,
            info: gpu.uniform("volume", &<VolumeInfo as bytemuck::Zeroable>::zeroed()),
        }
    }

    /// Bytes of a volume with so many levels.
    pub fn bytes(size: [u32; 3], levels: u32) -> u64 {
        (0..levels)
            .map(|level| {
                let voxels = level_size(size, level).map(u64::from);
                VOXEL_BYTES * voxels.iter().product::<u64>()
            })
            .sum()
    }

    /// A view of one level.
    pub fn level(&self, level: u32) -> wgpu::TextureView {
        self.texture.create_view(&wgpu::TextureViewDescriptor {
            base_mip_level: level,
            mip_level_count: Some(1),
            ..Default::default()
        })
    }

    /// Copies a level back: a word a voxel, value times presence in its low half.
    ///
    /// # Errors
    /// When the device reports an error.
    pub fn read(&self, gpu: &Gpu, level: u32) -> Result<Vec<u32>, GpuError> {
        let size = level_size(self.size, level);
        let row = padded_row(size[0]);
        let slab = Slab {
            first: [0; 3],
            row,
            size,
            level,
        };
        let staging = gpu.staging(slab_bytes(row, size[1], size[2]));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let (texture, buffer) = self.copy_places(&slab, &staging);
        encoder.copy_texture_to_buffer(texture, buffer, extent(size));
        gpu.queue.submit([encoder.finish()]);
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&gpu.map(&staging)?);
        let rows = words.chunks_exact(row as usize);
        Ok(rows.flat_map(|r| &r[..size[0] as usize]).copied().collect())
    }

    /// Makes the voxels of a level by `dispatch`, which writes a slab of them to a buffer; false where it
    /// was cancelled.
    ///
    /// # Errors
    /// When the device reports an error.
    pub fn make_level(
        &self,
        slabs: &mut Slabs<'_>,
        level: u32,
        dispatch: &dyn Fn(&mut wgpu::CommandEncoder, &Slab, &wgpu::Buffer),
    ) -> Result<bool, GpuError> {
        let size = level_size(self.size, level);
        let row = padded_row(size[0]);
        let row_bytes = slab_bytes(row, 1, RUN);
        let most_rows = (SLAB_BYTES / row_bytes).clamp(1, u64::from(size[1])) as u32;
        let voxels = slabs
            .gpu
            .scratch("voxels", row_bytes * u64::from(most_rows));
        slabs.cover(size, [most_rows, RUN], VOXEL_WORK, &|encoder, slab| {
            let slab = Slab {
                level,
                row,
                ..*slab
            };
            let [_, rows, slices] = slab.size;
            encoder.clear_buffer(&voxels, 0, Some(slab_bytes(row, rows, slices)));
            dispatch(encoder, &slab, &voxels);
            self.take(&slab, &voxels, encoder);
        })
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
            bytes_per_row: Some(VOXEL_BYTES as u32 * slab.row),
            rows_per_image: Some(slab.size[1]),
        };
        (texture, wgpu::TexelCopyBufferInfo { buffer, layout })
    }
}

/// Voxels of a level along each axis.
pub fn level_size(size: [u32; 3], level: u32) -> [u32; 3] {
    size.map(|n| (n >> level).max(1))
}

/// Words of a row in a slab: copies want whole multiples of 256 bytes.
fn padded_row(voxels: u32) -> u32 {
    voxels.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT / VOXEL_BYTES as u32)
}

fn slab_bytes(row: u32, rows: u32, slices: u32) -> u64 {
    VOXEL_BYTES * u64::from(row) * u64::from(rows) * u64::from(slices)
}

fn extent([width, height, depth_or_array_layers]: [u32; 3]) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers,
    }
}

/// Fills volumes by point location.
pub struct Resampler {
    fill: Pipeline,
}

impl Resampler {
    /// Compiles the shader.
    ///
    /// # Errors
    /// When the driver refuses it.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            fill: Pipeline::variant(gpu, "resample", "fill", &[])?,
        })
    }

    /// Fills the first level of a volume with the field that the grid shows; false where it was
    /// cancelled, and the volume is worth nothing then.
    ///
    /// `range` has the values that are stored as 0 and 1.
    ///
    /// # Errors
    /// When the device reports an error.
    pub fn fill(
        &self,
        slabs: &mut Slabs<'_>,
        grid: &GpuGrid,
        volume: &Volume,
        range: [f64; 2],
        interpolation: Interpolation,
    ) -> Result<bool, GpuError> {
        let gpu = slabs.gpu;
        let info = volume_info(grid, volume.size, range, interpolation);
        gpu.queue
            .write_buffer(&volume.info, 0, bytemuck::bytes_of(&info));
        let grid = grid.bind(gpu);
        volume.make_level(slabs, 0, &|encoder, slab, voxels| {
            let slab_info = gpu.uniform("slab", slab);
            let own = [
                volume.info.as_entire_binding(),
                slab_info.as_entire_binding(),
                voxels.as_entire_binding(),
            ];
            let groups = [(1, &grid), (3, &gpu.bind(&self.fill.own, &own))];
            let [width, height, _] = slab.size;
            self.fill.dispatch(encoder, &groups, [width, height, 1]);
        })
    }
}

fn volume_info(
    grid: &GpuGrid,
    size: [u32; 3],
    range: [f64; 2],
    interpolation: Interpolation,
) -> VolumeInfo {
    let [from, to] = grid.bounds;
    VolumeInfo {
        box_low: from.as_vec3().to_array(),
        value_low: range[0] as f32,
        box_extent: (to - from)
            .max(glam::DVec3::splat(1e-6))
            .as_vec3()
            .to_array(),
        value_scale: layout::per_unit(range),
        size,
        interpolation: layout::interpolation(interpolation),
    }
}
