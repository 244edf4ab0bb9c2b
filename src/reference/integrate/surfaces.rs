//! Points of surfaces on a ray, as [`crate::view::Surfaces`] defines them.

use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;
use std::collections::HashMap;

use super::{Integrator, Ray, Sample};
use crate::model::topology::Face;
use crate::model::{Grid, Ijk};
use crate::reference::locate::Located;
use crate::reference::tree::Tree;
use crate::scene::Hull;
use crate::view::surfaces::{
    EDGE_DARKNESS, EDGE_FADE, EDGE_WIDTH, FAINT_BEHIND, FAINT_FRONT, SHEET_OPACITY, faint_color,
    fault_color,
};
use crate::view::{ClipPlane, View};

/// Barycentric coordinates below zero by less than this still count as inside.
const ON_EDGE: f64 = 1e-12;

/// Corners of a face's two triangles, and the parameters on the face at them.
const TRIANGLES: [[usize; 3]; 2] = [[0, 1, 3], [0, 3, 2]];
const PARAMETERS: [DVec2; 4] = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];

/// The faces of a view's surfaces in world space.
#[derive(Debug, Default)]
pub(super) struct SurfaceFaces {
    /// Those of the hull.
    hull: Faces,
    /// Those that lie on faults, where they are sheets by themselves.
    sheets: Faces,
}

#[derive(Debug, Default)]
struct Faces {
    faces: Vec<SurfaceFace>,
    tree: Option<Tree>,
}

#[derive(Debug)]
struct SurfaceFace {
    cell: Ijk,
    face: Face,
    corners: [DVec3; 4],
    /// Middle of the cell.
    inside: DVec3,
    /// Color of the fault that it lies on, as it is blended.
    fault: Option<DVec3>,
}

/// What a ray meets of the surfaces.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layer {
    /// Distance along the ray.
    pub distance: f64,
    /// Color as it is blended, shaded.
    pub color: DVec3,
    /// Opacity.
    pub alpha: f64,
}

/// Where a ray meets a face.
#[derive(Clone, Copy)]
struct Hit<'a> {
    face: &'a SurfaceFace,
    corners: [usize; 3],
    distance: f64,
    /// The face is turned away from the viewer.
    is_back: bool,
}

impl SurfaceFaces {
    /// The faces that a view of the case's grid shows.
    pub fn new(grid: &Grid, view: &View) -> Self {
        let surfaces = view.style.surfaces;
        if !surfaces.are_shown() {
            return Self::default();
        }
        let faults = match surfaces.faults {
            true => view.fault_faces(grid),
            false => Vec::new(),
        };
        let color = |fault| DVec3::from_array(view.style.blending.of_srgb(fault_color(fault)));
        let key = |cell: Ijk, face: Face| (cell.i, cell.j, cell.k, face as usize);
        let colors: HashMap<_, _> = faults
            .iter()
            .map(|&(cell, face, fault)| (key(cell, face), color(fault)))
            .collect();
        let of = |(cell, face): (Ijk, Face)| {
            let fault = colors.get(&key(cell, face)).copied();
            SurfaceFace::new(grid, view, cell, face, fault)
        };
        let hull = match surfaces.has_hull() {
            true => view.hull_faces(grid),
            false => Vec::new(),
        };
        let sheets = match surfaces.hull {
            Hull::Opaque => Vec::new(),
            _ => faults.iter().map(|&(cell, face, _)| (cell, face)).collect(),
        };
        Self {
            hull: Faces::new(hull.into_par_iter().map(of).collect()),
            sheets: Faces::new(sheets.into_par_iter().map(of).collect()),
        }
    }
}

impl Faces {
    fn new(faces: Vec<SurfaceFace>) -> Self {
        let boxes: Vec<_> = faces.iter().map(|f| bounds(&f.corners)).collect();
        let tree = (!boxes.is_empty()).then(|| Tree::new(&boxes));
        Self { faces, tree }
    }

    /// Everything that a ray meets, in no order.
    fn hits(&self, ray: Ray) -> Vec<Hit<'_>> {
        let mut hits = Vec::new();
        if let Some(tree) = &self.tree {
            let meets = |bounds| ray.within(bounds).is_some();
            tree.meeting(&meets, &mut |n| hits.extend(self.faces[n].hits(ray)));
        }
        hits
    }
}

/// Box of some points, a little wider than they are: a ray along a side must not miss it.
fn bounds(corners: &[DVec3; 4]) -> [DVec3; 2] {
    let low = corners.iter().fold(DVec3::INFINITY, |a, &b| a.min(b));
    let high = corners.iter().fold(DVec3::NEG_INFINITY, |a, &b| a.max(b));
    let slack = DVec3::splat(1e-9 * low.distance(high));
    [low - slack, high + slack]
}

impl SurfaceFace {
    fn new(grid: &Grid, view: &View, cell: Ijk, face: Face, fault: Option<DVec3>) -> Self {
        let hexahedron = grid.hexahedron(cell);
        let world = |p| view.world.spaces.world_from_grid.transform_point3(p);
        let [mine, _] = face.corners();
        Self {
            cell,
            face,
            corners: mine.map(|c| world(hexahedron.0[c])),
            inside: world(hexahedron.center()),
            fault,
        }
    }

    /// Where a ray meets the two triangles, in front of its origin.
    fn hits(&self, ray: Ray) -> impl Iterator<Item = Hit<'_>> {
        TRIANGLES.into_iter().filter_map(move |corners| {
            let points = corners.map(|c| self.corners[c]);
            let (distance, weights) = meet(ray, points)?;
            let normal = (points[1] - points[0]).cross(points[2] - points[0]);
            let outward = normal * normal.dot(points[0] - self.inside).signum();
            (distance > 0.0 && weights.min_element() >= -ON_EDGE).then_some(Hit {
                face: self,
                corners,
                distance,
                is_back: outward.dot(ray.direction) > 0.0,
            })
        })
    }

    /// Unit vector at right angles to both diagonals, null where they are parallel.
    fn normal(&self) -> DVec3 {
        let [a, b, c, d] = self.corners;
        (d - a).cross(c - b).normalize_or_zero()
    }

    /// The two columns that the face lies between.
    fn columns(&self) -> (usize, usize, Face) {
        let Ijk { i, j, .. } = self.cell;
        match self.face {
            Face::IMinus => (i.wrapping_sub(1), j, Face::IPlus),
            Face::JMinus => (i, j.wrapping_sub(1), Face::JPlus),
            other => (i, j, other),
        }
    }

    /// Parameters (s, t, r) in the cell at parameters 0..1 of the face.
    fn in_cell(&self, at: DVec2) -> DVec3 {
        let [x, y] = (2.0 * at - 1.0).to_array();
        match self.face {
            Face::IMinus => DVec3::new(-1.0, x, y),
            Face::IPlus => DVec3::new(1.0, x, y),
            Face::JMinus => DVec3::new(x, -1.0, y),
            Face::JPlus => DVec3::new(x, 1.0, y),
            Face::KMinus => DVec3::new(x, y, -1.0),
            Face::KPlus => DVec3::new(x, y, 1.0),
        }
    }
}

/// Distance at which a ray crosses the plane of a triangle, and barycentric coordinates there.
fn meet(ray: Ray, [a, b, c]: [DVec3; 3]) -> Option<(f64, DVec3)> {
    let matrix = DMat3::from_cols(b - a, c - a, -ray.direction);
    let size = (b - a).length() * (c - a).length();
    if matrix.determinant().abs() <= 1e-14 * size {
        return None;
    }
    let [v, w, distance] = (matrix.inverse() * (ray.origin - a)).to_array();
    Some((distance, DVec3::new(1.0 - v - w, v, w)))
}

impl Hit<'_> {
    /// Parameters 0..1 on the face at which a ray crosses the triangle's plane.
    fn parameters(&self, ray: Ray) -> Option<DVec2> {
        let (_, weights) = meet(ray, self.corners.map(|c| self.face.corners[c]))?;
        let at = self.corners.iter().zip(weights.to_array());
        Some(at.map(|(&c, w)| w * PARAMETERS[c]).sum())
    }
}

impl Integrator<'_> {
    /// The surface points that a ray sees, nearest first.
    pub(super) fn layers(&self, ray: Ray) -> Vec<Layer> {
        let mut layers = match self.view.style.surfaces.hull {
            Hull::Hidden => Vec::new(),
            Hull::Faint => self.faint_hull(ray),
            Hull::Opaque => self.opaque_hull(ray),
        };
        layers.extend(self.sheets(ray));
        layers.extend(self.tube(ray));
        // Of equal distances what is drawn first stays in front.
        layers.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        layers
    }

    /// What a ray meets of some faces in what clip planes keep.
    fn kept<'f>(&self, faces: &'f Faces, ray: Ray) -> Vec<Hit<'f>> {
        let mut hits = faces.hits(ray);
        hits.retain(|hit| self.is_kept(ray.origin + hit.distance * ray.direction));
        hits
    }

    /// Distance by which hits on the hull are put in order.
    fn counts_as(&self, hit: &Hit<'_>) -> f64 {
        let behind = if hit.is_back {
            self.view.fault_gap()
        } else {
            0.0
        };
        hit.distance + behind
    }

    fn opaque_hull(&self, ray: Ray) -> Vec<Layer> {
        let hits = self.kept(&self.surfaces.hull, ray).into_iter();
        let nearest = hits.min_by(|a, b| self.counts_as(a).total_cmp(&self.counts_as(b)));
        nearest.iter().map(|hit| self.hull(ray, hit)).collect()
    }

    /// Its front and its ground.
    fn faint_hull(&self, ray: Ray) -> Vec<Layer> {
        let mut hits = self.kept(&self.surfaces.hull, ray);
        hits.sort_by(|a, b| self.counts_as(a).total_cmp(&self.counts_as(b)));
        let (Some(front), Some(behind)) = (hits.first(), hits.last()) else {
            return Vec::new();
        };
        let color = self
            .view
            .style
            .blending
            .of_srgb(faint_color(self.view.style.background));
        let layer = |hit: &Hit<'_>, [facing, edge_on]: [f64; 2]| {
            let cosine = hit.face.normal().dot(ray.direction).abs();
            Layer {
                distance: hit.distance,
                color: color.into(),
                alpha: facing + (edge_on - facing) * (1.0 - cosine).powi(2),
            }
        };
        vec![layer(front, FAINT_FRONT), layer(behind, FAINT_BEHIND)]
    }

    fn sheets(&self, ray: Ray) -> Vec<Layer> {
        let sheets = self.sheets_met(ray);
        sheets.iter().map(|hit| self.sheet(ray, hit)).collect()
    }

    /// Part of the light that sheets leave within a range of a ray.
    pub(super) fn past_sheets(&self, ray: Ray, [start, end]: [f64; 2]) -> f64 {
        let met = self.sheets_met(ray).into_iter();
        let counts = met.filter(|hit| (start..=end).contains(&hit.distance));
        (1.0 - SHEET_OPACITY).powi(counts.count() as i32)
    }

    /// Sheets on a ray, each of them once, nearest first.
    fn sheets_met(&self, ray: Ray) -> Vec<Hit<'_>> {
        let gap = self.view.fault_gap();
        let mut hits = self.kept(&self.surfaces.sheets, ray);
        hits.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        let mut sheets: Vec<Hit<'_>> = Vec::new();
        for hit in hits {
            let is_same = |before: &Hit<'_>| {
                hit.distance < before.distance + gap || hit.face.columns() == before.face.columns()
            };
            if !sheets.last().is_some_and(is_same) {
                sheets.push(hit);
            }
        }
        sheets
    }

    fn hull(&self, ray: Ray, hit: &Hit<'_>) -> Layer {
        let at = hit.parameters(ray).unwrap_or_default();
        let sample = self.sample_in(Located {
            ijk: hit.face.cell,
            str: hit.face.in_cell(at.clamp(DVec2::ZERO, DVec2::ONE)),
        });
        let own = DVec3::from_array(self.unlit(&sample));
        let color = hit.face.fault.map_or(own, |c| own.lerp(c, SHEET_OPACITY));
        let lamp = self.headlight(hit.face.normal(), ray.direction);
        self.layer(ray, hit, lamp * color, Some(&sample), 1.0)
    }

    fn sheet(&self, ray: Ray, hit: &Hit<'_>) -> Layer {
        let color = hit.face.fault.unwrap_or_default();
        self.layer(ray, hit, color, None, SHEET_OPACITY)
    }

    fn layer(
        &self,
        ray: Ray,
        hit: &Hit<'_>,
        color: DVec3,
        valued: Option<&Sample>,
        alpha: f64,
    ) -> Layer {
        let position = ray.origin + hit.distance * ray.direction;
        let lit = DVec3::from_array(self.shaded(position, color.to_array(), valued));
        let lines = match self.view.style.surfaces.cell_edges {
            true => self.lines_on(hit, ray).unwrap_or(0.0),
            false => 0.0,
        };
        Layer {
            distance: hit.distance,
            color: lit * (1.0 - EDGE_DARKNESS * lines),
            alpha,
        }
    }

    /// Part of a ray's pixel that the edges of the face cover; `None` where a ray runs along it.
    fn lines_on(&self, hit: &Hit<'_>, ray: Ray) -> Option<f64> {
        let at = hit.parameters(ray)?;
        let change = |[a, b]: [Ray; 2]| Some(hit.parameters(b)? - hit.parameters(a)?);
        let [right, down] = self.neighbors(ray).map(change);
        let (right, down) = (right?, down?);
        Some(line(at.x, right.x, down.x).max(line(at.y, right.y, down.y)))
    }

    /// The color of an opaque section with the edges of cells on it, where they are shown.
    pub(super) fn with_section_edges(
        &self,
        color: [f64; 3],
        ray: Ray,
        plane: &ClipPlane,
        sample: &Sample,
    ) -> [f64; 3] {
        if !self.view.style.surfaces.cell_edges {
            return color;
        }
        let Located { ijk, str } = sample.located;
        let world_from_grid = self.view.world.spaces.world_from_grid.matrix3;
        let map = world_from_grid * self.grid.hexahedron(ijk).jacobian(str);
        let at = |ray: Ray| {
            let distance = (plane.point - ray.origin).dot(plane.normal);
            ray.origin + distance / ray.direction.dot(plane.normal) * ray.direction
        };
        let change = |[a, b]: [Ray; 2]| 0.5 * (map.inverse() * (at(b) - at(a)));
        let [right, down] = self.neighbors(ray).map(change);
        let lines = (0..3)
            .map(|axis| line(0.5 * (str[axis] + 1.0), right[axis], down[axis]))
            .fold(0.0, f64::max);
        color.map(|channel| channel * (1.0 - EDGE_DARKNESS * lines))
    }

    /// Rays half a pixel of the final image to the left and right, and half a pixel above and below.
    fn neighbors(&self, ray: Ray) -> [[Ray; 2]; 2] {
        let View { camera, size, .. } = self.view;
        let height = f64::from(size[1] / self.view.sampling.supersample);
        let ahead = ray.direction / ray.direction.dot(camera.forward);
        let beside = |way: DVec3| match camera.parallel {
            None => Ray {
                direction: (ahead + camera.tan_half_fovy / height * way).normalize(),
                ..ray
            },
            Some(half_height) => Ray {
                origin: ray.origin + half_height / height * way,
                ..ray
            },
        };
        [camera.right, -camera.up].map(|way| [beside(-way), beside(way)])
    }
}

/// Part of a pixel that the lines cover along which a parameter (0..1) ends, from its change to the next
/// pixels.
fn line(parameter: f64, right: f64, down: f64) -> f64 {
    let pixels_across = 1.0 / right.hypot(down).max(1e-9);
    let away = parameter.min(1.0 - parameter) * pixels_across;
    let covered = (0.5 * EDGE_WIDTH + 0.5 - away).clamp(0.0, 1.0);
    let seen = ((pixels_across - EDGE_FADE[0]) / (EDGE_FADE[1] - EDGE_FADE[0])).clamp(0.0, 1.0);
    covered * seen * seen * (3.0 - 2.0 * seen)
}
