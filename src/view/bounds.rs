//! The box around the model in world space, and the vertical exaggeration that suits it.

use glam::DVec3;

use crate::case::Case;
use crate::model::{Space, Spaces};

/// Corners of the model's box in world space, at a vertical exaggeration or the one that suits it; `None` of a
/// model without active cells.
pub fn model_corners(case: &Case, exaggeration: Option<f64>) -> Option<[DVec3; 8]> {
    let bounds = case.grid.bounds()?;
    let factor = exaggeration.unwrap_or_else(|| automatic_exaggeration(bounds, case.grid.space()));
    let spaces = Spaces::new(case.grid.map_axes(), factor);
    Some(box_corners(&spaces, bounds))
}

/// Makes the model a quarter as high as it is wide, in the steps that engineers use; in index space, where nothing has a
/// true shape, one that is higher than wide about as high as wide.
pub(super) fn automatic_exaggeration(bounds: [DVec3; 2], space: Space) -> f64 {
    let size = bounds[1] - bounds[0];
    let width = size.x.max(size.y) / size.z.max(1e-9);
    let wanted = match space {
        Space::Ijk if width < 1.0 => width,
        _ => (0.25 * width).max(1.0),
    };
    let steps = [
        0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0, 15.0, 20.0, 30.0, 50.0,
    ];
    steps
        .into_iter()
        .rev()
        .find(|&s| s <= wanted)
        .unwrap_or(0.02)
}

/// Corners of the model's box, whose sides follow the grid's axes, in world space.
pub(super) fn box_corners(spaces: &Spaces, [low, high]: [DVec3; 2]) -> [DVec3; 8] {
    std::array::from_fn(|c| {
        let pick = |axis: usize| {
            if c >> axis & 1 == 1 {
                high[axis]
            } else {
                low[axis]
            }
        };
        let corner = DVec3::new(pick(0), pick(1), pick(2));
        spaces.world_from_grid.transform_point3(corner)
    })
}

/// Edges of the model's box along the grid's axes, in world space.
pub(super) fn box_edges(corners: &[DVec3; 8]) -> DVec3 {
    DVec3::from_array([1, 2, 4].map(|c| corners[c].distance(corners[0])))
}

/// Smallest and largest corner of points.
pub(super) fn bounds_of(points: &[DVec3]) -> [DVec3; 2] {
    let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    points
        .iter()
        .fold(start, |[a, b], p| [a.min(*p), b.max(*p)])
}
