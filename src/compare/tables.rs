//! The figures for people: one table over all views, one of each view, with links to the pictures.

use std::time::Duration;

use super::plots::FIGURES;
use super::row::ms;
use super::{Contender, Plan, Row, Source, Truth};
use crate::case::Case;
use crate::compare::markdown::{self, row, table};
use crate::model::Space;
use crate::scene::Interpolation;
use crate::view::View;

/// What a report tells of its pictures beside their figures.
#[derive(Clone)]
pub struct Setting<'a> {
    /// The case.
    pub case: &'a Case,
    /// What is compared.
    pub plan: &'a Plan,
    /// The adapter in words.
    pub adapter: String,
    /// CIEDE2000 difference at which the colors of difference maps end.
    pub difference_scale: f64,
}

/// The file with all images of all views.
pub(super) const SHEET: &str = "sheet.png";

/// What the rows of a contender come to.
struct Digest {
    name: String,
    is_reference: bool,
    is_floor: bool,
    worst_psnr_db: Option<f64>,
    worst_ssim: Option<f64>,
    mean_ciede2000: Option<f64>,
    worst_ciede2000_p99: Option<f64>,
    brighter: Option<f64>,
    light_ms: Option<f64>,
    median_ms: Option<f64>,
    prepare_ms: Option<f64>,
    gpu_bytes: Option<u64>,
    recovered_rays: u64,
    lost_rays: u64,
    failures: usize,
}

impl Digest {
    fn of(name: &str, rows: &[Row]) -> Self {
        let own: Vec<&Row> = rows.iter().filter(|r| r.name() == name).collect();
        let all = |value: fn(&Row) -> Option<f64>| own.iter().copied().filter_map(value);
        let mut times: Vec<f64> = all(|r| r.frame_ms).collect();
        times.sort_by(f64::total_cmp);
        let mean_of = |value| mean(&all(value).collect::<Vec<f64>>());
        Self {
            name: name.to_owned(),
            is_reference: own.iter().any(|r| r.is_reference()),
            is_floor: own.iter().any(|r| r.is_floor),
            worst_psnr_db: all(|r| r.psnr_db).min_by(f64::total_cmp),
            worst_ssim: all(|r| r.ssim).min_by(f64::total_cmp),
            mean_ciede2000: mean_of(|r| r.ciede2000_mean),
            worst_ciede2000_p99: all(|r| r.ciede2000_p99).max_by(f64::total_cmp),
            brighter: mean_of(|r| r.brighter),
            light_ms: all(|r| r.light_ms).next(),
            median_ms: times.get(times.len() / 2).copied(),
            prepare_ms: all(|r| r.prepare_ms).next(),
            gpu_bytes: own.iter().filter_map(|r| r.gpu_bytes).max(),
            recovered_rays: own.iter().filter_map(|r| r.recovered_rays).sum(),
            lost_rays: own.iter().filter_map(|r| r.lost_rays).sum(),
            failures: own.iter().filter(|r| r.error.is_some()).count(),
        }
    }

    /// One of each contender, in the order of the rows.
    fn all(rows: &[Row]) -> Vec<Self> {
        let mut names: Vec<&str> = Vec::new();
        for row in rows {
            if !names.contains(&row.name()) {
                names.push(row.name());
            }
        }
        names.into_iter().map(|n| Self::of(n, rows)).collect()
    }
}

/// Mean of some figures; `None` of none.
fn mean(values: &[f64]) -> Option<f64> {
    Some(crate::image::metrics::mean(values)).filter(|m| m.is_finite())
}

/// What rows are called that have these.
fn heading(rows: &[Row]) -> &'static str {
    match rows.iter().any(|r| r.setting.is_some()) {
        true => "setting",
        false => "strategy",
    }
}

/// Who is closest to the reference and who is fast, and a table of the contenders over all views.
pub fn summary(rows: &[Row]) -> String {
    let digests = Digest::all(rows);
    let times = digests.iter().filter_map(|d| d.median_ms);
    let slowest = times.fold(f64::NAN, f64::max);
    let is_lit = rows.iter().any(|r| r.light_ms.is_some());
    let mut head = row([
        heading(rows),
        "PSNR dB, worst",
        "SSIM, worst",
        "CIEDE2000, mean",
        "p99, worst",
        "brighter, of 255",
        "ms a frame",
        "speed",
        "ms to prepare",
    ]);
    if is_lit {
        head.push("of it light".into());
    }
    head.extend(row(["GPU MB", "recovered rays", "lost rays", "failed"]));
    let mut lines = vec![head];
    for digest in &digests {
        let speed = digest.median_ms.map(|ms| slowest / ms);
        let reference = if digest.is_reference {
            " (reference)"
        } else {
            ""
        };
        let mut line = vec![
            format!("{}{reference}", digest.name),
            decibels(digest.worst_psnr_db),
            figure(digest.worst_ssim, 5),
            figure(digest.mean_ciede2000, 4),
            figure(digest.worst_ciede2000_p99, 3),
            signed(digest.brighter),
            figure(digest.median_ms, 1),
            figure(speed, 1),
            figure(digest.prepare_ms, 1),
        ];
        if is_lit {
            line.push(figure(digest.light_ms, 1));
        }
        line.extend([
            megabytes(digest.gpu_bytes),
            digest.recovered_rays.to_string(),
            digest.lost_rays.to_string(),
            digest.failures.to_string(),
        ]);
        lines.push(line);
    }
    format!("{}\n{}", verdict(&digests), table(&lines, 1))
}

fn verdict(digests: &[Digest]) -> String {
    let mut text = String::new();
    let others = digests.iter().filter(|d| !d.is_reference && !d.is_floor);
    let measured = others.filter_map(|d| Some((d, d.mean_ciede2000?)));
    if let Some((closest, difference)) = measured.min_by(|a, b| a.1.total_cmp(&b.1)) {
        text += &format!(
            "- Closest to the reference: **{}**, CIEDE2000 {} in the mean, {} in its worst view.\n",
            closest.name,
            figure(Some(difference), 4),
            with_unit(closest.worst_psnr_db)
        );
    }
    let timed = || {
        let own = digests.iter().filter(|d| !d.is_floor);
        own.filter_map(|d| Some((d, d.median_ms?)))
    };
    let by_time = |a: &(&Digest, f64), b: &(&Digest, f64)| a.1.total_cmp(&b.1);
    if let (Some(fast), Some(slow)) = (timed().min_by(by_time), timed().max_by(by_time))
        && fast.0.name != slow.0.name
    {
        text += &format!(
            "- Fastest: **{}**, {:.1} ms a frame, {:.1} times as fast as {}.\n",
            fast.0.name,
            fast.1,
            slow.1 / fast.1,
            slow.0.name
        );
    }
    for floor in digests.iter().filter(|d| d.is_floor) {
        text += &format!(
            "- Noise floor: {} is CIEDE2000 {} from its reference by chance alone; figures below that say nothing.\n",
            floor.name,
            figure(floor.mean_ciede2000, 4)
        );
    }
    text
}

/// The whole of `compare.md`.
pub(super) fn page(setting: &Setting, rows: &[Row], reference_times: &[Duration]) -> String {
    let plan = setting.plan;
    let names: Vec<&str> = plan.contenders.iter().map(Contender::name).collect();
    let truths: Vec<&str> = plan.truths.iter().map(|t| t.name.as_str()).collect();
    let name = &setting.case.about.name;
    let plots = FIGURES.iter().map(|f| format!("![{0}]({0})\n", f.file));
    format!(
        "# {name}: {} against {}\n\n{}\n{}\n## Pictures\n![{SHEET}]({SHEET})\n\n## Over the views\n{}\n## Each view\n{}\n",
        names.join(", "),
        truths.join(", "),
        summary(rows),
        conditions(setting, rows, reference_times),
        plots.collect::<String>(),
        each_view(plan, rows),
    ) + NOTES
}

const NOTES: &str = "\
PSNR, SSIM and CIEDE2000 are of the 8-bit sRGB pictures over the background; two pictures that agree in every pixel are \"equal\". \
Times are of the rays; the first preparation compiles shaders and makes what a picture keeps beside the grid. \
Speed is relative to the slowest. GPU MB (1,000,000 bytes) is all that is on the device. Brighter is the signed mean over \
the pixels that the model covers. Light is what follows from its method alone: extinction, and volumes of light.
";

/// What the figures hold for.
fn conditions(setting: &Setting, rows: &[Row], reference_times: &[Duration]) -> String {
    let (case, plan) = (setting.case, setting.plan);
    let dims = case.grid.main_dims();
    let active = case.grid.active_cells().len();
    let (views, frames) = (plan.views.len(), plan.frames.max(1));
    let done = rows.last().map_or(0, |row| row.view + 1);
    let views = match done == views {
        true => views.to_string(),
        false => format!("{done} of {views}: the rest was canceled"),
    };
    let size = format!("{} x {} x {}", dims.ni, dims.nj, dims.nk);
    let mut lines = vec![
        row(["", ""]),
        row(["adapter", &setting.adapter]),
        row([
            "case",
            &format!("{}, {size} cells, {active} active", case.about.name),
        ]),
    ];
    if let Some(view) = plan.first_view() {
        lines.extend(conditions_of_view(case, view));
    }
    let total: Duration = reference_times.iter().sum();
    let each = ms(total) / reference_times.len().max(1) as f64;
    let by = |truth: &Truth| match truth.source {
        Source::Cpu(_) => format!("{}, the f64 reference on the CPU", truth.name),
        Source::Contender(_) | Source::Executor(_) => format!("{}, by the adapter", truth.name),
    };
    let truths: Vec<String> = plan.truths.iter().map(by).collect();
    let scale = setting.difference_scale;
    lines.extend([
        row(["views", &views]),
        row([
            "frames",
            &format!("median of {frames} after one to warm up"),
        ]),
        row([
            "reference",
            &format!("{}, {each:.0} ms a picture", truths.join("; ")),
        ]),
        row([
            "difference maps",
            &format!("CIEDE2000, black 0 to pale yellow {scale} and more"),
        ]),
    ]);
    table(&lines, 2)
}

fn conditions_of_view(case: &Case, view: &View) -> [markdown::Row; 3] {
    let step = case.steps.get(view.shown.step);
    let step = step.filter(|_| case.is_dynamic(&view.shown.property));
    let step = step.map_or_else(String::new, |s| {
        format!(", step {}, {}", view.shown.step, s.date)
    });
    let values = match view.shown.cells.interpolation {
        Interpolation::Cell => "values of cells",
        Interpolation::Vertex => "values between vertices",
    };
    [
        row(["size", &format!("{} x {}", view.size[0], view.size[1])]),
        row([
            "property",
            &format!("{}{step}, {values}", view.shown.property),
        ]),
        row([
            "sampling step",
            &match view.world.space {
                Space::Map => {
                    let length = case.length(view.notes.units);
                    format!("{:.4} {}", length.show(view.sampling.step), length.unit)
                }
                Space::Ijk => format!("{:.4} cells", view.sampling.step),
            },
        ]),
    ]
}

fn each_view(plan: &Plan, rows: &[Row]) -> String {
    let mut lines = vec![row([
        "view",
        heading(rows),
        "pictures",
        "PSNR dB",
        "SSIM",
        "CIEDE2000, mean",
        "p99",
        "brighter, of 255",
        "ms a frame",
        "GPU MB",
        "recovered rays",
        "lost rays",
    ])];
    for r in rows {
        let count = |n: Option<u64>| n.map_or_else(|| ABSENT.to_owned(), |n| n.to_string());
        lines.push(vec![
            r.view_title(),
            r.name().to_owned(),
            links(plan, r),
            decibels(r.psnr_db),
            figure(r.ssim, 5),
            figure(r.ciede2000_mean, 4),
            figure(r.ciede2000_p99, 3),
            signed(r.brighter),
            figure(r.frame_ms, 1),
            megabytes(r.gpu_bytes),
            count(r.recovered_rays),
            count(r.lost_rays),
        ]);
    }
    table(&lines, 3)
}

/// Links to the pictures of a row, or why there are none.
fn links(plan: &Plan, row: &Row) -> String {
    let reference = || plan.picture_file(row.view, &row.reference);
    let links = [
        ("picture", row.picture.clone()),
        ("reference", row.difference.as_ref().map(|_| reference())),
        ("difference", row.difference.clone()),
    ];
    let link = |(name, file): (&str, Option<String>)| Some(format!("[{name}]({})", file?));
    let mut parts: Vec<String> = links.into_iter().filter_map(link).collect();
    parts.extend(row.error.clone());
    parts.join(", ")
}

/// What stands for a figure that is absent.
const ABSENT: &str = "-";

/// A figure not below 0; only 0 itself is shown as 0.
pub(super) fn figure(value: Option<f64>, decimals: usize) -> String {
    let least = 0.1f64.powi(decimals as i32);
    match value {
        None => ABSENT.to_owned(),
        Some(v) if v > 0.0 && v < 0.5 * least => format!("<{least:.decimals$}"),
        Some(v) => format!("{v:.decimals$}"),
    }
}

/// A figure with its sign.
fn signed(value: Option<f64>) -> String {
    value.map_or_else(|| ABSENT.to_owned(), |v| format!("{v:+.1}"))
}

/// A PSNR; infinite where two pictures are equal.
pub(super) fn decibels(psnr_db: Option<f64>) -> String {
    match psnr_db {
        Some(db) if db == f64::INFINITY => "equal".into(),
        other => figure(other, 1),
    }
}

/// A PSNR with its unit.
pub(super) fn with_unit(psnr_db: Option<f64>) -> String {
    match psnr_db {
        Some(db) if db.is_finite() => format!("{} dB", decibels(psnr_db)),
        _ => decibels(psnr_db),
    }
}

fn megabytes(bytes: Option<u64>) -> String {
    figure(bytes.map(|b| b as f64 / 1e6), 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_zero_is_shown_as_zero() {
        let texts = [0.0, 1e-9, 0.004, 0.006, 1.236].map(|v| figure(Some(v), 2));
        assert_eq!(texts, ["0.00", "<0.01", "<0.01", "0.01", "1.24"]);
        assert_eq!([figure(None, 2), decibels(None)], ["-"; 2]);
        assert_eq!(decibels(Some(f64::INFINITY)), "equal");
        assert_eq!(decibels(Some(61.29)), "61.3");
    }

    /// A row with the figures that the verdict goes by.
    fn figures(strategy: &'static str, reference: &str, figures: [f64; 3]) -> Row {
        let [psnr_db, ciede2000, ms] = figures.map(Some);
        Row {
            strategy,
            reference: reference.to_owned(),
            psnr_db,
            ciede2000_mean: ciede2000,
            frame_ms: ms,
            ..Row::default()
        }
    }

    #[test]
    fn verdict_names_the_closest_and_the_fastest() {
        let rows = |reference| {
            [
                figures("a", reference, [50.0, 0.1, 10.0]),
                figures("a", reference, [40.0, 0.3, 90.0]),
                figures("a", reference, [45.0, 0.2, 20.0]),
                figures("b", reference, [f64::INFINITY, 0.0, 50.0]),
            ]
        };
        let against_cpu = summary(&rows("cpu"));
        assert!(against_cpu.contains("Closest to the reference: **b**, CIEDE2000 0.0000"));
        assert!(against_cpu.contains("equal in its worst") && !against_cpu.contains("(reference)"));
        assert!(against_cpu.contains("Fastest: **a**, 20.0 ms a frame, 2.5 times as fast as b."));
        // The reference is not the closest to itself.
        let against_b = summary(&rows("b"));
        let closest = "Closest to the reference: **a**, CIEDE2000 0.2000 in the mean, 40.0 dB";
        assert!(against_b.contains(closest), "{against_b}");
        assert!(against_b.contains("b (reference)"));
        // One alone is neither closest nor fastest.
        for alone in [&rows("b")[3..], &[]] {
            assert!(
                !["Closest", "Fastest"]
                    .iter()
                    .any(|w| summary(alone).contains(w))
            );
        }
    }
}
