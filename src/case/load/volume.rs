//! Regular volumes: each sample is the value of a cell around it.
//!
//! K is the axis of the file that is nearest to the vertical, and counts downward; I and J are the other two in the order
//! of the file. Of a volume that is too large every n-th sample is taken, and a note says so.

use std::path::Path;

use glam::DVec3;
use strataray_parsers::units::LengthUnit;
use strataray_parsers::volume::{self, Format, Options, Region, VolumeFile};
use strataray_parsers::{At, ErrorKind, ParseError};

use crate::case::{CONNECTIONS, Kind, POROSITY_THICKNESS, Property};
use crate::model::derived::Derived;
use crate::model::{Dims, RegularLattice};

/// Cells that are made of a volume, at most: some 4 GB with their values and what a first picture takes.
const MOST_CELLS: usize = 1 << 26;
/// Samples that are decoded at a time.
const SLAB: usize = 1 << 20;
/// Places of two volumes that are apart by more than this part of a step are others.
const SAME: f64 = 0.01;
/// Names of the axes of cells.
const IJK: [&str; 3] = ["I", "J", "K"];

/// A volume that has been opened, before its values are read.
#[derive(Debug)]
pub struct Volume {
    /// Where the cells are.
    pub lattice: RegularLattice,
    /// Its values.
    pub values: VolumeValues,
    /// The word of GRIDUNIT for its lengths.
    pub length: &'static str,
    /// Unit of the vertical axis where it is time.
    pub time: Option<String>,
    /// What an engineer should know.
    pub notes: Vec<String>,
}

/// The values of a volume, which are read when they are asked for.
#[derive(Debug)]
pub struct VolumeValues {
    file: VolumeFile,
    axes: [Taken; 3],
    name: String,
}

/// What of an axis of the file is taken as I, J or K.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Taken {
    /// The axis of the file.
    axis: usize,
    /// Cells count from its end.
    is_reversed: bool,
    /// Every so many samples make a cell.
    every: usize,
    /// Cells.
    count: usize,
}

impl Taken {
    /// The sample of a cell.
    fn sample(self, cell: usize) -> usize {
        match self.is_reversed {
            true => (self.count - 1 - cell) * self.every,
            false => cell * self.every,
        }
    }

    /// The cell of a sample; `None` where it has none.
    fn cell(self, sample: usize) -> Option<usize> {
        let number = sample / self.every;
        sample
            .is_multiple_of(self.every)
            .then_some(match self.is_reversed {
                true => self.count - 1 - number,
                false => number,
            })
    }
}

/// Opens a volume and reads nothing of its values.
///
/// # Errors
/// When it is damaged, or its axes span no cells.
pub fn open(path: &Path) -> Result<Volume, ParseError> {
    let file = volume::open(path, &Options::default())?;
    of_file(file, MOST_CELLS)
}

fn of_file(file: VolumeFile, most: usize) -> Result<Volume, ParseError> {
    let [first, edges @ ..] = in_depth(&file);
    let (vertical, share) = (0..3)
        .map(|axis| (axis, (edges[axis].z / edges[axis].length()).abs()))
        .fold(
            (0, 0.0),
            |best, next| if next.1 > best.1 { next } else { best },
        );
    if share == 0.0 {
        let message = "no axis of the volume has a vertical part, so there are no layers: correct the directions of its \
                       axes in the header";
        return Err(ParseError::of(
            ErrorKind::BadValue,
            file.path(),
            At::File,
            "",
            message,
        ));
    }
    let order: Vec<usize> = (0..3).filter(|axis| *axis != vertical).collect();
    let order = [order[0], order[1], vertical];
    let every = thinned(order.map(|axis| file.lattice.dims[axis]), most);
    let axes = [0, 1, 2].map(|n| Taken {
        axis: order[n],
        is_reversed: n == 2 && edges[vertical].z < 0.0,
        every: every[n],
        count: file.lattice.dims[order[n]].div_ceil(every[n]),
    });
    let begin = |n: usize| edges[axes[n].axis] * axes[n].sample(0) as f64;
    let sign = |taken: Taken| if taken.is_reversed { -1.0 } else { 1.0 };
    let step = |taken: Taken| edges[taken.axis] * (sign(taken) * taken.every as f64);
    let [ni, nj, nk] = axes.map(|taken| taken.count);
    let lattice = RegularLattice {
        dims: Dims { ni, nj, nk },
        first: first + begin(0) + begin(1) + begin(2),
        edges: axes.map(step),
    };
    let mut notes: Vec<String> = file.notes.iter().map(ToString::to_string).collect();
    notes.extend(told_thinning(&file, axes));
    notes.extend(told_axes(&file, axes));
    let (length, unit) = length_of(&file, axes);
    notes.extend(unit);
    let time = time_of(&file, axes);
    notes.extend(time.as_ref().map(|unit| {
        format!(
            "the vertical axis is two-way time in {unit}, and no depth: it is drawn as if a {unit} were as long as the unit of \
             x and y, and volumes of cells mean nothing"
        )
    }));
    let name = own_name(&file, &mut notes);
    Ok(Volume {
        lattice,
        values: VolumeValues { file, axes, name },
        length,
        time,
        notes,
    })
}

/// Sign of the third coordinate of files of a format as depth: time and depth of seismic grow downward, and images stand
/// upright.
pub fn downward(format: Format) -> f64 {
    match format {
        Format::Segy => 1.0,
        Format::Nrrd | Format::MetaImage | Format::Vti | Format::Raw => -1.0,
    }
}

/// The first sample and the steps along the axes of the file, with depth instead of height.
fn in_depth(file: &VolumeFile) -> [DVec3; 4] {
    let [i, j, k] = file.lattice.edges;
    let down = downward(file.format);
    [file.lattice.origin, i, j, k].map(|[x, y, z]| DVec3::new(x, y, down * z))
}

/// Of how many samples along each axis one is taken, so that there are at most so many.
fn thinned(dims: [usize; 3], most: usize) -> [usize; 3] {
    let mut every = [1; 3];
    let counts = |every: [usize; 3]| [0, 1, 2].map(|n: usize| dims[n].div_ceil(every[n]));
    let are_many = |counts: [usize; 3]| {
        let product = counts
            .iter()
            .try_fold(1_usize, |all, n| all.checked_mul(*n));
        product.is_none_or(|all| all > most)
    };
    while are_many(counts(every)) {
        let counts = counts(every);
        // The axis that has the most cells; of several the one that is thinned the least.
        let is_longer = |a: usize, b: usize| (counts[b], every[a]) > (counts[a], every[b]);
        let longest = (1..3).fold(0, |a, b| if is_longer(a, b) { b } else { a });
        every[longest] += 1;
    }
    every
}

/// Which samples are left out.
fn told_thinning(file: &VolumeFile, axes: [Taken; 3]) -> Option<String> {
    let thin = (0..3).filter(|n| axes[*n].every > 1);
    let thin: Vec<String> = thin
        .map(|n| format!("every {} sample along {}", ordinal(axes[n].every), IJK[n]))
        .collect();
    let [ni, nj, nk] = file.lattice.dims;
    (!thin.is_empty()).then(|| {
        format!(
            "volume: {} is shown, because {ni} x {nj} x {nk} samples are more than the {MOST_CELLS} cells that fit in memory",
            thin.join(", ")
        )
    })
}

fn ordinal(n: usize) -> String {
    let ending = match (n % 10, n % 100) {
        (1, r) if r != 11 => "st",
        (2, r) if r != 12 => "nd",
        (3, r) if r != 13 => "rd",
        _ => "th",
    };
    format!("{n}{ending}")
}

/// Which axes of the file are I, J and K, where that is not plain; numbers of lines where it has some.
fn told_axes(file: &VolumeFile, axes: [Taken; 3]) -> Vec<String> {
    let is_plain = (0..3).all(|n| axes[n].axis == n && !axes[n].is_reversed);
    let name = |taken: Taken| {
        let number = taken.axis + 1;
        let name = match file.axes[taken.axis].name.as_str() {
            "" => String::new(),
            name => format!(" ({name})"),
        };
        let way = if taken.is_reversed {
            " from its end"
        } else {
            ""
        };
        format!("axis {number}{name}{way}")
    };
    let named: Vec<String> = (0..3)
        .map(|n| format!("{} is {}", IJK[n], name(axes[n])))
        .collect();
    let order = format!("of the file {}; K counts downward", named.join(", "));
    let mut told = Vec::new();
    if !is_plain {
        told.push(order);
    }
    if let Some(survey) = &file.survey {
        let line = |n: usize| {
            let axis = axes[n].axis;
            let step = survey.step[axis] as usize * axes[n].every;
            let (name, first) = (&file.axes[axis].name, survey.first[axis]);
            format!(
                "{} 1 is {name} {first}, the next one {step} further",
                IJK[n]
            )
        };
        told.push(format!("{}; {}", line(0), line(1)));
    }
    told
}

/// The unit of lengths, and what is said where the file has none that is known.
fn length_of(file: &VolumeFile, axes: [Taken; 3]) -> (&'static str, Option<String>) {
    let units = axes.map(|taken| file.axes[taken.axis].unit.trim());
    let lateral = units.into_iter().find(|unit| !unit.is_empty());
    let metres = LengthUnit::Metre.name();
    let Some(unit) = lateral else {
        let note = format!("the file says no unit of lengths: they are taken as {metres}");
        return (metres, Some(note));
    };
    let Some(known) = LengthUnit::from_name(unit) else {
        let note =
            format!("lengths are in {unit}: they are shown as they are, and called {metres}");
        return (metres, Some(note));
    };
    let others = units.iter().filter(|other| {
        !other.is_empty() && **other != "ms" && LengthUnit::from_name(other) != Some(known)
    });
    let others: Vec<&str> = others.copied().collect();
    let note = (!others.is_empty()).then(|| {
        let others = others.join(", ");
        format!("lengths along the axes are in {unit} and {others}: all are shown as {unit}")
    });
    (known.name(), note)
}

/// The unit of the vertical axis where it is time.
fn time_of(file: &VolumeFile, axes: [Taken; 3]) -> Option<String> {
    let vertical = &file.axes[axes[2].axis];
    let is_time = file.format == Format::Segy && vertical.name == "time";
    is_time.then(|| vertical.unit.clone())
}

/// What the values are called: as in the file, unless that is the name of something that every grid has.
fn own_name(file: &VolumeFile, notes: &mut Vec<String>) -> String {
    let plain = match file.format {
        Format::Segy => "AMPLITUDE",
        _ => "VALUE",
    };
    let name = file.name.trim();
    let of_grids = Derived::ALL.iter().map(|(name, _)| *name);
    let mut of_grids = of_grids.chain([CONNECTIONS, POROSITY_THICKNESS]);
    // Of differences the part behind @ says to what.
    let is_taken = name.contains('@') || of_grids.any(|known| known.eq_ignore_ascii_case(name));
    if is_taken {
        notes.push(format!(
            "the values are called {name} in the file, and {plain} here: the other name has a meaning of its own"
        ));
    }
    match name.is_empty() || is_taken {
        true => plain.to_owned(),
        false => name.to_owned(),
    }
}

impl Volume {
    /// Checks that the cells are those of another volume.
    ///
    /// # Errors
    /// When they are others.
    pub fn check_lattice(&self, grid: &RegularLattice) -> Result<(), ParseError> {
        let dims = |of: &RegularLattice| [of.dims.ni, of.dims.nj, of.dims.nk];
        let refuse = |message: String| {
            let path = self.values.file.path();
            Err(ParseError::of(
                ErrorKind::Mismatch,
                path,
                At::File,
                "",
                message,
            ))
        };
        let ([a, b, c], [ni, nj, nk]) = (dims(&self.lattice), dims(grid));
        if dims(&self.lattice) != dims(grid) {
            return refuse(format!(
                "has {a} x {b} x {c} samples and the first volume {ni} x {nj} x {nk}: open it by itself"
            ));
        }
        let step = grid.edges.iter().map(|edge| edge.length());
        let step = step.fold(f64::INFINITY, f64::min);
        let last = dims(grid).map(|n| (n - 1) as f64);
        let ends = (0..8).map(|n: usize| [0, 1, 2].map(|axis| last[axis] * (n >> axis & 1) as f64));
        let apart = ends.map(|at| self.lattice.place(at).distance(grid.place(at)));
        let apart = apart.fold(0.0, f64::max);
        match apart <= SAME * step {
            true => Ok(()),
            false => refuse(format!(
                "has samples up to {apart:.3} away from those of the first volume: open it by itself"
            )),
        }
    }
}

impl VolumeValues {
    /// The property that the values are.
    pub fn property(&self) -> Property {
        Property::new(&self.name, Kind::Static, &self.file.unit)
    }

    /// The name of the property.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Takes a name that others do not have.
    pub fn rename(&mut self, taken: &[Self]) {
        let is_free = |name: &String| !taken.iter().any(|t| t.name.eq_ignore_ascii_case(name));
        let stem = self.file.path().file_stem().unwrap_or_default();
        let with_stem = format!("{}.{}", self.name, stem.to_string_lossy());
        let numbered = (2..).map(|n| format!("{with_stem}.{n}"));
        let own = std::iter::once(self.name.clone());
        let mut names = own.chain([with_stem.clone()]).chain(numbered);
        if let Some(free) = names.find(is_free) {
            self.name = free;
        }
    }

    /// The values of all cells, NaN where there is none.
    ///
    /// # Errors
    /// When the file is damaged or has become shorter, or there is not enough memory.
    pub fn read(&self) -> Result<Vec<f32>, ParseError> {
        let [ni, nj, nk] = self.axes.map(|taken| taken.count);
        let cells = ni * nj * nk;
        let mut values = Vec::new();
        // A plain allocation would end the process where memory is short.
        values.try_reserve_exact(cells).map_err(|_| {
            let message = format!("there is not enough memory for the values of {cells} cells");
            ParseError::of(ErrorKind::TooLarge, self.file.path(), At::File, "", message)
        })?;
        values.resize(cells, f32::NAN);
        let slow = self.file.slow_axis();
        for slab in self.file.slabs(SLAB) {
            let planes = slab.start[slow]..slab.start[slow] + slab.size[slow];
            let places = self.places();
            if planes.clone().any(|plane| places[slow](plane).is_some()) {
                self.take(slab, &mut values)?;
            }
        }
        Ok(values)
    }

    /// By axis of the file, what a sample adds to the number of its cell; `None` where it is not taken.
    fn places(&self) -> [impl Fn(usize) -> Option<usize>; 3] {
        let [ni, nj, _] = self.axes.map(|taken| taken.count);
        let strides = [1, ni, ni * nj];
        [0, 1, 2].map(|axis| {
            let of_axis = (0..3).find(|n| self.axes[*n].axis == axis);
            // Each axis of the file is one of the three.
            let n = of_axis.unwrap_or(axis);
            let (taken, stride) = (self.axes[n], strides[n]);
            move |sample| taken.cell(sample).map(|cell| cell * stride)
        })
    }

    /// Puts the samples of a slab that are taken into their cells.
    fn take(&self, slab: Region, values: &mut [f32]) -> Result<(), ParseError> {
        let samples = self.file.f32s(slab)?;
        let [along_a, along_b, along_c] = self.places();
        let [na, nb, nc] = slab.size;
        for c in 0..nc {
            let Some(plane) = along_c(slab.start[2] + c) else {
                continue;
            };
            for b in 0..nb {
                let Some(row) = along_b(slab.start[1] + b) else {
                    continue;
                };
                let samples = &samples[na * (b + nb * c)..][..na];
                for (a, sample) in samples.iter().enumerate() {
                    if let Some(place) = along_a(slab.start[0] + a) {
                        values[plane + row + place] = *sample;
                    }
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use strataray_parsers::volume::{ByteOrder, Contents, Lattice, SampleType, nrrd};

    use super::*;

    const DIMS: [usize; 3] = [9, 5, 4];

    fn file() -> VolumeFile {
        let contents = Contents {
            lattice: Lattice::straight(DIMS, [1.0, 2.0, 3.0], [2.0, 3.0, -4.0]),
            sample: SampleType::F32,
            byte_order: ByteOrder::Little,
            name: "Depth".into(),
        };
        let values = (0..DIMS.iter().product::<usize>()).map(|n| n as f64);
        let bytes = nrrd::write(Vec::new(), &contents, true, values).unwrap();
        volume::from_bytes(("A.nrrd", bytes), &Options::default()).unwrap()
    }

    #[test]
    fn large_volumes_are_thinned_and_say_so() {
        let whole = of_file(file(), 180).unwrap();
        assert!(!whole.notes.iter().any(|note| note.starts_with("volume:")));
        let values = whole.values.read().unwrap();
        assert!(values.iter().enumerate().all(|(n, v)| *v == n as f32));
        // 5 x 5 x 4 cells would do, and are one too many.
        let thin = of_file(file(), 99).unwrap();
        assert_eq!(
            thin.lattice.dims,
            Dims {
                ni: 5,
                nj: 3,
                nk: 4
            }
        );
        let told: Vec<_> = thin
            .notes
            .iter()
            .filter(|n| n.starts_with("volume:"))
            .collect();
        assert_eq!(told.len(), 1);
        assert!(
            told[0].contains("every 2nd sample along I, every 2nd sample along J is shown"),
            "{told:?}"
        );
        let values = thin.values.read().unwrap();
        for (n, value) in values.iter().enumerate() {
            let [i, j, k] = [2 * (n % 5), 2 * (n / 5 % 3), n / 15];
            assert_eq!(*value, (i + 9 * (j + 5 * k)) as f32);
        }
        let last = thin.lattice.place([4.0, 2.0, 3.0]);
        assert_eq!(last, DVec3::new(17.0, 14.0, 9.0));
    }

    #[test]
    fn names_that_every_grid_has_are_left_to_it() {
        let volume = of_file(file(), 180).unwrap();
        assert_eq!(volume.values.name(), "VALUE");
        assert!(
            volume
                .notes
                .iter()
                .any(|note| note.contains("are called Depth in the file"))
        );
    }

    #[test]
    fn ordinals() {
        let all = [1, 2, 3, 4, 11, 12, 22, 113].map(ordinal);
        assert_eq!(
            all,
            ["1st", "2nd", "3rd", "4th", "11th", "12th", "22nd", "113th"]
        );
    }
}
