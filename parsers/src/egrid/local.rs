//! Local grids: finer cells in place of some of their parent's.

use super::section::Section;
use crate::error::{ParseError, Warnings};
use crate::records::RecordFile;

/// A local grid: sections from LGR to ENDLGR, or what a deck makes of CARFIN with coordinates in f64.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LocalGrid<T = f32> {
    /// Name.
    pub name: String,
    /// Name of the grid it refines; empty for the global grid.
    pub parent: String,
    /// Number by which connections name it, from 1 (item 5 of GRIDHEAD).
    pub number: i32,
    /// Cells along i, j and k; in a radial grid radius, angle and k.
    pub dims: [usize; 3],
    /// **Shape**: 6 values per pillar: x, y, depth of the upper, then of the lower end. In a radial grid x is the
    /// radius, and y the angle in degrees; where it goes around, the first and the last angle are the same place.
    /// Several coordinate systems follow each other.
    pub coord: Vec<T>,
    /// COORDSYS: six values for each coordinate system, of which the first two are its layers, from 1.
    pub coord_systems: Option<Vec<i32>>,
    /// **Shape**: 8 depths per cell, as [`super::Egrid::zcorn`].
    pub zcorn: Vec<T>,
    /// One value per cell, as [`super::Egrid::actnum`].
    pub actnum: Option<Vec<i32>>,
    /// HOSTNUM: for each cell the number of the parent's cell that it lies in, from 1; empty where it is not written.
    pub host: Vec<i32>,
    /// First and last cell along i, j, k of the box in the parent, from 1, where GRIDHEAD names it.
    pub host_box: Option<[[i32; 3]; 2]>,
    /// BOXES, as written, where there are any.
    pub boxes: Option<Vec<i32>>,
    /// True where COORD holds radii and angles.
    pub is_radial: bool,
}

impl LocalGrid {
    /// The same with coordinates in f64.
    pub fn widened(self) -> LocalGrid<f64> {
        let wide = |values: Vec<f32>| values.into_iter().map(f64::from).collect();
        LocalGrid {
            coord: wide(self.coord),
            zcorn: wide(self.zcorn),
            name: self.name,
            parent: self.parent,
            number: self.number,
            dims: self.dims,
            coord_systems: self.coord_systems,
            actnum: self.actnum,
            host: self.host,
            host_box: self.host_box,
            boxes: self.boxes,
            is_radial: self.is_radial,
        }
    }

    /// Number of active cells.
    pub fn active(&self) -> usize {
        match &self.actnum {
            Some(actnum) => actnum.iter().filter(|a| **a != 0).count(),
            None => self.zcorn.len() / 8,
        }
    }
}

/// What makes a local grid of its section, and of its number in the file, from 1.
pub(super) type Reader = fn(&Section<'_>, i32, &mut Warnings) -> Result<LocalGrid, ParseError>;

/// The local grids of a file; one that is damaged is left out with a warning.
pub(super) fn read(file: &RecordFile, warnings: &mut Warnings, reader: Reader) -> Vec<LocalGrid> {
    let mut grids: Vec<LocalGrid> = Vec::new();
    for (section, number) in sections(file).zip(1..) {
        match reader(&section, number, warnings) {
            Ok(grid) => grids.push(grid),
            Err(error) => {
                let keyword = match error.keyword.as_str() {
                    "" => String::new(),
                    keyword => format!("{keyword}: "),
                };
                let name = section.string("LGR").ok().flatten().unwrap_or_default();
                let message = format!("local grid {name} was left out: {keyword}{}", error.message);
                warnings.push(file.path(), error.at, message);
            }
        }
    }
    grids
}

/// Arrays from each LGR to the ENDLGR behind it, or to the next LGR.
fn sections(file: &RecordFile) -> impl Iterator<Item = Section<'_>> {
    let entries = file.entries();
    let starts = (0..entries.len()).filter(|n| entries[*n].name() == "LGR");
    starts.map(move |start| {
        let rest = &entries[start..];
        let is_end = |name: &str| name == "ENDLGR" || name == "LGR" || name.starts_with("NNCHEAD");
        let length = rest.iter().skip(1).position(|e| is_end(e.name()));
        let entries = &rest[..length.map_or(rest.len(), |n| n + 1)];
        Section { file, entries }
    })
}

/// A local grid of EGRID.
pub(super) fn grid(
    section: &Section<'_>,
    counted: i32,
    _warnings: &mut Warnings,
) -> Result<LocalGrid, ParseError> {
    let head = section.head()?;
    let geometry = section.geometry(head.dims)?;
    let integers = |name: &str| {
        let entry = section.find(name);
        entry.map(|e| section.file.i32s(e)).transpose()
    };
    let host = section.of_cells("HOSTNUM", geometry.zcorn.len() / 8)?;
    Ok(LocalGrid {
        name: section.string("LGR")?.unwrap_or_default(),
        parent: section.string("LGRPARNT")?.unwrap_or_default(),
        number: if head.number > 0 {
            head.number
        } else {
            counted
        },
        dims: head.dims,
        coord: geometry.coord,
        coord_systems: integers("COORDSYS")?,
        zcorn: geometry.zcorn,
        actnum: geometry.actnum,
        host: host.unwrap_or_default(),
        host_box: head.host_box,
        boxes: integers("BOXES")?,
        is_radial: head.is_radial,
    })
}
