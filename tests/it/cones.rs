//! Cones through the pyramid: their tables, and what the device makes of them.

use crate::common;
use crate::common::cone::{Model, Traced};
use glam::DVec3;
use serde_json::json;
use strataray::render::plan::cones::ConeTable;

/// Half floats of transmittances, and the optical depth behind which cones end.
const HALVES: f64 = 0.0008;

/// A table of another program: half angle in degrees, splits, length; and distance, sigma, level, parts, radius,
/// amplitude and weight of each section.
type Table = ([f64; 3], Vec<[f64; 7]>);

fn tables() -> Vec<Table> {
    let text = std::fs::read_to_string(common::bundled("metrics/cone_tables.csv")).unwrap();
    let mut tables: Vec<Table> = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let numbers: Vec<f64> = line.split(',').map(|n| n.parse().unwrap()).collect();
        let (head, section) = numbers.split_at(3);
        let (head, section) = (head.try_into().unwrap(), section.try_into().unwrap());
        match tables.last_mut() {
            Some((last, sections)) if *last == head => sections.push(section),
            _ => tables.push((head, vec![section])),
        }
    }
    tables
}

#[test]
fn tables_are_those_of_another_program() {
    let tables = tables();
    assert_eq!(tables.len(), 12);
    let apart = |([angle, _, length], expected): &Table, splits: f64| -> f64 {
        let table = ConeTable::new(angle.to_radians(), splits as u32, 3.0, *length);
        if table.sections.len() != expected.len() {
            return f64::INFINITY;
        }
        let found = table.sections.iter().map(|s| {
            let [level, parts] = [s.level, s.parts].map(f64::from);
            [
                s.distance,
                s.sigma,
                level,
                parts,
                s.radius,
                s.amplitude,
                s.weight,
            ]
        });
        let pairs = found.flatten().zip(expected.as_flattened());
        pairs.map(|(f, e)| (f - e).abs()).fold(0.0, f64::max)
    };
    let mut twins = 0;
    for table in &tables {
        let [_, splits, _] = table.0;
        let error = apart(table, splits);
        assert!(error < 1e-9, "{splits}: {error}");
        twins += u32::from(apart(table, if splits == 1.0 { 3.0 } else { 1.0 }) > 0.01);
    }
    // A cone of one degree is never split.
    assert_eq!(twins, 9);
}

/// A number from 0 to 1 by a cell's place.
fn chance([i, j, k]: [usize; 3]) -> f64 {
    fastrand::Rng::with_seed((i + 101 * j + 10_007 * k) as u64).f64()
}

fn planes(count: u32, edge: f64) -> Vec<f64> {
    (0..=count).map(|n| edge * f64::from(n)).collect()
}

#[test]
fn the_device_adds_sections_as_defined() {
    let [x, y, z] = [planes(11, 3.0), planes(13, 2.0), planes(6, 4.0)];
    let Some(mut model) = Model::new([&x, &y, &z], &chance, [0.0, 0.12]) else {
        return;
    };
    let mut done = 0;
    for (degrees, splits, length, even) in [
        (25.0, 7, 30.0, false),
        (25.0, 3, 30.0, true),
        (12.0, 1, 45.0, false),
        (2.0, 7, 20.0, false),
        (44.0, 7, 45.0, false),
    ] {
        for eye in [[9e3, 4e3, 7e3], [-40.0, 20.0, 11.0], [16.0, 13.0, -9.0]] {
            let occlusion =
                json!({"half_angle_degrees": degrees, "splits": splits, "even_media": even});
            let light = model.light(&occlusion, length, DVec3::from_array(eye), [7, 6, 5]);
            let error = |turned: bool| {
                let traced = Traced {
                    levels: &light.pyramid,
                    size: light.space.size(),
                    table: ConeTable::of(&light.cone, light.space.sigma),
                    tangent: light.cone.half_angle.tan(),
                };
                let apart = light.block.voxels().map(|voxel| {
                    let (p, axis, reach) = light.way(voxel);
                    // The twin looks askew.
                    let axis = if turned {
                        (axis + 0.1).normalize()
                    } else {
                        axis
                    };
                    (light.block.at(voxel) - traced.transmittance(p, axis, reach)).abs()
                });
                apart.fold(0.0, f64::max)
            };
            let [error, twin] = [false, true].map(error);
            println!("{degrees} degrees, {splits} parts, eye {eye:?}: {error:.5}, twin {twin:.4}");
            assert!(error < HALVES && twin > 10.0 * HALVES, "{error} {twin}");
            done += 1;
        }
    }
    assert_eq!(done, 15);
}
