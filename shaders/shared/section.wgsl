// Where a clip plane opens the model, the cells that it cuts can be shown as an opaque section.
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
    let point = frame.eye + ray.enter * ray.direction;
    let location = locate(Query(point, vec3f(0.0), SECTION_ENOUGH, frame.interpolation), vec3f(0.0));
    if !location.found || is_ghost(location.cell.column, location.cell.layer) {
        return vec4f(0.0);
    }
    let inside = clamp(location.solution.uvw, vec3f(0.0), vec3f(1.0));
    return vec4f(shade(transfer(evaluate(location.cell, inside).w).rgb, point, false), 1.0);
}
