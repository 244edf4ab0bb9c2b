//! How a case looks before anyone has changed it: one place for the command line, the window, films and
//! comparisons.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::error::SceneError;
use crate::case::{Case, Categories, Kind, ValueRange, Well};
use crate::scene::{
    ColorSpec, Coloring, Hull, Integration, Interpolation, LibcSettings, LightingSpec, Mode,
    OpacitySpec, RangeSpec, ScaleSpec, Scene, Show, StrategyKind, TransferSpec,
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
        Self {
            range,
            transfer: TransferSpec {
                color: ColorSpec::Name(color.into()),
                opacity: Some(OpacitySpec::AUTOMATIC),
                ..TransferSpec::default()
            },
            ..Self::default()
        }
    }
}

/// How a property of a case looks before anyone has changed it.
///
/// Values are read here, at all steps where colors should mean the same while time plays; what cannot be read
/// has the look of its name, and its picture says why.
pub fn look_of(case: &Case, property: &str) -> Look {
    let mut look = match Quantity::of(property) {
        Quantity::Oil => Look::new(RangeSpec::Fixed([0.0, 1.0]), "oil"),
        Quantity::Water => Look::new(RangeSpec::Fixed([0.0, 1.0]), "water"),
        Quantity::Gas => Look::new(RangeSpec::Fixed([0.0, 1.0]), "gas"),
        Quantity::OtherPhase => Look::new(RangeSpec::Fixed([0.0, 1.0]), "viridis"),
        Quantity::Pressure => Look::new(RangeSpec::STEPS, "turbo"),
        Quantity::Wide => wide(case, property),
        Quantity::Region => categories(case, property),
        Quantity::Fraction => percentiles(case, property, "viridis"),
        Quantity::Difference => about_zero(case, property),
        Quantity::Depth => Look::new(RangeSpec::STEP, "viridis"),
        Quantity::Amplitude if has_both_signs(case, property) => about_zero(case, property),
        Quantity::Amplitude => percentiles(case, property, "turbo"),
        Quantity::Other if looks_like_regions(case, property) => categories(case, property),
        Quantity::Other => percentiles(case, property, "turbo"),
    };
    if is_mask(case, property) {
        // Means at corners would blur away what is one sample thick.
        look.interpolation = Interpolation::Cell;
    }
    if look.transfer.coloring != Coloring::Categories
        && look.transfer.scale == ScaleSpec::Linear
        && !matches!(look.range, RangeSpec::Fixed([0.0, 1.0]))
        && let Some(value) = constant(case, property)
    {
        // In the middle of the colors, not at their end.
        let reach = (0.1 * value.abs()).max(0.1);
        look.range = RangeSpec::Fixed([value - reach, value + reach]);
    }
    look
}

/// True where the case has the property and its values differ: from cell to cell at the last step, or at all.
pub fn varies(case: &Case, property: &str) -> bool {
    let last = case.last_field(property).ok().flatten();
    let last = last.and_then(|f| ValueRange::of(&f));
    let differs = |r: ValueRange| r.max > r.min;
    // Other steps are read where the last one is even.
    last.is_some_and(differs) || {
        let all = case.range_over_steps(property).ok().flatten();
        all.is_some_and(differs)
    }
}

/// True where wells of the last step are connected to cells, or have paths.
fn has_wells(case: &Case) -> bool {
    let last = case.steps.len().saturating_sub(1);
    let wells = case.wells(last).ok();
    wells.is_some_and(|wells| wells.iter().any(Well::has_place))
}

/// The property shown where a scene names none: what the case is about.
pub fn default_property(case: &Case) -> String {
    if let Some(subject) = &case.about.subject {
        return subject.clone();
    }
    let has = |name: &&&str| case.properties.iter().any(|p| p.name == **name);
    // A saturation that is the same everywhere tells nothing.
    let saturations = ["SOIL", "SGAS", "SWAT"].iter();
    let first = saturations.filter(has).find(|name| varies(case, name));
    let mut others = ["PRESSURE", "SOIL", "SGAS", "SWAT", "PORO", "PERMX"].iter();
    let found = first.or_else(|| others.find(has));
    found.map_or_else(|| "DEPTH".to_owned(), |name| (*name).to_owned())
}

/// The value of a property that is the same in all cells at all steps.
fn constant(case: &Case, property: &str) -> Option<f64> {
    // Spares the other steps where the values of the last one differ.
    if varies(case, property) {
        return None;
    }
    let range = case.range_over_steps(property).ok().flatten()?;
    (range.min == range.max).then_some(range.min)
}

/// Values over many powers of ten.
fn wide(case: &Case, property: &str) -> Look {
    let mut look = percentiles(case, property, "turbo");
    let range = case.range_over_steps(property).ok().flatten();
    let is_positive = |r: ValueRange| r.least_positive.is_some_and(|least| r.max > 3.0 * least);
    if range.is_some_and(is_positive) {
        look.transfer.scale = ScaleSpec::Log;
        // Zeros have no logarithm and get the color of the low end.
        look.range = match percentile_range(case, property, |v| v > 0.0) {
            Some(range) => RangeSpec::Fixed(range),
            None => RangeSpec::STEPS,
        };
    }
    look
}

/// Shares of the cells whose values lie below and above the range, where values have long tails.
const TAILS: [f64; 2] = [0.01, 0.99];
/// Tails are long where the range without them is less than this part of the whole.
const LONG: f64 = 0.6;

/// The whole range, or the one without tails where these are long.
fn percentiles(case: &Case, property: &str, color: &str) -> Look {
    let range = percentile_range(case, property, |_| true);
    let whole = case.range_over_steps(property).ok().flatten();
    let range = match (range, whole) {
        (Some([low, high]), Some(whole)) if high - low < LONG * (whole.max - whole.min) => {
            RangeSpec::Fixed([low, high])
        }
        _ if case.is_dynamic(property) => RangeSpec::STEPS,
        _ => RangeSpec::STEP,
    };
    Look::new(range, color)
}

/// The values at both ends of [`TAILS`] at the last step, of those that count; `None` where they are equal.
fn percentile_range(case: &Case, property: &str, counts: fn(f32) -> bool) -> Option<[f64; 2]> {
    let field = case.last_field(property).ok().flatten()?;
    let values = field.values().iter().copied();
    let mut values: Vec<f32> = values.filter(|v| !v.is_nan() && counts(*v)).collect();
    let last = values.len().checked_sub(1)?;
    let mut at = |share: f64| {
        let rank = (share * last as f64).round() as usize;
        let (_, value, _) = values.select_nth_unstable_by(rank, f32::total_cmp);
        f64::from(*value)
    };
    let [low, high] = TAILS.map(&mut at);
    (low < high).then_some([low, high])
}

/// True of a property whose values are numbers of regions, by its name or its values.
pub fn numbers_regions(case: &Case, property: &str) -> bool {
    match Quantity::of(property) {
        Quantity::Region => true,
        Quantity::Other => looks_like_regions(case, property),
        _ => false,
    }
}

/// Region numbers that the list of names does not know: few whole numbers in an array of the files. Two of them in a
/// volume are a mask, of which one looks for what it keeps.
fn looks_like_regions(case: &Case, property: &str) -> bool {
    let of_files = case
        .property(property)
        .is_ok_and(|p| p.kind == Kind::Static);
    let least = if is_subject(case, property) { 3 } else { 2 };
    of_files && matches!(case.categories(property), Ok(Categories::Values(v)) if v.len() >= least)
}

/// True of a volume of two whole numbers.
fn is_mask(case: &Case, property: &str) -> bool {
    is_subject(case, property)
        && matches!(case.categories(property), Ok(Categories::Values(v)) if v.len() == 2)
}

/// True of the values of a volume.
fn is_subject(case: &Case, property: &str) -> bool {
    let subject = case.about.subject.as_ref();
    subject.is_some_and(|subject| subject.eq_ignore_ascii_case(property))
}

fn categories(case: &Case, property: &str) -> Look {
    let mut look = Look::new(RangeSpec::STEP, "turbo");
    if let Ok(Categories::Values(values)) = case.categories(property)
        && !values.is_empty()
    {
        look.transfer.coloring = Coloring::Categories;
        look.interpolation = Interpolation::Cell;
    }
    look
}

fn has_both_signs(case: &Case, property: &str) -> bool {
    let range = case.range_over_steps(property).ok().flatten();
    range.is_some_and(|range| range.min < 0.0 && range.max > 0.0)
}

/// Symmetric about zero, so far that all but long tails is told apart.
fn about_zero(case: &Case, property: &str) -> Look {
    let whole = case.range_over_steps(property).ok().flatten();
    let whole = whole.map_or(0.0, |v| v.min.abs().max(v.max.abs()));
    let tails = percentile_range(case, property, |v| v != 0.0);
    let tails = tails.map_or(whole, |[low, high]| low.abs().max(high.abs()));
    let largest = if tails < LONG * whole { tails } else { whole };
    let range = match largest > 0.0 {
        true => RangeSpec::Fixed([-largest, largest]),
        false => RangeSpec::STEP,
    };
    Look::new(range, "coolwarm")
}

/// Cells that a model needs to have an inside worth looking into.
const FEW: usize = 2000;

/// The mode that shows more of a property: into the volume where it changes with time and the model has an inside,
/// or is that of a volume, cells where that hides what faces show at once: regions, constant and static properties,
/// small models and sections of one cell.
pub fn opening_mode(case: &Case, property: &str) -> Mode {
    let dims = case.grid.main_dims();
    let is_small = case.grid.active_cells().len() < FEW;
    let is_section = [dims.ni, dims.nj, dims.nk].contains(&1);
    let of_regions = Quantity::of(property) == Quantity::Region;
    let has_inside = case.is_dynamic(property) || is_subject(case, property);
    let is_plain = !has_inside || of_regions || constant(case, property).is_some();
    match is_small || is_section || is_plain {
        true => Mode::Cells,
        false => Mode::Volume,
    }
}

/// Ground of a picture that is not taken for a hole, nor for a color of the values.
const GROUND: &str = "#e9ebee";

/// The scene in which a case opens, `written` over it: the keys that a user gave, as in a scene file; null for
/// none.
///
/// # Errors
/// When a key is unknown or its value is not allowed.
pub fn opening(case: &Case, written: &Value) -> Result<Scene, SceneError> {
    let given = |key: &str| written.get(key).and_then(Value::as_str);
    let property = given("property").map_or_else(|| default_property(case), str::to_owned);
    let mut scene = Scene {
        // Whole segments show no steps, and take less time than samples.
        strategy: StrategyKind::Libc,
        libc: LibcSettings {
            integration: Integration::Segments,
            ..LibcSettings::default()
        },
        lighting: LightingSpec::preset("soft").unwrap_or_default(),
        background: GROUND.into(),
        show: Show {
            hull: Hull::Faint,
            wells: has_wells(case).into(),
            ..Show::default()
        },
        mode: match written.get("mode") {
            // Laid over below.
            Some(_) => Mode::default(),
            None => opening_mode(case, &property),
        },
        ..Scene::default()
    };
    look_of(case, &property).apply(&mut scene);
    scene.property = Some(property);
    let wrong = |e: serde_json::Error| SceneError::Text(e.to_string());
    let mut whole = serde_json::to_value(&scene).map_err(wrong)?;
    if !written.is_null() {
        lay_over(&mut whole, written);
    }
    serde_json::from_value(whole).map_err(wrong)
}

/// Keys whose value is one thing: what is written replaces all of it.
const WHOLE: [&str; 2] = ["camera", "lighting"];

/// Puts what is written over what is there, key by key.
fn lay_over(there: &mut Value, written: &Value) {
    match (there, written) {
        (Value::Object(there), Value::Object(written)) => {
            for (key, value) in written {
                match there.get_mut(key) {
                    Some(known) if !WHOLE.contains(&key.as_str()) => lay_over(known, value),
                    _ => {
                        there.insert(key.clone(), value.clone());
                    }
                }
            }
        }
        (there, written) => there.clone_from(written),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use serde_json::json;

    use super::*;
    use crate::case::load;
    use crate::view;

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
            let scene = opening(&case, &json!({"property": name})).unwrap();
            assert_eq!(Look::of(&scene), look_of(&case, &name), "{name}");
            let view = view::resolve(&scene, &case);
            assert!(view.is_ok(), "{name}: {:?}", view.err());
        }
    }

    #[test]
    fn looks_follow_the_kind_and_the_values() {
        let case = sample();
        assert_eq!(look_of(&case, "SWAT").range, RangeSpec::Fixed([0.0, 1.0]));
        assert_eq!(look_of(&case, "PRESSURE").range, RangeSpec::STEPS);
        assert_eq!(look_of(&case, "PERMX").transfer.scale, ScaleSpec::Log);
        let RangeSpec::Fixed([low, high]) = look_of(&case, "PRESSURE-PRESSURE@0").range else {
            panic!("a difference has a fixed range");
        };
        assert!(high > 0.0 && low == -high);
        let regions = look_of(&case, "FIPNUM").transfer.coloring;
        assert_eq!(regions, Coloring::Categories);
        // Column numbers are whole too, and no regions; a name that is not there has a look.
        for name in ["I", "NOSUCHNUM"] {
            let coloring = look_of(&case, name).transfer.coloring;
            assert_eq!(coloring, Coloring::Continuous, "{name}");
        }
    }

    #[test]
    fn what_is_written_counts_and_the_rest_is_the_look() {
        let case = sample();
        let opened = |written| opening(&case, &written).unwrap();
        let plain = opened(json!({}));
        assert_eq!(plain.property.as_deref(), Some("SOIL"));
        assert_eq!(plain.transfer.opacity, Some(OpacitySpec::AUTOMATIC));
        assert!(plain.lighting.occlusion.is_some());
        let own = opened(json!({
            "property": "PERMX", "transfer": {"color": "gray"}, "lighting": {"occlusion": null},
            "camera": {"eye": [0, 0, 9], "target": [0, 0, 0]}, "background": "#000000",
        }));
        assert_eq!(own.transfer.color, ColorSpec::Name("gray".into()));
        assert_eq!(own.transfer.scale, ScaleSpec::Log);
        assert!(own.lighting.occlusion.is_none() && own.background == "#000000");
        // A scene that was saved comes back as it was.
        let saved = serde_json::to_value(&own).unwrap();
        assert_eq!(opened(saved), own);
        let unknown = opening(&case, &json!({"transfer": {"colour": "gray"}}));
        assert!(unknown.unwrap_err().to_string().contains("colour"));
    }
}
