//! The figures for people: one table for loading, one for the strategies.

use strataray::compare::markdown::{Row, row, table};

use super::{Bench, turning};

/// Both tables, in Markdown that reads well as plain text.
pub fn text(bench: &Bench) -> String {
    let [width, height] = bench.size;
    let mut text = format!(
        "{}, {} threads, {width}x{height}, median of {} frames\n\n",
        bench.adapter, bench.threads, bench.frames
    );
    text += &table(&loading(bench), 2);
    text.push('\n');
    text += &table(&frames(bench), WORDS);
    if !bench.turning.is_empty() {
        text += "\nTurning in the window, from a move of the pointer to the draft from there:\n\n";
        text += &table(&turning::rows(&bench.turning), 3);
    }
    text
}

fn loading(bench: &Bench) -> Vec<Row> {
    let mut rows = vec![row([
        "case",
        "cells",
        "active",
        "open ms",
        "model ms",
        "topology ms",
        "property ms",
        "read ms",
        "upload ms",
        "acceleration ms",
        "light field ms",
        "extinction ms",
        "light volumes ms",
        "peak MB",
    ])];
    for case in &bench.cases {
        let peak = case
            .peak_memory_bytes
            .map_or("-".into(), |b| (b >> 20).to_string());
        let times = [
            case.open_ms,
            case.model_ms,
            case.topology_ms,
            case.property_ms,
            case.read_ms,
            case.upload_ms,
            case.acceleration_ms,
            case.light_field_ms,
            case.light_extinction_ms,
            case.light_volumes_ms,
        ];
        let mut cells = vec![
            case.case.clone(),
            case.dims.map(|n| n.to_string()).join("x"),
            case.active.to_string(),
        ];
        cells.extend(times.map(|ms| format!("{ms:.1}")));
        cells.push(peak);
        rows.push(cells);
    }
    rows
}

fn frames(bench: &Bench) -> Vec<Row> {
    let mut rows = vec![row([
        "case",
        "adapter",
        "strategy",
        "light",
        "prepare ms",
        "first ms",
        "frame ms",
        "wall ms",
        "CPU ms",
        "CPU range",
        "longest wait ms",
        "longest submission ms",
        "Msamples/s",
        "locations/pixel",
        "cells/pixel",
        "Newton/cell",
        "B read/pixel",
        "lost rays",
        "lost samples",
        "geometry B/cell",
        "acceleration",
        "property",
        "resampled",
        "lighting",
    ])];
    for case in &bench.cases {
        for s in &case.strategies {
            let lighting = match s.lighting.as_str() {
                "" => "-",
                name => name,
            };
            let words = [&case.case, short(&s.adapter), s.strategy, lighting];
            let mut cells: Vec<String> = words.map(str::to_owned).to_vec();
            let times = [
                s.prepare_ms,
                s.first_frame_ms,
                s.frame_ms,
                s.frame_wall_ms,
                s.frame_cpu_ms,
            ];
            cells.extend(times.map(|ms| format!("{ms:.1}")));
            let [low, high] = s.cpu_range_ms;
            cells.push(format!("{low:.0}-{high:.0}"));
            let waits = [s.longest_wait_ms, s.longest_submission_ms];
            cells.extend(waits.map(|ms| format!("{ms:.1}")));
            cells.push(format!("{:.2}", 1e-6 * s.samples_per_second));
            let ratio = |part: u64, whole: u64| format!("{:.2}", part as f64 / whole.max(1) as f64);
            cells.push(ratio(s.point_locations, s.covered_pixels));
            cells.push(ratio(s.cell_crossings, s.covered_pixels));
            cells.push(ratio(s.newton_iterations, s.cell_crossings));
            cells.push((s.bytes_read / s.covered_pixels.max(1)).to_string());
            cells.push(s.lost_rays.to_string());
            cells.push(s.lost_samples.to_string());
            let bytes = &s.gpu_bytes;
            let purposes = [
                bytes.geometry,
                bytes.acceleration,
                bytes.property,
                bytes.resampled,
                bytes.lighting,
            ];
            let per_cell = |b: u64| format!("{:.1}", b as f64 / case.active.max(1) as f64);
            cells.extend(purposes.map(per_cell));
            rows.push(cells);
        }
    }
    rows
}

/// Name of an adapter without what is in brackets.
fn short(adapter: &str) -> &str {
    adapter.split(" (").next().unwrap_or(adapter)
}

/// Leading columns of the frames that hold words, not numbers.
const WORDS: usize = 4;
