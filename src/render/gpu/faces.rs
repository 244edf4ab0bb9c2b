//! Faces of cells on the device, and the boundary faces rasterized: where the rays of a tile come in and go out.

use std::sync::Arc;

use super::device::Gpu;
use super::grid_upload::{Constants, GpuGrid};
use super::pipeline::RasterPipeline;
use super::round::{Place, Round};
use crate::model::Grid;
use crate::render::RenderError;
use crate::render::plan::faces::face_numbers;
use crate::render::plan::visible::{can_be_passed, visible_faces};
use crate::view::View;

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
    /// Of the cells that the list was made of; no two lists of one grid have the same.
    pub revision: u64,
    /// `(column * nk + layer) * 6 + face` of each.
    pub numbers: wgpu::Buffer,
    /// The same in memory.
    pub listed: Arc<[u32]>,
    /// How many there are.
    pub count: u32,
}

impl FaceList {
    /// A list of the cells of a revision.
    ///
    /// # Errors
    /// When it exceeds what the adapter holds.
    pub fn new(gpu: &Gpu, revision: u64, numbers: &[u32]) -> Result<Self, RenderError> {
        Ok(Self {
            revision,
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

/// The boundary faces of the drawn cells and of the visible ones: one list each for all that go by them.
#[derive(Default)]
pub struct BoundaryFaces {
    drawn: Option<FaceList>,
    /// By their revision; no list where rays meet all drawn cells.
    visible: Option<(u64, Option<FaceList>)>,
}

impl BoundaryFaces {
    /// The faces of the drawn cells, listed anew where these have changed.
    ///
    /// # Errors
    /// When the list exceeds what the adapter holds.
    pub fn of_drawn(
        &mut self,
        gpu: &Gpu,
        model: &Grid,
        grid: &GpuGrid,
        drawn: &[bool],
    ) -> Result<&FaceList, RenderError> {
        // Even; those of visible cells are odd.
        let revision = 2 * grid.revisions.drawn;
        let known = self.drawn.take().filter(|l| l.revision == revision);
        let list = match known {
            Some(known) => known,
            None => {
                let faces = face_numbers(model, &model.boundary_faces(drawn))?;
                FaceList::new(gpu, revision, &faces)?
            }
        };
        Ok(self.drawn.insert(list))
    }

    /// Tells `grid` which cells rays meet in a view, and gives the faces of these: the visible cells, where rays can pass
    /// the others, or all of the drawn ones.
    ///
    /// # Errors
    /// As [`Self::of_drawn`].
    pub fn of_met(
        &mut self,
        gpu: &Gpu,
        model: &Grid,
        grid: &mut GpuGrid,
        drawn: &[bool],
        view: &View,
    ) -> Result<Option<&FaceList>, RenderError> {
        let passes =
            can_be_passed(view, &grid.facts) && self.has_visible(gpu, model, grid, view)?;
        grid.meet_all(gpu, !passes);
        if passes {
            return Ok(self.visible.as_ref().and_then(|(_, list)| list.as_ref()));
        }
        self.of_drawn(gpu, model, grid, drawn).map(Some)
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        let visible = self.visible.iter().filter_map(|(_, list)| list.as_ref());
        let lists = self.drawn.iter().chain(visible);
        lists.map(FaceList::bytes).sum()
    }

    /// True where rays meet the visible cells alone; their list is made where it is not there.
    fn has_visible(
        &mut self,
        gpu: &Gpu,
        model: &Grid,
        grid: &mut GpuGrid,
        view: &View,
    ) -> Result<bool, RenderError> {
        let revision = grid.revisions.visible;
        let known = self.visible.take().filter(|(of, _)| *of == revision);
        let visible = match known {
            Some(known) => known,
            None => {
                let list = match grid.visible_words(view) {
                    Some(words) => {
                        grid.meet(gpu, Some(&words))?;
                        let faces = visible_faces(model, &words)?;
                        Some(FaceList::new(gpu, 2 * revision + 1, &faces)?)
                    }
                    None => None,
                };
                (revision, list)
            }
        };
        Ok(self.visible.insert(visible).1.is_some())
    }
}

/// Draws boundary faces.
#[derive(Default)]
pub struct FaceRaster {
    /// Compiled when it is first asked for.
    pipeline: Option<Arc<RasterPipeline>>,
    bound: Option<Bound>,
}

struct Bound {
    list: FaceList,
    margin: f32,
    /// By [`FaceMode`].
    groups: Vec<wgpu::BindGroup>,
}

impl Bound {
    fn new(gpu: &Gpu, pipeline: &RasterPipeline, faces: &FaceList, margin: f32) -> Self {
        let group = |mode: u32| {
            let info = gpu.uniform("faces info", &[mode, margin.to_bits()]);
            let resources = [info.as_entire_binding(), faces.numbers.as_entire_binding()];
            gpu.bind(&pipeline.own, &resources)
        };
        Self {
            list: faces.clone(),
            margin,
            groups: (0..MODES).map(group).collect(),
        }
    }
}

/// What a tile's faces are drawn into.
pub struct FaceTarget {
    size: [u32; 2],
    /// Two words a pixel: face number + 1, and the bits of its distance.
    pub met: wgpu::TextureView,
    pub(super) depth: wgpu::TextureView,
}

impl FaceRaster {
    /// Takes the faces to draw of a grid with these constants.
    ///
    /// `margin` is how far, in world space, the next entry of a peel may lie before the end of the
    /// last one.
    ///
    /// # Errors
    /// When the driver refuses the shader.
    pub fn update(
        &mut self,
        gpu: &Gpu,
        grid: Constants,
        faces: Option<&FaceList>,
        margin: f32,
    ) -> Result<(), RenderError> {
        let pipeline = RasterPipeline::variant(gpu, "faces", &[FORMAT], &[grid.storage()])?;
        let is_of = |b: &Bound, f: &FaceList| b.list.revision == f.revision && b.margin == margin;
        let known = self.bound.take();
        self.bound = faces.map(|faces| match known.filter(|b| is_of(b, faces)) {
            Some(known) => known,
            None => Bound::new(gpu, &pipeline, faces, margin),
        });
        self.pipeline = Some(pipeline);
        Ok(())
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
        if let (Some(pipeline), Some(bound)) = (&self.pipeline, &self.bound) {
            pass.set_pipeline(&pipeline.pipeline);
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
