//! Which of the things on a ray is the one that is seen.

use std::collections::HashMap;

use super::gather::{Gathered, PieceSource};
use crate::image::metrics::{ciede2000, lab};
use crate::model::Ijk;

/// CIEDE2000 at which a color counts little as that of the pixel.
const LIKE: f64 = 8.0;
/// The same for the color of a cell's own value, which counts less than the one that is seen of it.
const OWN_LIKE: f64 = 20.0;
/// How much colors count at least: where none is like the pixel's, contributions decide.
const UNLIKE: f64 = 1e-4;

/// What is seen: a cell, a sheet, a well or a volume beside the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Thing {
    Cell(Ijk),
    /// The piece that it is.
    Sheet(usize),
    /// The piece that it is.
    Well(usize),
    /// A volume beside the model.
    Cube,
}

/// How much a thing adds to the color that is seen.
struct Score {
    sum: f64,
    /// The piece that adds most, and what it adds.
    piece: usize,
    most: f64,
    /// How far the color of its own value is from that of the pixel.
    own_apart: f64,
}

/// The piece that is seen: see [the rule](super). `own_color` is the color of a cell's own value (sRGB, 0..1).
/// `None` where nothing contributes to the pixel.
pub(super) fn seen(
    gathered: &Gathered,
    own_color: impl Fn(Ijk) -> Option<[f64; 3]>,
) -> Option<usize> {
    let pixel = lab(gathered.color());
    let apart = |color: [f64; 3]| ciede2000(lab(color), pixel);
    let mut scores: Vec<Score> = Vec::new();
    let mut places: HashMap<Thing, usize> = HashMap::new();
    for (n, (piece, contribution)) in gathered.pieces.iter().enumerate() {
        let (thing, own) = match &piece.of {
            PieceSource::Cell { ijk, .. } => (Thing::Cell(*ijk), own_color(*ijk)),
            PieceSource::Sheet(_) => (Thing::Sheet(n), None),
            PieceSource::Well(_) => (Thing::Well(n), None),
            PieceSource::Cube(_) => (Thing::Cube, Some(piece.color)),
            PieceSource::Ghost => continue,
        };
        if *contribution <= 0.0 {
            continue;
        }
        let place = *places.entry(thing).or_insert_with(|| {
            scores.push(Score {
                sum: 0.0,
                piece: n,
                most: 0.0,
                own_apart: apart(own.unwrap_or(piece.color)),
            });
            scores.len() - 1
        });
        scores[place].add(n, *contribution, apart(piece.color));
    }
    let best = scores.iter().max_by(|a, b| a.sum.total_cmp(&b.sum))?;
    Some(best.piece)
}

impl Score {
    /// Adds a piece whose color is so far from the pixel's.
    fn add(&mut self, piece: usize, contribution: f64, apart: f64) {
        let unlikeness = (apart / LIKE).powi(2) + (self.own_apart / OWN_LIKE).powi(2);
        let adds = contribution * (-unlikeness).exp().max(UNLIKE);
        self.sum += adds;
        if adds > self.most {
            (self.piece, self.most) = (piece, adds);
        }
    }
}
