//! `IjkGridRepresentation`: what its object says, and its geometry once the arrays are read.

use roxmltree::Node;

use super::arrays::{Dataset, Values, index};
use super::hdf5::Files;
use super::xml::{self, Part};
use crate::error::{ErrorKind, ParseError};
use crate::geometry::{Lengths, first_not, unaddressable};

/// A grid with its geometry.
#[derive(Debug, Clone, PartialEq)]
pub struct IjkGrid {
    /// Cells along i, j and k.
    pub dims: [usize; 3],
    /// Whether k grows upward.
    pub is_upward: bool,
    /// Where the coordinate lines are: first one for each pillar, i fastest, then those of [`Self::splits`].
    pub points: Points,
    /// Which of the layers have a gap to the next one, and so nodes of their own; empty where there is none.
    pub gaps: Vec<bool>,
    /// The lines beyond those of pillars, in their order.
    pub splits: Vec<Split>,
    /// Which pillars have a geometry; absent = all.
    pub has_pillars: Option<Vec<bool>>,
    /// Which cells have a geometry; absent = all.
    pub has_cells: Option<Vec<bool>>,
}

/// A further line of a pillar, which some of the columns around it have instead of the first one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Split {
    /// Number of the pillar, i fastest.
    pub pillar: usize,
    /// Numbers of the columns, i fastest.
    pub columns: Vec<usize>,
}

/// Nodes along coordinate lines, of which there are one more than layers, and one more for each gap.
#[derive(Debug, Clone, PartialEq)]
pub enum Points {
    /// **Shape**: nodes, lines, then x, y, z.
    Nodes(Vec<f64>),
    /// Nodes are given by a parameter each along lines of pillars.
    Lines {
        /// **Shape**: nodes, lines.
        parameters: Vec<f64>,
        /// The lines of the pillars.
        lines: Lines,
    },
}

/// Lines by points that they pass.
#[derive(Debug, Clone, PartialEq)]
pub struct Lines {
    /// Points of each.
    pub knots: usize,
    /// What each is; `None` where a pillar has no line.
    pub kinds: Vec<Option<LineKind>>,
    /// **Shape**: knots, pillars, then x, y, z.
    pub points: Vec<f64>,
    /// **Shape**: knots, pillars: the parameter at each point; absent where all lines are vertical.
    pub parameters: Option<Vec<f64>>,
}

/// What a line is between its points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineKind {
    /// Through the first point; its parameter is z.
    Vertical,
    /// Straight from point to point.
    Linear,
}

/// What the object of a grid says, with its arrays by name.
#[derive(Debug)]
pub(super) struct GridObject {
    dims: [usize; 3],
    gaps: Option<(usize, Dataset)>,
    geometry: Option<Geometry>,
    /// The geometry's reference system.
    pub(super) crs: String,
    /// The grid that this one refines or coarsens.
    pub(super) parent: Option<String>,
}

#[derive(Debug)]
struct Geometry {
    is_upward: bool,
    points: PointsObject,
    has_pillars: Option<Values>,
    has_cells: Option<Values>,
    splits: Option<SplitsObject>,
}

#[derive(Debug)]
enum PointsObject {
    Nodes(Dataset),
    Lines(Box<LinesObject>),
}

#[derive(Debug)]
struct LinesObject {
    parameters: Dataset,
    knots: usize,
    kinds: Values,
    points: Dataset,
    point_parameters: Option<Values>,
}

#[derive(Debug)]
struct SplitsObject {
    count: usize,
    pillars: Dataset,
    columns: Dataset,
    ends: Dataset,
}

impl GridObject {
    pub(super) fn read(part: Part<'_>, root: Node<'_, '_>) -> Result<Self, ParseError> {
        let dims = [
            part.number(root, "Ni")?,
            part.number(root, "Nj")?,
            part.number(root, "Nk")?,
        ];
        if Lengths::of(dims).is_none() {
            return Err(part.error(ErrorKind::TooLarge, unaddressable(dims)));
        }
        let gaps = xml::child(root, "KGaps").map(|node| {
            let after = Dataset::child(part, node, "GapAfterLayer")?;
            Ok((part.number(node, "Count")?, after))
        });
        let geometry = xml::child(root, "Geometry");
        let parent = xml::child(root, "ParentWindow").map(|node| {
            let parent = xml::child(node, "ParentGrid");
            parent
                .map_or("", |node| xml::text_of(node, "Title"))
                .to_owned()
        });
        Ok(Self {
            dims,
            gaps: gaps.transpose()?,
            crs: geometry.map_or_else(String::new, |node| xml::reference(node, "LocalCrs")),
            geometry: geometry
                .map(|node| Geometry::read(part, node))
                .transpose()?,
            parent,
        })
    }

    pub(super) fn dims(&self) -> [usize; 3] {
        self.dims
    }

    pub(super) fn has_geometry(&self) -> bool {
        self.geometry.is_some()
    }

    pub(super) fn load(&self, part: Part<'_>, files: &Files) -> Result<IjkGrid, ParseError> {
        let Some(geometry) = &self.geometry else {
            let message = "has cells and no geometry, as a regular block has: write it with points of its own, or as EGRID or ROFF";
            return Err(part.error(ErrorKind::Unsupported, message));
        };
        let [ni, nj, nk] = self.dims;
        let pillars = (ni + 1) * (nj + 1);
        let gaps = self.gaps(part, files)?;
        let count = geometry.splits.as_ref().map_or(0, |splits| splits.count);
        let nodes = 1 + nk + gaps.iter().filter(|gap| **gap).count();
        // Beyond memory where the product is: the dataset does not have as many.
        let lines = pillars.saturating_add(count);
        let flags = |values: &Option<Values>, count: usize| {
            let numbers = values.as_ref().map(|v| v.numbers(files, count));
            let numbers = numbers.transpose()?;
            Ok::<_, ParseError>(numbers.map(|n| n.iter().map(|v| *v == 1.0).collect()))
        };
        Ok(IjkGrid {
            dims: self.dims,
            is_upward: geometry.is_upward,
            points: geometry.points.load(part, files, [nodes, lines, pillars])?,
            gaps,
            splits: match &geometry.splits {
                None => Vec::new(),
                Some(splits) => splits.load(files, pillars, ni * nj)?,
            },
            has_pillars: flags(&geometry.has_pillars, pillars)?,
            has_cells: flags(&geometry.has_cells, ni * nj * nk)?,
        })
    }

    fn gaps(&self, part: Part<'_>, files: &Files) -> Result<Vec<bool>, ParseError> {
        let Some((count, after)) = &self.gaps else {
            return Ok(Vec::new());
        };
        let numbers = after.numbers(files, self.dims[2] - 1)?;
        let gaps: Vec<bool> = numbers.iter().map(|v| *v == 1.0).collect();
        let found = gaps.iter().filter(|gap| **gap).count();
        if found != *count {
            let message = format!("KGaps counts {count} gaps, and its array has {found}");
            return Err(part.error(ErrorKind::WrongCount, message));
        }
        Ok(gaps)
    }
}

impl Geometry {
    fn read(part: Part<'_>, node: Node<'_, '_>) -> Result<Self, ParseError> {
        let values = |name: &str| {
            let node = xml::child(node, name);
            node.map(|node| Values::read(part, node)).transpose()
        };
        let direction = xml::text(part.need(node, "KDirection")?);
        let is_upward = match direction {
            "down" => false,
            "up" => true,
            other => {
                let message = format!("KDirection is {other:?}: only up and down are read");
                return Err(part.error(ErrorKind::Unsupported, message));
            }
        };
        let splits = xml::child(node, "SplitCoordinateLines");
        Ok(Self {
            is_upward,
            points: PointsObject::read(part, part.need(node, "Points")?)?,
            has_pillars: values("PillarGeometryIsDefined")?,
            has_cells: values("CellGeometryIsDefined")?,
            splits: splits
                .map(|node| SplitsObject::read(part, node))
                .transpose()?,
        })
    }
}

impl PointsObject {
    fn read(part: Part<'_>, node: Node<'_, '_>) -> Result<Self, ParseError> {
        match xml::type_of(node) {
            "Point3dHdf5Array" => Dataset::of(part, node).map(Self::Nodes),
            "Point3dParametricArray" => {
                let lines = LinesObject::read(part, node)?;
                Ok(Self::Lines(Box::new(lines)))
            }
            other => {
                let message = format!(
                    "its points are a {other}, which is not read: write them as points of their own (Point3dHdf5Array)"
                );
                Err(part.error(ErrorKind::Unsupported, message))
            }
        }
    }

    fn load(
        &self,
        part: Part<'_>,
        files: &Files,
        [nodes, lines, pillars]: [usize; 3],
    ) -> Result<Points, ParseError> {
        let count = nodes.saturating_mul(lines);
        match self {
            Self::Nodes(points) => {
                let points = points.numbers(files, count.saturating_mul(3));
                points.map(Points::Nodes)
            }
            Self::Lines(object) => {
                // Datasets first: a constant has as many values as it is asked for.
                let parameters = object.parameters.numbers(files, count)?;
                let lines = object.load(part, files, pillars)?;
                Ok(Points::Lines { parameters, lines })
            }
        }
    }
}

impl LinesObject {
    fn read(part: Part<'_>, node: Node<'_, '_>) -> Result<Self, ParseError> {
        for name in ["ParametricLineIndices", "TruncatedLineIndices"] {
            if xml::child(node, name).is_some() {
                let message = format!("its points have {name}, which are not read");
                return Err(part.error(ErrorKind::Unsupported, message));
            }
        }
        let lines = part.need(node, "ParametricLines")?;
        let point_parameters = xml::child(lines, "ControlPointParameters");
        Ok(Self {
            parameters: Dataset::child(part, node, "Parameters")?,
            knots: part.number(lines, "KnotCount")?,
            kinds: Values::read(part, part.need(lines, "LineKindIndices")?)?,
            points: Dataset::child(part, lines, "ControlPoints")?,
            point_parameters: point_parameters
                .map(|node| Values::read(part, node))
                .transpose()?,
        })
    }

    fn load(&self, part: Part<'_>, files: &Files, pillars: usize) -> Result<Lines, ParseError> {
        let count = self.knots.saturating_mul(pillars);
        let points = self.points.numbers(files, count.saturating_mul(3))?;
        let kinds = self.kinds.numbers(files, pillars)?;
        let Some(kinds) = kinds.iter().map(|v| LineKind::of(*v)).collect() else {
            let message = "a pillar is a curve (LineKindIndices beyond 1): only vertical and linear ones are read";
            return Err(part.error(ErrorKind::Unsupported, message));
        };
        let read = |v: &Values| v.numbers(files, count);
        let lines = Lines {
            knots: self.knots,
            kinds,
            points,
            parameters: self.point_parameters.as_ref().map(read).transpose()?,
        };
        lines.check(part)?;
        Ok(lines)
    }
}

impl LineKind {
    /// `None` for a curve, `Some(None)` for a pillar without a line.
    fn of(value: f64) -> Option<Option<Self>> {
        Some(match value {
            0.0 => Some(Self::Vertical),
            1.0 => Some(Self::Linear),
            value if value == -1.0 || value.is_nan() => None,
            _ => return None,
        })
    }
}

impl Lines {
    fn check(&self, part: Part<'_>) -> Result<(), ParseError> {
        let is_linear = self.kinds.contains(&Some(LineKind::Linear));
        let message = match (self.knots, &self.parameters) {
            (0, _) => "KnotCount is 0",
            (_, None) if is_linear => "pillars are linear and have no ControlPointParameters",
            (1, _) if is_linear => "pillars are linear and have one point",
            _ => return Ok(()),
        };
        Err(part.error(ErrorKind::BadValue, message))
    }
}

impl SplitsObject {
    fn read(part: Part<'_>, node: Node<'_, '_>) -> Result<Self, ParseError> {
        let columns = part.need(node, "ColumnsPerSplitCoordinateLine")?;
        Ok(Self {
            count: part.number(node, "Count")?,
            pillars: Dataset::child(part, node, "PillarIndices")?,
            columns: Dataset::child(part, columns, "Elements")?,
            ends: Dataset::child(part, columns, "CumulativeLength")?,
        })
    }

    fn load(
        &self,
        files: &Files,
        pillars: usize,
        columns: usize,
    ) -> Result<Vec<Split>, ParseError> {
        let places = |dataset: &Dataset, numbers: Vec<f64>, count: usize| {
            let Some(bad) = first_not(&numbers, |v| index(*v, count).is_some()) else {
                return Ok(numbers.into_iter().map(|v| v as usize).collect::<Vec<_>>());
            };
            let message = format!("value {bad} is {}, and there are {count}", numbers[bad - 1]);
            Err(files.error(dataset, ErrorKind::BadValue, message))
        };
        let numbers = files.numbers(&self.pillars, self.count)?;
        let of_pillars = places(&self.pillars, numbers, pillars)?;
        let elements = files.any_count(&self.columns)?;
        let elements = places(&self.columns, elements, columns)?;
        let numbers = files.numbers(&self.ends, self.count)?;
        let ends = places(&self.ends, numbers, elements.len() + 1)?;
        let mut start = 0;
        let split = of_pillars.into_iter().zip(ends).map(|(pillar, end)| {
            let columns = elements.get(start..end);
            start = end;
            let columns = columns.ok_or_else(|| {
                let message = "lengths do not grow from line to line";
                files.error(&self.ends, ErrorKind::BadValue, message)
            });
            Ok(Split {
                pillar,
                columns: columns?.to_vec(),
            })
        });
        split.collect()
    }
}
