//! The transfer function on the device.

use super::device::{Gpu, GpuError};
use super::layout::LUT_SIZE;
use crate::transfer::TransferFunction;

/// Its table and the integrals over it, for one transfer function.
pub struct TransferTables {
    transfer: TransferFunction,
    /// Linear color and extinction at equal distances over the range.
    pub table: wgpu::Buffer,
    /// Integrals over the position of extinction times color, and of extinction.
    pub integrals: wgpu::Buffer,
}

impl TransferTables {
    /// Uploads the tables.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn new(gpu: &Gpu, transfer: &TransferFunction) -> Result<Self, GpuError> {
        let table = transfer_table(transfer);
        Ok(Self {
            integrals: gpu.storage("transfer integrals", &transfer_integrals(&table))?,
            table: gpu.storage("transfer table", &table)?,
            transfer: transfer.clone(),
        })
    }

    /// True where they are those of `transfer`.
    pub fn are_of(&self, transfer: &TransferFunction) -> bool {
        self.transfer == *transfer
    }
}

/// Linear red, green, blue and extinction at equal distances over the range.
pub(super) fn transfer_table(transfer: &TransferFunction) -> Vec<[f32; 4]> {
    (0..LUT_SIZE)
        .map(|n| {
            let position = f64::from(n) / f64::from(LUT_SIZE - 1);
            let [r, g, b] = transfer.linear_rgb(position).map(|v| v as f32);
            [r, g, b, transfer.extinction(position) as f32]
        })
        .collect()
}

/// Integrals over the position, from 0 to each entry of the table, of extinction times color and of
/// extinction: between two positions the mean of both is a difference away.
fn transfer_integrals(table: &[[f32; 4]]) -> Vec<[f32; 4]> {
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
