// Corners as a ray sees them: it is the origin, so that edges are cross products.
#import grid

// A point on the ray, two directions across, and distances along.
struct RayFrame {
    origin: vec3f,
    across_x: vec3f,
    across_y: vec3f,
    along: vec3f,
    t_origin: f32,
}

// The frame at a point of a ray, which lies at distance `t`.
fn frame_at(origin: vec3f, direction: vec3f, t: f32) -> RayFrame {
    var r: RayFrame;
    r.t_origin = t;
    r.origin = origin;
    let helper = select(vec3f(0.0, 0.0, 1.0), vec3f(1.0, 0.0, 0.0), abs(direction.z) > 0.7 * length(direction));
    r.across_x = normalize(cross(helper, direction));
    r.across_y = normalize(cross(direction, r.across_x));
    r.along = direction / dot(direction, direction);
    return r;
}

// A corner relative to the frame's origin, in grid space.
fn from_origin(r: RayFrame, pillar: Pillar, depth: f32) -> vec3f {
    return vec3f((pillar.at - r.origin.xy) + (pillar.low_bits + pillar.slope * depth), depth - r.origin.z);
}

// A corner: two coordinates across the ray and the distance along it.
fn project(r: RayFrame, pillar: Pillar, depth: f32) -> vec3f {
    return projected(r, from_origin(r, pillar, depth));
}

fn projected(r: RayFrame, from_origin: vec3f) -> vec3f {
    return vec3f(dot(r.across_x, from_origin), dot(r.across_y, from_origin), r.t_origin + dot(r.along, from_origin));
}

fn cross2d(a: vec3f, b: vec3f) -> f32 {
    return a.x * b.y - a.y * b.x;
}
