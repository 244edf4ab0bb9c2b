//! Choices by name, as scene files have them, with a sentence for each.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use strataray::compare::LightRow;
use strataray::scene::lighting::LightMethod;
use strataray::scene::{Interpolation, LightMode, Mode, Space, Storage, StrategyKind, Units};
use strataray::view::TurnAxis;

/// A name, what it stands for, and what that is in one sentence.
type NamedChoice<T> = (&'static str, T, &'static str);

pub const MODES: [NamedChoice<Mode>; 2] = [
    (
        "volume",
        Mode::Volume,
        "Rays through the inside of the cells: the values looked for are solid",
    ),
    (
        "cells",
        Mode::Cells,
        "Opaque cells: their outer faces and the sections of clip planes, each cell in the color of its value",
    ),
];

pub const SPACES: [NamedChoice<Space>; 2] = [
    ("map", Space::Map, "The true geometry"),
    (
        "ijk",
        Space::Ijk,
        "Flat layers and square columns by I, J and K (simbox), values unchanged",
    ),
];

pub const INTERPOLATIONS: [NamedChoice<Interpolation>; 2] = [
    (
        "cell",
        Interpolation::Cell,
        "The cell's own value everywhere in it",
    ),
    (
        "vertex",
        Interpolation::Vertex,
        "Trilinear between averages at the vertices",
    ),
];

pub const STORAGES: [NamedChoice<Storage>; 2] = [
    ("exact", Storage::Exact, "As 32-bit numbers"),
    (
        "compact",
        Storage::Compact,
        "Rounded to 16 bits: half the memory on a GPU",
    ),
];

pub const LIGHT_MODES: [NamedChoice<LightMode>; 4] = [
    ("off", LightMode::Off, "No shading"),
    (
        "image",
        LightMode::Image,
        "By a cone at every sample of a ray: slower, more exact",
    ),
    (
        "preilluminated",
        LightMode::Preilluminated,
        "Precomputed in a light volume that the rays sample: fast",
    ),
    (
        "monte_carlo",
        LightMode::MonteCarlo,
        "By many rays over the cone at every sample: slow, for comparison",
    ),
];

pub const OCCLUSION_METHODS: [NamedChoice<LightMethod>; LightMethod::ALL.len()] = {
    const fn choice(method: LightMethod) -> NamedChoice<LightMethod> {
        (method.name(), method, method.describe())
    }
    let all = LightMethod::ALL;
    let mut choices = [choice(all[0]); LightMethod::ALL.len()];
    let mut n = 1;
    while n < all.len() {
        choices[n] = choice(all[n]);
        n += 1;
    }
    choices
};

pub const LIGHT_ROWS: [NamedChoice<LightRow>; LightMethod::ALL.len() + 2] = {
    let rays = (
        LightRow::Rays.name(),
        LightRow::Rays,
        "Many rays, which the others are measured against",
    );
    let off = (
        LightRow::Off.name(),
        LightRow::Off,
        "Without occlusion and shadows",
    );
    let mut choices = [rays; LightMethod::ALL.len() + 2];
    choices[1] = off;
    let mut n = 0;
    while n < LightMethod::ALL.len() {
        let method = LightMethod::ALL[n];
        choices[n + 2] = (method.name(), LightRow::Method(method), method.describe());
        n += 1;
    }
    choices
};

pub const STRATEGIES: [NamedChoice<StrategyKind>; StrategyKind::ALL.len()] = {
    let all = StrategyKind::ALL;
    let mut choices = [strategy(all[0]); StrategyKind::ALL.len()];
    let mut n = 1;
    while n < all.len() {
        choices[n] = strategy(all[n]);
        n += 1;
    }
    choices
};

const fn strategy(kind: StrategyKind) -> NamedChoice<StrategyKind> {
    (kind.name(), kind, kind.describe())
}

pub const UNITS: [NamedChoice<Units>; Units::ALL.len()] = {
    let all = Units::ALL;
    let mut choices = [units(all[0]); Units::ALL.len()];
    let mut n = 1;
    while n < all.len() {
        choices[n] = units(all[n]);
        n += 1;
    }
    choices
};

const fn units(units: Units) -> NamedChoice<Units> {
    (units.name(), units, units.describe())
}

pub const TURN_AXES: [NamedChoice<TurnAxis>; 4] = [
    ("x", TurnAxis::X, "The axis to the east"),
    ("y", TurnAxis::Y, "The axis to the north"),
    ("z", TurnAxis::Z, "The vertical"),
    ("all", TurnAxis::All, "All three, one after another"),
];

/// Reads one of some choices; the help lists them.
pub fn one_of<T>(choices: &'static [NamedChoice<T>]) -> impl TypedValueParser<Value = T>
where
    T: Copy + Send + Sync + 'static,
{
    let value = |(name, _, help): &NamedChoice<T>| PossibleValue::new(*name).help(*help);
    let names = PossibleValuesParser::new(choices.iter().map(value));
    names.try_map(|name| {
        let known = choices.iter().find(|choice| choice.0 == name);
        known.map(|choice| choice.1).ok_or("this name is not known")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named<T: serde::Serialize>(choices: &[NamedChoice<T>]) -> bool {
        let is_named = |(name, value, _): &NamedChoice<T>| serde_json::json!(value) == *name;
        choices.iter().all(is_named)
    }

    #[test]
    fn names_are_those_of_scene_files() {
        assert!(named(&MODES) && named(&INTERPOLATIONS) && named(&LIGHT_MODES));
        assert!(named(&STRATEGIES) && named(&OCCLUSION_METHODS) && named(&UNITS));
        assert!(!named(&[("cells", Mode::Volume, "")]));
    }
}
