//! How pointer and keys move the camera.

use glam::{DQuat, DVec2, DVec3};

use crate::scene::{Camera, CameraSpec, ExplicitCamera, FramingCamera, Projection};

/// Radians that a drag across the height of the picture turns.
const TURN: f64 = 3.0;
/// The camera never looks closer to straight up or down than this.
const LEAST_TILT: f64 = 0.01;

/// A scene's camera from one in the window. Its target lies as deep as `middle`; of a parallel one where the
/// field of view is as high as the picture.
pub fn spec(camera: &Camera, middle: DVec3) -> CameraSpec {
    let depth = match camera.parallel {
        None => camera.depth(middle).max(1.0),
        Some(half_height) => half_height / camera.tan_half_fovy,
    };
    let target = camera.eye + depth * camera.forward;
    CameraSpec::Explicit(ExplicitCamera {
        eye: camera.eye.to_array(),
        target: target.to_array(),
        up: camera.up.to_array(),
        fovy_degrees: 2.0 * camera.tan_half_fovy.atan().to_degrees(),
        projection: camera.projection(),
    })
}

/// Turns around a point of world space: `drag` in parts of the picture's height, right and down. The
/// horizon stays level.
pub fn rotate(camera: &Camera, around: DVec3, drag: DVec2) -> Camera {
    let yaw = DQuat::from_rotation_z(-TURN * drag.x);
    let tilt = camera.forward.z.clamp(-1.0, 1.0).asin();
    let limit = std::f64::consts::FRAC_PI_2 - LEAST_TILT;
    let wanted = (tilt - TURN * drag.y).clamp(-limit, limit);
    let pitch = DQuat::from_axis_angle(camera.right, wanted - tilt);
    level(camera.turned(around, pitch).turned(around, yaw))
}

/// The same camera with its horizon level, unless it looks straight up or down.
fn level(camera: Camera) -> Camera {
    match camera.forward.cross(DVec3::Z).try_normalize() {
        Some(right) if camera.forward.z.abs() < 1.0 - 1e-9 => Camera {
            right,
            up: right.cross(camera.forward),
            ..camera
        },
        _ => camera,
    }
}

/// Moves such that what lies at the distance of `around` follows the pointer.
pub fn pan(camera: &Camera, around: DVec3, drag: DVec2) -> Camera {
    let height = 2.0 * camera.half_height(camera.depth(around).max(1e-6));
    Camera {
        eye: camera.eye + height * (drag.y * camera.up - drag.x * camera.right),
        ..*camera
    }
}

/// Comes closer to a point by a factor above 1, or goes away by one below.
pub fn zoom(camera: &Camera, to: DVec3, factor: f64) -> Camera {
    camera.closer(to, factor.clamp(0.1, 10.0))
}

/// Where a ray through a place in the picture passes nearest to the middle of a box, or the middle.
pub fn point_under(camera: &Camera, at: DVec2, aspect: f64, corners: &[DVec3; 8]) -> DVec3 {
    let middle = corners.iter().sum::<DVec3>() / 8.0;
    let (origin, direction) = camera.ray(at, aspect);
    let along = (middle - origin).dot(direction);
    let point = origin + along.max(1e-6) * direction;
    let low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = corners
        .iter()
        .copied()
        .fold(DVec3::NEG_INFINITY, DVec3::max);
    if along > 0.0 && point.cmpge(low).all() && point.cmple(high).all() {
        point
    } else {
        middle
    }
}

/// The standard views: name, compass direction of the camera and its height, in degrees.
pub const VIEWS: [(&str, f64, f64); 6] = [
    ("North", 180.0, 0.0),
    ("South", 0.0, 0.0),
    ("East", 270.0, 0.0),
    ("West", 90.0, 0.0),
    ("Top", 180.0, 90.0),
    ("Isometric", 205.0, 35.0),
];

/// A camera that frames the model from a direction.
pub fn framing(azimuth_degrees: f64, elevation_degrees: f64) -> CameraSpec {
    CameraSpec::Framing(FramingCamera {
        azimuth_degrees,
        elevation_degrees,
        zoom: 1.0,
        projection: Projection::Perspective,
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera::look_at(DVec3::new(0.0, -10.0, 5.0), DVec3::ZERO, DVec3::Z, 0.5).unwrap()
    }

    #[test]
    fn rotating_keeps_distance_and_horizon() {
        let turned = rotate(&camera(), DVec3::ZERO, DVec2::new(0.3, 0.1));
        assert!((turned.eye.length() - camera().eye.length()).abs() < 1e-9);
        assert!(turned.right.z.abs() < 1e-9);
        assert!(turned.eye.distance(camera().eye) > 1.0);
        // However far one drags, the camera does not turn over.
        let over = rotate(&camera(), DVec3::ZERO, DVec2::new(0.0, 50.0));
        assert!(over.up.z > 0.0);
    }

    #[test]
    fn panning_moves_what_is_under_the_pointer_with_it() {
        let moved = pan(&camera(), DVec3::ZERO, DVec2::new(0.25, -0.1));
        let before = camera().project(DVec3::ZERO, 1.0).unwrap();
        let after = moved.project(DVec3::ZERO, 1.0).unwrap();
        assert!((after - before - DVec2::new(0.25, -0.1)).length() < 1e-9);
    }

    #[test]
    fn zooming_keeps_the_point_in_its_place() {
        let point = DVec3::new(1.0, 2.0, 0.5);
        let near = zoom(&camera(), point, 2.0);
        let (a, b) = (camera().project(point, 1.5), near.project(point, 1.5));
        assert!((a.unwrap() - b.unwrap()).length() < 1e-9);
        assert!((near.eye.distance(point) * 2.0 - camera().eye.distance(point)).abs() < 1e-9);
    }
}
