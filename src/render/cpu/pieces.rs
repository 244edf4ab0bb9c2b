//! Work on all threads, in groups so short that whoever waits can look at the clock between them.

use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::render::job::Progress;

/// Time that a group of parts should take.
const GROUP: Duration = Duration::from_millis(30);

/// Makes so many parts, and hands over each with its number.
pub async fn in_groups<T: Send>(
    count: usize,
    progress: &Progress,
    make: impl Fn(usize) -> T + Sync,
    mut take: impl FnMut(usize, T),
) {
    let least = rayon::current_num_threads();
    let mut group = least;
    let mut done = 0;
    while done < count {
        let began = Instant::now();
        let now = done..(done + group).min(count);
        let made: Vec<T> = now.clone().into_par_iter().map(&make).collect();
        done = now.end;
        for (n, part) in now.zip(made) {
            take(n, part);
        }
        let change = GROUP.as_secs_f64() / began.elapsed().as_secs_f64().max(1e-6);
        group = ((group as f64 * change.clamp(0.25, 4.0)) as usize).max(least);
        progress.reached(done as f64 / count as f64).await;
    }
}
