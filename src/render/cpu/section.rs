//! Where a clip plane opens the model, the cells that it cuts can be shown as an opaque section.
//! The twin of `shaders/shared/section.wgsl`.

use glam::{Vec3A, Vec4};

use super::edges::with_edges;
use super::frame::Ray;
use super::locate::{Query, locate};
use super::scene::Scene;
use super::tally::Tally;

/// Newton steps below this end the iteration on a section.
pub const SECTION_ENOUGH: f32 = 1e-4;

/// Color of the section at which a ray enters, and 1; zero where it enters none.
pub fn section_color(scene: &Scene<'_>, ray: &Ray, tally: &mut Tally) -> Vec4 {
    let Some(cut) = ray.cut.filter(|_| ray.opaque_cut) else {
        return Vec4::ZERO;
    };
    let point = ray.at(ray.enter);
    let query = Query {
        point,
        low_bits: Vec3A::ZERO,
        enough: SECTION_ENOUGH,
    };
    let location = locate(scene.grid, query, Vec3A::ZERO);
    tally.sections += 1;
    let is_ghost = |column, layer| scene.grid.is_ghost(column, layer);
    let found = location.found.filter(|(c, _)| !is_ghost(c.column, c.layer));
    let Some((cell, solution)) = found else {
        return Vec4::ZERO;
    };
    let inside = solution.uvw.clamp(Vec3A::ZERO, Vec3A::ONE);
    let normal = Vec3A::from_vec4(scene.frame.clip_planes[cut]);
    let own = Vec3A::from_vec4(scene.transfer.of(cell.evaluate(inside).w));
    let lamp = scene.shading.headlight(&scene.frame, normal, ray.direction);
    let color = scene.shading.shade(lamp * own, point, false);
    if !scene.surfaces.cell_edges {
        return color.extend(1.0);
    }
    let steps = scene.frame.pixel_steps(ray.direction, ray.enter);
    let steps =
        steps.map(|step| cell.parameters_along(inside, on_plane(step, normal, ray.direction)));
    with_edges(color, inside, steps).extend(1.0)
}

/// A displacement across a ray, moved along it into a plane that the ray crosses.
fn on_plane(displacement: Vec3A, normal: Vec3A, direction: Vec3A) -> Vec3A {
    displacement - normal.dot(displacement) / normal.dot(direction) * direction
}
