//! From the numbers and places of traces to a lattice: which trace is where, and the affine map of numbers to places.

/// Stands for no trace.
pub(super) const NONE: u32 = u32::MAX;
/// A lattice has at most so many places for each trace, and some more for small files.
const MOST_PLACES: u64 = 16;
const FEW: u64 = 64;

/// Numbers along one axis: from `first` on, `step` apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Numbers {
    pub(super) first: i32,
    pub(super) step: u32,
    pub(super) count: u64,
}

impl Numbers {
    /// The widest steps that meet all numbers.
    pub(super) fn of(numbers: impl Iterator<Item = i32> + Clone) -> Self {
        let first = numbers.clone().min().unwrap_or(0);
        let above = |n: i32| n.abs_diff(first);
        let step = numbers.clone().fold(0, |step, n| divisor(step, above(n)));
        let step = step.max(1);
        let last = numbers.map(above).max().unwrap_or(0);
        Self {
            first,
            step,
            count: u64::from(last / step) + 1,
        }
    }

    /// Place of a number along the axis.
    pub(super) fn place(self, number: i32) -> usize {
        (number.abs_diff(self.first) / self.step) as usize
    }
}

/// Greatest common divisor; zero divides nothing.
fn divisor(mut a: u32, mut b: u32) -> u32 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// Which trace stands at each place of the lattice, i fastest.
#[derive(Debug)]
pub(super) struct Grid {
    pub(super) axes: [Numbers; 2],
    pub(super) traces: Vec<u32>,
    /// Traces at places that had one.
    pub(super) repeated: u64,
    /// Places without a trace.
    pub(super) absent: u64,
}

impl Grid {
    /// The lattice of traces with these numbers; `None` stands for a trace that is left out. An error is the number of
    /// places of a lattice that is far larger than the number of traces.
    pub(super) fn new(numbers: &[Option<[i32; 2]>]) -> Result<Self, u64> {
        let present = || numbers.iter().flatten();
        let axes = [0, 1].map(|axis| Numbers::of(present().map(|n| n[axis])));
        let places = axes[0].count.saturating_mul(axes[1].count);
        let most = (present().count() as u64).saturating_mul(MOST_PLACES) + FEW;
        if places > most {
            return Err(places);
        }
        let mut grid = Self {
            axes,
            traces: vec![NONE; places as usize],
            repeated: 0,
            absent: places,
        };
        for (n, trace) in numbers.iter().enumerate() {
            let Some([inline, crossline]) = trace else {
                continue;
            };
            let (i, j) = (axes[0].place(*inline), axes[1].place(*crossline));
            let place = &mut grid.traces[j * axes[0].count as usize + i];
            if *place == NONE {
                *place = n as u32;
                grid.absent -= 1;
            } else {
                grid.repeated += 1;
            }
        }
        Ok(grid)
    }
}

/// `place = origin + u * edges[0] + v * edges[1]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Map {
    pub(super) origin: [f64; 2],
    pub(super) edges: [[f64; 2]; 2],
    /// Root of the mean squared distance, and the largest one.
    pub(super) residual: [f64; 2],
    /// Axes along which places change.
    pub(super) is_known: [bool; 2],
}

/// The affine map of `(u, v)` to `(x, y)` with the least squared distances; `None` where all places are the same, or
/// where numbers stand on a line that is not along an axis.
pub(super) fn fit(points: impl Iterator<Item = ([f64; 2], [f64; 2])> + Clone) -> Option<Map> {
    let mut count = 0.0;
    let mut mean = [0.0; 4];
    for (number, place) in points.clone() {
        count += 1.0;
        let all = [number[0], number[1], place[0], place[1]];
        // A running mean keeps its digits however many traces there are.
        mean.iter_mut()
            .zip(all)
            .for_each(|(m, v)| *m += (v - *m) / count);
    }
    let [mut uu, mut uv, mut vv] = [0.0; 3];
    let (mut u_place, mut v_place) = ([0.0; 2], [0.0; 2]);
    for (number, place) in points.clone() {
        let (u, v) = (number[0] - mean[0], number[1] - mean[1]);
        (uu, uv, vv) = (uu + u * u, uv + u * v, vv + v * v);
        for axis in 0..2 {
            let d = place[axis] - mean[2 + axis];
            u_place[axis] += u * d;
            v_place[axis] += v * d;
        }
    }
    let determinant = uu * vv - uv * uv;
    let edges = match (uu > 0.0, vv > 0.0) {
        (true, true) if determinant > 1e-9 * uu * vv => [
            [0, 1].map(|n| (vv * u_place[n] - uv * v_place[n]) / determinant),
            [0, 1].map(|n| (uu * v_place[n] - uv * u_place[n]) / determinant),
        ],
        (true, false) => [u_place.map(|v| v / uu), [0.0; 2]],
        (false, true) => [[0.0; 2], v_place.map(|v| v / vv)],
        _ => return None,
    };
    let origin = [0, 1].map(|n| mean[2 + n] - mean[0] * edges[0][n] - mean[1] * edges[1][n]);
    let (mut sum, mut largest) = (0.0, 0.0_f64);
    for ([u, v], place) in points {
        let off = [0, 1].map(|n| place[n] - origin[n] - u * edges[0][n] - v * edges[1][n]);
        let squared = off[0] * off[0] + off[1] * off[1];
        sum += squared;
        largest = largest.max(squared);
    }
    let is_known = edges.map(|edge| edge[0] != 0.0 || edge[1] != 0.0);
    is_known.contains(&true).then_some(Map {
        origin,
        edges,
        residual: [(sum / count).sqrt(), largest.sqrt()],
        is_known,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_numbers() {
        let numbers = |all: &[i32]| Numbers::of(all.iter().copied());
        let found = numbers(&[110, 100, 104, 100]);
        assert_eq!((found.first, found.step, found.count), (100, 2, 6));
        assert_eq!((found.place(100), found.place(110)), (0, 5));
        assert_eq!(numbers(&[7, 7]).count, 1);
        assert_eq!(numbers(&[1, 2, 4]).step, 1);
        let widest = numbers(&[i32::MIN, i32::MAX]);
        assert_eq!((widest.step, widest.count), (u32::MAX, 2));
    }

    #[test]
    fn lattices_have_holes_and_bounds() {
        let numbers = [Some([2, 1]), Some([1, 1]), None, Some([1, 2]), Some([1, 1])];
        let grid = Grid::new(&numbers).unwrap();
        assert_eq!(grid.traces, [1, 0, 3, NONE]);
        assert_eq!((grid.absent, grid.repeated), (1, 1));
        let wild = [Some([0, 0]), Some([1, 1]), Some([i32::MAX, i32::MAX])];
        assert_eq!(Grid::new(&wild).unwrap_err(), 1 << 62);
    }

    /// A sheared map in the millions is found to a micrometer, and one wrong place shows.
    #[test]
    fn affine_maps_by_least_squares() {
        let place = |u: f64, v: f64| {
            [
                431_000.0 + 20.0 * u + 7.5 * v,
                6_470_000.0 - 9.0 * u + 21.0 * v,
            ]
        };
        let points: Vec<_> = (0..600)
            .filter(|n| n % 7 != 0)
            .map(|n| [f64::from(n % 30), f64::from(n / 30)])
            .map(|[u, v]| ([u, v], place(u, v)))
            .collect();
        let map = fit(points.iter().copied()).unwrap();
        let close = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-6;
        assert!(close(map.origin, place(0.0, 0.0)), "{map:?}");
        assert!(close(map.edges[0], [20.0, -9.0]) && close(map.edges[1], [7.5, 21.0]));
        assert!(map.residual[1] < 1e-6);
        let mut wrong = points.clone();
        wrong[0].1[0] += 100.0;
        let map = fit(wrong.iter().copied()).unwrap();
        assert!(map.residual[1] > 90.0 && map.residual[0] > 3.0, "{map:?}");
        // Along one axis, along none, and along a diagonal.
        let line = points.iter().copied().filter(|(n, _)| n[0] == 1.0);
        let map = fit(line).unwrap();
        assert_eq!(map.is_known, [false, true]);
        assert!(fit(points.iter().map(|(n, _)| (*n, [1.0, 1.0]))).is_none());
        assert!(fit(points.iter().copied().filter(|(n, _)| n[0] == n[1])).is_none());
    }
}
