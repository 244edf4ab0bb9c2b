//! A camera in world space, perspective or parallel.

use glam::{DQuat, DVec2, DVec3};

mod fit;

pub use fit::{Framed, MARGINS, Margins};

use crate::scene::Projection;

/// A camera with an orthonormal frame. Distances of samples count from the eye, or in parallel from the
/// plane through it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Position in world space.
    pub eye: DVec3,
    /// Viewing direction, unit length.
    pub forward: DVec3,
    /// To the right in the picture, unit length.
    pub right: DVec3,
    /// Up in the picture, unit length.
    pub up: DVec3,
    /// Tangent of half the vertical field of view.
    pub tan_half_fovy: f64,
    /// Half the height of a parallel picture, in world space; `None` in perspective.
    pub parallel: Option<f64>,
}

/// Vertical field of view of cameras that frame something.
const FOVY: f64 = std::f64::consts::PI / 6.0;
/// Size of the picture over that of what is framed from all around, about one point.
const AROUND: f64 = 1.08;

impl Camera {
    /// A perspective camera at `eye` that looks at `target`; `None` where the three do not span a frame.
    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3, fovy_radians: f64) -> Option<Self> {
        let forward = (target - eye).try_normalize()?;
        let right = forward.cross(up).try_normalize()?;
        Some(Self {
            eye,
            forward,
            right,
            up: right.cross(forward),
            tan_half_fovy: (0.5 * fovy_radians).tan(),
            parallel: None,
        })
    }

    /// A camera that looks at the origin from a direction.
    ///
    /// `azimuth` is the compass direction in which the camera stands (0 north, 90 east).
    pub fn facing(
        azimuth_radians: f64,
        elevation_radians: f64,
        projection: Projection,
    ) -> Option<Self> {
        let (sin_a, cos_a) = azimuth_radians.sin_cos();
        let (sin_e, cos_e) = elevation_radians.sin_cos();
        let towards_eye = DVec3::new(sin_a * cos_e, cos_a * cos_e, sin_e);
        // Straight above or below, north is up.
        let up = if cos_e.abs() < 1e-6 {
            DVec3::Y
        } else {
            DVec3::Z
        };
        let camera = Self::look_at(towards_eye, DVec3::ZERO, up, FOVY)?;
        Some(camera.with(projection, DVec3::ZERO))
    }

    /// A camera that frames points from a direction; see [`Self::facing`] and [`Self::framed`].
    ///
    /// `aspect` is width over height; a `zoom` above 1 comes closer.
    pub fn framing(
        points: &[DVec3],
        azimuth_radians: f64,
        elevation_radians: f64,
        zoom: f64,
        aspect: f64,
        projection: Projection,
    ) -> Option<Self> {
        let camera = Self::facing(azimuth_radians, elevation_radians, projection)?;
        let margins = MARGINS;
        Some(camera.framed_within(&[Framed { points, margins }], aspect, zoom))
    }

    /// The camera in this one's direction that looks at a point and has all others in its picture.
    #[must_use]
    pub fn framed_around(self, points: &[DVec3], pivot: DVec3, aspect: f64) -> Self {
        let need = self.need(points, pivot, aspect);
        let radii = points.iter().map(|p| p.distance(pivot));
        let distance = match self.parallel {
            None => need,
            Some(_) => (need / self.tan_half_fovy).max(1.01 * radii.fold(0.0, f64::max)),
        };
        Self {
            eye: pivot - distance * self.forward,
            parallel: self.parallel.map(|_| need),
            ..self
        }
    }

    /// What a camera in this one's direction that looks at a point needs to have others in its picture: in
    /// perspective the distance, in parallel half the height.
    fn need(&self, points: &[DVec3], pivot: DVec3, aspect: f64) -> f64 {
        let needs = points.iter().map(|point| {
            let point = *point - pivot;
            let (x, y) = (point.dot(self.right).abs(), point.dot(self.up).abs());
            let half_height = AROUND * (x / aspect).max(y);
            match self.parallel {
                None => half_height / self.tan_half_fovy - point.dot(self.forward),
                Some(_) => half_height,
            }
        });
        needs.fold(1e-9, f64::max)
    }

    /// Takes cameras that look at a point, each from as far as the first one, as far away as the one that needs
    /// the most to have others in its picture: with one distance these do not shrink and grow between them. How
    /// close the first one is (its zoom) counts for all. Of parallel ones it is the height that counts.
    pub fn stand_back(cameras: &mut [Self], points: &[DVec3], pivot: DVec3, aspect: f64) {
        let needs = |camera: &Self| camera.need(points, pivot, aspect);
        let Some(first) = cameras.first().map(needs) else {
            return;
        };
        let most = cameras.iter().map(needs).fold(0.0, f64::max);
        for camera in cameras {
            *camera = camera.closer(pivot, first / most);
        }
    }

    /// This camera carried around a point.
    #[must_use]
    pub fn turned(self, middle: DVec3, turn: DQuat) -> Self {
        let arm = self.eye - middle;
        Self {
            // Written such that no turn is exactly no change.
            eye: self.eye + (turn * arm - arm),
            forward: turn * self.forward,
            right: turn * self.right,
            up: turn * self.up,
            ..self
        }
    }

    /// This camera closer to a point by a factor above 1, or farther by one below; the point keeps its place
    /// in the picture. In parallel the picture's height changes, and no distance.
    #[must_use]
    pub fn closer(self, to: DVec3, factor: f64) -> Self {
        let way = to - self.eye;
        let moved = match self.parallel {
            None => way,
            Some(_) => way - self.depth(to) * self.forward,
        };
        Self {
            // Written such that a factor of 1 is exactly no change.
            eye: self.eye + (1.0 - 1.0 / factor) * moved,
            parallel: self.parallel.map(|half_height| half_height / factor),
            ..self
        }
    }

    /// Its projection.
    pub fn projection(&self) -> Projection {
        match self.parallel {
            None => Projection::Perspective,
            Some(_) => Projection::Parallel,
        }
    }

    /// This camera in a projection; what lies as deep as `at` keeps its size in the picture.
    #[must_use]
    pub fn with(self, projection: Projection, at: DVec3) -> Self {
        let depth = self.depth(at);
        match (projection, self.parallel) {
            (Projection::Parallel, None) => Self {
                parallel: Some(depth.max(1e-9) * self.tan_half_fovy),
                ..self
            },
            (Projection::Perspective, Some(half_height)) => Self {
                eye: self.eye + (depth - half_height / self.tan_half_fovy) * self.forward,
                parallel: None,
                ..self
            },
            _ => self,
        }
    }

    /// A parallel camera moved back until a box lies before the plane of its eye, which changes nothing else
    /// in the picture; a perspective one as it is.
    #[must_use]
    pub fn before(self, corners: &[DVec3; 8]) -> Self {
        let depths = corners.iter().map(|c| self.depth(*c));
        let behind = -depths.fold(f64::INFINITY, f64::min);
        if self.parallel.is_none() || behind < 0.0 {
            return self;
        }
        let back = behind + 0.01 * corners[0].distance(corners[7]);
        Self {
            eye: self.eye - back * self.forward,
            ..self
        }
    }

    /// Distance of a point from the plane through the eye, along the viewing direction.
    pub fn depth(&self, point: DVec3) -> f64 {
        (point - self.eye).dot(self.forward)
    }

    /// Half the height of the picture at a depth, in world space.
    pub fn half_height(&self, depth: f64) -> f64 {
        self.parallel.unwrap_or(depth * self.tan_half_fovy)
    }

    /// Origin and unit direction of the ray through a place in the picture (x right, y down, 0..1).
    pub fn ray(&self, at: DVec2, aspect: f64) -> (DVec3, DVec3) {
        let half_height = self.half_height(1.0);
        let across = (2.0 * at.x - 1.0) * half_height * aspect * self.right
            + (1.0 - 2.0 * at.y) * half_height * self.up;
        match self.parallel {
            None => (self.eye, (self.forward + across).normalize()),
            Some(_) => (self.eye + across, self.forward),
        }
    }

    /// Unit vector from a point to the viewer, whom in parallel all points see in the same direction, and the
    /// distance at which the point's ray comes to it.
    pub fn to_viewer(&self, point: DVec3) -> (DVec3, f64) {
        match self.parallel {
            None => (self.eye - point).normalize_and_length(),
            Some(_) => (-self.forward, self.depth(point)),
        }
    }

    /// Picture position (x right, y down, 0..1) of a world point in front of the camera.
    pub fn project(&self, point: DVec3, aspect: f64) -> Option<DVec2> {
        let v = point - self.eye;
        let depth = self.depth(point);
        (depth > 1e-9).then(|| {
            let half_height = self.half_height(depth);
            let x = v.dot(self.right) / (half_height * aspect);
            let y = v.dot(self.up) / half_height;
            DVec2::new(0.5 + 0.5 * x, 0.5 - 0.5 * y)
        })
    }
}

/// Middle of a box, given by its corners.
pub fn middle(corners: &[DVec3; 8]) -> DVec3 {
    corners.iter().sum::<DVec3>() / 8.0
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    fn corners() -> [DVec3; 8] {
        std::array::from_fn(|c| {
            let pick = |axis: usize, far: f64| far * (c >> axis & 1) as f64;
            DVec3::new(pick(0, 40.0), pick(1, 30.0), pick(2, 10.0))
        })
    }

    fn framing(projection: Projection, zoom: f64) -> Camera {
        Camera::framing(&corners(), 2.0, 0.5, zoom, 1.5, projection).unwrap()
    }

    #[test]
    fn framed_boxes_fill_the_picture_in_both_projections() {
        for projection in [Projection::Perspective, Projection::Parallel] {
            let camera = framing(projection, 1.0);
            let away = corners().map(|c| (camera.project(c, 1.5).unwrap() - 0.5).abs());
            let most = away.iter().fold(0.0, |m: f64, a| m.max(a.max_element()));
            assert!(most > 0.4 && most < 0.5, "{most}");
            // The twin: a closer one does not hold it.
            let near = framing(projection, 1.3);
            let out = |c: &DVec3| (near.project(*c, 1.5).unwrap() - 0.5).abs().max_element() > 0.5;
            assert!(corners().iter().any(out));
        }
    }

    #[test]
    fn switching_keeps_the_size_of_what_is_at_the_target() {
        let target = DVec3::new(20.0, 15.0, 5.0);
        let beside = |camera: &Camera, depth: f64| {
            let point = target + depth * camera.forward + 3.0 * camera.up;
            camera.project(point, 1.5).unwrap()
        };
        let perspective = framing(Projection::Perspective, 1.0);
        let parallel = perspective.with(Projection::Parallel, target);
        assert!(beside(&perspective, 0.0).distance(beside(&parallel, 0.0)) < 1e-12);
        assert!(beside(&perspective, 9.0).distance(beside(&parallel, 9.0)) > 1e-3);
        let back = parallel.with(Projection::Perspective, target);
        assert!(back.eye.distance(perspective.eye) < 1e-9 && back.parallel.is_none());
    }

    #[test]
    fn rays_pass_through_what_is_projected() {
        let at = DVec2::new(0.2, 0.7);
        for projection in [Projection::Perspective, Projection::Parallel] {
            let camera = framing(projection, 1.0);
            let (origin, direction) = camera.ray(at, 1.5);
            for distance in [1.0, 70.0] {
                let seen = camera.project(origin + distance * direction, 1.5).unwrap();
                assert!(seen.distance(at) < 1e-12);
            }
            let other = framing(projection.other(), 1.0).project(origin + 70.0 * direction, 1.5);
            assert!(other.unwrap().distance(at) > 1e-3);
        }
    }

    #[test]
    fn the_plane_of_a_framing_camera_never_cuts_the_box() {
        for zoom in [0.5, 1.0, 30.0] {
            let camera = framing(Projection::Parallel, zoom);
            for degrees in (0..360).step_by(20) {
                let turn = DQuat::from_rotation_z(f64::from(degrees).to_radians());
                let turned = camera.turned(middle(&corners()), turn);
                assert!(corners().iter().all(|c| turned.depth(*c) > 0.0));
                assert_eq!(turned.before(&corners()), turned);
            }
            // The twin: one moved into it, which is moved out again along its axis.
            let inside = Camera {
                eye: middle(&corners()),
                ..camera
            };
            let before = inside.before(&corners());
            assert!(corners().iter().all(|c| before.depth(*c) > 0.0) && before != inside);
            assert!((before.eye - inside.eye).cross(camera.forward).length() < 1e-9);
        }
    }
}
