//! Layers of surface points that rays meet: found from the faces that a ray meets, colored, and blended between the
//! samples. The twin of `shaders/{peel,paint}.wgsl` and `shaders/shared/surfaces.wgsl`; `Surfaces` in
//! view/surfaces.rs says what is seen.

use glam::{Vec2, Vec3A};

use super::cube::{Cube, March};
use super::each::Each;
use super::edges::with_edges;
use super::facing::{FacePlace, column_behind, face_corner};
use super::frame::{PixelRay, Ray};
use super::grid::Grid;
use super::projection::{RayFrame, cross2d};
use super::raster::Met;
use super::scene::Scene;
use super::shading::turned_to_ray;
use super::tally::Tally;
use super::transfer::Accumulated;
use crate::image::Blending;
use crate::model::Grid as Model;
use crate::render::RenderError;
use crate::render::plan::faces::face_numbers;
use crate::render::plan::layout::FAULT_COLORS;
use crate::render::plan::list_entry;
use crate::render::plan::surfaces::{Layer as Kind, faults, layers, palette};
use crate::render::plan::tubes::{TubePoint, TubePoints};
use crate::scene::{Hull, Interpolation};
use crate::view::View;
use crate::view::surfaces::{FAINT_BEHIND, FAINT_FRONT, SHEET_OPACITY, faint_color};

/// The faces of the surfaces that a view shows.
#[derive(Default)]
pub struct SurfaceFaces {
    /// Faces of the hull.
    pub hull: Vec<u32>,
    /// Faces on faults, in rising order.
    pub faults: Vec<u32>,
    /// Numbers of their colors.
    colors: Vec<u32>,
}

impl SurfaceFaces {
    /// Those that a view shows of `model` (the case's grid).
    ///
    /// # Errors
    /// When the faces of the grid cannot be numbered.
    pub fn new(model: &Model, view: &View) -> Result<Self, RenderError> {
        let surfaces = view.style.surfaces;
        let hull = match surfaces.has_hull() {
            true => face_numbers(model, &view.hull_faces(model))?,
            false => Vec::new(),
        };
        let faults = match surfaces.faults {
            true => faults(model, view)?,
            false => Vec::new(),
        };
        let (faults, colors) = faults.into_iter().unzip();
        Ok(Self {
            hull,
            faults,
            colors,
        })
    }
}

/// Makes layers of the faces that rays meet.
pub struct Painter<'a> {
    faces: &'a SurfaceFaces,
    kinds: Vec<Kind>,
    /// Faces on both sides of a fault lie within this distance.
    gap: f32,
    palette: [[f32; 4]; FAULT_COLORS],
    /// Color of a faint hull.
    faint: Vec3A,
    /// Where rays meet wells.
    tubes: Option<TubePoints>,
}

/// A point of a surface.
#[derive(Debug, Clone, Copy)]
pub struct Layer {
    /// Along the ray.
    distance: f32,
    color: Vec3A,
    opacity: f32,
}

/// The layers of a ray, nearest first, and how many of them are blended; and the samples of a cube, which lie between
/// them and those of the cells.
#[derive(Debug, Default)]
pub struct Layers {
    layers: Vec<Layer>,
    passed: usize,
    march: Option<March>,
    /// Distance of what is next.
    next: f32,
    /// Samples of the cube that are blended.
    pub cube_samples: u64,
}

/// A point of a well, which carries no number, as ghosts do.
fn tube_layer(scene: &Scene<'_>, ray: &PixelRay, tube: TubePoint) -> Layer {
    let here = ray.origin + tube.distance * ray.direction;
    Layer {
        distance: tube.distance,
        color: scene.shading.shade(tube.color.into(), here, true),
        opacity: 1.0,
    }
}

impl Layers {
    /// Puts a layer among the others, behind all that are not farther.
    fn insert(&mut self, layer: Layer) {
        let at = self
            .layers
            .partition_point(|l| l.distance <= layer.distance);
        self.layers.insert(at, layer);
    }

    /// Begins with those that were found of a ray.
    pub fn begin(&mut self, scene: &Scene<'_>, ray: &PixelRay) {
        let march = |cube: &Cube<'_>| cube.march(&scene.frame, ray);
        self.march = scene.cube.as_ref().and_then(march);
        self.cube_samples = 0;
        self.next = self.after(scene);
    }

    /// Distance of the next one, or of the next sample of the cube.
    #[inline]
    pub fn next(&self) -> f32 {
        self.next
    }

    /// Blends what lies in front of a distance.
    #[inline]
    pub fn blend_until(&mut self, scene: &Scene<'_>, sum: &mut Accumulated, distance: f32) {
        if self.next <= distance {
            self.advance(scene, sum, distance);
        }
    }

    /// Blends the surfaces in front of a distance, and what lies before each of them: samples of a cube behind the last
    /// one are left for those of the cells.
    pub fn blend_surfaces_until(
        &mut self,
        scene: &Scene<'_>,
        sum: &mut Accumulated,
        distance: f32,
    ) {
        let next = |layers: &Self| layers.layers.get(layers.passed).map(|l| l.distance);
        while let Some(at) = next(self).filter(|at| *at <= distance) {
            self.advance(scene, sum, at);
        }
    }

    fn advance(&mut self, scene: &Scene<'_>, sum: &mut Accumulated, distance: f32) {
        loop {
            let layer = self.layers.get(self.passed).copied();
            let layer = layer.filter(|layer| layer.distance <= distance);
            let until = layer.map_or(distance, |layer| layer.distance);
            if let (Some(cube), Some(march)) = (&scene.cube, &mut self.march) {
                let is_open = |sum: &Accumulated| scene.transfer.is_open(sum);
                self.cube_samples += cube.blend_until(march, sum, until, is_open);
            }
            let Some(layer) = layer else {
                break;
            };
            sum.blend(layer.color, layer.opacity);
            self.passed += 1;
        }
        self.next = self.after(scene);
    }

    /// Distance of what is next.
    fn after(&self, scene: &Scene<'_>) -> f32 {
        let layer = self.layers.get(self.passed);
        let layer = layer.map_or(f32::INFINITY, |layer| layer.distance);
        match (&scene.cube, &self.march) {
            (Some(cube), Some(march)) => layer.min(cube.next(march)),
            _ => layer,
        }
    }

    /// Blends all that is left.
    pub fn blend_rest(&mut self, scene: &Scene<'_>, sum: &mut Accumulated) {
        self.blend_until(scene, sum, f32::MAX);
    }

    /// A ray up to the first opaque layer, which ends it. Nothing of it is left where that is the hull and nothing can be
    /// in front: only ghosts are outside.
    pub fn before_opaque(&self, scene: &Scene<'_>, ray: &Ray) -> Ray {
        let mut left = self.layers.iter().skip(self.passed);
        let Some(Layer { distance, .. }) = left.find(|layer| layer.opacity >= 1.0) else {
            return *ray;
        };
        let has_hull = scene.surfaces.hull == Hull::Opaque;
        let has_more = !has_hull || ray.starts_inside || scene.grid.has_ghosts();
        let samples = (distance / scene.frame.numbers.step - 0.5).ceil() - ray.first;
        let (count, leave) = match has_more {
            true => (samples.clamp(0.0, ray.count), ray.leave.min(*distance)),
            false => (0.0, ray.enter),
        };
        Ray {
            count,
            leave,
            ..*ray
        }
    }
}

/// A point on a face: its parameters along the face's two axes, and their change from a pixel to the next to the right
/// and below. And the face's normal in grid space, of any length and sense.
struct Spot {
    at: Vec2,
    right: Vec2,
    down: Vec2,
    normal: Vec3A,
}

/// Where a ray meets a face.
#[derive(Clone, Copy)]
struct Point {
    face: u32,
    distance: f32,
    /// The face is turned to the viewer.
    is_front: bool,
}

impl<'a> Painter<'a> {
    /// That of a view.
    pub fn new(faces: &'a SurfaceFaces, view: &View) -> Self {
        let blending: Blending = view.style.blending;
        let faint = blending.of_srgb(faint_color(view.style.background));
        Self {
            faces,
            kinds: layers(view.style.surfaces),
            gap: view.fault_gap() as f32,
            palette: palette(blending),
            faint: Vec3A::from(faint.map(|v| v as f32)),
            tubes: TubePoints::of(view),
        }
    }

    /// Where the ray of a pixel meets a well.
    pub fn tube(&self, pixel: [u32; 2]) -> Option<TubePoint> {
        self.tubes.as_ref()?.at(pixel)
    }

    /// Finds the layers of a pixel's ray among the faces of hull and sheets and the point of a tube that it meets.
    pub fn find(
        &self,
        scene: &Scene<'_>,
        ray: &PixelRay,
        ([hull, sheets], tube): ([&[Met]; 2], Option<TubePoint>),
        found: &mut Layers,
        tally: &mut Tally,
    ) {
        found.layers.clear();
        found.passed = 0;
        let mut before: Option<Point> = None;
        for kind in &self.kinds {
            let hull = || points_of(scene, ray, hull);
            let point = match kind {
                Kind::Hull | Kind::Front => nearest(hull(), self.gap),
                Kind::Ground => hull().max_by(|a, b| {
                    let counts_as = |p: &Point| p.counts_as(self.gap);
                    counts_as(a).total_cmp(&counts_as(b))
                }),
                Kind::Tube => {
                    if let Some(tube) = tube {
                        found.insert(tube_layer(scene, ray, tube));
                        tally.painted += 1;
                    }
                    continue;
                }
                Kind::Sheet(0) => nearest(points_of(scene, ray, sheets), 0.0),
                Kind::Sheet(_) => before.and_then(|before| {
                    let is_other = |p: &Point| {
                        // Sheets that touch, or lie between the same two columns, are one.
                        p.distance >= before.distance + self.gap
                            && sheet_of(scene.grid, p.face) != sheet_of(scene.grid, before.face)
                    };
                    nearest(points_of(scene, ray, sheets).filter(is_other), 0.0)
                }),
            };
            before = point;
            if let Some(point) = point {
                found.insert(self.layer_at(scene, *kind, point, ray));
                tally.painted += 1;
            }
        }
        found.begin(scene, ray);
    }

    fn layer_at(&self, scene: &Scene<'_>, kind: Kind, point: Point, ray: &PixelRay) -> Layer {
        let place = FacePlace::of(point.face, scene.grid.nk());
        let distance = point.distance;
        let direction = ray.direction;
        let here = ray.origin + distance * direction;
        let frame = RayFrame::at(here, direction, distance);
        let steps = scene.frame.pixel_steps(direction, distance);
        let spot = spot_on(scene.grid, place, &frame, steps);
        let faint = match kind {
            Kind::Front => Some(FAINT_FRONT),
            Kind::Ground => Some(FAINT_BEHIND),
            _ => None,
        };
        if let Some(opacities) = faint {
            let [facing, edge_on] = opacities.map(|v| v as f32);
            let away = 1.0 - turned_to_ray(&scene.frame, spot.normal, direction);
            return Layer {
                distance,
                color: self.faint,
                opacity: facing + away * away * (edge_on - facing),
            };
        }
        let is_hull = kind == Kind::Hull;
        let fault = self.fault_color(point.face);
        let sheet = SHEET_OPACITY as f32;
        let color = match is_hull {
            true => {
                let own = Vec3A::from_vec4(scene.transfer.of(value_on(scene.grid, place, spot.at)));
                let own = fault.map_or(own, |fault| own.lerp(fault, sheet));
                scene
                    .shading
                    .headlight(&scene.frame, spot.normal, direction)
                    * own
            }
            false => fault.unwrap_or(Vec3A::ZERO),
        };
        // A sheet carries no number, as ghosts do.
        let lit = scene.shading.shade(color, here, !is_hull);
        let color = match scene.surfaces.cell_edges {
            true => {
                let steps = [spot.right, spot.down].map(|step| step.extend(0.0).into());
                with_edges(lit, spot.at.extend(0.5).into(), steps)
            }
            false => lit,
        };
        Layer {
            distance,
            color,
            opacity: if is_hull { 1.0 } else { sheet },
        }
    }

    /// Color of the fault that a face lies on.
    fn fault_color(&self, face: u32) -> Option<Vec3A> {
        let at = self.faces.faults.binary_search(&face).ok()?;
        let [r, g, b, _] = self.palette[self.faces.colors[at] as usize];
        Some(Vec3A::new(r, g, b))
    }
}

impl Point {
    /// Its distance, farther by a gap where the face is turned away.
    fn counts_as(&self, gap: f32) -> f32 {
        self.distance + if self.is_front { 0.0 } else { gap }
    }
}

/// The points of faces that clip planes leave.
fn points_of<'a>(
    scene: &'a Scene<'_>,
    ray: &'a PixelRay,
    met: &'a [Met],
) -> impl Iterator<Item = Point> {
    let points = met.iter().filter_map(|m| {
        let (depth, turn) = m.point?;
        Some(Point {
            face: m.face,
            distance: (depth * f64::from(ray.slant)) as f32,
            is_front: turn > 0,
        })
    });
    points.filter(|p| scene.frame.is_kept(ray.origin + p.distance * ray.direction))
}

/// The nearest point, where those that are turned away count as farther by a gap.
fn nearest(points: impl Iterator<Item = Point>, gap: f32) -> Option<Point> {
    points.min_by(|a, b| a.counts_as(gap).total_cmp(&b.counts_as(gap)))
}

/// A number for the lateral faces that lie between the same two columns.
fn sheet_of(grid: &Grid, face: u32) -> u32 {
    let FacePlace { column, side, .. } = FacePlace::of(face, grid.nk());
    let lower = match side & 1 {
        1 => column,
        _ => column_behind(grid, column, side).unwrap_or(u32::MAX / 2),
    };
    2 * lower + (side >> 1)
}

fn value_on(grid: &Grid, place: FacePlace, at: Vec2) -> f32 {
    if grid.interpolation == Interpolation::Cell {
        return grid.cell_value(place.column, place.layer);
    }
    let corners = grid.corner_values(place.column, place.layer);
    let [c0, c1, c2, c3] = [0, 1, 2, 3].each(|n| {
        let corner = face_corner(place.side, n) as usize;
        corners[corner >> 2][corner & 3]
    });
    let low = c0 + at.x * (c1 - c0);
    let high = c2 + at.x * (c3 - c2);
    low + at.y * (high - low)
}

/// Where the ray, whose frame has its origin there, meets a face: parameters are linear in each triangle.
fn spot_on(grid: &Grid, place: FacePlace, r: &RayFrame, steps: [Vec3A; 2]) -> Spot {
    let lists = grid.lists(place.column);
    let numbers = grid.pillar_index(place.column);
    let corners = [0, 1, 2, 3].each(|n| {
        let corner = face_corner(place.side, n);
        let of_column = (corner & 3) as usize;
        let entry = list_entry(lists[of_column], place.layer, corner >> 2);
        r.relative(&grid.pillar(numbers[of_column]), grid.depth(entry))
    });
    let q = corners.each(|corner| r.projected(corner));
    // The ray is in triangle 0 1 3 where it lies on the same side of the diagonal as corner 1.
    let corner_side = cross2d(q[3] - q[0], q[1] - q[0]);
    let (first_axis, second_axis) = match corner_side * cross2d(q[0], q[3]) > 0.0 {
        true => (q[1] - q[0], q[3] - q[1]),
        false => (q[3] - q[2], q[2] - q[0]),
    };
    let area = cross2d(first_axis, second_axis);
    let scale = if area.abs() > 1e-20 { 1.0 / area } else { 0.0 };
    let parameters = |across: Vec2| {
        let to_x = Vec2::new(second_axis.y, -second_axis.x);
        let to_y = Vec2::new(-first_axis.y, first_axis.x);
        scale * Vec2::new(to_x.dot(across), to_y.dot(across))
    };
    let across = |step: Vec3A| Vec2::from_array(r.across.each(|axis| axis.dot(step)));
    Spot {
        at: (-parameters(q[0].truncate())).clamp(Vec2::ZERO, Vec2::ONE),
        right: parameters(across(steps[0])),
        down: parameters(across(steps[1])),
        // At right angles to both diagonals: one normal for both triangles.
        normal: (corners[3] - corners[0]).cross(corners[2] - corners[1]),
    }
}
