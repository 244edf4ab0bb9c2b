//! From summary files to the vectors of a case, once they are asked for.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use strataray_parsers::case::SummarySource;
use strataray_parsers::summary::{self, Subject, Summary};
use strataray_parsers::{ParseError, Warnings};

use crate::case::{CaseError, Vector, VectorKind, VectorSource, Vectors};

/// Files with vectors, and what was read of them.
#[derive(Default)]
pub struct SummaryFiles {
    files: Option<SummarySource>,
    read: Mutex<Option<Arc<Vectors>>>,
}

impl SummaryFiles {
    /// Those that were found beside a case, if any.
    pub fn new(files: Option<SummarySource>) -> Self {
        Self {
            files,
            read: Mutex::default(),
        }
    }

    /// The vectors, read when they are first asked for; `None` where there are no files.
    ///
    /// # Errors
    /// When the files are damaged.
    pub fn vectors(&self) -> Result<Option<Arc<Vectors>>, ParseError> {
        let Some(files) = &self.files else {
            return Ok(None);
        };
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        let vectors = match read.take() {
            Some(known) => known,
            None => Arc::new(open(files)?),
        };
        Ok(Some(read.insert(vectors).clone()))
    }
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

fn open(files: &SummarySource) -> Result<Vectors, ParseError> {
    let mut warnings = Warnings::default();
    let summary = Summary::open(files, &mut warnings)?;
    let named = summary.vectors.iter().filter(|v| is_named(v));
    let named: Vec<_> = named.cloned().collect();
    Ok(Vectors {
        list: named.iter().map(vector).collect(),
        days: summary.steps.iter().map(|step| step.days).collect(),
        start: summary.start,
        notes: warnings.iter().map(ToString::to_string).collect(),
        source: Box::new(OfSummary { summary, named }),
    })
}

/// False for the places that a run has kept free for wells and groups to come.
fn is_named(vector: &summary::Vector) -> bool {
    vector.subject != Subject::Other(None) || !vector.keyword.starts_with(['W', 'G'])
}

struct OfSummary {
    summary: Summary,
    named: Vec<summary::Vector>,
}

impl VectorSource for OfSummary {
    fn values(&self, place: usize) -> Result<Vec<f32>, CaseError> {
        let vector = self.named.get(place);
        let values = vector.map(|vector| self.summary.values(vector));
        Ok(values.transpose()?.unwrap_or_default())
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
