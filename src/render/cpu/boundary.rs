//! Where a ray passes the boundary of what is drawn, as samples of its lattice see it: between two passages all
//! samples lie in cells, or none does.

use super::frame::{PixelRay, Ray};
use super::raster::Met;

/// Samples nearer to a face than this part of a step are asked of its cell, against rounding.
const MARGIN: f32 = 0.02;

/// Behind a face, in samples.
const BEHIND: f32 = 1e-3;

/// A boundary face that a ray passes; places are numbers of samples, and parts of them.
#[derive(Debug, Clone, Copy)]
pub struct Passage {
    /// Number of the face.
    pub face: u32,
    /// Samples from here on may lie behind the face.
    pub near: f32,
    /// Samples from here on do.
    pub far: f32,
    /// +1 where the ray comes into the cell of the face, -1 where it leaves, 0 where it does both or neither.
    pub turn: i32,
}

/// The passages of a ray in the order in which it comes to them.
#[derive(Debug, Default)]
pub struct Boundary {
    passages: Vec<Passage>,
    /// Cells that the ray is in before the first of them.
    before: i32,
}

impl Boundary {
    /// Takes the faces that a ray meets. Where it may start among cells, how many it is in follows from the end, which
    /// lies in none.
    pub fn gather(&mut self, met: &[Met], through: &PixelRay, ray: &Ray, step: f32, inside: bool) {
        let scale = f64::from(through.slant) / f64::from(step);
        let sample = |depth: f64| (depth * scale - 0.5 - f64::from(ray.first)) as f32;
        let passages = met.iter().map(|m| Passage {
            face: m.face,
            near: sample(m.span[0]) - MARGIN,
            far: sample(m.span[1]) + MARGIN,
            turn: m.point.map_or(0, |(_, turn)| turn),
        });
        self.passages.clear();
        self.passages.extend(passages);
        self.passages
            .sort_unstable_by(|a, b| a.near.total_cmp(&b.near));
        let all = self.passages.iter().map(|p| p.turn).sum::<i32>();
        self.before = if inside { -all } else { 0 };
    }

    /// The passages to which the ray has come at a sample.
    pub fn until(&self, n: f32) -> &[Passage] {
        let count = self.passages.partition_point(|p| p.near <= n);
        &self.passages[..count]
    }

    /// Where the ray may be in a cell again behind a place outside of all cells, in samples, at most one ahead among
    /// faces that are bent; `None` where it never is.
    pub fn next(&self, n: f32) -> Option<f32> {
        let passed = self.until(n);
        let bent = passed.iter().map(|p| p.far).filter(|far| *far >= n);
        if let Some(far) = bent.reduce(f32::min) {
            return Some((far + BEHIND).min(n + 1.0));
        }
        self.passages.get(passed.len()).map(|p| p.near)
    }

    /// True where there are passages at or before a sample, and at or behind it.
    pub fn surrounds(&self, n: f32) -> bool {
        !self.until(n).is_empty() && self.passages.iter().any(|p| p.far >= n)
    }

    /// How many cells a sample is in, given that those have been asked whose faces are so near that they may begin or
    /// end there, and that it is in none of them.
    pub fn depth(&self, n: f32) -> i32 {
        let turns = self.until(n).iter().map(|p| match p.far < n {
            true => p.turn,
            false => p.turn.min(0),
        });
        self.before + turns.sum::<i32>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From 10 to 20 in one cell, whose far face is bent, then from 19 or 20 to 30 in another one.
    fn boundary() -> Boundary {
        let passages = [
            (10.0, 10.0, 1),
            (18.0, 20.0, -1),
            (19.0, 20.0, 1),
            (30.0, 30.0, -1),
        ];
        let passage = |(near, far, turn)| Passage {
            face: 0,
            near,
            far,
            turn,
        };
        Boundary {
            passages: passages.map(passage).into(),
            before: 0,
        }
    }

    #[test]
    fn samples_outside_are_passed_at_once_and_bent_faces_one_by_one() {
        let boundary = boundary();
        let places = [
            (3.0, 10.0),
            (10.0, 10.0 + BEHIND),
            (18.0, 19.0),
            (19.5, 20.0 + BEHIND),
        ];
        for (n, next) in places {
            assert_eq!(boundary.next(n), Some(next), "{n}");
        }
        assert_eq!(boundary.next(31.0), None);
        assert!(boundary.surrounds(15.0) && !boundary.surrounds(5.0) && !boundary.surrounds(35.0));
    }

    #[test]
    fn a_sample_is_in_a_cell_where_no_face_near_it_says_otherwise() {
        let boundary = boundary();
        let depth = |n: f32| boundary.depth(n);
        assert_eq!(
            [depth(5.0), depth(15.0), depth(25.0), depth(35.0)],
            [0, 1, 1, 0]
        );
        // In neither of the cells whose faces are near.
        assert_eq!([depth(18.5), depth(19.5)], [0, 0]);
    }
}
