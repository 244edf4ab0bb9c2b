//! The figures of a run beside those of an earlier one.

use std::path::Path;

use anyhow::Context;
use serde_json::Value;
use strataray::compare::markdown::{Row, row, table};
use strataray::scene::read_text;

/// Figures that are compared of a case, and of each of its frames.
const OF_CASE: [&str; 3] = ["open_ms", "model_ms", "acceleration_ms"];
const OF_FRAMES: [&str; 4] = ["first_frame_ms", "frame_wall_ms", "frame_cpu_ms", "samples"];

/// The figures of an earlier run.
///
/// # Errors
/// When the file cannot be read, or holds something else.
pub fn read(path: &Path) -> anyhow::Result<Value> {
    let text = read_text(path);
    let text = text.with_context(|| format!("cannot read {}", path.display()))?;
    let figures: Value =
        serde_json::from_str(&text).with_context(|| format!("{}", path.display()))?;
    let is_bench = figures["cases"].is_array();
    anyhow::ensure!(
        is_bench,
        "{}: these are not the figures of `strataray bench --json`",
        path.display()
    );
    Ok(figures)
}

/// A table of ratios, new to old, of all that both runs have.
///
/// # Errors
/// When they have nothing in common.
pub fn text(before: &Value, now: &Value) -> anyhow::Result<String> {
    let mut head = row(["case", "adapter", "strategy", "light"]);
    head.extend(
        OF_CASE
            .iter()
            .chain(&OF_FRAMES)
            .map(|name| name.replace("_ms", " ratio")),
    );
    let mut rows = vec![head];
    for (old_case, case) in pairs(before, now, "cases", &["case"]) {
        let of_case = ratios(old_case, case, &OF_CASE);
        let words = ["adapter", "strategy", "lighting"];
        for (old, new) in pairs(old_case, case, "strategies", &words) {
            let word = |of: &Value, name: &str| of[name].as_str().unwrap_or("-").to_owned();
            let mut cells = vec![word(case, "case")];
            cells.extend(words.map(|name| word(new, name)));
            cells.extend(of_case.clone());
            cells.extend(ratios(old, new, &OF_FRAMES));
            rows.push(cells);
        }
    }
    anyhow::ensure!(
        rows.len() > 1,
        "the two runs have no case, adapter and strategy in common"
    );
    let size = |of: &Value| of["size"].to_string();
    let note = match size(before) == size(now) {
        true => String::new(),
        false => format!(
            "The sizes differ: {} before, {} now.\n",
            size(before),
            size(now)
        ),
    };
    Ok(format!(
        "\nNew figures as multiples of the old ones:\n{note}\n{}",
        table(&rows, 4)
    ))
}

/// The entries of a list in both runs that agree in these words.
fn pairs<'a>(
    before: &'a Value,
    now: &'a Value,
    list: &str,
    words: &[&str],
) -> Vec<(&'a Value, &'a Value)> {
    let entries = |of: &'a Value| of[list].as_array().into_iter().flatten();
    let is_same = |old: &Value, new: &Value| words.iter().all(|w| old[w] == new[w]);
    let pair = |new: &'a Value| Some((entries(before).find(|old| is_same(old, new))?, new));
    entries(now).filter_map(pair).collect()
}

fn ratios(before: &Value, now: &Value, names: &[&str]) -> Row {
    let ratio = |name: &&str| {
        let (old, new) = (before[name].as_f64()?, now[name].as_f64()?);
        (old > 0.0).then(|| format!("{:.2}", new / old))
    };
    names
        .iter()
        .map(|name| ratio(name).unwrap_or("-".into()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn figures(wall: f64, adapter: &str) -> Value {
        let frames = json!({"adapter": adapter, "strategy": "plts", "lighting": "", "frame_wall_ms": wall, "samples": 8});
        json!({"size": [50, 40], "cases": [{"case": "A", "open_ms": 2.0, "strategies": [frames]}]})
    }

    #[test]
    fn what_both_runs_have_is_compared() {
        let told = text(&figures(10.0, "cpu"), &figures(25.0, "cpu")).unwrap();
        assert!(told.contains("2.50") && told.contains("1.00"), "{told}");
        assert!(text(&figures(10.0, "cpu"), &figures(25.0, "another")).is_err());
    }
}
