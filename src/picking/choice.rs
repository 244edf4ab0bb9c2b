//! Which of the things on a ray is the one that is seen.

use std::collections::HashMap;

use super::gather::{Gathered, Source};
use crate::metrics::{ciede2000, lab};
use crate::model::Ijk;

/// CIEDE2000 at which a color counts little as that of the pixel.
const LIKE: f64 = 8.0;
/// The same for the color of a cell's own value, which counts less than the one that is seen of it.
const OWN_LIKE: f64 = 20.0;

/// What is seen: a cell or a sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Thing {
    Cell(Ijk),
    /// The piece that it is.
    Sheet(usize),
}

/// How much a thing adds to the color that is seen.
struct Score {
    thing: Thing,
    sum: f64,
    /// The piece that adds most, and what it adds.
    piece: usize,
    most: f64,
}

/// The piece that is seen: see [the rule](super). `own_color` is the color of a cell's own value (sRGB, 0..1).
/// `None` where nothing contributes to the pixel.
pub(super) fn seen(
    gathered: &Gathered,
    own_color: impl Fn(Ijk) -> Option<[f64; 3]>,
) -> Option<usize> {
    let pixel = lab(gathered.color());
    let likeness =
        |color: [f64; 3], like: f64| (-(ciede2000(lab(color), pixel) / like).powi(2)).exp();
    let mut scores: Vec<Score> = Vec::new();
    let mut places: HashMap<Thing, usize> = HashMap::new();
    for (n, (piece, contribution)) in gathered.pieces.iter().enumerate() {
        let thing = match &piece.of {
            Source::Cell { ijk, .. } => Thing::Cell(*ijk),
            Source::Sheet(_) => Thing::Sheet(n),
            Source::Ghost => continue,
        };
        if *contribution <= 0.0 {
            continue;
        }
        let adds = contribution * likeness(piece.color, LIKE);
        let place = *places.entry(thing).or_insert(scores.len());
        match scores.get_mut(place) {
            Some(score) => score.add(n, adds),
            None => scores.push(Score {
                thing,
                sum: adds,
                piece: n,
                most: adds,
            }),
        }
    }
    for score in &mut scores {
        if let Thing::Cell(ijk) = score.thing
            && let Some(color) = own_color(ijk)
        {
            score.sum *= likeness(color, OWN_LIKE);
        }
    }
    let best = scores.iter().max_by(|a, b| a.sum.total_cmp(&b.sum))?;
    Some(best.piece)
}

impl Score {
    fn add(&mut self, piece: usize, adds: f64) {
        self.sum += adds;
        if adds > self.most {
            (self.piece, self.most) = (piece, adds);
        }
    }
}
