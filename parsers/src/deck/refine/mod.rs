//! Local grids of a deck: CARFIN, RADFIN or RADFIN4 names the cells that one refines and how many it has, and from there, or
//! from a later REFINE, to ENDFIN keywords are for its cells.
//!
//! Cells divide those that they refine evenly, or as NXFIN and HXFIN (and so on) say: along lines between the edges of the
//! host, as places of a trilinear map; those of radial grids are rings and sectors ([`rings`]). They have the values of
//! their hosts, and then what the deck does to them, in I, J and K of the local grid. Of dual porosity the upper half of
//! their layers is matrix and the lower one fractures, as in the main grid.

mod corners;
mod rings;

use std::ops::Range;
use std::rc::Rc;

use super::DeckLocalGrid;
use super::array::Rule;
use super::assemble::{MOST_CELLS_PER_BYTE, array, matrix_and_fractures};
use super::cells::{CellArrays, MOST_VALUES, is_size};
use super::edit::{CellBox, Edit, Place};
use super::header::{name, positive, real};
use super::lexer::{Cursor, Item, Keyword, Mistake};
use super::scan::{Block, Scan, product_text};
use super::skip::skip_records;
use super::source::Source;
use crate::egrid::LocalGrid;
use crate::error::{ParseError, Warnings};
use crate::geometry::Lengths;
use corners::Share;
use rings::Rings;

pub(super) use corners::Corners;

/// Sizes of cells where none are given: all the same.
const RATIO: Rule = Rule {
    default: Some(1.0),
    undefined: None,
};

/// Keywords that say how many cells divide each host along an axis, and how large these are beside each other.
const DIVISIONS: [[&str; 2]; 3] = [["NXFIN", "HXFIN"], ["NYFIN", "HYFIN"], ["NZFIN", "HZFIN"]];

/// Keywords that say where the rings and sectors of a radial local grid are.
const OF_RINGS: [&str; 6] = ["INRAD", "OUTRAD", "DRV", "DTHETAV", "DR", "DTHETA"];

/// A local grid as the deck describes it.
pub(super) struct Refinement {
    pub(super) place: Place,
    name: String,
    /// The local grid that it refines; none for the main one.
    parent: Option<String>,
    /// The cells that it refines.
    hosts: CellBox,
    /// Its cells along i, j and k, or along radius, angle and k; with dual porosity k counts those of the fractures too.
    dims: [usize; 3],
    /// Of a radial grid the inner and the outer radius, as far as its record has them.
    radii: Option<[Option<f64>; 2]>,
    /// How it divides them.
    divisions: Vec<Block>,
    /// What is done to its arrays, in order.
    pub(super) edits: Vec<Edit>,
}

/// Whose cells keywords are for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Target {
    Main,
    /// The number of a local grid.
    Local(usize),
    /// A local grid that is not read.
    Nothing,
}

impl Scan<'_> {
    /// CARFIN, RADFIN, RADFIN4, REFINE and ENDFIN.
    pub(super) fn refine(
        &mut self,
        source: &Rc<Source>,
        cursor: &mut Cursor,
        keyword: &Keyword,
    ) -> Result<(), ParseError> {
        let placed = |mistake| source.mistake(&keyword.name, mistake);
        self.input_box = CellBox::default();
        self.target = match keyword.name.as_str() {
            "CARFIN" | "RADFIN" | "RADFIN4" => {
                let place = Place {
                    source: Rc::clone(source),
                    at: keyword.at,
                    keyword: keyword.name.clone(),
                };
                self.begin(place, cursor).map_err(placed)?
            }
            "REFINE" => {
                let items = cursor.record().map_err(placed)?;
                let named = name(&items, 0).unwrap_or_default();
                let grids = &self.found.refinements;
                match grids.iter().position(|grid| grid.name == named) {
                    Some(number) => Target::Local(number),
                    None => {
                        let message = format!(
                            "REFINE: no local grid before it is called '{named}'; what is for its cells is left out"
                        );
                        self.warn(source, keyword.at, &message);
                        Target::Nothing
                    }
                }
            }
            other => {
                skip_records(cursor, other).map_err(placed)?;
                Target::Main
            }
        };
        Ok(())
    }

    /// The record of a local grid.
    fn begin(&mut self, place: Place, cursor: &mut Cursor) -> Result<Target, Mistake> {
        let items = cursor.record()?;
        let Some(record) = Record::of(&place.keyword, &items) else {
            let message = format!(
                "{} needs a name, the first and the last cell along I, J and K, and numbers of cells: this local grid is left out",
                place.keyword
            );
            place.warn(self.warnings, message);
            return Ok(Target::Nothing);
        };
        let named = record.name;
        let known = &self.found.refinements;
        if known.iter().any(|grid| grid.name == named) {
            let message = format!("there is a local grid '{named}' already: this one is left out");
            place.warn(self.warnings, message);
            return Ok(Target::Nothing);
        }
        let mut dims = [0; 3];
        for (dim, item) in dims.iter_mut().zip(&record.dims) {
            *dim = positive(item)?;
        }
        let hosts = CellBox::read(&record.hosts)?.unwrap_or_default();
        let parent = record.parent.filter(|parent| parent != "GLOBAL");
        let radius = |item: &Option<Item>| item.as_ref().map(real).transpose();
        let radii = match &record.radii {
            Some([inner, outer]) => Some([radius(inner)?, radius(outer)?]),
            None => None,
        };
        self.found.refinements.push(Refinement {
            place,
            name: named,
            parent,
            hosts,
            dims,
            radii,
            divisions: Vec::new(),
            edits: Vec::new(),
        });
        Ok(Target::Local(self.found.refinements.len() - 1))
    }

    /// What is done to the arrays of the cells that keywords are for; `None` where these are not read.
    pub(super) fn edits(&mut self) -> Option<&mut Vec<Edit>> {
        match self.target {
            Target::Main => Some(&mut self.found.edits),
            Target::Local(number) => {
                let grid = self.found.refinements.get_mut(number);
                grid.map(|grid| &mut grid.edits)
            }
            Target::Nothing => None,
        }
    }

    /// True of a keyword that says how the local grid at hand divides its hosts.
    pub(super) fn is_division(&self, name: &str) -> bool {
        let is_radial = match self.target {
            Target::Local(number) => {
                let grid = self.found.refinements.get(number);
                grid.is_some_and(|grid| grid.radii.is_some())
            }
            Target::Main | Target::Nothing => false,
        };
        DIVISIONS.as_flattened().contains(&name) || is_radial && OF_RINGS.contains(&name)
    }

    /// Keeps a block with how a local grid divides its hosts.
    pub(super) fn division(&mut self, block: Block) {
        if let Target::Local(number) = self.target
            && let Some(grid) = self.found.refinements.get_mut(number)
        {
            grid.divisions.push(block);
        }
    }
}

/// The items of the record of a local grid.
struct Record<'a> {
    name: String,
    /// First and last host along i, j and k.
    hosts: [Item<'a>; 6],
    /// Numbers of cells.
    dims: [Item<'a>; 3],
    parent: Option<String>,
    /// Of a radial grid, the inner and the outer radius.
    radii: Option<[Option<Item<'a>>; 2]>,
}

impl<'a> Record<'a> {
    /// Behind the numbers of cells stands the most wells that there may be, and behind that the parent (CARFIN) or the
    /// radii (RADFIN). RADFIN refines one column, by its I and J. `None` where items are missing.
    fn of(keyword: &str, items: &[Item<'a>]) -> Option<Self> {
        let item = |at: usize| items.get(at).copied().filter(|item| item.text.is_some());
        let places = match keyword {
            "RADFIN" => [1, 1, 2, 2, 3, 4, 5, 6, 7],
            _ => [1, 2, 3, 4, 5, 6, 7, 8, 9],
        };
        let numbers: Vec<Item> = places.into_iter().map_while(item).collect();
        let (hosts, dims) = numbers.split_at_checked(6)?;
        Some(Self {
            name: name(items, 0)?,
            hosts: hosts.try_into().ok()?,
            dims: dims.try_into().ok()?,
            parent: name(items, 11).filter(|_| keyword == "CARFIN"),
            radii: match keyword {
                "CARFIN" => None,
                "RADFIN" => Some([item(9), item(10)]),
                _ => Some([None, None]),
            },
        })
    }
}

/// A local grid whose arrays are made.
pub(super) struct Refined {
    refinement: Refinement,
    /// Its number among the refined ones; none for the main grid.
    parent: Option<usize>,
    ranges: [Range<usize>; 3],
    /// Its cells in space: with dual porosity half of its layers.
    dims: [usize; 3],
    cells: Cells,
    /// The number of the host of each of these cells, from 0.
    hosts: Vec<usize>,
    arrays: CellArrays,
}

/// How the cells of a local grid divide their hosts.
enum Cells {
    /// By cell along each axis.
    Boxes([Vec<Share>; 3]),
    Rings(Rings),
}

impl Cells {
    fn of(
        refinement: &Refinement,
        dims: [usize; 3],
        ranges: &[Range<usize>; 3],
        warnings: &mut Warnings,
    ) -> Result<Self, String> {
        let along = |axis: usize| refinement.shares(axis, dims[axis], ranges[axis].clone());
        Ok(match refinement.radii {
            None => Self::Boxes([along(0)?, along(1)?, along(2)?]),
            Some(_) => Self::Rings(Rings::of(refinement, dims, ranges, along(2)?, warnings)?),
        })
    }

    /// The number of the host of each cell, in a parent `ni` by `nj` cells wide.
    fn hosts(&self, [ni, nj, _]: [usize; 3]) -> Vec<usize> {
        let [along_i, along_j, along_k] = match self {
            Self::Boxes(shares) => shares,
            Self::Rings(rings) => return rings.hosts([ni, nj]),
        };
        let mut hosts = Vec::with_capacity(along_i.len() * along_j.len() * along_k.len());
        for k in along_k {
            for j in along_j {
                let row = ni * (j.host + nj * k.host);
                hosts.extend(along_i.iter().map(|i| i.host + row));
            }
        }
        hosts
    }

    /// How much of its host the cell at a place along an axis is; radial cells are no part of their hosts' width.
    fn size(&self, axis: usize, at: usize) -> f64 {
        match self {
            Self::Boxes(shares) => shares[axis][at].size(),
            Self::Rings(rings) if axis == 2 => rings.along_k[at].size(),
            Self::Rings(_) => f64::NAN,
        }
    }
}

/// The local grids of a deck with their arrays, begun with those of `main`; why one is left out goes to `warnings`.
///
/// There may be as many cells and values as `bytes` of text allow for.
pub(super) fn refined(
    refinements: Vec<Refinement>,
    main: &CellArrays,
    bytes: usize,
    warnings: &mut Warnings,
) -> Result<Vec<Refined>, ParseError> {
    let mut room = Room {
        cells: bytes.saturating_mul(MOST_CELLS_PER_BYTE),
        values: MOST_VALUES.max(bytes),
    };
    let mut made: Vec<Refined> = Vec::new();
    for refinement in refinements {
        let place = refinement.place.clone();
        let named = refinement.name.clone();
        match plan(refinement, &made, main, &mut room, warnings) {
            Ok(mut grid) => {
                grid.play(warnings)?;
                made.push(grid);
            }
            Err(why) => place.warn(warnings, left_out(&named, &why)),
        }
    }
    for grid in &mut made {
        grid.arrays.join_factors();
    }
    Ok(made)
}

/// What a deck may still ask for.
struct Room {
    cells: usize,
    values: usize,
}

impl Room {
    fn take(&mut self, cells: usize, arrays: usize) -> Result<(), String> {
        let values = cells.saturating_mul(arrays.max(8));
        let left = (self.cells.checked_sub(cells)).zip(self.values.checked_sub(values));
        let (cells, values) =
            left.ok_or("it has more cells than the length of the deck allows for")?;
        (self.cells, self.values) = (cells, values);
        Ok(())
    }
}

/// A local grid with the arrays of its hosts, or why there is none.
fn plan(
    refinement: Refinement,
    made: &[Refined],
    main: &CellArrays,
    room: &mut Room,
    warnings: &mut Warnings,
) -> Result<Refined, String> {
    let parent = match &refinement.parent {
        None => None,
        Some(parent) => {
            let known = made.iter().position(|grid| grid.refinement.name == *parent);
            Some(known.ok_or_else(|| format!("there is no grid {parent} before it"))?)
        }
    };
    if parent.is_some_and(|number| made[number].refinement.radii.is_some()) {
        return Err("it refines a radial grid, of which no cell is divided".into());
    }
    let arrays = parent.map_or(main, |number| &made[number].arrays);
    let halves = if main.is_dual() { 2 } else { 1 };
    let shown = |[ni, nj, nk]: [usize; 3]| [ni, nj, nk / halves];
    let ranges = refinement.hosts.ranges(shown(arrays.dims()));
    let ranges = ranges.ok_or_else(|| outside(halves > 1))?;
    let meets = |a: &Range<usize>, b: &Range<usize>| a.start < b.end && b.start < a.end;
    let beside = made.iter().filter(|grid| grid.parent == parent);
    for grid in beside {
        if grid.ranges.iter().zip(&ranges).all(|(a, b)| meets(a, b)) {
            let other = &grid.refinement.name;
            return Err(format!("it refines cells that {other} refines"));
        }
    }
    let all = refinement.dims;
    let Some(lengths) = Lengths::of(all) else {
        return Err(format!("{} cells are too many", product_text(all)));
    };
    if !all[2].is_multiple_of(halves) {
        return Err(format!(
            "{} layers of dual porosity: there must be an even number, half of them matrix and half fractures",
            all[2]
        ));
    }
    room.take(lengths.cells, arrays.count() + refinement.edits.len())?;
    let dims = shown(all);
    let cells = Cells::of(&refinement, dims, &ranges, warnings)?;
    let hosts = cells.hosts(arrays.dims());
    let below = arrays.dims().iter().product::<usize>() / halves;
    let of_half = |half: usize| hosts.iter().map(move |host| host + half * below);
    let of_all: Vec<usize> = (0..halves).flat_map(of_half).collect();
    let size = |cell: usize, axis: usize| {
        let [ni, nj, nk] = dims;
        let place = [cell % ni, cell / ni % nj, cell / (ni * nj) % nk];
        cells.size(axis, place[axis])
    };
    Ok(Refined {
        arrays: arrays.of_hosts(all, &of_all, size),
        refinement,
        parent,
        ranges,
        dims,
        cells,
        hosts,
    })
}

fn outside(is_dual: bool) -> String {
    match is_dual {
        true => "its box is outside the matrix of the grid that it refines, which is the upper half of the layers",
        false => "its box is outside the grid that it refines",
    }
    .into()
}

impl Refinement {
    /// The numbers behind a keyword that says how hosts are divided.
    fn read(&self, keyword: &str, count: usize) -> Option<Result<Vec<f64>, String>> {
        let block = self.divisions.iter().rev().find(|b| b.name == keyword)?;
        let values = array(block, RATIO, &[count]);
        Some(values.map_err(|error| format!("{keyword}: {}", error.message)))
    }

    /// How the hosts of a range along an axis are divided into cells.
    fn shares(&self, axis: usize, cells: usize, hosts: Range<usize>) -> Result<Vec<Share>, String> {
        let [counts_name, sizes_name] = DIVISIONS[axis];
        let read = |keyword: &str, count: usize| self.read(keyword, count);
        let counts = match read(counts_name, hosts.len()).transpose()? {
            None if cells.is_multiple_of(hosts.len()) => vec![cells / hosts.len(); hosts.len()],
            None => {
                return Err(format!(
                    "{cells} cells are not shared evenly among {} hosts, and {counts_name} does not say how",
                    hosts.len()
                ));
            }
            Some(counts) => whole(&counts, cells).ok_or_else(|| {
                format!("{counts_name} needs numbers of cells that are {cells} together")
            })?,
        };
        let sizes = read(sizes_name, cells).transpose()?;
        let sizes = sizes.unwrap_or_else(|| vec![1.0; cells]);
        if sizes.iter().any(|size| *size <= 0.0) {
            return Err(format!("{sizes_name} needs sizes above 0"));
        }
        let mut shares = Vec::with_capacity(cells);
        let mut rest = sizes.as_slice();
        for (host, count) in hosts.zip(counts) {
            let (of_host, behind) = rest.split_at(count);
            rest = behind;
            let whole: f64 = of_host.iter().sum();
            let mut before = 0.0;
            shares.extend(of_host.iter().enumerate().map(|(n, size)| {
                let start = before / whole;
                before += size;
                let end = if n + 1 == count { 1.0 } else { before / whole };
                let ends = [start, end];
                Share { host, ends }
            }));
        }
        Ok(shares)
    }
}

/// Positive whole numbers with a sum.
fn whole(values: &[f64], sum: usize) -> Option<Vec<usize>> {
    let is_count = |value: &f64| value.fract() == 0.0 && (1.0..=1e9).contains(value);
    if !values.iter().all(is_count) {
        return None;
    }
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "all values are whole and at most a billion"
    )]
    let counts: Vec<usize> = values.iter().map(|value| *value as usize).collect();
    (counts.iter().sum::<usize>() == sum).then_some(counts)
}

impl Refined {
    /// Plays what the deck does to its arrays.
    fn play(&mut self, warnings: &mut Warnings) -> Result<(), ParseError> {
        let (place, named) = (&self.refinement.place, &self.refinement.name);
        let lost = self.arrays.take_lost();
        if !lost.is_empty() {
            let message = format!(
                "{} of local grid {named} are not those of the cells that it refines: its own are shown where the deck gives them",
                lost.join(", ")
            );
            place.warn(warnings, message);
        }
        let edits = std::mem::take(&mut self.refinement.edits);
        let is_place = |edit: &Edit| {
            let name = edit.target();
            is_size(name) || ["COORD", "ZCORN", "DXV", "DYV", "DZV"].contains(&name)
        };
        let (places, edits): (Vec<_>, Vec<_>) = edits.into_iter().partition(is_place);
        if let Some(edit) = places.first() {
            let how = match self.cells {
                Cells::Boxes(_) => {
                    "its cells divide those that it refines evenly, or by NXFIN and HXFIN and so on"
                }
                Cells::Rings(_) => {
                    "its rings are by INRAD with DRV or OUTRAD, its sectors by DTHETAV, its layers even or by NZFIN and HZFIN"
                }
            };
            let message = format!("{} of local grid {named} is not read: {how}", edit.target());
            edit.place().warn(warnings, message);
        }
        if self.arrays.is_dual() {
            let half = self.dims[2];
            let message = format!(
                "the {} layers of local grid {named} are taken for {half} of matrix and {half} of fractures",
                2 * half
            );
            place.warn(warnings, message);
        }
        self.arrays.play(edits, warnings)
    }

    /// The grid of cells that divide those of its parent, or why there is none.
    fn grid(
        self,
        number: usize,
        parent: &Corners<'_>,
        parent_name: String,
    ) -> Result<DeckLocalGrid, String> {
        let dims = self.dims;
        let mut arrays = self.arrays;
        let actnum = arrays.take("ACTNUM").map(|array| {
            let active = array.values.iter().map(|value| i32::from(*value != 0.0));
            active.collect()
        });
        let actnum = match arrays.is_dual() {
            true => Some(matrix_and_fractures(actnum, self.hosts.len())),
            false => actnum,
        };
        arrays.show(dims);
        let number_of = |n: usize| i32::try_from(n).unwrap_or(i32::MAX);
        let [coord, zcorn] = match &self.cells {
            Cells::Boxes(shares) => [parent.coord_of(shares), parent.zcorn_of(shares)],
            Cells::Rings(rings) => rings.corners(parent)?,
        };
        Ok(DeckLocalGrid {
            grid: LocalGrid {
                name: self.refinement.name,
                parent: parent_name,
                number: number_of(number + 1),
                dims,
                coord,
                zcorn,
                actnum,
                host: self.hosts.iter().map(|host| number_of(host + 1)).collect(),
                is_radial: self.refinement.radii.is_some(),
                ..LocalGrid::default()
            },
            properties: arrays.into_properties(),
        })
    }
}

/// The cells of local grids, whose main grid has these corners; why one is left out goes to `warnings`.
pub(super) fn grids(
    made: Vec<Refined>,
    main: &Corners<'_>,
    warnings: &mut Warnings,
) -> Vec<DeckLocalGrid> {
    // Those that are left out are radial, which no other one refines.
    let mut grids: Vec<Option<DeckLocalGrid>> = Vec::with_capacity(made.len());
    for (number, grid) in made.into_iter().enumerate() {
        let parent = grid.parent.and_then(|parent| grids.get(parent)?.as_ref());
        let place = grid.refinement.place.clone();
        let named = grid.refinement.name.clone();
        let made = match parent.map(|parent| &parent.grid) {
            None => grid.grid(number, main, String::new()),
            Some(parent) => {
                let corners = Corners {
                    dims: parent.dims,
                    coord: &parent.coord,
                    zcorn: &parent.zcorn,
                };
                grid.grid(number, &corners, parent.name.clone())
            }
        };
        if let Err(why) = &made {
            place.warn(warnings, left_out(&named, why));
        }
        grids.push(made.ok());
    }
    grids.into_iter().flatten().collect()
}

fn left_out(named: &str, why: &str) -> String {
    format!("local grid {named} is left out, and its place shows the host cells: {why}")
}
