//! How large a draft may be. Pictures tell what they cost, and the size of the next draft and of its light
//! volume follow from that, on a fast machine as on a slow one.

use crate::scene::StrategyKind;

/// Milliseconds that a draft may take while something moves: 30 images per second.
pub const TURN_MS: f64 = 30.0;
/// The same where time plays: a step is looked at for longer.
pub const PLAY_MS: f64 = 250.0;
/// Width of a draft as a part of the whole image, at least: shapes can still be told apart.
pub const COARSEST: f64 = 0.12;
/// Parts of its voxels along each axis that a draft's light volume may have.
const LIGHT_PARTS: [u32; 6] = [1, 2, 3, 4, 6, 8];
/// Part of the time that does not go into fixed costs which the light may take.
const LIGHT_SHARE: f64 = 0.4;
/// Part of the goal that pixels and light get even where fixed costs leave nothing: an image that takes long
/// whatever its size is not made much faster by being coarse too.
const LEAST_ROOM: f64 = 1.0 / 3.0;
/// Milliseconds that a pixel and a voxel are taken to cost before one has been timed.
const UNKNOWN_PIXEL_MS: f64 = 1e-3;
const UNKNOWN_VOXEL_MS: f64 = 1e-3;
/// How many times more pixels a draft may have than the one before: too slow counts at once, too fast
/// step by step.
const GROWTH: f64 = 2.0;
/// Weight that what was learned keeps when another image is learned from.
const KEPT: f64 = 0.5;
/// Images whose cheapest remainder counts: what is compiled or uploaded once costs no later image anything.
const REMEMBERED: usize = 4;

/// What an image cost, in milliseconds.
#[derive(Debug, Clone, Copy)]
pub struct Spent {
    /// How its rays were cast.
    pub strategy: StrategyKind,
    /// Number of pixels, of their rays where several make one, and what these took.
    pub pixels: f64,
    /// See [`Self::pixels`].
    pub rays_ms: f64,
    /// Voxels of the light volumes made for it (0: none), and what they took.
    pub voxels: f64,
    /// See [`Self::voxels`].
    pub light_ms: f64,
    /// Everything else.
    pub rest_ms: f64,
}

/// How large a draft is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DraftSize {
    /// Width and height as a part of the whole image.
    pub part: f64,
    /// What the voxels of its light volume along each axis are divided by.
    pub light_part: u32,
}

/// What the parts of an image cost, learned from those that were made.
#[derive(Debug, Clone, Default)]
pub struct DraftBudget {
    /// Per pixel, by strategy.
    rays: [Cost; StrategyKind::ALL.len()],
    /// Per voxel.
    light: Cost,
    /// Of the last images, the newest last.
    rest: Vec<f64>,
    /// Pixels of the last draft.
    last: Option<f64>,
}

impl DraftBudget {
    /// Learns from an image; `is_draft` where it was one.
    pub fn learn(&mut self, spent: &Spent, is_draft: bool) {
        self.rays[at(spent.strategy)].learn(spent.pixels, spent.rays_ms);
        if spent.voxels > 0.0 {
            self.light.learn(spent.voxels, spent.light_ms);
        }
        if self.rest.len() == REMEMBERED {
            self.rest.remove(0);
        }
        self.rest.push(spent.rest_ms.max(0.0));
        if is_draft {
            self.last = Some(spent.pixels);
        }
    }

    /// The size of the next draft of an image of so many pixels, with a light volume of so many voxels
    /// (0: without), such that it takes `goal_ms`, or as near to that as a machine comes.
    pub fn draft(
        &self,
        strategy: StrategyKind,
        goal_ms: f64,
        pixels: f64,
        voxels: f64,
    ) -> DraftSize {
        let rays = &self.rays[at(strategy)];
        let fixed = self.rest_ms() + rays.fixed + self.light_fixed(voxels);
        let room = (goal_ms - fixed).max(LEAST_ROOM * goal_ms);
        let light_ms = |part: u32| self.voxel_ms() * voxels / f64::from(part.pow(3));
        let fits = |part: &&u32| light_ms(**part) <= LIGHT_SHARE * room;
        let light_part = LIGHT_PARTS.iter().find(fits).or(LIGHT_PARTS.last());
        let light_part = light_part.copied().unwrap_or(1);
        let room = (room - light_ms(light_part)).max(LEAST_ROOM * goal_ms);
        let affordable = room / rays.each().unwrap_or(UNKNOWN_PIXEL_MS);
        let most = self.last.map_or(pixels, |last| GROWTH * last);
        DraftSize {
            part: (affordable.min(most) / pixels).sqrt().clamp(COARSEST, 1.0),
            light_part,
        }
    }

    /// True where the whole image takes no longer than a draft may.
    pub fn affords_whole(
        &self,
        strategy: StrategyKind,
        goal_ms: f64,
        pixels: f64,
        voxels: f64,
    ) -> bool {
        let is_near = self.last.is_some_and(|last| pixels <= GROWTH * last);
        let ms = self.predicted_ms(strategy, pixels, voxels);
        is_near && ms.is_some_and(|ms| ms <= goal_ms)
    }

    /// What an image will take; `None` before one of its strategy was made.
    pub fn predicted_ms(&self, strategy: StrategyKind, pixels: f64, voxels: f64) -> Option<f64> {
        let rays = &self.rays[at(strategy)];
        let light = self.light_fixed(voxels) + self.voxel_ms() * voxels;
        Some(self.rest_ms() + rays.fixed + rays.each()? * pixels + light)
    }

    /// What the rays of an image will take; `None` before two of its strategy were made, of which the first
    /// compiles.
    pub fn rays_ms(&self, strategy: StrategyKind, pixels: f64) -> Option<f64> {
        let rays = &self.rays[at(strategy)];
        let each = rays.each().filter(|_| rays.measured > 1)?;
        Some(rays.fixed + each * pixels)
    }

    fn rest_ms(&self) -> f64 {
        let least = self.rest.iter().copied().reduce(f64::min);
        least.unwrap_or(0.0)
    }

    fn light_fixed(&self, voxels: f64) -> f64 {
        if voxels > 0.0 { self.light.fixed } else { 0.0 }
    }

    fn voxel_ms(&self) -> f64 {
        self.light.each().unwrap_or(UNKNOWN_VOXEL_MS)
    }
}

fn at(strategy: StrategyKind) -> usize {
    let all = StrategyKind::ALL.iter();
    all.take_while(|k| **k != strategy).count() % StrategyKind::ALL.len()
}

/// Part of the mean count by which counts must differ for the fixed cost to be told from the cost per item.
const SPREAD: f64 = 0.3;
/// The cost per item is at least this part of the mean cost divided by the mean count.
const LEAST_SLOPE: f64 = 0.02;

/// A cost that grows with a count: a straight line through what was measured, where the newest counts most. The
/// first measurement counts until there is a second one only: it may have compiled something.
#[derive(Debug, Clone, Copy, Default)]
struct Cost {
    /// How often it was measured.
    measured: u32,
    /// Weighted sums: of weights, counts, milliseconds, and products of these.
    weight: f64,
    count: f64,
    ms: f64,
    squares: f64,
    products: f64,
    /// What the line has at a count of zero.
    fixed: f64,
}

impl Cost {
    fn learn(&mut self, count: f64, ms: f64) {
        if !(count > 0.0 && ms.is_finite() && ms >= 0.0) {
            return;
        }
        if self.measured == 1 {
            *self = Self::default();
            self.measured = 1;
        }
        self.measured = self.measured.saturating_add(1);
        let add = |sum: &mut f64, term: f64| *sum = KEPT * *sum + term;
        add(&mut self.weight, 1.0);
        add(&mut self.count, count);
        add(&mut self.ms, ms);
        add(&mut self.squares, count * count);
        add(&mut self.products, count * ms);
        let [count, ms] = self.means();
        let variance = self.squares / self.weight - count * count;
        if variance > (SPREAD * count).powi(2) {
            let slope = (self.products / self.weight - count * ms) / variance;
            self.fixed = ms - slope.max(LEAST_SLOPE * ms / count) * count;
        }
        self.fixed = self.fixed.clamp(0.0, (1.0 - LEAST_SLOPE) * ms);
    }

    fn means(&self) -> [f64; 2] {
        [self.count, self.ms].map(|sum| sum / self.weight)
    }

    /// Per item; `None` before anything was measured.
    fn each(&self) -> Option<f64> {
        (self.weight > 0.0).then(|| {
            let [count, ms] = self.means();
            ((ms - self.fixed) / count).max(1e-9)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PIXELS: f64 = 1000.0 * 700.0;
    const VOXELS: f64 = 500_000.0;
    const LIBC: StrategyKind = StrategyKind::Libc;

    /// A machine without a clock: what its images cost is known.
    #[derive(Clone, Copy)]
    struct Machine {
        rest: f64,
        fixed: f64,
        pixel: f64,
        light_fixed: f64,
        voxel: f64,
    }

    impl Machine {
        fn spent(&self, draft: DraftSize, has_light: bool, noise: f64) -> Spent {
            let pixels = PIXELS * draft.part * draft.part;
            let voxels = VOXELS / f64::from(draft.light_part.pow(3));
            let light = noise * (self.light_fixed + self.voxel * voxels);
            Spent {
                strategy: LIBC,
                pixels,
                rays_ms: noise * (self.fixed + self.pixel * pixels),
                voxels: if has_light { voxels } else { 0.0 },
                light_ms: if has_light { light } else { 0.0 },
                rest_ms: noise * self.rest,
            }
        }

        fn least_ms(&self) -> f64 {
            let pixels = PIXELS * COARSEST * COARSEST;
            self.rest
                + self.fixed
                + self.pixel * pixels
                + self.light_fixed
                + self.voxel * VOXELS / 512.0
        }
    }

    fn ms(spent: &Spent) -> f64 {
        spent.rays_ms + spent.light_ms + spent.rest_ms
    }

    /// Draws so many drafts, one after another; size and cost of each.
    fn turned(
        budget: &mut DraftBudget,
        machine: Machine,
        count: usize,
        noise: impl Fn(usize) -> f64,
    ) -> Vec<(DraftSize, f64)> {
        let draw = |n| {
            let draft = budget.draft(LIBC, TURN_MS, PIXELS, VOXELS);
            let spent = machine.spent(draft, true, noise(n));
            budget.learn(&spent, true);
            (draft, ms(&spent))
        };
        (0..count).map(draw).collect()
    }

    const FAST: Machine = Machine {
        rest: 1.0,
        fixed: 0.5,
        pixel: 2e-6,
        light_fixed: 0.5,
        voxel: 2e-6,
    };
    const SLOW: Machine = Machine {
        rest: 3.0,
        fixed: 6.0,
        pixel: 2e-3,
        light_fixed: 2.0,
        voxel: 2e-4,
    };

    #[test]
    fn a_slow_machine_turns_within_the_goal_after_two_drafts() {
        let mut budget = DraftBudget::default();
        let drafts = turned(&mut budget, SLOW, 30, |_| 1.0);
        assert!(drafts[0].1 > 1.5 * TURN_MS, "nothing is known at first");
        for (draft, ms) in &drafts[3..] {
            assert!(*ms < 1.4 * TURN_MS.max(SLOW.least_ms()), "{draft:?} {ms}");
            assert!(draft.light_part > 1 && draft.part >= COARSEST);
        }
    }

    #[test]
    fn a_fast_machine_draws_in_full() {
        let mut budget = DraftBudget::default();
        let drafts = turned(&mut budget, FAST, 12, |_| 1.0);
        let last = drafts[11].0;
        assert_eq!((last.part, last.light_part), (1.0, 1));
        assert!(budget.affords_whole(LIBC, TURN_MS, PIXELS, VOXELS));
        // Ten times the pixels were never tried.
        assert!(!budget.affords_whole(LIBC, TURN_MS, 10.0 * PIXELS, VOXELS));
    }

    #[test]
    fn the_light_gives_way_before_the_image_is_too_coarse() {
        // Without light this machine draws a third of the pixels.
        let machine = Machine {
            pixel: 6e-5,
            voxel: 1e-3,
            ..FAST
        };
        let mut budget = DraftBudget::default();
        let drafts = turned(&mut budget, machine, 20, |_| 1.0);
        let (draft, ms) = drafts[19];
        assert!(draft.light_part >= 4 && draft.part > 0.4, "{draft:?}");
        assert!(ms < 1.2 * TURN_MS, "{ms}");
    }

    #[test]
    fn what_costs_the_same_at_any_size_does_not_make_drafts_coarse_for_nothing() {
        // 100 ms whatever the size, and pixels that cost next to nothing.
        let machine = Machine {
            rest: 100.0,
            pixel: 1e-4,
            ..FAST
        };
        let mut budget = DraftBudget::default();
        let drafts = turned(&mut budget, machine, 20, |_| 1.0);
        let (draft, ms) = drafts[19];
        assert!(draft.part > 2.0 * COARSEST, "{draft:?}");
        assert!(ms < 100.0 + TURN_MS, "{ms}");
    }

    #[test]
    fn a_machine_that_others_use_too_is_followed_within_six_drafts() {
        let mut budget = DraftBudget::default();
        let free = Machine {
            pixel: 4e-4,
            voxel: 1e-5,
            ..SLOW
        };
        let before = turned(&mut budget, free, 20, |_| 1.0);
        let busy = turned(&mut budget, free, 12, |_| 2.5);
        let late = busy[6..].iter().map(|d| d.1).fold(0.0, f64::max);
        let least = 2.5 * free.least_ms();
        assert!(late < 1.5 * TURN_MS.max(least), "{late} {least}");
        let after = turned(&mut budget, free, 20, |_| 1.0);
        assert!(after[19].0.part > 0.8 * before[19].0.part, "{after:?}");
    }

    #[test]
    fn noise_neither_drives_the_size_away_nor_makes_it_swing() {
        let mut budget = DraftBudget::default();
        // Up to 40 % more or less, the same each time.
        let noise = |n: usize| 1.0 + 0.4 * ((7 * n % 11) as f64 / 5.0 - 1.0);
        let machine = Machine {
            pixel: 3e-4,
            voxel: 1e-5,
            ..SLOW
        };
        let drafts = turned(&mut budget, machine, 100, noise);
        let (low, high) = drafts[10..].iter().fold((1.0, 0.0), |(low, high), d| {
            (d.0.part.min(low), d.0.part.max(high))
        });
        assert!(high < 2.0 * low && low > COARSEST, "{low} {high}");
        let late = drafts[10..].iter().filter(|d| d.1 > 2.0 * TURN_MS).count();
        assert!(late < 5, "{late}");
    }

    #[test]
    fn the_first_draft_that_compiles_is_forgotten() {
        let mut budget = DraftBudget::default();
        let draft = budget.draft(LIBC, TURN_MS, PIXELS, 0.0);
        let mut first = FAST.spent(draft, false, 1.0);
        (first.rest_ms, first.rays_ms) = (2000.0, 900.0);
        budget.learn(&first, true);
        for _ in 0..12 {
            let draft = budget.draft(LIBC, TURN_MS, PIXELS, 0.0);
            budget.learn(&FAST.spent(draft, false, 1.0), true);
        }
        assert_eq!(budget.draft(LIBC, TURN_MS, PIXELS, 0.0).part, 1.0);
        // Another strategy is not judged by this one.
        assert_eq!(budget.rays_ms(StrategyKind::Plts, PIXELS), None);
    }

    #[test]
    fn a_fixed_cost_is_told_from_the_cost_of_a_pixel() {
        let mut cost = Cost::default();
        for count in [1e4, 4e4, 2e4, 1e5, 3e4] {
            cost.learn(count, 12.0 + 1e-3 * count);
        }
        assert!((cost.fixed - 12.0).abs() < 0.5, "{cost:?}");
        assert!((cost.each().unwrap_or(0.0) - 1e-3).abs() < 1e-4, "{cost:?}");
        // Nothing that is no measurement counts.
        let before = cost.fixed;
        for wrong in [[0.0, 5.0], [1e4, f64::NAN], [1e4, -1.0]] {
            cost.learn(wrong[0], wrong[1]);
        }
        assert_eq!(cost.fixed, before);
    }
}
