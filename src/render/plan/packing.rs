//! Depths and values in 16 bits: in blocks, each with a step of its own, above the smallest number of the block.
//!
//! Numbers are rounded first, here, for every executor; packing what is rounded loses nothing. Steps are powers of two,
//! so that reading a number back is exact arithmetic in f32. Depths of one pillar are rounded alike: in the largest step of
//! the blocks that its lists lie in. What was equal or coincided does so after it, and what was apart stays apart.

use std::ops::Range;

use rayon::prelude::*;

use super::layout::{BLOCK, BLOCK_WORDS};
use crate::model::topology::COINCIDENT;

/// Steps above the smallest number that 16 bits hold.
const MOST_STEPS: f64 = 65535.0;
/// Steps from zero, at most, so that f32 holds each and 24 bits with a sign the smallest of a block.
const MOST_FROM_ZERO: f64 = 4_194_304.0;

/// The biased exponent, as in f32, of the least power of two in which numbers can be packed, with so many steps to spare.
fn exponent(numbers: &[f32], spare: f64) -> u32 {
    let [low, high] = range(numbers);
    let steps = (high - low) / (MOST_STEPS - spare);
    let from_zero = high.abs().max(low.abs()) / (MOST_FROM_ZERO - spare);
    let biased = steps.max(from_zero).log2().ceil() + 127.0;
    biased.clamp(1.0, 254.0) as u32
}

/// The power of two of a biased exponent.
fn power(exponent: u32) -> f64 {
    f64::from(f32::from_bits(exponent << 23))
}

/// Smallest and largest number that is one; zero where none is.
fn range(numbers: &[f32]) -> [f64; 2] {
    let known = numbers.iter().filter(|n| !n.is_nan());
    let start = [f64::INFINITY, f64::NEG_INFINITY];
    let [low, high] = known.fold(start, |[low, high], n| {
        [low.min(f64::from(*n)), high.max(f64::from(*n))]
    });
    if low <= high { [low, high] } else { [0.0; 2] }
}

/// Rounds values to what can be packed, block by block; those that are NaN are never asked for and become any. Returns
/// the largest change.
///
/// Whole numbers below 65,536, such as ranks of categories, stay as they are.
pub fn round_values(values: &mut [f32]) -> f64 {
    let blocks = values.par_chunks_mut(BLOCK as usize);
    let changes = blocks.map(|block| {
        // Both ends may be rounded away from each other.
        let step = power(exponent(block, 1.0));
        let [low, _] = range(block);
        block.iter_mut().fold(0.0, |change: f64, value| {
            let exact = if value.is_nan() {
                low
            } else {
                f64::from(*value)
            };
            let rounded = (exact / step).round() * step;
            *value = rounded as f32;
            change.max((rounded - exact).abs())
        })
    });
    changes.reduce(|| 0.0, f64::max)
}

/// Rounds depths to what can be packed, given where the entries of each pillar lie: ranges that follow each other over
/// all of them. Returns the largest change.
///
/// It is at most half the largest step, but where entries of a pillar are apart by less than a step and by more than
/// [`COINCIDENT`], which keeps them a step apart, and half of [`COINCIDENT`] more where they coincide.
pub fn round_depths(depths: &mut Vec<f32>, pillars: &[Range<usize>]) -> f64 {
    let size = BLOCK as usize;
    let blocks = depths.par_chunks(size);
    let mut exponents: Vec<u32> = blocks.map(|block| exponent(block, 1.0)).collect();
    loop {
        let of_pillar = |entries: &Range<usize>| {
            let blocks = entries.start / size..entries.end.div_ceil(size);
            let largest = exponents[blocks].iter().max().map_or(1, |e| *e);
            rounded_pillar(&depths[entries.clone()], power(largest))
        };
        let rounded: Vec<f32> = pillars.par_iter().flat_map_iter(of_pillar).collect();
        // Coarser steps of a pillar may take a block beyond its own.
        let mut all_fit = true;
        for (block, held) in rounded.chunks(size).zip(&mut exponents) {
            let needed = exponent(block, 0.0);
            all_fit &= needed <= *held;
            *held = needed.max(*held);
        }
        if all_fit {
            let pairs = depths.par_iter().zip(&rounded);
            let change = pairs.map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs());
            let change = change.reduce(|| 0.0, f64::max);
            *depths = rounded;
            return change;
        }
    }
}

/// Depths of a pillar in whole steps. Entries that coincide with the shallowest of them get its middle, and the next
/// ones are farther away than what coincides.
fn rounded_pillar(depths: &[f32], step: f64) -> Vec<f32> {
    let mut order: Vec<usize> = (0..depths.len()).collect();
    order.sort_unstable_by(|a, b| depths[*a].total_cmp(&depths[*b]));
    let depth = |at: &usize| f64::from(depths[*at]);
    let apart = (COINCIDENT / step).floor() + 1.0;
    let mut rounded = vec![0.0; depths.len()];
    let mut number = f64::NEG_INFINITY;
    let mut left = &order[..];
    while let Some(first) = left.first() {
        let count = left.partition_point(|at| depth(at) - depth(first) <= COINCIDENT);
        let (here, deeper) = left.split_at(count);
        let middle = 0.5 * (depth(first) + here.last().map_or(0.0, depth));
        number = (middle / step).round().max(number + apart);
        for at in here {
            rounded[*at] = (number * step) as f32;
        }
        left = deeper;
    }
    rounded
}

/// Rounded numbers in blocks. A block is a word with the smallest number in steps (24 bits with a sign) above the step's
/// exponent (8 bits, as in f32), and two words for each four numbers: how many steps each lies above the smallest.
pub fn packed(rounded: &[f32]) -> Vec<u32> {
    let blocks = rounded.par_chunks(BLOCK as usize);
    let words = blocks.flat_map_iter(|block| {
        let exponent = exponent(block, 0.0);
        let step = power(exponent);
        let low = (range(block)[0] / step).round();
        let above = move |number: &f32| (f64::from(*number) / step - low).round() as u32;
        let pairs = block.chunks(2).map(move |pair| {
            let [a, b] = [pair.first(), pair.get(1)].map(|n| n.map_or(0, above));
            a | b << 16
        });
        let head = (low as i32 as u32) << 8 | exponent;
        std::iter::once(head).chain(pairs)
    });
    words.collect()
}

/// A number by its position; the twin of what `shaders/shared/grid.wgsl` does.
pub fn unpacked(words: &[u32], entry: u32) -> f32 {
    let head = BLOCK_WORDS * (entry / BLOCK);
    let pair = words[(head + 1 + entry % BLOCK / 2) as usize];
    let head = words[head as usize];
    let number = (head as i32 >> 8) + (pair >> (16 * (entry % 2)) & 0xffff) as i32;
    number as f32 * f32::from_bits((head & 0xff) << 23)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lists of several pillars, with layers that touch, collapse, nearly do and are thin, and where they begin.
    fn pool() -> (Vec<f32>, Vec<Range<usize>>) {
        let mut random = fastrand::Rng::with_seed(5);
        let mut depths = Vec::new();
        let mut pillars = Vec::new();
        for pillar in 0..400 {
            let start = depths.len();
            // Rows of pillars end where the model is deepest.
            let mut depth = 7.0 * f64::from(pillar % 20) - 900.0;
            let mut list = vec![depth as f32];
            for _ in 0..23 {
                depth += match random.u32(0..12) {
                    0 => 0.0,
                    1 => 4e-4,
                    2 => 2e-3,
                    _ => 3.0 * random.f64(),
                };
                list.push(depth as f32);
            }
            depths.extend(&list);
            if random.bool() {
                // Another list of the pillar has most depths of the first one.
                let thrown = |d: &f32| if random.u32(0..4) == 0 { *d + 1.5 } else { *d };
                depths.extend(list.iter().map(thrown));
            }
            pillars.push(start..depths.len());
        }
        (depths, pillars)
    }

    #[test]
    fn rounded_numbers_are_packed_without_loss() {
        let (exact, pillars) = pool();
        let mut depths = exact.clone();
        let change = round_depths(&mut depths, &pillars);
        let mut values: Vec<f32> = (0..997).map(|n| 200.0 + (n as f32).sin()).collect();
        let off = round_values(&mut values);
        // A row ends 133 m and a list 36 m below the next one's begin.
        assert!(change > 0.0 && change <= 2.0 / 256.0, "{change}");
        assert!(off > 0.0 && off <= 0.5 / 16384.0, "{off}");
        for numbers in [&depths, &values] {
            let words = packed(numbers);
            assert!(words.len() * 4 * 100 < numbers.len() * 214);
            for (entry, number) in numbers.iter().enumerate() {
                assert_eq!(unpacked(&words, entry as u32), *number, "{entry}");
            }
        }
    }

    #[test]
    fn what_coincides_does_so_after_rounding_and_nothing_else() {
        let (exact, pillars) = pool();
        let mut depths = exact.clone();
        round_depths(&mut depths, &pillars);
        let [mut equal, mut near, mut apart] = [0; 3];
        for pillar in pillars {
            for (a, b) in pillar
                .clone()
                .flat_map(|a| (a + 1..pillar.end).map(move |b| (a, b)))
            {
                let before = f64::from(exact[b]) - f64::from(exact[a]);
                let after = f64::from(depths[b]) - f64::from(depths[a]);
                match before.abs() {
                    0.0 => equal += usize::from(after == 0.0),
                    // A stack of thin layers is cut into what coincides somewhere.
                    d if d <= 0.5 * COINCIDENT => near += usize::from(after == 0.0),
                    d if d <= 1.5 * COINCIDENT => continue,
                    _ => apart += usize::from(after * before > 0.0 && after.abs() > COINCIDENT),
                }
                let kept = after * before >= 0.0 && (before != 0.0 || after == 0.0);
                assert!(kept, "{before} {after}");
                assert!(before.abs() <= 1.5 * COINCIDENT || after.abs() > COINCIDENT);
            }
        }
        assert!(
            equal > 1000 && near > 100 && apart > 10_000,
            "{equal} {near} {apart}"
        );
    }

    #[test]
    fn categories_stay_exact_and_what_is_unknown_costs_nothing() {
        let mut ranks: Vec<f32> = (0..500u16).map(|n| f32::from(n * 131)).collect();
        ranks.extend([0.0, 65534.0, f32::NAN, 1.0]);
        let exact = ranks.clone();
        assert_eq!(round_values(&mut ranks), 0.0);
        let known = exact.iter().zip(&ranks).filter(|(e, _)| !e.is_nan());
        assert!(known.into_iter().all(|(a, b)| a == b));
        // Pressures beside vertices that no drawn cell touches.
        let mut values = vec![f32::NAN; 32];
        values[3] = 200.3;
        values[9] = 201.1;
        let off = round_values(&mut values);
        assert!(off < 1e-4 && values.iter().all(|v| (200.0..202.0).contains(v)));
        assert_eq!(packed(&[f32::NAN.max(0.0); 3]).len(), 3);
    }
}
