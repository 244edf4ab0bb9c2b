// Part of a cube around a point, of half an edge each way, that lies in the box: there is nothing outside.
#import light

fn part_inside(p: vec3f, half_edge: f32) -> f32 {
    let inside = min(p + half_edge, lighting.size) - max(p - half_edge, vec3f(0.0));
    let part = clamp(inside / (2.0 * half_edge), vec3f(0.0), vec3f(1.0));
    return part.x * part.y * part.z;
}
