//! Writing an EGRID file.

use std::io::{self, Write};
use std::ops::Range;

use super::{Egrid, PorosityModel};
use crate::geometry;
use crate::records::{RecordWriter, refused};

/// Items of FILEHEAD and GRIDHEAD.
const HEAD_ITEMS: usize = 100;
/// The version and release year of the format, as simulators name them in FILEHEAD.
const VERSION: [i32; 2] = [3, 2007];

impl Egrid {
    /// Writes the grid as a binary file; MAPAXES are rounded to f32, as files hold them.
    ///
    /// # Errors
    /// When writing fails, an array has the wrong length, a coordinate is not finite, or there are
    /// local grids, which are not written.
    pub fn write<W: Write>(&self, out: W) -> io::Result<W> {
        let mut out = RecordWriter::new(out);
        self.write_to(&mut out)?;
        out.finish()
    }

    /// As [`Self::write`], into a file of any form.
    ///
    /// # Errors
    /// As [`Self::write`].
    pub fn write_to<W: Write>(&self, out: &mut RecordWriter<W>) -> io::Result<()> {
        if !self.local_grids.is_empty() || !self.local_nnc.is_empty() {
            return Err(refused("local grids cannot be written".into()));
        }
        let actnum = self.actnum.as_deref();
        let finite = |v: &f32| v.is_finite();
        geometry::check(self.dims, &self.coord, &self.zcorn, actnum, finite)?;
        let cells = self.zcorn.len() / 8;
        if let Some(coarse) = self.coarse.as_ref().filter(|c| c.len() != cells) {
            let found = coarse.len();
            return Err(refused(format!(
                "CORSNUM: expected {cells} values, found {found}"
            )));
        }
        let [ni, nj, nk] = self.dims.map(|n| n as i32);
        out.inte("FILEHEAD", &file_head(self.porosity_model))?;
        if let Some(units) = &self.map_units {
            out.chars("MAPUNITS", &[units])?;
        }
        if let Some(axes) = self.map_axes {
            out.real("MAPAXES", &axes.map(|v| v as f32))?;
        }
        if let Some(unit) = &self.grid_unit {
            let system = if unit.is_map { "MAP" } else { "" };
            out.chars("GRIDUNIT", &[unit.length.as_str(), system])?;
        }
        let mut head = vec![0; HEAD_ITEMS];
        head[..4].copy_from_slice(&[1, ni, nj, nk]);
        // Coordinate systems, of one segment.
        head[24] = 1 + self.reservoirs.len() as i32;
        head[25] = 1;
        out.inte("GRIDHEAD", &head)?;
        let further = self.reservoirs.iter().flat_map(|r| &r.coord);
        let coord: Vec<f32> = self.coord.iter().chain(further).copied().collect();
        out.real("COORD", &coord)?;
        if !self.reservoirs.is_empty() {
            out.inte("COORDSYS", &self.coord_systems()?)?;
        }
        out.real("ZCORN", &self.zcorn)?;
        if let Some(actnum) = actnum {
            out.inte("ACTNUM", actnum)?;
        }
        if let Some(coarse) = &self.coarse {
            out.inte("CORSNUM", coarse)?;
        }
        out.inte("ENDGRID", &[])?;
        if !self.nnc.is_empty() {
            let side = |n: usize| self.nnc.iter().map(|pair| pair[n]).collect::<Vec<_>>();
            out.inte("NNCHEAD", &[self.nnc.len() as i32, 0])?;
            out.inte("NNC1", &side(0))?;
            out.inte("NNC2", &side(1))?;
        }
        Ok(())
    }
}

impl Egrid {
    /// COORDSYS: six numbers for each coordinate system, its layers from 1 first. The first one has the layers before
    /// those of the others.
    fn coord_systems(&self) -> io::Result<Vec<i32>> {
        let nk = self.dims[2];
        let first = self.reservoirs.iter().map(|r| r.layers.start).min();
        let mut systems = vec![0; 6 * (1 + self.reservoirs.len())];
        systems[..2].copy_from_slice(&[1, first.unwrap_or(nk) as i32]);
        for (system, reservoir) in systems.chunks_mut(6).skip(1).zip(&self.reservoirs) {
            let Range { start, end } = reservoir.layers;
            let is_whole = reservoir.coord.len() == self.coord.len();
            if start >= end || end > nk || !is_whole {
                return Err(refused(
                    "a reservoir has no layers, or other pillars".into(),
                ));
            }
            system[..2].copy_from_slice(&[start as i32 + 1, end as i32]);
        }
        Ok(systems)
    }
}

/// FILEHEAD of a corner-point grid (items 5 and 7).
fn file_head(model: PorosityModel) -> Vec<i32> {
    let mut head = vec![0; HEAD_ITEMS];
    head[..2].copy_from_slice(&VERSION);
    head[5] = match model {
        PorosityModel::Single => 0,
        PorosityModel::Dual => 1,
        PorosityModel::DualPermeability => 2,
    };
    head[6] = 1;
    head
}
