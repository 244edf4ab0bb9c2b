// Point location as a tool: one thread = one point; 64 points a workgroup.
// Reads the grid; writes one Found a point.
#import locate

struct Points {
    interpolation: u32,
    count: u32,
    reserved0: u32,
    reserved1: u32,
}

// The probe answers to f32's precision.
const PROBE_ENOUGH: f32 = 5e-6;

@group(3) @binding(0) var<uniform> points_info: Points;
// Pairs: the point in grid space relative to the origin, and what rounding to f32 cut off.
@group(3) @binding(1) var<storage, read> points: array<vec4f>;
@group(3) @binding(2) var<storage, read_write> found: array<Found>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= points_info.count {
        return;
    }
    let point = points[2u * id.x].xyz;
    let query = Query(point, points[2u * id.x + 1u].xyz, PROBE_ENOUGH, points_info.interpolation);
    let location = locate(query);
    var result: Found;
    result.column = NOT_FOUND;
    if location.found {
        let uvw = clamp(location.solution.uvw, vec3f(0.0), vec3f(1.0));
        result.column = location.cell.column;
        result.layer = location.cell.layer;
        result.parameters = 2.0 * uvw - vec3f(1.0);
        result.value = evaluate(location.cell, uvw).w;
    }
    found[id.x] = result;
}
