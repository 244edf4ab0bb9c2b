//! The wells of a deck: what its SCHEDULE section says of them, in time.
//!
//! Read are WELSPECS, WELSPECL, COMPDAT, COMPDATL, WCONPROD, WCONHIST, WCONINJE, WCONINJH, WCONINJ, WELTARG, WELOPEN and
//! WLIST, with names that end in `*`, and the time by START, DATES and TSTEP. What a run decides by itself, as by economic
//! limits, is not in a deck.
//!
//! ```
//! use std::path::Path;
//! use strataray_parsers::{Warnings, deck::{MemoryFiles, Schedule}, wells::{Kind, Status}};
//!
//! # fn main() -> Result<(), strataray_parsers::ParseError> {
//! let deck = "SCHEDULE
//! WELSPECS
//!  'P1' 'G' 3 4 1* OIL /
//! /
//! COMPDAT
//!  'P1' 2* 1 2 OPEN /
//! /
//! WCONPROD
//!  'P*' OPEN ORAT 100 /
//! /";
//! let files = MemoryFiles::from_iter([("CASE.DATA", deck)]);
//! let paths = [Path::new("CASE.DATA")];
//! let schedule = Schedule::read_from(&files, &paths, None, &mut Warnings::default())?;
//! let wells = schedule.wells(None, [10, 10, 5]);
//! assert_eq!((wells[0].kind, wells[0].status), (Kind::Producer, Status::Open));
//! assert_eq!(wells[0].completions[1].cell, [3, 4, 2]);
//! # Ok(())
//! # }
//! ```

mod records;
mod scan;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::files::{DeckFiles, Folders};
use crate::error::{ParseError, Warnings};
use crate::wells::{Completion, Direction, Kind, LocalWell, Status, Target, Well};

/// What decks say of wells, in time.
#[derive(Debug, Clone, Default)]
pub struct Schedule {
    /// Names of all wells, in the order in which they come.
    pub names: Vec<String>,
    /// The last date, in days since 1970.
    pub end: f64,
    /// Keywords about wells that are not evaluated, in alphabetical order.
    pub not_evaluated: Vec<String>,
    /// Files that say something of wells.
    pub files: Vec<PathBuf>,
    changes: Vec<(f64, Change)>,
}

/// Something that happens to a well, known by its number.
#[derive(Debug, Clone)]
struct Change {
    well: usize,
    what: What,
}

#[derive(Debug, Clone)]
enum What {
    /// WELSPECS and WELSPECL: group, head and reference depth.
    Head {
        grid: Option<String>,
        group: Option<String>,
        head: [i32; 2],
        depth: Option<f32>,
    },
    /// WCONPROD and others like it.
    Control {
        kind: Kind,
        status: Status,
        targets: Vec<Target>,
    },
    /// WELTARG.
    Target(Target),
    /// WELOPEN of the well itself.
    Status(Status),
    /// COMPDAT and COMPDATL. I and J of 0 are those of the head.
    Connect {
        grid: Option<String>,
        column: [i32; 2],
        layers: [i32; 2],
        is_open: bool,
        direction: Direction,
    },
    /// WELOPEN of connections; 0 stands for any.
    Connections { cell: [i32; 3], is_open: bool },
}

impl Schedule {
    /// Reads the SCHEDULE sections of the decks at `paths`, one after the other; a file without sections is one.
    ///
    /// `start`, in days since 1970, is when time begins where no deck says START; 1983 begins it by default.
    ///
    /// # Errors
    /// When a file is missing, but for one that SCHEDULE includes, or a record that is read is damaged.
    pub fn read(
        paths: &[&Path],
        start: Option<f64>,
        warnings: &mut Warnings,
    ) -> Result<Self, ParseError> {
        Self::read_from(&Folders, paths, start, warnings)
    }

    /// As [`Self::read`], for `files` that need not be on disk.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_from(
        files: &dyn DeckFiles,
        paths: &[&Path],
        start: Option<f64>,
        warnings: &mut Warnings,
    ) -> Result<Self, ParseError> {
        scan::read(files, paths, start, warnings)
    }

    /// True where a text begins with a keyword that only SCHEDULE has; `start` may end anywhere in the file.
    pub fn begins(start: &[u8]) -> bool {
        scan::begins(start)
    }

    /// The wells when a report of some date is written, in days since 1970; at the end where there is none. What a deck
    /// says at that date holds from there on, and is not in the report.
    ///
    /// Cells outside of `dims` are left out; K of fractures is folded to their layer where they have as many layers
    /// again.
    pub fn wells(&self, date: Option<f64>, dims: [usize; 3]) -> Vec<Well> {
        let mut state = State {
            wells: vec![None; self.names.len()],
            dims: dims.map(|n| i32::try_from(n).unwrap_or(i32::MAX)),
        };
        for (time, change) in &self.changes {
            if date.is_some_and(|date| *time >= date - HALF_A_SECOND) {
                break;
            }
            state.apply(&self.names, change);
        }
        let wells = state.wells.into_iter().flatten();
        wells.map(|made| made.well).collect()
    }

    /// Cells of connections that are outside of a grid of main cells, over all time.
    pub fn outside(&self, dims: [usize; 3]) -> usize {
        let dims = dims.map(|n| i32::try_from(n).unwrap_or(i32::MAX));
        let outside = |what: &What| match what {
            What::Connect {
                grid: None,
                column,
                layers,
                ..
            } => {
                let beyond = column[0] > dims[0] || column[1] > dims[1];
                beyond || layers[1] > dims[2].saturating_mul(2)
            }
            _ => false,
        };
        let changes = self.changes.iter();
        changes.filter(|(_, change)| outside(&change.what)).count()
    }
}

const HALF_A_SECOND: f64 = 0.5 / 86_400.0;

/// A well, and where its connections are by their cells.
#[derive(Clone)]
struct Made {
    well: Well,
    known: HashMap<(Option<String>, [i32; 3]), usize>,
}

struct State {
    wells: Vec<Option<Made>>,
    dims: [i32; 3],
}

impl State {
    fn apply(&mut self, names: &[String], change: &Change) {
        let (Some(place), Some(name)) = (self.wells.get_mut(change.well), names.get(change.well))
        else {
            return;
        };
        let made = place.get_or_insert_with(|| Made {
            well: Well::named(name.as_str()),
            known: HashMap::new(),
        });
        match &change.what {
            What::Head {
                grid,
                group,
                head,
                depth,
            } => {
                made.well.group = group.clone().or_else(|| made.well.group.take());
                made.well.depth = depth.or(made.well.depth);
                match grid {
                    None => made.well.head = *head,
                    Some(grid) => made.local(grid).head = *head,
                }
            }
            What::Control {
                kind,
                status,
                targets,
            } => {
                (made.well.kind, made.well.status) = (*kind, *status);
                made.well.targets.clone_from(targets);
            }
            What::Target(target) => {
                let targets = &mut made.well.targets;
                match targets.iter_mut().find(|known| known.name == target.name) {
                    Some(known) => *known = *target,
                    None => targets.push(*target),
                }
            }
            What::Status(status) => made.well.status = *status,
            What::Connect { .. } => made.connect(&change.what, self.dims),
            What::Connections { cell, is_open } => made.open(*cell, *is_open),
        }
    }
}

impl Made {
    fn local(&mut self, grid: &str) -> &mut LocalWell {
        let local = &mut self.well.local;
        let known = local.iter().position(|l| l.grid.eq_ignore_ascii_case(grid));
        let at = known.unwrap_or_else(|| {
            local.push(LocalWell {
                grid: grid.to_owned(),
                head: [0; 2],
                completions: Vec::new(),
            });
            local.len() - 1
        });
        &mut local[at]
    }

    fn connect(&mut self, what: &What, dims: [i32; 3]) {
        let What::Connect {
            grid,
            column,
            layers,
            is_open,
            direction,
        } = what
        else {
            return;
        };
        let head = match grid {
            None => self.well.head,
            Some(grid) => self.local(grid).head,
        };
        let [i, j] = [0, 1].map(|n| if column[n] > 0 { column[n] } else { head[n] });
        // The layers of local grids are not known here, and are few.
        let is_outside = grid.is_none() && (i > dims[0] || j > dims[1]);
        if i < 1 || j < 1 || is_outside {
            return;
        }
        let last = match grid {
            None => layers[1].min(dims[2].saturating_mul(2)),
            Some(_) => layers[1].min(layers[0].saturating_add(MOST_LOCAL_LAYERS)),
        };
        for layer in layers[0]..=last {
            let is_fracture = grid.is_none() && layer > dims[2];
            let k = if is_fracture { layer - dims[2] } else { layer };
            let key = (grid.clone(), [i, j, layer]);
            let known = self.known.get(&key).copied();
            let list = match grid {
                None => &mut self.well.completions,
                Some(grid) => &mut self.local(grid).completions,
            };
            match known.and_then(|at| list.get_mut(at)) {
                Some(known) => {
                    known.is_open = *is_open;
                    known.direction = Some(*direction);
                }
                None => {
                    let order = i32::try_from(list.len() + 1).unwrap_or(i32::MAX);
                    list.push(Completion {
                        is_fracture,
                        is_open: *is_open,
                        ..Completion::open([i, j, k], *direction, order)
                    });
                    let at = list.len() - 1;
                    self.known.insert(key, at);
                }
            }
        }
    }

    fn open(&mut self, cell: [i32; 3], is_open: bool) {
        let local = self.well.local.iter_mut().flat_map(|l| &mut l.completions);
        for completion in self.well.completions.iter_mut().chain(local) {
            let mut axes = cell.iter().zip(completion.cell);
            if axes.all(|(asked, is)| *asked <= 0 || *asked == is) {
                completion.is_open = is_open;
            }
        }
    }
}

/// Layers of a local grid that one record connects, at most.
const MOST_LOCAL_LAYERS: i32 = 10_000;
