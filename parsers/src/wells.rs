//! Wells of a restart step: where they go, what they are, what flows.
//!
//! The items of IWEL, SWEL, XWEL, ICON and SCON are those that OPM's public headers name
//! (`opm/output/eclipse/VectorItems`: `intehead.hpp`, `logihead.hpp`, `well.hpp`, `connection.hpp`; counted from 0
//! there and here). Other items are not read.
//!
//! ```
//! use strataray_parsers::{Warnings, records::RecordWriter, restart, wells};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut out = RecordWriter::new(Vec::new());
//! let mut head = [0; 40];
//! // 3 x 3 x 2 cells, one well of one completion, and how many items each has.
//! head[8..11].copy_from_slice(&[3, 3, 2]);
//! for (item, value) in [(16, 1), (17, 1), (24, 11), (27, 1), (32, 14)] {
//!     head[item] = value;
//! }
//! out.inte("INTEHEAD", &head)?;
//! out.inte("IWEL", &[2, 3, 1, 1, 1, 0, 1, 0, 0, 0, 1])?;
//! out.chars("ZWEL", &["P1"])?;
//! out.inte("ICON", &[1, 2, 3, 1, 0, 1, 0, 0, 0, 0, 0, 0, 1, 3])?;
//! let bytes = out.finish()?;
//!
//! let steps = restart::unified_from_bytes(("CASE.UNRST", bytes), &mut Warnings::default())?;
//! let wells = wells::read(&steps[0].arrays)?;
//! assert_eq!((wells[0].name.as_str(), wells[0].kind), ("P1", wells::Kind::Producer));
//! assert_eq!(wells[0].completions[0].cell, [2, 3, 1]);
//! # Ok(())
//! # }
//! ```

use std::collections::HashMap;
use std::io::{self, Write};

use crate::cells::CellArrays;
use crate::error::{ErrorKind, ParseError};
use crate::records::{Entry, RecordWriter, refused};

/// A well at a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Well {
    /// Name.
    pub name: String,
    /// Group, where it is known.
    pub group: Option<String>,
    /// I and J of the head, from 1, in the global grid.
    pub head: [i32; 2],
    /// Reference depth of the bottom-hole pressure, in the length unit of the results, where it is written.
    pub depth: Option<f32>,
    /// What it does.
    pub kind: Kind,
    /// Whether it does it.
    pub status: Status,
    /// Number of segments; 0 where it is no multi-segment well.
    pub segments: i32,
    /// Completions in cells of the global grid. Those of a well in a local grid are in its host cells here.
    pub completions: Vec<Completion>,
    /// Completions in the cells of local grids.
    pub local: Vec<LocalWell>,
    /// What flows, where XWEL is written.
    pub flow: Option<Flow>,
    /// What a schedule asks of it; none of a restart.
    pub targets: Vec<Target>,
}

/// A rate or a pressure that a schedule asks of a well, or limits it to, in the units of the deck.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// ORAT, WRAT, GRAT, LRAT, RESV, BHP or THP, or RATE of an injector.
    pub name: &'static str,
    /// How much.
    pub value: f64,
}

impl Well {
    /// A well of which nothing is known but its name: shut, and not connected to cells.
    pub fn named(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            group: None,
            head: [0; 2],
            depth: None,
            kind: Kind::Undefined,
            status: Status::Shut,
            segments: 0,
            completions: Vec::new(),
            local: Vec::new(),
            flow: None,
            targets: Vec::new(),
        }
    }
}

impl Completion {
    /// An open connection to a cell, `order` from 1 being its place in the well.
    pub fn open(cell: [i32; 3], direction: Direction, order: i32) -> Self {
        Self {
            cell,
            is_fracture: false,
            is_open: true,
            direction: Some(direction),
            order,
            number: order,
            segment: 0,
            factor: None,
            depth: None,
            diameter: None,
            kh: None,
            skin: None,
        }
    }
}

/// What a local grid says of a well.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalWell {
    /// Name of the grid.
    pub grid: String,
    /// I and J of the head, from 1, in the local grid.
    pub head: [i32; 2],
    /// Completions in its cells.
    pub completions: Vec<Completion>,
}

/// What a well does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// It produces.
    Producer,
    /// It injects oil.
    OilInjector,
    /// It injects water.
    WaterInjector,
    /// It injects gas.
    GasInjector,
    /// The file does not say, as before the well is opened first.
    Undefined,
}

/// Whether a well flows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Status {
    /// It is open.
    Open,
    /// It is closed above the reservoir: between its completions there may be flow.
    Stopped,
    /// It is shut.
    Shut,
}

/// A connection of a well to a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Completion {
    /// I, J and K of the cell, from 1. With dual porosity K is that of the matrix, also where the cell is of the
    /// fractures.
    pub cell: [i32; 3],
    /// True for a cell of the fractures.
    pub is_fracture: bool,
    /// True where it is open.
    pub is_open: bool,
    /// Direction in which the well goes through the cell, where it is known.
    pub direction: Option<Direction>,
    /// Place in the order of the well's connections, from 1.
    pub order: i32,
    /// Number of the completion that the connection is part of.
    pub number: i32,
    /// Segment; 0 where the well has none.
    pub segment: i32,
    /// Transmissibility factor of the connection, where SCON is written.
    pub factor: Option<f32>,
    /// Depth of its middle, in the length unit of the results.
    pub depth: Option<f32>,
    /// Diameter of the hole, in the length unit of the results; none where it is not positive.
    pub diameter: Option<f32>,
    /// Product of effective permeability and thickness.
    pub kh: Option<f32>,
    /// Skin factor.
    pub skin: Option<f32>,
}

/// An axis of the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Along I.
    X,
    /// Along J.
    Y,
    /// Along K.
    Z,
}

/// Rates, pressures and totals of a well in the units of the results; rates of injection are negative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flow {
    /// Surface rate of oil.
    pub oil: f64,
    /// Surface rate of water.
    pub water: f64,
    /// Surface rate of gas.
    pub gas: f64,
    /// Rate of reservoir volume.
    pub voidage: f64,
    /// Tubing-head pressure.
    pub tubing_head_pressure: f64,
    /// Bottom-hole pressure.
    pub bottom_hole_pressure: f64,
    /// Water cut.
    pub water_cut: f64,
    /// Gas-oil ratio.
    pub gas_oil_ratio: f64,
    /// Oil, water and gas produced since the start.
    pub produced: [f64; 3],
    /// Oil, water and gas injected since the start.
    pub injected: [f64; 3],
}

/// Items of a well and of a connection in the arrays that are written, as many as simulators write.
pub(crate) const ITEMS: ItemCounts = ItemCounts {
    iwel: 155,
    swel: 122,
    xwel: 130,
    zwel: 3,
    icon: 26,
    scon: 42,
};

/// How many items each well or connection has in an array.
pub(crate) struct ItemCounts {
    pub(crate) iwel: usize,
    pub(crate) swel: usize,
    pub(crate) xwel: usize,
    pub(crate) zwel: usize,
    pub(crate) icon: usize,
    pub(crate) scon: usize,
}

/// Writes IWEL, SWEL, XWEL, ZWEL, ICON and SCON of some wells, which [`read`] reads as the same wells. Groups, what is
/// in local grids and K of fractures are not written. SWEL, XWEL and SCON are left out where nothing is known of them.
pub(crate) fn write<W: Write>(out: &mut RecordWriter<W>, wells: &[Well]) -> io::Result<()> {
    if wells.is_empty() {
        return Ok(());
    }
    let most = wells.iter().map(|well| well.completions.len()).max();
    let most = most.unwrap_or(0);
    let mut iwel = vec![0; ITEMS.iwel * wells.len()];
    let mut swel = vec![0.0; ITEMS.swel * wells.len()];
    let mut xwel = vec![0.0; ITEMS.xwel * wells.len()];
    let mut names = vec![""; ITEMS.zwel * wells.len()];
    let mut icon = vec![0; ITEMS.icon * most * wells.len()];
    let mut scon = vec![0.0; ITEMS.scon * most * wells.len()];
    for (n, well) in wells.iter().enumerate() {
        names[ITEMS.zwel * n] = &well.name;
        write_well(&mut iwel[ITEMS.iwel * n..], well)?;
        swel[ITEMS.swel * n + 9] = well.depth.unwrap_or(0.0);
        if let Some(flow) = &well.flow {
            write_flow(&mut xwel[ITEMS.xwel * n..], flow);
        }
        for (c, completion) in well.completions.iter().enumerate() {
            let at = most * n + c;
            write_integers(&mut icon[ITEMS.icon * at..], completion);
            write_reals(&mut scon[ITEMS.scon * at..], completion);
        }
    }
    out.inte("IWEL", &iwel)?;
    if wells.iter().any(|well| well.depth.is_some()) {
        out.real("SWEL", &swel)?;
    }
    if wells.iter().any(|well| well.flow.is_some()) {
        out.doub("XWEL", &xwel)?;
    }
    out.chars("ZWEL", &names)?;
    if most > 0 {
        out.inte("ICON", &icon)?;
    }
    let mut completions = wells.iter().flat_map(|well| &well.completions);
    if completions.any(|c| {
        c.factor
            .or(c.depth)
            .or(c.diameter)
            .or(c.kh)
            .or(c.skin)
            .is_some()
    }) {
        out.real("SCON", &scon)?;
    }
    Ok(())
}

fn write_well(items: &mut [i32], well: &Well) -> io::Result<()> {
    let count = i32::try_from(well.completions.len());
    let layers = well.completions.iter().map(|c| c.cell[2]);
    items[..2].copy_from_slice(&well.head);
    items[2] = layers.clone().min().unwrap_or(0);
    items[3] = layers.max().unwrap_or(0);
    items[4] = count.map_err(|_| refused(format!("{}: too many connections", well.name)))?;
    items[6] = match well.kind {
        Kind::Producer => 1,
        Kind::OilInjector => 2,
        Kind::WaterInjector => 3,
        Kind::GasInjector => 4,
        Kind::Undefined => 0,
    };
    items[10] = match well.status {
        Status::Open => 1,
        Status::Stopped => 0,
        Status::Shut => SHUT,
    };
    items[71] = well.segments;
    Ok(())
}

fn write_integers(items: &mut [i32], completion: &Completion) {
    items[0] = completion.order;
    items[1..4].copy_from_slice(&completion.cell);
    items[5] = if completion.is_open { 1 } else { SHUT };
    items[12] = completion.number;
    items[13] = completion.direction.map_or(0, |direction| match direction {
        Direction::X => 1,
        Direction::Y => 2,
        Direction::Z => 3,
    });
    items[14] = completion.segment;
}

fn write_reals(items: &mut [f32], completion: &Completion) {
    let known = [
        completion.factor,
        completion.depth,
        completion.diameter,
        completion.kh,
        completion.skin,
    ];
    for (item, value) in items.iter_mut().zip(known) {
        *item = value.unwrap_or(0.0);
    }
}

fn write_flow(items: &mut [f64], flow: &Flow) {
    let rates = [flow.oil, flow.water, flow.gas];
    items[..3].copy_from_slice(&rates);
    items[4..9].copy_from_slice(&[
        flow.voidage,
        flow.tubing_head_pressure,
        flow.bottom_hole_pressure,
        flow.water_cut,
        flow.gas_oil_ratio,
    ]);
    items[18..21].copy_from_slice(&flow.produced);
    items[22..25].copy_from_slice(&flow.injected);
}

/// What stands for shut, of wells and connections.
const SHUT: i32 = -1000;

/// The wells of a step, in the order of the file; none where there are none.
///
/// # Errors
/// When an array is damaged, or shorter than INTEHEAD says.
pub fn read(arrays: &CellArrays) -> Result<Vec<Well>, ParseError> {
    let mut wells: Vec<Well> = Section::new(arrays)?.wells()?;
    let names = wells
        .iter()
        .enumerate()
        .map(|(n, well)| (well.name.clone(), n));
    let names: HashMap<String, usize> = names.collect();
    for local in arrays.local_grids()? {
        let section = Section::new(&local.arrays)?;
        // LGWEL: which of the global wells each of the local ones is, from 1.
        let numbers = section.integers("LGWEL")?;
        for (n, found) in section.wells()?.into_iter().enumerate() {
            let number = numbers.get(n).and_then(|n| usize::try_from(*n).ok());
            let by_number = number.and_then(|n| n.checked_sub(1));
            let by_number = by_number.filter(|n| wells.get(*n).is_some_and(|w| is_same(w, &found)));
            let by_name = || names.get(&found.name).copied();
            if let Some(well) = by_number.or_else(by_name) {
                wells[well].local.push(LocalWell {
                    grid: local.name.clone(),
                    head: found.head,
                    completions: found.completions,
                });
            }
        }
    }
    wells.retain(|well| !well.name.is_empty());
    Ok(wells)
}

/// Local sections of some writers leave the name out.
fn is_same(well: &Well, found: &Well) -> bool {
    found.name.is_empty() || well.name == found.name
}

/// The arrays of a grid at a step.
struct Section<'a> {
    arrays: &'a CellArrays,
    head: Vec<i32>,
    /// Layers of the matrix, where there are as many of the fractures behind them.
    matrix_layers: Option<i32>,
}

/// An array of so many items for each of something; empty where it is not written.
struct Items<T> {
    each: usize,
    values: Vec<T>,
}

impl<T: Copy> Items<T> {
    fn of(&self, n: usize) -> &[T] {
        let start = n.saturating_mul(self.each);
        let end = start.saturating_add(self.each);
        self.values.get(start..end).unwrap_or_default()
    }
}

/// The completions' arrays.
struct Connections {
    most: usize,
    integers: Items<i32>,
    reals: Items<f32>,
}

impl<'a> Section<'a> {
    fn new(arrays: &'a CellArrays) -> Result<Self, ParseError> {
        let mut section = Self {
            arrays,
            head: Vec::new(),
            matrix_layers: None,
        };
        section.head = section.integers("INTEHEAD")?;
        let logicals = match arrays.find("LOGIHEAD") {
            Some(entry) => arrays.file().bools(entry)?,
            None => Vec::new(),
        };
        let layers = section.head.get(10).copied().unwrap_or(0);
        let is_dual = logicals.get(14) == Some(&true) && layers % 2 == 0;
        section.matrix_layers = is_dual.then_some(layers / 2);
        Ok(section)
    }

    /// An item of INTEHEAD that counts something.
    fn count(&self, item: usize) -> usize {
        let value = self.head.get(item).copied().unwrap_or(0);
        usize::try_from(value).unwrap_or(0)
    }

    fn integers(&self, name: &str) -> Result<Vec<i32>, ParseError> {
        match self.arrays.find(name) {
            Some(entry) => self.arrays.file().i32s(entry),
            None => Ok(Vec::new()),
        }
    }

    /// An array with `each` items for `count` things.
    fn items<T>(
        &self,
        name: &str,
        count: usize,
        each: usize,
        read: impl Fn(&Entry) -> Result<Vec<T>, ParseError>,
    ) -> Result<Items<T>, ParseError> {
        let Some(entry) = self.arrays.find(name) else {
            let values = Vec::new();
            return Ok(Items { each, values });
        };
        let needed = (count as u64).saturating_mul(each as u64);
        if entry.count < needed {
            let message = format!(
                "has {} values, and INTEHEAD says {count} times {each}; the file is damaged",
                entry.count
            );
            let file = self.arrays.file();
            return Err(file.error(ErrorKind::WrongCount, entry, message));
        }
        let values = read(entry)?;
        Ok(Items { each, values })
    }

    fn wells(&self) -> Result<Vec<Well>, ParseError> {
        let count = self.count(16);
        let file = self.arrays.file();
        if count == 0 || self.arrays.find("IWEL").is_none() {
            return Ok(Vec::new());
        }
        let iwel = self.items("IWEL", count, self.count(24), |e| file.i32s(e))?;
        let swel = self.items("SWEL", count, self.count(25), |e| file.f32s(e))?;
        let xwel = self.items("XWEL", count, self.count(26), |e| file.f64s(e))?;
        let names = self.names("ZWEL", self.count(27))?;
        let groups = self.names("ZGRP", self.count(39))?;
        let most = self.count(17);
        let connections = Connections {
            most,
            integers: self.items("ICON", count.saturating_mul(most), self.count(32), |e| {
                file.i32s(e)
            })?,
            reals: self.items("SCON", count.saturating_mul(most), self.count(33), |e| {
                file.f32s(e)
            })?,
        };
        // No more than IWEL has values for.
        let count = if iwel.each == 0 { 0 } else { count };
        let well = |n: usize| {
            let items = iwel.of(n);
            let item = |n: usize| items.get(n).copied().unwrap_or(0);
            let group = usize::try_from(item(5)).ok().and_then(|g| g.checked_sub(1));
            let group = group.and_then(|g| groups.get(g)).cloned();
            Well {
                name: names.get(n).cloned().unwrap_or_default(),
                group: group.filter(|name| !name.is_empty()),
                head: [item(0), item(1)],
                depth: swel.of(n).get(9).copied(),
                kind: kind(item(6)),
                status: status(item(10)),
                segments: item(71).max(0),
                completions: self.completions(n, item(4), &connections),
                local: Vec::new(),
                flow: flow(xwel.of(n)),
                targets: Vec::new(),
            }
        };
        Ok((0..count).map(well).collect())
    }

    /// The first of every `each` strings.
    fn names(&self, array: &str, each: usize) -> Result<Vec<String>, ParseError> {
        let Some(entry) = self.arrays.find(array) else {
            return Ok(Vec::new());
        };
        let strings = self.arrays.file().strings(entry)?;
        Ok(strings.into_iter().step_by(each.max(1)).collect())
    }

    /// The connections of the well number `well`, of which `count` are in use.
    fn completions(&self, well: usize, count: i32, all: &Connections) -> Vec<Completion> {
        let most = match all.integers.each == 0 || all.integers.values.is_empty() {
            true => 0,
            false => all.most,
        };
        let count = usize::try_from(count).unwrap_or(0).min(most);
        let numbers = (0..count).map(|n| well * all.most + n);
        let completions = numbers.map(|n| self.completion(all.integers.of(n), all.reals.of(n)));
        // Places that are not in use have no cell.
        completions
            .filter(|c| c.cell.iter().all(|n| *n > 0))
            .collect()
    }

    fn completion(&self, integers: &[i32], reals: &[f32]) -> Completion {
        let item = |n: usize| integers.get(n).copied().unwrap_or(0);
        let real = |n: usize| reals.get(n).copied();
        let mut cell = [item(1), item(2), item(3)];
        let beyond = self.matrix_layers.filter(|layers| cell[2] > *layers);
        cell[2] -= beyond.unwrap_or(0);
        Completion {
            cell,
            is_fracture: beyond.is_some(),
            is_open: item(5) > 0,
            direction: match item(13) {
                1 => Some(Direction::X),
                2 => Some(Direction::Y),
                3 => Some(Direction::Z),
                _ => None,
            },
            order: item(0),
            number: item(12),
            segment: item(14),
            factor: real(0),
            depth: real(1),
            diameter: real(2).filter(|d| *d > 0.0),
            kh: real(3),
            skin: real(4),
        }
    }
}

fn kind(code: i32) -> Kind {
    match code {
        1 => Kind::Producer,
        2 => Kind::OilInjector,
        3 => Kind::WaterInjector,
        4 => Kind::GasInjector,
        _ => Kind::Undefined,
    }
}

/// Open is 1, and 3 where the well opens by itself; stopped is 0 and shut is -1000.
fn status(code: i32) -> Status {
    match code {
        1.. => Status::Open,
        0 => Status::Stopped,
        _ => Status::Shut,
    }
}

fn flow(items: &[f64]) -> Option<Flow> {
    let item = |n: usize| items.get(n).copied().unwrap_or(0.0);
    (!items.is_empty()).then(|| Flow {
        oil: item(0),
        water: item(1),
        gas: item(2),
        voidage: item(4),
        tubing_head_pressure: item(5),
        bottom_hole_pressure: item(6),
        water_cut: item(7),
        gas_oil_ratio: item(8),
        produced: [18, 19, 20].map(item),
        injected: [22, 23, 24].map(item),
    })
}
