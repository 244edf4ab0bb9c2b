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
    text += &table(&loading(bench), WORDS);
    text.push('\n');
    text += &table(&frames(bench), WORDS);
    if !bench.turning.is_empty() {
        text += "\nTurning in the window, from a move of the pointer to the draft from there:\n\n";
        text += &table(&turning::rows(&bench.turning), 1 + WORDS);
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
        "strategy",
        "prepare ms",
        "first ms",
        "frame ms",
        "wall ms",
        "CPU ms",
        "longest wait ms",
        "longest submission ms",
        "Msamples/s",
        "Newton/sample",
        "cells/entry",
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
            let mut cells = vec![case.case.clone(), s.strategy.to_owned()];
            let times = [
                s.prepare_ms,
                s.first_frame_ms,
                s.frame_ms,
                s.frame_wall_ms,
                s.frame_cpu_ms,
                s.longest_wait_ms,
                s.longest_submission_ms,
            ];
            cells.extend(times.map(|ms| format!("{ms:.1}")));
            cells.push(format!("{:.2}", 1e-6 * s.samples_per_second));
            cells.push(format!("{:.2}", s.newton_iterations_per_sample));
            let per_entry = s.cell_crossings as f64 / s.entries.max(1) as f64;
            cells.push(format!("{per_entry:.1}"));
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

/// Leading columns that hold words, not numbers.
const WORDS: usize = 2;
