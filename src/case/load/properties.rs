//! Which properties the files of a case have, and which follow from them.

use strataray_parsers::arrays::is_state;
use strataray_parsers::cells::CellArrays;
use strataray_parsers::units::{LengthUnit, UnitSystem};

use super::resqml::PackageValues;
use super::source::FileSource;
use super::volume::VolumeValues;
use crate::case::pores::Pores;
use crate::case::{About, CONNECTIONS, Kind, POROSITY_THICKNESS, Property};
use crate::model::derived::{Derived, rest_of_saturations};

/// What properties depend on beside the arrays.
pub struct Setting {
    /// Units of the files' arrays.
    pub units: UnitSystem,
    /// Length unit of the grid, that of what is computed from it.
    pub length: LengthUnit,
    /// Phases as INTEHEAD numbers them; 0 where unknown.
    pub phases: i32,
    /// Unit of the vertical axis where it is time.
    pub time: Option<String>,
    /// True where the case has connections between cells that are no neighbors.
    pub has_connections: bool,
}

/// All of them, file by file, then those that are computed. Why one is not goes into the notes.
pub fn of(source: &FileSource, setting: &Setting, about: &mut About) -> Vec<Property> {
    let unit = |name: &str| setting.units.unit_of(name);
    let mut list: Vec<Property> = Vec::new();
    for property in &source.texts {
        if source.changes(&property.name) {
            about.notes.push(format!(
                "{} of the deck is not shown: the restart has it for every step",
                property.name
            ));
            continue;
        }
        list.push(Property {
            doubt: property.doubt.clone(),
            ..Property::new(&property.name, Kind::Static, unit(&property.name))
        });
    }
    let package = source.package.iter().flat_map(PackageValues::properties);
    let volumes = source.volumes.iter().map(VolumeValues::property);
    let stored = package.chain(volumes);
    list.extend(stored.filter(|p| !source.texts.iter().any(|t| t.name == p.name)));
    // Dynamic ones first claim their names: a property of both INIT and restart changes with time.
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for step in &source.steps {
        for entry in source.properties_of(&step.arrays) {
            match counts.iter_mut().find(|c| c.0 == entry.name()) {
                Some(count) => count.1 += 1,
                None => counts.push((entry.name(), 1)),
            }
        }
    }
    let has = |list: &[Property], name: &str| list.iter().any(|p| p.name == name);
    let init = source.init.iter().flat_map(CellArrays::iter);
    let (mut of_steps, mut of_texts) = (Vec::new(), Vec::new());
    for entry in init.filter(|e| source.is_property(e)) {
        let name = entry.name();
        if counts.iter().any(|c| c.0 == name) {
            of_steps.push(name);
        } else if source.texts.iter().any(|text| text.name == name) {
            of_texts.push(name);
        } else if !has(&list, name) {
            list.push(Property::new(name, Kind::Static, unit(name)));
        }
    }
    note_hidden(&of_steps, "the restart has it for every step", about);
    note_hidden(&of_texts, "the values of the text file are shown", about);
    for &(name, steps) in &counts {
        list.push(Property {
            steps,
            ..Property::new(name, Kind::Dynamic, unit(name))
        });
    }
    list.extend(saturation(setting.phases, &list));
    list.extend(of_fractures(source, &list));
    if has(&list, "PORO") {
        let unit = setting.length.short();
        list.push(Property::new(POROSITY_THICKNESS, Kind::Derived, unit));
    }
    let connections = setting.has_connections.then_some((CONNECTIONS, ""));
    let [down, volume] = match &setting.time {
        Some(time) => [time.as_str(), ""],
        None => [setting.length.short(), setting.length.volume()],
    };
    let derived = Derived::ALL.iter().map(|(name, derived)| match derived {
        Derived::Depth | Derived::Thickness => (*name, down),
        Derived::Volume => (*name, volume),
        _ => (*name, ""),
    });
    for (name, unit) in derived.chain(connections) {
        if !has(&list, name) {
            list.push(Property::new(name, Kind::Derived, unit));
        }
    }
    list
}

/// Says which arrays of INIT are not shown.
fn note_hidden(names: &[&str], why: &str, about: &mut About) {
    if !names.is_empty() {
        let names = names.join(", ");
        let note = format!("{names} of the INIT file is not shown: {why}");
        about.notes.push(note);
    }
}

/// Properties of fractures, and of matrix and fractures together those of the state, where there are any.
fn of_fractures(source: &FileSource, list: &[Property]) -> Vec<Property> {
    let has = |name: &str| source.has_fractures(name);
    let has_volumes = has("PORV");
    let twins = list.iter().flat_map(|property| {
        let is_there = match property.rest_of[..] {
            [] => has(&property.name),
            _ => property.rest_of.iter().all(|name| has(name)),
        };
        let fracture = is_there.then(|| Pores::Fracture.twin(property));
        let is_state = property.steps > 0 || is_state(&property.name);
        let is_total = is_there && has_volumes && is_state;
        fracture
            .into_iter()
            .chain(is_total.then(|| Pores::Total.twin(property)))
    });
    twins.collect()
}

/// The saturation that the files leave out and that follows from those they have.
fn saturation(phases: i32, list: &[Property]) -> Option<Property> {
    let known = |name: &str| list.iter().find(|p| p.name == name);
    let rest = rest_of_saturations(phases, |name| known(name).is_some())?;
    let steps = rest
        .of
        .iter()
        .filter_map(|name| known(name))
        .map(|p| p.steps);
    Some(Property {
        steps: steps.max().unwrap_or(0),
        rest_of: rest.of.iter().map(|name| (*name).to_owned()).collect(),
        doubt: rest
            .lacks
            .map(|lacks| format!("{lacks} is not in the files, so any gas counts as oil")),
        ..Property::new(rest.name, Kind::Derived, "")
    })
}
