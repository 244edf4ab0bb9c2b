//! Sheets of faults.

use super::*;

/// What a ray sees of a sheet in the middle of matter from x = 0 to 200; `None` where a sample lies so near
/// to an end that it may count or not.
fn behind_half(view: &View, ray: reference::Ray, sheet: DVec3) -> Option<[f64; 4]> {
    let step = view.sampling.step;
    let at = [0.0, 100.0, 200.0].map(|x| (x - ray.origin.x) / ray.direction.x / step - 0.5);
    if at.iter().any(|n| (n - n.round()).abs() < 0.05) {
        return None;
    }
    let tau = view.style.transfer.extinction(0.5);
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
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        // From the west, so that rays cross the fault.
        let view = view::resolve(&plain(camera(270.0, 3.0, 1.0), 0.6), &case).unwrap();
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
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let view = view::resolve(&plain(camera(270.0, 0.0, 1.0), 0.0), &case).unwrap();
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
