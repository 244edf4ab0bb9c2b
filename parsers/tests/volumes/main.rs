//! Volumes: what writers write is read back, by this crate and by others, and what others write is read.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic, reason = "tests")]

mod detached;
mod images;
mod others;
mod segy;
mod vtk;

use strataray_parsers::ParseError;
use strataray_parsers::volume::{
    self, ByteOrder, Contents, Lattice, Options, Region, SampleType, VolumeFile,
};

/// A whole number below 101 for each sample, so that all types have it.
fn value([i, j, k]: [usize; 3]) -> f64 {
    ((i * 7 + j * 13 + k * 29 + i * j) % 101) as f64
}

/// Values of a region, i fastest.
fn values(region: Region) -> Vec<f64> {
    let [ni, nj, nk] = region.size;
    let [i, j, k] = region.start;
    let all = (0..ni * nj * nk).map(|n| value([i + n % ni, j + n / ni % nj, k + n / ni / nj]));
    all.collect()
}

const DIMS: [usize; 3] = [7, 5, 4];

/// Rotated about the third axis, with its own spacing along each.
fn rotated() -> Lattice {
    let (sine, cosine) = (0.6, 0.8);
    Lattice {
        dims: DIMS,
        origin: [431_000.25, 6_470_000.5, -12.0],
        edges: [
            [12.5 * cosine, 12.5 * sine, 0.0],
            [-25.0 * sine, 25.0 * cosine, 0.0],
            [0.0, 0.0, 4.0],
        ],
    }
}

fn contents(sample: SampleType, byte_order: ByteOrder) -> Contents {
    Contents {
        lattice: rotated(),
        sample,
        byte_order,
        name: "amplitude".into(),
    }
}

fn open(name: &str, bytes: Vec<u8>) -> Result<VolumeFile, ParseError> {
    volume::from_bytes((name, bytes), &Options::default())
}

/// Largest difference of numbers of two lattices; infinite where they are of other sizes.
fn apart(a: &Lattice, b: &Lattice) -> f64 {
    if a.dims != b.dims {
        return f64::INFINITY;
    }
    let numbers = |l: &Lattice| [l.edges.as_flattened(), &l.origin].concat();
    let pairs = numbers(a).into_iter().zip(numbers(b));
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Checks all values, as a whole, in slabs and in a brick.
#[track_caller]
fn check_values(volume: &VolumeFile) {
    let whole = volume.lattice.region();
    assert_eq!(volume.f64s(whole).unwrap(), values(whole));
    let narrow: Vec<f32> = values(whole).iter().map(|v| *v as f32).collect();
    assert_eq!(volume.f32s(whole).unwrap(), narrow);
    for most in [1, 50, 80] {
        for slab in volume.slabs(most) {
            assert_eq!(volume.f64s(slab).unwrap(), values(slab), "{slab:?}");
        }
    }
    let brick = Region {
        start: [2, 1, 1],
        size: [3, 2, 2],
    };
    assert_eq!(volume.f64s(brick).unwrap(), values(brick));
    let full_rows = Region {
        start: [0, 1, 1],
        size: [volume.lattice.dims[0], 2, 2],
    };
    assert_eq!(volume.f64s(full_rows).unwrap(), values(full_rows));
    let beyond = Region {
        size: [6, 2, 2],
        ..brick
    };
    assert!(volume.f64s(beyond).is_err());
    // The twin: another place has other values.
    let moved = Region {
        start: [1, 1, 1],
        ..brick
    };
    assert_ne!(volume.f64s(brick).unwrap(), values(moved));
}
