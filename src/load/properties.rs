//! Which properties the files of a case have, and which follow from them.

use strataray_parsers::cells::CellArrays;
use strataray_parsers::units::UnitSystem;

use super::source::FileSource;
use crate::case::{About, CONNECTIONS, Kind, POROSITY_THICKNESS, Property, SOIL};
use crate::model::derived::Derived;

/// All of them, file by file, then those that are computed. Why one is not goes into the notes.
pub fn of(source: &FileSource, has_connections: bool, about: &mut About) -> Vec<Property> {
    let units = source.units().or(match about.length_unit.as_str() {
        "FEET" => Some(UnitSystem::Field),
        "CM" => Some(UnitSystem::Lab),
        _ => Some(UnitSystem::Metric),
    });
    let unit = |name: &str| units.map_or("", |u| u.unit_of(name)).to_owned();
    let mut list: Vec<Property> = Vec::new();
    let mut add =
        |name: &str, kind: Kind, steps: usize| match list.iter_mut().find(|p| p.name == name) {
            Some(known) => known.steps = known.steps.max(steps),
            None => list.push(Property {
                name: name.to_owned(),
                kind,
                unit: unit(name),
                steps,
            }),
        };
    for property in source.deck.iter().flat_map(|d| &d.properties) {
        add(&property.name, Kind::Static, 0);
    }
    // Dynamic ones first claim their names: a property of both INIT and restart changes with time.
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for step in &source.steps {
        for entry in step.arrays.iter().filter(|e| source.is_property(e)) {
            match counts.iter_mut().find(|c| c.0 == entry.name()) {
                Some(count) => count.1 += 1,
                None => counts.push((entry.name(), 1)),
            }
        }
    }
    for entry in source
        .init
        .iter()
        .flat_map(CellArrays::iter)
        .filter(|e| source.is_property(e))
    {
        if !counts.iter().any(|c| c.0 == entry.name()) {
            add(entry.name(), Kind::Static, 0);
        }
    }
    for &(name, steps) in &counts {
        add(name, Kind::Dynamic, steps);
    }
    let has = |list: &[Property], name: &str| list.iter().any(|p| p.name == name);
    if !has(&list, SOIL) && has(&list, "SWAT") {
        let phases = source.steps.first().map_or(0, |s| s.head.phases);
        // Bit 1 oil: without oil there is no oil saturation to complete.
        if phases & 1 == 1 || phases == 0 {
            let steps = counts.iter().find(|c| c.0 == "SWAT").map_or(0, |c| c.1);
            list.push(Property {
                name: SOIL.into(),
                kind: Kind::Derived,
                unit: String::new(),
                steps,
            });
        } else {
            about
                .notes
                .push("SOIL is not derived: the case has no oil phase".into());
        }
    }
    if has(&list, "PORO") {
        list.push(Property {
            name: POROSITY_THICKNESS.into(),
            kind: Kind::Derived,
            unit: unit(POROSITY_THICKNESS),
            steps: 0,
        });
    }
    let connections = has_connections.then_some(CONNECTIONS);
    let derived = Derived::ALL.iter().map(|(name, _)| *name);
    for name in derived.chain(connections) {
        if !has(&list, name) {
            list.push(Property {
                name: name.into(),
                kind: Kind::Derived,
                unit: unit(name),
                steps: 0,
            });
        }
    }
    list
}
