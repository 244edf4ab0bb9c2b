//! Hull, fault sheets and edges of cells, by every strategy: against the reference and against formulas.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic, reason = "tests")]

mod common;

use common::shape::{Shape, boxes};
use glam::DVec3;
use strataray::case::Case;
use strataray::metrics::ciede2000_map;
use strataray::metrics::psnr_8bit;
use strataray::picture::Image;
use strataray::renderer::Renderer;
use strataray::scene::lighting::LightSpec;
use strataray::scene::surfaces::{
    EDGE_DARKNESS, EDGE_WIDTH, HEADLIGHT_AMBIENT, HEADLIGHT_ASIDE, PALETTE, SHEET_OPACITY, UNNAMED,
};
use strataray::scene::{
    self, CameraSpec, ClipSpec, CutFace, FramingCamera, Hull, Inactive, Interpolation, LightMode,
    LightingSpec, Mode, OpacitySpec, Projection, RangeSpec, Scene, Surfaces, View,
};
use strataray::strategies::StrategyKind;
use strataray::{load, reference};

const NONE: Surfaces = Surfaces {
    hull: Hull::Hidden,
    faults: false,
    cell_edges: false,
    solid: false,
};
const HULL: Surfaces = Surfaces {
    hull: Hull::Opaque,
    ..NONE
};
const FAULTS: Surfaces = Surfaces {
    faults: true,
    ..NONE
};
/// What the mode `cells` shows.
const CELLS: Surfaces = Surfaces {
    solid: true,
    cell_edges: true,
    ..HULL
};

fn camera(azimuth_degrees: f64, elevation_degrees: f64, zoom: f64) -> CameraSpec {
    CameraSpec::Framing(FramingCamera {
        azimuth_degrees,
        elevation_degrees,
        zoom,
        projection: Projection::Perspective,
    })
}

/// The picture by a strategy, or by the reference where there is none.
fn picture(renderer: &mut Renderer, case: &Case, view: &View, by: Option<StrategyKind>) -> Image {
    let Some(strategy) = by else {
        return reference::render(&case.grid, view, &|_| true).unwrap();
    };
    let view = View {
        strategy,
        ..view.clone()
    };
    let frame = renderer.render(&case.grid, &view, &|_| true).unwrap();
    let frame = frame.unwrap();
    assert_eq!(frame.stats.lost_rays, 0);
    frame.image
}

fn all() -> impl Iterator<Item = Option<StrategyKind>> {
    StrategyKind::ALL.into_iter().map(Some).chain([None])
}

fn with(view: &View, surfaces: Surfaces) -> View {
    View {
        surfaces,
        ..view.clone()
    }
}

/// PSNR in dB without the worst of a thousand pixels: at an outline a pixel may see another face, and one
/// pixel makes as much of it as all others.
fn psnr(a: &Image, b: &Image, view: &View) -> f64 {
    let [a, b] = [a, b].map(|i| i.over_background_8bit(view.background));
    let mut pairs: Vec<_> = a.into_iter().zip(b).collect();
    let error = |(a, b): &([u8; 3], [u8; 3])| (0..3).map(|c| a[c].abs_diff(b[c])).max();
    pairs.sort_by_key(error);
    pairs.truncate(pairs.len() - pairs.len().div_ceil(1000));
    let (a, b): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
    psnr_8bit(a.as_flattened(), b.as_flattened())
}

fn pixel(image: &Image, x: u32, y: u32) -> [f64; 4] {
    image.pixels[(x + image.size[0] * y) as usize].map(f64::from)
}

fn blended(view: &View, srgb: [f64; 3]) -> DVec3 {
    DVec3::from_array(view.blending.of_srgb(srgb))
}

/// A scene of test grids: nothing ends a ray early.
fn plain(camera: CameraSpec, opacity: f64) -> Scene {
    let mut scene = Scene {
        size: [80, 60],
        camera,
        property: Some("VALUE".into()),
        range: RangeSpec::Fixed([0.0, 1.0]),
        vertical_exaggeration: Some(1.0),
        sampling_step: Some(0.5),
        early_termination: 0.0,
        ..Scene::default()
    };
    scene.transfer.opacity = Some(OpacitySpec::Points(vec![[0.0, opacity], [1.0, opacity]]));
    scene.transfer.reference_length = Some(100.0);
    scene
}

/// A plane through the middle of the model, seen from the side that is cut away.
fn cut(view: &View, face: CutFace) -> ClipSpec {
    let [low, high] = view.world_bounds;
    let away = view.camera.forward.with_z(0.0) + DVec3::new(0.3, 0.1, 0.0);
    ClipSpec {
        point: (0.5 * (low + high)).to_array(),
        normal: away.to_array(),
        face,
    }
}

const BOTH: Surfaces = Surfaces {
    faults: true,
    ..HULL
};

const fn edges(on: Surfaces) -> Surfaces {
    Surfaces {
        cell_edges: true,
        ..on
    }
}

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

const LOOKS: [Look; 8] = [
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
        camera: [190.0, 30.0, 4.0],
        interpolation: Interpolation::Vertex,
        cut: Some(CutFace::Open),
        change: |_| (),
    },
    Look {
        name: "faults and edges, a section",
        shown: edges(FAULTS),
        other: NONE,
        camera: [240.0, 25.0, 4.0],
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
            scene.clip = vec![cut(&scene::resolve(&scene, case).unwrap(), face)];
        }
        with(&scene::resolve(&scene, case).unwrap(), self.shown)
    }
}

#[test]
fn strategies_agree_with_the_reference() {
    let Some(gpu) = common::gpu() else { return };
    let mut models = vec![common::sample()];
    models.extend(common::data("editnnc/9_EDITNNC.EGRID"));
    for model in models {
        let case = load::open(&model).unwrap();
        let mut renderer = Renderer::new(gpu.clone(), &case.grid).unwrap();
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
    let mut renderer = Renderer::new(gpu, &case.grid).unwrap();
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
        let dark = with(&scene::resolve(&scene, &case).unwrap(), surfaces);
        scene.lighting = LightingSpec::preset("strong").unwrap();
        scene.lighting.occlusion.as_mut().unwrap().mode = mode;
        scene.lighting.shadows.mode = mode;
        scene.lighting.rays = 14;
        scene.lighting.lights = vec![low.clone()];
        let lit = with(&scene::resolve(&scene, &case).unwrap(), surfaces);
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

/// A box of one value, seen so that three of its faces show.
fn one_box() -> Case {
    boxes(&[0.0, 100.0], &[0.0, 90.0], &[1000.0, 1080.0], &|_| 0.5)
}

/// Axis of the face at which a ray enters a box.
fn entered([low, high]: [DVec3; 2], ray: &reference::Ray) -> usize {
    let [a, b] = [low, high].map(|plane| (plane - ray.origin) / ray.direction);
    let near = a.min(b).to_array();
    (0..3).max_by(|a, b| near[*a].total_cmp(&near[*b])).unwrap()
}

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
    let mut renderer = Renderer::new(gpu, &case.grid).unwrap();
    for (exact_colors, surfaces) in [(false, HULL), (true, HULL), (false, CELLS)] {
        let mut scene = plain(camera(205.0, 35.0, 1.0), 0.3);
        scene.lighting.exact_colors = exact_colors;
        let view = scene::resolve(&scene, &case).unwrap();
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
    let [up, side] = [camera(0.0, 90.0, 1.0), camera(225.0, 35.0, 1.0)];
    for value in [0.05, 0.3, 0.5, 0.7, 0.95] {
        let case = boxes(&[0.0, 100.0], &[0.0, 100.0], &[1000.0, 1080.0], &|_| value);
        let mut renderer = Renderer::new(gpu.clone(), &case.grid).unwrap();
        let mut scene = plain(up.clone(), 0.3);
        scene.mode = Mode::Cells;
        scene.range = RangeSpec::Fixed([0.0, 1.0]);
        let mut colors = |camera: &CameraSpec| {
            scene.camera = camera.clone();
            let view = scene::resolve(&scene, &case).unwrap();
            let image = picture(&mut renderer, &case, &view, Some(StrategyKind::Plts));
            (view.clone(), image.over_background_8bit(view.background))
        };
        // Straight from above, the legend's color.
        let (view, pixels) = colors(&up);
        let legend = view.transfer.srgb(value).map(|v| (255.0 * v).round() as u8);
        let middle = pixels[30 * 80 + 40];
        let off = ciede2000_map(&[middle], &[legend]).unwrap()[0];
        println!("{value}: {off:.2} from the legend");
        assert!(off < 3.0, "{value}: {off}");
        // From the side, where a lamp at the viewer would make both walls and the roof all but alike.
        let (view, pixels) = colors(&side);
        let mut faces = [None; 3];
        for (n, pixel) in (0..).zip(&pixels) {
            let ray = reference::Ray::through_pixel(&view, n % 80, n / 80);
            if *pixel != [255; 3] {
                faces[entered(view.world_bounds, &ray)].get_or_insert(*pixel);
            }
        }
        let faces = faces.map(Option::unwrap);
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
        let mut renderer = Renderer::new(gpu.clone(), &case.grid).unwrap();
        for (inactive, is_cut, faults) in [
            (Inactive::Hidden, false, false),
            (Inactive::Hidden, true, true),
            (Inactive::Ghost, true, false),
        ] {
            let mut scene = Scene {
                size: [100, 75],
                camera: camera(150.0, 30.0, 8.0),
                mode: Mode::Cells,
                ..Scene::default()
            };
            scene.show.inactive = inactive;
            scene.show.faults = faults.into();
            if is_cut {
                scene.clip = vec![cut(&scene::resolve(&scene, &case).unwrap(), CutFace::Open)];
            }
            let view = scene::resolve(&scene, &case).unwrap();
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
    let mut renderer = Renderer::new(gpu, &case.grid).unwrap();
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
                ..scene::resolve(scene, &case).unwrap()
            };
            renderer
                .render(&case.grid, &view, &|_| true)
                .unwrap()
                .unwrap()
        };
        let [faint, solid] = [0.0, 0.9].map(|opacity| made(&scene(opacity, Mode::Cells)));
        assert_eq!(faint.image, solid.image, "{}", strategy.name());
        assert_eq!(faint.stats.samples, 0);
        // The twin: the volume depends on it.
        let [faint, solid] = [0.0, 0.9].map(|opacity| made(&scene(opacity, Mode::Volume)));
        assert!(faint.image != solid.image && solid.stats.samples > 0);
    }
}

/// Two blocks of 100 x 100 x 100 side by side, the eastern one deeper by a throw.
fn blocks(throw: f64, keywords: &str) -> Case {
    Shape {
        dims: [2, 1, 1],
        depth: &|[i, ..], [_, _, dk]| 1000.0 + throw * i as f64 + 100.0 * dk as f64,
        keywords,
        ..Shape::default()
    }
    .case()
}

/// What a ray sees of a sheet in the middle of matter from x = 0 to 200; `None` where a sample lies so near
/// to an end that it may count or not.
fn behind_half(view: &View, ray: reference::Ray, sheet: DVec3) -> Option<[f64; 4]> {
    let step = view.sampling_step;
    let at = [0.0, 100.0, 200.0].map(|x| (x - ray.origin.x) / ray.direction.x / step - 0.5);
    if at.iter().any(|n| (n - n.round()).abs() < 0.05) {
        return None;
    }
    let tau = view.transfer.extinction(0.5);
    let color = DVec3::from_array(view.color_at(0.5));
    let [front, back] = [0, 1].map(|n| (-tau * step * (at[n + 1].ceil() - at[n].ceil())).exp());
    let behind = SHEET_OPACITY * sheet + (1.0 - SHEET_OPACITY) * (1.0 - back) * color;
    let rgb = (1.0 - front) * color + front * behind;
    Some([
        rgb.x,
        rgb.y,
        rgb.z,
        1.0 - front * (1.0 - SHEET_OPACITY) * back,
    ])
}

#[test]
fn a_sheet_is_blended_between_what_is_before_and_behind_it() {
    let Some(gpu) = common::gpu() else { return };
    // A fault is named from either of its sides.
    let of_west = "FAULTS\n 'F' 1 1 1 1 1 1 'I' /\n/\n";
    let of_east = "FAULTS\n 'E' 1 1 1 1 1 1 'J' /\n 'F' 2 2 1 1 1 1 'X-' /\n/\n";
    for (keywords, sheet) in [("", UNNAMED), (of_west, PALETTE[0]), (of_east, PALETTE[1])] {
        let case = blocks(30.0, keywords);
        let mut renderer = Renderer::new(gpu.clone(), &case.grid).unwrap();
        // From the west, so that rays cross the fault.
        let view = scene::resolve(&plain(camera(270.0, 3.0, 1.0), 0.6), &case).unwrap();
        let view = with(&view, FAULTS);
        for by in all() {
            let image = picture(&mut renderer, &case, &view, by);
            let (mut seen, mut worst, mut otherwise) = (0, 0.0f64, f64::INFINITY);
            for (x, y) in (34..46).flat_map(|x| (27..33).map(move |y| (x, y))) {
                let ray = reference::Ray::through_pixel(&view, x, y);
                let error = |sheet| {
                    let expected = behind_half(&view, ray, sheet)?;
                    let pairs = pixel(&image, x, y).into_iter().zip(expected);
                    Some(pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max))
                };
                // The twin: the sheet of another fault.
                let errors = [sheet, PALETTE[2]].map(|color| error(blended(&view, color)));
                if let [Some(error), Some(other)] = errors {
                    seen += 1;
                    worst = worst.max(error);
                    otherwise = otherwise.min(other);
                }
            }
            println!("{by:?}: {seen} pixels, worst {worst:.1e}, {otherwise:.3} by another color");
            assert!(seen > 30 && worst < 1e-5 && otherwise > 0.02, "{by:?}");
        }
    }
}

#[test]
fn sheets_beyond_the_fourth_are_left_out() {
    let Some(gpu) = common::gpu() else { return };
    let case = Shape {
        dims: [7, 1, 1],
        depth: &|[i, ..], [_, _, dk]| 1000.0 + 30.0 * (i % 2) as f64 + 100.0 * dk as f64,
        ..Shape::default()
    }
    .case();
    let mut renderer = Renderer::new(gpu, &case.grid).unwrap();
    let view = scene::resolve(&plain(camera(270.0, 0.0, 1.0), 0.0), &case).unwrap();
    let view = with(&view, FAULTS);
    for by in all() {
        let sheets = if by.is_some() { 4 } else { 6 };
        let [.., alpha] = pixel(&picture(&mut renderer, &case, &view, by), 40, 30);
        assert!(
            (alpha - (1.0 - 0.5f64.powi(sheets))).abs() < 1e-6,
            "{by:?}: {alpha}"
        );
    }
}

/// Part of its color that a pixel in row `y` keeps where lines run down the picture at the projections of
/// some points.
fn kept_by_lines(view: &View, points: &[DVec3], x: u32) -> f64 {
    let covered = points.iter().map(|point| {
        let at = view.camera.project(*point, view.aspect()).unwrap().x * f64::from(view.size[0]);
        (0.5 * EDGE_WIDTH + 0.5 - (at - f64::from(x) - 0.5).abs()).clamp(0.0, 1.0)
    });
    1.0 - EDGE_DARKNESS * covered.fold(0.0, f64::max)
}

#[test]
fn edges_are_as_wide_at_any_distance() {
    let Some(gpu) = common::gpu() else { return };
    let planes = [0.0, 100.0, 200.0, 300.0];
    let case = boxes(&planes, &planes, &[1000.0, 1020.0, 1040.0], &|_| 0.5);
    let mut renderer = Renderer::new(gpu, &case.grid).unwrap();
    let section = ClipSpec {
        point: [0.0, 0.0, -1010.0],
        normal: [0.0, 0.0, -1.0],
        face: CutFace::Opaque,
    };
    for (zoom, clip, depth) in [
        (1.0, None, 1000.0),
        (0.55, None, 1000.0),
        (0.8, Some(section), 1010.0),
    ] {
        let is_section = clip.is_some();
        // Straight down: rows of pixels run along x.
        let mut scene = plain(camera(0.0, 90.0, zoom), 0.3);
        // So large that lines do not fade.
        scene.size = [160, 120];
        scene.clip.extend(clip);
        let view = scene::resolve(&scene, &case).unwrap();
        let on = |cell_edges| Surfaces {
            cell_edges,
            ..if is_section { NONE } else { HULL }
        };
        let row = view
            .camera
            .project(DVec3::new(150.0, 150.0, -depth), view.aspect());
        let y = (row.unwrap().y * f64::from(view.size[1])) as u32;
        let lines = planes.map(|x| DVec3::new(x, 150.0, -depth));
        for by in all() {
            let [with_lines, without] = [true, false]
                .map(|edges| picture(&mut renderer, &case, &with(&view, on(edges)), by));
            let (mut dark, mut seen) = (0, 0);
            for x in 0..view.size[0] {
                let [base, found] = [&without, &with_lines].map(|i| pixel(i, x, y));
                if base[3] < 1.0 {
                    continue;
                }
                let expected = kept_by_lines(&view, &lines, x);
                let error = (found[1] - expected * base[1]).abs();
                assert!(
                    error < 2e-3 && found[3] == 1.0,
                    "{by:?} {zoom} {x}: {error}"
                );
                seen += 1;
                dark += u32::from(expected < 1.0 - 0.35 * EDGE_DARKNESS);
            }
            assert!(
                seen > 20 && (4..=12).contains(&dark),
                "{by:?} {zoom}: {dark} of {seen}"
            );
        }
    }
}

#[test]
fn what_is_not_shown_leaves_no_trace() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let mut renderer = Renderer::new(gpu, &case.grid).unwrap();
    let scene = Scene {
        size: [16, 12],
        camera: camera(205.0, 35.0, 1.0),
        ..Scene::default()
    };
    let view = scene::resolve(&scene, &case).unwrap();
    for strategy in StrategyKind::ALL {
        let [before, hull, faults, after] = [NONE, edges(HULL), FAULTS, NONE]
            .map(|shown| picture(&mut renderer, &case, &with(&view, shown), Some(strategy)));
        let difference = |image: &Image| {
            let pairs = image
                .pixels
                .iter()
                .flatten()
                .zip(before.pixels.iter().flatten());
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
        };
        // Where a ray pauses depends on the time, and PLTS locates it anew then.
        let most = if strategy == StrategyKind::Plts {
            1e-4
        } else {
            0.0
        };
        assert!(difference(&after) <= most, "{}", difference(&after));
        assert!(difference(&hull) > 0.1 && difference(&faults) > 0.05);
    }
}

#[test]
fn scenes_say_what_is_shown() {
    let case = blocks(30.0, "");
    let resolved = |show: &str| {
        let scene: Scene = serde_json::from_str(&format!("{{\"show\": {show}}}")).ok()?;
        Some(scene::resolve(&scene, &case).unwrap().surfaces)
    };
    let cells = |rest: &str| {
        let text = format!(
            "{{\"mode\": \"cells\", \"clip\": [{{\"point\": [50, 50, -1050], \"normal\": [1, 0, 0]}}]{rest}}}"
        );
        scene::resolve(&serde_json::from_str(&text).unwrap(), &case).unwrap()
    };
    let view = cells("");
    assert_eq!(view.surfaces, CELLS);
    assert_eq!(view.interpolation, Interpolation::Cell);
    assert!(view.clip[0].opaque);
    let without_edges = Surfaces {
        cell_edges: false,
        ..CELLS
    };
    let view = cells(r#", "show": {"cell_edges": false, "hull": "hidden"}"#);
    assert_eq!(view.surfaces, without_edges);
    assert!(serde_json::from_str::<Scene>(r#"{"mode": "solid"}"#).is_err());
    assert_eq!(resolved("{}"), Some(NONE));
    assert_eq!(resolved(r#"{"hull": "opaque"}"#), Some(HULL));
    assert_eq!(
        resolved(r#"{"hull": "hidden", "faults": true}"#),
        Some(FAULTS)
    );
    let all = r#"{"hull": "opaque", "faults": true, "cell_edges": true}"#;
    assert_eq!(resolved(all), Some(edges(BOTH)));
    assert_eq!(resolved(r#"{"hull": "glass"}"#), None);
}
