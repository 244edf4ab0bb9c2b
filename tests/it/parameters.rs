//! Parameters of shaders as uniforms, which is the way of GPUs, and as storage, which is that of software: one picture.

use std::process::Command;
use std::sync::Arc;

use crate::common;
use crate::common::light::lighting;
use serde_json::json;
use strataray::case::load;
use strataray::image::Image;
use strataray::render::Renderer;
use strataray::render::gpu::bind_groups::Parameters;
use strataray::render::gpu::device::PARAMETERS;
use strataray::render::gpu::{Gpu, GpuRenderer};
use strataray::scene::{LightingSpec, Scene, SrgSettings, StrategyKind};
use strataray::view;

/// As small as shows all: where they are uniforms, llvmpipe compiles a compute shader anew at each dispatch.
const SIZE: [u32; 2] = [32, 24];

/// Largest difference of two pictures' numbers.
fn apart(a: &Image, b: &Image) -> f32 {
    let pairs = a.pixels.as_flattened().iter().zip(b.pixels.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn both_ways_make_the_same_pictures() {
    if common::gpu().is_none() {
        return;
    }
    let case = load::open(&common::sample()).unwrap();
    let scene = Scene {
        size: SIZE,
        lighting: lighting(json!({
            "occlusion": {"mode": "preilluminated"},
            "lights": [{"kind": "directional", "direction": [1, 1, -2]}],
            "volume": {"size": [4, 4, 2], "light_size": [4, 4, 2]},
        })),
        srg: SrgSettings {
            factor: Some(1.0),
            ..SrgSettings::default()
        },
        ..Scene::default()
    };
    let lit = view::resolve(&scene, &case).unwrap();
    let dark = Scene {
        lighting: LightingSpec::default(),
        ..scene
    };
    let dark = view::resolve(&dark, &case).unwrap();
    let pictures = [Parameters::Uniform, Parameters::Storage].map(|parameters| {
        let gpu = Arc::new(Gpu::with_parameters(None, parameters).unwrap());
        assert_eq!(gpu.layouts.parameters(), parameters);
        let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
        StrategyKind::ALL.map(|strategy| {
            let view = lit.by(strategy);
            renderer.render(&view, &|_| true).unwrap().image
        })
    });
    let mut renderer = GpuRenderer::new(common::gpu().unwrap(), &case.grid).unwrap();
    for (n, strategy) in StrategyKind::ALL.into_iter().enumerate() {
        let view = dark.by(strategy);
        let [uniform, storage] = pictures.each_ref().map(|all| &all[n]);
        let unlit = renderer.render(&view, &|_| true).unwrap().image;
        let found = [storage, &unlit].map(|other| apart(uniform, other));
        println!("{}: {found:?}", strategy.name());
        // 1e-5 of 1 is 100 dB in the worst pixel. The twin, no light, is a hundred times farther.
        assert!(found[0] <= 1e-5 && found[1] > 1e-3, "{found:?}");
    }
}

#[test]
fn the_variable_decides() {
    let Some(gpu) = common::gpu() else { return };
    if let Ok(name) = std::env::var(PARAMETERS) {
        // In the programs that are begun below.
        assert_eq!(Some(gpu.layouts.parameters()), Parameters::named(&name));
        return;
    }
    let with = |name: &str| {
        let mut tests = Command::new(std::env::current_exe().unwrap());
        tests
            .args(["--exact", "parameters::the_variable_decides"])
            .envs([(PARAMETERS, name), ("REQUIRE_GPU", "1")]);
        let output = tests.output().unwrap();
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(said.contains("running 1 test"), "{said}");
        (output.status.success(), said)
    };
    assert!(with("uniform").0 && with("storage").0);
    let (passed, said) = with("texture");
    let words = "STRATARAY_PARAMETERS is texture, but can only be uniform or storage";
    assert!(!passed && said.contains(words), "{said}");
}
