//! The image on the device, and its way back.

use super::device::Gpu;
use crate::render::RenderError;

/// A texture of premultiplied RGBA that shaders write.
pub fn create(gpu: &Gpu, size: [u32; 2]) -> wgpu::Texture {
    let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_SRC;
    gpu.flat_texture("target", size, wgpu::TextureFormat::Rgba32Float, usage)
}

/// Copies the image back in bands, so that the staging buffer stays small.
pub fn read(
    gpu: &Gpu,
    target: &wgpu::Texture,
    [width, height]: [u32; 2],
) -> Result<Vec<[f32; 4]>, RenderError> {
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
