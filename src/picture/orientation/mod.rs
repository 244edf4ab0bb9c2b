//! What shows where one is: the model's box with coordinates along its edges, a scale bar, the directions
//! east, north and up or I, J and K, and the vertical exaggeration. Here they are laid out as lines and texts; pictures and
//! the window draw them.

mod coordinates;
mod edges;
mod triad;
mod wells;

use glam::DVec2;

pub use edges::on_screen;
pub use wells::{WellNames, well_names};

use super::ticks::shortened;
use super::units::Lengths;
use crate::case::Measure;
use crate::model::Space;
use crate::view::View;
use crate::view::camera::middle;

/// Upper left and lower right corner of a part of the picture.
pub type Area = [DVec2; 2];

/// What is drawn on, in pixels or points from the upper left corner.
pub struct Paper<'a> {
    /// Width and height.
    pub size: DVec2,
    /// Text height; the unit of every size here.
    pub unit: f64,
    /// Width of a text of this height.
    pub width: &'a dyn Fn(&str) -> f64,
    /// The background is dark.
    pub is_dark: bool,
    /// Parts that are needed for other things.
    pub taken: Vec<Area>,
}

/// A line of text.
#[derive(Debug, Clone, PartialEq)]
pub struct Text {
    /// What it says.
    pub text: String,
    /// Middle of it.
    pub middle: DVec2,
    /// Its height.
    pub height: f64,
}

/// An arrow, or a dot where it is no longer than it is wide.
#[derive(Debug, Clone, PartialEq)]
pub struct Arrow {
    /// From where to where.
    pub ends: [DVec2; 2],
    /// Width of its shaft, of its head where that begins, and length of the head.
    pub shape: [f64; 3],
    /// Color in sRGB.
    pub color: [u8; 3],
}

/// Lines, arrows and texts for orientation.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Orientation {
    /// Ticks on edges of the box, and the scale bar.
    pub strokes: Vec<[DVec2; 2]>,
    /// Directions, the farthest first.
    pub arrows: Vec<Arrow>,
    /// Texts; none is cut at the rim nor lies on another.
    pub texts: Vec<Text>,
}

/// Text heights that the smaller side of a picture must have for a scale bar, and for coordinates.
const ROOM: [f64; 2] = [20.0, 30.0];

impl Orientation {
    /// What a view needs.
    pub fn of(view: &View, lengths: &Lengths, paper: Paper<'_>) -> Self {
        let mut layout = Arrangement {
            paper,
            made: Self::default(),
        };
        // Else it stands among the facts below the picture.
        if view.notes.facts.is_none() {
            layout.exaggeration(view);
        }
        triad::add(&mut layout, view);
        let room = layout.paper.size.min_element() / layout.paper.unit;
        // Numbers of cells have no length.
        if room >= ROOM[0] && view.world.space.is_map() {
            layout.scale_bar(view, &lengths.grid);
        }
        if room >= ROOM[1] {
            coordinates::add(&mut layout, view, lengths);
        }
        layout.made
    }

    /// Edges of the far sides of the box, cut at the rim of a picture of this size; they lie behind the volume.
    pub fn box_edges(view: &View, size: DVec2) -> Vec<[DVec2; 2]> {
        let ends = |edge: edges::Edge| edge.corners.map(|c| view.world.subject.outline[c]);
        let lines = edges::far(view).into_iter();
        lines
            .filter_map(|edge| on_screen(view, ends(edge), size))
            .collect()
    }
}

/// What has been laid out so far.
struct Arrangement<'a> {
    paper: Paper<'a>,
    made: Orientation,
}

impl Arrangement<'_> {
    /// Half the width and height of a text of a height.
    fn half(&self, text: &str, height: f64) -> DVec2 {
        let width = (self.paper.width)(text) * height / self.paper.unit;
        DVec2::new(0.5 * width, 0.6 * height)
    }

    /// The area of a text, moved into the picture where it would be cut at the rim.
    fn area(&self, text: &str, middle: DVec2) -> Area {
        let half = self.half(text, self.paper.unit);
        let low = half + 0.3 * self.paper.unit;
        let high = (self.paper.size - low).max(low);
        let middle = middle.clamp(low, high);
        [middle - half, middle + half]
    }

    /// True where an area is inside the picture and not needed for anything else.
    fn is_free(&self, area: &Area) -> bool {
        let is_inside = area[0].cmpge(DVec2::ZERO).all() && area[1].cmple(self.paper.size).all();
        is_inside && !self.paper.taken.iter().any(|taken| overlap(taken, area))
    }

    /// Writes a text of the common height.
    fn write(&mut self, text: &str, area: Area) {
        self.paper.taken.push(area);
        self.made.texts.push(Text {
            text: text.to_owned(),
            middle: 0.5 * (area[0] + area[1]),
            height: self.paper.unit,
        });
    }

    /// The vertical exaggeration, bottom left, as far as there is room.
    fn exaggeration(&mut self, view: &View) {
        let factor = format!("{:.2}", view.world.vertical_exaggeration);
        let full = match view.world.space {
            Space::Map => format!("Vertical exaggeration ×{}", shortened(&factor)),
            Space::Ijk => format!("Layers ×{}", shortened(&factor)),
        };
        let unit = self.paper.unit;
        let room = self.paper.size.x - 2.0 * unit;
        let short = format!("×{}", shortened(&factor));
        let text = [full, short].into_iter();
        let Some(text) = text.into_iter().find(|t| (self.paper.width)(t) <= room) else {
            return;
        };
        let half = self.half(&text, unit);
        let middle = DVec2::new(unit + half.x, self.paper.size.y - 1.3 * unit);
        self.write(&text, [middle - half, middle + half]);
    }

    /// A round length at the distance of the box's middle, bottom right.
    fn scale_bar(&mut self, view: &View, measure: &Measure) {
        let Paper { size, unit, .. } = self.paper;
        let depth = view.camera.depth(middle(&view.world.subject.outline));
        let height = 2.0 * view.camera.half_height(depth);
        let most = measure.show(0.2 * size.x * height / size.y);
        let Some(length) = round_length(most).filter(|_| depth > 0.0) else {
            return;
        };
        let right = size - DVec2::new(1.2 * unit, 1.2 * unit);
        let left = right - DVec2::X * (measure.read(length) * size.y / height);
        let text = format!("{length} {}", measure.unit);
        let label = self.area(
            text.trim_end(),
            0.5 * (left + right) - DVec2::Y * 0.95 * unit,
        );
        let all = [left - 0.5 * unit, right + 0.5 * unit];
        let is_long = right.x - left.x >= 3.0 * unit;
        if !(is_long && self.is_free(&label) && self.is_free(&all)) {
            return;
        }
        self.write(text.trim_end(), label);
        self.paper.taken.push(all);
        let end = DVec2::Y * 0.3 * unit;
        let strokes = [
            [left, right],
            [left - end, left + end],
            [right - end, right + end],
        ];
        self.made.strokes.extend(strokes);
    }
}

fn overlap(a: &Area, b: &Area) -> bool {
    a[0].cmplt(b[1]).all() && b[0].cmplt(a[1]).all()
}

/// The largest of 1, 2 and 5 times a power of ten that is not above a length.
fn round_length(most: f64) -> Option<f64> {
    // Beyond these the number would fill the picture.
    if !(1e-4..1e12).contains(&most) {
        return None;
    }
    let power = 10f64.powf(most.log10().floor());
    let steps = [5.0, 2.0, 1.0].map(|n| n * power);
    let length = steps.into_iter().find(|s| *s <= most * (1.0 + 1e-12))?;
    // Powers below one are not exact.
    format!("{length:.4}").parse().ok()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::picture::annotate::tests::view;
    use crate::scene::Projection;
    use crate::view::Camera;

    /// A view from a direction on a box of 1000 by 900 by 200 (400 exaggerated) at map coordinates of seven
    /// digits.
    fn seen(azimuth: f64, elevation: f64, zoom: f64, projection: Projection) -> View {
        let mut view = view([800, 600], 1.0);
        let origin = DVec3::new(460_000.0, 5_930_000.0, -4000.0);
        view.world.corners = view.world.corners.map(|c| origin + 100.0 * c);
        view.world.subject = crate::view::Subject::of_box(view.world.corners).into();
        let [azimuth, elevation] = [azimuth, elevation].map(f64::to_radians);
        let aspect = view.aspect();
        view.camera = Camera::framing(
            &view.world.corners,
            azimuth,
            elevation,
            zoom,
            aspect,
            projection,
        )
        .unwrap();
        view
    }

    fn laid_out(view: &View) -> Orientation {
        let paper = Paper {
            size: DVec2::new(800.0, 600.0),
            unit: 14.0,
            width: &|text| 7.5 * text.chars().count() as f64,
            is_dark: false,
            taken: Vec::new(),
        };
        Orientation::of(view, &Lengths::named("m"), paper)
    }

    fn area(text: &Text) -> Area {
        let width = 7.5 * text.text.chars().count() as f64 * text.height / 14.0;
        let half = 0.5 * DVec2::new(width, text.height);
        [text.middle - half, text.middle + half]
    }

    #[test]
    fn texts_lie_apart_and_inside_the_picture_from_all_sides() {
        for projection in [Projection::Perspective, Projection::Parallel] {
            for (azimuth, elevation) in (0..24).flat_map(|a| (-4..=4).map(move |e| (a, e))) {
                for zoom in [0.5, 1.0, 2.5, 20.0] {
                    let [azimuth, elevation] =
                        [15.0 * f64::from(azimuth), 22.5 * f64::from(elevation)];
                    let view = seen(azimuth, elevation, zoom, projection);
                    let texts = laid_out(&view).texts;
                    for (n, text) in texts.iter().enumerate() {
                        let [low, high] = area(text);
                        assert!(low.min_element() > 0.0 && high.x < 800.0 && high.y < 600.0);
                        let others = texts[n + 1..].iter();
                        let over = others.filter(|t| overlap(&area(t), &area(text)));
                        assert_eq!(over.count(), 0, "{azimuth} {elevation} {zoom} {text:?}");
                    }
                    let has = |name: &str| texts.iter().any(|t| t.text == name);
                    let is_oblique = elevation.abs() == 22.5 && azimuth % 90.0 != 0.0;
                    for name in ["Easting (m)", "Northing (m)", "Depth (m)"] {
                        assert!(
                            has(name) || !(is_oblique && zoom == 1.0),
                            "{azimuth} {name}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn ticks_stand_where_their_values_are() {
        // From above, north up: x of the picture is the easting.
        let view = seen(180.0, 90.0, 1.0, Projection::Parallel);
        let made = laid_out(&view);
        let value = |t: &Text| t.text.parse().ok().filter(|v: &f64| *v < 1e6);
        let eastings: Vec<(f64, DVec2)> = made
            .texts
            .iter()
            .filter_map(|t| Some((value(t)?, t.middle)))
            .collect();
        assert!(eastings.len() >= 3, "{:?}", made.texts);
        for (easting, middle) in eastings {
            let point = view.world.corners[0].with_x(easting);
            let x = 800.0 * view.camera.project(point, view.aspect()).unwrap().x;
            assert!((x - middle.x).abs() < 1e-6);
            let stroke = |[a, _]: &[DVec2; 2]| (a.x - x).abs() < 1e-6;
            assert!(made.strokes.iter().any(stroke));
            assert!(
                !made
                    .strokes
                    .iter()
                    .any(|[a, _]| (a.x - x - 3.0).abs() < 1.0)
            );
        }
    }

    #[test]
    fn the_scale_bar_is_as_long_as_it_says() {
        for (projection, off) in [
            (Projection::Parallel, 300.0),
            (Projection::Perspective, 0.0),
        ] {
            let view = seen(30.0, 40.0, 1.0, projection);
            let made = laid_out(&view);
            let is_bar = |t: &&Text| t.text.ends_with(" m");
            let label = &made.texts.iter().find(is_bar).unwrap().text;
            let length: f64 = label.trim_end_matches(" m").parse().unwrap();
            let [a, b] = made.strokes[0];
            // Exact at the middle of the box, in parallel anywhere.
            let across = |shift: f64, length: f64| {
                let at = middle(&view.world.corners) + shift * view.camera.forward;
                let ends = [0.0, 1.0].map(|part| at + part * length * view.camera.right);
                let [a, b] = ends.map(|p| view.camera.project(p, view.aspect()).unwrap());
                800.0 * a.distance(b)
            };
            assert!((across(off, length) - a.distance(b)).abs() < 1e-6);
            assert!((across(off, 1.1 * length) - a.distance(b)).abs() > 1.0);
            let elsewhere = (across(300.0, length) - a.distance(b)).abs();
            assert_eq!(elsewhere > 1.0, projection.is_default());
        }
    }

    #[test]
    fn index_space_has_whole_numbers_and_no_lengths() {
        let mut view = view([800, 600], 1.0);
        view.world.space = Space::Ijk;
        view.world.spaces = crate::model::Spaces::new(None, 2.0);
        // Three columns, twelve rows, four layers twice as high as they are wide.
        let [low, high] = [[0.5, 0.5, -9.0], [3.5, 12.5, -1.0]].map(DVec3::from_array);
        view.world.corners = std::array::from_fn(|n| {
            let far = |axis: usize| if n >> axis & 1 == 1 { high } else { low };
            // The first layer is the upper one.
            let z = if n >> 2 & 1 == 1 { low.z } else { high.z };
            DVec3::new(far(0).x, far(1).y, z)
        });
        view.world.subject = crate::view::Subject::of_box(view.world.corners).into();
        let corners = view.world.corners;
        let aspect = view.aspect();
        let camera = Camera::framing(&corners, 3.6, 0.6, 1.0, aspect, Projection::Perspective);
        view.camera = camera.unwrap();
        let texts: Vec<String> = laid_out(&view).texts.into_iter().map(|t| t.text).collect();
        for (name, count) in [("I", 2), ("J", 2), ("K", 2), ("E", 0), ("N", 0), ("Up", 0)] {
            let found = texts.iter().filter(|t| *t == name).count();
            assert_eq!(found, count, "{name} {texts:?}");
        }
        let numbers: Vec<f64> = texts.iter().filter_map(|t| t.parse().ok()).collect();
        assert!(numbers.len() >= 6, "{texts:?}");
        let is_cell = |v: &f64| v.fract() == 0.0 && (1.0..=12.0).contains(v);
        assert!(numbers.iter().all(is_cell), "{texts:?}");
        assert!(!texts.iter().any(|t| t.contains("m")), "{texts:?}");
        // The same view as a map has the scale bar.
        view.world.space = Space::Map;
        let texts = laid_out(&view).texts;
        assert!(texts.iter().any(|t| t.text.ends_with(" m")));
    }

    #[test]
    fn small_pictures_stay_clear() {
        let count = |size: f64| {
            let paper = Paper {
                size: DVec2::splat(size),
                unit: 11.0,
                width: &|text| 6.0 * text.len() as f64,
                is_dark: true,
                taken: Vec::new(),
            };
            let view = seen(30.0, 40.0, 1.0, Projection::Parallel);
            Orientation::of(&view, &Lengths::named("m"), paper)
        };
        let [small, middle, large] = [200.0, 300.0, 500.0].map(count);
        // The exaggeration alone.
        assert!(small.strokes.is_empty() && small.arrows.is_empty() && small.texts.len() == 1);
        assert_eq!(middle.arrows.len(), 3);
        assert!(middle.strokes.len() == 3 && large.strokes.len() > 10);
    }

    #[test]
    fn lengths_of_scale_bars_are_round() {
        let found = [0.03, 1.0, 1.99, 2.0, 7.3, 999.0, 1000.0, 12_345.0].map(round_length);
        let expected = [0.02, 1.0, 1.0, 2.0, 5.0, 500.0, 1000.0, 10_000.0];
        assert_eq!(found, expected.map(Some));
        for odd in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!(round_length(odd), None);
        }
    }
}
