//! A comparison as files: pictures, difference maps, contact sheet, plots and tables.

use std::path::{Path, PathBuf};
use std::time::Duration;
use std::{fs, io};

use super::sheet::Sheet;
use super::tables::Setting;
use super::{Compared, Outcome, Row, Source, plots, tables};
use crate::image::Rgb8;
use crate::picture::{PictureError, SheetError, difference_picture, write_png};

const ROWS: &str = "compare.json";
const PAGE: &str = "compare.md";

/// A folder in which a comparison is written, view by view.
pub struct Report<'a> {
    folder: &'a Path,
    setting: Setting<'a>,
    rows: Vec<Row>,
    reference_times: Vec<Duration>,
    sheet: Sheet,
}

/// Why a report could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A picture could not be written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The contact sheet cannot be made.
    #[error(transparent)]
    Sheet(#[from] SheetError),
    /// The folder or a table could not be written.
    #[error("cannot write {path}: {cause}")]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
}

impl ReportError {
    fn write(path: &Path) -> impl FnOnce(io::Error) -> Self {
        |cause| Self::Write {
            path: path.to_owned(),
            cause,
        }
    }
}

impl<'a> Report<'a> {
    /// Begins a report in a folder, which is made where it is missing; files of the same names in it
    /// are replaced.
    ///
    /// # Errors
    /// When the folder cannot be made.
    pub fn begin(folder: &'a Path, setting: Setting<'a>) -> Result<Self, ReportError> {
        fs::create_dir_all(folder).map_err(ReportError::write(folder))?;
        Ok(Self {
            folder,
            setting,
            rows: Vec::new(),
            reference_times: Vec::new(),
            sheet: Sheet::default(),
        })
    }

    /// Writes the pictures and difference maps of a view.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn add(&mut self, compared: Compared) -> Result<(), ReportError> {
        let Setting {
            plan,
            difference_scale,
            ..
        } = self.setting;
        self.sheet.add(plan, &compared, difference_scale);
        for (truth, found) in plan.truths.iter().zip(&compared.truths) {
            if let Ok(picture) = &found.picture {
                self.reference_times.push(found.time);
                if !matches!(truth.source, Source::Contender(_)) {
                    let name = plan.picture_file(compared.view, &truth.name);
                    self.write(&name, picture)?;
                }
            }
        }
        for outcome in compared.outcomes {
            let row = self.files_of(outcome)?;
            self.rows.push(row);
        }
        Ok(())
    }

    /// Writes what is over all views that were added: contact sheet, plots, `compare.json` with the rows and
    /// `compare.md`; gives the rows.
    ///
    /// # Errors
    /// When there are no views or a file cannot be written.
    pub fn finish(self) -> Result<Vec<Row>, ReportError> {
        let Setting { case, plan, .. } = self.setting;
        self.write(tables::SHEET, &self.sheet.picture()?)?;
        for (file, picture) in plots::all(case, plan, &self.rows) {
            self.write(file, &picture)?;
        }
        let json = serde_json::to_string_pretty(&self.rows);
        self.write_text(ROWS, json.map_err(io::Error::from))?;
        let page = tables::page(&self.setting, &self.rows, &self.reference_times);
        self.write_text(PAGE, Ok(page))?;
        Ok(self.rows)
    }

    /// Writes picture and difference map of an outcome; gives its row with their names.
    fn files_of(&self, outcome: Outcome) -> Result<Row, ReportError> {
        let plan = self.setting.plan;
        let Outcome {
            mut row,
            picture,
            differences,
        } = outcome;
        if let Some(picture) = &picture {
            let name = plan.picture_file(row.view, row.name());
            self.write(&name, picture)?;
            row.picture = Some(name);
        }
        if let (Some(differences), Some(Rgb8 { size, .. })) = (&differences, &picture) {
            let name = plan.picture_file(row.view, &format!("{}_difference", row.name()));
            let [own, reference] = [row.name(), &row.reference];
            let title = format!("{own} against {reference}, view {}", row.view_title());
            let scale = self.setting.difference_scale;
            self.write(
                &name,
                &difference_picture(differences, *size, scale, &title),
            )?;
            row.difference = Some(name);
        }
        Ok(row)
    }

    fn write(&self, name: &str, picture: &Rgb8) -> Result<(), ReportError> {
        let path = self.folder.join(name);
        Ok(write_png(&path, picture.size, &picture.pixels)?)
    }

    fn write_text(&self, name: &str, text: io::Result<String>) -> Result<(), ReportError> {
        let path = self.folder.join(name);
        let written = text.and_then(|text| fs::write(&path, text));
        written.map_err(ReportError::write(&path))
    }
}
