//! Title, legend, orientation axes and the model's box, drawn into the 8-bit picture.

use glam::DVec2;

use super::canvas::Canvas;
use super::orientation::{Orientation, Paper};
use super::pen::Pen;
use super::{Image, axes, legend};
use crate::case::Case;
use crate::scene::View;

/// What to write and draw.
#[derive(Debug, Clone, Default)]
pub struct Annotations {
    /// Line at the top; its end is left out where there is no room.
    pub title: String,
    /// Step and date behind the title, which are never left out; may be empty.
    pub when: String,
    /// Name over the legend.
    pub property: String,
    /// Unit behind the name; may be empty.
    pub unit: String,
    /// Unit of lengths; may be empty.
    pub length_unit: String,
    /// Draw title and legend.
    pub show_legend: bool,
    /// Draw the box with coordinates, the directions, a scale bar and the vertical exaggeration.
    pub show_box: bool,
}

impl Annotations {
    /// What belongs to a view of a case: its name, the property and, where that changes, the step.
    pub fn of(case: &Case, view: &View) -> Self {
        let step = case.steps.get(view.step);
        let shown = step.filter(|_| case.is_dynamic(&view.property));
        Self {
            title: format!("{}   {}", case.about.name, case.title_of(&view.property)),
            when: shown.map_or_else(String::new, |step| {
                format!("   step {}   {}", view.step, step.date)
            }),
            property: case.heading_of(&view.property),
            unit: case.unit(&view.property).to_owned(),
            length_unit: short_unit(&case.about.length_unit),
            show_legend: view.show_legend,
            show_box: view.show_box,
        }
    }
}

/// A length unit of a grid file as it is written behind numbers.
pub fn short_unit(name: &str) -> String {
    match name {
        "METRES" => "m".into(),
        "FEET" => "ft".into(),
        other => other.to_lowercase(),
    }
}

/// The picture as users see it: over the background, with what [`Annotations::of`] says unless `plain`.
pub fn finished(image: &Image, case: &Case, view: &View, plain: bool) -> Vec<[u8; 3]> {
    let mut rgb = image.over_background_8bit(view.background);
    if !plain {
        annotate(&mut rgb, image, view, &Annotations::of(case, view));
    }
    rgb
}

/// Pictures lower or narrower than this get no annotations: nothing would be readable.
const SMALLEST: [u32; 2] = [200, 150];

/// Draws annotations into a picture that was put over its background.
///
/// Pictures narrower than 200 or lower than 150 pixels stay as they are.
pub fn annotate(rgb: &mut [[u8; 3]], image: &Image, view: &View, annotations: &Annotations) {
    if image.size[0] < SMALLEST[0] || image.size[1] < SMALLEST[1] {
        return;
    }
    let canvas = Canvas::new(image.size, rgb);
    let mut pen = Pen::new(canvas, view.background, Pen::unit_of(image.size));
    let size = DVec2::from_array(image.size.map(f64::from));
    axes::draw_connections(&mut pen, view, size);
    if annotations.show_box {
        axes::draw_edges(&mut pen, image, &Orientation::box_edges(view, size));
    }
    let mut taken = Vec::new();
    if annotations.show_legend {
        taken.push(pen.title_until(&annotations.title, &annotations.when));
        let heading = [&annotations.property, &annotations.unit];
        taken.push(legend::draw(
            &mut pen,
            &view.transfer,
            heading.map(String::as_str),
        ));
    }
    if annotations.show_box {
        let orientation = Orientation::of(
            view,
            &annotations.length_unit,
            Paper {
                size,
                unit: pen.unit,
                width: &|text| pen.canvas.text_width(text, pen.unit),
                is_dark: pen.dark_paper,
                taken,
            },
        );
        axes::draw_marks(&mut pen, &orientation);
    }
}

#[cfg(test)]
pub(super) mod tests {
    use glam::DVec3;

    use super::*;
    use crate::model::{CellField, Spaces};
    use crate::scene::{Camera, Interpolation, Projection};
    use crate::strategies::StrategyKind;
    use crate::transfer::{TransferFunction, presets};

    /// A view from the southwest on a box of 10 by 9 by 4.
    pub fn view(size: [u32; 2], background: f64) -> View {
        let spaces = Spaces::new(None, 2.0);
        let box_corners = std::array::from_fn(|c| {
            let pick = |axis: usize, length: f64| if c >> axis & 1 == 1 { length } else { 0.0 };
            let corner = DVec3::new(pick(0, 10.0), pick(1, 9.0), pick(2, 2.0));
            spaces.world_from_grid.transform_point3(corner)
        });
        let aspect = f64::from(size[0]) / f64::from(size[1]);
        View {
            size,
            background: [background; 3],
            camera: Camera::framing(&box_corners, 3.6, 0.6, 1.0, aspect, Projection::Perspective)
                .unwrap(),
            spaces,
            vertical_exaggeration: 2.0,
            world_bounds: [DVec3::new(0.0, 0.0, -4.0), DVec3::new(10.0, 9.0, 0.0)],
            box_corners,
            strategy: StrategyKind::ALL[0],
            property: "SWAT".into(),
            step: 0,
            field: CellField::new(Vec::new()).into(),
            interpolation: Interpolation::Cell,
            transfer: TransferFunction {
                color: presets::color_map("turbo").unwrap(),
                opacity: vec![(0.0, 0.1), (1.0, 0.5)],
                range: [0.0, 1.0],
                scale: crate::transfer::Scale::Linear,
                bands: None,
                reference_length: 1.0,
            },
            sampling_step: 1.0,
            early_termination: 0.0,
            surfaces: crate::scene::Surfaces::default(),
            connections: std::sync::Arc::default(),
            named_faults: std::sync::Arc::default(),
            chosen_faults: None,
            drawn: Vec::new().into(),
            clip: Vec::new(),
            ghosts: None,
            lighting: crate::scene::lighting::resolve(
                &crate::scene::LightingSpec::default(),
                DVec3::ONE,
                1,
            )
            .unwrap(),
            libc: crate::scene::LibcSettings::default(),
            srg: crate::scene::SrgSettings::default(),
            show_box: true,
            show_legend: true,
        }
    }

    fn notes(title: &str, show_legend: bool, show_box: bool) -> Annotations {
        Annotations {
            title: title.into(),
            when: String::new(),
            property: "SWAT".into(),
            unit: "m3".into(),
            length_unit: "m".into(),
            show_legend,
            show_box,
        }
    }

    /// Pixels before and after, of a picture that the volume covers with the given alpha.
    fn drawn(view: &View, notes: &Annotations, alpha: f32) -> [Vec<[u8; 3]>; 2] {
        let pixels = vec![[0.0, 0.0, 0.0, alpha]; (view.size[0] * view.size[1]) as usize];
        let image = Image {
            size: view.size,
            pixels,
        };
        let before = image.over_background_8bit(view.background);
        let mut after = before.clone();
        annotate(&mut after, &image, view, notes);
        [before, after]
    }

    fn changed([before, after]: &[Vec<[u8; 3]>; 2]) -> Vec<usize> {
        (0..before.len())
            .filter(|&p| before[p] != after[p])
            .collect()
    }

    #[test]
    fn ok_every_size_and_title_is_drawn_without_panic() {
        let long = "REEK \u{0} é 漢字 ".repeat(500);
        for size in [
            [1, 1],
            [10, 3],
            [3000, 20],
            [20, 3000],
            [200, 150],
            [250, 1500],
        ] {
            for title in ["", "REEK", &long] {
                let view = view(size, 1.0);
                let small = size[0] < 200 || size[1] < 150;
                let pictures = drawn(&view, &notes(title, true, true), 0.0);
                assert_eq!(changed(&pictures).is_empty(), small, "{size:?}");
            }
        }
    }

    #[test]
    fn ok_odd_views_are_drawn_without_panic() {
        let all = notes("REEK", true, true);
        for odd in [f64::NAN, f64::INFINITY, 0.0, -1e300] {
            let mut view = view([300, 200], 0.2);
            view.camera.right *= odd;
            view.box_corners[3].x = odd;
            view.transfer.range = [odd, 1.0];
            view.transfer.opacity = vec![(0.0, odd)];
            view.vertical_exaggeration = odd;
            drawn(&view, &all, 0.5);
        }
    }

    #[test]
    fn nothing_changes_where_nothing_is_drawn() {
        let view = view([400, 300], 1.0);
        assert!(changed(&drawn(&view, &notes("REEK", false, false), 0.0)).is_empty());
        // The title stands at the top left, the legend at the right; all else stays.
        let pictures = drawn(&view, &notes("REEK", true, false), 0.0);
        let pixels = changed(&pictures);
        let (title, legend): (Vec<usize>, Vec<_>) = pixels.into_iter().partition(|p| p / 400 < 30);
        assert!(!title.is_empty() && title.iter().all(|p| p % 400 < 100));
        assert!(!legend.is_empty() && legend.iter().all(|p| p % 400 > 300));
    }

    #[test]
    fn text_follows_the_title_and_stands_out_from_the_background() {
        let picture = |background, title| {
            let [_, after] = drawn(
                &view([400, 300], background),
                &notes(title, true, false),
                0.0,
            );
            after[..400 * 30].to_vec()
        };
        assert_ne!(picture(1.0, "REEK"), picture(1.0, "NORNE"));
        assert!(picture(1.0, "REEK").iter().any(|p| p[0] < 80));
        assert!(picture(0.1, "REEK").iter().any(|p| p[0] > 190));
    }

    #[test]
    fn step_and_date_stay_behind_a_long_title() {
        let picture = |title: &str, when: &str| {
            let notes = Annotations {
                when: when.into(),
                ..notes(title, true, false)
            };
            let [_, after] = drawn(&view([200, 150], 1.0), &notes, 0.0);
            after[..200 * 25].to_vec()
        };
        for title in ["REEK", &"REEK ".repeat(100)] {
            let first = picture(title, "   step 1   2001-01-01");
            assert_eq!(first, picture(title, "   step 1   2001-01-01"));
            assert_ne!(first, picture(title, "   step 1   2001-01-02"));
        }
    }

    #[test]
    fn box_lies_under_the_volume() {
        let view = view([400, 300], 1.0);
        let boxed = notes("", false, true);
        let middle = |pixels: Vec<usize>| {
            // Right of the axes.
            let inside = |p: &&usize| *p % 400 > 120 && *p / 400 < 250;
            pixels.iter().filter(inside).count()
        };
        assert!(middle(changed(&drawn(&view, &boxed, 0.0))) > 100);
        let covered = changed(&drawn(&view, &boxed, 1.0));
        assert_eq!(middle(covered), 0);
    }
}
