//! The transfer function as tables.

use super::layout::LUT_SIZE;
use crate::image::Blending;
use crate::transfer::TransferFunction;
use crate::view::View;

/// Red, green, blue, as they are blended, and extinction at equal distances over the range.
pub fn transfer_table(view: &View) -> Vec<[f32; 4]> {
    table_of(&view.style.transfer, view.style.blending)
}

/// As [`transfer_table`], of any transfer function.
pub fn table_of(transfer: &TransferFunction, blending: Blending) -> Vec<[f32; 4]> {
    let color = |position| blending.of_srgb(transfer.srgb(position)).map(|v| v as f32);
    let extinctions = extinctions(transfer).into_iter();
    positions()
        .zip(extinctions)
        .map(|(position, extinction)| {
            let [r, g, b] = color(position);
            [r, g, b, extinction]
        })
        .collect()
}

/// Extinctions at equal distances over the range.
pub fn extinctions(transfer: &TransferFunction) -> Vec<f32> {
    positions()
        .map(|position| transfer.extinction(position) as f32)
        .collect()
}

/// Transfer-function position of a value that is stored as a part of `range`: offset and factor.
pub fn position(view: &View, range: [f64; 2]) -> [f32; 2] {
    view.style.transfer.positions(range).map(|v| v as f32)
}

fn positions() -> impl Iterator<Item = f64> {
    (0..LUT_SIZE).map(|n| f64::from(n) / f64::from(LUT_SIZE - 1))
}

/// Integrals over the position, from 0 to each entry of the table, of extinction times color and of
/// extinction: between two positions the mean of both is a difference away.
pub fn transfer_integrals(table: &[[f32; 4]]) -> Vec<[f32; 4]> {
    let width = 1.0 / f64::from(LUT_SIZE - 1);
    let mut sum = [0.0f64; 4];
    let mut before = [0.0f64; 4];
    table
        .iter()
        .enumerate()
        .map(|(n, entry)| {
            let tau = f64::from(entry[3]);
            let [r, g, b] = [0, 1, 2].map(|c| tau * f64::from(entry[c]));
            let now = [r, g, b, tau];
            if n > 0 {
                for c in 0..4 {
                    sum[c] += 0.5 * width * (before[c] + now[c]);
                }
            }
            before = now;
            sum.map(|v| v as f32)
        })
        .collect()
}
