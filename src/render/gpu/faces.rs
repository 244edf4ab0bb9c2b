//! Faces of cells on the device, and the boundary faces rasterized: where the rays of a tile come in and go out.

use std::sync::Arc;

use super::device::Gpu;
use super::grid_upload::GpuGrid;
use super::pipeline::RasterPipeline;
use super::round::{Place, Round};
use crate::model::Grid;
use crate::render::RenderError;
use crate::render::plan::faces::face_numbers;

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

/// Face number + 1 (0 for none) and the bits of the distance along the ray as f32.
pub(super) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;

/// Faces by number on the device.
#[derive(Clone)]
pub struct FaceList {
    /// Of the drawn cells that the list was made of.
    pub revision: u64,
    /// `(column * nk + layer) * 6 + face` of each.
    pub numbers: wgpu::Buffer,
    /// The same in memory.
    pub listed: Arc<[u32]>,
    /// How many there are.
    pub count: u32,
}

impl FaceList {
    /// A list of the drawn cells that `grid` has now.
    ///
    /// # Errors
    /// When it exceeds what the adapter holds.
    pub fn new(gpu: &Gpu, grid: &GpuGrid, numbers: &[u32]) -> Result<Self, RenderError> {
        Ok(Self {
            revision: grid.revisions.drawn,
            numbers: gpu.storage("faces", numbers)?,
            listed: numbers.into(),
            count: numbers.len() as u32,
        })
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.numbers.size()
    }
}

/// The boundary faces of the drawn cells: one list for all that draw them.
#[derive(Default)]
pub struct BoundaryFaces {
    list: Option<FaceList>,
}

impl BoundaryFaces {
    /// Lists the faces anew where the drawn cells have changed.
    ///
    /// # Errors
    /// When the list exceeds what the adapter holds.
    pub fn update(
        &mut self,
        gpu: &Gpu,
        model: &Grid,
        grid: &GpuGrid,
        drawn: &[bool],
    ) -> Result<&FaceList, RenderError> {
        let known = self
            .list
            .take()
            .filter(|l| l.revision == grid.revisions.drawn);
        let list = match known {
            Some(known) => known,
            None => FaceList::new(
                gpu,
                grid,
                &face_numbers(model, &model.boundary_faces(drawn))?,
            )?,
        };
        Ok(self.list.insert(list))
    }
}

/// Draws boundary faces.
pub struct FaceRaster {
    pipeline: RasterPipeline,
    bound: Option<Bound>,
}

struct Bound {
    list: FaceList,
    margin: f32,
    /// By [`FaceMode`].
    groups: Vec<wgpu::BindGroup>,
}

/// What a tile's faces are drawn into.
pub struct FaceTarget {
    size: [u32; 2],
    /// Two words a pixel: face number + 1, and the bits of its distance.
    pub met: wgpu::TextureView,
    pub(super) depth: wgpu::TextureView,
}

impl FaceRaster {
    /// Compiles the shader.
    ///
    /// # Errors
    /// When the driver refuses it.
    pub fn new(gpu: &Gpu) -> Result<Self, RenderError> {
        Ok(Self {
            pipeline: RasterPipeline::new(gpu, "faces", &[FORMAT])?,
            bound: None,
        })
    }

    /// Takes the faces to draw.
    ///
    /// `margin` is how far, in world space, the next entry of a peel may lie before the end of the
    /// last one.
    pub fn update(&mut self, gpu: &Gpu, faces: Option<&FaceList>, margin: f32) {
        let is_of = |b: &Bound, f: &FaceList| b.list.revision == f.revision && b.margin == margin;
        let known = self.bound.take();
        self.bound = faces.map(|faces| match known.filter(|b| is_of(b, faces)) {
            Some(known) => known,
            None => self.bind(gpu, faces, margin),
        });
    }

    fn bind(&self, gpu: &Gpu, faces: &FaceList, margin: f32) -> Bound {
        let group = |mode: u32| {
            let info = gpu.uniform("faces info", &[mode, margin.to_bits()]);
            let resources = [info.as_entire_binding(), faces.numbers.as_entire_binding()];
            gpu.bind(&self.pipeline.own, &resources)
        };
        Bound {
            list: faces.clone(),
            margin,
            groups: (0..MODES).map(group).collect(),
        }
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
        if let Some(bound) = &self.bound {
            pass.set_pipeline(&self.pipeline.pipeline);
            pass.set_bind_group(3, &bound.groups[mode as usize], &[]);
            pass.draw(0..6 * bound.list.count, 0..1);
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

pub(super) fn texture(gpu: &Gpu, size: [u32; 2], format: wgpu::TextureFormat) -> wgpu::TextureView {
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
    let texture = gpu.flat_texture("faces", size, format, usage);
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
