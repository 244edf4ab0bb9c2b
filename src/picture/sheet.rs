//! Contact sheets: pictures side by side, each with a caption.

use super::pen::Pen;
use crate::image::{Rgb8, srgb_8bit};

/// A picture on a contact sheet.
#[derive(Debug, Clone, Copy)]
pub struct SheetImage<'a> {
    /// The picture.
    pub picture: &'a Rgb8,
    /// Lines of text under it: four at most are shown, and cut where they are wider than the picture.
    pub caption: &'a str,
}

/// Lines of a caption that are shown.
const MOST_LINES: usize = 4;

/// Why a contact sheet cannot be made.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SheetError {
    /// There is no picture, or one without pixels.
    #[error("a contact sheet needs at least one image with pixels")]
    Empty,
    /// The pictures have unlike sizes.
    #[error(
        "image {number} is {}x{} pixels, the first {}x{}: a contact sheet takes one size",
        .size[0], .size[1], .first[0], .first[1]
    )]
    UnlikeSizes {
        /// Which picture, counted from 1.
        number: usize,
        /// Its size.
        size: [u32; 2],
        /// Size of the first.
        first: [u32; 2],
    },
    /// The sheet would be too wide or too high.
    #[error("a contact sheet of {columns} by {rows} images is too large: use fewer")]
    TooLarge {
        /// Pictures in a row.
        columns: usize,
        /// Rows.
        rows: usize,
    },
}

/// Where things are on a sheet, in pixels.
struct SheetLayout {
    columns: usize,
    rows: usize,
    picture: [u32; 2],
    gap: u32,
    caption: u32,
}

/// Pictures of one size in rows of `columns`, each with its caption, over a background (sRGB, 0..1).
///
/// Sheets have equal sizes where number and size of the pictures and the captions' lines are equal,
/// as the pictures of a film must.
///
/// # Errors
/// When there are no pictures, when their sizes differ, or when the sheet would be too large.
pub fn contact_sheet(
    tiles: &[SheetImage],
    columns: usize,
    background: [f64; 3],
) -> Result<Rgb8, SheetError> {
    let size = one_size(tiles)?;
    let unit = Pen::unit_of(size);
    let lines = tiles.iter().map(|t| t.caption.lines().count()).max();
    let lines = lines.unwrap_or(0).min(MOST_LINES);
    let columns = columns.clamp(1, tiles.len());
    let layout = SheetLayout {
        columns,
        rows: tiles.len().div_ceil(columns),
        picture: size,
        gap: unit.round() as u32,
        caption: (1.3 * unit * lines as f64).ceil() as u32,
    };
    let mut sheet = Rgb8::filled(layout.size()?, srgb_8bit(background));
    for (n, tile) in tiles.iter().enumerate() {
        sheet.paste(tile.picture, layout.corner(n));
    }
    let mut pen = Pen::new(sheet.canvas(), background, unit);
    for (n, tile) in tiles.iter().enumerate() {
        surround(
            &mut pen,
            layout.corner(n).map(f64::from),
            size.map(f64::from),
            tile.caption,
        );
    }
    Ok(sheet)
}

fn one_size(tiles: &[SheetImage]) -> Result<[u32; 2], SheetError> {
    let first = tiles.first().ok_or(SheetError::Empty)?.picture.size;
    if first.contains(&0) {
        return Err(SheetError::Empty);
    }
    let unlike = tiles.iter().position(|t| t.picture.size != first);
    match unlike {
        None => Ok(first),
        Some(n) => Err(SheetError::UnlikeSizes {
            number: n + 1,
            size: tiles[n].picture.size,
            first,
        }),
    }
}

impl SheetLayout {
    /// From one picture's corner to the next one's.
    fn pitch(&self) -> [u32; 2] {
        let [w, h] = self.picture;
        [
            w.saturating_add(self.gap),
            h.saturating_add(self.gap + self.caption),
        ]
    }

    fn size(&self) -> Result<[u32; 2], SheetError> {
        let (columns, rows) = (self.columns, self.rows);
        let side = |n: usize, pitch: u32| {
            let pixels = n as u64 * u64::from(pitch) + u64::from(self.gap);
            u32::try_from(pixels).map_err(|_| SheetError::TooLarge { columns, rows })
        };
        let [x, y] = self.pitch();
        Ok([side(columns, x)?, side(rows, y)?])
    }

    /// Upper left corner of picture `n`.
    fn corner(&self, n: usize) -> [u32; 2] {
        let [x, y] = self.pitch();
        let [column, row] = [n % self.columns, n / self.columns].map(|n| n as u32);
        [self.gap + column * x, self.gap + row * y]
    }
}

/// Draws frame and caption around a picture, whose pixels stay as they are.
fn surround(pen: &mut Pen, [left, top]: [f64; 2], [width, height]: [f64; 2], caption: &str) {
    let (right, bottom) = (left + width, top + height);
    let outside = 0.5 * pen.thin.ceil();
    pen.frame(
        [left - outside, top - outside],
        [right + outside, bottom + outside],
        0.3,
    );
    for (n, line) in caption.lines().take(MOST_LINES).enumerate() {
        let line = pen.canvas.cut(line, pen.unit, width);
        let y = bottom + (0.3 + 1.3 * n as f64) * pen.unit;
        pen.write(&line, [left, y]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: [f64; 3] = [1.0; 3];

    fn tiles<'a>(pictures: &'a [Rgb8], caption: &'a str) -> Vec<SheetImage<'a>> {
        let tile = |picture| SheetImage { picture, caption };
        pictures.iter().map(tile).collect()
    }

    fn pictures(sizes: &[[u32; 2]]) -> Vec<Rgb8> {
        let picture =
            |(n, size): (usize, &[u32; 2])| Rgb8::filled(*size, [10 * n as u8 + 50, 7, 9]);
        sizes.iter().enumerate().map(picture).collect()
    }

    #[test]
    fn ok_every_picture_is_whole_and_in_reading_order() {
        let pictures = pictures(&[[60, 40]; 5]);
        let sheet = contact_sheet(&tiles(&pictures, "plts\nreference"), 3, WHITE).unwrap();
        // Text of 11 pixels, so gaps of 11 and captions of 2.6 * 11.
        assert_eq!(sheet.size, [11 + 3 * 71, 11 + 2 * (40 + 11 + 29)]);
        for (n, picture) in pictures.iter().enumerate() {
            let (left, top) = (11 + 71 * (n % 3), 11 + 80 * (n / 3));
            let color = picture.pixels[0];
            let found: Vec<usize> = (0..sheet.pixels.len())
                .filter(|&p| sheet.pixels[p] == color)
                .collect();
            let width = sheet.size[0] as usize;
            assert_eq!(found.len(), 60 * 40, "{n}");
            assert_eq!((found[0] % width, found[0] / width), (left, top), "{n}");
        }
    }

    #[test]
    fn ok_thick_frames_stay_outside_of_large_pictures() {
        let pictures = pictures(&[[1500, 1400]]);
        let sheet = contact_sheet(&tiles(&pictures, ""), 1, WHITE).unwrap();
        let count = |wanted: &dyn Fn([u8; 3]) -> bool| {
            let pixels = sheet.pixels.iter();
            pixels.filter(|p| wanted(**p)).count()
        };
        let color = pictures[0].pixels[0];
        assert_eq!(count(&|p| p == color), 1500 * 1400);
        assert!(count(&|p| p != color && p != [255; 3]) >= 2 * (1500 + 1400));
    }

    #[test]
    fn ok_captions_change_only_what_is_under_pictures() {
        let pictures = pictures(&[[200, 100]; 2]);
        let sheet = |caption: &str| contact_sheet(&tiles(&pictures, caption), 2, WHITE).unwrap();
        let (a, b) = (sheet("plts"), sheet("libc"));
        assert_eq!(a.size, b.size);
        let width = a.size[0] as usize;
        let changed: Vec<usize> = (0..a.pixels.len())
            .filter(|&p| a.pixels[p] != b.pixels[p])
            .collect();
        assert!(!changed.is_empty() && changed.iter().all(|p| p / width >= 112));
        // A long caption is cut to its picture's width, many lines to four.
        let long = sheet(&"漢字 long \u{0}".repeat(999));
        assert_eq!(long.size, a.size);
        assert_eq!(sheet(&"x\n".repeat(999)).size, sheet("x\nx\nx\nx").size);
        assert!(sheet("").size[1] < a.size[1]);
    }

    #[test]
    fn ok_more_columns_than_pictures() {
        let pictures = pictures(&[[60, 40]; 2]);
        let sheet = |columns| contact_sheet(&tiles(&pictures, ""), columns, WHITE).unwrap();
        assert_eq!(sheet(2).size, sheet(usize::MAX).size);
        assert_eq!(sheet(0).size, sheet(1).size);
        assert_ne!(sheet(1).size, sheet(2).size);
    }

    #[test]
    fn err_sheets_that_cannot_be_made() {
        let error = |sizes: &[[u32; 2]]| {
            let pictures = pictures(sizes);
            contact_sheet(&tiles(&pictures, ""), 2, WHITE).unwrap_err()
        };
        assert_eq!(error(&[]), SheetError::Empty);
        assert_eq!(error(&[[0, 5]]), SheetError::Empty);
        let unlike = error(&[[6, 4], [6, 4], [4, 6]]);
        assert!(
            unlike
                .to_string()
                .starts_with("image 3 is 4x6 pixels, the first 6x4")
        );
        // The sizes alone decide, so nothing is allocated first.
        let huge = Rgb8 {
            size: [u32::MAX, 1],
            pixels: Vec::new(),
        };
        let huge = [huge.clone(), huge];
        let error = contact_sheet(&tiles(&huge, ""), 2, WHITE).unwrap_err();
        assert_eq!(
            error,
            SheetError::TooLarge {
                columns: 2,
                rows: 1
            }
        );
    }
}
