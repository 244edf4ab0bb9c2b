//! Two pictures as one: beside each other, or one over the other up to a line; and what each has of its own.

use glam::DVec2;

use super::annotate::{Annotations, when};
use super::pen::Pen;
use crate::case::Case;
use crate::image::Rgb8;
use crate::view::View;

/// Pixels between pictures that stand beside each other, and of a wipe's line.
const GAP: u32 = 2;
const LINE: [u8; 3] = [128; 3];

/// Sizes of two pictures that stand beside each other in one of a size.
pub fn halves([width, height]: [u32; 2]) -> [[u32; 2]; 2] {
    let left = width.saturating_sub(GAP) / 2;
    let right = width.saturating_sub(GAP + left);
    [left, right].map(|width| [width.max(1), height])
}

/// Two pictures beside each other.
pub fn beside([left, right]: [&Rgb8; 2]) -> Rgb8 {
    let width = left.size[0] + GAP + right.size[0];
    let height = left.size[1].max(right.size[1]);
    let mut both = Rgb8::filled([width, height], LINE);
    both.paste(left, [0, 0]);
    both.paste(right, [left.size[0] + GAP, 0]);
    both
}

/// The first picture left of a part of the width, the second one right of it.
pub fn wipe([left, right]: [&Rgb8; 2], at: f64) -> Rgb8 {
    let column = (at.clamp(0.0, 1.0) * f64::from(right.size[0])).round() as u32;
    let mut both = right.clone();
    both.paste(&cropped(left, column), [0, 0]);
    let line = Rgb8::filled([GAP, right.size[1]], LINE);
    both.paste(&line, [column.saturating_sub(GAP / 2), 0]);
    both
}

/// The left part of a picture, some columns wide.
pub fn cropped(picture: &Rgb8, columns: u32) -> Rgb8 {
    let columns = columns.min(picture.size[0]);
    let rows = picture.pixels.chunks(picture.size[0].max(1) as usize);
    Rgb8 {
        size: [columns, picture.size[1]],
        pixels: rows
            .flat_map(|row| &row[..(columns as usize).min(row.len())])
            .copied()
            .collect(),
    }
}

/// Writes what a picture has of its own below the place of its title, from a column on, in letters that suit a
/// picture of `size`.
pub fn write_own(picture: &mut Rgb8, view: &View, size: [u32; 2], column: u32, text: &str) {
    let unit = Pen::unit_of(size);
    let mut pen = Pen::new(picture.canvas(), view.style.background, unit);
    let left = f64::from(column) + unit;
    let (top, end) = (2.4 * unit, left + pen.canvas.text_width(text, unit));
    pen.plate(
        [left - 0.5 * unit, top - 0.2 * unit],
        [end + 0.5 * unit, top + 1.3 * unit],
    );
    pen.write(text, [left, top]);
}

/// Writes a line at the top of a map that has no title.
pub fn write_title(picture: &mut Rgb8, text: &str) {
    let unit = Pen::unit_of(picture.size);
    Pen::new(picture.canvas(), [0.0; 3], unit).title(text);
}

/// Draws the legend of a view at the right edge of what is seen of its picture.
pub fn draw_legend(part: &mut Rgb8, view: &View, annotations: &Annotations, size: [u32; 2]) {
    let unit = Pen::unit_of(size);
    let [width, height] = part.size.map(f64::from);
    let mut pen = Pen::new(part.canvas(), view.style.background, unit);
    let legend = {
        let text = |text: &str| pen.canvas.text_width(text, unit);
        let key = annotations.key(view, unit, &text);
        let left = width - key.widths(0.85 * height).full;
        let strip = [[left, 2.0 * unit], [width, height - 2.0 * unit]].map(DVec2::from_array);
        key.laid_out(strip, false)
    };
    pen.legend(&legend);
}

/// What two pictures have each of its own: case, property, date, strategy.
pub fn differing(of: [(&Case, &View); 2]) -> [String; 2] {
    let facts = of.map(|(case, view)| {
        [
            case.about.name.clone(),
            case.title_of(&view.shown.property),
            when(case, view),
            view.sampling.strategy.name().to_uppercase(),
        ]
    });
    let differ = |n: &usize| facts[0][*n] != facts[1][*n];
    let own = |facts: &[String; 4]| {
        let own: Vec<_> = (0..4).filter(differ).map(|n| facts[n].as_str()).collect();
        own.join("   ")
    };
    [own(&facts[0]), own(&facts[1])]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_pictures_become_one_of_the_size_asked_for() {
        for size in [[200, 100], [201, 3], [1, 1]] {
            let parts = halves(size);
            let pictures = [0, 1].map(|n| Rgb8::filled(parts[n], [n as u8 + 1; 3]));
            let both = beside([&pictures[0], &pictures[1]]);
            assert!(both.size == size || size[0] < 4, "{:?}", both.size);
            assert_eq!(both.pixels[0], [1; 3]);
            assert_eq!(both.pixels.last(), Some(&[2; 3]));
        }
    }

    #[test]
    fn a_wipe_shows_each_on_its_side() {
        let [a, b] = [1, 2].map(|v| Rgb8::filled([100, 4], [v; 3]));
        let both = wipe([&a, &b], 0.25);
        let row: Vec<u8> = both.pixels[..100].iter().map(|p| p[0]).collect();
        assert!(row[..24].iter().all(|v| *v == 1) && row[26..].iter().all(|v| *v == 2));
        assert_eq!(row[24..26], [128, 128]);
        for (at, column) in [(-1.0, 50), (2.0, 50), (f64::NAN, 50)] {
            assert_eq!(wipe([&a, &b], at).size, [100, 4], "{column}");
        }
        assert_eq!(cropped(&a, 500), a);
    }
}
