//! What a hand that turns the model in the window waits for.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use anyhow::anyhow;
use serde::Serialize;
use strataray::compare::markdown::{Row, row};
use strataray::scene::{LightingSpec, Scene};
use strataray::view::look;
use strataray::viewer::{Turned, turn};

use crate::cli::progress::Reporter;
use crate::cli::scene_options::open_case;

/// Size of the picture in a window of 1280x800 points.
const SIZE: [u32; 2] = [720, 690];
/// Drafts that find out what drafts cost.
const LEARNING: usize = 5;
const LIGHTS: [&str; 2] = ["off", "soft"];

/// Drafts while the model is turned, after the first few.
#[derive(Serialize)]
pub struct Turning {
    pub case: String,
    pub light: &'static str,
    pub strategy: String,
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

/// Turns a case by so many moves, without light and with some.
pub fn case(path: &Path, moves: usize, reporter: &Reporter) -> anyhow::Result<Vec<Turning>> {
    let case = Arc::new(open_case(path, reporter)?);
    let opening = look::opening(&case, &serde_json::Value::default())?;
    let times = |light| {
        let scene = Scene {
            size: SIZE,
            lighting: LightingSpec::preset(light).unwrap_or_default(),
            ..opening.clone()
        };
        let turned = turn(&case, &scene, LEARNING + moves).map_err(|why| anyhow!(why))?;
        Ok(summary(
            &case.about.name,
            light,
            &scene,
            &turned[LEARNING..],
        ))
    };
    LIGHTS.into_iter().map(times).collect()
}

fn summary(case: &str, light: &'static str, scene: &Scene, turned: &[Turned]) -> Turning {
    let mut sorted = turned.to_vec();
    sorted.sort_by_key(|t| t.took);
    let median = sorted.get(sorted.len() / 2);
    let ms = |of: Option<&Turned>, part: fn(&Turned) -> Duration| {
        of.map_or(0.0, |t| 1e3 * part(t).as_secs_f64())
    };
    let last = turned.last();
    Turning {
        case: case.to_owned(),
        light,
        strategy: scene.strategy.clone(),
        moves: turned.len(),
        median_ms: ms(median, |t| t.took),
        longest_ms: ms(sorted.last(), |t| t.took),
        rays_ms: ms(median, |t| t.rays),
        light_ms: ms(median, |t| t.light_volumes),
        draft: last.map_or([0, 0], |t| t.size),
        whole: scene.size,
        light_voxels: last.and_then(|t| t.light),
    }
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
