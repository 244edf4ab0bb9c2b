//! Figures over the views as line plots.

use super::{Contender, Plan, Row};
use crate::case::Case;
use crate::image::Rgb8;
use crate::picture::{Plot, Series};

/// Width and height of the plots.
const SIZE: [u32; 2] = [900, 420];

/// A figure that is drawn over the views.
pub struct Figure {
    /// File of the plot.
    pub file: &'static str,
    /// Over the y axis.
    label: &'static str,
    log: bool,
    /// Whether the reference has it only in comparison with itself.
    is_quality: bool,
    value: fn(&Row) -> Option<f64>,
}

/// The figures that are drawn.
pub const FIGURES: [Figure; 4] = [
    Figure {
        file: "time.png",
        label: "Time of a frame [ms]",
        log: true,
        is_quality: false,
        value: |row| row.frame_ms,
    },
    Figure {
        file: "psnr.png",
        label: "PSNR [dB]",
        log: false,
        is_quality: true,
        value: |row| row.psnr_db,
    },
    Figure {
        file: "ssim.png",
        label: "SSIM",
        log: false,
        is_quality: true,
        value: |row| row.ssim,
    },
    Figure {
        file: "ciede2000.png",
        label: "Mean CIEDE2000",
        log: false,
        is_quality: true,
        value: |row| row.ciede2000_mean,
    },
];

/// All plots by their files.
pub fn all(case: &Case, plan: &Plan, rows: &[Row]) -> Vec<(&'static str, Rgb8)> {
    let drawn = |figure: &Figure| (figure.file, figure.plot(case, plan, rows).draw(SIZE));
    FIGURES.iter().map(drawn).collect()
}

fn x_label(plan: &Plan) -> String {
    match plan.views.as_slice() {
        [] => String::new(),
        [only] => format!("View: {only}"),
        [first, .., last] => format!("View, from {first} to {last}"),
    }
}

impl Figure {
    fn plot(&self, case: &Case, plan: &Plan, rows: &[Row]) -> Plot {
        let against = match (self.is_quality, plan.truths.as_slice()) {
            (true, [only]) => format!(" against {}", only.name),
            (true, _) => " against its reference".to_owned(),
            (false, _) => String::new(),
        };
        let series = |contender: &Contender| {
            let truth = &plan.truths[contender.truth].name;
            match self.is_quality && truth == contender.name() {
                // Nothing to see, but a contender keeps its color in all plots.
                true => Series::default(),
                false => self.series(contender.name(), rows),
            }
        };
        Plot {
            title: format!("{}{against}", case.about.name),
            x_label: x_label(plan),
            y_label: self.label.into(),
            log_y: self.log,
            series: plan.contenders.iter().map(series).collect(),
        }
    }

    fn series(&self, name: &str, rows: &[Row]) -> Series {
        let own = rows.iter().filter(|row| row.name() == name);
        let point = |row: &Row| [row.view as f64, (self.value)(row).unwrap_or(f64::NAN)];
        Series {
            name: name.to_owned(),
            points: own.map(point).collect(),
        }
    }
}
