//! How a property looks at first, by what kind of quantity it is.

use serde::{Deserialize, Serialize};

use crate::case::{Case, Categories, ValueRange};
use crate::model::derived::Derived;
use crate::scene::{
    self, ColorSpec, Coloring, Interpolation, OpacitySpec, RangeSpec, ScaleSpec, Scene,
    TransferSpec,
};
use crate::transfer::kinds::Quantity;

/// What of a scene belongs to the property that it shows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Look {
    /// Values at both ends of the color map.
    pub range: RangeSpec,
    /// Colors and opacities.
    pub transfer: TransferSpec,
    /// How values vary inside a cell.
    pub interpolation: Interpolation,
}

impl Default for Look {
    fn default() -> Self {
        Self::of(&Scene::default())
    }
}

impl Look {
    /// That of a scene.
    pub fn of(scene: &Scene) -> Self {
        Self {
            range: scene.range,
            transfer: scene.transfer.clone(),
            interpolation: scene.interpolation,
        }
    }

    /// Gives it to a scene.
    pub fn apply(self, scene: &mut Scene) {
        scene.range = self.range;
        scene.transfer = self.transfer;
        scene.interpolation = self.interpolation;
    }

    fn new(range: RangeSpec, color: &str) -> Self {
        let transfer = TransferSpec {
            color: ColorSpec::Name(color.into()),
            ..TransferSpec::default()
        };
        Self {
            range,
            transfer,
            ..Self::default()
        }
    }

    fn with_opacity(mut self, points: &[[f64; 2]]) -> Self {
        self.transfer.opacity = Some(OpacitySpec::Points(points.to_vec()));
        self
    }
}

/// How a property of a case looks before anyone has changed it.
///
/// Regions and differences need their values at all steps and permeabilities those of one, which are read
/// here unless they are known; what cannot be read has the default look, and its picture says why.
pub fn look_of(case: &Case, property: &str) -> Look {
    let mut look = look_of_kind(case, property);
    look.transfer.reference_length = seen_through(case);
    if look.range == RangeSpec::STEP
        && look.transfer.coloring != Coloring::Categories
        && let Some(value) = constant(case, property)
    {
        // In the middle of the colors, not at their end.
        let reach = (0.1 * value.abs()).max(0.1);
        look.range = RangeSpec::Fixed([value - reach, value + reach]);
    }
    look
}

/// Layers of a model through which one looks from above: opacities refer to so thin a part of its thickness.
const LAYERS: f64 = 8.0;

/// The length to which opacities refer such that a model is seen and seen through, be it of two cells or of two
/// hundred layers: a part of its mean thickness in world space. `None` of a model without a thickness.
fn seen_through(case: &Case) -> Option<f64> {
    let grid = &case.grid;
    let thickness = Derived::Thickness.field(grid);
    let total: f64 = thickness.values().iter().map(|v| f64::from(*v)).sum();
    let dims = grid.dims();
    let mut columns: Vec<u32> = grid
        .active_cells()
        .iter()
        .map(|c| {
            let ijk = dims.ijk(*c);
            (ijk.i + ijk.j * dims.ni) as u32
        })
        .collect();
    columns.sort_unstable();
    columns.dedup();
    let [bottom, .., top] = scene::model_corners(case, None)?;
    let [low, high] = grid.bounds()?;
    let exaggeration = (top.z - bottom.z).abs() / (high.z - low.z).abs().max(1e-9);
    let mean = total / columns.len().max(1) as f64;
    let length = exaggeration * mean / LAYERS;
    (length > 0.0 && length.is_finite()).then_some(length)
}

/// The value of a property that is the same in all cells at the step shown first.
fn constant(case: &Case, property: &str) -> Option<f64> {
    let last = case.steps.len().saturating_sub(1);
    let field = case.field(property, last).ok()?;
    let statistics = field.statistics()?;
    (statistics.min == statistics.max).then_some(statistics.min)
}

fn look_of_kind(case: &Case, property: &str) -> Look {
    let values = || case.range_over_steps(property).ok().flatten();
    match Quantity::of(property) {
        Quantity::Saturation => saturation(property),
        Quantity::Pressure => Look::new(RangeSpec::STEPS, "turbo"),
        Quantity::Conductivity => conductivity(values()),
        Quantity::Region => regions(case, property),
        Quantity::Fraction => Look::new(RangeSpec::STEP, "viridis"),
        Quantity::Difference => difference(values()),
        Quantity::Depth => {
            Look::new(RangeSpec::STEP, "viridis").with_opacity(&[[0.0, 0.1], [1.0, 0.1]])
        }
        Quantity::Other => Look::default(),
    }
}

/// The same values have the same colors at all steps, and fronts are seen.
fn saturation(property: &str) -> Look {
    let color = match property.to_ascii_uppercase().as_str() {
        "SWAT" => "viridis",
        "SGAS" => "plasma",
        _ => "turbo",
    };
    let mut look = Look::new(RangeSpec::Fixed([0.0, 1.0]), color);
    look.transfer.opacity = Some(OpacitySpec::BOUNDARIES);
    look
}

fn conductivity(values: Option<ValueRange>) -> Look {
    let mut look = Look::new(RangeSpec::STEP, "turbo");
    if values.is_some_and(|v| v.least_positive.is_some()) {
        look.transfer.scale = ScaleSpec::Log;
    }
    look
}

fn regions(case: &Case, property: &str) -> Look {
    let mut look = Look::default();
    if let Ok(Categories::Values(values)) = case.categories(property)
        && !values.is_empty()
    {
        look.transfer.coloring = Coloring::Categories;
        look.interpolation = Interpolation::Cell;
    }
    look
}

/// Symmetric about zero, where nothing is to be seen.
fn difference(values: Option<ValueRange>) -> Look {
    let largest = values.map_or(0.0, |v| v.min.abs().max(v.max.abs()));
    let range = match largest > 0.0 {
        true => RangeSpec::Fixed([-largest, largest]),
        false => RangeSpec::STEP,
    };
    let v_shape = [[0.0, 0.5], [0.5, 0.005], [1.0, 0.5]];
    Look::new(range, "coolwarm").with_opacity(&v_shape)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::load;

    fn sample() -> Case {
        let file = "samples/scissor/SCISSOR.EGRID";
        load::open(&Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap()
    }

    #[test]
    fn every_property_of_the_sample_can_be_shown_in_its_look() {
        let case = sample();
        let mut names: Vec<String> = case.properties.iter().map(|p| p.name.clone()).collect();
        names.push("PRESSURE-PRESSURE@0".into());
        for name in names {
            let mut scene = Scene {
                property: Some(name.clone()),
                ..Scene::default()
            };
            let look = look_of(&case, &name);
            look.clone().apply(&mut scene);
            assert_eq!(Look::of(&scene), look);
            let view = scene::resolve(&scene, &case);
            assert!(view.is_ok(), "{name}: {:?}", view.err());
        }
    }

    #[test]
    fn looks_follow_the_kind_and_the_values() {
        let case = sample();
        let swat = look_of(&case, "SWAT");
        assert_eq!(swat.range, RangeSpec::Fixed([0.0, 1.0]));
        assert_eq!(look_of(&case, "PRESSURE").range, RangeSpec::STEPS);
        assert_eq!(look_of(&case, "PERMX").transfer.scale, ScaleSpec::Log);
        let RangeSpec::Fixed([low, high]) = look_of(&case, "PRESSURE-PRESSURE@0").range else {
            panic!("a difference has a fixed range");
        };
        assert!(high > 0.0 && low == -high);
        // No positive value, and no such property.
        let zero = ValueRange {
            min: 0.0,
            max: 0.0,
            least_positive: None,
        };
        assert_eq!(conductivity(Some(zero)).transfer.scale, ScaleSpec::Linear);
        assert_eq!(difference(Some(zero)).range, RangeSpec::STEP);
        let unknown = look_of(&case, "NOSUCHNUM");
        assert_eq!(unknown.transfer.coloring, Coloring::Continuous);
    }
}
