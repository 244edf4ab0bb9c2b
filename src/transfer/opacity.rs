//! Opacity found in the values: what is rich in the quantity that one looks for is the most solid, the rest is
//! a haze that still shows.

use rayon::prelude::*;

use super::function::Curve;
use super::shares::{Weighted, shares_below};

/// Which end of a property's range one looks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Interest {
    /// High values: oil, gas, porosity.
    High,
    /// Low values: where pressure has fallen.
    Low,
    /// Both ends: differences.
    Ends,
    /// All values alike: regions, depths.
    Alike,
}

/// A cell, as far as its opacity matters.
#[derive(Debug, Clone, Copy)]
pub struct Cell {
    /// Position of its value in the range, 0..1.
    pub position: f64,
    /// Its pore volume, in any unit.
    pub volume: f64,
    /// Its thinnest extent in world space.
    pub extent: f64,
}

impl Cell {
    /// True where the cell has all that its opacity follows from.
    fn counts(&self) -> bool {
        self.position.is_finite() && self.volume > 0.0 && self.extent > 0.0
    }

    /// Its volume, where it counts.
    fn weight(&self) -> f64 {
        if self.counts() { self.volume } else { 0.0 }
    }
}

/// An opacity curve and the length in world space that it refers to.
#[derive(Debug, Clone, PartialEq)]
pub struct Opacity {
    /// Opacity per reference length by position.
    pub curve: Curve<f64>,
    /// Reference length.
    pub reference_length: f64,
}

/// Opacity at which a cell shows that stands alone on a ray, through its thinnest extent.
pub const SHOWS: f64 = 0.1;
/// Share of what one looks for that lies in cells that show.
const SHOWN: f64 = 0.965;
/// Share of it that lies in values below which there is but haze.
const HAZE_SHARE: f64 = 0.015;
/// Shares of it below which opacity is that of a veil, and from which on it is that of a body.
const BODY_SHARES: [f64; 2] = [0.4, 0.7];
/// Opacities per reference length where the veil begins, where it ends, of a body, and at the end of the range.
const OPACITIES: [f64; 4] = [0.13, 0.3, 0.9, 0.97];
/// Opacity of the haze through the whole model.
const HAZE: f64 = 0.35;
/// The haze per reference length, at most.
const MOST_HAZE: f64 = 0.08;
/// Opacity per reference length where all values are alike.
const ALIKE: f64 = 0.6;
/// Opacity per reference length of a property that is the same everywhere.
const CONSTANT: f64 = 0.95;

/// The opacity for some cells of a model whose thinnest extent in world space, all cells along it, is
/// `model_extent`; `None` where no cell has a value and a volume.
///
/// Cells are weighted by pore volume times how far their value lies toward the interesting end: for a
/// saturation that is the volume of the phase. The curve rises at fixed shares of that weight, and the
/// reference length is so chosen that cells with 96.5 % of it have an opacity of [`SHOWS`] or more each,
/// through their own thinnest extent.
pub fn find(
    interest: Interest,
    cells: impl IndexedParallelIterator<Item = Cell> + Clone,
    model_extent: f64,
) -> Option<Opacity> {
    let (low, high) = ends(cells.clone())?;
    if interest == Interest::Alike || high - low < 1e-6 {
        let opacity = if interest == Interest::Alike {
            ALIKE
        } else {
            CONSTANT
        };
        let extents = cells.map(|c| (c.extent, c.weight()));
        return Some(Opacity {
            curve: vec![(0.0, opacity), (1.0, opacity)],
            reference_length: shares_below(extents, [0.5])?[0],
        });
    }
    let weighted = |c: Cell| {
        let richness = interest.richness(c.position);
        (richness, c.weight() * richness)
    };
    let [veil, body] = [HAZE_SHARE, BODY_SHARES[0]];
    let weights = cells.clone().map(weighted);
    let rich = shares_below(weights, [veil, body, BODY_SHARES[1]])?;
    let rising = rising(rich);
    // The length at which each cell just shows; the haze is decided after it.
    let lengths = cells.map(|cell| {
        let (richness, weight) = weighted(cell);
        let opacity = at_richness(&rising, richness);
        let needed = (1.0 - SHOWS).ln() / (1.0 - opacity).ln();
        (cell.extent / needed, weight)
    });
    let lengths: Vec<Weighted> = lengths.collect();
    let [reference_length] = shares_below(lengths.par_iter().copied(), [1.0 - SHOWN])?;
    let layers = (model_extent / reference_length).max(1.0);
    let haze = (1.0 - (1.0 - HAZE).powf(1.0 / layers)).min(MOST_HAZE);
    Some(Opacity {
        curve: interest.curve(&with_haze(rising, haze)),
        reference_length,
    })
}

fn ends(cells: impl ParallelIterator<Item = Cell>) -> Option<(f64, f64)> {
    let counting = cells.filter(Cell::counts);
    let ends = counting.map(|c| (c.position, c.position));
    ends.reduce_with(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

/// Opacity by richness from where the veil begins, without haze.
fn rising([veil, body, solid]: [f64; 3]) -> [(f64, f64); 4] {
    // Equal shares of one value are told apart by no more than a table of the curve can.
    let least = 2e-3;
    let veil = veil.min(1.0 - 4.0 * least);
    let body = body.clamp(veil + least, 1.0 - 2.0 * least);
    let solid = solid.clamp(body + least, 1.0 - least);
    let [a, b, c, d] = OPACITIES;
    [(veil, a), (body, b), (solid, c), (1.0, d)]
}

/// Opacity at a richness; next to nothing below the veil.
fn at_richness(rising: &[(f64, f64); 4], richness: f64) -> f64 {
    if richness < rising[0].0 - 1e-9 {
        return 1e-6;
    }
    let (a, b, f) = super::function::segment(rising, richness);
    a + (b - a) * f
}

/// The whole curve by richness: haze up to just below the veil.
fn with_haze(rising: [(f64, f64); 4], haze: f64) -> Curve<f64> {
    let veil = rising[0].0;
    let mut curve = vec![(0.0, haze)];
    let before = 0.85 * veil;
    if before > 1e-3 {
        curve.push((before, haze));
    }
    if veil > 0.0 {
        curve.extend(rising);
    } else {
        curve.extend(&rising[1..]);
        curve[0].1 = rising[0].1;
    }
    curve
}

impl Interest {
    /// How far a position lies toward the end that one looks for, 0..1.
    fn richness(self, position: f64) -> f64 {
        match self {
            Self::High | Self::Alike => position,
            Self::Low => 1.0 - position,
            Self::Ends => (2.0 * position - 1.0).abs(),
        }
    }

    /// A curve over positions from one over richness.
    fn curve(self, rich: &Curve<f64>) -> Curve<f64> {
        let turned = |to: &dyn Fn(f64) -> f64| -> Curve<f64> {
            rich.iter().map(|(r, opacity)| (to(*r), *opacity)).collect()
        };
        match self {
            Self::High | Self::Alike => rich.clone(),
            Self::Low => {
                let mut curve = turned(&|r| 1.0 - r);
                curve.reverse();
                curve
            }
            Self::Ends => {
                let mut curve = turned(&|r| 0.5 - 0.5 * r);
                curve.reverse();
                curve.extend(turned(&|r| 0.5 + 0.5 * r).split_off(1));
                curve
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transfer::function::segment;

    /// Half of the cells hold nothing, the others from a little to much, in layers of 1 to 4.
    fn cells() -> Vec<Cell> {
        let cell = |n: usize| Cell {
            position: (n as f64 / 500.0 - 1.0).max(0.0),
            volume: 1.0 + (n % 3) as f64,
            extent: 1.0 + (n % 4) as f64,
        };
        (0..1000).map(cell).collect()
    }

    fn opacity(found: &Opacity, cell: &Cell) -> f64 {
        let (a, b, f) = segment(&found.curve, cell.position);
        1.0 - (1.0 - (a + (b - a) * f)).powf(cell.extent / found.reference_length)
    }

    fn share_that_shows(found: &Opacity, richness: impl Fn(f64) -> f64) -> f64 {
        let (mut shown, mut all) = (0.0, 0.0);
        for cell in cells() {
            let weight = cell.volume * richness(cell.position);
            all += weight;
            shown += if opacity(found, &cell) >= SHOWS - 1e-9 {
                weight
            } else {
                0.0
            };
        }
        shown / all
    }

    #[test]
    fn what_one_looks_for_shows_whatever_the_length_unit() {
        for scale in [1e-3, 1.0, 1e4] {
            let scaled: Vec<Cell> = cells()
                .into_iter()
                .map(|c| Cell {
                    extent: scale * c.extent,
                    ..c
                })
                .collect();
            let mut found = find(Interest::High, scaled.into_par_iter(), 40.0 * scale).unwrap();
            found.reference_length /= scale;
            assert!(share_that_shows(&found, |p| p) >= 0.96);
            // A length three times as long hides more than it may.
            found.reference_length *= 3.0;
            assert!(share_that_shows(&found, |p| p) < 0.96);
        }
    }

    #[test]
    fn the_rich_end_is_solid_and_the_rest_a_haze() {
        let at = |interest, position| {
            let found = find(interest, cells().into_par_iter(), 40.0).unwrap();
            let rising = found.curve.is_sorted_by(|a, b| a.0 <= b.0);
            assert!(rising && found.curve[0].0 == 0.0 && found.curve.last().unwrap().0 == 1.0);
            let (a, b, f) = segment(&found.curve, position);
            a + (b - a) * f
        };
        assert!(at(Interest::High, 1.0) > 0.9 && at(Interest::High, 0.0) < 0.1);
        assert!(at(Interest::Low, 0.0) > 0.9 && at(Interest::Low, 1.0) < 0.2);
        assert!(at(Interest::Ends, 0.0) > 0.9 && at(Interest::Ends, 1.0) > 0.9);
        assert!(at(Interest::Ends, 0.5) < 0.2);
        assert!(at(Interest::High, 0.0) > 0.0);
        let alike = find(Interest::Alike, cells().into_par_iter(), 40.0).unwrap();
        assert_eq!(alike.curve[0].1, alike.curve[1].1);
    }

    #[test]
    fn constant_values_are_a_body_and_nothing_has_no_opacity() {
        let same: Vec<Cell> = cells()
            .into_iter()
            .map(|c| Cell { position: 0.5, ..c })
            .collect();
        let found = find(Interest::High, same.into_par_iter(), 40.0).unwrap();
        assert!(found.curve.iter().all(|p| p.1 == CONSTANT));
        assert_eq!(find(Interest::High, rayon::iter::empty(), 1.0), None);
        let empty = [Cell {
            position: 0.2,
            volume: 0.0,
            extent: 1.0,
        }];
        assert_eq!(find(Interest::High, empty.into_par_iter(), 1.0), None);
        // All at the poor end: nothing that one looks for, so that only the ends of the range differ.
        let odd = [f64::NAN, 0.0, 1.0].map(|position| Cell {
            position,
            volume: 1.0,
            extent: 1.0,
        });
        assert!(find(Interest::High, odd.into_par_iter(), 1.0).is_some());
    }
}
