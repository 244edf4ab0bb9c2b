//! Edges of the model's box as the camera sees them.

use glam::{DVec2, DVec3};

use crate::view::{Camera, View};

/// An edge of the box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// Axis of the grid along which it runs.
    pub axis: usize,
    /// Its corners.
    pub corners: [usize; 2],
    /// It has a far side on one hand and a near one on the other: nothing of the box is beyond it.
    pub is_outline: bool,
}

/// Edges of those sides of the box that the viewer sees from within.
///
/// The depth of the volume is not known here, so an edge in front of it could only be drawn wrong.
pub fn far(view: &View) -> Vec<Edge> {
    let corners = &view.world.subject.outline;
    let is_far = |axis: usize, corner: usize| {
        let here = corners[corner];
        let along = |axis: usize| corners[corner ^ 1 << axis] - here;
        let side = along((axis + 1) % 3).cross(along((axis + 2) % 3));
        view.camera.to_viewer(here).0.dot(side) * along(axis).dot(side) >= 0.0
    };
    let mut edges = Vec::new();
    for axis in 0..3usize {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for corner in (0..8usize).filter(|c| c >> axis & 1 == 0) {
            let sides = [is_far(u, corner), is_far(v, corner)];
            if sides != [false; 2] {
                edges.push(Edge {
                    axis,
                    corners: [corner, corner | 1 << axis],
                    is_outline: sides[0] != sides[1],
                });
            }
        }
    }
    edges
}

/// A line of world space in a picture of a size, cut at its rim.
pub fn on_screen(view: &View, ends: [DVec3; 2], size: DVec2) -> Option<[DVec2; 2]> {
    let aspect = view.aspect();
    let [a, b] = visible(&view.camera, ends, aspect)?;
    let project = |p: DVec3| Some(view.camera.project(p, aspect)? * size);
    Some([project(a)?, project(b)?])
}

/// The part of a line that is in the picture.
pub fn visible(camera: &Camera, [a, b]: [DVec3; 2], aspect: f64) -> Option<[DVec3; 2]> {
    // Each of these is linear along the line and not negative in the picture.
    let heights = |p: DVec3| {
        let depth = camera.depth(p);
        let half_height = camera.half_height(depth);
        let (x, y) = (
            (p - camera.eye).dot(camera.right),
            (p - camera.eye).dot(camera.up),
        );
        [
            depth - 1e-4 * a.distance(b),
            half_height * aspect - x,
            half_height * aspect + x,
            half_height - y,
            half_height + y,
        ]
    };
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for (start, end) in heights(a).into_iter().zip(heights(b)) {
        if !(start >= 0.0 || end >= 0.0) {
            return None;
        }
        let crossing = start / (start - end);
        if start < 0.0 {
            from = from.max(crossing);
        } else if end < 0.0 {
            to = to.min(crossing);
        }
    }
    (from < to).then(|| [a.lerp(b, from), a.lerp(b, to)])
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use crate::scene::Projection;

    #[test]
    fn lines_are_cut_at_the_eye_and_the_rim() {
        let eye = DVec3::ZERO;
        let perspective = Camera::look_at(eye, DVec3::Y, DVec3::Z, 1.0).unwrap();
        let parallel = perspective.with(Projection::Parallel, 5.0 * DVec3::Y);
        for camera in [perspective, parallel] {
            let at = |y: f64| DVec3::new(1.0, y, 0.0);
            let whole = [at(4.0), at(5.0)];
            assert_eq!(visible(&camera, whole, 1.0), Some(whole));
            assert_eq!(visible(&camera, [at(-1.0), at(-2.0)], 1.0), None);
            let [from, to] = visible(&camera, [at(-1.0), at(5.0)], 1.0).unwrap();
            // The rim where it is in perspective, the plane of the eye in parallel.
            let start = match camera.parallel {
                None => 1.0 / camera.tan_half_fovy,
                Some(_) => 0.0,
            };
            assert!((from.y - start).abs() < 1e-3 && to == at(5.0), "{from}");
            let far_out = [DVec3::new(9.0, 5.0, 0.0), DVec3::new(9.0, 5.0, 1.0)];
            assert_eq!(visible(&camera, far_out, 1.0), None);
        }
    }
}
