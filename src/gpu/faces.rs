//! The boundary faces of the drawn cells, rasterized: where the rays of a tile come in and go out.

use rayon::prelude::*;

use super::device::{Gpu, GpuError};
use super::frame::{Place, Round};
use super::grid_upload::GpuGrid;
use super::pipeline::RasterPipeline;
use crate::model::Grid;

/// Which face a pixel gets; the order is that of the shader's constants.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaceMode {
    /// The next entry behind what the ray's state says is done.
    Peel,
    /// The first entry.
    First,
    /// The last exit.
    Last,
}

const MODES: u32 = 3;

/// Face number + 1 (0 for none) and the bits of the distance from the eye as f32.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;

/// The list of boundary faces on the device, and the pipeline that draws it.
pub struct BoundaryFaces {
    pipeline: RasterPipeline,
    listed: Option<Listed>,
}

struct Listed {
    /// Version of the drawn cells that the list was made of.
    drawn: u64,
    margin: f32,
    list: wgpu::Buffer,
    count: u32,
    /// By [`FaceMode`].
    groups: Vec<wgpu::BindGroup>,
}

/// What a tile's faces are drawn into.
pub struct FaceTarget {
    size: [u32; 2],
    /// Two words a pixel: face number + 1, and the bits of its distance.
    pub met: wgpu::TextureView,
    depth: wgpu::TextureView,
}

impl BoundaryFaces {
    /// Compiles the shader.
    ///
    /// # Errors
    /// When the driver refuses it.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            pipeline: RasterPipeline::new(gpu, "faces", &[FORMAT])?,
            listed: None,
        })
    }

    /// Lists the faces anew where the drawn cells have changed.
    ///
    /// `margin` is how far, in world space, the next entry of a peel may lie before the end of the
    /// last one.
    ///
    /// # Errors
    /// When the list exceeds what the adapter holds.
    pub fn update(
        &mut self,
        gpu: &Gpu,
        model: &Grid,
        grid: &GpuGrid,
        drawn: &[bool],
        margin: f32,
    ) -> Result<(), GpuError> {
        let version = grid.versions.drawn;
        let known = self.listed.take().filter(|l| l.drawn == version);
        if known.as_ref().is_some_and(|l| l.margin == margin) {
            self.listed = known;
            return Ok(());
        }
        let (list, count) = match known {
            Some(known) => (known.list, known.count),
            None => {
                let faces = numbers(model, drawn)?;
                (gpu.storage("boundary faces", &faces)?, faces.len() as u32)
            }
        };
        let group = |mode: u32| {
            let info = gpu.uniform("faces info", &[mode, margin.to_bits()]);
            let resources = [info.as_entire_binding(), list.as_entire_binding()];
            gpu.bind(&self.pipeline.own, &resources)
        };
        self.listed = Some(Listed {
            drawn: version,
            margin,
            groups: (0..MODES).map(group).collect(),
            count,
            list,
        });
        Ok(())
    }

    /// Bytes of the list.
    pub fn bytes(&self) -> u64 {
        self.listed.as_ref().map_or(0, |l| l.list.size())
    }

    /// Records a pass that draws the faces of a tile; nothing is met before [`Self::update`].
    pub fn draw(
        &self,
        round: &Round<'_>,
        encoder: &mut wgpu::CommandEncoder,
        target: &FaceTarget,
        mode: FaceMode,
        place: Place,
    ) {
        let mut pass = round.raster(encoder, &target.met, &target.depth, place);
        if let Some(listed) = &self.listed {
            pass.set_pipeline(&self.pipeline.pipeline);
            pass.set_bind_group(3, &listed.groups[mode as usize], &[]);
            pass.draw(0..6 * listed.count, 0..1);
        }
    }
}

impl FaceTarget {
    /// A target for tiles of at least this size; `existing` is used again where it is large enough.
    pub fn fitting(existing: Option<Self>, gpu: &Gpu, size: [u32; 2]) -> Self {
        let largest = existing
            .as_ref()
            .map_or(size, |e| [e.size[0].max(size[0]), e.size[1].max(size[1])]);
        match existing {
            Some(target) if target.size == largest => target,
            _ => Self {
                size: largest,
                met: texture(gpu, largest, FORMAT),
                depth: texture(gpu, largest, wgpu::TextureFormat::Depth32Float),
            },
        }
    }
}

fn texture(gpu: &Gpu, size: [u32; 2], format: wgpu::TextureFormat) -> wgpu::TextureView {
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
    let texture = gpu.flat_texture("faces", size, format, usage);
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// `(column * nk + layer) * 6 + face` of each boundary face.
fn numbers(model: &Grid, drawn: &[bool]) -> Result<Vec<u32>, GpuError> {
    let dims = model.dims();
    let needed = 6 * dims.cells() as u64;
    if needed >= u64::from(u32::MAX) {
        return Err(GpuError::TooLarge {
            what: "numbering the faces",
            needed,
            limit: u64::from(u32::MAX),
        });
    }
    let number = |(cell, face): &(crate::model::Ijk, crate::model::topology::Face)| {
        let column = cell.i + dims.ni * cell.j;
        ((column * dims.nk + cell.k) * 6 + *face as usize) as u32
    };
    Ok(model.boundary_faces(drawn).par_iter().map(number).collect())
}
