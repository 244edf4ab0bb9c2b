//! Summary vectors: curves over time of the field, groups, wells, regions and cells, as simulators write them.

use strataray_parsers::calendar;

use super::CaseError;

/// What a vector is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum VectorKind {
    /// The field.
    Field,
    /// A group.
    Group,
    /// A well.
    Well,
    /// A connection of a well.
    Connection,
    /// A segment of a well.
    Segment,
    /// A region, or what goes from one to another.
    Region,
    /// A cell.
    Block,
    /// An aquifer.
    Aquifer,
    /// Anything else: times, the work of the simulator.
    Other,
}

impl VectorKind {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Field,
        Self::Group,
        Self::Well,
        Self::Connection,
        Self::Segment,
        Self::Region,
        Self::Block,
        Self::Aquifer,
        Self::Other,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Field => "field",
            Self::Group => "group",
            Self::Well => "well",
            Self::Connection => "connection",
            Self::Segment => "segment",
            Self::Region => "region",
            Self::Block => "block",
            Self::Aquifer => "aquifer",
            Self::Other => "other",
        }
    }
}

/// A summary vector.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Vector {
    /// Its name: a keyword, and behind colons what it is of, such as `FOPR`, `WOPR:P1`, `BPR:3,4,5`.
    pub name: String,
    /// The keyword, such as `WOPR`.
    pub keyword: String,
    /// What it is of.
    pub kind: VectorKind,
    /// The well that it, its connection or segment is of.
    pub well: Option<String>,
    /// Unit as written; empty where there is none.
    pub unit: String,
    /// It was measured, not computed.
    pub is_history: bool,
}

/// Gives the values of vectors; implemented by [`crate::case::load`].
pub trait VectorSource: Send + Sync {
    /// Values of the vector at a place in the list, one for each time; not a number where a run before did not have it.
    ///
    /// # Errors
    /// When the file is damaged.
    fn values(&self, place: usize) -> Result<Vec<f32>, CaseError>;
}

/// The vectors of a case and their times, which are other ones than the steps of restart files.
pub struct Vectors {
    /// The vectors, in the order of the file.
    pub list: Vec<Vector>,
    /// Times in days since the start of the simulation, rising.
    pub days: Vec<f64>,
    /// Start of the simulation, in days since 1970, where it is known.
    pub start: Option<f64>,
    /// What was odd about the files, one sentence each.
    pub notes: Vec<String>,
    /// Gives the values.
    pub source: Box<dyn VectorSource>,
}

impl Vectors {
    /// Place in the list of the vector of a name, whatever its letter case.
    pub fn find(&self, name: &str) -> Option<usize> {
        let is_it = |v: &Vector| v.name.eq_ignore_ascii_case(name);
        let exact = self.list.iter().position(|v| v.name == name);
        exact.or_else(|| self.list.iter().position(is_it))
    }

    /// Date of a time, with the time of day where it is not midnight; empty where the start is not known.
    pub fn date(&self, time: usize) -> String {
        let moment = self.start.zip(self.days.get(time)).map(|(a, b)| a + b);
        moment.map_or_else(String::new, calendar::text)
    }

    /// Values of the vector at a place in the list, one for each of [`Self::days`]; not a number where a run before did not
    /// have it.
    ///
    /// # Errors
    /// When the file is damaged.
    pub fn values(&self, place: usize) -> Result<Vec<f32>, CaseError> {
        self.source.values(place)
    }
}
