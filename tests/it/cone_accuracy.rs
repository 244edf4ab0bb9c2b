//! How far cones are from the integral over a cone: even media, edges, slabs, oblique surfaces. With
//! `--nocapture` each test prints its table.

use crate::common::cone::{Filled, Light, Model};
use glam::DVec3;
use serde_json::json;

/// Extinction of an opacity of one.
const OPAQUE: f64 = 13.815_510_557_964_274;
/// An eye so far above the middle that all cones point up.
const ABOVE: DVec3 = DVec3::new(24.0, 24.0, 1e5);

/// Occlusion as published, and by sections that count as in an even medium.
fn both(
    model: &mut Model,
    [degrees, length]: [f64; 2],
    splits: u32,
    eye: DVec3,
    light_size: [u32; 3],
) -> [Light; 2] {
    [false, true].map(|even_media| {
        let occlusion = json!({
            "half_angle_degrees": degrees, "splits": splits, "even_media": even_media,
        });
        model.light(&occlusion, length, eye, light_size)
    })
}

#[test]
fn an_even_medium_is_too_light_unless_told() {
    // Cones go up from the middle, 44 deep of 56: nothing of the border is in their sections.
    let (x, z) = ([0.0, 64.0], [0.0, 56.0]);
    let Some(mut model) = Model::new([&x, &x, &z], &|_| 0.0, [0.05, 0.05]) else {
        return;
    };
    let eye = DVec3::new(32.0, 32.0, 1e5);
    let exact = 0.95f64.powf(18.0 - 3.0);
    println!("| half angle | parts | exact | as published | even media |");
    for degrees in [10.0, 20.0, 30.0] {
        for splits in [1, 3, 7] {
            let lights = both(&mut model, [degrees, 18.0], splits, eye, [3, 3, 7]);
            let [published, even] = lights.map(|light| light.block.at([1, 1, 5]));
            println!("| {degrees} | {splits} | {exact:.4} | {published:.4} | {even:.4} |");
            assert!((even - exact).abs() < 0.002, "{even}");
            assert!(published > exact + 0.05, "{published}");
        }
    }
}

/// Cones of 20 degrees that look up, side by side across what stands above them: where they are from the
/// middle, by rays, as published, and as in an even medium.
fn across(model: &mut Model, length: f64, splits: u32, boxes: &[Filled]) -> Vec<[f64; 4]> {
    let [published, even] = both(model, [20.0, length], splits, ABOVE, [23, 3, 5]);
    let row = |x| {
        let voxel = [x, 1, 3];
        let (off, exact) = (
            published.way(voxel).0.x - 24.0,
            published.by_rays(voxel, boxes),
        );
        [off, exact, published.block.at(voxel), even.block.at(voxel)]
    };
    // Nearer to the border rays pass the box's side.
    (3..20).map(row).collect()
}

/// Prints rows, and gives root mean square differences to the integral: as published, as in an even medium,
/// and of the twin, for which the integral is that of a cone 12 voxels away.
fn spread(splits: u32, rows: &[[f64; 4]]) -> [f64; 3] {
    for [off, exact, published, even] in rows {
        println!("| {splits} | {off:.1} | {exact:.4} | {published:.4} | {even:.4} |");
    }
    let rms = |of: &dyn Fn(usize) -> f64| {
        let squares = (0..rows.len()).map(|n| of(n).powi(2));
        (squares.sum::<f64>() / rows.len() as f64).sqrt()
    };
    let away = |n: usize| rows[(n + 6) % rows.len()][1];
    let found = [
        rms(&|n| rows[n][2] - rows[n][1]),
        rms(&|n| rows[n][3] - rows[n][1]),
        rms(&|n| rows[n][2] - away(n)),
    ];
    let [published, even, twin] = found;
    println!("| {splits} | rms | | {published:.4} | {even:.4} | (twin {twin:.4})");
    found
}

#[test]
fn half_of_a_cone_behind_an_edge_is_dark() {
    let (x, y, z) = ([0.0, 24.0, 48.0], [0.0, 48.0], [0.0, 8.0, 12.0, 40.0]);
    let opaque = |[i, _, k]: [usize; 3]| f64::from(u8::from(i == 0 && k == 1));
    let Some(mut model) = Model::new([&x, &y, &z], &opaque, [0.0, 1.0]) else {
        return;
    };
    let (low, high) = (DVec3::new(0.0, 0.0, 8.0), DVec3::new(24.0, 48.0, 12.0));
    let wall = [Filled(low, high, OPAQUE)];
    println!("| parts | from the edge | exact | as published | even media |");
    for (splits, dark, edge, most) in [
        (1, 0.07, 0.32, 0.2),
        (3, 0.02, 0.21, 0.1),
        (7, 0.03, 0.15, 0.1),
    ] {
        let rows = across(&mut model, 35.0, splits, &wall);
        let [published, _, twin] = spread(splits, &rows);
        assert!(published < most && twin > 2.0 * most, "{splits}");
        let [behind, middle, beside] = [3, 8, 14].map(|n| rows[n]);
        assert!(behind[1] < 1e-3 && behind[2] < dark, "{splits}");
        assert!(
            (middle[1] - 0.5).abs() < 0.01 && (middle[2] - 0.5).abs() < edge,
            "{splits}"
        );
        assert!(beside[1] > 0.999 && beside[2] > 0.9, "{splits}");
    }
    // The last section counts half: a wall near a cone's end lets light through that should not be there.
    println!("| parts | length | behind the wall, as published | even media |");
    for splits in [1, 3, 7] {
        for length in [22.0, 24.0, 26.0, 28.0, 31.0, 35.0, 40.0] {
            let rows = across(&mut model, length, splits, &wall);
            let [_, _, published, even] = rows[3];
            println!("| {splits} | {length} | {published:.4} | {even:.4} |");
            let is_well_within = length > 30.0;
            assert!(published < if is_well_within { 0.05 } else { 0.5 });
            assert!(is_well_within || length > 25.0 || published > 0.08);
        }
    }
}

#[test]
fn a_slab_beside_the_axis_hides_a_part() {
    let (x, y, z) = ([0.0, 20.0, 24.0, 48.0], [0.0, 48.0], [0.0, 40.0]);
    let slab = |[i, _, _]: [usize; 3]| f64::from(u8::from(i == 1));
    let (low, high) = (DVec3::new(20.0, 0.0, 0.0), DVec3::new(24.0, 48.0, 40.0));
    for (opacity, extinction, most) in [(0.2, -(0.8f64.ln()), 0.1), (1.0, OPAQUE, 0.27)] {
        let Some(mut model) = Model::new([&x, &y, &z], &slab, [0.0, opacity]) else {
            return;
        };
        let slab = [Filled(low, high, extinction)];
        println!(
            "| parts | from the side | exact, opacity {opacity} | as published | even media |"
        );
        for splits in [1, 3, 7] {
            let rows = across(&mut model, 28.0, splits, &slab);
            let [published, _, twin] = spread(splits, &rows);
            assert!(published < most && twin > 1.5 * most, "{splits} {opacity}");
        }
    }
}

#[test]
fn a_surface_oblique_to_the_axis_is_too_dark() {
    let (x, y, z) = ([0.0, 80.0], [0.0, 64.0], [0.0, 20.0, 40.0]);
    let Some(mut model) = Model::new([&x, &y, &z], &|[_, _, k]| k as f64, [0.0, 1.0]) else {
        return;
    };
    let (low, high) = (DVec3::new(-1e4, -1e4, 20.0), DVec3::splat(1e4));
    let ground = [Filled(low, high, OPAQUE)];
    println!("| elevation | parts | above the ground | exact | as published | even media |");
    for elevation in [90.0, 60.0, 45.0, 30.0, 20.0, 10.0f64] {
        for (splits, most) in [(1, 0.8), (3, 0.62), (7, 0.58)] {
            let (sine, cosine) = elevation.to_radians().sin_cos();
            let eye = DVec3::new(13.3 + 1e5 * cosine, 32.0, -20.0 + 1e5 * sine);
            let lights = both(&mut model, [20.0, 28.0], splits, eye, [3, 3, 40]);
            for (layer, above) in [(19, 0.5), (18, 1.5), (17, 2.5), (15, 4.5)] {
                let voxel = [0, 1, layer];
                let exact = lights[0].by_rays(voxel, &ground);
                let [published, even] = [0, 1].map(|n: usize| lights[n].block.at(voxel));
                println!(
                    "| {elevation} | {splits} | {above} | {exact:.4} | {published:.4} | {even:.4} |"
                );
                let missing = exact - published;
                assert!(
                    missing > -0.002 && missing < most,
                    "{elevation} {splits} {above}"
                );
                // Steep, or well above the ground, little is missing; the twin: the other way, much.
                let is_easy = splits == 7 && (elevation > 40.0 || above > 4.0);
                assert!(!is_easy || missing < 0.05, "{elevation} {above}");
                let is_hard = elevation < 15.0 && above < 1.0;
                assert!(!is_hard || missing > 0.3, "{elevation} {above}");
            }
        }
    }
}
