//! The model's box, the orientation axes and the vertical exaggeration.

use glam::{DVec2, DVec3};

use super::Image;
use super::pen::Pen;
use super::ticks::shortened;
use crate::scene::{Camera, View};

/// Color of the lines between cells of non-neighbor connections.
pub const CONNECTION: [u8; 3] = [225, 30, 170];

/// Draws lines between the cells of the view's connections, over the volume: its depth is not known here.
pub fn draw_connections(pen: &mut Pen, view: &View) {
    let size = pen.canvas.size.map(f64::from);
    let thin = pen.thin;
    for ends in view.connections.iter() {
        if let Some(line) = on_screen(&view.camera, *ends, size) {
            pen.canvas.line(line, [thin; 2], CONNECTION, |_, _| 0.8);
        }
    }
}

/// Draws the edges of the box's far sides, under the volume.
///
/// The depth of the volume is not known here, so an edge in front of it could only be drawn wrong.
pub fn draw_box(pen: &mut Pen, image: &Image, view: &View) {
    let size = image.size.map(f64::from);
    let [width, height] = image.size.map(i64::from);
    let strength = |x: i64, y: i64| {
        let inside = (0..width).contains(&x) && (0..height).contains(&y);
        let pixel = inside.then(|| image.pixels.get((x + width * y) as usize));
        0.5 * (1.0 - f64::from(pixel.flatten().map_or(0.0, |p| p[3])))
    };
    let (ink, thin) = (pen.ink, pen.thin);
    let edge = |(a, b): (usize, usize)| [view.box_corners[a], view.box_corners[b]];
    for ends in far_edges(view).into_iter().map(edge) {
        if let Some(line) = on_screen(&view.camera, ends, size) {
            pen.canvas.line(line, [thin; 2], ink, strength);
        }
    }
}

/// Edges, by their corners, of those sides of the box that the viewer sees from within.
pub fn far_edges(view: &View) -> Vec<(usize, usize)> {
    let to_grid = |v: DVec3| view.spaces.grid_from_world.transform_vector3(v);
    let is_far = |axis: usize, corner: usize| {
        let here = view.box_corners[corner];
        let inward = to_grid(view.box_corners[corner ^ 1 << axis] - here)[axis];
        to_grid(view.camera.to_viewer(here).0)[axis] * inward >= 0.0
    };
    let mut edges = Vec::new();
    for axis in 0..3usize {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for corner in (0..8usize).filter(|c| c >> axis & 1 == 0) {
            if is_far(u, corner) || is_far(v, corner) {
                edges.push((corner, corner | 1 << axis));
            }
        }
    }
    edges
}

/// An edge in pixels, cut where it passes the eye.
fn on_screen(camera: &Camera, [a, b]: [DVec3; 2], size: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let nearest = 1e-4 * a.distance(b).max(1e-3);
    let [depth_a, depth_b] = [a, b].map(|p| camera.depth(p));
    let cut = |p: DVec3, depth: f64| {
        if depth >= nearest {
            p
        } else {
            a + (b - a) * ((nearest - depth_a) / (depth_b - depth_a))
        }
    };
    if depth_a.max(depth_b) <= nearest {
        return None;
    }
    let pixel = |p: DVec3| {
        let at = camera.project(p, size[0] / size[1])?;
        Some([at.x * size[0], at.y * size[1]])
    };
    Some([pixel(cut(a, depth_a))?, pixel(cut(b, depth_b))?])
}

/// Draws east, north and up as the camera sees them and the vertical exaggeration, bottom left.
pub fn draw_axes(pen: &mut Pen, view: &View) {
    let unit = pen.unit;
    let bottom = f64::from(pen.canvas.size[1]);
    let length = 3.0 * unit;
    let center = DVec2::new(unit + 1.3 * length, bottom - 2.2 * unit - 1.3 * length);
    let camera = &view.camera;
    let colors = if pen.dark_paper {
        [[242, 96, 86], [88, 200, 104], [110, 155, 255]]
    } else {
        [[205, 45, 40], [30, 140, 55], [45, 85, 210]]
    };
    let mut arrows: [_; 3] = std::array::from_fn(|n| {
        let (axis, name) = [(DVec3::X, "E"), (DVec3::Y, "N"), (DVec3::Z, "Up")][n];
        let seen = DVec2::new(axis.dot(camera.right), -axis.dot(camera.up));
        (
            axis.dot(camera.forward),
            center + length * seen,
            colors[n],
            name,
        )
    });
    // Far ones first.
    arrows.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, tip, color, _) in arrows {
        arrow(pen, center, tip, color);
    }
    let mut taken: Vec<[DVec2; 2]> = arrows.iter().map(|a| [center, a.1]).collect();
    for (_, tip, _, name) in arrows {
        let at = free_place(center, tip, &taken, unit);
        taken.push([at, at]);
        let width = pen.canvas.text_width(name, unit);
        pen.write(name, [at.x - 0.5 * width, at.y - 0.5 * unit]);
    }
    exaggeration(pen, view.vertical_exaggeration);
}

fn exaggeration(pen: &mut Pen, factor: f64) {
    let unit = pen.unit;
    let factor = format!("{factor:.2}");
    let text = format!("Vertical exaggeration ×{}", shortened(&factor));
    let top = f64::from(pen.canvas.size[1]) - 1.9 * unit;
    let text = pen
        .canvas
        .cut(&text, unit, f64::from(pen.canvas.size[0]) - 2.0 * unit);
    let end = unit + pen.canvas.text_width(&text, unit);
    pen.plate(
        [0.5 * unit, top - 0.2 * unit],
        [end + 0.5 * unit, top + 1.3 * unit],
    );
    pen.write(&text, [unit, top]);
}

fn arrow(pen: &mut Pen, from: DVec2, tip: DVec2, color: [u8; 3]) {
    let unit = pen.unit;
    let length = from.distance(tip);
    if length < 0.4 * unit {
        // It points at the eye or away from it.
        let dot = [from.to_array(); 2];
        pen.canvas.line(dot, [0.5 * unit; 2], color, |_, _| 1.0);
        return;
    }
    let neck = tip.lerp(from, (unit / length).min(0.6));
    let [from, neck, tip] = [from, neck, tip].map(|p| p.to_array());
    let lines = [
        ([from, neck], [0.16 * unit; 2]),
        ([neck, tip], [0.65 * unit, 0.0]),
    ];
    for (ends, widths) in lines {
        pen.canvas.line(ends, widths, color, |_, _| 1.0);
    }
}

/// A place for a label near an arrow's tip, as far from all else as it can be.
fn free_place(center: DVec2, tip: DVec2, taken: &[[DVec2; 2]], unit: f64) -> DVec2 {
    let ahead = (tip - center).try_normalize().unwrap_or(DVec2::X);
    let room = |place: DVec2| {
        let distances = taken.iter().map(|&segment| distance(place, segment));
        distances.fold(0.85 * unit, f64::min)
    };
    // The first of the best: straight ahead, unless something is there.
    let (mut best, mut best_room) = (tip + 0.85 * unit * ahead, 0.0);
    for degrees in [0.0f64, 60.0, -60.0, 100.0, -100.0, 180.0] {
        let place = tip + 0.85 * unit * DVec2::from_angle(degrees.to_radians()).rotate(ahead);
        if room(place) > best_room + 0.05 * unit {
            (best, best_room) = (place, room(place));
        }
    }
    best
}

fn distance(point: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let along = (point - a).dot(b - a) / a.distance_squared(b).max(1e-12);
    point.distance(a + along.clamp(0.0, 1.0) * (b - a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_keep_away_from_arrows_ahead() {
        let (center, tip) = (DVec2::ZERO, DVec2::new(0.0, -20.0));
        let own = [center, tip];
        assert!(free_place(center, tip, &[own], 10.0).abs_diff_eq(DVec2::new(0.0, -28.5), 1e-9));
        let longer = [center, DVec2::new(0.0, -40.0)];
        let place = free_place(center, tip, &[own, longer], 10.0);
        assert!(distance(place, longer) > 5.0);
    }

    #[test]
    fn edges_are_cut_at_the_eye() {
        let eye = DVec3::ZERO;
        let camera = Camera::look_at(eye, DVec3::Y, DVec3::Z, 1.0).unwrap();
        let at = |y: f64| DVec3::new(1.0, y, 0.0);
        let size = [100.0, 100.0];
        assert!(on_screen(&camera, [at(1.0), at(2.0)], size).is_some());
        assert!(on_screen(&camera, [at(-1.0), at(-2.0)], size).is_none());
        let [[behind, _], [ahead, _]] = on_screen(&camera, [at(-1.0), at(2.0)], size).unwrap();
        assert!(behind > 1000.0 && (50.0..100.0).contains(&ahead));
    }
}
