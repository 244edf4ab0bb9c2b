//! Surfaces as parts of the picture: before the rays of a part of it begin, the points at which they meet
//! surfaces are rasterized, layer by layer, and get their colors. The strategies blend them between samples.
//!
//! An opaque hull is one layer, for nothing is seen behind it; a faint one is two. Of faults each ray has the
//! nearest [`layout::SHEET_LAYERS`] sheets; farther ones are left out. Each layer that gets its colors takes its
//! place among those of the pixel by its distance.

use std::ops::Range;
use std::sync::Arc;

use super::device::Gpu;
use super::faces::{self, FORMAT, FaceList, FaceTarget};
use super::grid_upload::GpuGrid;
use super::pipeline::{Pipeline, RasterPipeline, flag};
use super::round::{Place, Round};
use crate::image::Blending;
use crate::model::Grid;
use crate::render::RenderError;
use crate::render::plan::faces::face_numbers;
use crate::render::plan::layout::{self, PaintInfo};
use crate::render::plan::light::Shading;
use crate::render::plan::surfaces::{Layer, faults, layers, palette};
use crate::render::plan::tubes::{TubePoint, TubePoints};
use crate::scene::Hull;
use crate::view::surfaces::{FAINT_BEHIND, FAINT_FRONT, faint_color};
use crate::view::{Surfaces, View};

/// Names and values of the `override` constants of shaders that blend surfaces.
pub fn constants(surfaces: Surfaces) -> [(&'static str, f64); 6] {
    [
        ("SURFACES", flag(surfaces.are_shown())),
        ("HULL", flag(surfaces.hull == Hull::Opaque)),
        ("TUBES", flag(surfaces.wells)),
        ("LAYERS", f64::from(layers(surfaces).len().max(1) as u32)),
        ("CELL_EDGES", flag(surfaces.cell_edges)),
        ("SOLID", flag(surfaces.solid)),
    ]
}

/// Finds surface points and gives them colors.
pub struct SurfacePainter {
    /// Compiled when they are first asked for.
    peel: Option<Arc<RasterPipeline>>,
    paint: Option<Arc<Pipeline>>,
    surfaces: Surfaces,
    shown: Option<ShownSurfaces>,
    gap: f32,
    blending: Blending,
    /// Color of a faint hull.
    faint: [f32; 4],
    work: u64,
    targets: Vec<Option<FaceTarget>>,
    /// Where rays meet wells, and the points of a part of the image.
    tubes: Option<TubePoints>,
    tube_target: Option<wgpu::TextureView>,
    /// What is bound in place of a layer before the first one.
    nothing: wgpu::TextureView,
}

/// The surfaces that are shown.
struct ShownSurfaces {
    revision: u64,
    hull: Option<FaceList>,
    /// Faces that are sheets by themselves.
    sheets: Option<FaceList>,
    /// Of each the number and that of its color.
    fault_faces: wgpu::Buffer,
    faults: u32,
}

impl SurfacePainter {
    /// With nothing to find.
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            peel: None,
            paint: None,
            surfaces: Surfaces::default(),
            shown: None,
            gap: 0.0,
            blending: Blending::default(),
            faint: [0.0; 4],
            work: 0,
            targets: Vec::new(),
            tubes: None,
            tube_target: None,
            nothing: faces::texture(gpu, [1; 2], FORMAT),
        }
    }

    /// True where the boundary faces of all drawn cells are the hull.
    pub fn shares_faces(view: &View) -> bool {
        view.style.surfaces.has_hull() && view.shown.cells.ghosts.is_none()
    }

    /// Brings up to date what is shown of `model` (the case's grid). `boundary` are the boundary faces of all
    /// drawn cells, for a view that [shares](Self::shares_faces) them; `work` is what the light of a sample
    /// costs.
    ///
    /// # Errors
    /// When a list exceeds what the adapter holds, or the driver refuses a shader.
    pub fn update(
        &mut self,
        gpu: &Gpu,
        model: &Grid,
        grid: &GpuGrid,
        view: &View,
        boundary: Option<&FaceList>,
        work: u32,
    ) -> Result<(), RenderError> {
        self.surfaces = view.style.surfaces;
        let shading = Shading::of(&view.style.lighting);
        let of_grid = [grid.constants().storage()];
        self.peel = Some(RasterPipeline::variant(gpu, "peel", &[FORMAT], &of_grid)?);
        let constants = [&of_grid[..], &constants(self.surfaces), &shading.pairs()].concat();
        self.paint = Some(Pipeline::variant(gpu, "paint", "main", &constants)?);
        let is_known = |s: &ShownSurfaces| s.revision == grid.revisions.surfaces;
        let shown = match self.shown.take().filter(is_known) {
            Some(known) => known,
            None => ShownSurfaces::new(gpu, model, grid, view, boundary)?,
        };
        self.shown = Some(shown);
        self.gap = view.fault_gap() as f32;
        self.blending = view.style.blending;
        let [r, g, b] = view
            .style
            .blending
            .of_srgb(faint_color(view.style.background));
        self.faint = [r, g, b, 1.0].map(|v| v as f32);
        self.work = u64::from(layout::PAINT_WORK + work);
        self.tubes = TubePoints::of(view);
        Ok(())
    }

    /// Layers that a ray can have.
    pub fn layers(&self) -> u32 {
        layers(self.surfaces).len() as u32
    }

    /// Loop iterations that a pixel of a layer costs, about.
    pub fn work(&self) -> u64 {
        self.work
    }

    /// Records the passes that find the points of all layers in a part of the image, whose upper left pixel this is.
    pub fn peel(
        &mut self,
        round: &Round<'_>,
        origin: [u32; 2],
        encoder: &mut wgpu::CommandEncoder,
    ) {
        let tubes = self.tubes.as_ref();
        self.tube_target = tubes.map(|points| tube_target(round.gpu, points, origin, round.size));
        let (Some(shown), Some(peel)) = (&self.shown, &self.peel) else {
            return;
        };
        let layers = layers(self.surfaces);
        self.targets.resize_with(layers.len(), || None);
        let mut before = self.nothing.clone();
        let passes = layers.iter().filter(|layer| **layer != Layer::Tube).count();
        // Tubes come last, and are not rasterized.
        let layers = &layers[..passes];
        for (n, (layer, slot)) in layers.iter().zip(&mut self.targets).enumerate() {
            let target = FaceTarget::fitting(slot.take(), round.gpu, round.size);
            // Only of the hull both sides of a fault are there to choose from.
            let (faces, number, behind) = match layer {
                Layer::Sheet(number) => (&shown.sheets, *number, 0.0),
                _ => (&shown.hull, 0, self.gap),
            };
            let is_last = u32::from(*layer == Layer::Ground);
            let info = [number, self.gap.to_bits(), behind.to_bits(), is_last];
            let info = round.gpu.uniform("peel info", &info);
            let place = Place::of(n, passes);
            let mut pass = round.raster(encoder, &target.met, &target.depth, place);
            if let Some(faces) = faces {
                let own = [
                    info.as_entire_binding(),
                    faces.numbers.as_entire_binding(),
                    wgpu::BindingResource::TextureView(&before),
                ];
                let own = round.gpu.bind(&peel.own, &own);
                pass.set_pipeline(&peel.pipeline);
                pass.set_bind_group(3, &own, &[]);
                pass.draw(0..6 * faces.count, 0..1);
            }
            drop(pass);
            before = target.met.clone();
            *slot = Some(target);
        }
    }

    /// Records the pass that gives some rows of a layer their colors.
    pub fn paint(
        &self,
        layer: u32,
        rows: &Range<u32>,
        round: &Round<'_>,
        encoder: &mut wgpu::CommandEncoder,
    ) {
        let kinds = layers(self.surfaces);
        let points = match kinds.get(layer as usize) {
            Some(Layer::Tube) => self.tube_target.as_ref(),
            _ => {
                let target = self.targets.get(layer as usize).and_then(Option::as_ref);
                target.map(|target| &target.met)
            }
        };
        let (Some(shown), Some(points), Some(paint)) = (&self.shown, points, &self.paint) else {
            return;
        };
        let (look, [facing, edge_on]) = match kinds.get(layer as usize) {
            Some(Layer::Front) => (layout::LOOK_FAINT, FAINT_FRONT),
            Some(Layer::Ground) => (layout::LOOK_FAINT, FAINT_BEHIND),
            Some(Layer::Tube) => (layout::LOOK_TUBE, [1.0; 2]),
            _ => (layout::LOOK_COLORED, [1.0; 2]),
        };
        let info = PaintInfo {
            palette: palette(self.blending),
            faint: self.faint,
            faults: shown.faults,
            layer,
            first_row: rows.start,
            rows: rows.len() as u32,
            look,
            facing: facing as f32,
            edge_on: edge_on as f32,
            reserved: 0,
        };
        let info = round.gpu.uniform("paint info", &info);
        let own = [
            info.as_entire_binding(),
            wgpu::BindingResource::TextureView(points),
            shown.fault_faces.as_entire_binding(),
        ];
        let own = round.gpu.bind(&paint.own, &own);
        let size = [round.size[0], rows.len() as u32];
        round.compute(encoder, paint, Some(&own), size, Place::Only);
    }

    /// Bytes of the lists that are this one's own.
    pub fn bytes(&self, view: &View) -> u64 {
        self.shown.as_ref().map_or(0, |shown| {
            let faults = shown.fault_faces.size();
            let hull = shown.hull.iter().filter(|_| !Self::shares_faces(view));
            faults + hull.chain(&shown.sheets).map(FaceList::bytes).sum::<u64>()
        })
    }
}

/// The points of tubes in a part of the image, as `shaders/paint.wgsl` reads them.
fn tube_target(
    gpu: &Gpu,
    points: &TubePoints,
    origin: [u32; 2],
    size: [u32; 2],
) -> wgpu::TextureView {
    let [width, height] = size;
    let texel = |point: TubePoint| {
        let [r, g, b] = point
            .color
            .map(|v| (v.clamp(0.0, 1.0) * 1023.0).round() as u32);
        [1 << 30 | r << 20 | g << 10 | b, point.distance.to_bits()]
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [origin[0] + x, origin[1] + y]));
    let texels: Vec<[u32; 2]> = pixels
        .map(|pixel| points.at(pixel).map_or([0; 2], texel))
        .collect();
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let texture = gpu.flat_texture("tubes", size, FORMAT, usage);
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(8 * width),
        rows_per_image: None,
    };
    let bytes = bytemuck::cast_slice(&texels);
    gpu.queue
        .write_texture(texture.as_image_copy(), bytes, layout, texture.size());
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

impl ShownSurfaces {
    fn new(
        gpu: &Gpu,
        model: &Grid,
        grid: &GpuGrid,
        view: &View,
        boundary: Option<&FaceList>,
    ) -> Result<Self, RenderError> {
        let surfaces = view.style.surfaces;
        let faults = match surfaces.faults {
            true => faults(model, view)?
                .into_iter()
                .map(<[u32; 2]>::from)
                .collect(),
            false => Vec::new(),
        };
        let hull = match (surfaces.has_hull(), boundary) {
            (false, _) => None,
            (true, Some(boundary)) if SurfacePainter::shares_faces(view) => Some(boundary.clone()),
            (true, _) => {
                let faces = face_numbers(model, &view.hull_faces(model))?;
                Some(FaceList::new(gpu, grid.revisions.surfaces, &faces)?)
            }
        };
        let sheets = match surfaces.hull {
            Hull::Opaque => None,
            _ => {
                let numbers: Vec<u32> = faults.iter().map(|[face, _]| *face).collect();
                Some(FaceList::new(gpu, grid.revisions.surfaces, &numbers)?)
            }
        };
        Ok(Self {
            revision: grid.revisions.surfaces,
            hull,
            sheets,
            fault_faces: gpu.storage("fault faces", &faults)?,
            faults: faults.len() as u32,
        })
    }
}
