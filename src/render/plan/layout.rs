//! Mirrors of the structs and constants in `shaders/shared/layout.wgsl`; a test compares them.

use bytemuck::{Pod, Zeroable};

use crate::scene::Interpolation;

/// Camera, lattice and value range of a frame.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "described where the shader reads them")]
pub struct Frame {
    pub eye: [f32; 3],
    pub step: f32,
    pub forward: [f32; 3],
    pub early_termination: f32,
    pub right: [f32; 3],
    pub value_low: f32,
    pub up: [f32; 3],
    pub value_scale: f32,
    pub grid_from_world_x: [f32; 3],
    pub width: u32,
    pub grid_from_world_y: [f32; 3],
    pub height: u32,
    pub grid_from_world_z: [f32; 3],
    pub interpolation: u32,
    pub box_low: [f32; 3],
    pub clip_count: u32,
    pub box_high: [f32; 3],
    pub opaque_cuts: u32,
    pub view_x: [f32; 3],
    pub farthest: f32,
    pub view_y: [f32; 3],
    pub world_handedness: f32,
    pub view_z: [f32; 3],
    pub grid_handedness: f32,
    pub origin_right: [f32; 3],
    pub is_parallel: f32,
    pub origin_up: [f32; 3],
    pub rays_across: f32,
    pub headlight: [f32; 3],
    pub headlight_scale: f32,
    pub ghost: [f32; 4],
    pub clip_planes: [[f32; 4]; MAX_CLIP_PLANES],
}

/// The part of the picture that one dispatch makes.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "described where the shader reads them")]
pub struct Tile {
    pub origin: [u32; 2],
    pub size: [u32; 2],
    pub resume: u32,
    pub work_limit: u32,
    pub layers: u32,
    pub part_width: u32,
    pub part_origin: [u32; 2],
    pub reserved: [u32; 2],
}

/// Sizes of the grid and its acceleration grid.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "described where the shader reads them")]
pub struct GridInfo {
    pub ni: u32,
    pub nj: u32,
    pub nk: u32,
    pub bins_x: u32,
    pub bins_y: u32,
    pub ghosts: u32,
    pub bin_origin: [f32; 2],
    pub bin_size: [f32; 2],
    pub depth_low: f32,
    pub depth_scale: f32,
    pub column_lists: u32,
    pub bins: u32,
    pub bin_columns: u32,
    pub visible: u32,
}

/// A volume resampled over a box.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "described where the shader reads them")]
pub struct VolumeInfo {
    pub box_low: [f32; 3],
    pub value_low: f32,
    pub box_extent: [f32; 3],
    pub value_scale: f32,
    pub size: [u32; 3],
    pub interpolation: u32,
}

/// The part of a volume or pyramid that one dispatch makes.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "described where the shader reads them")]
pub struct Slab {
    pub first: [u32; 3],
    pub row: u32,
    pub size: [u32; 3],
    pub level: u32,
}

/// Bricks of a volume, their pyramid, and what makes a part of it special.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "described where the shader reads them")]
pub struct BricksInfo {
    pub count: [u32; 3],
    pub levels: u32,
    pub position_low: f32,
    pub position_scale: f32,
    pub empty: f32,
    pub even: f32,
    pub thin: f32,
    pub averages: u32,
    pub reserved0: u32,
    pub reserved1: u32,
}

/// What a pass of the blur makes of a volume.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "described where the shader reads them")]
pub struct BlurInfo {
    pub axis: u32,
    pub source_count: u32,
    pub made_count: u32,
    pub deviation: f32,
    pub box_low: [f32; 3],
    pub position_low: f32,
    pub spacing: [f32; 3],
    pub position_scale: f32,
    pub sigma: f32,
    pub ghost: f32,
    pub clip_count: u32,
    pub counts: f32,
    pub clip_planes: [[f32; 4]; MAX_CLIP_PLANES],
}

/// Lighting of a view.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "described where the shader reads them")]
pub struct LightingInfo {
    pub box_low: [f32; 3],
    pub sigma: f32,
    pub scale: [f32; 3],
    pub strength: f32,
    pub size: [f32; 3],
    pub ambient: f32,
    pub light_size: [u32; 3],
    pub volumes: u32,
    pub emitters: u32,
    pub levels: u32,
    pub position_low: f32,
    pub position_scale: f32,
    pub rays: u32,
    pub seed: u32,
    pub step: f32,
    pub gradient_scale: f32,
    pub work: u32,
    pub rays_gap: f32,
    pub around: u32,
    pub around_attenuation: f32,
}

/// The viewer, or a light.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "described where the shader reads them")]
pub struct Emitter {
    pub at: [f32; 3],
    pub kind: u32,
    pub axis: [f32; 3],
    pub cos_outer: f32,
    pub color: [f32; 3],
    pub cos_inner: f32,
    pub first: u32,
    pub ones: u32,
    pub threes: u32,
    pub sevens: u32,
    pub tangent: f32,
    pub cosine: f32,
    pub length: f32,
    pub volume: u32,
}

/// A layer of surface points that gets its colors.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "described where the shader reads them")]
pub struct PaintInfo {
    pub palette: [[f32; 4]; FAULT_COLORS],
    pub faint: [f32; 4],
    pub faults: u32,
    pub layer: u32,
    pub first_row: u32,
    pub rows: u32,
    pub look: u32,
    pub facing: f32,
    pub edge_on: f32,
    pub reserved: u32,
}

/// One answer of the probe.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "described where the shader writes them")]
pub struct Found {
    pub column: u32,
    pub layer: u32,
    pub reserved0: u32,
    pub reserved1: u32,
    pub parameters: [f32; 3],
    pub value: f32,
}

/// Value constant within a cell.
pub const INTERPOLATION_CELL: u32 = 0;
/// Value trilinear between the vertices.
pub const INTERPOLATION_VERTEX: u32 = 1;

/// The constant of an interpolation.
pub fn interpolation(of: Interpolation) -> u32 {
    match of {
        Interpolation::Cell => INTERPOLATION_CELL,
        Interpolation::Vertex => INTERPOLATION_VERTEX,
    }
}

/// Part of a range per unit of the property; zero for an empty range.
pub fn per_unit([low, high]: [f64; 2]) -> f32 {
    if high > low {
        (1.0 / (high - low)) as f32
    } else {
        0.0
    }
}

/// Entries of the transfer table.
pub const LUT_SIZE: u32 = 4096;
/// Entries in a row of the textures that hold tables: no device has narrower ones.
pub const LUT_ROW: u32 = 2048;
/// Texels of an emitter.
pub const EMITTER_TEXELS: u32 = 5;
/// Column of a point that lies in no cell.
pub const NOT_FOUND: u32 = u32::MAX;
/// Flag of a depth list with gaps.
pub const LIST_GAPPED: u32 = 0x8000_0000;
/// Flag of a column: in its first list reference that layers cross, in the others the margin's level.
pub const COLUMN_FLAG: u32 = 0x4000_0000;
/// Mask of the offset in a list reference.
pub const LIST_OFFSET: u32 = 0x3fff_ffff;
/// Flag of a bin where points are found only by a search of all cells.
pub const BIN_IS_ODD: u32 = 0x8000_0000;
/// Numbers of a block of those that take 16 bits.
pub const BLOCK: u32 = 32;
/// Words of a block.
pub const BLOCK_WORDS: u32 = 1 + BLOCK / 2;
/// Voxels along one side of a brick.
pub const BRICK: u32 = 8;
/// Voxels that a thread fills one after the other, downward.
pub const RUN: u32 = 16;
/// An emitter far away.
pub const EMITTER_DIRECTIONAL: u32 = 0;
/// An emitter at a point.
pub const EMITTER_POINT: u32 = 1;
/// An emitter at a point, within a cone.
pub const EMITTER_SPOT: u32 = 2;
/// No light along cones.
pub const LIGHT_OFF: u32 = 0;
/// Light found at every sample.
pub const LIGHT_IMAGE: u32 = 1;
/// Light found in a volume before.
pub const LIGHT_VOLUME: u32 = 2;
/// Light found at every sample by rays over the cone.
pub const LIGHT_RAYS: u32 = 3;
/// Light along a cone toward an emitter.
pub const METHOD_CONES: u32 = 0;
/// Light along cones to all sides.
pub const METHOD_SURROUND: u32 = 1;
/// Light from all sides by shells.
pub const METHOD_SPAO_MIPMAP: u32 = 2;
/// Light along a cone through the pyramid of values.
pub const METHOD_VCT: u32 = 3;
/// Light along a cone by boxes of a summed-area table.
pub const METHOD_SAT: u32 = 4;
/// Sums that a pass adds up along an axis.
pub const SUM_PARTS: u32 = 8;
/// Means of the table of opacities by mean and deviation.
pub const VCT_MEANS: u32 = 1024;
/// Deviations of it.
pub const VCT_DEVIATIONS: u32 = 32;
/// Bits below the coverage of a packed voxel.
pub const PACKED_SHIFT: u32 = 11;
/// Coverage of a packed voxel that cells fill.
pub const PACKED_COVERAGE: u32 = 31;
/// Value of a packed voxel at the upper end of the range.
pub const PACKED_VALUES: u32 = 2046;
/// Value of a packed voxel in an inactive cell.
pub const PACKED_GHOST: u32 = 2047;
/// A layer in the colors of values or faults.
pub const LOOK_COLORED: u32 = 0;
/// A layer of a faint hull.
pub const LOOK_FAINT: u32 = 1;
/// Points of wells, which have their colors.
pub const LOOK_TUBE: u32 = 2;
pub use crate::view::surfaces::SHEET_LAYERS;
/// Loop iterations that a point of a surface costs beside its light, about.
pub const PAINT_WORK: u32 = 2;
/// Vectors of 16 bytes of a ray's state in PLTS and SRG.
pub const RAY_STATE: u32 = 2;
/// Vectors of 16 bytes of a ray's state in LIBC.
pub const LIBC_STATE: u32 = 4;
/// A pass that makes opacities of values.
pub const WORK_VALUES: u32 = 0;
/// A pass of the Gaussian.
pub const WORK_GAUSSIAN: u32 = 1;
/// A pass of means.
pub const WORK_MEAN: u32 = 2;
/// Counters, each of a low and a high word.
pub const COUNTERS: u32 = 15;
/// Counter of the samples inside drawn cells.
pub const COUNT_SAMPLES: u32 = 0;
/// Counter of Newton iterations.
pub const COUNT_ITERATIONS: u32 = 1;
/// Counter of steps from cell to cell.
pub const COUNT_STEPS: u32 = 2;
/// Counter of point locations through the acceleration grid.
pub const COUNT_FALLBACKS: u32 = 3;
/// Counter of rays that have ended.
pub const COUNT_FINISHED: u32 = 4;
/// Counter of loop iterations.
pub const COUNT_WORK: u32 = 5;
/// Largest number of peels of a ray.
pub const COUNT_PEELS: u32 = 6;
/// Counter of rays set right by point location.
pub const COUNT_RECOVERED: u32 = 7;
/// Counter of rays that could not be set right.
pub const COUNT_LOST: u32 = 8;
/// Counter of rays that paused within what they were doing.
pub const COUNT_PAUSED: u32 = 9;
/// Counter of entries into the model.
pub const COUNT_ENTRIES: u32 = 10;
/// Counter of points of opaque sections that were located.
pub const COUNT_SECTIONS: u32 = 11;
/// Counter of cells that rays passed through.
pub const COUNT_CROSSINGS: u32 = 12;
/// Counter of samples inside the model that were found in no cell.
pub const COUNT_LOST_SAMPLES: u32 = 13;
/// Counter of samples of a cube beside the model.
pub const COUNT_CUBE: u32 = 14;
/// Colors of faults: of named ones in turn, and of those without a name.
pub const FAULT_COLORS: usize = crate::view::surfaces::PALETTE.len() + 1;
/// Clip planes at most.
pub const MAX_CLIP_PLANES: usize = crate::view::clip::MAX_CLIP_PLANES;
