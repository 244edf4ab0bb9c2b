//! An image in pieces, each short enough for a slow adapter: watchdogs reset a GPU that is busy for long.

use std::time::Duration;

/// A part of an image in pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rect {
    /// Left and top.
    pub origin: [u32; 2],
    /// Width and height.
    pub size: [u32; 2],
}

impl Rect {
    /// Number of pixels.
    pub fn area(self) -> u64 {
        u64::from(self.size[0]) * u64::from(self.size[1])
    }

    fn halves(self) -> [Self; 2] {
        let axis = usize::from(self.size[1] > self.size[0]);
        let (mut a, mut b) = (self, self);
        a.size[axis] = self.size[axis] / 2;
        b.size[axis] -= a.size[axis];
        b.origin[axis] += a.size[axis];
        [a, b]
    }
}

/// Time that one submission should take at most.
pub const BUDGET: Duration = Duration::from_millis(70);
/// Pixels of a tile at most: each has a state on the device, of 64 bytes in LIBC.
pub const MAX_AREA: u64 = 1 << 20;
/// Loop iterations of the first submission: few enough for the slowest adapter that was met.
const FIRST_UNITS: f64 = 70_000.0;
/// How much an adapter does in the time of a submission, learned from them and kept from frame to
/// frame. As a ray pauses after a number of loop iterations, that time has a bound beforehand.
#[derive(Debug)]
pub struct Pace {
    /// Loop iterations of all rays that fit into a submission.
    units: f64,
}

impl Default for Pace {
    fn default() -> Self {
        Self { units: FIRST_UNITS }
    }
}

impl Pace {
    /// How much shorter or longer than the last submission the next one may be: too long counts at once,
    /// too short by and by, for neighboring tiles differ.
    pub const CHANGE: [f64; 2] = [0.25, 1.7];

    /// How many pieces of so many loop iterations fit into a submission.
    pub fn pieces(&self, each: u64) -> u64 {
        self.units as u64 / each.max(1)
    }

    /// Pixels of the next tile, at most, where a ray makes `least` loop iterations in a submission.
    pub fn area(&self, least: u64) -> u64 {
        self.pieces(least).clamp(256, MAX_AREA)
    }

    /// Loop iterations after which each ray of a tile pauses.
    pub fn work_limit(&self, area: u64, least: u64, most: u32) -> u32 {
        let most = u64::from(most);
        self.pieces(area).clamp(least.min(most), most) as u32
    }

    /// Learns from a submission: what it took and the loop iterations that it made.
    pub fn learn(&mut self, took: Duration, work: u64) {
        let change = BUDGET.as_secs_f64() / took.as_secs_f64().max(1e-6);
        // A submission with little to do says nothing of a full one, unless it was slow; one with nothing
        // to do for the rays says nothing at all.
        if work > 0 && (change < 1.0 || work as f64 > self.units / 3.0) {
            self.units =
                (self.units * change.clamp(Self::CHANGE[0], Self::CHANGE[1])).clamp(1e4, 1e12);
        }
    }
}

/// Parts of at most so many pixels that cover a rectangle.
pub fn parts(whole: Rect, most: u64) -> Vec<Rect> {
    match whole.area() > most.max(1) {
        true => whole
            .halves()
            .into_iter()
            .flat_map(|half| parts(half, most))
            .collect(),
        false => vec![whole],
    }
}

/// Tiles that cover a rectangle.
pub struct Tiles {
    left: Vec<Rect>,
}

impl Tiles {
    /// All of a rectangle is left.
    pub fn of(whole: Rect) -> Self {
        Self { left: vec![whole] }
    }

    /// The next tile, of at most so many pixels; `None` where all have been taken.
    pub fn next(&mut self, most: u64) -> Option<Rect> {
        let mut rect = self.left.pop()?;
        while rect.area() > most.max(1) {
            let [first, second] = rect.halves();
            self.left.push(second);
            rect = first;
        }
        Some(rect)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at_origin(size: [u32; 2]) -> Rect {
        Rect {
            origin: [0, 0],
            size,
        }
    }

    #[test]
    fn ok_parts_are_small_and_cover_each_pixel_once() {
        let whole = Rect {
            origin: [7, 3],
            size: [333, 257],
        };
        let parts = parts(whole, 1000);
        assert!(parts.len() > 80 && parts.iter().all(|p| p.area() <= 1000));
        assert_eq!(parts.iter().map(|p| p.area()).sum::<u64>(), whole.area());
        let inside = |p: &Rect, axis: usize| {
            let [low, high] = [whole.origin[axis], whole.origin[axis] + whole.size[axis]];
            p.origin[axis] >= low && p.origin[axis] + p.size[axis] <= high
        };
        assert!(parts.iter().all(|p| inside(p, 0) && inside(p, 1)));
    }

    #[test]
    fn tiles_cover_each_pixel_once() {
        for size in [[1, 1], [1000, 3], [333, 257]] {
            let mut hits = vec![0u8; (size[0] * size[1]) as usize];
            let mut n = 0u32;
            let (mut pace, mut tiles) = (Pace::default(), Tiles::of(at_origin(size)));
            while let Some(r) = tiles.next(pace.area(500)) {
                n += 1;
                pace.learn(Duration::from_millis(u64::from(n % 5) * 50), 100_000);
                for y in r.origin[1]..r.origin[1] + r.size[1] {
                    for x in r.origin[0]..r.origin[0] + r.size[0] {
                        hits[(x + size[0] * y) as usize] += 1;
                    }
                }
            }
            assert!(hits.iter().all(|&h| h == 1));
        }
    }

    #[test]
    fn a_fast_adapter_gets_tiles_of_all_rays_within_a_few_submissions() {
        // A billion loop iterations in a millisecond, whatever is asked of it.
        let mut pace = Pace::default();
        let mut submissions = 0;
        while pace.area(32) < MAX_AREA {
            let work = pace.pieces(1);
            pace.learn(Duration::from_nanos(work / 1000), work);
            submissions += 1;
        }
        assert_eq!(pace.area(32), 1 << 20);
        assert!(submissions < 20, "{submissions}");
    }

    #[test]
    fn submissions_stay_within_the_budget() {
        // An adapter of 50 ns a loop iteration, on which the rays of the right half never rest.
        let mut longest = Duration::ZERO;
        let (mut pace, mut tiles) = (Pace::default(), Tiles::of(at_origin([1000, 500])));
        while let Some(r) = tiles.next(pace.area(500)) {
            let limit = u64::from(pace.work_limit(r.area(), 500, 6000));
            let each = if r.origin[0] < 500 { 3 } else { limit };
            let took = Duration::from_nanos(50 * each * r.area());
            pace.learn(took, each * r.area());
            longest = longest.max(took);
        }
        assert!(
            longest <= Duration::from_millis(100) && longest > Duration::from_millis(20),
            "{longest:?}"
        );
    }
}
