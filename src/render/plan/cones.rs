//! Tables of sections: where along a cone the extinction pyramid is asked, and what each answer counts
//! (campagnolo-2021, 3.2 and appendix A).

use std::f64::consts::{PI, SQRT_2};

use crate::view::lighting::Cone;

/// Distance from one section to the next, in standard deviations of their level: so a sum of Gaussians
/// is all but constant between them.
const SPACING: f64 = 2.5;
/// Radius, in standard deviations, at which a section is split, or taken from the next level.
const WIDEST: f64 = 2.0;
/// The same for even media: a disk's own standard deviation along an axis is half its radius, and this keeps
/// those of the levels, which double, about it.
const WIDEST_EVEN: f64 = 2.0 * SQRT_2;
/// Radius of each part, as a part of the cone's, by its number of parts: circles packed in a circle.
fn part_radius(parts: u32) -> f64 {
    match parts {
        3 => 1.0 / (1.0 + 2.0 / 3f64.sqrt()),
        7 => 1.0 / 3.0,
        _ => 1.0,
    }
}

/// A section of a cone.
///
/// **Units**: lengths in standard deviations of the pyramid's finest level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// From the cone's tip.
    pub distance: f64,
    /// Standard deviation of its level.
    pub sigma: f64,
    /// Level of the pyramid.
    pub level: u32,
    /// Parts of the cone here: 1, 3 or 7.
    pub parts: u32,
    /// Radius of a part.
    pub radius: f64,
    /// Factor on the pyramid's extinction.
    pub amplitude: f64,
    /// Half of the length that the section and the one before it stand for together.
    pub weight: f64,
}

/// All sections of a cone, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct ConeTable {
    /// Parts rise from section to section.
    pub sections: Vec<Section>,
}

/// Sections at most: more would come of no cone within a box that a texture can hold.
const MOST_SECTIONS: usize = 4096;

impl ConeTable {
    /// The table of a cone of `half_angle` (radians), up to `splits` parts, from `gap` to before `length`,
    /// both in standard deviations of the finest level.
    pub fn new(half_angle: f64, splits: u32, gap: f64, length: f64) -> Self {
        Self::with_widest(WIDEST, half_angle, splits, gap, length)
    }

    fn with_widest(widest: f64, half_angle: f64, splits: u32, gap: f64, length: f64) -> Self {
        let tangent = half_angle.tan();
        let mut sections = Vec::new();
        let (mut distance, mut level, mut parts) = (gap, 0, 1);
        let mut before: Option<f64> = None;
        while distance < length && sections.len() < MOST_SECTIONS {
            (level, parts) = resolution(distance * tangent / widest, level, parts, splits);
            let sigma = f64::from(level).exp2();
            let radius = distance * tangent * part_radius(parts);
            sections.push(Section {
                distance,
                sigma,
                level,
                parts,
                radius,
                amplitude: amplitude(radius, sigma),
                weight: match before {
                    None => 0.5 * sigma * (2.0 * PI).sqrt(),
                    Some(before) => 0.25 * SPACING * (before + sigma),
                },
            });
            before = Some(sigma);
            // The next section's level is judged as far ahead as if it were on this one's.
            let ahead = (distance + SPACING * sigma) * tangent / widest;
            let (next, _) = resolution(ahead, level, parts, splits);
            distance += 0.5 * SPACING * (sigma + f64::from(next).exp2());
        }
        Self { sections }
    }

    /// The table of a checked cone, given the finest level's standard deviation in world space. The
    /// attenuation is in the amplitudes.
    pub fn of(cone: &Cone, sigma: f64) -> Self {
        let length = cone.length / sigma;
        let mut table = match cone.even_media {
            true => Self::of_even_media(cone.half_angle, cone.splits, cone.gap, length),
            false => Self::new(cone.half_angle, cone.splits, cone.gap, length),
        };
        for section in &mut table.sections {
            section.amplitude *= cone.attenuation;
        }
        table
    }

    /// As [`Self::new`] for media that are even within a section: the mean over its area is what the pyramid
    /// holds, and the sections stand for the cone from its gap to its end, no more and no less.
    ///
    /// The paper's amplitude takes what the pyramid holds as the peak of a Gaussian, which an even medium
    /// has not: at a radius of two standard deviations it counts half of it.
    pub fn of_even_media(half_angle: f64, splits: u32, gap: f64, length: f64) -> Self {
        let mut table = Self::with_widest(WIDEST_EVEN, half_angle, splits, gap, length);
        for section in &mut table.sections {
            section.amplitude = 1.0;
        }
        match table.sections.as_mut_slice() {
            [] => {}
            [only] => only.weight = length - gap,
            [first, .., last] => {
                // Nothing lies before the first one, and the last one reaches to the end.
                first.weight = 0.0;
                last.weight += 0.5 * (length - last.distance);
            }
        }
        table
    }

    /// Number of sections of one part, of three and of seven.
    pub fn by_parts(&self) -> [u32; 3] {
        [1, 3, 7].map(|parts| {
            let of = self.sections.iter().filter(|s| s.parts == parts);
            of.count() as u32
        })
    }
}

/// Level and parts with which a section is fine enough: it splits first and takes a coarser level once no
/// split is left. `radius` is the cone's, as a part of the widest that the finest level allows.
fn resolution(radius: f64, mut level: u32, mut parts: u32, splits: u32) -> (u32, u32) {
    while radius * part_radius(parts) >= f64::from(level).exp2() {
        match parts {
            1 if splits > 1 => parts = 3,
            3 if splits > 3 => parts = 7,
            _ => level += 1,
        }
    }
    (level, parts)
}

/// Integral of a Gaussian of peak 1 over the square around a disk, per area of the disk.
fn amplitude(radius: f64, sigma: f64) -> f64 {
    let relative = radius / sigma;
    if relative < 1e-6 {
        // The limit on the axis.
        return 4.0 / PI;
    }
    let part = libm::erf(relative / 2f64.sqrt());
    2.0 * (part / relative).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At ten angles: what each section is must follow from its distance by the paper's formulas.
    #[test]
    fn sections_follow_the_formulas() {
        for degrees in [0.5, 1.0, 2.0, 3.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0f64] {
            for splits in [1, 3, 7] {
                let table = ConeTable::new(degrees.to_radians(), splits, 3.0, 100.0);
                assert_eq!(table.sections[0].distance, 3.0);
                for (n, s) in table.sections.iter().enumerate() {
                    let packed = [0.0, 1.0, 0.0, 0.464_101_6, 0.0, 0.0, 0.0, 1.0 / 3.0];
                    let radius = s.distance * degrees.to_radians().tan() * packed[s.parts as usize];
                    assert!((s.radius - radius).abs() < 1e-6 * radius);
                    assert!(s.radius < 2.0 * s.sigma && s.parts <= splits);
                    let p = libm::erf(s.radius / (s.sigma * 2f64.sqrt()));
                    let a = p * p * s.sigma * s.sigma * 2.0 * PI / (PI * s.radius * s.radius);
                    assert!((s.amplitude - a).abs() < 1e-9);
                    if n > 0 {
                        let before = table.sections[n - 1];
                        assert!(s.parts >= before.parts && s.level >= before.level);
                        assert!((s.weight - 0.625 * (before.sigma + s.sigma)).abs() < 1e-12);
                        // The next level is judged from nearer than where the section then lies.
                        let step = s.distance - before.distance;
                        assert!(step > 2.5 * before.sigma - 1e-9 && step < 2.0 * s.weight + 1e-9);
                        // Only where no split is left is a coarser level taken.
                        assert!(s.level == before.level || s.parts == splits);
                    }
                }
                let last = table.sections.last().unwrap();
                assert!((100.0 - 5.0 * last.sigma..100.0).contains(&last.distance));
            }
        }
    }

    /// Optical depth of a table in an even medium of one a unit of length.
    fn depth(table: &ConeTable) -> f64 {
        let (mut depth, mut before) = (0.0, 0.0);
        for section in &table.sections {
            depth += section.weight * (before + section.amplitude);
            before = section.amplitude;
        }
        depth
    }

    #[test]
    fn an_even_medium_counts_its_length() {
        for degrees in [0.5, 3.0, 10.0, 20.0, 30.0f64] {
            for (splits, length) in [(1, 100.0), (3, 66.0), (7, 50.0), (7, 4.0)] {
                let angle = degrees.to_radians();
                let even = ConeTable::of_even_media(angle, splits, 3.0, length);
                assert!((depth(&even) - (length - 3.0)).abs() < 1e-9, "{degrees}");
                let narrow = |s: &Section| s.radius < 2.0 * SQRT_2 * s.sigma;
                assert!(even.sections.iter().all(narrow));
            }
        }
        // What the paper admits: too light.
        let paper = ConeTable::new(0.35, 7, 3.0, 100.0);
        assert!(depth(&paper) < 0.8 * 97.0, "{}", depth(&paper));
    }
}
