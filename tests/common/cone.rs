//! Transmittances of cones: from light volumes, and in f64 by sections of a pyramid and by rays.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use serde_json::{Value, json};
use strataray::case::Case;
use strataray::render::gpu::GpuRenderer;
use strataray::render::plan::cones::ConeTable;
use strataray::scene::{CameraSpec, ExplicitCamera, Projection, Scene};
use strataray::view::lighting::Cone;

use super::light::{Block, Space, lighting, render, scene};
use super::shape::boxes;

/// A model with its renderer; voxels have edges of 1.
pub struct Model {
    case: Case,
    renderer: GpuRenderer,
    scene: Scene,
}

/// What cones from the middles of a light volume's voxels gave.
pub struct Light {
    /// Transmittances.
    pub block: Block,
    /// Of extinction; none where it is not asked.
    pub pyramid: Vec<Block>,
    pub space: Space,
    pub cone: Cone,
    eye: DVec3,
}

impl Model {
    /// Boxes between planes, of opacities a unit of length at values 0 and 1.
    pub fn new(
        planes: [&[f64]; 3],
        value: &dyn Fn([usize; 3]) -> f64,
        opacity: [f64; 2],
    ) -> Option<Self> {
        let gpu = super::gpu()?;
        let [x, y, depth] = planes;
        let case = boxes(x, y, depth, value);
        let [low, high] = opacity;
        Some(Self {
            renderer: GpuRenderer::new(gpu, &case.grid).unwrap(),
            scene: scene(&[[0.0, low], [1.0, high]], 1.0, lighting(json!({}))),
            case,
        })
    }

    /// Occlusion toward an eye in a light volume of `light_size` voxels, of cones of a length in voxels.
    pub fn light(
        &mut self,
        occlusion: &Value,
        length: f64,
        eye: DVec3,
        light_size: [u32; 3],
    ) -> Light {
        let [low, high] = self.case.grid.bounds().unwrap();
        let edges = high - low;
        self.scene.camera = CameraSpec::Explicit(ExplicitCamera {
            eye: eye.to_array(),
            target: [low.x, low.y, -low.z],
            up: [0.3, 1.0, 0.2],
            fovy_degrees: 0.1,
            projection: Projection::Perspective,
        });
        let mut spec = json!({
            "attenuation": 1.0,
            "length": length / edges.length(),
        });
        for (name, value) in occlusion.as_object().unwrap() {
            spec[name] = value.clone();
        }
        let size = edges.to_array().map(|e| e.round());
        self.scene.lighting = lighting(json!({
            "occlusion": spec,
            "volume": {"size": size.map(|n| n as u32), "light_size": light_size},
        }));
        let (view, _) = render(&mut self.renderer, &self.case, &self.scene);
        let (gpu, light) = (self.renderer.gpu(), self.renderer.light());
        let pyramid = light.pyramid();
        let pyramid = pyramid.map_or_else(Vec::new, |p| Block::levels(gpu, p));
        let space = Space::new(&view, size.map(|n| n as usize));
        Light {
            block: Block::read(gpu, light.light_volumes().unwrap(), 0),
            eye: space.point(eye),
            space,
            pyramid,
            cone: view.style.lighting.occlusion.unwrap().cone,
        }
    }
}

impl Light {
    /// Where a voxel is, the unit vector to the eye, and the distance.
    pub fn way(&self, voxel: [usize; 3]) -> (DVec3, DVec3, f64) {
        let p = self.block.middle(voxel) * self.space.size();
        let away = self.eye - p;
        (p, away.normalize(), away.length())
    }

    /// The integral over a voxel's cone.
    pub fn by_rays(&self, voxel: [usize; 3], boxes: &[Filled]) -> f64 {
        let (p, axis, _) = self.way(voxel);
        by_rays(&self.cone, self.space.sigma, p, axis, boxes)
    }
}

/// A cone through a pyramid; lengths in standard deviations of the finest level.
pub struct Traced<'a> {
    pub levels: &'a [Block],
    /// Of the box.
    pub size: DVec3,
    pub table: ConeTable,
    pub tangent: f64,
}

impl Traced<'_> {
    /// Transmittance from a point along a unit vector, up to a distance.
    pub fn transmittance(&self, p: DVec3, axis: DVec3, reach: f64) -> f64 {
        // Each part: where it goes, its depth, and what its last section counted.
        let mut parts = vec![(axis, 0.0, 0.0)];
        for section in &self.table.sections {
            let number = section.parts as usize;
            if parts.len() < number {
                let split = self.directions(axis, number).into_iter();
                parts = split.map(|d| inherited(&parts, axis, d)).collect();
            }
            if section.distance > reach {
                break;
            }
            for (direction, depth, before) in &mut parts {
                let at = p + section.distance * *direction;
                let now = section.amplitude * self.depth(at, section.level as usize);
                *depth += section.weight * (*before + now);
                *before = now;
            }
        }
        let weighted = parts.iter().map(|(direction, depth, _)| {
            let cosine = direction.dot(axis);
            (cosine * (-depth).exp(), cosine)
        });
        let (sum, weights) = weighted.fold((0.0, 0.0), |(s, w), (a, b)| (s + a, w + b));
        sum / weights
    }

    /// What the pyramid holds at a point; beyond its border a Gaussian's part of what is there.
    fn depth(&self, p: DVec3, level: usize) -> f64 {
        let outside = (p - p.clamp(DVec3::ZERO, self.size)).length();
        let fade = (-0.5 * (outside / f64::from(level as u32).exp2()).powi(2)).exp();
        fade * self.levels[level.min(self.levels.len() - 1)].linear(p / self.size)
    }

    /// Axes of 3 or 7 circles packed in a circle, one of them up; the middle one of 7 first.
    fn directions(&self, axis: DVec3, number: usize) -> Vec<DVec3> {
        // Duff and others 2017: which way the parts lie is a matter of choice, but it shows.
        let s = if axis.z >= 0.0 { 1.0 } else { -1.0 };
        let (a, b) = (-1.0 / (s + axis.z), -axis.x * axis.y / (s + axis.z));
        let right = DVec3::new(1.0 + s * axis.x * axis.x * a, s * b, -s * axis.x);
        let up = DVec3::new(b, s + axis.y * axis.y * a, -axis.y);
        let outer = |count: usize, radius: f64, turn: f64| -> Vec<DVec3> {
            let angle = |n: usize| TAU * (n as f64 / count as f64 + turn);
            let at = |n: usize| angle(n).sin() * right + angle(n).cos() * up;
            let to = |n: usize| (axis + radius * self.tangent * at(n)).normalize();
            (0..count).map(to).collect()
        };
        match number {
            3 => outer(3, 2.0 / (2.0 + 3f64.sqrt()), 0.0),
            _ => [vec![axis], outer(6, 2.0 / 3.0, 1.0 / 12.0)].concat(),
        }
    }
}

/// What a part begins with: the depths of the nearest part before, or the mean of all that are as near.
fn inherited(before: &[(DVec3, f64, f64)], axis: DVec3, direction: DVec3) -> (DVec3, f64, f64) {
    let nearest = before
        .iter()
        .map(|b| b.0.dot(direction))
        .fold(-1.0, f64::max);
    let near = before
        .iter()
        .filter(|b| b.0.dot(direction) > nearest - 1e-9);
    let near: Vec<_> = near.collect();
    assert!(near.len() == 1 || direction == axis, "{}", near.len());
    let mean =
        |of: fn(&&(DVec3, f64, f64)) -> f64| near.iter().map(of).sum::<f64>() / near.len() as f64;
    (direction, mean(|b| b.1), mean(|b| b.2))
}

/// A box of one extinction a unit of length: low corner, high corner.
pub struct Filled(pub DVec3, pub DVec3, pub f64);

impl Filled {
    /// Optical depth of a range of distances along a ray.
    fn depth(&self, p: DVec3, direction: DVec3, [from, to]: [f64; 2]) -> f64 {
        let [a, b] = [self.0, self.1].map(|corner| (corner - p) / direction);
        let enter = a.min(b).max_element().max(from);
        let leave = a.max(b).min_element().min(to);
        self.2 * (leave - enter).max(0.0)
    }
}

/// Mean of the transmittances of rays over a cone from a point along a unit vector, weighted by the cosine
/// of their angle to it; lengths in `unit`.
pub fn by_rays(cone: &Cone, unit: f64, p: DVec3, axis: DVec3, boxes: &[Filled]) -> f64 {
    const RINGS: u32 = 60;
    const TURNS: u32 = 120;
    let [right, up] = [
        axis.any_orthonormal_vector(),
        axis.cross(axis.any_orthonormal_vector()),
    ];
    let range = [cone.gap, cone.length / unit];
    let mut sum = DVec2::ZERO;
    for ring in 0..RINGS {
        // Uniform in solid angle.
        let part = (f64::from(ring) + 0.5) / f64::from(RINGS);
        let cosine = 1.0 - part * (1.0 - cone.half_angle.cos());
        let sine = (1.0 - cosine * cosine).sqrt();
        for turn in 0..TURNS {
            let angle = TAU * (f64::from(turn) + 0.5) / f64::from(TURNS);
            let direction = cosine * axis + sine * (angle.cos() * right + angle.sin() * up);
            let depth: f64 = boxes.iter().map(|b| b.depth(p, direction, range)).sum();
            sum += cosine * DVec2::new((-cone.attenuation * depth).exp(), 1.0);
        }
    }
    sum.x / sum.y
}
