//! Which cells of a grid the results are for, and where in their arrays the value of each stands.

use rayon::prelude::*;
use strataray_parsers::cells::CellArrays;
use strataray_parsers::egrid::PorosityModel;

use crate::model::{CellIndex, Dims, Grid};

/// How cell arrays of a file map to the grid's active cells.
pub struct CellSlots {
    /// Natural index of each active cell.
    cells: Vec<u32>,
    /// Cells along i, j and k.
    dims: Dims,
    /// All cells.
    total: usize,
    /// Where values stand, if not for one active cell after the other; with dual porosity those of the matrix.
    places: Option<Places>,
    /// Of dual porosity, those of the fractures.
    fractures: Option<Places>,
}

/// Where in arrays the values of active cells stand.
struct Places {
    /// By active cell: number among the values of an array of active cells, and natural index of the cell that has
    /// the value; `None` for a cell without one.
    of: Vec<Option<(u32, u32)>>,
    /// Values of an array of active cells.
    count: usize,
    /// Values of an array of all cells.
    whole: usize,
}

/// What the grid's file says of its cells beside their activity.
#[derive(Default)]
pub struct CellFlags {
    /// For dual porosity, one a cell: 1 matrix, 2 fracture, 3 both.
    pub porosity: Option<Vec<i32>>,
    /// Number of the coarse cell that a cell is part of, or 0.
    pub coarse: Option<Vec<i32>>,
}

impl CellFlags {
    /// Flags of a grid file.
    pub fn new(actnum: Option<Vec<i32>>, coarse: Option<Vec<i32>>, model: PorosityModel) -> Self {
        Self {
            porosity: actnum.filter(|_| model != PorosityModel::Single),
            coarse: coarse.filter(|numbers| numbers.iter().any(|&number| number > 0)),
        }
    }
}

/// What results say of the cells that they are for.
pub struct ResultCells<'a> {
    /// Active cells (INTEHEAD); `None` where unknown.
    pub active: Option<usize>,
    /// The INIT file.
    pub init: Option<&'a CellArrays>,
}

impl ResultCells<'_> {
    /// Which of all cells have pore volume, if PORV says so of as many as are active.
    fn with_pore_volume(&self, total: usize) -> Option<Vec<bool>> {
        let init = self.init?;
        let entry = init.find("PORV").filter(|e| e.count as usize == total)?;
        let volumes = init.values(entry).ok()?;
        let has: Vec<bool> = volumes.iter().map(|v| *v > 0.0).collect();
        (Some(has.iter().filter(|has| **has).count()) == self.active).then_some(has)
    }
}

impl CellSlots {
    /// Finds the cells that results are for. Where they are for fewer cells than are active in the grid, those without
    /// pore volume become inactive. What was done about it goes into `notes`.
    pub fn new(
        grid: &mut Grid,
        flags: &CellFlags,
        results: &ResultCells<'_>,
        notes: &mut Vec<String>,
    ) -> Self {
        let total = grid.dims().cells();
        let active = grid.active_cells().len();
        let [places, fractures] = match (&flags.porosity, &flags.coarse) {
            (Some(porosity), _) => Places::of_porosity(grid, porosity).map(Some),
            (None, Some(coarse)) => {
                let coarsened = Places::of_coarse(grid, coarse, results);
                notes.push(coarsened.note(coarse));
                [Some(coarsened), None]
            }
            (None, None) => [None, None],
        };
        let differs = results.active.is_some_and(|count| count != active);
        if places.is_none()
            && differs
            && let Some(has) = results.with_pore_volume(total)
        {
            grid.retain_active(|cell| has[cell.0 as usize]);
            let left = grid.active_cells().len();
            notes.push(format!(
                "the grid has {active} active cells and the results {left}: cells without pore volume (PORV of INIT) are inactive"
            ));
        }
        Self {
            cells: grid.active_cells().iter().map(|c| c.0).collect(),
            dims: grid.dims(),
            total,
            places,
            fractures,
        }
    }

    /// True where an array of this length has values of matrix and fractures.
    pub fn has_fractures(&self, count: usize) -> bool {
        let fractures = self.fractures.as_ref();
        fractures.is_some_and(|places| count == places.count || count == places.whole)
    }

    /// Rank of a cell of the grid among its active ones.
    pub fn rank(&self, cell: CellIndex) -> Option<u32> {
        self.cells.binary_search(&cell.0).ok().map(|at| at as u32)
    }

    /// Values of an array of active cells.
    pub fn count(&self) -> usize {
        self.places.as_ref().map_or(self.cells.len(), |p| p.count)
    }

    /// True where an INTEHEAD with this number of active cells belongs to the grid.
    pub fn are_as_many(&self, active: usize) -> bool {
        active == self.count() || active == self.cells.len()
    }

    /// In words the grid's dimensions and those of INTEHEAD, where these are others; of dual porosity they have twice the
    /// layers.
    pub fn other_dims(&self, head: [i32; 3]) -> Option<[String; 2]> {
        let [ni, nj, nk] = head.map(|n| usize::try_from(n).unwrap_or(0));
        let own = self.dims;
        let fits = ni == own.ni && nj == own.nj && (nk == own.nk || nk == 2 * own.nk);
        let words = |[i, j, k]: [usize; 3]| format!("{i} x {j} x {k}");
        let is_told = ni > 0 && nj > 0 && nk > 0;
        (is_told && !fits).then(|| [words([own.ni, own.nj, own.nk]), words([ni, nj, nk])])
    }

    /// True where an array of this length has a value for each active cell.
    pub fn fits(&self, count: usize) -> bool {
        let whole = self.places.as_ref().is_some_and(|p| p.whole == count);
        whole || count == self.total || count == self.count()
    }

    /// The values of the active cells from those of all cells, which are kept where all are active.
    pub fn pick_of_whole(&self, values: Vec<f32>) -> Vec<f32> {
        match self.places.is_none() && self.cells.len() == values.len() {
            true => values,
            false => self.pick_of_all(&values),
        }
    }

    /// The values of the active cells from an array of all cells.
    pub fn pick_of_all(&self, values: &[f32]) -> Vec<f32> {
        match &self.places {
            Some(places) => {
                let value = |(_, cell): (u32, u32)| values[cell as usize];
                let places = places.of.iter();
                places.map(|place| place.map_or(f32::NAN, value)).collect()
            }
            None => {
                let cells = self.cells.par_iter();
                cells.map(|&c| values[c as usize]).collect()
            }
        }
    }

    /// The values of the active cells from an array that fits.
    pub fn pick(&self, values: &[f32]) -> Vec<f32> {
        match &self.places {
            Some(places) => places.pick(values),
            None if values.len() == self.cells.len() => values.to_vec(),
            None => self.pick_of_all(values),
        }
    }
}

impl CellSlots {
    /// Follows a grid of which some active cells, in natural order, have become inactive though files have values for them.
    pub fn leave_out(&mut self, cells: &[CellIndex]) {
        if cells.is_empty() {
            return;
        }
        let keeps = |cell: u32| cells.binary_search(&CellIndex(cell)).is_err();
        let kept: Vec<bool> = self.cells.iter().map(|cell| keeps(*cell)).collect();
        let places = self.places.take().unwrap_or_else(|| Places {
            of: (0..)
                .zip(&self.cells)
                .map(|(n, cell)| Some((n, *cell)))
                .collect(),
            count: self.cells.len(),
            whole: self.total,
        });
        self.places = Some(places.of_kept(&kept));
        self.fractures = self.fractures.take().map(|places| places.of_kept(&kept));
        self.cells.retain(|cell| keeps(*cell));
    }

    /// True where an array of all cells has values of fractures behind those of the matrix.
    pub fn has_all_fractures(&self, count: usize) -> bool {
        let fractures = self.fractures.as_ref();
        fractures.is_some_and(|places| count == places.whole)
    }

    /// The values of the active cells' fractures from an array that [has them](Self::has_fractures).
    pub fn pick_fractures(&self, values: &[f32]) -> Vec<f32> {
        let fractures = self.fractures.as_ref();
        fractures.map_or_else(Vec::new, |places| places.pick(values))
    }
}

impl Places {
    /// Of the matrix and of the fractures, whose values come behind those of the matrix.
    fn of_porosity(grid: &Grid, porosity: &[i32]) -> [Self; 2] {
        let total = grid.dims().cells();
        let mut count = 0;
        let places = [(1, 0), (2, total as u32)].map(|(flag, before)| {
            let of = grid.active_cells().iter().map(|cell| {
                let is_there = porosity[cell.0 as usize] & flag != 0;
                is_there.then(|| {
                    count += 1;
                    (count - 1, before + cell.0)
                })
            });
            of.collect::<Vec<_>>()
        });
        places.map(|of| Self {
            of,
            count: count as usize,
            whole: 2 * total,
        })
    }

    /// The places of the cells that are kept.
    ///
    /// **Shape**: `kept` has one value for each place.
    fn of_kept(mut self, kept: &[bool]) -> Self {
        let mut kept = kept.iter();
        self.of.retain(|_| kept.next() == Some(&true));
        self
    }

    /// The values of the active cells from an array that fits; not a number where a cell has none.
    fn pick(&self, values: &[f32]) -> Vec<f32> {
        let by_rank = values.len() == self.count;
        let value = |(rank, cell): (u32, u32)| {
            let at = if by_rank { rank } else { cell };
            values.get(at as usize).copied().unwrap_or(f32::NAN)
        };
        let places = self.of.iter();
        places.map(|place| place.map_or(f32::NAN, value)).collect()
    }

    /// Of cells that were made into coarse ones: all cells of a coarse one have the value of the one that stands for
    /// it, which has the pore volume, else the first one.
    fn of_coarse(grid: &Grid, coarse: &[i32], results: &ResultCells<'_>) -> Self {
        let total = grid.dims().cells();
        let has_volume = results.with_pore_volume(total);
        let mut standing: std::collections::HashMap<i32, (u32, u32)> = Default::default();
        let mut count = 0;
        let mut own: Vec<Option<(u32, u32)>> = Vec::with_capacity(grid.active_cells().len());
        for &CellIndex(cell) in grid.active_cells() {
            let number = coarse[cell as usize];
            let stands = match &has_volume {
                Some(has) => has[cell as usize],
                None => number == 0 || !standing.contains_key(&number),
            };
            own.push(stands.then(|| {
                count += 1;
                (count - 1, cell)
            }));
            if let Some(Some(place)) = own.last()
                && number > 0
            {
                standing.insert(number, *place);
            }
        }
        let cells = grid.active_cells().iter().zip(&own);
        let of = cells.map(|(cell, own)| {
            let number = coarse[cell.0 as usize];
            own.or_else(|| standing.get(&number).copied())
        });
        Self {
            of: of.collect(),
            count: count as usize,
            whole: total,
        }
    }

    fn note(&self, coarse: &[i32]) -> String {
        let fine = coarse.iter().filter(|number| **number > 0);
        let numbers: std::collections::HashSet<_> = fine.clone().collect();
        format!(
            "CORSNUM: {} cells are coarsened to {}; each shows the value of its coarse cell, also of PORV",
            fine.count(),
            numbers.len()
        )
    }
}
