//! What a hand that turns the model in the window waits for.

#[cfg(feature = "viewer")]
mod drafts;

#[cfg(feature = "viewer")]
pub use drafts::case;
use serde::Serialize;
use strataray::compare::markdown::{Row, row};

/// Drafts while the model is turned, after the first few.
#[derive(Serialize)]
pub struct Turning {
    pub case: String,
    pub light: &'static str,
    pub strategy: &'static str,
    pub moves: usize,
    /// From a move of the pointer to the picture from there.
    pub median_ms: f64,
    pub longest_ms: f64,
    /// Of the median, what rays and light volumes took.
    pub rays_ms: f64,
    pub light_ms: f64,
    /// The last draft, and what it is a part of.
    pub draft: [u32; 2],
    pub whole: [u32; 2],
    /// Voxels of its light volume along each axis.
    pub light_voxels: Option<[u32; 3]>,
}

/// Without a window there is nothing to time.
#[cfg(not(feature = "viewer"))]
pub fn case(
    _: &std::path::Path,
    _: usize,
    _: &crate::cli::progress::Reporter,
) -> anyhow::Result<Vec<Turning>> {
    anyhow::bail!("--turn times the window, and this build of strataray has none")
}

/// The table for people.
pub fn rows(turning: &[Turning]) -> Vec<Row> {
    let mut rows = vec![row([
        "case",
        "light",
        "strategy",
        "moves",
        "median ms",
        "longest ms",
        "rays ms",
        "light ms",
        "draft",
        "of",
        "light voxels",
    ])];
    for t in turning {
        let size = |s: &[u32]| s.iter().map(u32::to_string).collect::<Vec<_>>().join("x");
        rows.push(vec![
            t.case.clone(),
            t.light.to_owned(),
            t.strategy.to_uppercase(),
            t.moves.to_string(),
            format!("{:.0}", t.median_ms),
            format!("{:.0}", t.longest_ms),
            format!("{:.0}", t.rays_ms),
            format!("{:.0}", t.light_ms),
            size(&t.draft),
            size(&t.whole),
            t.light_voxels.map_or("-".into(), |v| size(&v)),
        ]);
    }
    rows
}
