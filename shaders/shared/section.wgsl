// Where a clip plane opens the model, the cells that it cuts can be shown as an opaque section.
#import edges
#import locate
#import shading
#import transfer

// Steps below this end the iteration on a section.
const SECTION_ENOUGH: f32 = 1e-4;

// Color of the section at which a ray enters, and 1; zero where it enters none.
fn section_color(ray: Ray) -> vec4f {
    if !ray.opaque_cut {
        return vec4f(0.0);
    }
    let point = ray.origin + ray.enter * ray.direction;
    let location = locate(Query(point, vec3f(0.0), SECTION_ENOUGH, frame.interpolation));
    count(COUNT_SECTIONS, 1u);
    if !location.found || is_ghost(location.cell.column, location.cell.layer) {
        return vec4f(0.0);
    }
    let inside = clamp(location.solution.uvw, vec3f(0.0), vec3f(1.0));
    let normal = frame.clip_planes[ray.cut].xyz;
    let own = transfer(evaluate(location.cell, inside).w).rgb;
    let color = shade(headlight(normal, ray.direction) * own, point, false);
    if !CELL_EDGES {
        return vec4f(color, 1.0);
    }
    let steps = pixel_steps(ray.direction, ray.enter);
    let right = parameters_along(location.cell, inside, on_plane(steps[0], normal, ray.direction));
    let down = parameters_along(location.cell, inside, on_plane(steps[1], normal, ray.direction));
    return vec4f(with_edges(color, inside, right, down), 1.0);
}

// A displacement across a ray, moved along it into a plane that the ray crosses.
fn on_plane(displacement: vec3f, normal: vec3f, direction: vec3f) -> vec3f {
    return displacement - dot(normal, displacement) / dot(normal, direction) * direction;
}
