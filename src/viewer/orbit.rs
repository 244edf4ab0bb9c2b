//! How pointer and keys move the camera.

use glam::{DQuat, DVec2, DVec3};

use crate::model::{Grid, Ijk};
use crate::scene::{AutomaticCamera, CameraSpec, ExplicitCamera, FramingCamera, Projection};
use crate::view::camera::middle;
use crate::view::{Camera, View};

/// Radians that a drag across the height of the picture turns.
const TURN: f64 = 3.0;
/// The camera never looks closer to straight up or down than this.
const LEAST_TILT: f64 = 0.01;

/// A scene's camera from one in the window, given the corners of the model's box. Its target lies as deep as
/// the middle of that; of a parallel one where the field of view is as high as the picture. The plane of a
/// parallel one is put before the model.
pub fn spec(camera: &Camera, corners: &[DVec3; 8]) -> CameraSpec {
    let camera = camera.before(corners);
    let depth = match camera.parallel {
        None => camera.depth(middle(corners)).max(1.0),
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

/// A selected cell takes this part of the picture.
const SELECTED: f64 = 0.3;

/// The camera of a view on some cells, from the same direction; `None` where there are none.
pub fn on_cells(now: &View, grid: &Grid, cells: impl IntoIterator<Item = Ijk>) -> Option<Camera> {
    let cells: Vec<Ijk> = cells.into_iter().collect();
    let cells = now.corners_of(grid.bounds_of(cells)?);
    let framed = now.camera.framed(&cells, now.aspect());
    Some(framed.closer(middle(&cells), SELECTED))
}

/// A drag that turns by angles in radians, to the right and down.
pub fn drag_of(angles: DVec2) -> DVec2 {
    angles / TURN
}

/// What lies under a place in the picture (x right, y down, 0 to 1): the middle of the way of its ray through
/// the box of the drawn cells, whose bounds in grid space are given; the middle of that, or of the model where
/// nothing is drawn, where the ray passes by.
pub fn point_under(view: &View, drawn: Option<[DVec3; 2]>, at: DVec2) -> DVec3 {
    let Some([low, high]) = drawn else {
        return middle(&view.world.corners);
    };
    let (origin, direction) = view.camera.ray(at, view.aspect());
    // The box lies along the axes of grid space, and lengths along a ray are the same there.
    let to_grid = &view.world.spaces.grid_from_world;
    let start = to_grid.transform_point3(origin);
    let way = to_grid.transform_vector3(direction);
    let (a, b) = ((low - start) / way, (high - start) / way);
    let (enter, leave) = (a.min(b).max_element().max(0.0), a.max(b).min_element());
    match enter < leave && leave.is_finite() {
        true => origin + 0.5 * (enter + leave) * direction,
        false => middle(&view.corners_of([low, high])),
    }
}

/// The standard views: name, compass direction of the camera and its height, in degrees.
pub const VIEWS: [(&str, f64, f64); 7] = [
    ("North", 180.0, 0.0),
    ("South", 0.0, 0.0),
    ("East", 270.0, 0.0),
    ("West", 90.0, 0.0),
    ("Top", 180.0, 90.0),
    ("Isometric", 205.0, 35.0),
    ("Bottom", 180.0, -90.0),
];

/// A camera that frames the model in one of the standard views.
pub fn standard(view: usize, projection: Projection) -> CameraSpec {
    let (_, azimuth_degrees, elevation_degrees) = VIEWS[view.min(VIEWS.len() - 1)];
    CameraSpec::Framing(FramingCamera {
        azimuth_degrees,
        elevation_degrees,
        zoom: 1.0,
        projection,
    })
}

/// A camera that frames what is drawn, of which points are given, from where a scene's camera looks.
pub fn frame_all(
    scene: &CameraSpec,
    camera: &Camera,
    points: &[DVec3],
    corners: &[DVec3; 8],
    aspect: f64,
) -> CameraSpec {
    let [x, y, z] = camera.forward.to_array();
    let is_level = camera.right.z.abs() < 1e-6 && camera.up.z > 1e-6;
    match scene {
        CameraSpec::Framing(framing) => CameraSpec::Framing(FramingCamera {
            zoom: 1.0,
            ..framing.clone()
        }),
        CameraSpec::Automatic(automatic) => CameraSpec::Automatic(AutomaticCamera {
            zoom: 1.0,
            ..automatic.clone()
        }),
        CameraSpec::Explicit(_) if is_level => CameraSpec::Framing(FramingCamera {
            azimuth_degrees: (-x).atan2(-y).to_degrees().rem_euclid(360.0),
            elevation_degrees: (-z).clamp(-1.0, 1.0).asin().to_degrees(),
            zoom: 1.0,
            projection: camera.projection(),
        }),
        CameraSpec::Explicit(_) => spec(&camera.framed(points, aspect), corners),
    }
}

/// A scene's camera in the other projection; the middle of the model keeps its size, or the model is framed
/// where it was.
pub fn switched(scene: &CameraSpec, camera: &Camera, corners: &[DVec3; 8]) -> CameraSpec {
    let other = camera.projection().other();
    match scene {
        CameraSpec::Framing(framing) => CameraSpec::Framing(FramingCamera {
            projection: other,
            ..framing.clone()
        }),
        CameraSpec::Automatic(automatic) => CameraSpec::Automatic(AutomaticCamera {
            projection: other,
            ..automatic.clone()
        }),
        CameraSpec::Explicit(_) => spec(&camera.with(other, middle(corners)), corners),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera::look_at(DVec3::new(0.0, -10.0, 5.0), DVec3::ZERO, DVec3::Z, 0.5).unwrap()
    }

    /// A camera on a box of 4 by 3 by 2 around the origin, as a scene's explicit one.
    fn seen(spec: &CameraSpec) -> View {
        let mut view = crate::picture::test_view([300, 200], 1.0);
        view.world.spaces = crate::model::Spaces::new(None, 2.0);
        view.world.corners = view.corners_of(BOUNDS);
        view.world.subject = crate::view::Subject::of_box(view.world.corners).into();
        view.seen_from(spec, [300, 200]).unwrap()
    }

    const BOUNDS: [DVec3; 2] = [DVec3::new(-2.0, -1.5, -0.5), DVec3::new(2.0, 1.5, 0.5)];

    fn explicit(projection: Projection) -> CameraSpec {
        let corners = seen(&standard(0, projection)).world.corners;
        let camera = camera().with(projection, DVec3::ZERO);
        spec(&camera, &corners)
    }

    #[test]
    fn cameras_come_back_from_their_scenes() {
        for projection in [Projection::Perspective, Projection::Parallel] {
            let view = seen(&explicit(projection));
            let again = seen(&spec(&view.camera, &view.world.corners)).camera;
            assert!(again.eye.distance(view.camera.eye) < 1e-9);
            assert_eq!(again.parallel.is_some(), projection == Projection::Parallel);
            let heights = [again, view.camera].map(|c| c.half_height(c.depth(DVec3::ZERO)));
            assert!((heights[0] - heights[1]).abs() < 1e-9);
            // The plane of a parallel one that has come into the model is put before it.
            let inside = Camera {
                eye: DVec3::ZERO,
                ..view.camera
            };
            let moved = seen(&spec(&inside, &view.world.corners)).camera;
            let is_before = view.world.corners.iter().all(|c| moved.depth(*c) > 0.0);
            assert_eq!(is_before, projection == Projection::Parallel);
        }
    }

    #[test]
    fn framing_all_keeps_the_direction() {
        for projection in [Projection::Perspective, Projection::Parallel] {
            for start in [explicit(projection), standard(3, projection)] {
                let view = seen(&start);
                let near = zoom(&view.camera, DVec3::new(1.0, 1.0, 0.0), 5.0);
                let all = seen(&frame_all(
                    &spec(&near, &view.world.corners),
                    &near,
                    &view.world.subject.points,
                    &view.world.corners,
                    1.5,
                ));
                assert!(all.camera.forward.distance(view.camera.forward) < 1e-9);
                assert_eq!(all.camera.projection(), projection);
                let is_in = |c: &DVec3| {
                    let at = all.camera.project(*c, 1.5).unwrap();
                    at.min_element() > 0.0 && at.max_element() < 1.0
                };
                assert!(view.world.corners.iter().all(is_in));
                let outside = |c: &DVec3| {
                    near.project(*c, 1.5)
                        .is_none_or(|at| (at - 0.5).abs().max_element() > 0.5)
                };
                assert!(view.world.corners.iter().any(outside));
            }
        }
    }

    #[test]
    fn switching_there_and_back_changes_nothing() {
        for start in [
            explicit(Projection::Perspective),
            standard(5, Projection::Perspective),
        ] {
            let view = seen(&start);
            let parallel = switched(&start, &view.camera, &view.world.corners);
            assert_eq!(parallel.projection(), Projection::Parallel);
            let there = seen(&parallel);
            let back = seen(&switched(&parallel, &there.camera, &there.world.corners)).camera;
            assert!(back.eye.distance(view.camera.eye) < 1e-9 && back.parallel.is_none());
        }
    }

    #[test]
    fn the_point_under_the_pointer_is_half_way_through_what_is_drawn() {
        for projection in [Projection::Perspective, Projection::Parallel] {
            let view = seen(&explicit(projection));
            let at = view.camera.project(DVec3::new(0.5, 0.2, 0.1), 1.5).unwrap();
            // The eastern half of the model.
            let drawn = [BOUNDS[0].with_x(0.0), BOUNDS[1]];
            let point = point_under(&view, Some(drawn), at);
            assert!(view.camera.project(point, 1.5).unwrap().distance(at) < 1e-9);
            let [low, high] = drawn.map(|p| view.world.spaces.world_from_grid.transform_point3(p));
            assert!(point.cmpge(low.min(high)).all() && point.cmple(low.max(high)).all());
            // Beside it and with nothing drawn: the middles.
            let beside = point_under(&view, Some(drawn), DVec2::new(0.01, 0.01));
            assert!(beside.distance(DVec3::X) < 1e-9);
            assert!(point_under(&view, None, at).length() < 1e-9);
        }
    }

    #[test]
    fn a_parallel_camera_zooms_by_its_height() {
        let parallel = camera().with(Projection::Parallel, DVec3::ZERO);
        let point = DVec3::new(1.0, 2.0, 0.5);
        let near = zoom(&parallel, point, 2.0);
        let (a, b) = (parallel.project(point, 1.5), near.project(point, 1.5));
        assert!((a.unwrap() - b.unwrap()).length() < 1e-9);
        assert_eq!(near.parallel, parallel.parallel.map(|h| 0.5 * h));
        assert!((near.depth(point) - parallel.depth(point)).abs() < 1e-9);
        let moved = pan(&parallel, point, DVec2::new(0.25, -0.1));
        let by = moved.project(point, 1.0).unwrap() - parallel.project(point, 1.0).unwrap();
        assert!((by - DVec2::new(0.25, -0.1)).length() < 1e-9);
    }

    #[test]
    fn keys_turn_by_their_angle() {
        let angle = 10f64.to_radians();
        let turned = rotate(&camera(), DVec3::ZERO, drag_of(DVec2::new(angle, 0.0)));
        let [a, b] = [camera(), turned].map(|c| c.forward.truncate());
        assert!((a.angle_to(b).abs() - angle).abs() < 1e-9);
        let up = rotate(&camera(), DVec3::ZERO, drag_of(DVec2::new(0.0, angle)));
        assert!((up.forward.angle_between(camera().forward) - angle).abs() < 1e-9);
        assert!(up.eye.z > camera().eye.z);
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
