//! Spaces and the transforms between them; the one place where depth changes sign.
//!
//! | space | axes | units |
//! | --- | --- | --- |
//! | grid | x, y as in COORD, depth positive down | the file's length unit |
//! | map | x east, y north (MAPAXES applied), depth positive down | the same unit |
//! | world | x east, y north, z = -depth * vertical exaggeration | the same unit |

use glam::{DAffine3, DMat3, DVec2, DVec3};

/// The map coordinate system of a grid (MAPAXES): `map = origin + x * ex + y * ey`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapAxes {
    /// Map position of the grid's origin.
    pub origin: DVec2,
    /// Unit vector of the grid's x axis in the map.
    pub ex: DVec2,
    /// Unit vector of the grid's y axis in the map.
    pub ey: DVec2,
}

impl MapAxes {
    /// Axes from the six numbers of MAPAXES: a point on the y axis, the origin, a point on the x axis.
    ///
    /// `None` where the points coincide or the axes are parallel, so that no map is defined.
    pub fn from_keyword(v: [f64; 6]) -> Option<Self> {
        let origin = DVec2::new(v[2], v[3]);
        let ex = (DVec2::new(v[4], v[5]) - origin).try_normalize()?;
        let ey = (DVec2::new(v[0], v[1]) - origin).try_normalize()?;
        (ex.perp_dot(ey).abs() > 1e-6).then_some(Self { origin, ex, ey })
    }
}

/// The transforms between grid, map and world space of one picture.
#[derive(Debug, Clone, Copy)]
pub struct Spaces {
    /// World from grid space (grid z is depth, positive down).
    pub world_from_grid: DAffine3,
    /// Its inverse.
    pub grid_from_world: DAffine3,
}

impl Spaces {
    /// Spaces for map axes (identity where absent) and a vertical exaggeration above zero.
    pub fn new(axes: Option<MapAxes>, vertical_exaggeration: f64) -> Self {
        let axes = axes.unwrap_or(MapAxes {
            origin: DVec2::ZERO,
            ex: DVec2::X,
            ey: DVec2::Y,
        });
        let world_from_grid = DAffine3::from_mat3_translation(
            DMat3::from_cols(
                axes.ex.extend(0.0),
                axes.ey.extend(0.0),
                DVec3::new(0.0, 0.0, -vertical_exaggeration),
            ),
            axes.origin.extend(0.0),
        );
        Self {
            world_from_grid,
            grid_from_world: world_from_grid.inverse(),
        }
    }
}
