//! What lies under a place in the picture: the first thing along its ray that is opaque enough to be seen.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::case::Case;
use crate::gpu::GpuError;
use crate::model::topology::{Behind, Face};
use crate::model::{Grid, Ijk};
use crate::renderer::Renderer;
use crate::scene::{Hull, Surfaces, View};

/// Opacity that a ray must have gathered to have met something.
const SEEN: f64 = 0.1;
/// How far behind a section its cell is looked for, as a part of the sampling step.
const BEHIND_SECTION: f64 = 1e-3;

/// A cell, and where a ray met it.
#[derive(Debug, Clone, PartialEq)]
pub struct Hit {
    /// The cell.
    pub ijk: Ijk,
    /// Place in world space.
    pub world: DVec3,
    /// East, north and depth in map coordinates.
    pub map: DVec3,
    /// What of the cell was met.
    pub part: Part,
}

/// What of a cell a ray met.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// Its inside, which is transparent.
    Inside,
    /// Its section at an opaque clip plane.
    Section,
    /// A face of the hull.
    Face(Face),
    /// A face on a fault.
    Fault(Fault),
}

/// A face on a fault.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// How much deeper the same layer lies on the other side: the mean over the face's corners, in the
    /// grid's length unit; below 0 where it lies higher.
    pub throw: f64,
    /// The cell of the same layer on the other side.
    pub beyond: Ijk,
}

/// What lies under a place in the picture (0 to 1, right and down); `None` where nothing does.
///
/// The nearest of: the point of the volume at which the ray has gathered an opacity of 0.1, faces of the
/// hull and of faults where the view shows them, and the section of an opaque clip plane.
///
/// # Errors
/// When the device reports an error.
pub fn pick(
    renderer: &mut Renderer,
    case: &Case,
    view: &View,
    at: DVec2,
) -> Result<Option<Hit>, GpuError> {
    let ray = Ray::through(view, at);
    let mut found: Vec<(f64, Ijk, Part)> = Vec::new();
    if let Some((world, located)) = renderer.first_seen(&case.grid, view, at, SEEN)? {
        found.push((ray.distance(world), located.ijk, Part::Inside));
    }
    if let Some(distance) = section(view, &ray) {
        let inside = ray.at(distance + BEHIND_SECTION * view.sampling_step);
        if let Some(ijk) = renderer.cell_at(&case.grid, view, inside)? {
            found.push((distance, ijk, Part::Section));
        }
    }
    found.extend(surface(case, view, view.surfaces, &ray));
    let nearest = found.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    Ok(nearest.map(|(distance, ijk, part)| hit(view, ray.at(distance), ijk, part)))
}

fn hit(view: &View, world: DVec3, ijk: Ijk, part: Part) -> Hit {
    let map = DVec3::new(world.x, world.y, -world.z / view.vertical_exaggeration);
    Hit {
        ijk,
        world,
        map,
        part,
    }
}

/// The nearest fault under a place in the picture, whatever of the volume is before it; `None` where the view
/// shows none there.
pub fn fault_under(case: &Case, view: &View, at: DVec2) -> Option<Hit> {
    let ray = Ray::through(view, at);
    let surfaces = Surfaces {
        hull: Hull::Hidden,
        ..view.surfaces
    };
    let (distance, ijk, part) = surface(case, view, surfaces, &ray)?;
    Some(hit(view, ray.at(distance), ijk, part))
}

struct Ray {
    origin: DVec3,
    direction: DVec3,
}

impl Ray {
    fn through(view: &View, at: DVec2) -> Self {
        let (origin, direction) = view.camera.ray(at, view.aspect());
        Self { origin, direction }
    }

    fn at(&self, distance: f64) -> DVec3 {
        self.origin + distance * self.direction
    }

    fn distance(&self, point: DVec3) -> f64 {
        (point - self.origin).dot(self.direction)
    }

    /// Distance of a triangle (Moller and Trumbore 1997); `None` where the ray passes it by.
    fn meets([a, b, c]: [DVec3; 3], ray: &Self) -> Option<f64> {
        let (ab, ac) = (b - a, c - a);
        let across = ray.direction.cross(ac);
        let volume = ab.dot(across);
        if volume == 0.0 {
            return None;
        }
        let from_a = ray.origin - a;
        let u = from_a.dot(across) / volume;
        let other = from_a.cross(ab);
        let v = ray.direction.dot(other) / volume;
        let distance = ac.dot(other) / volume;
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some(distance)
    }
}

/// Distance at which the ray comes into what clip planes keep, where that is at an opaque one.
fn section(view: &View, ray: &Ray) -> Option<f64> {
    let entries = view.clip.iter().filter_map(|plane| {
        let along = ray.direction.dot(plane.normal);
        let distance = (plane.point - ray.origin).dot(plane.normal) / along;
        (along > 0.0 && distance > 0.0).then_some((distance, plane.opaque))
    });
    let last = entries.max_by(|a, b| a.0.total_cmp(&b.0))?;
    last.1.then_some(last.0)
}

/// The nearest face of some surfaces.
fn surface(case: &Case, view: &View, surfaces: Surfaces, ray: &Ray) -> Option<(f64, Ijk, Part)> {
    let grid = &case.grid;
    let mut faces = Vec::new();
    if surfaces.hull == Hull::Opaque {
        faces.extend(view.hull_faces(grid));
    }
    if surfaces.faults {
        let faults = view.fault_faces(grid);
        faces.extend(faults.into_iter().map(|(ijk, face, _)| (ijk, face)));
    }
    let kept = |p: DVec3| {
        let mut planes = view.clip.iter();
        planes.all(|c| (p - c.point).dot(c.normal) >= 0.0)
    };
    let distance = |&(ijk, face): &(Ijk, Face)| {
        let all = grid.hexahedron(ijk).0;
        let corners = face.corners()[0];
        let [a, b, c, d] = corners.map(|n| view.spaces.world_from_grid.transform_point3(all[n]));
        let hits = [[a, b, d], [a, d, c]].into_iter();
        let hits = hits.filter_map(|t| Ray::meets(t, ray));
        let nearest = hits.filter(|t| kept(ray.at(*t))).min_by(f64::total_cmp)?;
        Some((nearest, ijk, face))
    };
    let nearest = faces.par_iter().filter_map(distance);
    let (distance, ijk, face) = nearest.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let part = match fault(case, ijk, face) {
        Some(fault) => Part::Fault(fault),
        None => Part::Face(face),
    };
    Some((distance, ijk, part))
}

/// The fault that a face lies on, if it does.
fn fault(case: &Case, ijk: Ijk, face: Face) -> Option<Fault> {
    if matches!(face, Face::KMinus | Face::KPlus) {
        return None;
    }
    let Behind::Displaced(beyond) = case.grid.behind(ijk, face) else {
        return None;
    };
    let number = case.fault_faces.fault_of(ijk, face);
    let name = number.and_then(|n| case.about.named_faults.get(n));
    Some(Fault {
        name: name.map(|f| f.name.clone()),
        throw: throw(&case.grid, ijk, face, beyond),
        beyond,
    })
}

fn throw(grid: &Grid, ijk: Ijk, face: Face, beyond: Ijk) -> f64 {
    let [mine, theirs] = face.corners();
    let pairs = mine.iter().zip(theirs);
    let drops = pairs.map(|(&a, b)| grid.corner_depth(beyond, b) - grid.corner_depth(ijk, a));
    drops.sum::<f64>() / 4.0
}
