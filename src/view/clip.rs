//! Clip planes, checked.

use glam::DVec3;

use super::View;
use super::error::{SceneError, wrong};
use crate::scene::{ClipSpec, CutFace, Mode};

/// A plane in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClipPlane {
    /// A point of it.
    pub point: DVec3,
    /// Unit length, points to the part that is kept.
    pub normal: DVec3,
    /// Its section through the cells is opaque.
    pub opaque: bool,
}

/// Clip planes at most; what a frame's uniform has room for.
pub const MAX_CLIP_PLANES: usize = 8;

/// Checks the planes of a scene.
pub(super) fn planes(planes: &[ClipSpec], mode: Mode) -> Result<Vec<ClipPlane>, SceneError> {
    if planes.len() > MAX_CLIP_PLANES {
        let problem = format!(
            "has {} planes; at most {MAX_CLIP_PLANES} are possible",
            planes.len()
        );
        return Err(wrong("clip", problem));
    }
    let resolve = |plane: &ClipSpec| {
        let point = DVec3::from_array(plane.point);
        if !point.is_finite() {
            return Err(wrong("clip.point", "must be three finite numbers"));
        }
        let normal = DVec3::from_array(plane.normal)
            .try_normalize()
            .ok_or_else(|| wrong("clip.normal", "must have a length above 0"))?;
        let opaque = plane.face == CutFace::Opaque || mode == Mode::Cells;
        Ok(ClipPlane {
            point,
            normal,
            opaque,
        })
    };
    planes.iter().map(resolve).collect()
}

impl View {
    /// True where a point of world space lies on the kept side of every clip plane.
    pub fn keeps(&self, point: DVec3) -> bool {
        let mut planes = self.shown.clip.iter();
        planes.all(|plane| (point - plane.point).dot(plane.normal) >= 0.0)
    }
}
