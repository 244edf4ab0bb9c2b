//! One submission of a tile: its passes, with bind groups and timestamps in place.

use super::device::Gpu;
use super::pipeline::Pipeline;

/// One round of a tile, as a strategy records it: one submission that takes every ray further.
pub struct Round<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// Pixels of the tile.
    pub size: [u32; 2],
    /// True in the tile's first round, before which its rays have no state.
    pub starts: bool,
    /// Rays of the tile that have not ended.
    pub rays_left: u32,
    /// Rays that paused within what they were doing in the round before.
    pub paused: u64,
    /// Of these, rays that lost their way.
    pub strayed: u64,
    pub(super) groups: &'a [wgpu::BindGroup; 3],
    pub(super) queries: Option<&'a wgpu::QuerySet>,
}

/// Where a pass stands in its round; the first and the last one take the time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// The round's only pass.
    Only,
    /// The first of several.
    First,
    /// Neither first nor last.
    Between,
    /// The last of several.
    Last,
}

impl Place {
    /// The place of pass `n` of so many.
    pub fn of(n: usize, passes: usize) -> Self {
        match (n == 0, n + 1 == passes) {
            (true, true) => Self::Only,
            (true, false) => Self::First,
            (false, true) => Self::Last,
            (false, false) => Self::Between,
        }
    }
}

impl Round<'_> {
    /// Query set with the indices that a pass writes its begin and end to.
    fn times(&self, place: Place) -> Option<(&wgpu::QuerySet, Option<u32>, Option<u32>)> {
        let begin = matches!(place, Place::Only | Place::First).then_some(0);
        let end = matches!(place, Place::Only | Place::Last).then_some(1);
        let set = self.queries.filter(|_| begin.is_some() || end.is_some())?;
        Some((set, begin, end))
    }

    /// Records a dispatch that covers `size` invocations; `own` is bind group 3.
    pub fn compute(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pipeline: &Pipeline,
        own: Option<&wgpu::BindGroup>,
        size: [u32; 2],
        place: Place,
    ) {
        let times = self.times(place);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("rays"),
            timestamp_writes: times.map(|(query_set, begin, end)| {
                wgpu::ComputePassTimestampWrites {
                    query_set,
                    beginning_of_pass_write_index: begin,
                    end_of_pass_write_index: end,
                }
            }),
        });
        for (n, group) in (0..).zip(self.groups.iter().chain(own)) {
            pass.set_bind_group(n, group, &[]);
        }
        pipeline.record(&mut pass, [size[0], size[1], 1]);
    }

    /// Begins a render pass over the tile, its bind groups set; the caller sets the pipeline.
    pub fn raster<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        color: &wgpu::TextureView,
        depth: &wgpu::TextureView,
        place: Place,
    ) -> wgpu::RenderPass<'e> {
        let times = self.times(place);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("faces"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: color,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            timestamp_writes: times.map(|(query_set, begin, end)| {
                wgpu::RenderPassTimestampWrites {
                    query_set,
                    beginning_of_pass_write_index: begin,
                    end_of_pass_write_index: end,
                }
            }),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        let [width, height] = self.size.map(|n| n as f32);
        pass.set_viewport(0.0, 0.0, width, height, 0.0, 1.0);
        pass.set_scissor_rect(0, 0, self.size[0], self.size[1]);
        for (n, group) in (0..).zip(self.groups) {
            pass.set_bind_group(n, group, &[]);
        }
        pass
    }
}
