//! Plots over time: dates along the axis, one time under the pointer in all of them, steps that can be clicked.

use std::ops::RangeInclusive;

use eframe::egui::{Id, Ui};
use egui_plot::{GridInput, GridMark, Plot, PlotResponse};

use super::controls::significant;
use super::dates::Calendar;
use crate::case::{Case, Vectors};
use crate::viewer::action::Action;

/// Months between marks of the axis, from dense to sparse, and about how many days that is.
const MARKS: [i64; 7] = [1, 3, 6, 12, 60, 120, 600];
const MONTH: f64 = 30.44;
/// Points beside a plot for the numbers of its axis: plots below each other have the same times at the same place.
const NUMBERS: f32 = 56.0;
/// Points of the height that a number has, and marks at most.
const NUMBER: f32 = 32.0;
const MOST_NUMBERS: usize = 100;

/// The axis of time that plots share: days since the start of the run.
#[derive(Debug, Clone, Copy)]
pub struct TimeAxis {
    calendar: Option<Calendar>,
    /// Where the times of vectors begin.
    vectors: f64,
}

impl TimeAxis {
    /// That of a case and of its vectors, which may begin at another date.
    pub fn of(case: &Case, vectors: Option<&Vectors>) -> Self {
        let start = vectors.and_then(|v| v.start);
        let own = Calendar::of(&case.steps);
        let between = own.zip(start).map(|(own, start)| start - own.start());
        Self {
            calendar: own.or(start.map(Calendar::since)),
            vectors: between.unwrap_or(0.0),
        }
    }

    /// Where on the axis a time of vectors lies.
    pub fn of_vectors(self, days: f64) -> f64 {
        self.vectors + days
    }

    /// What stands at a mark of the axis: year and month of the first day of a month.
    fn mark(self, days: f64) -> String {
        match self.calendar {
            Some(calendar) => {
                let date = calendar.date(days);
                date.strip_suffix("-01").unwrap_or(&date).to_owned()
            }
            None => format!("day {}", significant(days)),
        }
    }

    /// A plot over this axis; `unit` is that of its values.
    pub fn plot(self, name: &str, unit: &str, height: f32) -> Plot<'static> {
        let plot = Plot::new(("curves", name))
            .height(height)
            .allow_scroll(false)
            .link_axis(Id::unique("curves over time"), [true, false])
            .label_formatter(|_| None)
            .y_axis_label(unit)
            .y_grid_spacer(move |input| numbers(input.bounds, f64::from(height / NUMBER)))
            .y_axis_min_width(NUMBERS)
            .x_axis_formatter(move |mark: GridMark, _: &RangeInclusive<f64>| self.mark(mark.value))
            .y_axis_formatter(|mark: GridMark, _: &RangeInclusive<f64>| significant(mark.value));
        match self.calendar {
            Some(calendar) => plot.x_grid_spacer(move |input| months(calendar, &input)),
            None => plot,
        }
    }
}

/// The place among rising times that is nearest to one of them.
pub fn nearest(times: impl Iterator<Item = f64>, time: f64) -> Option<usize> {
    let apart = times.map(|t| (t - time).abs()).enumerate();
    apart.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(n, _)| n)
}

/// The step of a case that is nearest to a place on the axis.
pub fn nearest_step(case: &Case, days: f64) -> Option<usize> {
    nearest(case.steps.iter().map(|step| step.days), days)
}

/// The place on the axis that the pointer is at in a plot; a click goes to the step that is nearest.
pub fn touched<R>(
    case: &Case,
    response: &PlotResponse<R>,
    actions: &mut Vec<Action>,
) -> Option<f64> {
    let at = response.response.hover_pos()?;
    let days = response.transform.value_from_position(at).x;
    if response.response.clicked() {
        actions.extend(nearest_step(case, days).map(Action::Step));
    }
    Some(days)
}

/// Where it is kept to which time the pointer points: all plots tell the values there.
fn pointed_id() -> Id {
    Id::unique("time that the pointer in the curves is at")
}

/// The place on the axis that the pointer was at in the frame before.
pub fn pointed_before(ui: &Ui) -> Option<f64> {
    ui.data(|d| d.get_temp::<Option<f64>>(pointed_id()))
        .flatten()
}

/// Keeps where the pointer is.
pub fn keep_pointed(ui: &Ui, pointed: Option<f64>) {
    ui.data_mut(|d| d.insert_temp(pointed_id(), pointed));
}

/// About as many marks between two values as there is room for, at round numbers.
fn numbers((low, high): (f64, f64), count: f64) -> Vec<GridMark> {
    let least = (high - low) / count.max(1.0);
    let power = 10_f64.powf(least.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|n| n * power);
    let Some(step_size) = steps
        .into_iter()
        .find(|step| *step >= least && step.is_normal())
    else {
        return Vec::new();
    };
    let places = (low / step_size).ceil() as i64..=(high / step_size).floor() as i64;
    let mark = |n: i64| GridMark {
        value: n as f64 * step_size,
        step_size,
    };
    places.map(mark).take(MOST_NUMBERS).collect()
}

/// Marks at the first of months or years: four thicknesses of them, of which the sparse ones have room for dates.
fn months(calendar: Calendar, input: &GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let first = MARKS
        .iter()
        .position(|m| *m as f64 * MONTH >= input.base_step_size);
    let from = first.unwrap_or(MARKS.len() - 1);
    let mut marks: Vec<GridMark> = Vec::new();
    for every in MARKS.iter().skip(from).take(4) {
        let step_size = *every as f64 * MONTH;
        for value in calendar.months([low, high], *every) {
            match marks.iter_mut().find(|m| m.value == value) {
                Some(known) => known.step_size = step_size,
                None => marks.push(GridMark { value, step_size }),
            }
        }
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_lie_at_round_numbers() {
        let of = |low: f64, high: f64, count: f64| -> Vec<f64> {
            let marks = numbers((low, high), count);
            marks.iter().map(|mark| mark.value).collect()
        };
        assert_eq!(of(-80.0, 7100.0, 3.0), [0.0, 5000.0]);
        assert_eq!(of(-80.0, 7100.0, 4.0), [0.0, 2000.0, 4000.0, 6000.0]);
        assert_eq!(of(0.1, 0.9, 4.0), [0.2, 0.4, 0.6000000000000001, 0.8]);
        assert_eq!(of(-1.0, 1.0, 2.0), [-1.0, 0.0, 1.0]);
        // Nothing between values that are no numbers or the same.
        for (low, high) in [(f64::NAN, 1.0), (0.0, f64::INFINITY), (2.0, 2.0)] {
            assert!(of(low, high, 4.0).is_empty());
        }
    }

    #[test]
    fn the_nearest_time_is_found() {
        let near = |time| nearest([0.0, 10.0, 30.0].into_iter(), time);
        assert_eq!([-5.0, 4.0, 6.0, 100.0].map(near), [0, 0, 1, 2].map(Some));
        assert_eq!(nearest(std::iter::empty(), 1.0), None);
    }
}
