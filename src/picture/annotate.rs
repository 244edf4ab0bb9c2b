//! What is written and drawn around and over the volume in the 8-bit picture.

use glam::DVec2;

use super::axes;
use super::canvas::Canvas;
use super::info::Info;
use super::layout::{LINE, Layout, Length, Parts};
use super::legend::Key;
use super::marks::mark_cells;
use super::orientation::{Area, Orientation, Paper, well_names};
use super::pen::Pen;
use super::units::Lengths;
use crate::case::{Case, Measure, Step};
use crate::image::{Image, Rgb8, srgb_8bit};
use crate::scene::Scene;
use crate::view::{SceneError, View, resolve};

/// What to write and draw.
#[derive(Debug, Clone, Default)]
pub struct Annotations {
    /// Line at the top; its end is left out where there is no room.
    pub title: String,
    /// Date and report behind the title, which are never left out; may be empty.
    pub when: String,
    /// Name over the legend.
    pub property: String,
    /// How its values are written; the unit stands behind the name.
    pub measure: Measure,
    /// Name over the legend of a volume beside the model, and how its values are written.
    pub cube: Option<(String, Measure)>,
    /// How lengths are written.
    pub lengths: Lengths,
    /// The legend has a curve of the opacity.
    pub has_opacity: bool,
    /// Draw title and legend.
    pub show_legend: bool,
    /// Draw the box with coordinates, the directions and a scale bar.
    pub show_box: bool,
    /// Facts on what is drawn; `None` where they are hidden.
    pub info: Option<Info>,
}

impl Annotations {
    /// What belongs to a view of a case: its name, the property, when it was so, and what is drawn in numbers.
    pub fn of(case: &Case, view: &View) -> Self {
        let when = when(case, view);
        let facts = view.notes.facts.as_ref();
        Self {
            title: format!(
                "{}   {}",
                case.about.name,
                case.title_of(&view.shown.property)
            ),
            info: facts.map(|facts| Info::of(case, view, facts, &when)),
            when: match when.is_empty() {
                true => when,
                false => format!("   {when}"),
            },
            property: case.heading_of(&view.shown.property),
            measure: case.measure(&view.shown.property, view.notes.units),
            cube: view.shown.cube.as_ref().map(|shown| {
                let measure = view.notes.units.of_unit(&shown.cube.unit, "");
                (shown.cube.name.clone(), measure)
            }),
            lengths: Lengths::of(case, view.notes.units),
            has_opacity: !view.style.surfaces.solid,
            show_legend: view.notes.has_legend,
            show_box: view.notes.has_box,
        }
    }

    /// The legend of a view's colors.
    pub fn key<'a>(&'a self, view: &'a View, unit: f64, width: &'a dyn Fn(&str) -> f64) -> Key<'a> {
        Key {
            transfer: &view.style.transfer,
            beyond: view.style.beyond,
            heading: [&self.property, &self.measure.unit],
            measure: &self.measure,
            has_opacity: self.has_opacity,
            unit,
            width,
        }
    }
}

impl Annotations {
    /// The legend of the colors of a view's cube, beside that of its property.
    pub fn cube_key<'a>(&'a self, view: &'a View, other: &Key<'a>) -> Option<Key<'a>> {
        let (shown, (name, measure)) = view.shown.cube.as_deref().zip(self.cube.as_ref())?;
        Some(Key {
            transfer: &shown.transfer,
            beyond: shown.beyond,
            heading: [name, &measure.unit],
            measure,
            has_opacity: true,
            unit: other.unit,
            width: other.width,
        })
    }
}

/// Date and report of the step that a view shows; empty where its property does not change with time.
pub fn when(case: &Case, view: &View) -> String {
    let step = case.steps.get(view.shown.step);
    let step = step.filter(|_| case.is_dynamic(&view.shown.property));
    let Some(step) = step else {
        return String::new();
    };
    // Where a file has no report numbers, they do not rise.
    let has_reports = case
        .steps
        .is_sorted_by(|a: &Step, b: &Step| a.report < b.report);
    match (step.date.is_empty(), has_reports) {
        (false, true) => format!("{}   report {}", step.date, step.report),
        (false, false) => step.date.clone(),
        (true, true) => format!("report {}", step.report),
        (true, false) => format!("step {}", view.shown.step),
    }
}

/// A view of the volume, and where that stands in the picture.
#[derive(Debug, Clone)]
pub struct Shot {
    /// What is rendered, in the size of the volume's rectangle.
    pub view: View,
    /// The parts of the picture.
    pub layout: Layout,
    /// Cells that are marked, by I, J, K from 1.
    pub marked: Vec<[usize; 3]>,
}

impl Shot {
    /// Of a scene, whose size is that of the whole picture; the volume alone where it is `plain`.
    ///
    /// # Errors
    /// When the scene cannot be shown.
    pub fn of(scene: &Scene, case: &Case, plain: bool) -> Result<Self, SceneError> {
        let view = resolve(scene, case)?;
        let layout = Layout::of_picture(case, &view, plain);
        let view = match layout.volume_size() == view.size {
            true => view,
            false => view.seen_from(&scene.camera, layout.volume_size())?,
        };
        Ok(Self {
            view,
            layout,
            marked: Vec::new(),
        })
    }

    /// The picture as users see it, from the image of its view.
    pub fn finished(&self, image: &Image, case: &Case) -> Rgb8 {
        let annotations = Annotations::of(case, &self.view);
        let mark = |volume: &mut Rgb8| mark_cells(volume, &self.view, &case.grid, &self.marked);
        composed(image, &self.view, &self.layout, &annotations, &mark)
    }
}

impl Layout {
    /// The layout of the picture of a view that has the whole picture's size; the volume alone where it is
    /// `plain`.
    pub fn of_picture(case: &Case, view: &View, plain: bool) -> Self {
        let size = DVec2::from_array(view.size.map(f64::from));
        let unit = Pen::unit_of(view.size);
        if plain {
            return Self::plain(size, unit);
        }
        let canvas = Canvas::new(view.size, &mut []);
        let width = |text: &str| canvas.text_width(text, unit);
        let annotations = Annotations::of(case, view);
        let key = annotations.key(view, unit, &width);
        Self::of(size, unit, &annotations.parts(view, &key, size.y))
    }
}

impl Annotations {
    /// The parts of a picture of a height: the legend of a cube stands at the left.
    pub fn parts<'a>(&'a self, view: &'a View, key: &Key<'a>, height: f64) -> Parts {
        let widths = |key: &Key<'_>| key.widths(0.85 * height);
        Parts {
            title: self.show_legend,
            info: self.info.as_ref().map(|info| match info.is_long() {
                true => Length::Long,
                false => Length::Usual,
            }),
            legend: self.show_legend.then(|| widths(key)),
            left_legend: self
                .cube_key(view, key)
                .filter(|_| self.show_legend)
                .map(|key| widths(&key)),
        }
    }
}

/// The picture as users see it: the image of a view over the background in its place, with what
/// [`Annotations::of`] says around it and over it.
pub fn finished(image: &Image, case: &Case, view: &View, layout: &Layout) -> Rgb8 {
    composed(image, view, layout, &Annotations::of(case, view), &|_| ())
}

/// [`finished`], with given annotations, and what `mark` draws over the volume.
fn composed(
    image: &Image,
    view: &View,
    layout: &Layout,
    annotations: &Annotations,
    mark: &dyn Fn(&mut Rgb8),
) -> Rgb8 {
    let mut volume = Rgb8 {
        size: image.size,
        pixels: image.over_background_8bit(view.style.background),
    };
    if !layout.is_plain {
        over_volume(&mut volume, image, view, layout.unit, annotations);
    }
    mark(&mut volume);
    let size = layout.size.to_array().map(|n| n as u32);
    if size == image.size {
        return volume;
    }
    let mut picture = Rgb8::filled(size, srgb_8bit(view.style.background));
    picture.paste(&volume, layout.volume_corner());
    beside_volume(&mut picture, view, layout, annotations);
    picture
}

/// Draws what belongs to the model; on a canvas of the volume alone, so that nothing leaves that.
fn over_volume(
    volume: &mut Rgb8,
    image: &Image,
    view: &View,
    unit: f64,
    annotations: &Annotations,
) {
    let size = DVec2::from_array(image.size.map(f64::from));
    let mut pen = Pen::new(volume.canvas(), view.style.background, unit);
    axes::draw_connections(&mut pen, view, size);
    if annotations.show_box {
        axes::draw_edges(&mut pen, image, &Orientation::box_edges(view, size));
    }
    let marks = {
        let width = |text: &str| pen.canvas.text_width(text, unit);
        let mut paper = Paper {
            size,
            unit,
            width: &width,
            is_dark: pen.dark_paper,
            taken: Vec::new(),
        };
        let names = well_names(view, &paper);
        let areas = names.texts.iter().map(|name| name.area(width(&name.text)));
        paper.taken.extend(areas);
        let mut marks = match annotations.show_box {
            true => Orientation::of(view, &annotations.lengths, paper),
            false => Orientation::default(),
        };
        marks.texts.extend(names.texts);
        marks.strokes.extend(names.leaders);
        marks
    };
    axes::draw_marks(&mut pen, &marks);
}

/// Draws title, legend and facts.
fn beside_volume(picture: &mut Rgb8, view: &View, layout: &Layout, annotations: &Annotations) {
    let unit = layout.unit;
    let mut pen = Pen::new(picture.canvas(), view.style.background, unit);
    if layout.title.is_some() {
        pen.title_until(&annotations.title, &annotations.when);
    }
    let legends = {
        let width = |text: &str| pen.canvas.text_width(text, unit);
        let key = annotations.key(view, unit, &width);
        let cube = annotations.cube_key(view, &key);
        [(Some(key), layout.legend), (cube, layout.left_legend)].map(|(key, strip)| {
            let (key, strip) = key.zip(strip)?;
            Some(key.laid_out(strip, layout.is_narrow))
        })
    };
    for legend in legends.iter().flatten() {
        pen.legend(legend);
    }
    if let (Some(area), Some(info)) = (layout.info, &annotations.info) {
        draw_info(&mut pen, area, layout, info);
    }
}

fn draw_info(pen: &mut Pen, [low, high]: Area, layout: &Layout, info: &Info) {
    let unit = layout.unit;
    let width = |text: &str| pen.canvas.text_width(text, unit);
    let room = high.x - low.x - 2.0 * unit;
    let lines = info.lines(room, layout.info_lines, layout.title.is_some(), &width);
    for (n, line) in lines.iter().enumerate() {
        let y = low.y + (0.3 + LINE * n as f64) * unit;
        pen.write(line, [low.x + unit, y]);
    }
}

#[cfg(test)]
pub(super) mod tests {
    use glam::DVec3;

    use super::*;
    use crate::model::{CellField, Spaces};
    use crate::scene::{Interpolation, Projection, StrategyKind};
    use crate::transfer::{TransferFunction, presets};
    use crate::view::{Camera, Notes, Sampling, Shown, ShownCells, Style, World};

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
            camera: Camera::framing(&box_corners, 3.6, 0.6, 1.0, aspect, Projection::Perspective)
                .unwrap(),
            style: Style {
                background: [background; 3],
                beyond: [false; 2],
                transfer: TransferFunction {
                    color: presets::color_map("turbo").unwrap(),
                    opacity: vec![(0.0, 0.1), (1.0, 0.5)],
                    range: [0.0, 1.0],
                    scale: crate::transfer::Scale::Linear,
                    bands: None,
                    reference_length: 1.0,
                },
                blending: crate::image::Blending::Linear,
                surfaces: crate::view::Surfaces::default(),
                lighting: crate::view::lighting::resolve(
                    &crate::scene::LightingSpec::default(),
                    DVec3::ONE,
                    1,
                )
                .unwrap(),
            },
            world: World {
                spaces,
                vertical_exaggeration: 2.0,
                space: crate::model::Space::Map,
                bounds: [DVec3::new(0.0, 0.0, -4.0), DVec3::new(10.0, 9.0, 0.0)],
                corners: box_corners,
                subject: crate::view::Subject::of_box(box_corners).into(),
            },
            sampling: Sampling {
                strategy: StrategyKind::ALL[0],
                step: 1.0,
                early_termination: 0.0,
                supersample: 1,
                libc: crate::scene::LibcSettings::default(),
                plts: crate::scene::PltsSettings::default(),
                srg: crate::scene::SrgSettings::default(),
                storage: crate::scene::Storage::default(),
            },
            shown: Shown {
                property: "SWAT".into(),
                step: 0,
                wells: std::sync::Arc::default(),
                cells: ShownCells::new(
                    CellField::new(Vec::new()).into(),
                    Vec::new(),
                    Interpolation::Cell,
                ),
                connections: std::sync::Arc::default(),
                named_faults: std::sync::Arc::default(),
                chosen_faults: None,
                cube: None,
                clip: Vec::new(),
            },
            notes: Notes {
                has_box: true,
                has_legend: true,
                facts: None,
                units: crate::case::Units::default(),
                warnings: Vec::new(),
            },
        }
    }

    fn notes(title: &str, show_legend: bool, show_box: bool) -> Annotations {
        Annotations {
            title: title.into(),
            property: "SWAT".into(),
            measure: Measure::of_file("m3"),
            lengths: Lengths::named("m"),
            show_legend,
            show_box,
            ..Annotations::default()
        }
    }

    fn with_info(notes: Annotations) -> Annotations {
        Annotations {
            info: Some(Info::of_items(&["12,204 of 35,817 cells", "SWAT 0 to 1"])),
            ..notes
        }
    }

    fn layout(size: [u32; 2], view: &View, notes: &Annotations) -> Layout {
        let unit = Pen::unit_of(size);
        let canvas = Canvas::new(size, &mut []);
        let width = |text: &str| canvas.text_width(text, unit);
        let key = notes.key(view, unit, &width);
        let parts = notes.parts(view, &key, f64::from(size[1]));
        Layout::of(DVec2::from_array(size.map(f64::from)), unit, &parts)
    }

    /// A picture of a size of a volume that covers the background by the given alpha.
    fn drawn_of(
        size: [u32; 2],
        background: f64,
        notes: &Annotations,
        alpha: f32,
        change: impl Fn(&mut View),
    ) -> (Layout, Rgb8) {
        let mut seen = view(size, background);
        change(&mut seen);
        let layout = layout(size, &seen, notes);
        seen = view(layout.volume_size(), background);
        change(&mut seen);
        let count = seen.size[0] as usize * seen.size[1] as usize;
        let image = Image {
            size: seen.size,
            blending: seen.style.blending,
            // A color that nothing beside the volume has.
            pixels: vec![[0.0, alpha, 0.0, alpha]; count],
        };
        let picture = composed(&image, &seen, &layout, notes, &|_| ());
        assert_eq!(picture.size, size);
        assert_eq!(picture.pixels.len(), (size[0] * size[1]) as usize);
        (layout, picture)
    }

    fn drawn(size: [u32; 2], notes: &Annotations, alpha: f32) -> (Layout, Rgb8) {
        drawn_of(size, 1.0, notes, alpha, |_| ())
    }

    /// Pixels in an area that are not of a color.
    fn other_than(color: [u8; 3], picture: &Rgb8, [low, high]: Area) -> usize {
        let width = picture.size[0] as usize;
        let rows = picture.pixels.chunks(width).enumerate();
        let inside = |n: usize, low: f64, high: f64| (low..high).contains(&(n as f64 + 0.5));
        let pixels = rows.flat_map(|(y, row)| row.iter().enumerate().map(move |(x, p)| (x, y, p)));
        pixels
            .filter(|(x, y, p)| {
                **p != color && inside(*x, low.x, high.x) && inside(*y, low.y, high.y)
            })
            .count()
    }

    fn area(area: Area) -> usize {
        (area[1] - area[0]).element_product() as usize
    }

    const WHITE: [u8; 3] = [255; 3];
    const GREEN: [u8; 3] = [0, 255, 0];

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
                let (_, picture) = drawn(size, &with_info(notes(title, true, true)), 0.0);
                let small = size[0] < 200 || size[1] < 150;
                let is_bare = picture.pixels.iter().all(|p| *p == WHITE);
                assert_eq!(is_bare, small, "{size:?}");
            }
        }
    }

    #[test]
    fn ok_odd_views_are_drawn_without_panic() {
        let all = notes("REEK", true, true);
        for odd in [f64::NAN, f64::INFINITY, 0.0, -1e300] {
            drawn_of([300, 200], 0.2, &all, 0.5, |view| {
                view.camera.right *= odd;
                let mut corners = view.world.corners;
                corners[3].x = odd;
                view.world.subject = crate::view::Subject::of_box(corners).into();
                view.style.transfer.range = [odd, 1.0];
                view.style.transfer.opacity = vec![(0.0, odd)];
                view.world.vertical_exaggeration = odd;
            });
        }
    }

    #[test]
    fn nothing_beside_the_volume_covers_it() {
        let notes = with_info(notes(&"REEK ".repeat(30), true, false));
        for size in [
            [1000, 750],
            [640, 480],
            [300, 200],
            [1600, 600],
            [480, 640],
            [250, 1500],
        ] {
            let (layout, picture) = drawn(size, &notes, 1.0);
            let volume = layout.volume;
            assert_eq!(other_than(GREEN, &picture, volume), 0, "{size:?}");
            // And all of it is there.
            let whole = [DVec2::ZERO, layout.size];
            let green = area(whole) - other_than(GREEN, &picture, whole);
            assert_eq!(green, area(volume), "{size:?}");
            for part in [layout.title, layout.info, layout.legend] {
                assert!(other_than(WHITE, &picture, part.unwrap()) > 50, "{size:?}");
            }
        }
    }

    #[test]
    fn what_belongs_to_the_model_stays_in_its_rectangle() {
        let bare = drawn([640, 480], &notes("REEK", true, false), 0.0);
        let boxed = drawn([640, 480], &notes("REEK", true, true), 0.0);
        assert_eq!(bare.0, boxed.0);
        let [low, high] = bare.0.volume;
        let pairs = bare.1.pixels.iter().zip(&boxed.1.pixels).enumerate();
        let changed: Vec<usize> = pairs.filter(|(_, (a, b))| a != b).map(|(n, _)| n).collect();
        assert!(changed.len() > 500);
        for n in changed {
            let at = DVec2::new((n % 640) as f64, (n / 640) as f64);
            assert!(at.cmpge(low).all() && at.cmplt(high).all(), "{at}");
        }
    }

    #[test]
    fn nothing_changes_where_nothing_is_drawn() {
        let (layout, picture) = drawn([400, 300], &notes("REEK", false, false), 0.0);
        assert!(picture.pixels.iter().all(|p| *p == WHITE));
        assert_eq!(layout.volume, [DVec2::ZERO, layout.size]);
        // With title and legend all else stays.
        let (layout, picture) = drawn([400, 300], &notes("REEK", true, false), 0.0);
        assert_eq!(other_than(WHITE, &picture, layout.volume), 0);
        assert!(layout.info.is_none());
    }

    #[test]
    fn text_follows_the_title_and_stands_out_from_the_background() {
        let picture = |background, title| {
            let notes = with_info(notes(title, true, false));
            let (_, picture) = drawn_of([400, 300], background, &notes, 0.0, |_| ());
            let rows = |from: usize, to: usize| picture.pixels[400 * from..400 * to].to_vec();
            [rows(0, 24), rows(270, 300)]
        };
        assert_ne!(picture(1.0, "REEK")[0], picture(1.0, "NORNE")[0]);
        for part in picture(1.0, "REEK") {
            assert!(part.iter().any(|p| p[0] < 80));
        }
        for part in picture(0.1, "REEK") {
            assert!(part.iter().any(|p| p[0] > 190));
        }
    }

    #[test]
    fn step_and_date_stay_behind_a_long_title() {
        let picture = |title: &str, when: &str| {
            let notes = Annotations {
                when: when.into(),
                ..notes(title, true, false)
            };
            let (_, picture) = drawn([200, 150], &notes, 0.0);
            picture.pixels[..200 * 25].to_vec()
        };
        for title in ["REEK", &"REEK ".repeat(100)] {
            let first = picture(title, "   2001-01-01   report 1");
            assert_eq!(first, picture(title, "   2001-01-01   report 1"));
            assert_ne!(first, picture(title, "   2001-01-02   report 1"));
        }
    }

    #[test]
    fn box_lies_under_the_volume() {
        let boxed = notes("", false, true);
        // Right of the axes, and above the coordinates.
        let middle = [DVec2::new(120.0, 0.0), DVec2::new(400.0, 200.0)];
        let (_, picture) = drawn([400, 300], &boxed, 0.0);
        assert!(other_than(WHITE, &picture, middle) > 100);
        let (_, picture) = drawn([400, 300], &boxed, 1.0);
        assert_eq!(other_than(GREEN, &picture, middle), 0);
    }
}
