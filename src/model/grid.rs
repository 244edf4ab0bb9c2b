//! The corner-point grid in compact form: pillars, shared depth lists, activity.
//!
//! Each column has four corners, each on a pillar. The depths of a column corner, from the top of
//! the first layer to the bottom of the last, form a list in one pool; columns around a pillar
//! that have the same list share it. So two columns are displaced along their common edge exactly
//! where their lists differ, and topology needs no storage.
//!
//! ```text
//! corner numbers of a cell          depth list of a column corner
//!        4----5    z = depth          touching layers: D0 D1 D2 .. Dnk        (nk+1)
//!       /|   /|    grows downward    with gaps:       T0 B0 T1 B1 .. Tnk Bnk (2 nk)
//!      6----7 |
//!      | 0--|-1    corner = di + 2 dj + 4 dk
//!      |/   |/     (drawn upside down: 0..3 is the top face)
//!      2----3
//! ```

use std::iter::Sum;
use std::sync::{Arc, OnceLock};

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::activity::{Activity, ColumnBits};
use super::column::{Column, Corner};
use super::corner_point::{Hexahedron, NO_THICKNESS};
use super::depth_lists::{DepthList, Lists, UsedDepths};
use super::ids::{ActiveIndex, CellIndex, Dims, Ijk};
use super::patches::Patches;
use super::spaces::MapAxes;

/// Pillars whose ends lie closer in depth than this are vertical.
const VERTICAL_PILLAR: f64 = 1e-10;

/// Why a grid could not be built.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum ModelError {
    /// An array has the wrong number of values.
    #[error("{keyword}: expected {expected} values, found {found}")]
    Length {
        /// The array.
        keyword: &'static str,
        /// Values that the dimensions ask for.
        expected: usize,
        /// Values given.
        found: usize,
    },
    /// A coordinate is infinite or not a number.
    #[error("{keyword}: value {index} is not a finite number")]
    NotFinite {
        /// The array.
        keyword: &'static str,
        /// Position in the array, from 1.
        index: usize,
    },
    /// The dimensions are zero or too large.
    #[error("a grid of {0} x {1} x {2} cells is not supported; 1 to 2^31-1 cells are")]
    Dimensions(usize, usize, usize),
    /// Local grids whose shape is so unlike that of the others that the lattice of all would be nearly empty.
    #[error(
        "together the grids would take {0} x {1} x {2} places, nearly all of them empty: a grid has far more layers or \
         columns than the others"
    )]
    Empty(usize, usize, usize),
    /// The cells of a regular lattice have no volume.
    #[error("there is no grid of such cells: {0}")]
    Lattice(&'static str),
    /// The corners of so many cells do not fit in memory.
    #[error("there is not enough memory for the corners of {0} x {1} x {2} cells")]
    Memory(usize, usize, usize),
}

/// A coordinate line: the straight line on which corners lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pillar {
    /// Upper end (x, y, depth).
    pub top: DVec3,
    /// Lower end (x, y, depth).
    pub bottom: DVec3,
}

impl Pillar {
    /// Horizontal displacement per unit of depth; zero for a vertical pillar.
    pub fn slope(&self) -> DVec2 {
        let axis = self.bottom - self.top;
        if axis.z.abs() < VERTICAL_PILLAR {
            return DVec2::ZERO;
        }
        axis.truncate() / axis.z
    }

    /// The point of the line at `depth`, extrapolated beyond the ends.
    pub fn at(&self, depth: f64) -> DVec3 {
        (self.top.truncate() + self.slope() * (depth - self.top.z)).extend(depth)
    }
}

/// The arrays from which a grid is built, as files hold them.
///
/// **Shape**: `coord` 6 values a pillar, `zcorn` 8 a cell (index
/// `2i+di + 2ni(2j+dj) + 4ni*nj(2k+dk)`), `actnum` one a cell, absent = all active.
#[derive(Debug, Clone, Copy)]
pub struct GridInput<'a, C, Z> {
    /// Cells along each axis.
    pub dims: Dims,
    /// Pillar ends: x, y, depth of the upper, then of the lower end.
    pub coord: &'a [C],
    /// Corner depths.
    pub zcorn: &'a [Z],
    /// Activity: a cell is active where this is not zero.
    pub actnum: Option<&'a [i32]>,
    /// Map coordinate system, `None` where coordinates are map coordinates.
    pub map_axes: Option<MapAxes>,
}

/// A corner-point grid in its file's own coordinates (grid space).
///
/// Copies share the geometry and have their own activity. Local grids lie beside the main one in the same lattice
/// (`patches.rs`): a cell is active in its own grid, whether or not a local grid refines it.
#[derive(Debug, Clone)]
pub struct Grid {
    pub(super) dims: Dims,
    pub(super) pillars: Arc<[Pillar]>,
    /// Of the pillars: corners are asked for much more often than pillars are made.
    pub(super) slopes: Arc<[DVec2]>,
    pub(super) lists: Arc<Vec<DepthList>>,
    pub(super) depths: Arc<Vec<f64>>,
    /// By column: true where depth grows with the layer, or stays, on all pillars.
    pub(super) sorted: Arc<Vec<bool>>,
    pub(super) active_cells: Vec<CellIndex>,
    pub(super) activity: Activity,
    pub(super) map_axes: Option<MapAxes>,
    pub(super) patches: Arc<Patches>,
    /// Of a grid in index space.
    pub(super) flat: Option<Arc<Flat>>,
    pub(super) found: Found,
}

/// What a grid in index space was made of (`flat.rs`).
#[derive(Debug)]
pub(super) struct Flat {
    pub of: Arc<Grid>,
    /// By number of the patch: true where it has no place here.
    pub left_out: Vec<bool>,
}

/// What was found out of the active cells, at the first question.
#[derive(Debug, Clone, Default)]
pub(super) struct Found {
    bounds: OnceLock<Option<[DVec3; 2]>>,
    signed_volume: OnceLock<f64>,
    thick: OnceLock<Arc<[bool]>>,
    used_depths: OnceLock<Arc<UsedDepths>>,
}

impl Grid {
    /// Builds the compact form.
    ///
    /// # Errors
    /// When an array has the wrong length, a coordinate is not finite, or the dimensions are
    /// zero or over 2^31-1 cells.
    pub fn new<C, Z>(input: &GridInput<'_, C, Z>) -> Result<Self, ModelError>
    where
        C: Copy + Into<f64> + Sync,
        Z: Copy + Into<f64> + Send + Sync,
    {
        let dims = input.dims;
        check(input)?;
        let coord: Vec<f64> = input.coord.iter().map(|&v| v.into()).collect();
        let pillars: Arc<[Pillar]> = coord
            .chunks_exact(6)
            .map(|c| Pillar {
                top: DVec3::new(c[0], c[1], c[2]),
                bottom: DVec3::new(c[3], c[4], c[5]),
            })
            .collect();
        let Lists {
            lists,
            depths,
            sorted,
        } = super::depth_lists::build(dims, input.zcorn);
        let is_active = |cell: &u32| input.actnum.is_none_or(|a| a[*cell as usize] != 0);
        let active_cells = (0..dims.cells() as u32).filter(is_active).map(CellIndex);
        let active_cells: Vec<CellIndex> = active_cells.collect();
        Ok(Self {
            dims,
            slopes: pillars.iter().map(Pillar::slope).collect(),
            pillars,
            lists: Arc::new(lists),
            depths: Arc::new(depths),
            sorted: Arc::new(sorted),
            activity: Activity::new(dims, &active_cells),
            active_cells,
            map_axes: input.map_axes,
            patches: Arc::new(Patches::one(dims)),
            flat: None,
            found: Found::default(),
        })
    }

    /// Columns along each axis and layers of the lattice: the cells along each axis where there are no local grids.
    pub fn dims(&self) -> Dims {
        self.dims
    }

    /// All pillars, i fastest.
    pub fn pillars(&self) -> &[Pillar] {
        &self.pillars
    }

    /// The pillar at corner `corner` (`di + 2 dj`) of column (`i`, `j`).
    pub fn pillar(&self, i: usize, j: usize, corner: usize) -> &Pillar {
        &self.pillars[self.pillar_index(i, j, corner)]
    }

    /// The number of that pillar.
    pub fn pillar_index(&self, i: usize, j: usize, corner: usize) -> usize {
        (i + (corner & 1)) + (self.dims.ni + 1) * (j + (corner >> 1 & 1))
    }

    /// The same grid with its inactive cells active too.
    pub fn with_inactive(&self) -> Self {
        let all = (0..self.dims.cells() as u32).map(CellIndex);
        let is_one = self.patches().len() == 1;
        let is_cell = |cell: &CellIndex| is_one || self.patch_of(self.dims.ijk(*cell)).is_some();
        let active_cells: Vec<CellIndex> = all.filter(is_cell).collect();
        Self {
            dims: self.dims,
            pillars: self.pillars.clone(),
            slopes: self.slopes.clone(),
            lists: self.lists.clone(),
            depths: self.depths.clone(),
            sorted: self.sorted.clone(),
            activity: Activity::new(self.dims, &active_cells),
            active_cells,
            map_axes: self.map_axes,
            patches: self.patches.clone(),
            flat: self.flat.clone(),
            found: Found::default(),
        }
    }

    /// Makes all cells inactive that `keep` does not hold for.
    pub fn retain_active(&mut self, keep: impl Fn(CellIndex) -> bool) {
        self.active_cells.retain(|&cell| keep(cell));
        self.activity = Activity::new(self.dims, &self.active_cells);
        self.found = Found::default();
    }

    /// True where another grid holds the same corners in the same memory.
    pub fn shares_geometry(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.depths, &other.depths) && Arc::ptr_eq(&self.pillars, &other.pillars)
    }

    /// True where another grid has exactly the same cells, whichever of them are active.
    pub fn has_equal_geometry(&self, other: &Self) -> bool {
        let are_alike = self.dims == other.dims
            && self.map_axes == other.map_axes
            && self.flat.is_none()
            && other.flat.is_none();
        are_alike
            && (self.shares_geometry(other)
                || self.pillars == other.pillars
                    && self.lists == other.lists
                    && self.depths == other.depths
                    && self.patches() == other.patches())
    }

    /// The same grid, which holds the geometry of an equal one in place of its own.
    pub fn with_geometry_of(&self, other: &Self) -> Self {
        Self {
            pillars: other.pillars.clone(),
            slopes: other.slopes.clone(),
            lists: other.lists.clone(),
            depths: other.depths.clone(),
            sorted: other.sorted.clone(),
            patches: other.patches.clone(),
            ..self.clone()
        }
    }

    /// Sets the map coordinate system.
    pub fn set_map_axes(&mut self, map_axes: Option<MapAxes>) {
        self.map_axes = map_axes;
    }

    /// The four depth lists of a column (`i + ni * j`), by corner `di + 2 dj`.
    pub fn column_lists(&self, column: usize) -> [DepthList; 4] {
        let at = 4 * column;
        [
            self.lists[at],
            self.lists[at + 1],
            self.lists[at + 2],
            self.lists[at + 3],
        ]
    }

    /// The pool of all depth lists.
    pub fn depths(&self) -> &[f64] {
        &self.depths
    }

    /// The part of the pool that columns with active cells need. Found at the first call.
    pub fn used_depths(&self) -> &UsedDepths {
        self.found.used_depths.get_or_init(|| {
            let columns = (0..self.dims.columns()).into_par_iter();
            let has_cells = |column: &usize| {
                let words = self.active_bits().column(*column);
                words.iter().any(|word| *word != 0)
            };
            let lists = columns
                .filter(has_cells)
                .flat_map_iter(|c| self.column_lists(c));
            Arc::new(UsedDepths::new(lists.collect(), self.dims.nk))
        })
    }

    /// Depth-pool position of corner `corner` (`di + 2 dj + 4 dk`) of a cell.
    pub fn corner_entry(&self, ijk: Ijk, corner: usize) -> usize {
        let column = ijk.i + self.dims.ni * ijk.j;
        self.lists[4 * column + (corner & 3)].entry(ijk.k, corner >> 2)
    }

    /// Depth of corner `corner` (`di + 2 dj + 4 dk`) of a cell.
    pub fn corner_depth(&self, ijk: Ijk, corner: usize) -> f64 {
        self.depths[self.corner_entry(ijk, corner)]
    }

    /// The hexahedron of a cell in grid space.
    pub fn hexahedron(&self, ijk: Ijk) -> Hexahedron {
        let mut corners = [DVec3::ZERO; 8];
        for corner in 0..4 {
            let pillar = self.pillar_index(ijk.i, ijk.j, corner);
            let (top, slope) = (self.pillars[pillar].top, self.slopes[pillar]);
            for end in [corner, corner + 4] {
                let depth = self.corner_depth(ijk, end);
                corners[end] = (top.truncate() + slope * (depth - top.z)).extend(depth);
            }
        }
        Hexahedron(corners)
    }

    /// The active cells in natural order.
    pub fn active_cells(&self) -> &[CellIndex] {
        &self.active_cells
    }

    /// True where depth grows with the layer, or stays, on all pillars of a column.
    pub(super) fn is_sorted(&self, column: usize) -> bool {
        self.sorted[column]
    }

    /// A column (`i + ni * j`).
    pub fn column(&self, column: usize) -> Column<'_> {
        let (i, j) = (column % self.dims.ni, column / self.dims.ni);
        let corner = |c: usize| {
            let pillar = self.pillar_index(i, j, c);
            let list = self.lists[4 * column + c];
            Corner {
                top: self.pillars[pillar].top,
                slope: self.slopes[pillar],
                depths: &self.depths[list.entries(self.dims.nk)],
                step: list.step(),
            }
        };
        Column {
            i,
            j,
            is_sorted: self.sorted[column],
            active: self.activity.columns().column(column),
            corners: std::array::from_fn(corner),
        }
    }

    /// All columns, i fastest.
    pub fn columns(&self) -> impl IndexedParallelIterator<Item = Column<'_>> {
        let columns = (0..self.dims.columns()).into_par_iter();
        columns.map(|column| self.column(column))
    }

    /// The active cells column by column: the order in which their depths lie in memory, for work on
    /// all of them whose order does not matter.
    pub fn active_by_column(&self) -> impl ParallelIterator<Item = Ijk> + '_ {
        let columns = (0..self.dims.columns()).into_par_iter();
        columns.flat_map_iter(|column| {
            let (i, j) = (column % self.dims.ni, column / self.dims.ni);
            let layers = self.activity.columns().layers(column);
            layers.map(move |k| Ijk { i, j, k })
        })
    }

    /// Bits of the active cells, column by column.
    pub fn active_bits(&self) -> &ColumnBits {
        self.activity.columns()
    }

    /// Bits of the cells that `chosen` (by active index) names, column by column.
    pub fn bits_of(&self, chosen: &[bool]) -> ColumnBits {
        self.activity
            .bits_of(|rank| chosen.get(rank) == Some(&true))
    }

    /// The active cells of the row along i of one j and k: i and active index of each.
    pub fn active_in_row(&self, j: usize, k: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.activity.row(self.dims.ni * (j + self.dims.nj * k))
    }

    /// The sum of a quantity over the active cells, given by column and layer; the same bits with any number of
    /// threads.
    pub fn sum_active<T: Sum + Send>(&self, of: impl Fn(&Column<'_>, usize) -> T + Sync) -> T {
        let sums = self.columns().map(|c| c.active().map(|k| of(&c, k)).sum());
        sums.collect::<Vec<T>>().into_iter().sum()
    }

    /// A value for each active cell, by active index, made from its column and layer.
    pub fn map_active<T: Clone + Default + Send>(
        &self,
        of: impl Fn(&Column<'_>, usize) -> T + Sync,
    ) -> Vec<T> {
        let Dims { ni, nj, nk } = self.dims;
        let mut values = vec![T::default(); self.active_cells.len()];
        // Of each row of columns the places for its values, layer by layer.
        let mut rows: Vec<Vec<_>> = (0..nj).map(|_| Vec::with_capacity(nk)).collect();
        let mut rest = values.as_mut_slice();
        let mut before = 0;
        for k in 0..nk {
            for (j, row) in rows.iter_mut().enumerate() {
                let end = self.activity.before(ni * (j + nj * k) + ni) as usize;
                let (places, behind) = rest.split_at_mut(end - before);
                row.push(places.iter_mut());
                (rest, before) = (behind, end);
            }
        }
        rows.into_par_iter().enumerate().for_each(|(j, mut row)| {
            for i in 0..ni {
                let column = self.column(i + ni * j);
                for k in column.active() {
                    if let Some(place) = row[k].next() {
                        *place = of(&column, k);
                    }
                }
            }
        });
        values
    }

    /// Rank of a cell among the active ones, `None` where it is inactive.
    pub fn active_index(&self, cell: CellIndex) -> Option<ActiveIndex> {
        self.activity.rank(cell.0 as usize).map(ActiveIndex)
    }

    /// True when the cell is active.
    pub fn is_active(&self, ijk: Ijk) -> bool {
        self.active_index(self.dims.cell(ijk)).is_some()
    }

    /// By active index: true where [`Self::has_thickness`] holds. Found at the first call.
    pub fn thick(&self) -> &[bool] {
        let thick = &self.found.thick;
        thick.get_or_init(|| self.map_active(|column, k| column.has_thickness(k)).into())
    }

    /// True when at least one of the four edges along the pillars has a length.
    pub fn has_thickness(&self, ijk: Ijk) -> bool {
        (0..4).any(|c| {
            (self.corner_depth(ijk, c + 4) - self.corner_depth(ijk, c)).abs() > NO_THICKNESS
        })
    }

    /// Map axes, `None` where grid coordinates are map coordinates.
    pub fn map_axes(&self) -> Option<MapAxes> {
        self.map_axes
    }

    /// Sum of the active cells' volumes, negative where the grid is left-handed (x, y, depth). Found at the first
    /// call.
    pub fn signed_bulk_volume(&self) -> f64 {
        let volume = |column: &Column<'_>, k: usize| column.hexahedron(k).signed_volume();
        let found = &self.found.signed_volume;
        *found.get_or_init(|| self.sum_active(volume))
    }

    /// Smallest and largest corner of the active cells in grid space; `None` without any. Found at the first call.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        let of_column = |column: Column<'_>| {
            let ends = column.ends(column.active())?;
            let ends = ends.as_flattened();
            let start = [ends[0]; 2];
            Some(ends.iter().fold(start, |[a, b], &c| [a.min(c), b.max(c)]))
        };
        *self.found.bounds.get_or_init(|| {
            let each = self.columns().filter_map(of_column);
            each.reduce_with(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
        })
    }

    /// Smallest and largest corner of some cells in grid space; `None` of none.
    pub fn bounds_of(&self, cells: impl IntoParallelIterator<Item = Ijk>) -> Option<[DVec3; 2]> {
        let each = cells.into_par_iter();
        each.map(|ijk| self.hexahedron(ijk).bounds())
            .reduce_with(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }
}

fn check<C, Z>(input: &GridInput<'_, C, Z>) -> Result<(), ModelError>
where
    C: Copy + Into<f64> + Sync,
    Z: Copy + Into<f64> + Sync,
{
    let Dims { ni, nj, nk } = input.dims;
    let cells = input.dims.checked_cells();
    let cells = cells.ok_or(ModelError::Dimensions(ni, nj, nk))?;
    let lengths = [
        ("COORD", 6 * input.dims.pillars(), input.coord.len()),
        ("ZCORN", 8 * cells, input.zcorn.len()),
        ("ACTNUM", cells, input.actnum.map_or(cells, <[_]>::len)),
    ];
    for (keyword, expected, found) in lengths {
        if expected != found {
            return Err(ModelError::Length {
                keyword,
                expected,
                found,
            });
        }
    }
    finite("COORD", input.coord)?;
    finite("ZCORN", input.zcorn)
}

/// Values looked at between two questions whether another thread has found one.
const PIECE: usize = 1 << 14;

fn finite<T: Copy + Into<f64> + Sync>(
    keyword: &'static str,
    values: &[T],
) -> Result<(), ModelError> {
    let pieces = values.par_chunks(PIECE).enumerate();
    let bad = pieces.find_map_first(|(piece, values)| {
        // All at once first, which takes a fraction of the time of one after the other.
        let all = values
            .iter()
            .fold(true, |all, &v| all & v.into().is_finite());
        let at = if all {
            None
        } else {
            values.iter().position(|&v| !v.into().is_finite())
        };
        Some(piece * PIECE + at? + 1)
    });
    bad.map_or(Ok(()), |index| {
        Err(ModelError::NotFinite { keyword, index })
    })
}
