//! Cameras as scenes have them.

use serde::{Deserialize, Serialize};

/// How a camera maps the world to its picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Projection {
    /// Rays go out from the eye: what is far is small.
    #[default]
    Perspective,
    /// Rays start on the plane through the eye at right angles to the viewing direction and all run along
    /// that: equal lengths look equal.
    Parallel,
}

impl Projection {
    /// True for what scenes need not say.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// The other one.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Perspective => Self::Parallel,
            Self::Parallel => Self::Perspective,
        }
    }
}

/// A camera in world coordinates, or one that frames what is drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "camera must have azimuth_degrees, elevation_degrees and zoom, or eye, target and up"
)]
pub enum CameraSpec {
    /// Explicit position.
    Explicit(ExplicitCamera),
    /// Direction only; position and distance frame what is drawn.
    Framing(FramingCamera),
    /// The same from the direction that suits the shape of what is drawn.
    Automatic(AutomaticCamera),
}

/// A camera placed in world coordinates.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExplicitCamera {
    /// Position.
    pub eye: [f64; 3],
    /// Point in the middle of the picture.
    pub target: [f64; 3],
    /// Direction that is up in the picture.
    #[serde(default = "z_up")]
    pub up: [f64; 3],
    /// Vertical field of view.
    #[serde(default = "default_fovy")]
    pub fovy_degrees: f64,
    /// A parallel picture is as high as the field of view is at the target, so that switching keeps the size
    /// of what is there. Nothing behind the plane through the eye is seen.
    #[serde(default, skip_serializing_if = "Projection::is_default")]
    pub projection: Projection,
}

/// A camera that frames what is drawn from a direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FramingCamera {
    /// Compass direction in which the camera stands as seen from the model: 0 north, 90 east.
    pub azimuth_degrees: f64,
    /// Height above the horizon.
    pub elevation_degrees: f64,
    /// Above 1 comes closer.
    #[serde(default = "one")]
    pub zoom: f64,
    /// Perspective or parallel; either frames what is drawn.
    #[serde(default, skip_serializing_if = "Projection::is_default")]
    pub projection: Projection,
}

/// A camera that frames what is drawn from the direction that suits its shape.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AutomaticCamera {
    /// Above 1 comes closer.
    pub zoom: f64,
    /// Perspective or parallel.
    #[serde(skip_serializing_if = "Projection::is_default")]
    pub projection: Projection,
}

impl Default for AutomaticCamera {
    fn default() -> Self {
        Self {
            zoom: 1.0,
            projection: Projection::Perspective,
        }
    }
}

impl CameraSpec {
    /// Its projection.
    pub fn projection(&self) -> Projection {
        match self {
            Self::Explicit(camera) => camera.projection,
            Self::Framing(camera) => camera.projection,
            Self::Automatic(camera) => camera.projection,
        }
    }

    /// Its zoom where it frames what is drawn; `None` of an explicit camera.
    pub fn framing_zoom(&self) -> Option<f64> {
        match self {
            Self::Explicit(_) => None,
            Self::Framing(camera) => Some(camera.zoom),
            Self::Automatic(camera) => Some(camera.zoom),
        }
    }
}

impl Default for CameraSpec {
    fn default() -> Self {
        Self::Automatic(AutomaticCamera::default())
    }
}

fn z_up() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

fn default_fovy() -> f64 {
    30.0
}

fn one() -> f64 {
    1.0
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn scenes_name_a_projection_only_where_it_is_parallel() {
        for plain in [
            r#"{"eye":[1.0,2.0,3.0],"target":[0.0,0.0,0.0],"up":[0.0,0.0,1.0],"fovy_degrees":30.0}"#,
            r#"{"azimuth_degrees":1.0,"elevation_degrees":2.0,"zoom":1.0}"#,
        ] {
            let parallel = plain.replace('}', r#","projection":"parallel"}"#);
            for (text, projection) in [
                (plain, Projection::Perspective),
                (&parallel, Projection::Parallel),
            ] {
                let spec: CameraSpec = serde_json::from_str(text).unwrap();
                assert_eq!(spec.projection(), projection);
                assert_eq!(serde_json::to_string(&spec).unwrap(), text);
            }
            let wrong = plain.replace('}', r#","projection":"fisheye"}"#);
            assert!(serde_json::from_str::<CameraSpec>(&wrong).is_err());
        }
    }
}
