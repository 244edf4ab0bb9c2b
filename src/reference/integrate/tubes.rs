//! Points of wells on a ray, as [`crate::view::Wells`] defines them.

use glam::{DMat3, DVec3};

use super::surfaces::Layer;
use super::{Integrator, Ray};
use crate::view::wells::Capsule;

/// Where a ray meets a capsule.
struct Hit {
    distance: f64,
    /// Unit normal, outward.
    normal: DVec3,
}

impl Integrator<'_> {
    /// The nearest point of a well.
    pub(super) fn tube(&self, ray: Ray) -> Option<Layer> {
        if !self.view.style.surfaces.wells {
            return None;
        }
        let capsules = self.view.shown.wells.capsules.iter();
        let all =
            capsules.flat_map(|capsule| hits(capsule, ray).into_iter().map(move |h| (capsule, h)));
        let seen = all.filter(|(_, hit)| {
            hit.distance > 0.0 && self.is_kept(ray.origin + hit.distance * ray.direction)
        });
        let (capsule, hit) = seen.min_by(|a, b| a.1.distance.total_cmp(&b.1.distance))?;
        let own = DVec3::from(self.view.style.blending.of_srgb(capsule.color));
        let color = self.headlight(hit.normal, ray.direction) * own;
        let position = ray.origin + hit.distance * ray.direction;
        Some(Layer {
            distance: hit.distance,
            color: self.shaded(position, color.to_array(), None).into(),
            alpha: 1.0,
        })
    }
}

impl Integrator<'_> {
    /// True where a ray meets a well within a range of distances.
    pub(super) fn meets_tube(&self, ray: Ray, [start, end]: [f64; 2]) -> bool {
        let capsules = &self.view.shown.wells.capsules;
        let is_met = |hit: Hit| {
            (start..=end).contains(&hit.distance)
                && self.is_kept(ray.origin + hit.distance * ray.direction)
        };
        self.view.style.surfaces.wells
            && capsules
                .iter()
                .any(|c| hits(c, ray).into_iter().any(is_met))
    }
}

/// All points of a capsule's surface on a ray: of the cylinder between its ends and of the half spheres beyond them.
fn hits(capsule: &Capsule, ray: Ray) -> Vec<Hit> {
    let [a, b] = capsule.ends;
    let radius = capsule.radius;
    let length = a.distance(b);
    let axis = (b - a).try_normalize().unwrap_or(DVec3::Z);
    let (x, y) = axis.any_orthonormal_pair();
    // Rows of the rotation that makes the axis that of z.
    let turn = DMat3::from_cols(x, y, axis).transpose();
    let (origin, direction) = (turn * (ray.origin - a), turn * ray.direction);
    let mut hits = Vec::new();
    let mut add = |distance: f64, center: f64| {
        let at = origin + distance * direction;
        let normal = turn.transpose() * (at - center * DVec3::Z) / radius;
        hits.push(Hit { distance, normal });
    };
    let (flat_origin, flat) = (origin.with_z(0.0), direction.with_z(0.0));
    for distance in roots(flat, flat_origin, radius) {
        let height = origin.z + distance * direction.z;
        if height > 0.0 && height < length {
            add(distance, height);
        }
    }
    for distance in roots(direction, origin, radius) {
        if origin.z + distance * direction.z <= 0.0 {
            add(distance, 0.0);
        }
    }
    for distance in roots(direction, origin - length * DVec3::Z, radius) {
        if origin.z + distance * direction.z >= length {
            add(distance, length);
        }
    }
    hits
}

/// Distances at which a point that moves from `origin` is as far from zero as the radius.
fn roots(direction: DVec3, origin: DVec3, radius: f64) -> Vec<f64> {
    let a = direction.length_squared();
    let b = direction.dot(origin);
    let c = origin.length_squared() - radius * radius;
    let discriminant = b * b - a * c;
    if a < 1e-24 || discriminant < 0.0 {
        return Vec::new();
    }
    let root = discriminant.sqrt();
    vec![(-b - root) / a, (-b + root) / a]
}
