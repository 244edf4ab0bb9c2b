//! Picture metrics against figures of other programs.

use std::path::Path;

use crate::common;
use strataray::image::Rgb8;
use strataray::image::metrics::{Comparison, ciede2000};

fn picture(path: &Path) -> Rgb8 {
    let read = image::open(path).unwrap().into_rgb8();
    Rgb8 {
        size: [read.width(), read.height()],
        pixels: read.pixels().map(|p| p.0).collect(),
    }
}

/// What a pair's figures are off by: PSNR, SSIM, mean and 99th percentile of CIEDE2000.
fn deviations(found: Comparison, pair: &serde_json::Value) -> [f64; 4] {
    let figures = [
        ("psnr_db", found.psnr_db),
        ("ssim_luma", found.ssim),
        ("ciede2000_mean", found.ciede2000_mean),
        ("ciede2000_p99", found.ciede2000_p99),
    ];
    figures.map(|(name, found)| match pair[name].as_f64() {
        Some(expected) => (found - expected).abs(),
        // JSON has null for infinite.
        None if pair[name].is_null() && found == f64::INFINITY => 0.0,
        None => f64::INFINITY,
    })
}

#[test]
fn figures_are_those_of_scikit_image() {
    let path = common::bundled("metrics/metrics.json");
    let text = std::fs::read_to_string(&path).unwrap();
    let expected: serde_json::Value = serde_json::from_str(&text).unwrap();
    let pairs = expected["pairs"].as_array().unwrap();
    assert!(pairs.len() >= 5);
    // CIEDE2000 differs by up to 5e-6 of itself for mean hues beyond 360 degrees.
    let agree = |off: [f64; 4]| off[0] < 1e-11 && off[1] < 1e-11 && off[2] < 1e-6 && off[3] < 2e-5;
    for (n, pair) in pairs.iter().enumerate() {
        let file = |which: &str| path.with_file_name(pair[which].as_str().unwrap());
        let [a, b] = ["a", "b"].map(|which| picture(&file(which)));
        let found = Comparison::of(&a, &b).unwrap();
        let off = deviations(found, pair);
        println!("{}: {found:?}, off by {off:?}", pair["b"]);
        assert!(agree(off), "{pair}: {found:?}");
        for other in pairs.iter().enumerate().filter(|o| o.0 != n) {
            assert!(!agree(deviations(found, other.1)), "{pair} {other:?}");
        }
    }
}

#[test]
fn ciede2000_is_that_of_the_published_pairs() {
    let text = std::fs::read_to_string(common::bundled("metrics/ciede2000_pairs.csv")).unwrap();
    let pairs: Vec<[f64; 7]> = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| {
            let numbers: Vec<f64> = line.split(',').map(|n| n.parse().unwrap()).collect();
            numbers.try_into().unwrap()
        })
        .collect();
    assert_eq!(pairs.len(), 34);
    let mut worst = 0f64;
    for pair @ [l1, a1, b1, l2, a2, b2, expected] in pairs {
        let (a, b) = ([l1, a1, b1], [l2, a2, b2]);
        for found in [ciede2000(a, b), ciede2000(b, a)] {
            worst = worst.max((found - expected).abs());
            assert!((found - expected).abs() < 1e-4, "{pair:?}: {found}");
        }
        // A twin that must fail.
        let moved = ciede2000([l1 + 0.1, a1, b1], b);
        assert!((moved - expected).abs() > 1e-4, "{pair:?}: {moved}");
    }
    println!("largest deviation {worst:.1e}");
}
