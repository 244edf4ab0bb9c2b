//! From a scene's range and transfer function to those of a view, checked against the case's values.

use std::sync::Arc;

use rayon::prelude::*;

use super::SceneError;
use super::error::{positive, wrong};
use crate::case::{Case, Categories, Extent, MAX_CATEGORIES, ValueRange};
use crate::model::CellField;
use crate::scene::transfer::BANDS;
use crate::scene::{
    ColorSpec, Coloring, FoundOpacity, Interpolation, Mode, OpacitySpec, OwnRange, RangeSpec,
    ScaleSpec, Scene, TransferSpec,
};
use crate::transfer::function::{MAX_OPACITY, color_at};
use crate::transfer::kinds::Quantity;
use crate::transfer::opacity::{self, Interest, Opacity};
use crate::transfer::{Curve, Scale, TransferFunction, boundaries, coloring, presets};

/// What colors are asked for, and of what.
pub(super) struct ColorRequest<'a> {
    pub scene: &'a Scene,
    pub case: &'a Case,
    pub property: &'a str,
    /// Range of true values to use instead of the scene's.
    pub range: Option<[f64; 2]>,
    /// Mean edge of the cells in world space.
    pub mean_edge: f64,
    /// Factor on depth in world space.
    pub exaggeration: f64,
    /// Extent of the thinnest part that a filter leaves, in world space; `None` where it hides nothing.
    pub thinnest: Option<f64>,
}

/// A transfer function, and the field in its scale.
pub(super) struct Colors {
    pub field: Arc<CellField>,
    pub transfer: TransferFunction,
    /// Values lie below the range, and above.
    pub beyond: [bool; 2],
}

/// How values vary inside a cell: a category never passes into another, and a solid cell has one value.
pub(super) fn interpolation(scene: &Scene) -> Interpolation {
    match (scene.mode, scene.transfer.coloring) {
        (Mode::Cells, _) | (_, Coloring::Categories) => Interpolation::Cell,
        _ => scene.interpolation,
    }
}

/// Field and transfer function for the values of the step shown.
pub(super) fn resolve(
    asked: &ColorRequest<'_>,
    field: &Arc<CellField>,
) -> Result<Colors, SceneError> {
    let spec = &asked.scene.transfer;
    let (scale, range) = match (spec.coloring, spec.scale) {
        (Coloring::Categories, _) => categories(asked, field)?,
        (_, ScaleSpec::Linear) => (Scale::Linear, ends(asked, field)?.0),
        (_, ScaleSpec::Log) => (Scale::Log, log_range(asked, field)?),
    };
    let (color, bands) = colors(&asked.scene.transfer, &scale)?;
    let opacity = match asked.scene.mode {
        // What stands before light is solid.
        Mode::Cells => Opacity {
            curve: vec![(0.0, MAX_OPACITY)],
            reference_length: asked.mean_edge,
        },
        Mode::Volume => opacity(asked, &scale, range)?,
    };
    let reference_length = match spec.reference_length {
        Some(v) => positive("transfer.reference_length", v)?,
        None => opacity.reference_length,
    };
    let transfer = TransferFunction {
        color,
        opacity: opacity.curve,
        range,
        bands,
        reference_length,
        scale,
    };
    Ok(Colors {
        field: transfer.scale.field(field, range[0]),
        beyond: beyond(&transfer, field),
        transfer,
    })
}

/// Part of a range, in its scale, that does not show beside the bar of a legend.
const UNSEEN: f64 = 1e-3;

/// True where defined values lie below the range of colors, and above.
fn beyond(transfer: &TransferFunction, field: &CellField) -> [bool; 2] {
    let scale = &transfer.scale;
    let is_ramp = !matches!(scale, Scale::Categories(_));
    let Some(values) = ValueRange::of(field).filter(|_| is_ramp) else {
        return [false; 2];
    };
    let [low, high] = transfer.range;
    let unseen = UNSEEN * (high - low);
    let has_no_logarithm = *scale == Scale::Log && values.min <= 0.0;
    [
        has_no_logarithm || scale.shown(values.min, low) < low - unseen,
        scale.shown(values.max, low) > high + unseen,
    ]
}

/// The ends of the range as true values, and what the values are like that they are taken from.
fn ends(
    asked: &ColorRequest<'_>,
    field: &CellField,
) -> Result<([f64; 2], Option<ValueRange>), SceneError> {
    let values = match asked.scene.range {
        RangeSpec::Own(OwnRange::Steps) => asked.case.range_over_steps(asked.property)?,
        _ => ValueRange::of(field),
    };
    let range = match (asked.range, asked.scene.range) {
        (Some(range), _) => range,
        (_, RangeSpec::Fixed([a, b])) if a.is_finite() && b.is_finite() && a < b => [a, b],
        (_, RangeSpec::Fixed(_)) => {
            return Err(wrong("range", "must be two numbers, the smaller first"));
        }
        (_, RangeSpec::Own(_)) => values.map_or([0.0, 1.0], |v| [v.min, v.max]),
    };
    Ok((range, values))
}

/// Powers of ten that a log scale spans at most where its low end is not given.
const DECADES: i32 = 8;

fn log_range(asked: &ColorRequest<'_>, field: &CellField) -> Result<[f64; 2], SceneError> {
    let ([low, high], values) = ends(asked, field)?;
    if high <= 0.0 || values.is_none() {
        let problem = format!(
            "\"log\" needs values above 0, and the range of {} is {low} to {high}; use \"linear\" or another range",
            asked.property
        );
        return Err(wrong("transfer.scale", problem));
    }
    let lowest = high * 10f64.powi(-DECADES);
    let least = values.and_then(|v| v.least_positive).filter(|v| *v < high);
    let low = match asked.scene.range {
        RangeSpec::Fixed(_) if low > 0.0 => low,
        _ if low > 0.0 => low.max(lowest),
        _ => least.unwrap_or(lowest).max(lowest),
    };
    Ok([low, high].map(f64::log10))
}

fn categories(
    asked: &ColorRequest<'_>,
    field: &CellField,
) -> Result<(Scale, [f64; 2]), SceneError> {
    let name = asked.property;
    let refuse = |problem: String| {
        let problem = format!("{name} {problem}; use \"continuous\" or \"banded\"");
        Err(wrong("transfer.coloring", problem))
    };
    if asked.scene.transfer.scale == ScaleSpec::Log {
        let problem = "categories have no logarithm; use \"linear\"";
        return Err(wrong("transfer.scale", problem));
    }
    // Before all steps are read.
    if let Some(v) = field
        .values()
        .iter()
        .find(|v| v.fract() != 0.0 && !v.is_nan())
    {
        return refuse(format!("has values that are not whole, such as {v}"));
    }
    match asked.case.categories(name)? {
        Categories::NotWhole(v) => refuse(format!("has values that are not whole, such as {v}")),
        Categories::TooMany => refuse(format!("has more than {MAX_CATEGORIES} different values")),
        Categories::Values(values) => {
            let last = values.len().max(1) - 1;
            Ok((Scale::Categories(values), [-0.5, last as f64 + 0.5]))
        }
    }
}

/// The color curve, and the number of equal parts that have one color each.
pub(super) fn colors(
    spec: &TransferSpec,
    scale: &Scale,
) -> Result<(Curve<[f64; 3]>, Option<usize>), SceneError> {
    let map = color_map(&spec.color)?;
    // At positions from 0 to 1, both included.
    let spread = |count: usize| {
        let last = (count.max(2) - 1) as f64;
        let at = |n: usize| color_at(&map, n as f64 / last);
        (0..count).map(at).collect::<Vec<_>>()
    };
    let parts = match (scale, spec.coloring) {
        (Scale::Categories(values), _) => match spec.color {
            ColorSpec::Name(_) => coloring::palette(values.len().max(1)),
            ColorSpec::Points(_) => spread(values.len().max(1)),
        },
        (_, Coloring::Banded) if (BANDS[0]..=BANDS[1]).contains(&spec.bands) => spread(spec.bands),
        (_, Coloring::Banded) => {
            let [least, most] = BANDS;
            let problem = format!("{} must be {least} to {most}", spec.bands);
            return Err(wrong("transfer.bands", problem));
        }
        _ => return Ok((map, None)),
    };
    Ok((coloring::parts(&parts), Some(parts.len())))
}

fn color_map(spec: &ColorSpec) -> Result<Curve<[f64; 3]>, SceneError> {
    let color = match spec {
        ColorSpec::Name(name) => presets::color_map(name).ok_or_else(|| {
            let known = presets::NAMES.join(", ");
            let problem = format!("{name} is not known; there are {known}");
            wrong("transfer.color", problem)
        })?,
        ColorSpec::Points(points) => points
            .iter()
            .map(|(at, hex)| presets::parse_color(hex).map(|rgb| (*at, rgb)))
            .collect::<Option<Vec<_>>>()
            .ok_or_else(|| wrong("transfer.color", "colors must look like #rrggbb"))?,
    };
    match rises(&color) {
        true => Ok(color),
        false => Err(wrong(
            "transfer.color",
            "needs positions that rise from 0 to 1",
        )),
    }
}

fn rises<T>(curve: &Curve<T>) -> bool {
    let is_within = |p: &(f64, T)| (0.0..=1.0).contains(&p.0);
    !curve.is_empty() && curve.iter().all(is_within) && curve.is_sorted_by(|a, b| a.0 <= b.0)
}

/// Where a scene has no opacity: rising with the value, or the same for all categories.
pub(super) fn default_opacity(scale: &Scale) -> Curve<f64> {
    match scale {
        Scale::Categories(_) => vec![(0.0, 0.3), (1.0, 0.3)],
        _ => vec![(0.0, 0.02), (0.5, 0.1), (1.0, 0.5)],
    }
}

fn opacity(
    asked: &ColorRequest<'_>,
    scale: &Scale,
    range: [f64; 2],
) -> Result<Opacity, SceneError> {
    let per_edge = |curve| Opacity {
        curve,
        reference_length: asked.mean_edge,
    };
    let spec = &asked.scene.transfer;
    let found = match &spec.opacity {
        Some(OpacitySpec::Points(points)) => per_edge(checked(points)?),
        None => filtered(asked, per_edge(default_opacity(scale))),
        Some(OpacitySpec::Found(FoundOpacity::Automatic)) => {
            let found = automatic(asked, scale, range)?;
            filtered(
                asked,
                found.unwrap_or_else(|| per_edge(default_opacity(scale))),
            )
        }
        Some(OpacitySpec::Found(FoundOpacity::Boundaries)) => {
            let found = asked.case.boundaries(asked.property, scale)?;
            let curve = boundaries::curve(&found, range);
            filtered(
                asked,
                per_edge(curve.unwrap_or_else(|| default_opacity(scale))),
            )
        }
    };
    Ok(found)
}

/// An opacity that was chosen by hand.
pub(super) fn checked(points: &[[f64; 2]]) -> Result<Curve<f64>, SceneError> {
    let curve: Curve<f64> = points.iter().map(|p| (p[0], p[1])).collect();
    match rises(&curve) && curve.iter().all(|p| (0.0..=1.0).contains(&p.1)) {
        true => Ok(curve),
        false => Err(wrong(
            "transfer.opacity",
            "needs rising positions and opacities, both from 0 to 1",
        )),
    }
}

/// The weights for a property's values: cells that a local grid refines count with the finer ones.
fn weights(case: &Case, property: &str) -> Arc<Vec<f32>> {
    let weights = case.weights_of(property).values;
    let Some(finest) = case.grid.finest() else {
        return weights;
    };
    let weights = weights.iter().zip(finest);
    Arc::new(
        weights
            .map(|(weight, is_finest)| if is_finest { *weight } else { 0.0 })
            .collect(),
    )
}

/// The opacity that suits the values at the last step that has them; found once for a range and exaggeration.
fn automatic(
    asked: &ColorRequest<'_>,
    scale: &Scale,
    range: [f64; 2],
) -> Result<Option<Opacity>, SceneError> {
    let (case, exaggeration) = (asked.case, asked.exaggeration);
    let kind = match scale {
        Scale::Linear => "linear",
        Scale::Log => "log",
        Scale::Categories(_) => "categories",
    };
    let space = case.grid.space();
    let key = format!(
        "{} {kind} {range:?} {space:?} {exaggeration}",
        asked.property
    );
    case.over_steps.opacity(&key, || {
        let Some(field) = case.last_field(asked.property)? else {
            return Ok(None);
        };
        let field = scale.field(&field, range[0]);
        let (weights, extents) = rayon::join(|| weights(case, asked.property), || case.extents());
        let [low, high] = range;
        // Where the range is empty all values are at its low end; what is undefined stays so.
        let width = if high > low {
            high - low
        } else {
            f64::INFINITY
        };
        let cell = |(value, (volume, extent)): (&f32, (&f32, &Extent))| opacity::Cell {
            position: ((f64::from(*value) - low) / width).clamp(0.0, 1.0),
            volume: f64::from(*volume),
            extent: f64::from(extent.lateral).min(exaggeration * f64::from(extent.vertical)),
        };
        let cells = field.values().par_iter();
        let cells = cells
            .zip(weights.par_iter().zip(extents.par_iter()))
            .map(cell);
        let interest = match scale {
            Scale::Categories(_) => Interest::Alike,
            // Amplitudes of one sign are not about zero.
            _ if Quantity::of(asked.property) == Quantity::Amplitude && low >= 0.0 => {
                Interest::High
            }
            _ => Quantity::of(asked.property).interest(),
        };
        Ok(opacity::find(
            interest,
            cells,
            case.thinnest_extent(exaggeration),
        ))
    })
}

/// What a filter leaves of a model is at least this opaque, seen through its thinnest part.
const FILTERED: f64 = 0.9;

/// An opacity that was not chosen by hand, made solid where a filter hides cells.
fn filtered(asked: &ColorRequest<'_>, found: Opacity) -> Opacity {
    let Some(thinnest) = asked.thinnest else {
        return found;
    };
    // A length that the scene gives counts in place of the one that was found.
    let spec = &asked.scene.transfer;
    let length = spec.reference_length.unwrap_or(found.reference_length);
    Opacity {
        curve: filtered_opacity(found.curve, length, thinnest),
        ..found
    }
}

/// An opacity that was not chosen by hand, where a filter hides cells: at least 0.9 for every value over the
/// thinnest part that is left, which is one cell of a filter by value and the kept rows, columns or layers of
/// one by I, J or K. What passes a filter is what one wants to see.
///
/// **Units**: both lengths in world space; opacities refer to `reference_length`.
fn filtered_opacity(curve: Curve<f64>, reference_length: f64, thinnest: f64) -> Curve<f64> {
    let least = 1.0 - (1.0 - FILTERED).powf(reference_length / thinnest);
    let raised = |(at, opacity): (f64, f64)| (at, opacity.max(least));
    curve.into_iter().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_passes_a_filter_is_solid() {
        let faint = vec![(0.0, 0.0), (0.4, 0.9), (1.0, 0.01)];
        let through = |curve: &Curve<f64>, n: usize, length: f64| {
            1.0 - (1.0 - curve[n].1).powf(length / 40.0)
        };
        for thinnest in [2.0, 40.0, 900.0] {
            let solid = filtered_opacity(faint.clone(), 40.0, thinnest);
            for n in 0..3 {
                assert!(through(&solid, n, thinnest) >= FILTERED - 1e-12);
                assert!(solid[n].1 >= faint[n].1 && solid[n].0 == faint[n].0);
            }
        }
        // A crop that leaves much changes next to nothing.
        let crop = filtered_opacity(faint.clone(), 40.0, 1e5);
        assert!((crop[2].1 - faint[2].1).abs() < 1e-12 && crop[0].1 < 1e-3);
    }
}
