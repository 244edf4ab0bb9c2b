//! Spaces and the transforms between them; the one place where depth changes sign.
//!
//! | space | axes | units |
//! | --- | --- | --- |
//! | grid | x, y as in COORD, depth positive down | the file's length unit (GRIDUNIT) |
//! | world | x east, y north (MAPAXES applied), z = -depth * vertical exaggeration | the same unit |
//! | map | x east, y north, depth positive down | x and y in the map's unit (MAPUNITS), depth in the grid's |
//!
//! In index space the grid's x, y and depth are I, J and K.

use glam::{DAffine3, DMat3, DVec2, DVec3};

/// What places of cells go by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Space {
    /// Their true geometry.
    Map,
    /// Their numbers I, J and K: flat layers and square columns (simbox).
    Ijk,
}

impl Space {
    /// True of the true geometry.
    pub fn is_map(&self) -> bool {
        *self == Self::Map
    }
}

/// The map coordinate system of a grid (MAPAXES): `map = origin + x * ex + y * ey`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapAxes {
    /// Map position of the grid's origin, in the grid's length unit.
    pub origin: DVec2,
    /// Unit vector of the grid's x axis in the map.
    pub ex: DVec2,
    /// Unit vector of the grid's y axis in the map.
    pub ey: DVec2,
    /// Unit of map coordinates where it is not the grid's.
    pub unit: Option<MapUnit>,
}

/// A length unit of map coordinates that is not the grid's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapUnit {
    /// Its name, as in MAPUNITS.
    pub name: &'static str,
    /// Its length in the grid's length unit.
    pub length: f64,
}

impl MapAxes {
    /// Axes from the six numbers of MAPAXES: a point on the y axis, the origin, a point on the x axis.
    ///
    /// `None` where the points coincide or the axes are parallel, so that no map is defined.
    pub fn from_keyword(v: [f64; 6]) -> Option<Self> {
        let origin = DVec2::new(v[2], v[3]);
        let ex = (DVec2::new(v[4], v[5]) - origin).try_normalize()?;
        let ey = (DVec2::new(v[0], v[1]) - origin).try_normalize()?;
        (ex.perp_dot(ey).abs() > 1e-6).then_some(Self {
            origin,
            ex,
            ey,
            unit: None,
        })
    }

    /// The same axes, whose six numbers were in a unit that is not the grid's.
    #[must_use]
    pub fn in_unit(self, unit: MapUnit) -> Self {
        Self {
            origin: self.origin * unit.length,
            unit: Some(unit),
            ..self
        }
    }
}

/// The transforms between grid, map and world space of one picture.
#[derive(Debug, Clone, Copy)]
pub struct Spaces {
    /// World from grid space (grid z is depth, positive down).
    pub world_from_grid: DAffine3,
    /// Its inverse.
    pub grid_from_world: DAffine3,
    /// Unit of map coordinates where it is not the grid's.
    pub map_unit: Option<MapUnit>,
    vertical_exaggeration: f64,
}

impl Spaces {
    /// Spaces for map axes (identity where absent) and a vertical exaggeration above zero.
    pub fn new(axes: Option<MapAxes>, vertical_exaggeration: f64) -> Self {
        let axes = axes.unwrap_or(MapAxes {
            origin: DVec2::ZERO,
            ex: DVec2::X,
            ey: DVec2::Y,
            unit: None,
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
            map_unit: axes.unit,
            vertical_exaggeration,
        }
    }

    /// Easting, northing and depth of a point in world space.
    pub fn map_from_world(&self, world: DVec3) -> DVec3 {
        let unit = self.map_unit.map_or(1.0, |unit| unit.length);
        let depth = -world.z / self.vertical_exaggeration;
        (world.truncate() / unit).extend(depth)
    }

    /// The point in world space of an easting, a northing and a depth.
    pub fn world_from_map(&self, map: DVec3) -> DVec3 {
        map * self.map_scale()
    }

    /// From eastings, northings and depths to world space.
    pub fn map_to_world(&self) -> DAffine3 {
        DAffine3::from_scale(self.map_scale())
    }

    fn map_scale(&self) -> DVec3 {
        let unit = self.map_unit.map_or(1.0, |unit| unit.length);
        DVec3::new(unit, unit, -self.vertical_exaggeration)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_in_metres_of_grids_in_feet() {
        let keyword = [5e5, 100_100.0, 5e5, 1e5, 500_100.0, 1e5];
        let feet = MapUnit {
            name: "METRES",
            length: 1.0 / 0.3048,
        };
        let axes = MapAxes::from_keyword(keyword).map(|axes| axes.in_unit(feet));
        let spaces = Spaces::new(axes, 5.0);
        let world = spaces
            .world_from_grid
            .transform_point3(DVec3::new(600.0, 0.0, 2000.0));
        let map = spaces.map_from_world(world);
        assert!(
            map.distance(DVec3::new(500_182.88, 1e5, 2000.0)) < 1e-6,
            "{map}"
        );
        assert!(spaces.world_from_map(map).distance(world) < 1e-6);
        // A foot stays a foot in world space, so that shapes are true.
        let origin = spaces.world_from_grid.transform_point3(DVec3::ZERO);
        assert!(((world - origin).truncate().length() - 600.0).abs() < 1e-6);
    }
}
