//! A picture in pieces, each short enough for a slow adapter: watchdogs reset a GPU that is busy for long.

use std::time::Duration;

/// A part of a picture in pixels.
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
/// Pixels of a tile at most: each has a state of 32 bytes on the device.
pub const MAX_AREA: u64 = 1 << 20;
/// Time of a submission that does nothing: counted in, tiles of empty sky would look slow.
const OVERHEAD: Duration = Duration::from_millis(2);
/// Loop iterations of a ray in one submission, at least; fewer would mostly pay for the pause.
const LEAST_WORK: u64 = 500;

/// How fast an adapter is, learned from its submissions and kept from frame to frame. As a ray pauses
/// after a number of loop iterations, the time of a submission has a bound that is known beforehand.
#[derive(Debug)]
pub struct Pace {
    seconds_per_work: f64,
}

impl Default for Pace {
    fn default() -> Self {
        // Slower than any adapter that was met, so that the first submissions are short.
        Self {
            seconds_per_work: 1e-6,
        }
    }
}

impl Pace {
    /// Loop iterations of all rays that fit into a submission.
    fn budget(&self) -> u64 {
        (BUDGET.as_secs_f64() / self.seconds_per_work) as u64
    }

    /// Pixels of the next tile, at most.
    fn area(&self) -> u64 {
        (self.budget() / LEAST_WORK).clamp(256, MAX_AREA)
    }

    /// Loop iterations after which each ray of a tile pauses.
    pub fn work_limit(&self, area: u64, most: u32) -> u32 {
        (self.budget() / area.max(1)).clamp(LEAST_WORK, u64::from(most)) as u32
    }

    /// Learns from a submission: what it took and the loop iterations that it made.
    pub fn learn(&mut self, took: Duration, work: u64) {
        let now = took.saturating_sub(OVERHEAD).as_secs_f64() / work.max(1) as f64;
        // A submission with little to do says nothing of a full one, unless it was slow.
        if now > self.seconds_per_work || work > self.budget() / 3 {
            // Slower counts at once, faster by and by: neighboring tiles differ.
            self.seconds_per_work = now.clamp(0.6 * self.seconds_per_work, 1e-5).max(1e-12);
        }
    }
}

/// Calls `draw` for tiles that cover a picture, as large as the pace allows.
///
/// `progress` is told the fraction done and returns false to cancel; the result is false then.
///
/// # Errors
/// The first error of `draw`.
pub fn cover<E>(
    size: [u32; 2],
    pace: &mut Pace,
    mut draw: impl FnMut(Rect, &mut Pace) -> Result<(), E>,
    progress: &dyn Fn(f64) -> bool,
) -> Result<bool, E> {
    let whole = Rect {
        origin: [0, 0],
        size,
    };
    let (mut done, mut left) = (0, vec![whole]);
    while let Some(rect) = left.pop() {
        if rect.area() > pace.area() {
            let [first, second] = rect.halves();
            left.extend([second, first]);
            continue;
        }
        draw(rect, pace)?;
        done += rect.area();
        if !progress(done as f64 / whole.area() as f64) {
            return Ok(false);
        }
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_each_pixel_once() {
        for size in [[1, 1], [1000, 3], [333, 257]] {
            let mut hits = vec![0u8; (size[0] * size[1]) as usize];
            let mut n = 0u32;
            let draw = |r: Rect, pace: &mut Pace| -> Result<(), ()> {
                n += 1;
                pace.learn(Duration::from_millis(u64::from(n % 5) * 50), 100_000);
                for y in r.origin[1]..r.origin[1] + r.size[1] {
                    for x in r.origin[0]..r.origin[0] + r.size[0] {
                        hits[(x + size[0] * y) as usize] += 1;
                    }
                }
                Ok(())
            };
            assert_eq!(cover(size, &mut Pace::default(), draw, &|_| true), Ok(true));
            assert!(hits.iter().all(|&h| h == 1));
        }
    }

    #[test]
    fn submissions_stay_within_the_budget_and_cancel_works() {
        // An adapter of 50 ns a loop iteration, on which the rays of the right half never rest.
        let mut longest = Duration::ZERO;
        let slow = |r: Rect, pace: &mut Pace| -> Result<(), ()> {
            let limit = u64::from(pace.work_limit(r.area(), 6000));
            let each = if r.origin[0] < 500 { 3 } else { limit };
            let took = Duration::from_nanos(50 * each * r.area());
            pace.learn(took, each * r.area());
            longest = longest.max(took);
            Ok(())
        };
        assert_eq!(
            cover([1000, 500], &mut Pace::default(), slow, &|f| f < 0.9),
            Ok(false)
        );
        assert!(
            longest <= Duration::from_millis(100) && longest > Duration::from_millis(20),
            "{longest:?}"
        );
    }
}
