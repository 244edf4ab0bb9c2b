//! Writes a synthetic seismic cube around a case: reflections that follow its top, with the throw of its faults.
//!
//! `cargo run --release --example seismic_cube -- samples/scissor/SCISSOR.EGRID seismic.segy`

use std::f64::consts::TAU;

use glam::DVec3;
use strataray::Session;
use strataray::model::{Ijk, Spaces};
use strataray_parsers::volume::{ByteOrder, SampleType, SegyLayout, SegyWriter};

/// Samples along each side, how far the cube reaches beyond the model, as a part of that, and meters between samples.
const TRACES: [usize; 2] = [60, 60];
const BEYOND: f64 = 0.15;
const INTERVAL: f64 = 4.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(case), Some(path)) = (arguments.next(), arguments.next()) else {
        return Err("usage: seismic_cube CASE FILE.segy".into());
    };
    let session = Session::open(case)?;
    let grid = &session.case().grid;
    let spaces = Spaces::new(grid.map_axes(), 1.0);
    let dims = grid.dims();
    let columns = (0..dims.nj).flat_map(|j| (0..dims.ni).map(move |i| Ijk { i, j, k: 0 }));
    // The middle of each column's top.
    let tops: Vec<DVec3> = columns
        .map(|cell| {
            let top = grid.hexahedron(cell).0[..4].iter().sum::<DVec3>() / 4.0;
            spaces.map_from_world(spaces.world_from_grid.transform_point3(top))
        })
        .collect();
    let low = tops.iter().fold(DVec3::INFINITY, |a, b| a.min(*b));
    let high = tops.iter().fold(DVec3::NEG_INFINITY, |a, b| a.max(*b));
    let margin = BEYOND * (high - low);
    let (low, high) = (low - margin, high + margin);
    let first = (low.z - 150.0).max(0.0).round();
    let samples = ((high.z + 250.0 - first) / INTERVAL) as usize;
    let layout = SegyLayout {
        sample: SampleType::F32,
        byte_order: ByteOrder::Big,
        samples,
        interval: INTERVAL,
        delay: first as i16,
        text: "Synthetic reflections, depth in meters".into(),
    };
    let mut writer = SegyWriter::new(std::fs::File::create(path)?, layout)?;
    for line in 0..TRACES[0] {
        for crossline in 0..TRACES[1] {
            let part = |n: usize, of: usize| n as f64 / (of - 1) as f64;
            let at = DVec3::new(part(line, TRACES[0]), part(crossline, TRACES[1]), 0.0);
            let place = low + at * (high - low);
            let away = |top: &&DVec3| top.truncate().distance_squared(place.truncate());
            let nearest = tops.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
            let top = nearest.map_or(0.0, |top| top.z);
            let trace: Vec<f32> = (0..samples)
                .map(|n| reflection(first + INTERVAL * n as f64 - top) as f32)
                .collect();
            let [inline, crossline] = [line, crossline].map(|n| n as i32 + 1);
            writer.trace(inline, crossline, [place.x, place.y], &trace)?;
        }
    }
    writer.finish()?;
    Ok(())
}

/// Amplitude at a depth below the top: two beats, so that reflections are not all alike.
fn reflection(below: f64) -> f64 {
    (TAU * below / 50.0).sin() * (0.55 + 0.45 * (TAU * below / 330.0).cos())
}
