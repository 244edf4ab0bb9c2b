//! Every kind of surface, by every strategy, against the reference.

use super::*;

/// A view of some surfaces, and another choice of them that looks different.
struct Look {
    name: &'static str,
    shown: Surfaces,
    other: Surfaces,
    /// Azimuth, elevation, zoom.
    camera: [f64; 3],
    interpolation: Interpolation,
    cut: Option<CutFace>,
    change: fn(&mut Scene),
}

const LOOKS: [Look; 11] = [
    Look {
        name: "hull",
        shown: HULL,
        other: FAULTS,
        camera: [205.0, -35.0, 1.2],
        interpolation: Interpolation::Cell,
        cut: None,
        change: |scene| scene.filter.k = Some([2, 5].into()),
    },
    Look {
        name: "faults",
        shown: FAULTS,
        other: NONE,
        camera: [120.0, 20.0, 1.2],
        interpolation: Interpolation::Vertex,
        cut: None,
        change: |_| (),
    },
    Look {
        name: "both and edges",
        shown: edges(BOTH),
        other: edges(HULL),
        camera: [150.0, 40.0, 3.0],
        interpolation: Interpolation::Vertex,
        cut: None,
        change: |_| (),
    },
    Look {
        name: "hull and edges, cut open",
        shown: edges(HULL),
        other: HULL,
        camera: [150.0, 40.0, 3.0],
        interpolation: Interpolation::Vertex,
        cut: Some(CutFace::Open),
        change: |_| (),
    },
    Look {
        name: "faults and edges, a section",
        shown: edges(FAULTS),
        other: NONE,
        camera: [240.0, 25.0, 2.0],
        interpolation: Interpolation::Cell,
        cut: Some(CutFace::Opaque),
        change: |_| (),
    },
    Look {
        name: "hull among ghosts",
        shown: HULL,
        other: NONE,
        camera: [60.0, 15.0, 1.2],
        interpolation: Interpolation::Vertex,
        cut: None,
        change: |scene| scene.show.inactive = Inactive::Ghost,
    },
    Look {
        name: "hull and edges in parallel",
        shown: edges(HULL),
        other: HULL,
        camera: [150.0, 40.0, 3.0],
        interpolation: Interpolation::Vertex,
        cut: Some(CutFace::Opaque),
        change: parallel,
    },
    Look {
        name: "faint hull, cut open",
        shown: FAINT,
        other: NONE,
        camera: [150.0, 40.0, 1.2],
        interpolation: Interpolation::Vertex,
        cut: Some(CutFace::Open),
        change: |_| (),
    },
    Look {
        name: "faint hull and faults",
        shown: Surfaces {
            faults: true,
            ..FAINT
        },
        other: FAINT,
        camera: [120.0, 20.0, 1.2],
        interpolation: Interpolation::Cell,
        cut: None,
        change: |scene| scene.background = "#10141c".into(),
    },
    Look {
        name: "faint hull among ghosts in parallel",
        shown: FAINT,
        other: NONE,
        camera: [60.0, 15.0, 1.2],
        interpolation: Interpolation::Vertex,
        cut: None,
        change: |scene| {
            scene.show.inactive = Inactive::Ghost;
            parallel(scene);
        },
    },
    Look {
        name: "faults in parallel",
        shown: edges(FAULTS),
        other: NONE,
        camera: [120.0, 20.0, 1.2],
        interpolation: Interpolation::Cell,
        cut: None,
        change: parallel,
    },
];

/// The camera of a scene in parallel.
fn parallel(scene: &mut Scene) {
    if let CameraSpec::Framing(camera) = &mut scene.camera {
        camera.projection = Projection::Parallel;
    }
}

impl Look {
    fn view(&self, case: &Case) -> View {
        let [azimuth, elevation, zoom] = self.camera;
        let mut scene = Scene {
            size: [100, 75],
            camera: camera(azimuth, elevation, zoom),
            interpolation: self.interpolation,
            ..Scene::default()
        };
        (self.change)(&mut scene);
        if let Some(face) = self.cut {
            scene.clip = vec![cut(&view::resolve(&scene, case).unwrap(), face)];
        }
        with(&view::resolve(&scene, case).unwrap(), self.shown)
    }
}

#[test]
fn strategies_agree_with_the_reference() {
    let Some(gpu) = common::gpu() else { return };
    let mut models = vec![common::sample()];
    models.extend(common::data("editnnc/9_EDITNNC.EGRID"));
    for model in models {
        let case = load::open(&model).unwrap();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        for look in LOOKS {
            let view = look.view(&case);
            let truth = picture(&mut renderer, &case, &view, None);
            // The twin: what is shown otherwise.
            let other = picture(&mut renderer, &case, &with(&view, look.other), None);
            let other = psnr(&other, &truth, &view);
            for strategy in StrategyKind::ALL {
                let image = picture(&mut renderer, &case, &view, Some(strategy));
                let found = psnr(&image, &truth, &view);
                let what = format!(
                    "{} {} {}: {found:.1} dB, {other:.1} dB otherwise",
                    case.about.name,
                    look.name,
                    strategy.name()
                );
                println!("{what}");
                // A resampled grid blurs the samples between surfaces.
                let least = match strategy {
                    StrategyKind::Srg => 40.0,
                    _ => 55.0,
                };
                assert!(found > least && other + 8.0 < found, "{what}");
            }
        }
    }
}
#[test]
fn light_falls_on_surfaces_as_on_samples() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    // Nothing stands between the hull and the viewer, but much between it and a light.
    let low = LightSpec::Directional {
        direction: [1.0, 0.4, -0.2],
        half_angle_degrees: 3.0,
        intensity: None,
        color: "#ffd0a0".into(),
    };
    // Of the hull one point a ray is lit, among sheets each sample. Rays over cones are the truth but for
    // their random numbers; cones are not.
    for (mode, surfaces, size, least) in [
        (LightMode::Image, HULL, [40, 30], 33.0),
        (LightMode::Image, FAULTS, [12, 9], 40.0),
        (LightMode::MonteCarlo, HULL, [40, 30], 42.0),
    ] {
        let mut scene = Scene {
            size,
            camera: camera(205.0, 35.0, 1.2),
            ..Scene::default()
        };
        let dark = with(&view::resolve(&scene, &case).unwrap(), surfaces);
        scene.lighting = LightingSpec::preset("strong").unwrap();
        let occlusion = scene.lighting.occlusion.as_mut().unwrap();
        (occlusion.attenuation, occlusion.strength) = (0.8, 1.0);
        scene.lighting.occlusion.as_mut().unwrap().mode = mode;
        scene.lighting.shadows.mode = mode;
        // Rays start where cones do: what is compared is which points are lit.
        scene.lighting.rays_gap = scene.lighting.shadows.gap;
        scene.lighting.rays = 14;
        scene.lighting.lights = vec![low.clone()];
        let lit = with(&view::resolve(&scene, &case).unwrap(), surfaces);
        let truth = picture(&mut renderer, &case, &lit, None);
        let other = psnr(&picture(&mut renderer, &case, &dark, None), &truth, &lit);
        for strategy in StrategyKind::ALL {
            let image = picture(&mut renderer, &case, &lit, Some(strategy));
            let found = psnr(&image, &truth, &lit);
            let what = format!(
                "{mode:?} {surfaces:?} {}: {found:.1} dB, {other:.1} dB without light",
                strategy.name()
            );
            println!("{what}");
            assert!(found > least && other + 4.0 < found, "{what}");
        }
    }
}
