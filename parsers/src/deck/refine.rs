//! Local grids of a deck: CARFIN names the cells that one refines and how many it has, and from there, or from a later
//! REFINE, to ENDFIN keywords are for its cells.
//!
//! Cells divide those that they refine evenly, or as NXFIN and HXFIN (and so on) say: along lines between the edges of the
//! host, as places of a trilinear map. They have the values of their hosts, and then what the deck does to them, in I, J
//! and K of the local grid.

use std::ops::Range;
use std::rc::Rc;

use super::DeckLocalGrid;
use super::array::Rule;
use super::assemble::{MOST_CELLS_PER_BYTE, array};
use super::cells::{CellArrays, MOST_VALUES, is_size};
use super::edit::{CellBox, Edit, Place};
use super::header::{name, positive};
use super::lexer::{Cursor, Keyword, Mistake};
use super::scan::{Block, Scan, product_text};
use super::skip::skip_records;
use super::source::Source;
use crate::egrid::LocalGrid;
use crate::error::{ParseError, Warnings};
use crate::geometry::Lengths;

/// Sizes of cells where none are given: all the same.
const RATIO: Rule = Rule {
    default: Some(1.0),
    undefined: None,
};

/// Keywords that say how many cells divide each host along an axis, and how large these are beside each other.
const DIVISIONS: [[&str; 2]; 3] = [["NXFIN", "HXFIN"], ["NYFIN", "HYFIN"], ["NZFIN", "HZFIN"]];

/// True of the keywords that say how hosts are divided.
pub(super) fn is_division(name: &str) -> bool {
    DIVISIONS.as_flattened().contains(&name)
}

/// A local grid as the deck describes it.
pub(super) struct Refinement {
    pub(super) place: Place,
    name: String,
    /// The local grid that it refines; none for the main one.
    parent: Option<String>,
    /// The cells that it refines.
    hosts: CellBox,
    /// Its cells along i, j and k.
    dims: [usize; 3],
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
    /// CARFIN, REFINE, ENDFIN, and the kinds of local grids that are not read.
    pub(super) fn refine(
        &mut self,
        source: &Rc<Source>,
        cursor: &mut Cursor,
        keyword: &Keyword,
    ) -> Result<(), ParseError> {
        let placed = |mistake| source.mistake(&keyword.name, mistake);
        self.input_box = CellBox::default();
        self.target = match keyword.name.as_str() {
            "CARFIN" => {
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
                            "REFINE: no CARFIN before it is called '{named}'; what is for its cells is left out"
                        );
                        self.warn(source, keyword.at, &message);
                        Target::Nothing
                    }
                }
            }
            other => {
                skip_records(cursor, other).map_err(placed)?;
                if other == "ENDFIN" {
                    Target::Main
                } else {
                    let message = format!(
                        "{other}: radial local grids are not read from text; run the simulator and open the EGRID to see them"
                    );
                    self.warn(source, keyword.at, &message);
                    Target::Nothing
                }
            }
        };
        Ok(())
    }

    /// The record of CARFIN: name, first and last host along i, j and k, cells along them, most wells, and the parent.
    fn begin(&mut self, place: Place, cursor: &mut Cursor) -> Result<Target, Mistake> {
        let items = cursor.record()?;
        let numbers = items.get(1..10).unwrap_or_default();
        let grid = name(&items, 0);
        let is_whole = numbers.len() == 9 && numbers.iter().all(|item| item.text.is_some());
        let (Some(named), true) = (grid, is_whole) else {
            let message = "CARFIN needs a name, the first and the last cell along I, J and K, and numbers of cells: this local grid is left out";
            place.warn(self.warnings, message);
            return Ok(Target::Nothing);
        };
        let known = &self.found.refinements;
        if known.iter().any(|grid| grid.name == named) {
            let message = format!("there is a local grid '{named}' already: this one is left out");
            place.warn(self.warnings, message);
            return Ok(Target::Nothing);
        }
        let mut dims = [0; 3];
        for (dim, item) in dims.iter_mut().zip(&numbers[6..]) {
            *dim = positive(item)?;
        }
        let hosts = CellBox::read(&numbers[..6])?.unwrap_or_default();
        let parent = name(&items, 11).filter(|parent| parent != "GLOBAL");
        self.found.refinements.push(Refinement {
            place,
            name: named,
            parent,
            hosts,
            dims,
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

    /// Keeps a block with how a local grid divides its hosts.
    pub(super) fn division(&mut self, block: Block) {
        if let Target::Local(number) = self.target
            && let Some(grid) = self.found.refinements.get_mut(number)
        {
            grid.divisions.push(block);
        }
    }
}

/// A part of a host along an axis.
#[derive(Clone, Copy)]
pub(super) struct Share {
    /// Number of the host along the axis.
    host: usize,
    /// Where in the host it begins and ends, from 0 to 1.
    ends: [f64; 2],
}

impl Share {
    fn size(self) -> f64 {
        self.ends[1] - self.ends[0]
    }
}

/// A local grid whose arrays are made.
pub(super) struct Refined {
    refinement: Refinement,
    /// Its number among the refined ones; none for the main grid.
    parent: Option<usize>,
    ranges: [Range<usize>; 3],
    /// By cell along each axis.
    shares: [Vec<Share>; 3],
    /// The number of the host of each cell, from 0.
    hosts: Vec<usize>,
    arrays: CellArrays,
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
        match plan(refinement, &made, main, &mut room) {
            Ok(mut grid) => {
                grid.play(warnings)?;
                made.push(grid);
            }
            Err(why) => place.warn(
                warnings,
                format!(
                    "local grid {named} is left out, and its place shows the host cells: {why}"
                ),
            ),
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
) -> Result<Refined, String> {
    if main.is_dual() {
        return Err("local grids of dual porosity are not read from text".into());
    }
    let parent = match &refinement.parent {
        None => None,
        Some(parent) => {
            let known = made.iter().position(|grid| grid.refinement.name == *parent);
            Some(known.ok_or_else(|| format!("there is no grid {parent} before it"))?)
        }
    };
    let arrays = parent.map_or(main, |number| &made[number].arrays);
    let ranges = refinement.hosts.ranges(arrays.dims());
    let ranges = ranges.ok_or("its box is outside the grid that it refines")?;
    let meets = |a: &Range<usize>, b: &Range<usize>| a.start < b.end && b.start < a.end;
    let beside = made.iter().filter(|grid| grid.parent == parent);
    for grid in beside {
        if grid.ranges.iter().zip(&ranges).all(|(a, b)| meets(a, b)) {
            let other = &grid.refinement.name;
            return Err(format!("it refines cells that {other} refines"));
        }
    }
    let dims = refinement.dims;
    let Some(lengths) = Lengths::of(dims) else {
        return Err(format!("{} cells are too many", product_text(dims)));
    };
    room.take(lengths.cells, arrays.count() + refinement.edits.len())?;
    let mut shares = [const { Vec::new() }; 3];
    for (axis, shares) in shares.iter_mut().enumerate() {
        *shares = refinement.shares(axis, ranges[axis].clone())?;
    }
    let hosts = hosts(&shares, arrays.dims());
    let size = |cell: usize, axis: usize| {
        let [ni, nj, _] = dims;
        shares[axis][[cell % ni, cell / ni % nj, cell / (ni * nj)][axis]].size()
    };
    Ok(Refined {
        arrays: arrays.of_hosts(dims, &hosts, size),
        refinement,
        parent,
        ranges,
        shares,
        hosts,
    })
}

/// The number of the host of each cell.
fn hosts([along_i, along_j, along_k]: &[Vec<Share>; 3], [ni, nj, _]: [usize; 3]) -> Vec<usize> {
    let mut hosts = Vec::with_capacity(along_i.len() * along_j.len() * along_k.len());
    for k in along_k {
        for j in along_j {
            let row = ni * (j.host + nj * k.host);
            hosts.extend(along_i.iter().map(|i| i.host + row));
        }
    }
    hosts
}

impl Refinement {
    /// How the hosts of a range along an axis are divided.
    fn shares(&self, axis: usize, hosts: Range<usize>) -> Result<Vec<Share>, String> {
        let (cells, [counts_name, sizes_name]) = (self.dims[axis], DIVISIONS[axis]);
        let read = |keyword: &str, count: usize| {
            let block = self.divisions.iter().rev().find(|b| b.name == keyword)?;
            let values = array(block, RATIO, &[count]);
            Some(values.map_err(|error| format!("{keyword}: {}", error.message)))
        };
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
            let message = format!(
                "{} of local grid {named} is not read: its cells divide those that it refines evenly, or by NXFIN and HXFIN and so on",
                edit.target()
            );
            edit.place().warn(warnings, message);
        }
        self.arrays.play(edits, warnings)
    }

    /// The grid of cells that divide those of its parent.
    fn grid(self, number: usize, parent: &Corners<'_>, parent_name: String) -> DeckLocalGrid {
        let dims = self.refinement.dims;
        let mut arrays = self.arrays;
        let actnum = arrays.take("ACTNUM").map(|array| {
            let active = array.values.iter().map(|value| i32::from(*value != 0.0));
            active.collect()
        });
        let number_of = |n: usize| i32::try_from(n).unwrap_or(i32::MAX);
        DeckLocalGrid {
            grid: LocalGrid {
                name: self.refinement.name,
                parent: parent_name,
                number: number_of(number + 1),
                dims,
                coord: parent.coord_of(&self.shares),
                zcorn: parent.zcorn_of(&self.shares),
                actnum,
                host: self.hosts.iter().map(|host| number_of(host + 1)).collect(),
                ..LocalGrid::default()
            },
            properties: arrays.into_properties(),
        }
    }
}

/// The cells of local grids, whose main grid has these corners.
pub(super) fn grids(made: Vec<Refined>, main: &Corners<'_>) -> Vec<DeckLocalGrid> {
    let mut grids: Vec<DeckLocalGrid> = Vec::with_capacity(made.len());
    for (number, grid) in made.into_iter().enumerate() {
        let parent = grid.parent.and_then(|parent| grids.get(parent));
        let grid = match parent.map(|parent| &parent.grid) {
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
        grids.push(grid);
    }
    grids
}

/// Pillars and depths of a grid.
pub(super) struct Corners<'a> {
    pub(super) dims: [usize; 3],
    pub(super) coord: &'a [f64],
    pub(super) zcorn: &'a [f64],
}

/// A host along an axis, and a place in it from 0 to 1.
type Within = (usize, f64);

impl Corners<'_> {
    /// Depth of a corner of a cell, numbered along i first, then j, then k.
    fn depth(&self, [i, j, k]: [usize; 3], corner: usize) -> f64 {
        let [ni, nj, _] = self.dims;
        let (x, y, z) = (
            2 * i + (corner & 1),
            2 * j + (corner >> 1 & 1),
            2 * k + (corner >> 2),
        );
        self.zcorn[x + 2 * ni * (y + 2 * nj * z)]
    }

    fn ends(&self, i: usize, j: usize) -> &[f64] {
        let pillar = 6 * (i + (self.dims[0] + 1) * j);
        &self.coord[pillar..pillar + 6]
    }

    /// The pillar through a place in a column, between the pillars of the column, from the top of a layer to the bottom of
    /// another one.
    fn pillar(&self, (i, u): Within, (j, v): Within, layers: [usize; 2]) -> [f64; 6] {
        let corners = || (0..4).map(|c| (c, part(u, c & 1) * part(v, c >> 1)));
        let mut line = [0.0; 6];
        for (half, corner) in [(0, 0), (1, 4)] {
            for (c, weight) in corners() {
                let depth = self.depth([i, j, layers[half]], c + corner);
                let [x, y] = place_at(self.ends(i + (c & 1), j + (c >> 1)), depth);
                for (sum, value) in line[3 * half..].iter_mut().zip([x, y, depth]) {
                    *sum += weight * value;
                }
            }
        }
        if line[2] < line[5] {
            return line;
        }
        // Without thickness between them the ends say where the pillar goes.
        let mut line = [0.0; 6];
        for (c, weight) in corners() {
            let ends = self.ends(i + (c & 1), j + (c >> 1));
            for (sum, value) in line.iter_mut().zip(ends) {
                *sum += weight * value;
            }
        }
        line
    }

    fn coord_of(&self, [along_i, along_j, along_k]: &[Vec<Share>; 3]) -> Vec<f64> {
        let layers = [along_k.first(), along_k.last()].map(|share| share.map_or(0, |s| s.host));
        let mut coord = Vec::with_capacity(6 * (along_i.len() + 1) * (along_j.len() + 1));
        for j in edges(along_j) {
            for i in edges(along_i) {
                coord.extend(self.pillar(i, j, layers));
            }
        }
        coord
    }

    fn zcorn_of(&self, [along_i, along_j, along_k]: &[Vec<Share>; 3]) -> Vec<f64> {
        let both = |shares: &[Share]| -> Vec<Within> {
            let both = |share: &Share| share.ends.map(|end| (share.host, end));
            shares.iter().flat_map(both).collect()
        };
        let [along_i, along_j, along_k] = [along_i, along_j, along_k].map(|shares| both(shares));
        let mut zcorn = Vec::with_capacity(along_i.len() * along_j.len() * along_k.len());
        for (k, w) in along_k {
            for &(j, v) in &along_j {
                zcorn.extend(along_i.iter().map(|&(i, u)| {
                    let of_corner = |c: usize| {
                        let weight = part(u, c & 1) * part(v, c >> 1 & 1) * part(w, c >> 2);
                        weight * self.depth([i, j, k], c)
                    };
                    (0..8).map(of_corner).sum::<f64>()
                }));
            }
        }
        zcorn
    }
}

/// How much an end, 0 or 1, counts at a place between them.
fn part(place: f64, end: usize) -> f64 {
    if end == 0 { 1.0 - place } else { place }
}

/// x and y of a pillar at a depth.
fn place_at(ends: &[f64], depth: f64) -> [f64; 2] {
    let length = ends[5] - ends[2];
    let along = if length == 0.0 {
        0.0
    } else {
        (depth - ends[2]) / length
    };
    [0, 1].map(|n| ends[n] + along * (ends[n + 3] - ends[n]))
}

/// Where the pillars of cells stand along an axis.
fn edges(shares: &[Share]) -> impl Iterator<Item = Within> {
    let starts = shares.iter().map(|share| (share.host, share.ends[0]));
    starts.chain(shares.last().map(|share| (share.host, share.ends[1])))
}
