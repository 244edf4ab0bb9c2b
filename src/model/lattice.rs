//! The lattice in which the grids of a model lie side by side (see `patches.rs`): its geometry, and who is where in it.

use std::ops::Range;
use std::sync::Arc;

use glam::DVec2;
use rayon::prelude::*;

use super::activity::Activity;
use super::depth_lists::DepthList;
use super::grid::{Found, Grid, GridInput, ModelError, Pillar};
use super::ids::{CellIndex, Dims, Ijk};
use super::patches::{GridCell, Patch, Patches};

/// Places of the lattice for each cell, at most, where there are more than a few: files that are small stay so in memory.
const MOST_PLACES: usize = 32;
const FEW_PLACES: usize = 1 << 22;

/// A local grid that is to be laid into the lattice of a model.
#[derive(Debug, Clone)]
pub struct LocalGrid {
    /// Its name.
    pub name: String,
    /// Its parent among the grids before it: 0 for the main one.
    pub parent: usize,
    /// Its cells.
    pub grid: Grid,
    /// As [`Patch::layers`].
    pub layers: Option<Range<usize>>,
    /// As [`Patch::split`].
    pub split: usize,
    /// As [`Patch::is_reversed`].
    pub is_reversed: bool,
    /// By cell, in natural order: the parent's cell that it lies in.
    pub hosts: Vec<CellIndex>,
}

impl Patch {
    fn of(local: &LocalGrid) -> Self {
        Self {
            name: local.name.clone(),
            parent: local.parent,
            dims: local.grid.dims(),
            layers: local.layers.clone(),
            split: local.split,
            is_reversed: local.is_reversed,
            first: [0; 2],
            hosts: local.hosts.clone(),
        }
    }
}

/// What meets at a pillar of the lattice: a pillar of a patch's grid, or nothing.
struct Meeting<'a> {
    grid: &'a Grid,
    patch: &'a Patch,
    /// Along i and j in that grid.
    at: [usize; 2],
}

impl Meeting<'_> {
    fn pillar(&self) -> Pillar {
        self.grid.pillars()[self.at[0] + (self.grid.dims().ni + 1) * self.at[1]]
    }

    /// The depth list of one of the columns around the pillar, given by its place in the lattice: that of the column
    /// itself, or, where it is none of the patch's, of one that is.
    fn list(&self, column: [usize; 2]) -> DepthList {
        let dims = self.grid.dims();
        let own = |axis: usize, count: usize| {
            let column = column[axis].saturating_sub(self.patch.first[axis]);
            let nearest = [self.at[axis].saturating_sub(1), self.at[axis]];
            column.clamp(nearest[0], nearest[1]).min(count - 1)
        };
        let (i, j) = (own(0, dims.ni), own(1, dims.nj));
        let corner = (self.at[0] - i) + 2 * (self.at[1] - j);
        self.grid.column_lists(i + dims.ni * j)[corner]
    }
}

/// The grids that are joined.
struct Joined<'a> {
    main: &'a Grid,
    locals: &'a [LocalGrid],
    patches: &'a Patches,
    dims: Dims,
}

impl Joined<'_> {
    fn grid(&self, patch: usize) -> &Grid {
        match patch {
            0 => self.main,
            number => &self.locals[number - 1].grid,
        }
    }

    /// Columns of the lattice around a pillar, with their corner on it.
    fn around(&self, pi: usize, pj: usize) -> impl Iterator<Item = ([usize; 2], usize)> + use<> {
        let Dims { ni, nj, .. } = self.dims;
        (0..4).filter_map(move |corner| {
            let i = pi.checked_sub(corner & 1).filter(|i| *i < ni)?;
            let j = pj.checked_sub(corner >> 1).filter(|j| *j < nj)?;
            Some(([i, j], corner))
        })
    }

    fn meeting(&self, pi: usize, pj: usize) -> Option<Meeting<'_>> {
        let number = |([i, j], _): ([usize; 2], usize)| self.patches.at(i, j, self.dims.ni);
        let number = self.around(pi, pj).find_map(number)?;
        let patch = &self.patches.list[number];
        Some(Meeting {
            grid: self.grid(number),
            patch,
            at: [pi - patch.first[0], pj - patch.first[1]],
        })
    }
}

/// Pillars and depth lists of the lattice.
struct Geometry {
    pillars: Vec<Pillar>,
    lists: Vec<DepthList>,
    depths: Vec<f64>,
    sorted: Vec<bool>,
}

impl Geometry {
    fn of(joined: &Joined<'_>) -> Self {
        let Dims { ni, nj, nk } = joined.dims;
        let mut made = Self {
            pillars: Vec::with_capacity(joined.dims.pillars()),
            lists: vec![DepthList::new(0, false); 4 * joined.dims.columns()],
            depths: Vec::new(),
            sorted: vec![true; joined.dims.columns()],
        };
        for pj in 0..=nj {
            for pi in 0..=ni {
                let meeting = joined.meeting(pi, pj);
                made.pillars.push(match &meeting {
                    Some(meeting) => meeting.pillar(),
                    None => joined.main.pillars()[0],
                });
                let mut known: Vec<(Option<DepthList>, DepthList)> = Vec::with_capacity(4);
                for ([i, j], corner) in joined.around(pi, pj) {
                    let from = meeting.as_ref().map(|m| m.list([i, j]));
                    let found = known.iter().find(|(list, _)| *list == from);
                    let list = match found {
                        Some((_, list)) => *list,
                        None => {
                            let source = meeting.as_ref().map(|m| m.grid).zip(from);
                            let list = made.add(source, nk);
                            known.push((from, list));
                            list
                        }
                    };
                    made.lists[4 * (i + ni * j) + corner] = list;
                }
            }
        }
        for column in 0..joined.dims.columns() {
            let (i, j) = (column % ni, column / ni);
            if let Some(number) = joined.patches.at(i, j, ni) {
                let [left, top] = joined.patches.list[number].first;
                let grid = joined.grid(number);
                made.sorted[column] = grid.is_sorted(i - left + grid.dims().ni * (j - top));
            }
        }
        made
    }

    /// Adds a list of a grid, whose last depth goes on where the lattice has more layers, or one without depths.
    fn add(&mut self, source: Option<(&Grid, DepthList)>, nk: usize) -> DepthList {
        let is_gapped = source.is_some_and(|(_, list)| list.gapped());
        let made = DepthList::new(self.depths.len(), is_gapped);
        if let Some((grid, list)) = source {
            self.depths
                .extend_from_slice(&grid.depths()[list.entries(grid.dims().nk)]);
        }
        let last = self.depths.last().copied().unwrap_or(0.0);
        self.depths.resize(made.entries(nk).end, last);
        made
    }
}

impl Grid {
    /// The same grid with local grids beside it in one lattice. [`Self::dims`] and all indices are the lattice's then.
    ///
    /// # Errors
    /// When the lattice would have more cells than can be numbered.
    pub fn with_local_grids(self, locals: &[LocalGrid]) -> Result<Self, ModelError> {
        if locals.is_empty() {
            return Ok(self);
        }
        let (patches, dims) = Patches::lay_out(self.dims(), locals.iter().map(Patch::of).collect());
        let Dims { ni, nj, nk } = dims;
        let places = dims
            .checked_cells()
            .ok_or(ModelError::Dimensions(ni, nj, nk))?;
        let cells = patches.list.iter().map(|patch| patch.dims.cells());
        if places > FEW_PLACES && places / MOST_PLACES > cells.sum::<usize>() {
            return Err(ModelError::Empty(ni, nj, nk));
        }
        let joined = Joined {
            main: &self,
            locals,
            patches: &patches,
            dims,
        };
        let geometry = Geometry::of(&joined);
        if geometry.depths.len() >= 1 << 31 {
            return Err(ModelError::Memory(ni, nj, nk));
        }
        let mut active_cells: Vec<CellIndex> = Vec::new();
        for (number, patch) in patches.list.iter().enumerate() {
            let grid = joined.grid(number);
            let cells = grid.active_cells().iter();
            active_cells
                .extend(cells.map(|cell| dims.cell(patch.to_lattice(patch.dims.ijk(*cell)))));
        }
        active_cells.sort_unstable();
        Ok(Self {
            dims,
            slopes: geometry
                .pillars
                .iter()
                .map(Pillar::slope)
                .collect::<Arc<[DVec2]>>(),
            pillars: geometry.pillars.into(),
            lists: Arc::new(geometry.lists),
            depths: Arc::new(geometry.depths),
            sorted: Arc::new(geometry.sorted),
            activity: Activity::new(dims, &active_cells),
            active_cells,
            map_axes: self.map_axes(),
            patches: Arc::new(patches),
            flat: None,
            found: Found::default(),
        })
    }

    /// COORD and ZCORN of the main grid, converted number by number.
    ///
    /// **Shape**: as in [`GridInput`].
    pub fn main_corners<T: Send>(&self, of: impl Fn(f64) -> T + Sync) -> (Vec<T>, Vec<T>) {
        let dims = self.main_dims();
        let Dims { ni, nj, .. } = dims;
        let pillars = (0..=nj).flat_map(|j| (0..=ni).map(move |i| i + (self.dims.ni + 1) * j));
        let ends = pillars.flat_map(|at| [self.pillars[at].top, self.pillars[at].bottom]);
        let coord = ends.flat_map(|end| end.to_array()).map(&of).collect();
        let depth = |n: usize| {
            let [x, y, plane] = [n % (2 * ni), n / (2 * ni) % (2 * nj), n / (4 * ni * nj)];
            let cell = Ijk {
                i: x / 2,
                j: y / 2,
                k: plane / 2,
            };
            of(self.corner_depth(cell, x % 2 + 2 * (y % 2) + 4 * (plane % 2)))
        };
        let zcorn = (0..8 * dims.cells()).into_par_iter().map(depth).collect();
        (coord, zcorn)
    }

    /// The main grid without its local grids.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn main_alone(&self) -> Result<Self, ModelError> {
        let dims = self.main_dims();
        let (coord, zcorn) = self.main_corners(|v| v);
        let mut actnum = vec![0; dims.cells()];
        for (_, cell) in self.active_in(0) {
            actnum[dims.cell(cell).0 as usize] = 1;
        }
        Self::new(&GridInput {
            dims,
            coord: &coord,
            zcorn: &zcorn,
            actnum: Some(&actnum),
            map_axes: self.map_axes,
        })
    }

    /// The grids of the model: the main one, and its local grids.
    pub fn patches(&self) -> &[Patch] {
        &self.patches.list
    }

    /// Cells along each axis of the main grid.
    pub fn main_dims(&self) -> Dims {
        self.patches.list[0].dims
    }

    /// The number of the grid that a cell belongs to; `None` between grids.
    pub fn patch_of(&self, at: Ijk) -> Option<usize> {
        let number = self.patches.at(at.i, at.j, self.dims().ni)?;
        (at.k < self.patches.list[number].dims.nk).then_some(number)
    }

    /// A cell as its file knows it; between grids as if it were of the main one.
    pub fn cell_name(&self, at: Ijk) -> GridCell<'_> {
        let (patch, mut own) = self.own_cell(at);
        // Layers of a reservoir are known by their number in the main grid.
        own.k += patch.layers.as_ref().map_or(0, |layers| layers.start);
        GridCell {
            grid: &patch.name,
            ijk: own.one_based(),
        }
    }

    /// False for all but the first of several cells that are one of the file.
    pub fn is_first(&self, at: Ijk) -> bool {
        let patch = &self.patches.list[self.patch_of(at).unwrap_or(0)];
        (at.j - patch.first[1]).is_multiple_of(patch.split)
    }

    /// A cell as its file knows it, by the numbers from 1 that it has in the lattice; those outside are taken for cells
    /// of the main grid.
    pub fn name_of(&self, numbers: [usize; 3]) -> GridCell<'_> {
        match self.dims().one_based(numbers) {
            Some(at) => self.cell_name(at),
            None => GridCell {
                grid: "",
                ijk: numbers,
            },
        }
    }

    /// The number of a cell's grid, and the cell's in its file.
    pub fn file_cell(&self, at: Ijk) -> (usize, CellIndex) {
        let (patch, own) = self.own_cell(at);
        (self.patch_of(at).unwrap_or(0), patch.file_dims().cell(own))
    }

    fn own_cell(&self, at: Ijk) -> (&Patch, Ijk) {
        let patch = &self.patches.list[self.patch_of(at).unwrap_or(0)];
        let own = patch.own(at).unwrap_or(at);
        let j = patch.file_row(own.j);
        (patch, Ijk { j, ..own })
    }

    /// Where the cell of a grid is in the lattice, given as its file counts cells from 0: the first of those that are
    /// one. `None` outside of that grid. Layers of a reservoir with pillars of its own are counted in the main grid.
    pub fn in_lattice(&self, patch: usize, mut cell: Ijk) -> Option<Ijk> {
        let mut patch = self.patches.list.get(patch)?;
        if patch.hosts.is_empty()
            && let Some((reservoir, layers)) = self.reservoir_of(cell.k)
        {
            patch = reservoir;
            cell.k -= layers.start;
        }
        let Dims { ni, nj, nk } = patch.file_dims();
        let is_inside = cell.i < ni && cell.j < nj && cell.k < nk;
        let own = Ijk {
            j: patch.first_row(cell.j),
            ..cell
        };
        is_inside.then(|| patch.to_lattice(own))
    }

    /// The reservoir with pillars of its own that a layer of the main grid belongs to, and its layers.
    fn reservoir_of(&self, k: usize) -> Option<(&Patch, &Range<usize>)> {
        let reservoirs = self.patches.list.iter();
        let mut reservoirs = reservoirs.filter_map(|p| Some((p, p.layers.as_ref()?)));
        reservoirs.find(|(_, layers)| layers.contains(&k))
    }

    /// The number of the grid of that name, whatever its letter case; the main one has none.
    pub fn patch_named(&self, name: &str) -> Option<usize> {
        let mut patches = self.patches.list.iter();
        patches.position(|patch| patch.name.eq_ignore_ascii_case(name))
    }

    /// The parent's cell that a cell of a local grid lies in; `None` of one of the main grid.
    pub fn host(&self, at: Ijk) -> Option<Ijk> {
        let patch = &self.patches.list[self.patch_of(at)?];
        let own = patch.own(at)?;
        let host = patch.hosts.get(patch.dims.cell(own).0 as usize)?;
        let parent = &self.patches.list[patch.parent];
        Some(parent.to_lattice(parent.dims.ijk(*host)))
    }

    /// The cell of the main grid that a cell is, or lies in.
    pub fn main_cell(&self, at: Ijk) -> Ijk {
        let mut cell = at;
        while let Some(host) = self.host(cell) {
            cell = host;
        }
        cell
    }

    /// The cells of a local grid and their hosts in the lattice.
    pub fn hosts_of(&self, patch: usize) -> impl Iterator<Item = (Ijk, Ijk)> + '_ {
        let patch = &self.patches.list[patch];
        let parent = &self.patches.list[patch.parent];
        let cells = patch.hosts.iter().enumerate();
        cells.map(move |(own, host)| {
            let own = patch.dims.ijk(CellIndex(own as u32));
            let host = parent.to_lattice(parent.dims.ijk(*host));
            (patch.to_lattice(own), host)
        })
    }

    /// By active index the cells that no local grid refines; `None` where these are all.
    pub fn finest(&self) -> Option<Vec<bool>> {
        if self.patches.list.len() == 1 {
            return None;
        }
        let mut finest = vec![true; self.active_cells().len()];
        for number in 1..self.patches.list.len() {
            for (_, host) in self.hosts_of(number) {
                if let Some(active) = self.active_index(self.dims().cell(host)) {
                    finest[active.0 as usize] = false;
                }
            }
        }
        Some(finest)
    }

    /// Divides amounts, by active index, that files give for cells of which several of the lattice are one.
    pub fn share_out(&self, amounts: &mut [f32]) {
        if self.patches.list.iter().all(|patch| patch.split == 1) {
            return;
        }
        for (amount, cell) in amounts.iter_mut().zip(self.active_cells()) {
            let patch = self.patch_of(self.dims().ijk(*cell)).unwrap_or(0);
            *amount /= self.patches.list[patch].split as f32;
        }
    }

    /// The active cells of a grid, with their active indices; of those that are one cell of the file the first.
    pub fn active_in(&self, patch: usize) -> impl Iterator<Item = (usize, Ijk)> + '_ {
        let cells = self.active_cells().iter().enumerate();
        let cells = cells.map(|(active, cell)| (active, self.dims().ijk(*cell)));
        cells.filter(move |(_, at)| self.patch_of(*at) == Some(patch) && self.is_first(*at))
    }
}
