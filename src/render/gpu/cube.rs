//! A cube beside the model on the device, as `shaders/shared/cube.wgsl` reads it.

use super::device::Gpu;
use crate::case;
use crate::render::RenderError;
use crate::render::plan::GridFacts;
use crate::render::plan::cube::{CubeNumbers, cube_range, cube_table};
use crate::render::revisions::Revisions;
use crate::view::View;

const TABLE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// The textures of a cube, or what is bound where there is none.
pub struct GpuCube {
    /// Value times presence, and presence.
    voxels: wgpu::TextureView,
    /// Its transfer function and its numbers.
    table: wgpu::TextureView,
    /// Of the voxels and the table, where they are of a cube, and bytes of the voxels.
    held: Option<u64>,
    look: Option<u64>,
    bytes: u64,
}

impl GpuCube {
    /// None.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn none(gpu: &Gpu) -> Result<Self, RenderError> {
        Ok(Self {
            voxels: voxels(gpu, [1; 3], &[[0; 2]]),
            table: gpu.table("cube", TABLE, &[[0.0f32; 4]])?,
            held: None,
            look: None,
            bytes: 0,
        })
    }

    /// Brings up to date what a view shows, or frees it.
    ///
    /// # Errors
    /// When the cube does not fit.
    pub fn update(
        &mut self,
        gpu: &Gpu,
        grid: &GridFacts,
        view: &View,
        revisions: Revisions,
    ) -> Result<(), RenderError> {
        let Some(shown) = &view.shown.cube else {
            if self.held.is_some() {
                *self = Self::none(gpu)?;
            }
            return Ok(());
        };
        // Around zero half floats are finest.
        let [low, high] = cube_range(&shown.cube);
        let stored = [0.5 * (low + high), high];
        if self.held != Some(revisions.cube) {
            let limit = u64::from(gpu.device.limits().max_texture_dimension_3d);
            let longest = shown.cube.size.iter().max().copied().unwrap_or(0) as u64;
            if longest > limit {
                return Err(RenderError::Unsuitable {
                    adapter: gpu.info.name.clone(),
                    reason: format!("volumes are limited to {limit} samples along an axis"),
                });
            }
            let halves = halves(&shown.cube, stored);
            self.voxels = voxels(gpu, shown.cube.size.map(|n| n as u32), &halves);
            self.bytes = size_of_val(&halves[..]) as u64;
            self.held = Some(revisions.cube);
        }
        if self.look == Some(revisions.cube_look) {
            return Ok(());
        }
        let numbers = CubeNumbers::new(grid, view, shown, stored);
        let corner = |[x, y, z]: [f32; 3], more: f32| [x, y, z, more];
        let [offset, factor] = numbers.position;
        let mut texels = cube_table(view, shown);
        texels.extend(numbers.box_from_grid);
        texels.extend([
            corner(numbers.low, numbers.step),
            corner(numbers.high, 0.0),
            [offset, factor, 0.0, 0.0],
        ]);
        self.table = gpu.table("cube", TABLE, &texels)?;
        self.look = Some(revisions.cube_look);
        Ok(())
    }

    /// What is bound of it.
    pub fn views(&self) -> [wgpu::TextureView; 2] {
        [self.voxels.clone(), self.table.clone()]
    }

    /// Bytes of the voxels.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// Values, stored as 0 and 1 at the ends of a range, times presence; and presence: bits of half floats.
fn halves(cube: &case::Cube, [zero, one]: [f64; 2]) -> Vec<[u16; 2]> {
    let stored = |value: &f32| match value.is_nan() {
        true => [0; 2],
        false => {
            let part = (f64::from(*value) - zero) / (one - zero);
            [half(part as f32), half(1.0)]
        }
    };
    cube.values.iter().map(stored).collect()
}

/// Bits of the half float nearest to a number from -1 to 1.
fn half(number: f32) -> u16 {
    // Below this half floats are equally spaced.
    const LEAST_NORMAL: f32 = 1.0 / 16384.0;
    const PER_UNIT: f32 = 16_777_216.0;
    let bits = number.to_bits();
    let sign = (bits >> 16 & 0x8000) as u16;
    if number.abs() < LEAST_NORMAL {
        return sign | (number.abs() * PER_UNIT).round_ties_even() as u16;
    }
    // Exponents count from 15 instead of 127, and 13 bits of the fraction go.
    let rebased = (bits & 0x7fff_ffff) - (112 << 23);
    let even = rebased >> 13 & 1;
    sign | ((rebased + 0xfff + even) >> 13) as u16
}

fn voxels(gpu: &Gpu, size: [u32; 3], halves: &[[u16; 2]]) -> wgpu::TextureView {
    let [width, height, depth_or_array_layers] = size;
    let size = wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers,
    };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("cube"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D3,
        format: wgpu::TextureFormat::Rg16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    // A slice at a time: what is staged for one copy stays small.
    let slice = (width * height) as usize;
    for (z, slice) in (0..).zip(halves.chunks_exact(slice)) {
        let place = wgpu::TexelCopyTextureInfo {
            origin: wgpu::Origin3d { x: 0, y: 0, z },
            ..texture.as_image_copy()
        };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * width),
            rows_per_image: Some(height),
        };
        let size = wgpu::Extent3d {
            depth_or_array_layers: 1,
            ..size
        };
        gpu.queue
            .write_texture(place, bytemuck::cast_slice(slice), layout, size);
    }
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

#[cfg(test)]
mod tests {
    use half::f16;

    #[test]
    fn halves_are_those_of_the_standard() {
        let numbers = (-40_000..=40_000).map(|n| n as f32 / 40_000.0);
        let small = (-3000..3000).map(|n| n as f32 * 3.1e-8);
        for number in numbers.chain(small) {
            let (own, known) = (super::half(number), f16::from_f32(number).to_bits());
            assert_eq!(own, known, "{number}");
        }
    }
}
