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
pub const BUDGET: Duration = Duration::from_millis(80);
/// Pixels of a tile at most: each has a state of 32 bytes on the device.
pub const MAX_AREA: u64 = 1 << 20;
/// First tile on an adapter of unknown speed, in pixels.
const FIRST_AREA: u64 = 16 * 16;

/// Tile sizes that follow the adapter's speed; kept from frame to frame.
#[derive(Debug)]
pub struct Tiles {
    area: u64,
}

impl Default for Tiles {
    fn default() -> Self {
        Self { area: FIRST_AREA }
    }
}

impl Tiles {
    /// Calls `draw` for tiles that cover a picture; `draw` gives the time that it took.
    ///
    /// `progress` is told the fraction done and returns false to cancel; the result is false then.
    ///
    /// # Errors
    /// The first error of `draw`.
    pub fn cover<E>(
        &mut self,
        size: [u32; 2],
        mut draw: impl FnMut(Rect) -> Result<Duration, E>,
        progress: &dyn Fn(f64) -> bool,
    ) -> Result<bool, E> {
        let whole = Rect {
            origin: [0, 0],
            size,
        };
        let (mut done, mut left) = (0, vec![whole]);
        while let Some(rect) = left.pop() {
            if rect.area() > self.area.max(1) {
                let [first, second] = rect.halves();
                left.extend([second, first]);
                continue;
            }
            let took = draw(rect)?;
            self.adapt(rect.area(), took);
            done += rect.area();
            if !progress(done as f64 / whole.area() as f64) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn adapt(&mut self, area: u64, took: Duration) {
        let ratio = BUDGET.as_secs_f64() / took.as_secs_f64().max(1e-6);
        if ratio < 1.0 {
            // Too slow: shrink at once.
            self.area = ((area as f64 * ratio * 0.8) as u64).max(1);
        } else if area * 2 > self.area {
            // A tile of the full allowance that was fast enough: grow, but not beyond what is sure.
            let grown = (area as f64 * (ratio * 0.5).clamp(1.0, 4.0)) as u64;
            self.area = self.area.max(grown).min(MAX_AREA);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_each_pixel_once() {
        for size in [[1, 1], [1000, 3], [333, 257]] {
            let mut hits = vec![0u8; (size[0] * size[1]) as usize];
            let mut n = 0u32;
            let draw = |r: Rect| -> Result<Duration, ()> {
                n += 1;
                for y in r.origin[1]..r.origin[1] + r.size[1] {
                    for x in r.origin[0]..r.origin[0] + r.size[0] {
                        hits[(x + size[0] * y) as usize] += 1;
                    }
                }
                Ok(Duration::from_millis(u64::from(n % 5) * 50))
            };
            assert_eq!(Tiles::default().cover(size, draw, &|_| true), Ok(true));
            assert!(hits.iter().all(|&h| h == 1));
        }
    }

    #[test]
    fn tiles_shrink_when_slow_and_stop_when_cancelled() {
        let mut tiles = Tiles::default();
        let mut areas = Vec::new();
        let slow = |r: Rect| -> Result<Duration, ()> {
            areas.push(r.area());
            Ok(Duration::from_millis(r.area() * 10))
        };
        assert_eq!(tiles.cover([64, 64], slow, &|f| f < 0.5), Ok(false));
        assert!(areas[1..].iter().all(|&a| a <= 8), "{areas:?}");
    }
}
