//! What a camera frames, and from where it looks when a scene does not say.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::bounds::box_corners;
use super::camera::{Framed, MARGINS, Margins, middle};
use super::{Camera, View};
use crate::case::Case;
use crate::model::{Column, ColumnBits, Grid, Spaces};
use crate::scene::{CameraSpec, Filter, Projection};

/// The cells that a camera frames: those that pass every filter that does not change with time, so that the
/// camera of a film over time steps stands still.
///
/// Clip planes do not count: the camera does not follow one that is dragged.
#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    /// Points in world space that have the same convex hull as the cells.
    pub points: Vec<DVec3>,
    /// Corners of a box around the cells in world space; bit n of the index is the end along axis n. Its sides
    /// follow the grid's axes, or the direction of I where that box is much smaller.
    pub outline: [DVec3; 8],
    /// Middle of the box along the grid's axes, around which films turn.
    pub middle: DVec3,
    /// How large the cells are together.
    pub extents: Extents,
}

/// How large cells are together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extents {
    /// Unit vectors on the map: the mean directions in which I and J rise.
    pub directions: [DVec2; 2],
    /// Lengths along I, along J and upward, in world space.
    pub lengths: DVec3,
    /// Cells from the first to the last one along I, J and K.
    pub cells: [usize; 3],
}

/// The direction from which a camera looks, in degrees: compass direction in which it stands as seen from the
/// model, and height above the horizon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction {
    /// 0 north, 90 east.
    pub azimuth: f64,
    /// 0 level, 90 straight from above.
    pub elevation: f64,
}

/// Where a camera stands unless the shape of the model asks for something else.
pub const USUAL: Direction = Direction {
    azimuth: 205.0,
    elevation: 35.0,
};

/// A field that is this much longer than it is wide has its length across a wide picture.
const LONG: f64 = 1.6;
/// Width over height below which a picture is so narrow that the length of a long field goes up in it.
const NARROW: f64 = 0.8;
/// Degrees that the camera may stand beside the line at right angles to a long field, and to a section.
const LEAN: f64 = 25.0;
const LEAN_OF_SECTION: f64 = 12.0;
/// Part of its length and height below which a body is a section: of one cell, and of several.
const SECTION: [f64; 2] = [0.5, 0.1];
/// Part of its length below which the height of a body hardly shows.
const FLAT: f64 = 0.04;
/// Height over length of a body that is looked at from the side.
const TALL: f64 = 1.5;
/// Elevations of sections, tall bodies, and single layers.
const SECTION_ELEVATION: f64 = 10.0;
const TALL_ELEVATION: f64 = 20.0;
const FLAT_ELEVATION: f64 = 55.0;
/// Degrees that the camera stands higher than usual at most, where the width of the picture limits the size.
const HIGHER: f64 = 10.0;

impl Extents {
    /// The direction from which the cells show best in a picture of a width over height.
    ///
    /// Near the usual one, so that models are seen alike. A vertical section is seen from the side. A long field
    /// lies across a wide picture, of its two sides the one that is nearer to the usual direction being seen. A
    /// single layer is seen from higher up, and a tall body from lower; others from somewhat higher up where that
    /// fills the height of the picture.
    pub fn direction(&self, aspect: f64) -> Direction {
        if let Some(axis) = self.section() {
            return Direction {
                azimuth: near_usual(self.azimuth_along(axis), LEAN_OF_SECTION),
                elevation: SECTION_ELEVATION,
            };
        }
        let [i, j, height] = self.lengths.to_array();
        let (long, length) = if i >= j { (0, i) } else { (1, j) };
        let is_long = length > LONG * i.min(j) && height < length;
        let azimuth = match (is_long, aspect < NARROW) {
            (false, _) => USUAL.azimuth,
            (true, true) => near_usual(self.azimuth_along(long), LEAN),
            (true, false) => near_usual(self.azimuth_along(long) + 90.0, LEAN),
        };
        let elevation = match () {
            () if height > TALL * length => TALL_ELEVATION,
            () if self.cells[2] == 1 || height < FLAT * length => FLAT_ELEVATION,
            () => USUAL.elevation + self.higher(azimuth, aspect),
        };
        Direction { azimuth, elevation }
    }

    /// Degrees above the usual elevation at which the cells, seen from an azimuth, are as high as the picture where
    /// they are as wide as that.
    fn higher(&self, azimuth: f64, aspect: f64) -> f64 {
        let away = DVec2::from_angle((90.0 - azimuth).to_radians());
        let reach = |way: DVec2| {
            let [i, j] = self.directions.map(|d| d.dot(way).abs());
            i * self.lengths.x + j * self.lengths.y
        };
        let wanted = reach(away.perp()) / aspect;
        let height = |degrees: f64| {
            let (sin, cos) = (USUAL.elevation + degrees).to_radians().sin_cos();
            reach(away) * sin + self.lengths.z * cos
        };
        let mut degrees = 0.0;
        while degrees < HIGHER && height(degrees) < wanted {
            degrees += 0.5;
        }
        degrees
    }

    /// The horizontal axis across which the cells are a thin vertical section.
    fn section(&self) -> Option<usize> {
        let thin = |axis: usize| {
            let (across, along) = (self.lengths[axis], self.lengths[1 - axis]);
            let is_single = self.cells[axis] == 1 && self.cells[1 - axis] > 1;
            let part = SECTION[usize::from(!is_single)];
            across < part * along.min(self.lengths.z)
        };
        (0..2).find(|axis| thin(*axis))
    }

    /// Compass direction of an axis, in degrees.
    fn azimuth_along(&self, axis: usize) -> f64 {
        let [east, north] = self.directions[axis].to_array();
        east.atan2(north).to_degrees()
    }
}

/// Of an azimuth and the opposite one the one that is nearer to the usual azimuth, turned toward that by
/// `lean` degrees at most.
fn near_usual(azimuth: f64, lean: f64) -> f64 {
    // From -90 to 90: a half turn more or less is the other side.
    let aside = (USUAL.azimuth - azimuth + 90.0).rem_euclid(180.0) - 90.0;
    let azimuth = USUAL.azimuth - aside + aside.clamp(-lean, lean);
    match azimuth.is_finite() {
        true => azimuth.rem_euclid(360.0),
        false => USUAL.azimuth,
    }
}

/// Part of the footprint along the grid's axes below which a box along I is the better one.
const MUCH_SMALLER: f64 = 0.85;

impl Subject {
    /// Of the chosen active cells of a grid, by active index; of all where none is chosen. `None` where no cell
    /// is active.
    pub fn of(grid: &Grid, chosen: &[bool], spaces: &Spaces) -> Option<Self> {
        let found = Columns::of(grid, &grid.bits_of(chosen));
        let found = found.or_else(|| Columns::of(grid, grid.active_bits()))?;
        let [low, high] = bounds(&found.points);
        let along_axes = box_corners(spaces, [low, high]);
        let to_world = |p: &DVec3| spaces.world_from_grid.transform_point3(*p);
        let points: Vec<DVec3> = found.points.iter().map(to_world).collect();
        let directions = found.ways.map(|way| {
            let way = spaces.world_from_grid.transform_vector3(way);
            way.truncate().normalize_or_zero()
        });
        let directions = match directions {
            [i, j] if i == DVec2::ZERO && j == DVec2::ZERO => [DVec2::X, DVec2::Y],
            [i, j] if i == DVec2::ZERO => [-j.perp(), j],
            [i, j] if j == DVec2::ZERO => [i, i.perp()],
            both => both,
        };
        let length = |way: DVec2| {
            let [low, high] = reach(&points, way.extend(0.0));
            high - low
        };
        let [i, j] = directions.map(length);
        let height = (along_axes[0].z - along_axes[7].z).abs();
        Some(Self {
            outline: outline(&points, along_axes, directions),
            middle: middle(&along_axes),
            extents: Extents {
                directions,
                lengths: DVec3::new(i, j, height),
                cells: found.cells,
            },
            points,
        })
    }

    /// The eight corners of a box as if they were cells; for tests.
    #[cfg(test)]
    pub fn of_box(corners: [DVec3; 8]) -> Self {
        let edges = [1, 2, 4].map(|c| corners[c] - corners[0]);
        let direction = |axis: usize| edges[axis].truncate().normalize_or(DVec2::X);
        Self {
            points: corners.to_vec(),
            outline: corners,
            middle: middle(&corners),
            extents: Extents {
                directions: [direction(0), direction(1)],
                lengths: DVec3::from_array(edges.map(DVec3::length)),
                cells: [2; 3],
            },
        }
    }

    /// The camera that frames the cells from a direction, or from the one that suits their shape; where it
    /// `has_box`, also that, with room for its labels.
    pub fn camera(
        &self,
        from: Option<Direction>,
        zoom: f64,
        projection: Projection,
        aspect: f64,
        has_box: bool,
    ) -> Option<Camera> {
        let Direction { azimuth, elevation } =
            from.unwrap_or_else(|| self.extents.direction(aspect));
        let camera = Camera::facing(azimuth.to_radians(), elevation.to_radians(), projection)?;
        let cells = Framed {
            points: &self.points,
            margins: MARGINS,
        };
        let outline = Framed {
            points: &self.outline,
            margins: LABELS,
        };
        let framed = match has_box {
            true => &[cells, outline][..],
            false => &[cells],
        };
        Some(camera.framed_within(framed, aspect, zoom))
    }
}

impl View {
    /// The camera with which a turn about the middle of what is drawn begins, given the scene's camera: one that
    /// frames looks at that middle.
    pub(super) fn turning_camera(&self, spec: &CameraSpec) -> Camera {
        let Subject { points, middle, .. } = &*self.world.subject;
        match spec.framing_zoom() {
            None => self.camera,
            Some(zoom) => {
                let camera = self.camera.framed_around(points, *middle, self.aspect());
                camera.closer(*middle, zoom)
            }
        }
    }
}

/// Around the box: coordinates stand below it and at its left.
const LABELS: Margins = Margins {
    left: 0.07,
    right: 0.02,
    top: 0.02,
    bottom: 0.08,
};

/// The part of a filter that does not change with time; `None` where all of it does not.
pub(super) fn still(filter: &Filter, case: &Case) -> Option<Filter> {
    let mut still = filter.clone();
    still.properties.retain(|p| !case.is_dynamic(&p.name));
    still.wells.clear();
    (still != *filter).then_some(still)
}

/// A box along the direction of I around points where that is much smaller than the one along the grid's axes.
fn outline(points: &[DVec3], along_axes: [DVec3; 8], [i, j]: [DVec2; 2]) -> [DVec3; 8] {
    let across = i.perp() * i.perp().dot(j).signum();
    let [u, v] = [i, across].map(|way| reach(points, way.extend(0.0)));
    let area = (u[1] - u[0]) * (v[1] - v[0]);
    let sides = [1, 2].map(|c: usize| (along_axes[c] - along_axes[0]).truncate());
    if area < MUCH_SMALLER * sides[0].perp_dot(sides[1]).abs() {
        return std::array::from_fn(|c| {
            let on_map = u[c & 1] * i + v[c >> 1 & 1] * across;
            on_map.extend(along_axes[c & 4].z)
        });
    }
    along_axes
}

/// Smallest and largest coordinate of points along a direction.
fn reach(points: &[DVec3], way: DVec3) -> [f64; 2] {
    let start = [f64::INFINITY, f64::NEG_INFINITY];
    let at = points.iter().map(|p| p.dot(way));
    at.fold(start, |[a, b], v| [a.min(v), b.max(v)])
}

fn bounds(points: &[DVec3]) -> [DVec3; 2] {
    let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let points = points.iter();
    points.fold(start, |[a, b], p| [a.min(*p), b.max(*p)])
}

/// The chosen cells of the columns of a grid, in grid space.
struct Columns {
    /// The highest and lowest corner on each pillar: all others lie between them.
    points: Vec<DVec3>,
    /// Sums of the ways across the columns along I and J.
    ways: [DVec3; 2],
    /// Cells from the first to the last one along each axis.
    cells: [usize; 3],
}

impl Columns {
    fn of(grid: &Grid, chosen: &ColumnBits) -> Option<Self> {
        let of_column = |(number, column): (usize, Column<'_>)| {
            let layers = || chosen.layers(number);
            let ends = column.ends(layers())?;
            let [first, last] = [layers().next()?, layers().last()?];
            Some(([column.i, column.j], ends, [first, last]))
        };
        let columns = grid.columns().enumerate();
        let columns: Vec<_> = columns.filter_map(of_column).collect();
        let mut on_pillars: Vec<Option<[DVec3; 2]>> = vec![None; grid.dims().pillars()];
        let mut ways = [DVec3::ZERO; 2];
        let mut cells = [[usize::MAX, 0]; 3];
        for &([i, j], ends, layers) in &columns {
            for (range, at) in cells.iter_mut().zip([[i, i], [j, j], layers]) {
                *range = [range[0].min(at[0]), range[1].max(at[1])];
            }
            let [a, b, c, d] = ends;
            ways[0] += b[0] - a[0] + d[0] - c[0];
            ways[1] += c[0] - a[0] + d[0] - b[0];
            for (corner, [high, low]) in ends.into_iter().enumerate() {
                let known = &mut on_pillars[grid.pillar_index(i, j, corner)];
                let [a, b] = known.unwrap_or([high, low]);
                let high = if high.z < a.z { high } else { a };
                *known = Some([high, if low.z > b.z { low } else { b }]);
            }
        }
        (!columns.is_empty()).then(|| Self {
            points: on_pillars.into_iter().flatten().flatten().collect(),
            ways: ways.map(|way| way.with_z(0.0)),
            cells: cells.map(|[first, last]| last - first + 1),
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use crate::model::{Dims, GridInput, MapAxes};

    /// A block of cells in world space, turned by an angle on the map.
    fn block(lengths: [f64; 3], cells: [usize; 3], turn: f64) -> Extents {
        let i = DVec2::from_angle(turn.to_radians());
        Extents {
            directions: [i, i.perp()],
            lengths: DVec3::from_array(lengths),
            cells,
        }
    }

    fn apart(a: f64, b: f64) -> f64 {
        ((a - b + 180.0).rem_euclid(360.0) - 180.0).abs()
    }

    /// Degrees between the line of sight and the horizontal line across an axis.
    fn aside(direction: Direction, extents: &Extents, axis: usize) -> f64 {
        let across = extents.azimuth_along(axis) + 90.0;
        apart(direction.azimuth, across).min(apart(direction.azimuth, across + 180.0))
    }

    #[test]
    fn models_of_usual_shape_and_single_cells_are_seen_from_the_usual_side() {
        for aspect in [0.5, 1.0, 1.5, 3.0] {
            for (lengths, cells) in [
                ([4000.0, 3500.0, 900.0], [40, 35, 10]),
                ([100.0, 100.0, 50.0], [1, 1, 1]),
                ([0.0, 0.0, 0.0], [1, 1, 1]),
                ([f64::NAN, 1.0, 1.0], [2, 2, 2]),
            ] {
                for turn in [0.0, 30.0, 130.0] {
                    let found = block(lengths, cells, turn).direction(aspect);
                    let highest = match cells[2] {
                        1 => FLAT_ELEVATION,
                        _ if aspect == 3.0 => USUAL.elevation,
                        _ => USUAL.elevation + HIGHER,
                    };
                    assert_eq!(found.azimuth, 205.0);
                    assert!((35.0..=highest).contains(&found.elevation), "{found:?}");
                }
            }
        }
    }

    #[test]
    fn long_fields_lie_across_wide_pictures_and_go_up_in_narrow_ones() {
        for turn in (0..360).step_by(10).map(f64::from) {
            for (lengths, long) in [([9000.0, 3000.0, 900.0], 0), ([3000.0, 9000.0, 900.0], 1)] {
                let field = block(lengths, [30, 30, 10], turn);
                let [narrow, square, wide] = [0.5, 1.0, 2.0].map(|a| field.direction(a));
                assert_eq!(square.azimuth, wide.azimuth);
                assert!(square.elevation >= wide.elevation);
                assert!(aside(wide, &field, long) <= LEAN + 1e-9, "{turn} {wide:?}");
                assert!(aside(narrow, &field, 1 - long) <= LEAN + 1e-9, "{turn}");
                // The side toward the usual direction.
                for found in [narrow, wide] {
                    assert!(apart(found.azimuth, 205.0) <= 90.0 - LEAN + 1e-9, "{turn}");
                }
            }
        }
        // One that lies right already is not turned at all.
        let west_east = block([9000.0, 3000.0, 900.0], [30, 30, 10], -10.0);
        assert_eq!(west_east.direction(4.0), USUAL);
    }

    #[test]
    fn sections_are_seen_from_the_side() {
        for turn in (0..180).step_by(15).map(f64::from) {
            for axis in 0..2 {
                let mut lengths = [6000.0, 6000.0, 1500.0];
                let mut cells = [60, 60, 20];
                (lengths[axis], cells[axis]) = (100.0, 1);
                let section = block(lengths, cells, turn);
                let found = section.direction(1.5);
                // Along the axis across which it is thin.
                assert!(aside(found, &section, 1 - axis) <= LEAN_OF_SECTION + 1e-9);
                assert!(found.elevation <= 15.0);
                assert!(apart(found.azimuth, 205.0) <= 90.0, "{turn} {found:?}");
            }
        }
        // A whole field is not one, however many cells it has.
        let field = block([6000.0, 6000.0, 1500.0], [60, 60, 20], 0.0);
        assert_eq!(field.section(), None);
        // Of a coarse grid a single column of cells is one, but no two of them.
        let coarse = |cells| block([1000.0, 10_000.0, 2500.0], [cells, 10, 3], 0.0).section();
        assert_eq!([coarse(1), coarse(2)], [Some(0), None]);
    }

    #[test]
    fn single_layers_are_seen_from_above_and_tall_bodies_from_the_side() {
        let elevation = |lengths, cells| block(lengths, cells, 0.0).direction(1.3).elevation;
        let layer = elevation([5000.0, 4000.0, 600.0], [50, 40, 1]);
        let sheet = elevation([5000.0, 4000.0, 20.0], [50, 40, 5]);
        let tall = elevation([100.0, 100.0, 900.0], [3, 3, 40]);
        assert!(layer > 50.0 && sheet > 50.0 && tall < 25.0);
    }

    /// Cells of 100 by 50 by 10, with map axes turned by an angle.
    fn grid(dims: [usize; 3], turn: f64) -> Grid {
        let [ni, nj, nk] = dims;
        let dims = Dims { ni, nj, nk };
        let pillar = |n: usize| {
            let (x, y) = (100.0 * (n % (ni + 1)) as f64, 50.0 * (n / (ni + 1)) as f64);
            [x, y, 0.0, x, y, 5000.0]
        };
        let coord: Vec<f64> = (0..dims.pillars()).flat_map(pillar).collect();
        let depth = |at: usize| 10.0 * ((at / (4 * ni * nj)) as f64 / 2.0).ceil();
        let zcorn: Vec<f64> = (0..8 * dims.cells()).map(|at| 2000.0 + depth(at)).collect();
        let ex = DVec2::from_angle(turn.to_radians());
        Grid::new(&GridInput {
            dims,
            coord: &coord,
            zcorn: &zcorn,
            actnum: None,
            map_axes: Some(MapAxes {
                origin: DVec2::new(460_000.0, 5_930_000.0),
                ex,
                ey: ex.perp(),
                unit: None,
            }),
        })
        .unwrap()
    }

    fn subject(grid: &Grid, chosen: impl Fn([usize; 3]) -> bool) -> Subject {
        let dims = grid.dims();
        let cells = grid.active_cells().iter().map(|c| dims.ijk(*c));
        let chosen: Vec<bool> = cells.map(|c| chosen([c.i, c.j, c.k])).collect();
        Subject::of(grid, &chosen, &Spaces::new(grid.map_axes(), 2.0)).unwrap()
    }

    #[test]
    fn extents_are_those_of_the_chosen_cells_along_the_turned_axes() {
        for turn in [0.0, 35.0, 215.0] {
            let grid = grid([12, 8, 4], turn);
            let found = subject(&grid, |[i, j, k]| i < 3 && j == 2 && k > 0);
            let Extents {
                directions,
                lengths,
                cells,
            } = found.extents;
            assert_eq!(cells, [3, 1, 3]);
            assert!(
                lengths.abs_diff_eq(DVec3::new(300.0, 50.0, 60.0), 1e-6),
                "{lengths}"
            );
            let i = DVec2::from_angle(turn.to_radians());
            assert!(
                directions[0].abs_diff_eq(i, 1e-9) && directions[1].abs_diff_eq(i.perp(), 1e-9)
            );
            // Nothing chosen: all of it.
            assert_eq!(subject(&grid, |_| false).extents.cells, [12, 8, 4]);
        }
    }

    #[test]
    fn points_have_the_hull_of_the_chosen_cells() {
        let grid = grid([6, 5, 4], 20.0);
        let chosen = |[i, j, k]: [usize; 3]| (i + j + k) % 3 != 0 && i + j < 8;
        let found = subject(&grid, chosen);
        let spaces = Spaces::new(grid.map_axes(), 2.0);
        let cells = grid.active_cells().iter().map(|c| grid.dims().ijk(*c));
        let cells = cells.filter(|c| chosen([c.i, c.j, c.k]));
        let corners: Vec<DVec3> = cells
            .flat_map(|c| grid.hexahedron(c).0)
            .map(|c| spaces.world_from_grid.transform_point3(c))
            .collect();
        for n in 0..200 {
            let n = f64::from(n);
            let way = DVec3::new((1.3 * n).sin(), (2.1 * n).cos(), (0.7 * n).sin());
            let [a, b] = [&found.points, &corners].map(|p| reach(p, way));
            assert!((a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-6, "{way}");
        }
        assert!(found.points.len() < corners.len());
    }

    #[test]
    fn the_outline_follows_a_field_that_lies_diagonally() {
        // A narrow band along the diagonal of its grid has a box along the grid's axes; a grid whose own axes
        // lie diagonally in its coordinates does not.
        let along = subject(&grid([10, 6, 2], 0.0), |_| true);
        let turned = subject(&grid([10, 6, 2], 40.0), |_| true);
        for found in [&along, &turned] {
            let sides = [1, 2, 4].map(|c: usize| found.outline[c].distance(found.outline[0]));
            assert!(DVec3::from_array(sides).abs_diff_eq(DVec3::new(1000.0, 300.0, 40.0), 1e-6));
        }
        let world = |c: f64, s: f64| DVec3::new(c, s, 0.0);
        let ring: Vec<DVec3> = [[0.0, 0.0], [800.0, 600.0], [680.0, 760.0], [-120.0, 160.0]]
            .iter()
            .flat_map(|[x, y]| [world(*x, *y), world(*x, *y) - 50.0 * DVec3::Z])
            .collect();
        let loose: [DVec3; 8] = std::array::from_fn(|c| {
            let pick = |axis: usize, ends: [f64; 2]| ends[c >> axis & 1];
            DVec3::new(
                pick(0, [-120.0, 800.0]),
                pick(1, [0.0, 760.0]),
                pick(2, [0.0, -50.0]),
            )
        });
        let i = DVec2::new(0.8, 0.6);
        let tight = outline(&ring, loose, [i, i.perp()]);
        for point in &ring {
            assert!(tight.iter().any(|c| c.distance(*point) < 1e-9), "{point}");
        }
        // Along an axis that would not make it smaller it stays as it was.
        assert_eq!(outline(&ring, loose, [DVec2::X, DVec2::Y]), loose);
    }
}
