//! Where the samples of a volume are: their numbers, and an affine map from these to places.

/// The lattice of samples: sample (i, j, k) is at `origin + i * edges[0] + j * edges[1] + k * edges[2]`.
///
/// Places are in the file's own frame and units; edges may be rotated and sheared, as the bins of seismic are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice {
    /// Samples along i, j and k.
    pub dims: [usize; 3],
    /// Place of the first sample.
    pub origin: [f64; 3],
    /// Steps from one sample to the next along i, j and k.
    pub edges: [[f64; 3]; 3],
}

impl Lattice {
    /// Samples along axes that are those of space, `spacing` apart, the first one at `origin`.
    pub fn straight(dims: [usize; 3], origin: [f64; 3], spacing: [f64; 3]) -> Self {
        let mut edges = [[0.0; 3]; 3];
        for axis in 0..3 {
            edges[axis][axis] = spacing[axis];
        }
        Self {
            dims,
            origin,
            edges,
        }
    }

    /// The place that is `at` steps from the first sample; halves are allowed.
    pub fn place(&self, at: [f64; 3]) -> [f64; 3] {
        let mut place = self.origin;
        for (edge, steps) in self.edges.iter().zip(at) {
            for (coordinate, step) in place.iter_mut().zip(edge) {
                *coordinate += step * steps;
            }
        }
        place
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.dims.iter().product()
    }

    /// Lengths of the edges.
    pub fn spacing(&self) -> [f64; 3] {
        self.edges
            .map(|edge| edge.iter().map(|v| v * v).sum::<f64>().sqrt())
    }

    /// All samples.
    pub fn region(&self) -> Region {
        Region {
            start: [0; 3],
            size: self.dims,
        }
    }

    /// True where every number is finite.
    pub(super) fn is_finite(&self) -> bool {
        let numbers = self.edges.iter().flatten().chain(&self.origin);
        numbers.into_iter().all(|v| v.is_finite())
    }
}

/// Number of samples; `None` where there are none, or more than can be addressed with 8 bytes each.
pub(super) fn samples(dims: [u64; 3]) -> Option<([usize; 3], u64)> {
    let count = dims
        .iter()
        .try_fold(1_u64, |product, n| product.checked_mul(*n))?;
    let fits = count > 0 && usize::try_from(count.checked_mul(8)?).ok()? <= isize::MAX as usize;
    // No factor is larger than the product.
    fits.then(|| (dims.map(|n| n as usize), count))
}

/// A box of samples: a slab or a brick of a volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Region {
    /// First sample along i, j and k, from 0.
    pub start: [usize; 3],
    /// Samples along i, j and k.
    pub size: [usize; 3],
}

impl Region {
    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.size.iter().product()
    }

    /// Regions of at most `most` samples, but whole planes across `axis`, that cover this one in order.
    pub(super) fn slabs(self, axis: usize, most: usize) -> impl Iterator<Item = Self> {
        let plane = (self.samples() / self.size[axis].max(1)).max(1);
        let thick = (most / plane).max(1);
        let end = self.size[axis];
        (0..end).step_by(thick).map(move |first| {
            let mut slab = self;
            slab.start[axis] += first;
            slab.size[axis] = thick.min(end - first);
            slab
        })
    }

    /// False where a part of the region is outside of `dims`.
    pub(super) fn is_within(&self, dims: [usize; 3]) -> bool {
        let ends = self.start.iter().zip(self.size);
        let mut ends = ends.zip(dims);
        ends.all(|((start, size), n)| start.checked_add(size).is_some_and(|end| end <= n))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slabs_cover_a_region_once() {
        let region = Region {
            start: [1, 2, 3],
            size: [4, 5, 7],
        };
        for axis in 0..3 {
            for most in [1, 40, 60, 1000] {
                let slabs: Vec<_> = region.slabs(axis, most).collect();
                let count: usize = slabs.iter().map(Region::samples).sum();
                assert_eq!(count, region.samples());
                assert_eq!(slabs[0].start, region.start);
                let ends = slabs.windows(2).map(|w| (w[0], w[1]));
                for (a, b) in ends {
                    assert_eq!(a.start[axis] + a.size[axis], b.start[axis]);
                }
                assert_eq!(slabs.len() == 1, most == 1000, "{axis} {most}");
            }
        }
    }

    #[test]
    fn hostile_counts_are_none() {
        assert_eq!(samples([2, 3, 4]), Some(([2, 3, 4], 24)));
        for dims in [[0, 1, 1], [u64::MAX, 2, 1], [1 << 21, 1 << 21, 1 << 21]] {
            assert_eq!(samples(dims), None, "{dims:?}");
        }
    }
}
