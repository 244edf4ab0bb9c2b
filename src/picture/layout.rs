//! Where the parts of a picture are: title, line of facts and legend stand beside the volume, never over it.

use glam::DVec2;

use super::orientation::Area;

/// Rectangles of the parts of a picture, in pixels, or points of the window, from its upper left corner.
///
/// **Invariants**: they lie in the picture and apart from each other, at whole numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Width and height of the whole picture.
    pub size: DVec2,
    /// Text height; the unit of every size here.
    pub unit: f64,
    /// The title, along the top.
    pub title: Option<Area>,
    /// Facts on what is drawn, along the bottom.
    pub info: Option<Area>,
    /// Lines of text that `info` has room for.
    pub info_lines: usize,
    /// The legend, at the right.
    pub legend: Option<Area>,
    /// That of a volume beside the model, or of another picture in the same place, of which the left part is seen; at the
    /// left.
    pub left_legend: Option<Area>,
    /// Legends have no heading and little more than their ends.
    pub is_narrow: bool,
    /// All the rest: the volume, with what belongs to the model.
    pub volume: Area,
    /// Nothing is drawn over the volume either.
    pub is_plain: bool,
}

/// What is shown beside the volume.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Parts {
    /// A title.
    pub title: bool,
    /// Facts on what is drawn.
    pub info: Option<Length>,
    /// The legend.
    pub legend: Option<LegendWidths>,
    /// That of a volume beside the model, or of another picture in the same place.
    pub left_legend: Option<LegendWidths>,
}

/// How much there is to say of what is drawn. It does not change from one time step to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Length {
    /// As much as of most pictures.
    Usual,
    /// More: filters and cuts.
    Long,
}

/// Widths that a legend needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LegendWidths {
    /// With heading, opacities and all labels.
    pub full: f64,
    /// Of a narrow one.
    pub narrow: f64,
}

/// Pictures lower or narrower than this show the volume alone: nothing would be readable.
const SMALLEST: DVec2 = DVec2::new(200.0, 150.0);
/// Those lower or narrower than this have a narrow legend and one line of facts.
const SMALL: DVec2 = DVec2::new(320.0, 240.0);
/// Part of the picture's width that legends may take: where full ones would take more they are narrow, and where
/// narrow ones would, there are none.
const LEGENDS: f64 = 0.3;
/// Heights of the title, and of facts beside their lines, in text heights.
const TITLE: f64 = 2.2;
const INFO: f64 = 0.8;
/// From one line of text to the next, in text heights.
pub const LINE: f64 = 1.25;
/// Text heights from where a picture is so wide that the usual facts stand in one line, and more of them.
const WIDE: f64 = 50.0;
const WIDER: f64 = 85.0;

impl Layout {
    /// The volume alone.
    pub fn plain(size: DVec2, unit: f64) -> Self {
        Self {
            size,
            unit,
            title: None,
            info: None,
            info_lines: 0,
            legend: None,
            left_legend: None,
            is_narrow: false,
            volume: [DVec2::ZERO, size],
            is_plain: true,
        }
    }

    /// The parts of a picture of a size with text of a height.
    ///
    /// Sizes do not depend on texts but for the width of legends, so that the volume stays where it is from one
    /// time step to the next.
    pub fn of(size: DVec2, unit: f64, parts: &Parts) -> Self {
        let mut layout = Self::plain(size, unit);
        if size.cmplt(SMALLEST).any() {
            return layout;
        }
        layout.is_plain = false;
        let is_small = size.cmplt(SMALL).any();
        let [low, high] = &mut layout.volume;
        if parts.title {
            let bottom = (TITLE * unit).round();
            layout.title = Some([DVec2::ZERO, DVec2::new(size.x, bottom)]);
            low.y = bottom;
        }
        if let Some(length) = parts.info {
            let wide = match length {
                Length::Usual => WIDE,
                Length::Long => WIDER,
            };
            layout.info_lines = if is_small || size.x > wide * unit {
                1
            } else {
                2
            };
            let height = (LINE * layout.info_lines as f64 + INFO) * unit;
            let top = (size.y - height).round();
            layout.info = Some([DVec2::new(0.0, top), size]);
            high.y = top;
        }
        let legends = [parts.left_legend, parts.legend];
        let width = |of: fn(&LegendWidths) -> f64| {
            let each = legends.map(|l| l.as_ref().map_or(0.0, of).round());
            (each[0] + each[1], each)
        };
        let (full, narrow) = (width(|l| l.full), width(|l| l.narrow));
        let [left, right] = match () {
            () if !is_small && full.0 <= LEGENDS * size.x => full.1,
            () if narrow.0 <= LEGENDS * size.x => {
                layout.is_narrow = true;
                narrow.1
            }
            () => [0.0; 2],
        };
        let [top, bottom] = [low.y, high.y];
        let strip = |from: f64, to: f64| {
            let area = [DVec2::new(from, top), DVec2::new(to, bottom)];
            (from < to).then_some(area)
        };
        layout.left_legend = strip(0.0, left);
        layout.legend = strip(size.x - right, size.x);
        low.x = left;
        high.x = size.x - right;
        layout
    }

    /// Width and height of the volume in pixels.
    pub fn volume_size(&self) -> [u32; 2] {
        let [low, high] = self.volume;
        (high - low).max(DVec2::ONE).to_array().map(|n| n as u32)
    }

    /// Upper left corner of the volume in pixels.
    pub fn volume_corner(&self) -> [u32; 2] {
        self.volume[0].to_array().map(|n| n as u32)
    }

    /// Place in the volume (x right, y down, 0 to 1) of a place in the picture, given in its pixels from the upper
    /// left corner, so that the middle of the first pixel is at 0.5; `None` beside the volume.
    pub fn volume_place(&self, at: [f64; 2]) -> Option<DVec2> {
        let [low, high] = self.volume;
        let place = (DVec2::from_array(at) - low) / (high - low);
        (place.cmpge(DVec2::ZERO).all() && place.cmplt(DVec2::ONE).all()).then_some(place)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use crate::picture::pen::Pen;

    const SIZES: [[u32; 2]; 14] = [
        [1, 1],
        [199, 400],
        [200, 150],
        [300, 200],
        [319, 900],
        [320, 240],
        [640, 480],
        [480, 640],
        [1000, 750],
        [1000, 1000],
        [1600, 600],
        [250, 1500],
        [3840, 2160],
        [16384, 300],
    ];

    fn all_parts(unit: f64) -> impl Iterator<Item = Parts> {
        let legend = Some(LegendWidths {
            full: 9.0 * unit,
            narrow: 5.5 * unit,
        });
        (0..16).map(move |n| Parts {
            title: n & 1 > 0,
            info: (n & 2 > 0).then_some(Length::Long),
            legend: legend.filter(|_| n & 4 > 0),
            left_legend: legend.filter(|_| n & 8 > 0),
        })
    }

    fn areas(layout: &Layout) -> Vec<Area> {
        let parts = [
            layout.title,
            layout.info,
            layout.legend,
            layout.left_legend,
            Some(layout.volume),
        ];
        parts.into_iter().flatten().collect()
    }

    fn extent(area: &Area) -> f64 {
        (area[1] - area[0]).element_product()
    }

    #[test]
    fn parts_fill_the_picture_and_lie_apart() {
        for size in SIZES {
            let unit = Pen::unit_of(size);
            let whole = DVec2::from_array(size.map(f64::from));
            for parts in all_parts(unit) {
                let layout = Layout::of(whole, unit, &parts);
                let areas = areas(&layout);
                for (n, [low, high]) in areas.iter().enumerate() {
                    assert!(low.cmpge(DVec2::ZERO).all() && high.cmple(whole).all());
                    assert!(low.cmplt(*high).all(), "{size:?} {layout:?}");
                    assert_eq!([low.fract(), high.fract()], [DVec2::ZERO; 2]);
                    for [other_low, other_high] in &areas[n + 1..] {
                        let apart = high.cmple(*other_low) | other_high.cmple(*low);
                        assert!(apart.any(), "{size:?} {layout:?}");
                    }
                }
                // Nothing is lost between them.
                let sum: f64 = areas.iter().map(extent).sum();
                assert!((sum - whole.element_product()).abs() < 0.5, "{size:?}");
            }
        }
    }

    #[test]
    fn the_volume_has_most_of_the_picture() {
        for size in SIZES {
            let unit = Pen::unit_of(size);
            let whole = DVec2::from_array(size.map(f64::from));
            for parts in all_parts(unit) {
                let part =
                    extent(&Layout::of(whole, unit, &parts).volume) / whole.element_product();
                let least = match (parts.left_legend, size) {
                    (Some(_), _) => 0.49,
                    (_, [..=320, _] | [_, ..=240]) => 0.56,
                    _ => 0.65,
                };
                assert!(part >= least, "{size:?} {parts:?}: {part}");
            }
        }
    }

    #[test]
    fn small_pictures_have_narrow_legends_and_the_smallest_have_nothing() {
        let of = |size: [u32; 2]| {
            let unit = Pen::unit_of(size);
            let parts = all_parts(unit).nth(7).unwrap();
            Layout::of(DVec2::from_array(size.map(f64::from)), unit, &parts)
        };
        for (size, is_narrow, lines) in [
            ([300, 200], true, 1),
            ([400, 300], false, 2),
            ([1000, 750], false, 2),
            ([1600, 600], false, 1),
        ] {
            let layout = of(size);
            assert_eq!((layout.is_narrow, layout.info_lines), (is_narrow, lines));
            assert!(layout.legend.is_some(), "{size:?}");
        }
        let bare = of([199, 400]);
        assert_eq!(bare.volume_size(), [199, 400]);
        assert!(bare.title.is_none() && bare.legend.is_none());
    }

    #[test]
    fn places_in_the_volume_are_told_from_those_beside_it() {
        let parts = all_parts(10.0).nth(15).unwrap();
        let layout = Layout::of(DVec2::new(800.0, 600.0), 10.0, &parts);
        let [low, high] = layout.volume;
        let place = |at: DVec2| layout.volume_place(at.to_array());
        assert_eq!(place(low), Some(DVec2::ZERO));
        assert!(
            place(0.5 * (low + high))
                .unwrap()
                .abs_diff_eq(DVec2::splat(0.5), 1e-12)
        );
        for beside in [layout.title, layout.info, layout.legend, layout.left_legend] {
            let [low, high] = beside.unwrap();
            assert_eq!(place(0.5 * (low + high)), None);
        }
        assert_eq!(place(high), None);
        let size = layout.volume_size().map(f64::from);
        assert_eq!(DVec2::from_array(size), high - low);
    }
}
