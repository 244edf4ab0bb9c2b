//! Work on many pieces at once: in several threads with the feature `parallel`, else in this one.

#[cfg(feature = "parallel")]
use rayon::prelude::*;

/// What `convert` makes of each item, in the order of the items.
pub(crate) fn map<T: Send, R: Send>(
    items: Vec<T>,
    convert: impl Fn(T) -> R + Send + Sync,
) -> Vec<R> {
    // Most arrays are one short piece, for which waking a thread would take longer than the work.
    #[cfg(feature = "parallel")]
    if items.len() > 1 {
        return items.into_par_iter().map(convert).collect();
    }
    items.into_iter().map(convert).collect()
}

/// Number of items that [`map`] works on at once.
pub(crate) fn threads() -> usize {
    #[cfg(feature = "parallel")]
    let threads = rayon::current_num_threads();
    #[cfg(not(feature = "parallel"))]
    let threads = 1;
    threads
}
