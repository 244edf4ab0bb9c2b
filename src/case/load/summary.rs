//! From summary files to the vectors of a case, once they are asked for.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use strataray_parsers::case::{SummarySource, find_summary};
use strataray_parsers::summary::{self, Subject, Summary};
use strataray_parsers::{ParseError, Warnings, calendar};

use crate::case::{CaseError, Vector, VectorKind, VectorSource, Vectors};
use crate::model::Dims;

/// Days before the start of a run that its vectors may begin and count as its own.
const ONE_MOMENT: f64 = 1e-3;

/// Files with vectors, and what was read of them.
#[derive(Default)]
pub struct SummaryFiles {
    files: Option<SummarySource>,
    dims: Option<Dims>,
    read: Mutex<Option<(Stamp, Arc<Vectors>)>>,
}

/// Sizes and times of the files, by which it is known whether a run has written more.
type Stamp = Vec<Option<(u64, Option<SystemTime>)>>;

impl SummaryFiles {
    /// Those that were found beside a case, if any.
    pub fn new(files: Option<SummarySource>) -> Self {
        Self {
            files,
            ..Self::default()
        }
    }

    /// Those of a case whose grid has these dimensions.
    pub fn of_grid(self, dims: Dims) -> Self {
        Self {
            dims: Some(dims),
            ..self
        }
    }

    /// The vectors, read when they are first asked for, and again where the files have changed since; `None` where there are
    /// no files.
    ///
    /// # Errors
    /// When the files are damaged.
    pub fn vectors(&self) -> Result<Option<Arc<Vectors>>, ParseError> {
        let Some(files) = &self.files else {
            return Ok(None);
        };
        let stamp = stamp(files);
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        let vectors = match read.take() {
            Some((known, vectors)) if known == stamp => vectors,
            _ => Arc::new(open(files, self.dims)?),
        };
        *read = Some((stamp, vectors.clone()));
        Ok(Some(vectors))
    }
}

fn stamp(files: &SummarySource) -> Stamp {
    let stamp = |path: &PathBuf| {
        let data = std::fs::metadata(path).ok()?;
        Some((data.len(), data.modified().ok()))
    };
    paths(files).iter().map(stamp).collect()
}

/// The paths of summary files.
pub fn paths(files: &SummarySource) -> Vec<PathBuf> {
    match files {
        SummarySource::Unified { spec, data } => vec![spec.clone(), data.clone()],
        SummarySource::Separate { spec, data } => {
            let data = data.iter().map(|(_, path)| path);
            [spec].into_iter().chain(data).cloned().collect()
        }
        SummarySource::Extended(path) => vec![path.clone()],
    }
}

/// The file that says what the vectors are.
fn spec(files: &SummarySource) -> &Path {
    match files {
        SummarySource::Unified { spec, .. } | SummarySource::Separate { spec, .. } => spec,
        SummarySource::Extended(path) => path,
    }
}

fn open(files: &SummarySource, dims: Option<Dims>) -> Result<Vectors, ParseError> {
    let mut warnings = Warnings::default();
    let summary = Summary::open(files, &mut warnings)?;
    let mut notes = Vec::new();
    notes.extend(dims.and_then(|dims| other_grid(spec(files), &summary, dims)));
    let before = runs_before(&summary, files, &mut warnings, &mut notes);
    let named = summary.vectors.iter().filter(|v| is_named(v));
    let named: Vec<_> = named.cloned().collect();
    let own = summary.steps.iter().map(|step| step.days);
    let days = before.iter().flat_map(|run| run.days.iter().copied());
    notes.extend(warnings.iter().map(ToString::to_string));
    Ok(Vectors {
        list: named.iter().map(vector).collect(),
        days: days.chain(own).collect(),
        start: summary.start,
        notes,
        source: Box::new(OfSummary {
            summary,
            named,
            before,
        }),
    })
}

/// What is said of a summary whose run had a grid of other dimensions; with two porosities it has twice the layers.
fn other_grid(path: &Path, summary: &Summary, own: Dims) -> Option<String> {
    let [ni, nj, nk] = summary.dims.map(|n| usize::try_from(n).unwrap_or(0));
    let fits = ni == own.ni && nj == own.nj && (nk == own.nk || nk == 2 * own.nk);
    (ni > 0 && nj > 0 && nk > 0 && !fits).then(|| {
        format!(
            "{}: DIMENS is {ni} x {nj} x {nk} and the grid {} x {} x {}: the summary belongs to another grid, and cells in names of vectors are cells of that",
            path.display(),
            own.ni,
            own.nj,
            own.nk
        )
    })
}

/// A run that another one goes on from.
struct RunBefore {
    summary: Summary,
    /// Its times up to where the next one begins, in days since the start of the last run.
    days: Vec<f64>,
}

/// The runs that a summary goes on from (RESTART), the first of them in front; which ones count, and why one does not, goes
/// into the notes.
fn runs_before(
    last: &Summary,
    files: &SummarySource,
    warnings: &mut Warnings,
    notes: &mut Vec<String>,
) -> Vec<RunBefore> {
    let same = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let mut known = vec![same(spec(files))];
    let mut runs: Vec<RunBefore> = Vec::new();
    let mut begin = last.steps.first().map_or(0.0, |step| step.days);
    let mut next = last.restart.clone();
    let mut child = spec(files).to_owned();
    while let Some(name) = next.take() {
        let told = |why: &str| {
            let child = child.display();
            format!("{child}: RESTART names {name}, {why}: curves begin where the run went on")
        };
        let Some(source) = parent(&child, &name) else {
            notes.push(told("which has no summary there nor beside this file"));
            break;
        };
        let path = same(spec(&source));
        if known.contains(&path) {
            notes.push(told("which goes on from this run itself"));
            break;
        }
        let summary = match Summary::open(&source, warnings) {
            Ok(summary) => summary,
            Err(error) => {
                notes.push(told(&format!("which cannot be read ({error})")));
                break;
            }
        };
        let shift = summary.start.zip(last.start).map_or(0.0, |(a, b)| a - b);
        let days = summary.steps.iter().map(|step| step.days + shift);
        let days: Vec<f64> = days.take_while(|d| *d < begin - ONE_MOMENT).collect();
        let until = last.start.map(|start| calendar::text(start + begin));
        notes.push(format!(
            "curves until {} are of {}, which this run goes on from",
            until.unwrap_or_else(|| format!("day {begin}")),
            spec(&source).display()
        ));
        begin = days.first().copied().unwrap_or(begin);
        next.clone_from(&summary.restart);
        spec(&source).clone_into(&mut child);
        known.push(path);
        runs.push(RunBefore { summary, days });
    }
    runs.reverse();
    runs
}

/// The summary of the run that another one names: where its path says, from the folder of the other, or else beside it.
fn parent(child: &Path, name: &str) -> Option<SummarySource> {
    let folder = child.parent().unwrap_or(Path::new(""));
    let named = folder.join(name);
    let beside = named.file_name().map(|name| folder.join(name));
    let places = [Some(named), beside].into_iter().flatten();
    places.filter_map(|path| find_summary(&path).ok()).next()
}

/// False for the places that a run has kept free for wells and groups to come.
fn is_named(vector: &summary::Vector) -> bool {
    vector.subject != Subject::Other(None) || !vector.keyword.starts_with(['W', 'G'])
}

struct OfSummary {
    summary: Summary,
    named: Vec<summary::Vector>,
    before: Vec<RunBefore>,
}

impl VectorSource for OfSummary {
    fn values(&self, place: usize) -> Result<Vec<f32>, CaseError> {
        let Some(vector) = self.named.get(place) else {
            return Ok(Vec::new());
        };
        let name = vector.to_string();
        let mut all = Vec::new();
        for RunBefore { summary, days } in &self.before {
            let twin = summary.find(&name).filter(|v| v.unit == vector.unit);
            let mut values = twin.map(|twin| summary.values(twin)).transpose()?;
            let values = values.get_or_insert_default();
            // A vector that the run before does not have begins later.
            values.resize(days.len(), f32::NAN);
            all.append(values);
        }
        all.extend(self.summary.values(vector)?);
        Ok(all)
    }
}

fn vector(vector: &summary::Vector) -> Vector {
    let (kind, well) = match &vector.subject {
        Subject::Field => (VectorKind::Field, None),
        Subject::Group(_) => (VectorKind::Group, None),
        Subject::Well(well) | Subject::LocalWell(_, well) => (VectorKind::Well, Some(well)),
        Subject::Connection(well, _) | Subject::LocalConnection(_, well, _) => {
            (VectorKind::Connection, Some(well))
        }
        Subject::Segment(well, _) => (VectorKind::Segment, Some(well)),
        Subject::Region(_) | Subject::Regions(_) => (VectorKind::Region, None),
        Subject::Block(_) | Subject::LocalBlock(..) => (VectorKind::Block, None),
        Subject::Aquifer(_) => (VectorKind::Aquifer, None),
        Subject::Other(_) => (VectorKind::Other, None),
    };
    Vector {
        name: vector.to_string(),
        keyword: vector.keyword.clone(),
        kind,
        well: well.cloned(),
        unit: vector.unit.clone(),
        is_history: vector.is_history(),
    }
}
