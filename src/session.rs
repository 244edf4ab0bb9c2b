//! The short way in: open a case, read values, locate points, and make images of it, in a few calls.
//!
//! What is behind it are the rooms of the library, each usable by itself; see the [crate's page](crate).

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;

use crate::case::{Case, CaseError, load};
use crate::image::{Image, Rgb8};
use crate::model::{CellField, Spaces};
use crate::picture::Shot;
use crate::reference::{self, Located};
use crate::render::{self, RenderError, Renderer};
use crate::scene::{Interpolation, Scene};
use crate::view::{SceneError, look};

/// An opened case, and what makes images of it once one is asked for.
///
/// ```
/// use strataray::Session;
///
/// # fn main() -> Result<(), strataray::Error> {
/// let session = Session::open("samples/scissor/SCISSOR.EGRID")?;
/// let poro = session.values("PORO", "last")?;
/// assert_eq!(poro.dims, [40, 30, 10]);
/// assert!(poro.of_cell([1, 1, 1]).is_none_or(|v| (0.0..1.0).contains(&v)));
/// # Ok(())
/// # }
/// ```
pub struct Session {
    case: Arc<Case>,
    renderer: Option<Box<dyn Renderer>>,
}

/// Why a session could not do what it was asked for.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be read; [`crate::ParseError::kind`] says what is wrong with it.
    #[error(transparent)]
    Parse(#[from] crate::ParseError),
    /// The case does not have what was asked for.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The scene is wrong, or asks for what the case does not have.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// No image can be made.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// Values of a property at a step.
#[derive(Clone)]
pub struct Values {
    /// Cells along I, J and K.
    pub dims: [usize; 3],
    /// Unit as the files name it; may be empty.
    pub unit: String,
    field: Arc<CellField>,
    case: Arc<Case>,
}

impl Values {
    /// One value for each active cell, local grids included; not a number where a cell has none. Without local grids I is
    /// fastest, then J, then K.
    pub fn active(&self) -> &[f32] {
        self.field.values()
    }

    /// The value of a cell of the main grid by I, J, K from 1; `None` of inactive cells, of those without a value, and
    /// outside the grid.
    pub fn of_cell(&self, [i, j, k]: [usize; 3]) -> Option<f32> {
        let [ni, nj, nk] = self.dims;
        let is_inside = (1..=ni).contains(&i) && (1..=nj).contains(&j) && (1..=nk).contains(&k);
        let grid = &self.case.grid;
        let cell = is_inside.then(|| crate::model::Ijk {
            i: i - 1,
            j: j - 1,
            k: k - 1,
        })?;
        self.field.value(grid, grid.dims().cell(cell))
    }

    /// One value for each cell of the main grid, active or not, I fastest, then J, then K; not a number where there is
    /// none.
    pub fn all(&self) -> Vec<f32> {
        let grid = &self.case.grid;
        let dims = grid.main_dims();
        let mut all = vec![f32::NAN; dims.cells()];
        for (active, cell) in grid.active_in(0) {
            all[dims.cell(cell).0 as usize] = self.field.values()[active];
        }
        all
    }
}

/// Where a point lies.
#[derive(Debug, Clone, PartialEq)]
pub struct Location {
    /// The local grid that has the cell; empty for the main one.
    pub grid: String,
    /// The cell, by I, J, K from 1 in that grid.
    pub cell: [usize; 3],
    /// Parameters in the cell, -1 to 1 along I, J and K.
    pub parameters: [f64; 3],
    /// The value there.
    pub value: f64,
}

impl Session {
    /// Opens a case by any of its files, by its base name, or by a folder with one EGRID file.
    ///
    /// # Errors
    /// When a file cannot be read.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Error> {
        Ok(Self::of(load::open(path.as_ref())?))
    }

    /// Of a case that is there already.
    pub fn of(case: impl Into<Arc<Case>>) -> Self {
        Self {
            case: case.into(),
            renderer: None,
        }
    }

    /// The case in map space: its grid, steps, properties, and what was not loaded.
    pub fn case(&self) -> &Arc<Case> {
        &self.case
    }

    /// The values of a property at a step: a number from 0, a date such as `2001-06-30`, `first` or `last`. Those of a
    /// property that does not change with time are the same at all steps, and `step` is not looked at.
    ///
    /// # Errors
    /// When the case does not have them, or they cannot be read.
    pub fn values(&self, property: &str, step: &str) -> Result<Values, Error> {
        let field = self.field(property, step)?;
        let dims = self.case.grid.main_dims();
        Ok(Values {
            dims: [dims.ni, dims.nj, dims.nk],
            unit: self.case.unit(property).to_owned(),
            field,
            case: self.case.clone(),
        })
    }

    fn field(&self, property: &str, step: &str) -> Result<Arc<CellField>, CaseError> {
        let step = match self.case.is_dynamic(property) {
            true => self.case.step(step)?,
            false => 0,
        };
        self.case.field(property, step)
    }

    /// Locates points, and gives the value there; `None` where a point lies in no active cell, or in one without a
    /// value. Needs no device. Each call builds a search tree: ask for all points at once.
    ///
    /// **Units**: easting and northing in map coordinates, depth positive down, in the grid's length unit.
    ///
    /// # Errors
    /// When the case does not have the values, or they cannot be read.
    pub fn locate(
        &self,
        property: &str,
        step: &str,
        interpolation: Interpolation,
        points: &[[f64; 3]],
    ) -> Result<Vec<Option<Location>>, Error> {
        let field = self.field(property, step)?;
        let grid = &*self.case.grid;
        let spaces = Spaces::new(grid.map_axes(), 1.0);
        let in_grid = |point: &[f64; 3]| {
            let world = spaces.world_from_map(DVec3::from_array(*point));
            spaces.grid_from_world.transform_point3(world)
        };
        let points: Vec<DVec3> = points.iter().map(in_grid).collect();
        let found = reference::values_at(grid, &field, interpolation, &points);
        let location = |(located, value): (Located, f64)| {
            let cell = grid.cell_name(located.ijk);
            Location {
                grid: cell.grid.to_owned(),
                cell: cell.ijk,
                parameters: located.str.to_array(),
                value,
            }
        };
        Ok(found.into_iter().map(|f| f.map(location)).collect())
    }

    /// The scene in which the case opens, with the keys of a scene file in JSON over it; `{}` changes nothing.
    ///
    /// # Errors
    /// When a key is not known, or a value has the wrong form.
    pub fn scene(&self, json: &str) -> Result<Scene, Error> {
        let written = serde_json::from_str(json);
        let written = written.map_err(|e| SceneError::Text(e.to_string()))?;
        Ok(look::opening(&self.case, &written)?)
    }

    /// The picture of a scene with title, legend and axes, over its background, as `strataray render` saves it.
    ///
    /// # Errors
    /// When the scene cannot be shown, or there is no device that makes images.
    pub fn picture(&mut self, scene: &Scene) -> Result<Rgb8, Error> {
        let case = self.case.in_space(scene.space);
        let shot = Shot::of(scene, &case, false)?;
        let image = self.rendered(&shot, &case)?;
        Ok(shot.finished(&image, &case))
    }

    /// The model alone, without a background: red, green and blue times alpha, and alpha.
    ///
    /// # Errors
    /// As [`Self::picture`].
    pub fn image(&mut self, scene: &Scene) -> Result<Image, Error> {
        let case = self.case.in_space(scene.space);
        let shot = Shot::of(scene, &case, true)?;
        self.rendered(&shot, &case)
    }

    fn rendered(&mut self, shot: &Shot, case: &Case) -> Result<Image, Error> {
        let kept = self.renderer.take();
        let kept = match kept.filter(|kept| Arc::ptr_eq(kept.grid(), &case.grid)) {
            Some(kept) => kept,
            None => render::executor(None)?.renderer(&case.grid)?,
        };
        let renderer = self.renderer.insert(kept);
        Ok(renderer.render(&shot.view, &|_| true)?.image)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    fn session() -> Session {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        Session::open(root.join("samples/scissor/SCISSOR.EGRID")).unwrap()
    }

    #[test]
    fn values_are_those_of_cells() {
        let session = session();
        let soil = session.values("SOIL", "last").unwrap();
        let grid = &session.case().grid;
        let all = soil.all();
        assert_eq!(all.len(), soil.dims.iter().product::<usize>());
        assert_eq!(soil.active().len(), grid.active_cells().len());
        let first = grid.active_cells()[7];
        let cell = grid.dims().ijk(first).one_based();
        assert_eq!(soil.of_cell(cell), Some(soil.active()[7]));
        assert_eq!(all[first.0 as usize], soil.active()[7]);
        assert_ne!(soil.of_cell(cell), Some(soil.active()[8]));
        for outside in [[0, 1, 1], [1, 1, soil.dims[2] + 1]] {
            assert_eq!(soil.of_cell(outside), None);
        }
        assert!(matches!(
            session.values("NONE", "last"),
            Err(Error::Case(_))
        ));
        assert!(session.values("SOIL", "1066-10-14").is_err());
    }

    #[test]
    fn points_are_located_in_map_coordinates() {
        let session = session();
        let grid = &session.case().grid;
        let cell = grid.dims().ijk(grid.active_cells()[500]);
        let spaces = Spaces::new(grid.map_axes(), 1.0);
        let world = spaces
            .world_from_grid
            .transform_point3(grid.hexahedron(cell).center());
        let middle = spaces.map_from_world(world).to_array();
        let [x, y, depth] = middle;
        let found = session
            .locate(
                "PORO",
                "last",
                Interpolation::Cell,
                &[middle, [x, y, depth + 1e6]],
            )
            .unwrap();
        let at = found[0].clone().unwrap();
        assert_eq!(at.cell, cell.one_based());
        assert!(at.parameters.iter().all(|p| p.abs() < 0.2), "{at:?}");
        let poro = session.values("PORO", "last").unwrap();
        assert_eq!(at.value, f64::from(poro.of_cell(at.cell).unwrap()));
        assert_eq!(found[1], None);
    }

    #[test]
    fn a_scene_becomes_a_picture() {
        let mut session = session();
        let scene = session.scene(r#"{"size": [160, 120]}"#).unwrap();
        let picture = match session.picture(&scene) {
            Err(Error::Render(error)) if std::env::var_os("REQUIRE_GPU").is_none() => {
                eprintln!("SKIPPED: {error}");
                return;
            }
            picture => picture.unwrap(),
        };
        assert_eq!(picture.size, [160, 120]);
        let image = session.image(&scene).unwrap();
        assert!(image.pixels.iter().any(|p| p[3] > 0.9));
        let error = session.scene(r#"{"sizes": 1}"#).unwrap_err();
        assert!(error.to_string().contains("sizes"), "{error}");
    }
}
