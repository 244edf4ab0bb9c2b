//! Samples of traces as values of a volume.

use super::super::lattice::Region;
use super::super::sample::{Coding, Value};
use super::super::source::Source;
use super::grid::NONE;
use super::header::TRACE_HEADER;
use super::scan::Layout;
use crate::error::ParseError;

/// Which trace stands at each place of the lattice.
#[derive(Debug)]
pub(in super::super) struct Traces {
    layout: Layout,
    /// Places along i and j.
    dims: [usize; 2],
    traces: Vec<u32>,
    slow_axis: usize,
}

/// The axis along which traces of the file are farther apart.
fn slow_axis([ni, nj]: [usize; 2], traces: &[u32]) -> usize {
    let apart = |step: usize| {
        let pairs = traces.iter().zip(traces.iter().skip(step));
        let pairs = pairs.filter(|(a, b)| **a != NONE && **b != NONE).take(1000);
        let (sum, count) = pairs.fold((0, 0), |(sum, count), (a, b)| {
            (sum + u64::from(a.abs_diff(*b)), count + 1)
        });
        sum as f64 / f64::from(count.max(1))
    };
    // Along i by `ni` traces: lines of equal j are together.
    usize::from(ni == 1 || (nj > 1 && apart(ni) > apart(1)))
}

impl Traces {
    pub(super) fn new(layout: Layout, dims: [usize; 2], traces: Vec<u32>) -> Self {
        Self {
            slow_axis: slow_axis(dims, &traces),
            layout,
            dims,
            traces,
        }
    }

    pub(in super::super) fn slow_axis(&self) -> usize {
        self.slow_axis
    }

    /// Values of a region, i fastest.
    pub(in super::super) fn read<T: Value>(
        &self,
        source: &Source,
        coding: Coding,
        region: Region,
        out: &mut [T],
    ) -> Result<(), ParseError> {
        out.fill(T::NONE);
        let [ni, nj, nk] = region.size;
        let size = coding.kind.size();
        let mut bytes = vec![0; nk * size];
        let mut values = vec![T::NONE; nk];
        let first = TRACE_HEADER + (region.start[2] * size) as u64;
        // In the order of the file, as far as possible.
        let is_by_inline = self.slow_axis() == 0;
        for n in 0..ni * nj {
            let [i, j] = match is_by_inline {
                true => [n / nj, n % nj],
                false => [n % ni, n / ni],
            };
            let trace = self.traces[(region.start[1] + j) * self.dims[0] + region.start[0] + i];
            if trace == NONE {
                continue;
            }
            let start = self.layout.start + u64::from(trace) * self.layout.length;
            source.read(start + first, &mut bytes)?;
            coding.decode(&bytes, size, &mut values);
            for (k, value) in values.iter().enumerate() {
                out[(k * nj + j) * ni + i] = *value;
            }
        }
        Ok(())
    }
}
