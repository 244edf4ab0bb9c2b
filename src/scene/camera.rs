//! A perspective camera in world space.

use glam::{DQuat, DVec2, DVec3};

/// A pinhole camera with an orthonormal frame.
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
}

impl Camera {
    /// A camera at `eye` that looks at `target`; `None` where the three do not span a frame.
    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3, fovy_radians: f64) -> Option<Self> {
        let forward = (target - eye).try_normalize()?;
        let right = forward.cross(up).try_normalize()?;
        Some(Self {
            eye,
            forward,
            right,
            up: right.cross(forward),
            tan_half_fovy: (0.5 * fovy_radians).tan(),
        })
    }

    /// A camera that frames a box, given by its corners in world space, from a direction.
    ///
    /// `azimuth` is the compass direction of the camera as seen from the box (0 north, 90 east),
    /// `aspect` width over height; a `zoom` above 1 comes closer.
    pub fn framing(
        corners: &[DVec3; 8],
        azimuth_radians: f64,
        elevation_radians: f64,
        zoom: f64,
        aspect: f64,
    ) -> Option<Self> {
        let fovy = 30f64.to_radians();
        let center = corners.iter().sum::<DVec3>() / 8.0;
        let (sin_a, cos_a) = azimuth_radians.sin_cos();
        let (sin_e, cos_e) = elevation_radians.sin_cos();
        let towards_eye = DVec3::new(sin_a * cos_e, cos_a * cos_e, sin_e);
        // Straight above or below, north is up.
        let up = if cos_e.abs() < 1e-6 {
            DVec3::Y
        } else {
            DVec3::Z
        };
        let mut camera = Self::look_at(center + towards_eye, center, up, fovy)?;
        camera.eye = center + towards_eye * (camera.framing_distance(corners, aspect) / zoom);
        Some(camera)
    }

    /// The nearest distance from the middle of a box, given by its corners, at which all of them are
    /// inside the picture of a camera that looks there in this one's direction.
    pub fn framing_distance(&self, corners: &[DVec3; 8], aspect: f64) -> f64 {
        let center = corners.iter().sum::<DVec3>() / 8.0;
        let tan = DVec2::new(self.tan_half_fovy * aspect, self.tan_half_fovy) / 1.08;
        let distances = corners.iter().map(|corner| {
            let corner = corner - center;
            let (x, y) = (corner.dot(self.right).abs(), corner.dot(self.up).abs());
            (x / tan.x).max(y / tan.y) - corner.dot(self.forward)
        });
        distances.fold(1e-9, f64::max)
    }

    /// Takes cameras that look at the middle of a box, each from as far as the first one, as far away as
    /// the one that needs the most: with one distance the box does not shrink and grow between them. How
    /// close the first one is (its zoom) counts for all.
    pub fn stand_back(cameras: &mut [Self], corners: &[DVec3; 8], aspect: f64) {
        let needs = |camera: &Self| camera.framing_distance(corners, aspect);
        let Some(first) = cameras.first().map(needs) else {
            return;
        };
        let most = cameras.iter().map(needs).fold(0.0, f64::max);
        let middle = corners.iter().sum::<DVec3>() / 8.0;
        for camera in cameras {
            camera.eye += (most / first - 1.0) * (camera.eye - middle);
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

    /// Picture position (x right, y down, 0..1) of a world point in front of the camera.
    pub fn project(&self, point: DVec3, aspect: f64) -> Option<DVec2> {
        let v = point - self.eye;
        let depth = v.dot(self.forward);
        (depth > 1e-9).then(|| {
            let x = v.dot(self.right) / (depth * self.tan_half_fovy * aspect);
            let y = v.dot(self.up) / (depth * self.tan_half_fovy);
            DVec2::new(0.5 + 0.5 * x, 0.5 - 0.5 * y)
        })
    }
}
