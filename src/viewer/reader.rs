//! Values are read on a thread of their own: those of the selected cells, curves over time, wells, and the next
//! steps before they are shown.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use super::spread::Spread;
use super::vectors::{VectorCurves, VectorRequest};
use crate::case::{Case, Property, Well};
use crate::model::CellIndex;
use crate::view::look::{Look, look_of};

/// Cells of a case, by I, J, K from 1.
#[derive(Clone)]
pub struct Cells {
    /// The case.
    pub case: Arc<Case>,
    /// The cells.
    pub cells: Vec<[usize; 3]>,
}

impl PartialEq for Cells {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.case, &other.case) && self.cells == other.cells
    }
}

/// All properties of some cells at a step.
#[derive(Clone, PartialEq)]
pub struct Table {
    /// Of which cells.
    pub of: Cells,
    /// At which step.
    pub step: usize,
    /// Name, unit and a value for each cell, where it has one.
    pub rows: Vec<(String, String, Vec<Option<f32>>)>,
}

/// Properties of some cells over time.
#[derive(Clone, PartialEq)]
pub struct Curves {
    /// Of which cells.
    pub of: Cells,
    /// In the order in which they were asked for.
    pub curves: Vec<TimeCurve>,
}

/// A property of some cells over time.
#[derive(Clone, PartialEq)]
pub struct TimeCurve {
    /// Which property.
    pub property: String,
    /// By cell: number and value of the steps that have one; none of a property that does not change.
    pub points: Vec<Vec<(usize, f32)>>,
}

/// The wells of a case at a step.
pub struct WellList {
    /// The case.
    pub case: Arc<Case>,
    /// The step.
    pub step: usize,
    /// The wells, in the order of the file.
    pub wells: Arc<Vec<Well>>,
}

/// What the thread says.
pub enum Read {
    /// All properties of some cells.
    Table(Table),
    /// Curves over time.
    Curves(Curves),
    /// Summary vectors.
    Vectors(VectorCurves),
    /// The wells of a step.
    Wells(WellList),
    /// How a property of a case looks at first.
    Look(Arc<Case>, String, Look),
    /// How the values of a property are spread.
    Spread(Arc<Spread>),
}

/// Properties at steps that are read ahead.
type Ahead = (Arc<Case>, Vec<(String, usize)>);

/// What is asked for; a newer wish of a kind replaces the one before.
#[derive(Default)]
struct Wishes {
    look: Option<(Arc<Case>, String)>,
    table: Option<(Cells, usize)>,
    curves: Option<(Cells, Vec<String>)>,
    vectors: Option<(Arc<Case>, VectorRequest)>,
    wells: Option<(Arc<Case>, usize)>,
    ahead: Option<Ahead>,
    spreads: Vec<(Arc<Case>, String, usize)>,
    ends: bool,
}

/// The thread that reads values.
pub struct Reader {
    wishes: Arc<(Mutex<Wishes>, Condvar)>,
    answers: Receiver<Read>,
}

impl Reader {
    /// Starts it; `wake` is called with each answer.
    pub fn start(wake: impl Fn() + Send + 'static) -> Self {
        let (outbox, answers) = channel();
        let wishes = Arc::new((Mutex::default(), Condvar::new()));
        let thread = Thread {
            wishes: wishes.clone(),
            outbox,
            wake: Box::new(wake),
        };
        std::thread::spawn(move || thread.run());
        Self { wishes, answers }
    }

    /// Asks for all properties of some cells at a step.
    pub fn table(&self, of: Cells, step: usize) {
        self.wish(|w| w.table = Some((of, step)));
    }

    /// Asks how a property looks at first; that may need its values at all steps.
    pub fn look(&self, case: Arc<Case>, property: String) {
        self.wish(|w| w.look = Some((case, property)));
    }

    /// Asks for properties of some cells over time.
    pub fn curves(&self, of: Cells, properties: Vec<String>) {
        self.wish(|w| w.curves = Some((of, properties)));
    }

    /// Asks for summary vectors over time.
    pub fn vectors(&self, case: Arc<Case>, asked: VectorRequest) {
        self.wish(|w| w.vectors = Some((case, asked)));
    }

    /// Asks for the wells of a step.
    pub fn wells(&self, case: Arc<Case>, step: usize) {
        self.wish(|w| w.wells = Some((case, step)));
    }

    /// Reads properties at steps, so that they are at hand when they are shown.
    pub fn ahead(&self, case: Arc<Case>, fields: Vec<(String, usize)>) {
        self.wish(|w| w.ahead = Some((case, fields)));
    }

    /// Asks how the values of some properties of a case are spread at steps.
    pub fn spreads(&self, case: &Arc<Case>, wanted: &[(String, usize)]) {
        let all = wanted
            .iter()
            .map(|(name, step)| (case.clone(), name.clone(), *step));
        self.wish(|w| w.spreads = all.collect());
    }

    /// Leaves what was asked for of a case that was closed.
    pub fn forget(&self, case: &Arc<Case>) {
        let is_of = |known: &Arc<Case>| Arc::ptr_eq(known, case);
        self.wish(|w| {
            w.look.take_if(|(c, _)| is_of(c));
            w.table.take_if(|(of, _)| is_of(&of.case));
            w.curves.take_if(|(of, _)| is_of(&of.case));
            w.vectors.take_if(|(c, _)| is_of(c));
            w.wells.take_if(|(c, _)| is_of(c));
            w.ahead.take_if(|(c, _)| is_of(c));
            w.spreads.retain(|(c, ..)| !is_of(c));
        });
    }

    fn wish(&self, change: impl FnOnce(&mut Wishes)) {
        change(&mut lock(&self.wishes.0));
        self.wishes.1.notify_one();
    }

    /// What has been said since the last call.
    pub fn poll(&self) -> Vec<Read> {
        self.answers.try_iter().collect()
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        self.wish(|w| w.ends = true);
    }
}

fn lock(wishes: &Mutex<Wishes>) -> MutexGuard<'_, Wishes> {
    wishes.lock().unwrap_or_else(PoisonError::into_inner)
}

enum Wish {
    Look(Arc<Case>, String),
    Table(Cells, usize),
    Curves(Cells, Vec<String>),
    Vectors(Arc<Case>, VectorRequest),
    Wells(Arc<Case>, usize),
    Ahead(Ahead),
    Spread(Arc<Case>, String, usize),
}

struct Thread {
    wishes: Arc<(Mutex<Wishes>, Condvar)>,
    outbox: Sender<Read>,
    wake: Box<dyn Fn() + Send>,
}

impl Thread {
    fn run(self) {
        while let Some(wish) = self.next() {
            match wish {
                Wish::Look(case, property) => {
                    let look = look_of(&case, &property);
                    self.say(Read::Look(case, property, look));
                }
                Wish::Table(of, step) => {
                    let rows = rows(&of, step);
                    self.say(Read::Table(Table { of, step, rows }));
                }
                Wish::Curves(of, properties) => self.follow(of, properties),
                Wish::Vectors(case, asked) => {
                    self.say(Read::Vectors(VectorCurves::read(case, asked)));
                }
                Wish::Wells(case, step) => {
                    // Where they are damaged, a note of the case says so.
                    let wells = case.wells(step).unwrap_or_default();
                    self.say(Read::Wells(WellList { case, step, wells }));
                }
                Wish::Spread(case, property, step) => {
                    let spread = Spread::of(&case, &property, step);
                    self.say(Read::Spread(Arc::new(spread)));
                }
                Wish::Ahead((case, fields)) => {
                    for (property, step) in fields {
                        // Reading ahead is a favor: where it fails, showing the step will say why.
                        let _ = case.field(&property, step);
                        if self.has_wishes() {
                            break;
                        }
                    }
                }
            }
        }
    }

    /// Waits for the next wish, the quickest kind first; `None` when the window is gone.
    fn next(&self) -> Option<Wish> {
        let mut wishes = lock(&self.wishes.0);
        loop {
            if wishes.ends {
                return None;
            }
            if let Some((case, property)) = wishes.look.take() {
                return Some(Wish::Look(case, property));
            }
            if let Some((of, step)) = wishes.table.take() {
                return Some(Wish::Table(of, step));
            }
            if let Some((case, step)) = wishes.wells.take() {
                return Some(Wish::Wells(case, step));
            }
            if let Some((case, property, step)) = wishes.spreads.pop() {
                return Some(Wish::Spread(case, property, step));
            }
            if let Some((case, asked)) = wishes.vectors.take() {
                return Some(Wish::Vectors(case, asked));
            }
            if let Some(ahead) = wishes.ahead.take() {
                return Some(Wish::Ahead(ahead));
            }
            if let Some((of, properties)) = wishes.curves.take() {
                return Some(Wish::Curves(of, properties));
            }
            wishes = self
                .wishes
                .1
                .wait(wishes)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn has_wishes(&self) -> bool {
        let w = lock(&self.wishes.0);
        let is_asked = w.look.is_some() || w.table.is_some() || w.curves.is_some();
        let is_asked = is_asked || w.vectors.is_some() || w.wells.is_some();
        w.ends || is_asked || w.ahead.is_some() || !w.spreads.is_empty()
    }

    /// Reads properties step by step. Another wish comes first; the curves then begin again.
    fn follow(&self, of: Cells, properties: Vec<String>) {
        let case = of.case.clone();
        let cells: Vec<_> = of.cells.iter().map(|cell| index(&case, *cell)).collect();
        let empty = |property: &String| TimeCurve {
            property: property.clone(),
            points: vec![Vec::new(); cells.len()],
        };
        let mut curves: Vec<TimeCurve> = properties.iter().map(empty).collect();
        for step in 0..case.steps.len() {
            if self.has_wishes() {
                let mut wishes = lock(&self.wishes.0);
                wishes.curves.get_or_insert((of, properties));
                return;
            }
            for curve in curves.iter_mut().filter(|c| case.is_dynamic(&c.property)) {
                // A step that lacks the property, or cannot be read, is a gap in the curve.
                let Ok(field) = case.field(&curve.property, step) else {
                    continue;
                };
                for (points, cell) in curve.points.iter_mut().zip(&cells) {
                    let value = cell.and_then(|c| field.value(&case.grid, c));
                    points.extend(value.map(|v| (step, v)));
                }
            }
        }
        self.say(Read::Curves(Curves { of, curves }));
    }

    fn say(&self, read: Read) {
        // The window may be gone.
        let _ = self.outbox.send(read);
        (self.wake)();
    }
}

fn index(case: &Case, cell: [usize; 3]) -> Option<CellIndex> {
    let dims = case.grid.dims();
    Some(dims.cell(dims.one_based(cell)?))
}

fn rows(of: &Cells, step: usize) -> Vec<(String, String, Vec<Option<f32>>)> {
    let case = &of.case;
    let row = |p: &Property| {
        let field = case.field(&p.name, step).ok()?;
        let value = |cell: &[usize; 3]| field.value(&case.grid, index(case, *cell)?);
        let values: Vec<_> = of.cells.iter().map(value).collect();
        let any = values.iter().any(Option::is_some);
        any.then(|| (p.name.clone(), p.unit.clone(), values))
    };
    case.properties.iter().filter_map(row).collect()
}
