//! The contact sheet: a line for each view, with the references and each contender beside its differences.

use super::tables::{figure, with_unit};
use super::{Compared, Outcome, Plan, Row};
use crate::image::Rgb8;
use crate::picture::{SheetError, SheetImage, contact_sheet, difference_colors};

/// Width of the pictures on the sheet at most.
const WIDEST: u32 = 360;

/// The pictures so far, made smaller, with captions.
#[derive(Default)]
pub struct Sheet {
    tiles: Vec<(Rgb8, String)>,
    views: usize,
}

impl Sheet {
    /// Adds the line of a view.
    pub fn add(&mut self, plan: &Plan, compared: &Compared, difference_scale: f64) {
        let Some(first) = plan.contenders.first() else {
            return;
        };
        let size = first.views[compared.view].size;
        let empty = Rgb8::filled(size, [255; 3]);
        let mut add = |picture: Option<&Rgb8>, caption: String| {
            let tile = picture.unwrap_or(&empty).shrunk(WIDEST);
            self.tiles.push((tile, caption));
        };
        let view = format!("view {}, {}", compared.view, plan.views[compared.view]);
        for (truth, found) in plan.truths.iter().zip(&compared.truths) {
            let name = &truth.name;
            let said = match &found.picture {
                Ok(_) => {
                    let ms = 1e3 * found.time.as_secs_f64();
                    format!("{name}, the reference: {ms:.0} ms")
                }
                Err(error) => format!("{name}, the reference, failed: {error}"),
            };
            add(found.picture.as_ref().ok(), format!("{view}\n{said}"));
        }
        let others = compared.outcomes.iter();
        for outcome in others.filter(|o| !o.row.is_reference()) {
            let Outcome {
                row,
                picture,
                differences,
            } = outcome;
            add(picture.as_ref(), format!("{view}\n{}", cost(row)));
            let map = differences.as_ref();
            let map = map.map(|d| difference_colors(d, size, difference_scale));
            add(map.as_ref(), quality(row));
        }
        self.views += 1;
    }

    /// The sheet.
    ///
    /// # Errors
    /// When there are no views, or so many that the sheet would be too large.
    pub fn picture(&self) -> Result<Rgb8, SheetError> {
        let tile = |(picture, caption)| SheetImage { picture, caption };
        let tiles: Vec<SheetImage> = self.tiles.iter().map(|(p, c)| tile((p, c))).collect();
        let columns = tiles.len() / self.views.max(1);
        contact_sheet(&tiles, columns, [1.0; 3])
    }
}

fn cost(row: &Row) -> String {
    match (row.frame_ms, &row.error) {
        (Some(ms), _) => format!("{}: {ms:.0} ms", row.name()),
        (None, Some(error)) => format!("{} failed: {error}", row.name()),
        (None, None) => row.name().to_owned(),
    }
}

fn quality(row: &Row) -> String {
    if row.psnr_db.is_none() {
        return String::new();
    }
    format!(
        "{} against {}\n{}, CIEDE2000 {}",
        row.name(),
        row.reference,
        with_unit(row.psnr_db),
        figure(row.ciede2000_mean, 3)
    )
}
