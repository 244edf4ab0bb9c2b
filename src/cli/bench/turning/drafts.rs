//! Drafts timed as the window makes them.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use anyhow::anyhow;
use strataray::scene::{LightingSpec, Scene};
use strataray::view::look;
use strataray::viewer::{Turned, turn};

use super::Turning;
use crate::cli::progress::Reporter;
use crate::cli::scene_options::open_case;

/// Size of the picture in a window of 1280x800 points.
const SIZE: [u32; 2] = [720, 690];
/// Drafts that find out what drafts cost.
const LEARNING: usize = 5;
const LIGHTS: [&str; 2] = ["off", "soft"];

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
        strategy: scene.strategy.name(),
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
