//! Opaque hulls and solid cells in the light of the lamp beside the viewer.

use super::*;

/// What the lamp beside the viewer leaves of a color.
fn lamp(view: &View, ray: &reference::Ray, normal: DVec3) -> f64 {
    let [right, up] = HEADLIGHT_ASIDE;
    let to_lamp = right * view.camera.right + up * view.camera.up - ray.direction;
    let outward = -normal.dot(ray.direction).signum() * normal;
    let cosine = outward.dot(to_lamp) / (1.0 + right * right + up * up).sqrt();
    HEADLIGHT_AMBIENT + (1.0 - HEADLIGHT_AMBIENT) * cosine.max(0.0)
}

#[test]
fn the_hull_of_a_box_has_the_color_of_its_values_in_the_headlight() {
    let Some(gpu) = common::gpu() else { return };
    let case = one_box();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    for (exact_colors, surfaces) in [(false, HULL), (true, HULL), (false, CELLS)] {
        let mut scene = plain(camera(205.0, 35.0, 1.0), 0.3);
        scene.lighting.exact_colors = exact_colors;
        let view = view::resolve(&scene, &case).unwrap();
        let view = with(
            &view,
            Surfaces {
                cell_edges: false,
                ..surfaces
            },
        );
        let [color, other] = [0.5, 0.51].map(|at| DVec3::from_array(view.color_at(at)));
        let truth = picture(&mut renderer, &case, &view, None);
        for by in all() {
            let image = picture(&mut renderer, &case, &view, by);
            let (mut covered, mut wrong, mut unlit) = (0, 0, 0);
            for (n, (found, expected)) in (0..).zip(image.pixels.iter().zip(&truth.pixels)) {
                let [r, g, b, alpha] = found.map(f64::from);
                assert!(alpha == 0.0 || alpha == 1.0, "{by:?}: {alpha}");
                if alpha == 0.0 || expected[3] == 0.0 {
                    wrong += u32::from(found[3] != expected[3]);
                    continue;
                }
                let ray = reference::Ray::through_pixel(&view, n % 80, n / 80);
                let normal = DVec3::AXES[entered(view.world_bounds, &ray)];
                let lamp = if exact_colors {
                    1.0
                } else {
                    lamp(&view, &ray, normal)
                };
                let error = |color: DVec3| (DVec3::new(r, g, b) - color).abs().max_element();
                covered += 1;
                wrong += u32::from(error(lamp * color) > 1e-5);
                // The twins: the color of the next value, and that of no light.
                assert!(error(lamp * other) > 1e-3);
                unlit += u32::from(error(color) < 1e-3);
            }
            let what = format!("{by:?}: {wrong} of {covered}, {unlit} without light");
            // At an edge a pixel may see the other face.
            assert!(covered > 800 && wrong < 6, "{what}");
            assert!(
                if exact_colors {
                    unlit == covered
                } else {
                    unlit < 4
                },
                "{what}"
            );
        }
    }
}
#[test]
fn values_are_read_off_faces_and_shapes_off_their_light() {
    let Some(gpu) = common::gpu() else { return };
    let [up, side] = [camera(0.0, 90.0, 1.0), camera(225.0, 35.0, 0.3)];
    for value in [0.05, 0.3, 0.5, 0.7, 0.95] {
        let case = boxes(&[0.0, 100.0], &[0.0, 100.0], &[1000.0, 1080.0], &|_| value);
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        let mut scene = plain(up.clone(), 0.3);
        scene.mode = Mode::Cells;
        scene.range = RangeSpec::Fixed([0.0, 1.0]);
        let mut colors = |camera: &CameraSpec| {
            scene.camera = camera.clone();
            let view = view::resolve(&scene, &case).unwrap();
            let image = picture(&mut renderer, &case, &view, Some(StrategyKind::Plts));
            (view.clone(), image.over_background_8bit(view.background))
        };
        // Straight from above, the legend's color.
        let (view, pixels) = colors(&up);
        let legend = srgb(view.transfer.srgb(value));
        let middle = pixels[30 * 80 + 40];
        let off = ciede2000_map(&[middle], &[legend]).unwrap()[0];
        println!("{value}: {off:.2} from the legend");
        assert!(off < 3.0, "{value}: {off}");
        // From the side, where a lamp at the viewer would make both walls and the roof all but alike.
        let (view, pixels) = colors(&side);
        let mut faces: [Vec<[u8; 3]>; 3] = Default::default();
        for (n, pixel) in (0..).zip(&pixels) {
            let ray = reference::Ray::through_pixel(&view, n % 80, n / 80);
            if *pixel != [255; 3] {
                faces[entered(view.world_bounds, &ray)].push(*pixel);
            }
        }
        // The first and last pixels of a face may lie on its edges.
        let faces = faces.map(|pixels| pixels[pixels.len() / 2]);
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            let apart = ciede2000_map(&[faces[a]], &[faces[b]]).unwrap()[0];
            println!("{value}: faces {a} and {b} are {apart:.1} apart");
            assert!(apart > 3.0, "{value}: {a} {b} {apart}");
        }
    }
}

#[test]
fn cells_agree_with_the_reference() {
    let Some(gpu) = common::gpu() else { return };
    let mut models = vec![common::sample()];
    models.extend(common::data("reek/REEK.EGRID"));
    for model in models {
        let case = load::open(&model).unwrap();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        for (inactive, is_cut, faults) in [
            (Inactive::Hidden, false, false),
            (Inactive::Hidden, true, true),
            (Inactive::Ghost, true, false),
        ] {
            let mut scene = Scene {
                size: [100, 75],
                camera: camera(150.0, 30.0, 1.5),
                mode: Mode::Cells,
                ..Scene::default()
            };
            scene.show.inactive = inactive;
            scene.show.faults = faults.into();
            if is_cut {
                scene.clip = vec![cut(&view::resolve(&scene, &case).unwrap(), CutFace::Open)];
            }
            let view = view::resolve(&scene, &case).unwrap();
            let truth = picture(&mut renderer, &case, &view, None);
            // The twins: without the headlight, and without edges.
            let mut dark = view.clone();
            dark.lighting.exact_colors = true;
            let plain = Surfaces {
                cell_edges: false,
                ..view.surfaces
            };
            let others = [dark, with(&view, plain)]
                .map(|other| psnr(&picture(&mut renderer, &case, &other, None), &truth, &view));
            for strategy in StrategyKind::ALL {
                let found = picture(&mut renderer, &case, &view, Some(strategy));
                let found = psnr(&found, &truth, &view);
                let what = format!(
                    "{} {inactive:?} {} {}: {found:.1} dB, {others:.1?} dB otherwise",
                    case.about.name,
                    if is_cut { "cut" } else { "whole" },
                    strategy.name()
                );
                println!("{what}");
                let least = if inactive == Inactive::Ghost && strategy == StrategyKind::Srg {
                    40.0
                } else {
                    50.0
                };
                assert!(
                    found > least && others.iter().all(|o| o + 6.0 < found),
                    "{what}"
                );
            }
        }
    }
}

#[test]
fn cells_are_solid_whatever_the_opacity_and_cast_no_ray() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let scene = |opacity: f64, mode: Mode| {
        let mut scene = Scene {
            size: [40, 30],
            mode,
            ..Scene::default()
        };
        scene.transfer.opacity = Some(OpacitySpec::Points(vec![[0.0, opacity], [1.0, opacity]]));
        scene
    };
    for strategy in StrategyKind::ALL {
        let mut made = |scene: &Scene| {
            let view = View {
                strategy,
                ..view::resolve(scene, &case).unwrap()
            };
            renderer.render(&view, &|_| true).unwrap()
        };
        let [faint, solid] = [0.0, 0.9].map(|opacity| made(&scene(opacity, Mode::Cells)));
        assert_eq!(faint.image, solid.image, "{}", strategy.name());
        assert_eq!(faint.stats.samples, 0);
        // The twin: the volume depends on it.
        let [faint, solid] = [0.0, 0.9].map(|opacity| made(&scene(opacity, Mode::Volume)));
        assert!(faint.image != solid.image && solid.stats.samples > 0);
    }
}
