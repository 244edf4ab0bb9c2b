// Every struct and constant that host and shaders share; the host's mirrors have the same names.

const MAX_CLIP_PLANES: u32 = 8u;
// The last one is that of faults without a name.
const FAULT_COLORS: u32 = 8u;

struct Frame {
    // Grid space relative to the model's origin, file length units.
    eye: vec3f,
    // World-space distance of samples.
    step: f32,
    // How the rays' directions vary over half the picture, in world space: not at all in parallel.
    forward: vec3f,
    early_termination: f32,
    right: vec3f,
    value_low: f32,
    up: vec3f,
    // Transfer-function position per unit of value; zero for an empty range.
    value_scale: f32,
    // Columns of the linear part of the grid-from-world transform.
    grid_from_world_x: vec3f,
    width: u32,
    grid_from_world_y: vec3f,
    height: u32,
    grid_from_world_z: vec3f,
    interpolation: u32,
    // Box of the active cells, grid space relative to the origin.
    box_low: vec3f,
    clip_count: u32,
    box_high: vec3f,
    // Bit n: where plane n opens the model to the eye, its section is drawn opaque.
    opaque_cuts: u32,
    // Rows of the transform from grid space relative to the eye to x, y and distance along the axis; x and y
    // are those of the picture, in perspective times that distance.
    view_x: vec3f,
    // Distance of the model's farthest corner.
    farthest: f32,
    view_y: vec3f,
    // +1 where cells are right-handed in world space, else -1.
    world_handedness: f32,
    view_z: vec3f,
    // The same in grid space.
    grid_handedness: f32,
    // How the rays' origins vary over half the picture, in grid space: not at all in perspective.
    origin_right: vec3f,
    // 1 where rays are parallel, else 0.
    is_parallel: f32,
    origin_up: vec3f,
    // Rays along each axis of a pixel of the final image.
    rays_across: f32,
    // The way from the viewer to the lamp beside it, at a distance of one, in grid space; and one over the length
    // of the way from there to the lamp.
    headlight: vec3f,
    headlight_scale: f32,
    // Color and extinction of inactive cells.
    ghost: vec4f,
    // Kept is where dot(xyz, point) + w >= 0, grid space relative to the origin.
    clip_planes: array<vec4f, MAX_CLIP_PLANES>,
}

// The part of the picture that one dispatch makes, in pixels.
struct Tile {
    origin: vec2u,
    size: vec2u,
    // 1 where rays go on from their states.
    resume: u32,
    // Loop iterations after which a ray pauses until the next dispatch.
    work_limit: u32,
    // Position in the ray states of the layers of surfaces of the picture's part that the tile lies in.
    layers: u32,
    part_width: u32,
    part_origin: vec2u,
    reserved: vec2u,
}

struct GridInfo {
    ni: u32,
    nj: u32,
    nk: u32,
    bins_x: u32,
    bins_y: u32,
    // Where the bits of inactive cells begin in the bits of cells, in pairs of words.
    ghosts: u32,
    bin_origin: vec2f,
    bin_size: vec2f,
    // Depth = depth_low + depth_scale * 16-bit number, relative to the origin.
    depth_low: f32,
    depth_scale: f32,
    // Where parts of the grid's words begin, in pairs; the pillars come first.
    column_lists: u32,
    bins: u32,
    bin_columns: u32,
    // Where the bits of the cells that rays meet begin, as `ghosts`; 0 where these are all drawn cells.
    visible: u32,
}

// A volume resampled over a box, in voxels; grid space relative to the origin.
struct VolumeInfo {
    box_low: vec3f,
    // Stored values are 0 here and grow by `value_scale` per unit of the property.
    value_low: f32,
    box_extent: vec3f,
    value_scale: f32,
    size: vec3u,
    interpolation: u32,
}

// The part of a volume or pyramid that one dispatch makes.
struct Slab {
    first: vec3u,
    // Voxels from one row to the next.
    row: u32,
    size: vec3u,
    // Level of the pyramid.
    level: u32,
}

// Bricks of BRICK^3 voxels, their pyramid, and what makes a part of it special.
struct BricksInfo {
    count: vec3u,
    levels: u32,
    // Transfer-function position of a stored value: low + scale * stored.
    position_low: f32,
    position_scale: f32,
    // A part is empty where no extinction in it exceeds this; negative for never, as for the next two.
    empty: f32,
    // Even where its voxels are all present and its positions differ by no more.
    even: f32,
    // Thin where no extinction exceeds this.
    thin: f32,
    // Levels of the volume's average pyramid.
    averages: u32,
    reserved0: u32,
    reserved1: u32,
}

// What a pass of the blur makes of a volume, along one axis.
struct BlurInfo {
    axis: u32,
    // Voxels along the axis, of what is read and of what is made.
    source_count: u32,
    made_count: u32,
    // Standard deviation in voxels of what is read.
    deviation: f32,
    // Where values are read: box and planes in grid space relative to the origin, as in a frame; the transfer
    // function's position of a value: low + scale * part of the range.
    box_low: vec3f,
    position_low: f32,
    // From one voxel to the next.
    spacing: vec3f,
    position_scale: f32,
    // World-space length of the finest level's standard deviation.
    sigma: f32,
    // Extinction of inactive cells.
    ghost: f32,
    clip_count: u32,
    // Numbers that a unit of optical depth is counted in, in sums.
    counts: f32,
    clip_planes: array<vec4f, MAX_CLIP_PLANES>,
}

// Lighting of a view. Its space: the grid's axes from the low corner of the box, in units of the finest
// level's standard deviation in world space, so that lengths are those of world space.
struct LightingInfo {
    // Grid space relative to the origin.
    box_low: vec3f,
    // World-space length of the unit.
    sigma: f32,
    // Units a grid-space length.
    scale: vec3f,
    strength: f32,
    // Of the box.
    size: vec3f,
    ambient: f32,
    // Voxels of a light volume, of which there are `volumes`, one above the other.
    light_size: vec3u,
    volumes: u32,
    // The viewer is the first, the lights follow.
    emitters: u32,
    // Levels of the extinction pyramid.
    levels: u32,
    // Transfer-function position of a value: low + scale * part of the range.
    position_low: f32,
    position_scale: f32,
    // Of the rays over a cone: number, seed and step.
    rays: u32,
    seed: u32,
    step: f32,
    // Units in a reference length of the transfer function.
    gradient_scale: f32,
    // Loop iterations that a sample costs, about.
    work: u32,
    // Where rays over a cone start.
    rays_gap: f32,
    // Occlusion from all sides: directions of its cones, or shells around a point; and the factor on its extinction.
    around: u32,
    around_attenuation: f32,
}

// The viewer, or a light.
struct Emitter {
    // Where it is, or for a directional light the unit vector toward it.
    at: vec3f,
    kind: u32,
    // Axis of a spot; of directional light a point of the plane that it comes from.
    axis: vec3f,
    // Cosines of the angle at which a spot's light ends, and at which it begins to fade.
    cos_outer: f32,
    // Color times intensity.
    color: vec3f,
    cos_inner: f32,
    // First of its sections, and how many have one part, three and seven.
    first: u32,
    ones: u32,
    threes: u32,
    sevens: u32,
    // Tangent and cosine of the cone's half angle, its length, and the number of its light volume.
    tangent: f32,
    cosine: f32,
    length: f32,
    volume: u32,
}

// A layer of surface points that gets its colors.
struct PaintInfo {
    // Colors of faults.
    palette: array<vec4f, FAULT_COLORS>,
    // Color of a faint hull.
    faint: vec4f,
    // Faces that lie on faults.
    faults: u32,
    // How many are painted already.
    layer: u32,
    // Rows of the part that are painted.
    first_row: u32,
    rows: u32,
    // One of the LOOK constants.
    look: u32,
    // Opacity of a faint hull that is turned to the viewer, and where it is seen edge-on.
    facing: f32,
    edge_on: f32,
    reserved: u32,
}

// One found point for the probe: cell column and layer, or NOT_FOUND, and (s, t, r) and value.
struct Found {
    column: u32,
    layer: u32,
    reserved0: u32,
    reserved1: u32,
    parameters: vec3f,
    value: f32,
}

const INTERPOLATION_CELL: u32 = 0u;
const INTERPOLATION_VERTEX: u32 = 1u;
const LUT_SIZE: u32 = 4096u;
// Entries in a row of the textures that hold tables: no device has narrower ones.
const LUT_ROW: u32 = 2048u;
// Texels of an emitter.
const EMITTER_TEXELS: u32 = 5u;
const NOT_FOUND: u32 = 0xffffffffu;
// Flags in the four list references of a column: its own list has gaps; one bit of the column's:
// in the first reference that layers cross, in the others the level of its margin, low bit first.
const LIST_GAPPED: u32 = 0x80000000u;
const COLUMN_FLAG: u32 = 0x40000000u;
const LIST_OFFSET: u32 = 0x3fffffffu;
// Corners closer than this along their pillar coincide.
const COINCIDENT: f32 = 1e-3;
// Flag of a bin, in the position of its first entry: points there are found only by a search of all cells.
const BIN_IS_ODD: u32 = 0x80000000u;
// Numbers of a block of those that take 16 bits, and words that these take.
const BLOCK: u32 = 32u;
const BLOCK_WORDS: u32 = 17u;
// Voxels along one side of a brick.
const BRICK: u32 = 8u;
// Voxels that a thread fills one after the other, downward.
const RUN: u32 = 16u;
// How rays pass a part of a volume.
const PASS_PLAIN: u32 = 0u;
const PASS_EMPTY: u32 = 1u;
const PASS_EVEN: u32 = 2u;
const PASS_THIN: u32 = 3u;
// Kinds of emitters.
const EMITTER_DIRECTIONAL: u32 = 0u;
const EMITTER_POINT: u32 = 1u;
const EMITTER_SPOT: u32 = 2u;
// Where light along a cone is found.
const LIGHT_OFF: u32 = 0u;
const LIGHT_IMAGE: u32 = 1u;
const LIGHT_VOLUME: u32 = 2u;
const LIGHT_RAYS: u32 = 3u;
// How light in a volume is found.
const METHOD_CONES: u32 = 0u;
const METHOD_SURROUND: u32 = 1u;
const METHOD_SPAO_MIPMAP: u32 = 2u;
// Light along a cone through the pyramid of values.
const METHOD_VCT: u32 = 3u;
// Light along a cone by boxes of a summed-area table.
const METHOD_SAT: u32 = 4u;
// Sums that a pass adds up along an axis, and the optical depth of a unit of length that counts at most.
const SUM_PARTS: u32 = 8u;
const DEEPEST: f32 = 8.0;
// Means and deviations of the table of opacities by mean and deviation.
const VCT_MEANS: u32 = 1024u;
const VCT_DEVIATIONS: u32 = 32u;
// Changes of position over a reference length between which the gradient comes to count; brightness and
// exponent of highlights.
const GRADIENT_FADE_LOW: f32 = 0.01;
const GRADIENT_FADE_HIGH: f32 = 0.1;
const SPECULAR: f32 = 0.25;
const SHININESS: f32 = 40.0;
// A packed voxel: coverage, and below it the value as a part of the range, or PACKED_GHOST.
const PACKED_SHIFT: u32 = 11u;
const PACKED_COVERAGE: u32 = 31u;
const PACKED_VALUES: u32 = 2046u;
const PACKED_GHOST: u32 = 2047u;
// What a layer shows: values or faults; or that there is something.
const LOOK_COLORED: u32 = 0u;
const LOOK_FAINT: u32 = 1u;
const LOOK_TUBE: u32 = 2u;
// Points of sheets that a ray meets, at most.
const SHEET_LAYERS: u32 = 4u;
// Loop iterations that a point of a surface costs beside its light, about.
const PAINT_WORK: u32 = 2u;
const SHEET_OPACITY: f32 = 0.5;
// Part of the headlight that comes from everywhere.
const HEADLIGHT_AMBIENT: f32 = 0.35;
// Lines along edges: width in pixels, darkness, and pixels from edge to edge between which they come to be seen.
const EDGE_WIDTH: f32 = 1.0;
const EDGE_DARKNESS: f32 = 0.4;
const EDGE_FADE_LOW: f32 = 3.0;
const EDGE_FADE_HIGH: f32 = 12.0;
// Vectors of a ray's state between rounds: in PLTS and SRG, and in LIBC, whose state peeling reads too.
const RAY_STATE: u32 = 2u;
const LIBC_STATE: u32 = 4u;
// What a pass of the blur does.
const WORK_VALUES: u32 = 0u;
const WORK_GAUSSIAN: u32 = 1u;
const WORK_MEAN: u32 = 2u;
// Counters, each of a low and a high word.
const COUNTERS: u32 = 15u;
const COUNT_SAMPLES: u32 = 0u;
const COUNT_ITERATIONS: u32 = 1u;
const COUNT_STEPS: u32 = 2u;
const COUNT_FALLBACKS: u32 = 3u;
const COUNT_FINISHED: u32 = 4u;
const COUNT_WORK: u32 = 5u;
const COUNT_PEELS: u32 = 6u;
const COUNT_RECOVERED: u32 = 7u;
const COUNT_LOST: u32 = 8u;
const COUNT_PAUSED: u32 = 9u;
const COUNT_ENTRIES: u32 = 10u;
const COUNT_SECTIONS: u32 = 11u;
const COUNT_CROSSINGS: u32 = 12u;
const COUNT_LOST_SAMPLES: u32 = 13u;
const COUNT_CUBE: u32 = 14u;
