//! RESQML packages: a grid as pillars and depths on the map, its properties, and steps of a time series.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use strataray_parsers::calendar;
use strataray_parsers::resqml::{
    Crs, GridPart, IjkGrid, LineKind, Lines, Package, Points, Property as FileProperty,
};
use strataray_parsers::roff::Pillars;
use strataray_parsers::units::LengthUnit;
use strataray_parsers::{At, ErrorKind, ParseError};

use crate::case::{Kind, Property, Step};

/// What is in a package.
pub struct Contents {
    pub pillars: Pillars,
    /// Unit of all lengths.
    pub unit: LengthUnit,
    pub values: PackageValues,
}

/// Corners that pillars miss by less than this, in the unit of the grid, are on them.
const STRAIGHT: f64 = 0.01;

/// Reads the first grid of a package that has a geometry and refines no other; what is not read goes into `notes`.
pub fn read(path: &Path, notes: &mut Vec<String>) -> Result<Contents, ParseError> {
    let package = Package::open(path)?;
    let grid = chosen(&package)?;
    notes.extend(other_grids(&package, grid));
    notes.extend(package.not_read().iter().cloned());
    let place = Place::of(&package, package.crs(grid)?)?;
    let geometry = package.geometry(grid)?;
    let dims = geometry.dims;
    if geometry.is_upward {
        notes.push(
            "layers of the package count from the bottom: here layer 1 is the uppermost".into(),
        );
    }
    let uuid = grid.uuid.clone();
    let values = PackageValues::of(package, &uuid, &geometry, notes);
    let nodes = Nodes::of(&geometry, &place);
    let (lines, bent) = nodes.pillars();
    notes.extend(bent.map(|bent| bent.sentence(place.unit)));
    let (zcorn, is_whole) = nodes.depths(&lines);
    let active = values.active(dims, notes);
    let mut actnum: Vec<i32> = is_whole.iter().map(|whole| i32::from(*whole)).collect();
    if let Some(has_cells) = &geometry.has_cells {
        keep(&mut actnum, &turned(dims, geometry.is_upward, has_cells));
    }
    let without = actnum.iter().filter(|a| **a == 0).count();
    if without > 0 {
        notes.push(format!(
            "{without} cells have no geometry: they are inactive"
        ));
    }
    active.iter().for_each(|active| keep(&mut actnum, active));
    Ok(Contents {
        pillars: Pillars {
            dims,
            coord: lines.concat(),
            zcorn,
            actnum: Some(actnum),
        },
        unit: place.unit,
        values,
    })
}

fn keep(actnum: &mut [i32], is_active: &[bool]) {
    let gone = actnum.iter_mut().zip(is_active).filter(|(_, is)| !**is);
    gone.for_each(|(a, _)| *a = 0);
}

/// The grid that is shown.
fn chosen(package: &Package) -> Result<&GridPart, ParseError> {
    let grids = package.grids();
    let main = || grids.iter().filter(|grid| grid.parent().is_none());
    let whole = main().find(|grid| grid.has_geometry());
    // What the others lack is told where they are read.
    whole.or(main().next()).or(grids.first()).ok_or_else(|| {
        let others = match package.not_read() {
            [] => String::new(),
            others => format!(": {}", others.join("; ")),
        };
        let message =
            format!("has no grid of rows, columns and layers (IjkGridRepresentation){others}");
        let kind = ErrorKind::MissingKeyword;
        ParseError::of(kind, package.path(), At::File, "", message)
    })
}

/// One sentence about the grids that are not shown.
fn other_grids(package: &Package, shown: &GridPart) -> Option<String> {
    let others = package.grids().iter().filter(|g| g.uuid != shown.uuid);
    let others = others.map(|grid| {
        let [ni, nj, nk] = grid.dims();
        let what = match (grid.parent(), grid.has_geometry()) {
            (Some(parent), _) => format!(", in a window of {parent}"),
            (None, false) => ", without geometry".into(),
            (None, true) => String::new(),
        };
        format!("{} ({ni} x {nj} x {nk}{what})", grid.title)
    });
    let others: Vec<String> = others.collect();
    (!others.is_empty()).then(|| {
        let shown = &shown.title;
        format!(
            "the package has several grids: {shown} is shown, and not {}",
            others.join(", ")
        )
    })
}

/// From a local reference system to the map, with depth.
struct Place {
    unit: LengthUnit,
    /// What lengths of x and y, and of z, are multiplied by.
    scale: [f64; 2],
    /// Which of x and y is east, and the signs of east and north.
    has_east_second: bool,
    signs: [f64; 2],
    /// East and north, scaled.
    origin: [f64; 2],
    z: f64,
    is_depth: bool,
    sine: f64,
    cosine: f64,
}

impl Place {
    fn of(package: &Package, crs: &Crs) -> Result<Self, ParseError> {
        let refuse = |message: String| {
            let kind = ErrorKind::Unsupported;
            ParseError::of(kind, package.path(), At::File, "LocalDepth3dCrs", message)
        };
        let meters = |unit: &str| {
            let found = meters(unit);
            found.ok_or_else(|| refuse(format!("its unit {unit:?} is not known: use m or ft")))
        };
        let lateral = meters(&crs.unit)?;
        let unit = LengthUnit::from_name(&crs.unit).unwrap_or(LengthUnit::Metre);
        let scale = [lateral, meters(&crs.vertical_unit)?].map(|m| m / unit.meters());
        let axes: Vec<&str> = crs.axes.split_whitespace().collect();
        let (has_east_second, [east, north]) = match axes[..] {
            [a @ ("easting" | "westing"), b @ ("northing" | "southing")] => (false, [a, b]),
            [b @ ("northing" | "southing"), a @ ("easting" | "westing")] => (true, [a, b]),
            _ => {
                let message = format!("its axes are {:?}, which is not read", crs.axes);
                return Err(refuse(message));
            }
        };
        let sign = |is_reversed: bool| if is_reversed { -1.0 } else { 1.0 };
        let mut place = Self {
            unit,
            scale,
            has_east_second,
            signs: [sign(east == "westing"), sign(north == "southing")],
            origin: [0.0; 2],
            z: crs.origin[2],
            is_depth: crs.is_depth,
            sine: crs.rotation.sin(),
            cosine: crs.rotation.cos(),
        };
        place.origin = place.east_north(crs.origin[0], crs.origin[1]);
        Ok(place)
    }

    fn east_north(&self, x: f64, y: f64) -> [f64; 2] {
        let [east, north] = if self.has_east_second { [y, x] } else { [x, y] };
        [
            self.signs[0] * east * self.scale[0],
            self.signs[1] * north * self.scale[0],
        ]
    }

    /// A point on the map, with its depth.
    fn map(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [east, north] = self.east_north(x, y);
        // Local axes are turned clockwise.
        let z = (z + self.z) * self.scale[1];
        [
            self.origin[0] + east * self.cosine + north * self.sine,
            self.origin[1] - east * self.sine + north * self.cosine,
            if self.is_depth { z } else { -z },
        ]
    }
}

/// Meters of a unit of lengths as RESQML calls it.
fn meters(unit: &str) -> Option<f64> {
    Some(match unit {
        "m" => 1.0,
        "ft" => 0.3048,
        "cm" => 0.01,
        "mm" => 0.001,
        "km" => 1000.0,
        "ft[US]" => 1200.0 / 3937.0,
        _ => return None,
    })
}

/// Nodes of coordinate lines on the map.
struct Nodes<'a> {
    grid: &'a IjkGrid,
    /// All lines of a node, then those of the next one.
    points: Vec<[f64; 3]>,
    lines: usize,
    /// By column, the lines at its corners, `2 * dj + di`.
    corners: Vec<[u32; 4]>,
}

/// How far corners are off straight pillars.
struct Bent {
    pillars: usize,
    of: usize,
    most: f64,
}

impl Bent {
    fn sentence(&self, unit: LengthUnit) -> String {
        format!(
            "{} of {} pillars are not straight: corners were moved along their layers by up to {:.3} {} onto straight ones",
            self.pillars,
            self.of,
            self.most,
            unit.name()
        )
    }
}

impl<'a> Nodes<'a> {
    fn of(grid: &'a IjkGrid, place: &Place) -> Self {
        let lines = pillar_count(grid.dims) + grid.splits.len();
        let points = match &grid.points {
            Points::Nodes(numbers) => {
                let (points, _) = numbers.as_chunks::<3>();
                points.par_iter().map(|p| place.map(*p)).collect()
            }
            Points::Lines {
                parameters,
                lines: of_pillars,
            } => {
                let point = |(n, parameter): (usize, &f64)| {
                    let pillar = pillar_of(grid, n % lines);
                    place.map(point_at(of_pillars, pillar, *parameter))
                };
                parameters.par_iter().enumerate().map(point).collect()
            }
        };
        Self {
            points,
            lines,
            corners: corners(grid),
            grid,
        }
    }

    /// The points along a line, from the first node on.
    fn along(&self, line: usize) -> impl Iterator<Item = [f64; 3]> {
        let points = self.points[line..].iter().step_by(self.lines);
        points.copied().filter(|p| p.iter().all(|v| v.is_finite()))
    }

    /// Pillars through the uppermost and the lowest of their nodes, upper end first, and how far others are off them.
    /// A pillar without nodes takes the place of one before it, or behind.
    fn pillars(&self) -> (Vec<[f64; 6]>, Option<Bent>) {
        let count = pillar_count(self.grid.dims);
        let mut of_pillar: Vec<Vec<usize>> = (0..count).map(|p| vec![p]).collect();
        for (n, split) in self.grid.splits.iter().enumerate() {
            of_pillar[split.pillar].push(count + n);
        }
        let has = |pillar: usize| self.grid.has_pillars.as_ref().is_none_or(|has| has[pillar]);
        let line = |(pillar, lines): (usize, &Vec<usize>)| {
            let lines = lines.iter().filter(|_| has(pillar));
            let points: Vec<[f64; 3]> = lines.flat_map(|line| self.along(*line)).collect();
            let top = points
                .iter()
                .copied()
                .min_by(|a, b| a[2].total_cmp(&b[2]))?;
            let bottom = points
                .iter()
                .copied()
                .max_by(|a, b| a[2].total_cmp(&b[2]))?;
            let off = points.iter().map(|p| off_line(top, bottom, *p));
            Some(([top, bottom], off.fold(0.0, f64::max)))
        };
        let found: Vec<Option<([[f64; 3]; 2], f64)>> =
            of_pillar.par_iter().enumerate().map(line).collect();
        let off = || found.iter().flatten().map(|(_, off)| *off);
        let bent = off().filter(|off| *off > STRAIGHT).count();
        let bent = (bent > 0).then(|| Bent {
            pillars: bent,
            of: count,
            most: off().fold(0.0, f64::max),
        });
        let first = found.iter().flatten().next();
        let mut last = first.map_or([[0.0; 3]; 2], |(line, _)| *line);
        let ends = found.iter().map(|found| {
            last = found.map_or(last, |(line, _)| line);
            let [[x, y, z], [u, v, w]] = last;
            [x, y, z, u, v, w]
        });
        (ends.collect(), bent)
    }

    /// Depths of all corners as decks have them, from the uppermost layer on, and which cells have all of theirs.
    fn depths(&self, lines: &[[f64; 6]]) -> (Vec<f64>, Vec<bool>) {
        let [ni, nj, nk] = self.grid.dims;
        let upper = first_nodes(self.grid);
        let mut zcorn = vec![0.0; 8 * ni * nj * nk];
        let mut is_whole = vec![true; ni * nj * nk];
        let layers = zcorn.par_chunks_mut(8 * ni * nj);
        let layers = layers.zip(is_whole.par_chunks_mut(ni * nj)).enumerate();
        layers.for_each(|(k, (zcorn, is_whole))| {
            let is_upward = self.grid.is_upward;
            let node = upper[if is_upward { nk - 1 - k } else { k }];
            for (column, whole) in is_whole.iter_mut().enumerate() {
                for corner in 0..8 {
                    let [di, dj, dk] = [corner & 1, corner >> 1 & 1, corner >> 2];
                    let line = self.corners[column][corner & 3] as usize;
                    let below = if is_upward { 1 - dk } else { dk };
                    let [x, y, depth] = self.points[(node + below) * self.lines + line];
                    let pillar = pillar_of(self.grid, line);
                    let has_pillar = self.grid.has_pillars.as_ref().is_none_or(|h| h[pillar]);
                    let is_there =
                        has_pillar && x.is_finite() && y.is_finite() && depth.is_finite();
                    *whole &= is_there;
                    let (i, j) = (column % ni, column / ni);
                    let at = 2 * i + di + 2 * ni * (2 * j + dj) + 4 * ni * nj * dk;
                    zcorn[at] = if is_there { depth } else { lines[pillar][2] };
                }
            }
        });
        (zcorn, is_whole)
    }
}

fn pillar_count([ni, nj, _]: [usize; 3]) -> usize {
    (ni + 1) * (nj + 1)
}

/// The pillar that a line belongs to.
fn pillar_of(grid: &IjkGrid, line: usize) -> usize {
    match line.checked_sub(pillar_count(grid.dims)) {
        Some(split) => grid.splits[split].pillar,
        None => line,
    }
}

/// By layer of the file, the node of the side where it begins.
fn first_nodes(grid: &IjkGrid) -> Vec<usize> {
    let mut node = 0;
    let first = |k: usize| {
        let first = node;
        node += 1 + usize::from(grid.gaps.get(k) == Some(&true));
        first
    };
    (0..grid.dims[2]).map(first).collect()
}

/// By column, the lines at its corners.
fn corners(grid: &IjkGrid) -> Vec<[u32; 4]> {
    let [ni, nj, _] = grid.dims;
    let pillar = |column: usize, corner: usize| {
        let [i, j] = [column % ni + (corner & 1), column / ni + (corner >> 1)];
        i + (ni + 1) * j
    };
    let columns = 0..ni * nj;
    let mut corners: Vec<[u32; 4]> = columns
        .map(|column| std::array::from_fn(|corner| pillar(column, corner) as u32))
        .collect();
    for (n, split) in grid.splits.iter().enumerate() {
        let line = pillar_count(grid.dims) + n;
        for &column in &split.columns {
            // A column that is not at the pillar has no corner there.
            let at = (0..4).find(|corner| pillar(column, *corner) == split.pillar);
            if let Some(corner) = at {
                corners[column][corner] = line as u32;
            }
        }
    }
    corners
}

/// Distance of a point from the line between two others, at its depth.
fn off_line(top: [f64; 3], bottom: [f64; 3], point: [f64; 3]) -> f64 {
    let height = bottom[2] - top[2];
    let share = match height > 0.0 {
        true => (point[2] - top[2]) / height,
        false => 0.0,
    };
    let off = |axis: usize| point[axis] - (top[axis] + share * (bottom[axis] - top[axis]));
    off(0).hypot(off(1))
}

/// The point of a pillar's line at a parameter; not finite where it has none.
fn point_at(lines: &Lines, pillar: usize, parameter: f64) -> [f64; 3] {
    let pillars = lines.kinds.len();
    let point = |knot: usize| -> [f64; 3] {
        std::array::from_fn(|axis| lines.points[3 * (knot * pillars + pillar) + axis])
    };
    match (lines.kinds[pillar], &lines.parameters) {
        (Some(LineKind::Vertical), _) => {
            let [x, y, _] = point(0);
            [x, y, parameter]
        }
        (Some(LineKind::Linear), Some(parameters)) => {
            let at = |knot: usize| parameters[knot * pillars + pillar];
            // Of the pieces the one that the parameter is in; the outer ones go on.
            let is_within = |knot: &usize| (parameter - at(*knot)) * (at(1) - at(0)) > 0.0;
            let knot = (1..lines.knots - 1).rev().find(is_within).unwrap_or(0);
            let share = (parameter - at(knot)) / (at(knot + 1) - at(knot));
            let (a, b) = (point(knot), point(knot + 1));
            std::array::from_fn(|axis| a[axis] + share * (b[axis] - a[axis]))
        }
        _ => [f64::NAN; 3],
    }
}

/// Values in the order of layers from the top.
fn turned<T: Copy>([ni, nj, _]: [usize; 3], is_upward: bool, values: &[T]) -> Vec<T> {
    match is_upward {
        true => values.chunks(ni * nj).rev().flatten().copied().collect(),
        false => values.to_vec(),
    }
}

/// The properties of the grid of a package, whose values are read when they are asked for.
pub struct PackageValues {
    package: Package,
    dims: [usize; 3],
    is_upward: bool,
    steps: Vec<Step>,
    /// Which properties of the package are known by which name, and at which step.
    named: Vec<Named>,
    /// Of the property that says which cells are active.
    active: Option<usize>,
}

struct Named {
    name: String,
    unit: String,
    step: Option<usize>,
    property: usize,
}

impl PackageValues {
    fn of(package: Package, grid: &str, geometry: &IjkGrid, notes: &mut Vec<String>) -> Self {
        let properties = package.properties().iter().enumerate();
        let own: Vec<(usize, &FileProperty)> = properties.filter(|(_, p)| p.grid == grid).collect();
        let others = package.properties().len() - own.len();
        if others > 0 && package.grids().len() == 1 {
            notes.push(format!(
                "{others} properties are not of the grid that is shown"
            ));
        }
        let is_active = |(_, p): &&(usize, &FileProperty)| {
            p.kind.eq_ignore_ascii_case("active") && p.time.is_none()
        };
        let active = own.iter().find(is_active).map(|(n, _)| *n);
        let series = series_of(&package, &own, notes);
        let steps = series.map_or_else(Vec::new, |n| steps(&package.series()[n].times));
        let series = series.map(|n| package.series()[n].uuid.as_str());
        let own = own.into_iter().filter(|(n, _)| Some(*n) != active);
        let mut named: Vec<Named> = Vec::new();
        for (number, property) in own {
            let step = property.time.as_ref().map(|time| time.index);
            let is_of_other = property
                .time
                .as_ref()
                .is_some_and(|t| Some(t.series.as_str()) != series);
            if is_of_other || step.is_some_and(|step| step >= steps.len()) {
                continue;
            }
            named.push(Named {
                name: free_name(&named, property, step),
                unit: unit(&property.unit),
                step,
                property: number,
            });
        }
        Self {
            dims: geometry.dims,
            is_upward: geometry.is_upward,
            steps,
            named,
            active,
            package,
        }
    }

    /// The files that arrays are in.
    pub fn array_files(&self) -> Vec<PathBuf> {
        self.package.array_files().map(Path::to_owned).collect()
    }

    /// The steps of the time series.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// Leaves out all that changes with time, because results have steps of their own; the sentence says so.
    pub fn drop_steps(&mut self) -> Option<String> {
        self.steps.clear();
        let before = self.named.len();
        self.named.retain(|named| named.step.is_none());
        (self.named.len() < before)
            .then(|| "what changes with time in the package is not shown: the restart has steps of its own".into())
    }

    /// True where there is a property of that name.
    pub fn has(&self, name: &str) -> bool {
        self.named.iter().any(|named| named.name == name)
    }

    /// All properties in the order of the package.
    pub fn properties(&self) -> Vec<Property> {
        let mut list: Vec<Property> = Vec::new();
        for named in &self.named {
            let at_step = usize::from(named.step.is_some());
            match list.iter_mut().find(|p| p.name == named.name) {
                Some(known) => known.steps += at_step,
                None => {
                    let kind = match named.step {
                        Some(_) => Kind::Dynamic,
                        None => Kind::Static,
                    };
                    list.push(Property {
                        steps: at_step,
                        ..Property::new(&named.name, kind, &named.unit)
                    });
                }
            }
        }
        list
    }

    /// The values of all cells; `None` where the property has none at the step.
    pub fn values(&self, name: &str, step: usize) -> Result<Option<Vec<f32>>, ParseError> {
        let is_it = |n: &&Named| n.name == name && n.step.is_none_or(|s| s == step);
        let Some(named) = self.named.iter().find(is_it) else {
            return Ok(None);
        };
        let property = &self.package.properties()[named.property];
        let values = self.package.values(property, self.dims)?;
        let values: Vec<f32> = values.iter().map(|v| *v as f32).collect();
        Ok(Some(turned(self.dims, self.is_upward, &values)))
    }

    /// Which cells are active by the property that says so.
    fn active(&self, dims: [usize; 3], notes: &mut Vec<String>) -> Option<Vec<bool>> {
        let property = &self.package.properties()[self.active?];
        match self.package.values(property, dims) {
            Ok(values) => {
                let is_active: Vec<bool> = values.iter().map(|v| *v > 0.0).collect();
                Some(turned(dims, self.is_upward, &is_active))
            }
            Err(error) => {
                notes.push(format!("which cells are active was not read: {error}"));
                None
            }
        }
    }
}

/// A unit as it is shown: none where both sides of a ratio are the same.
fn unit(uom: &str) -> String {
    match uom.split_once('/') {
        Some((a, b)) if a == b => String::new(),
        None if uom == "Euc" => String::new(),
        _ => uom.to_owned(),
    }
}

/// The title of a property, with its facets or a number where another one has it at the same time.
fn free_name(named: &[Named], property: &FileProperty, step: Option<usize>) -> String {
    let is_free = |name: &String| {
        // What changes with time and what does not are two properties.
        let mut others = named.iter().filter(|n| n.name.eq_ignore_ascii_case(name));
        !others.any(|n| n.step == step || n.step.is_none() || step.is_none())
    };
    let title = match property.title.trim() {
        "" => property.kind.clone(),
        title => title.to_owned(),
    };
    let with_facets = match &property.facets[..] {
        [] => None,
        facets => Some(format!("{title} {}", facets.join(" "))),
    };
    let base = with_facets.clone().unwrap_or_else(|| title.clone());
    let numbered = (2..).map(|n| format!("{base} {n}"));
    let mut names = std::iter::once(title).chain(with_facets).chain(numbered);
    names.find(is_free).unwrap_or(base)
}

/// The series that most properties are of; others are told.
fn series_of(
    package: &Package,
    own: &[(usize, &FileProperty)],
    notes: &mut Vec<String>,
) -> Option<usize> {
    let times = || own.iter().filter_map(|(_, p)| p.time.as_ref());
    let count = |uuid: &str| times().filter(|t| t.series == uuid).count();
    let counts = package.series().iter().enumerate();
    let counts: Vec<(usize, usize)> = counts.map(|(n, s)| (n, count(&s.uuid))).collect();
    // Of several with as many the first.
    let most = counts.iter().rev().max_by_key(|(_, count)| *count);
    let most = most.filter(|(_, count)| *count > 0).copied();
    let is_shown = |t: &&strataray_parsers::resqml::TimeIndex| {
        most.is_some_and(|(n, _)| {
            let series = &package.series()[n];
            series.uuid == t.series && t.index < series.times.len()
        })
    };
    let left = times().filter(|t| !is_shown(t)).count();
    if left > 0 {
        notes.push(format!(
            "{left} properties are of times beyond the time series that is shown: they were left out"
        ));
    }
    most.map(|(n, _)| n)
}

/// The steps of times such as `2021-01-01T06:30:00Z`; those that are no dates count as days from the first.
fn steps(times: &[String]) -> Vec<Step> {
    let moments: Vec<Option<f64>> = times.iter().map(|time| moment(time)).collect();
    let start = moments.iter().flatten().copied().next();
    let step = |(n, moment): (usize, &Option<f64>)| Step {
        report: n as u32,
        date: moment.map(calendar::text).unwrap_or_default(),
        days: moment
            .zip(start)
            .map_or(n as f64, |(moment, start)| moment - start),
    };
    moments.iter().enumerate().map(step).collect()
}

/// Days since 1970 of a time as XML has it; its zone is passed over.
fn moment(time: &str) -> Option<f64> {
    let (date, clock) = time.split_once('T').unwrap_or((time, "00:00:00"));
    let clock = clock.split(['Z', '+', '-', '.']).next().unwrap_or_default();
    calendar::moment(&format!("{} {clock}", date.trim_end_matches('Z')))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_lines_lie_between_their_knots() {
        let lines = Lines {
            knots: 3,
            kinds: vec![Some(LineKind::Linear), Some(LineKind::Vertical), None],
            points: [[0.0, 0.0, 100.0], [5.0, 6.0, 0.0], [0.0; 3]]
                .into_iter()
                .chain([[10.0, 0.0, 200.0], [0.0; 3], [0.0; 3]])
                .chain([[10.0, 40.0, 400.0], [0.0; 3], [0.0; 3]])
                .flatten()
                .collect(),
            parameters: Some([[0.0; 3], [1.0; 3], [2.0; 3]].concat()),
        };
        let at = |pillar, parameter| point_at(&lines, pillar, parameter);
        assert_eq!(at(0, 0.5), [5.0, 0.0, 150.0]);
        assert_eq!(at(0, 1.5), [10.0, 20.0, 300.0]);
        assert_eq!(at(0, 3.0), [10.0, 80.0, 600.0]);
        assert_eq!(at(1, 77.0), [5.0, 6.0, 77.0]);
        assert!(at(2, 1.0).iter().all(|v| v.is_nan()));
        // Parameters may fall along a line.
        let falling = Lines {
            parameters: Some([[4.0; 3], [2.0; 3], [0.0; 3]].concat()),
            ..lines
        };
        assert_eq!(point_at(&falling, 0, 3.0), [5.0, 0.0, 150.0]);
        assert_eq!(point_at(&falling, 0, 1.0), [10.0, 20.0, 300.0]);
    }

    #[test]
    fn times_are_dates() {
        let times = [
            "2020-01-01",
            "2020-01-02T06:30:00Z",
            "2020-02-01T00:00:00.000+01:00",
            "",
        ];
        let steps = steps(&times.map(str::to_owned));
        let dates: Vec<&str> = steps.iter().map(|s| s.date.as_str()).collect();
        assert_eq!(dates, ["2020-01-01", "2020-01-02 06:30", "2020-02-01", ""]);
        assert!((steps[1].days - 1.270_833).abs() < 1e-6);
        assert_eq!(steps[2].days, 31.0);
    }
}
