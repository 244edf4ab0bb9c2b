//! Range, scale, colors and opacities, as scenes have them.

use serde::{Deserialize, Deserializer, Serialize};

/// Which values lie at both ends of the color map: `[low, high]`, `"step"` or `"steps"`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "range must be two numbers [low, high], \"step\" or \"steps\""
)]
pub enum RangeSpec {
    /// These, the smaller first.
    Fixed([f64; 2]),
    /// Those of the property itself.
    Own(OwnRange),
}

/// The values of a property that its range is taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum OwnRange {
    /// The step shown.
    Step,
    /// All steps; for a static property the same as the step.
    Steps,
}

impl RangeSpec {
    /// `"step"`.
    pub const STEP: Self = Self::Own(OwnRange::Step);
    /// `"steps"`.
    pub const STEPS: Self = Self::Own(OwnRange::Steps);
}

impl Default for RangeSpec {
    fn default() -> Self {
        Self::STEP
    }
}

/// A field's value, or its default for `null`, which scenes had for "absent".
pub(super) fn null_is_default<'de, D, T>(deserializer: D) -> Result<T, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de> + Default,
{
    Option::deserialize(deserializer).map(Option::unwrap_or_default)
}

/// Bands of a banded color map, at least and at most.
pub const BANDS: [usize; 2] = [2, 64];

/// Color map and opacity curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TransferSpec {
    /// A named map or a list of points.
    pub color: ColorSpec,
    /// Whether positions follow the values or their logarithms.
    pub scale: ScaleSpec,
    /// How the color map is used.
    pub coloring: Coloring,
    /// Number of bands where coloring is banded, 2 to 64.
    pub bands: usize,
    /// Points (position 0..1, opacity 0..1), `"automatic"` or `"boundaries"`; where absent a curve that rises
    /// with the value, or for categories the same opacity for all.
    pub opacity: Option<OpacitySpec>,
    /// Length to which opacity refers; where absent the mean cell edge in world space, or for an automatic
    /// opacity the one found with it.
    pub reference_length: Option<f64>,
}

impl Default for TransferSpec {
    fn default() -> Self {
        Self {
            color: ColorSpec::Name("turbo".into()),
            scale: ScaleSpec::Linear,
            coloring: Coloring::Continuous,
            bands: 10,
            opacity: None,
            reference_length: None,
        }
    }
}

/// What positions in the range follow.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ScaleSpec {
    /// The values.
    #[default]
    Linear,
    /// Their decimal logarithms, which are what is interpolated between cells then. Values at or below
    /// zero count as the low end of the range.
    Log,
}

/// How the color map is used.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Coloring {
    /// Colors pass into each other.
    #[default]
    Continuous,
    /// One color for each of `bands` equal parts of the range.
    Banded,
    /// A color of its own for each whole number that occurs at any step, at most 64 of them: a fixed
    /// palette, or the map where it is given by points. Values are those of cells, and the range is not
    /// used.
    Categories,
}

/// A color map by name or by points (position 0..1, `#rrggbb`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "transfer.color must be a name or points [[position, \"#rrggbb\"], ...]"
)]
pub enum ColorSpec {
    /// One of the presets.
    Name(String),
    /// Position and `#rrggbb`.
    Points(Vec<(f64, String)>),
}

/// An opacity curve, or how to find one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "transfer.opacity must be points [[position, opacity], ...], \"automatic\" or \"boundaries\""
)]
pub enum OpacitySpec {
    /// Position 0..1 and opacity 0..1.
    Points(Vec<[f64; 2]>),
    /// By what the values are like.
    Found(FoundOpacity),
}

/// How an opacity curve is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FoundOpacity {
    /// What is rich in the quantity that one looks for is the most solid, the rest a haze: by the values at the
    /// last step that has them. The reference length is found with it where the scene has none.
    Automatic,
    /// Peaks where values change most from cell to cell, at the last step that has them; the default
    /// curve where there is no such boundary.
    Boundaries,
}

impl OpacitySpec {
    /// `"automatic"`.
    pub const AUTOMATIC: Self = Self::Found(FoundOpacity::Automatic);
    /// `"boundaries"`.
    pub const BOUNDARIES: Self = Self::Found(FoundOpacity::Boundaries);
}

#[cfg(test)]
mod tests {
    use crate::scene::{OpacitySpec, RangeSpec, Scene};

    fn read(json: &str) -> Result<Scene, String> {
        serde_json::from_str(json).map_err(|e| e.to_string())
    }

    #[test]
    fn ok_every_form_of_range_and_opacity_comes_back() {
        let forms = [
            (r#"{"range": [1, 2.5]}"#, RangeSpec::Fixed([1.0, 2.5])),
            (r#"{"range": "step"}"#, RangeSpec::STEP),
            (r#"{"range": "steps"}"#, RangeSpec::STEPS),
            (r#"{"range": null}"#, RangeSpec::STEP),
            ("{}", RangeSpec::STEP),
        ];
        for (json, range) in forms {
            let scene = read(json).unwrap();
            assert_eq!(scene.range, range, "{json}");
            let again = serde_json::to_string(&scene).unwrap();
            assert_eq!(read(&again).unwrap(), scene, "{again}");
        }
        let scene = read(
            r#"{"transfer": {"opacity": "boundaries", "scale": "log", "coloring": "banded", "bands": 7}}"#,
        )
        .unwrap();
        assert_eq!(scene.transfer.opacity, Some(OpacitySpec::BOUNDARIES));
        let again = serde_json::to_string(&scene).unwrap();
        assert!(again.contains(r#""opacity":"boundaries""#) && again.contains(r#""scale":"log""#));
        assert_eq!(read(&again).unwrap(), scene);
        assert_ne!(scene, Scene::default());
    }

    #[test]
    fn err_other_forms_are_named() {
        for (json, word) in [
            (r#"{"range": "all"}"#, "\"steps\""),
            (r#"{"range": [1]}"#, "[low, high]"),
            (r#"{"transfer": {"opacity": "ramp"}}"#, "\"boundaries\""),
            (r#"{"transfer": {"scale": "ln"}}"#, "`log`"),
            (r#"{"transfer": {"coloring": "steps"}}"#, "`categories`"),
            (r#"{"transfer": {"preset": true}}"#, "preset"),
        ] {
            let said = read(json).unwrap_err();
            assert!(said.contains(word), "{said}");
        }
    }
}
