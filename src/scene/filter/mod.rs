//! Which cells are drawn, as scenes have it: by I, J and K, by the values of properties, and by wells.

mod indices;

use serde::{Deserialize, Serialize};

pub use indices::Indices;

/// Which active cells are drawn: those that all of it keeps.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Filter {
    /// Columns along i; all where absent.
    pub i: Option<Indices>,
    /// Columns along j; all where absent.
    pub j: Option<Indices>,
    /// Layers; all where absent.
    pub k: Option<Indices>,
    /// Filters by value.
    pub properties: Vec<PropertyFilter>,
    /// Keeps the cells that wells of these names are connected to at the scene's step; the names may be patterns, see
    /// [`super::names`]. All cells where there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub wells: Vec<String>,
}

/// Keeps the cells whose value lies in a range, or is one of a list.
///
/// A filter without bounds and list keeps every cell. With either, a cell without a value is never kept,
/// inverted or not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PropertyFilter {
    /// Property, at the scene's step.
    pub name: String,
    /// Smallest value kept; open where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// Largest value kept; open where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// The values kept of a property of categories, in place of bounds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub values: Option<Vec<f64>>,
    /// Keeps the other cells instead.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub invert: bool,
    /// False keeps the filter in the scene without using it.
    #[serde(default = "on", skip_serializing_if = "is_on")]
    pub enabled: bool,
}

fn on() -> bool {
    true
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "what serde calls")]
fn is_on(enabled: &bool) -> bool {
    *enabled
}

impl PropertyFilter {
    /// A filter that keeps every cell until it is given bounds or values.
    pub fn open(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            min: None,
            max: None,
            values: None,
            invert: false,
            enabled: true,
        }
    }

    /// True where it can hide a cell.
    pub fn limits(&self) -> bool {
        self.enabled && (self.min.is_some() || self.max.is_some() || self.values.is_some())
    }

    /// True where a cell of this value is kept. Bounds are rounded as the values of files are, so that a
    /// value written as 0.6 lies within bounds of 0.6.
    pub fn keeps(&self, value: f32) -> bool {
        if !self.limits() {
            return true;
        }
        let is_listed = |values: &Vec<f64>| values.iter().any(|v| *v as f32 == value);
        let is_within = self.min.is_none_or(|min| value >= min as f32)
            && self.max.is_none_or(|max| value <= max as f32)
            && self.values.as_ref().is_none_or(is_listed);
        !value.is_nan() && is_within != self.invert
    }

    /// What it keeps as a person would say it: `SOIL 0.6 to 1.0`.
    fn words(&self) -> String {
        let name = &self.name;
        let not = if self.invert { "not " } else { "" };
        match (self.min, self.max, &self.values) {
            (_, _, Some(values)) if values.is_empty() => format!("{not}no {name}"),
            (_, _, Some(values)) => format!("{not}{name} {}", runs(values)),
            (Some(min), Some(max), _) if min == max => format!("{not}{name} {}", number(min)),
            (Some(min), Some(max), _) => {
                let outside = if self.invert { "outside " } else { "" };
                let [min, max] = alike([min, max]);
                format!("{name} {outside}{min} to {max}")
            }
            (Some(min), None, _) if self.invert => format!("{name} below {}", number(min)),
            (None, Some(max), _) if self.invert => format!("{name} above {}", number(max)),
            (Some(min), None, _) => format!("{name} from {}", number(min)),
            (None, Some(max), _) => format!("{name} up to {}", number(max)),
            (None, None, None) => name.clone(),
        }
    }
}

impl Filter {
    /// The three axes: name, zero-based number, and what is kept along it.
    fn axes(&self) -> [(&'static str, &'static str, Option<&Indices>); 3] {
        [
            ("I", "filter.i", self.i.as_ref()),
            ("J", "filter.j", self.j.as_ref()),
            ("K", "filter.k", self.k.as_ref()),
        ]
    }

    /// What is kept along an axis (0 for I, 1 for J, 2 for K).
    pub fn along(&self, axis: usize) -> Option<&Indices> {
        match axis {
            0 => self.i.as_ref(),
            1 => self.j.as_ref(),
            _ => self.k.as_ref(),
        }
    }

    /// The same, to change it.
    pub fn along_mut(&mut self, axis: usize) -> &mut Option<Indices> {
        match axis {
            0 => &mut self.i,
            1 => &mut self.j,
            _ => &mut self.k,
        }
    }

    /// True where it can hide a cell.
    pub fn limits(&self) -> bool {
        self.axes().iter().any(|axis| axis.2.is_some())
            || self.properties.iter().any(PropertyFilter::limits)
            || !self.wells.is_empty()
    }

    /// What it keeps as a person would say it, such as `K 2-5, SOIL 0.6 to 1.0`; empty where it keeps
    /// everything.
    pub fn words(&self) -> String {
        let axes = self.axes().into_iter();
        let axes = axes.filter_map(|(name, _, kept)| Some(format!("{name} {}", kept?.text())));
        let values = self.properties.iter().filter(|p| p.limits());
        let values = values.map(PropertyFilter::words);
        let wells = match self.wells.as_slice() {
            [] => None,
            wells => Some(format!("cells of wells {}", wells.join(" "))),
        };
        axes.chain(values)
            .chain(wells)
            .collect::<Vec<_>>()
            .join(", ")
    }
}

/// Whole numbers that follow each other as `1-3`, and the others one by one.
fn runs(values: &[f64]) -> String {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    let runs = values.chunk_by(|a, b| b - a == 1.0);
    let text = runs.map(|run| match run {
        [first, _, .., last] => format!("{}-{}", number(*first), number(*last)),
        few => few.iter().map(|v| number(*v)).collect::<Vec<_>>().join(","),
    });
    text.collect::<Vec<_>>().join(",")
}

/// A number with six digits at most.
fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    match rounded {
        v if v == 0.0 || (1e-4..1e7).contains(&v.abs()) => v.to_string(),
        v => format!("{v:e}"),
    }
}

/// Two numbers with as many decimals: `0.6` and `1.0`.
fn alike(ends: [f64; 2]) -> [String; 2] {
    let texts = ends.map(number);
    if texts.iter().any(|t| t.contains('e')) {
        return texts;
    }
    let decimals = |text: &String| text.split_once('.').map_or(0, |(_, d)| d.len());
    let most = texts.iter().map(decimals).max().unwrap_or(0);
    texts.map(|text| {
        let value: f64 = text.parse().unwrap_or(f64::NAN);
        format!("{value:.most$}")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(json: &str) -> Result<Filter, String> {
        serde_json::from_str(json).map_err(|e| e.to_string())
    }

    #[test]
    fn both_forms_come_back_as_they_were() {
        for json in [
            r#"{"i":[1,46],"j":null,"k":"2,4-6, 10-30:2","properties":[]}"#,
            r#"{"i":null,"j":"7","k":null,"properties":[{"name":"SOIL","min":0.6}]}"#,
            r#"{"i":null,"j":null,"k":null,"properties":[{"name":"SOIL","max":0.6,"invert":true}]}"#,
            r#"{"i":null,"j":null,"k":null,"properties":[],"wells":["P*","I1"]}"#,
            r#"{"i":null,"j":null,"k":null,"properties":[{"name":"FIPNUM","values":[1.0,3.0],"enabled":false}]}"#,
        ] {
            let filter = read(json).unwrap();
            assert_eq!(serde_json::to_string(&filter).unwrap(), json);
        }
    }

    #[test]
    fn old_filters_are_read_and_wrong_ones_named() {
        let old = r#"{"k":[1,22],"properties":[{"name":"SOIL","min":0.3,"max":1.0}]}"#;
        let soil = &read(old).unwrap().properties[0];
        assert!(soil.keeps(0.3) && soil.keeps(1.0) && !soil.keeps(0.29));
        for (json, word) in [
            (r#"{"k":[1]}"#, "[first, last]"),
            (r#"{"k":4}"#, "2,4-6,10-30:2"),
            (r#"{"properties":[{"min":1}]}"#, "name"),
            (r#"{"properties":[{"name":"A","least":1}]}"#, "least"),
        ] {
            let said = read(json).unwrap_err();
            assert!(said.contains(word), "{said}");
        }
    }

    #[test]
    fn values_pass_bounds_lists_and_their_opposites() {
        let filter = |change: &dyn Fn(&mut PropertyFilter)| {
            let mut filter = PropertyFilter::open("A");
            change(&mut filter);
            filter
        };
        let kept = |f: &PropertyFilter| [1.0, 2.0, 3.0, f32::NAN].map(|v| f.keeps(v));
        let from = filter(&|f| f.min = Some(2.0));
        assert_eq!(kept(&from), [false, true, true, false]);
        let outside = filter(&|f| (f.min, f.max, f.invert) = (Some(2.0), Some(2.5), true));
        assert_eq!(kept(&outside), [true, false, true, false]);
        let listed = filter(&|f| f.values = Some(vec![1.0, 3.0]));
        assert_eq!(kept(&listed), [true, false, true, false]);
        assert_eq!(kept(&filter(&|f| f.values = Some(vec![]))), [false; 4]);
        // Nothing is asked: an open one, and one that is off.
        assert_eq!(kept(&filter(&|f| f.invert = true)), [true; 4]);
        let off = filter(&|f| (f.min, f.enabled) = (Some(9.0), false));
        assert_eq!(kept(&off), [true; 4]);
        // 0.6 as a file has it is a little more than 0.6.
        assert!(filter(&|f| f.max = Some(0.6)).keeps(0.6));
    }

    #[test]
    fn filters_are_told_in_words() {
        let words = |json: &str| read(json).unwrap().words();
        let soil = r#""properties":[{"name":"SOIL","min":0.6,"max":1}]"#;
        assert_eq!(
            words(&format!(r#"{{"k":[2,5],{soil}}}"#)),
            "K 2-5, SOIL 0.6 to 1.0"
        );
        assert_eq!(words(r#"{"i":[7,7],"j":"1, 4-8:2"}"#), "I 7, J 1,4-8:2");
        assert_eq!(
            words(r#"{"k":[2,5],"wells":["P*","I1"]}"#),
            "K 2-5, cells of wells P* I1"
        );
        for (filter, said) in [
            (r#""min":0.25"#, "A from 0.25"),
            (r#""max":200,"invert":true"#, "A above 200"),
            (r#""min":0,"max":1e9,"invert":true"#, "A outside 0 to 1e9"),
            (r#""values":[7,1,2,3]"#, "A 1-3,7"),
            (r#""values":[1,2],"invert":true"#, "not A 1,2"),
            (r#""min":4,"max":4"#, "A 4"),
            (r#""min":4,"enabled":false"#, ""),
            (r#""invert":true"#, ""),
        ] {
            let json = format!(r#"{{"properties":[{{"name":"A",{filter}}}]}}"#);
            assert_eq!(words(&json), said);
        }
    }
}
