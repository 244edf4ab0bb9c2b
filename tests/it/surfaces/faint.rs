//! The faint hull.

use super::*;

/// What a faint hull leaves of the light through an empty box: the opacities of the faces at which a ray comes
/// in and goes out.
fn behind_faint([low, high]: [DVec3; 2], ray: &reference::Ray) -> f64 {
    let [a, b] = [low, high].map(|plane| (plane - ray.origin) / ray.direction);
    let axis = |t: DVec3, ahead: f64| {
        let t = (ahead * t).to_array();
        (0..3).max_by(|a, b| t[*a].total_cmp(&t[*b])).unwrap()
    };
    let passed = |axis: usize, [facing, edge_on]: [f64; 2]| {
        let away = 1.0 - ray.direction[axis].abs();
        1.0 - facing - (edge_on - facing) * away * away
    };
    passed(axis(a.min(b), 1.0), FAINT_FRONT) * passed(axis(a.max(b), -1.0), FAINT_BEHIND)
}

#[test]
fn a_faint_hull_has_a_front_and_a_ground() {
    let Some(gpu) = common::gpu() else { return };
    let case = one_box();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let scene = plain(camera(205.0, 35.0, 1.0), 0.0);
    let view = with(&view::resolve(&scene, &case).unwrap(), FAINT);
    let gray = blended(&view, faint_color(view.style.background)).x;
    for by in all() {
        let image = picture(&mut renderer, &case, &view, by);
        let (mut covered, mut wrong, mut worst, mut constant) = (0, 0, 0.0f64, 0.0f64);
        for (n, pixel) in (0..).zip(&image.pixels) {
            let ray = reference::Ray::through_pixel(&view, n % 80, n / 80);
            let [red, .., alpha] = pixel.map(f64::from);
            if alpha == 0.0 {
                continue;
            }
            let expected = 1.0 - behind_faint(view.world.bounds, &ray);
            let error = (alpha - expected).abs().max((red - gray * expected).abs());
            covered += 1;
            // At an edge a pixel may see the other face.
            if error > 1e-4 {
                wrong += 1;
            } else {
                worst = worst.max(error);
            }
            // The twin: the same everywhere.
            constant = constant.max((alpha - FAINT_BEHIND[0]).abs());
        }
        println!("{by:?}: {wrong} of {covered}, worst {worst:.1e}, constant {constant:.2}");
        assert!(
            covered > 800 && wrong < 8 && constant > 0.1,
            "{by:?}: {wrong} of {covered}"
        );
    }
}

#[test]
fn what_is_drawn_is_never_taken_for_the_background() {
    let Some(gpu) = common::gpu() else { return };
    let mut models = vec![common::sample()];
    models.extend(common::data("reek/REEK.EGRID"));
    for model in models {
        let case = load::open(&model).unwrap();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        for (background, blending, is_empty) in [
            ("#ffffff", Blending::Display, false),
            ("#ffffff", Blending::Display, true),
            ("#ffffff", Blending::Linear, true),
            ("#10141c", Blending::Display, false),
            ("#10141c", Blending::Display, true),
            ("#808080", Blending::Display, true),
            ("#7f7f7f", Blending::Linear, true),
        ] {
            let mut scene = Scene {
                size: [100, 75],
                background: background.into(),
                blending,
                ..Scene::default()
            };
            if is_empty {
                scene.transfer.opacity = Some(OpacitySpec::Points(vec![[0.0, 0.0], [1.0, 0.0]]));
            }
            let view = view::resolve(&scene, &case).unwrap();
            let mut least = |hull: Surfaces| {
                let view = with(&view, hull);
                let image = picture(&mut renderer, &case, &view, Some(StrategyKind::Libc));
                let pixels = image.over_background_8bit(view.style.background);
                let empty = vec![srgb(view.style.background); pixels.len()];
                ciede2000_map(&pixels, &empty).unwrap()
            };
            let [solid, faint, hidden] = [HULL, FAINT, NONE].map(&mut least);
            let covered = solid.iter().zip(faint.iter().zip(&hidden));
            let covered: Vec<_> = covered.filter(|(solid, _)| **solid > 0.0).collect();
            let worst = |of: fn(&(&f64, (&f64, &f64))) -> f64| {
                covered.iter().map(of).fold(f64::INFINITY, f64::min)
            };
            let [faint, hidden] = [worst(|c| *c.1.0), worst(|c| *c.1.1)];
            let what = format!(
                "{} {background} {blending:?} {is_empty}: {faint:.1} apart, {hidden:.1} without",
                case.about.name
            );
            println!("{what}");
            assert!(
                faint > 10.0 && hidden < 1.0 && covered.len() > 500,
                "{what}"
            );
        }
    }
}
