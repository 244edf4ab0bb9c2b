//! A package: its objects that are read, and the files that their arrays are in.

use std::fmt;
use std::path::{Path, PathBuf};

use roxmltree::Document;

use super::crs::Crs;
use super::grid::{GridObject, IjkGrid};
use super::hdf5::Files;
use super::parts::{Object, Parts, document};
use super::property::{Property, PropertyClass, TimeSeries};
use super::xml::{self, Part};
use crate::bytes::FileBytes;
use crate::error::{At, ErrorKind, ParseError};

/// Grids of other kinds, which are named where they are not read.
const OTHER_GRIDS: [&str; 5] = [
    "GpGridRepresentation",
    "TruncatedIjkGridRepresentation",
    "UnstructuredColumnLayerGridRepresentation",
    "UnstructuredGridRepresentation",
    "UnstructuredColumnLayerTruncatedGridRepresentation",
];

/// A package with its objects; arrays are read when they are asked for.
pub struct Package {
    path: PathBuf,
    grids: Vec<GridPart>,
    systems: Vec<Crs>,
    properties: Vec<Property>,
    series: Vec<TimeSeries>,
    not_read: Vec<String>,
    files: Files,
}

/// A grid of a package.
#[derive(Debug)]
pub struct GridPart {
    /// Name of the object.
    pub uuid: String,
    /// Title.
    pub title: String,
    name: String,
    object: GridObject,
}

impl GridPart {
    /// Cells along i, j and k.
    pub fn dims(&self) -> [usize; 3] {
        self.object.dims()
    }

    /// Whether it has a geometry; [`Package::geometry`] fails without.
    pub fn has_geometry(&self) -> bool {
        self.object.has_geometry()
    }

    /// Title of the grid that this one is a window of, as a local refinement is.
    pub fn parent(&self) -> Option<&str> {
        self.object.parent.as_deref()
    }
}

impl fmt::Debug for Package {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [grids, properties] = [self.grids.len(), self.properties.len()];
        let path = self.path.display();
        write!(f, "Package({path}, {grids} grids, {properties} properties)")
    }
}

impl Package {
    /// Opens a package and the HDF5 files that it names, beside it.
    ///
    /// # Errors
    /// When the file is no package, is damaged, or is of another version of RESQML. What is wrong with the HDF5 file is
    /// told once an array is asked for.
    pub fn open(path: &Path) -> Result<Self, ParseError> {
        let find = |target: &str| FileBytes::open(&beside(path, target));
        Self::read(&FileBytes::open(path)?, &find)
    }

    /// As [`Self::open`], of files that are in memory; those with arrays are found by the ends of their paths.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn from_bytes(
        package: impl Into<FileBytes>,
        files: &[FileBytes],
    ) -> Result<Self, ParseError> {
        let package = package.into();
        let find = |target: &str| {
            let found = files.iter().find(|file| file.path().ends_with(target));
            found.cloned().ok_or_else(|| {
                let path = Path::new(target);
                ParseError::of(ErrorKind::NotFound, path, At::File, "", "was not given")
            })
        };
        Self::read(&package, &find)
    }

    /// The path that was opened, or the name that was given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The files with arrays that were opened.
    pub fn array_files(&self) -> impl Iterator<Item = &Path> {
        self.files.paths()
    }

    /// The grids in the order of the package.
    pub fn grids(&self) -> &[GridPart] {
        &self.grids
    }

    /// The properties in the order of the package, those of all grids.
    pub fn properties(&self) -> &[Property] {
        &self.properties
    }

    /// The time series.
    pub fn series(&self) -> &[TimeSeries] {
        &self.series
    }

    /// One sentence for each object that could be of interest and is not read.
    pub fn not_read(&self) -> &[String] {
        &self.not_read
    }

    /// The reference system of a grid.
    ///
    /// # Errors
    /// When the package does not have it: it may be one in time.
    pub fn crs(&self, grid: &GridPart) -> Result<&Crs, ParseError> {
        let found = self.systems.iter().find(|crs| crs.uuid == grid.object.crs);
        found.ok_or_else(|| {
            let message = "its reference system is none in depth (LocalDepth3dCrs) of this package; a grid in time is not read";
            self.part(&grid.name).error(ErrorKind::Unsupported, message)
        })
    }

    /// Reads the geometry of a grid.
    ///
    /// # Errors
    /// When the grid has none, or of a form that is not read, or an array is missing or damaged.
    pub fn geometry(&self, grid: &GridPart) -> Result<IjkGrid, ParseError> {
        grid.object.load(self.part(&grid.name), &self.files)
    }

    /// The values of a property on a grid of `dims` cells: i fastest, then j, then k, NaN where there is none.
    ///
    /// # Errors
    /// When the array is missing or damaged, or does not have one value for each cell.
    pub fn values(
        &self,
        property: &Property,
        [ni, nj, nk]: [usize; 3],
    ) -> Result<Vec<f64>, ParseError> {
        let count = ni.saturating_mul(nj).saturating_mul(nk);
        property.values.numbers(&self.files, count)
    }

    fn part<'a>(&'a self, name: &'a str) -> Part<'a> {
        Part {
            path: &self.path,
            name,
        }
    }

    fn read(
        file: &FileBytes,
        find: &dyn Fn(&str) -> Result<FileBytes, ParseError>,
    ) -> Result<Self, ParseError> {
        let path = file.path();
        let mut parts = Parts::open(file)?;
        let mut package = Self {
            path: path.to_owned(),
            grids: Vec::new(),
            systems: Vec::new(),
            properties: Vec::new(),
            series: Vec::new(),
            not_read: Vec::new(),
            files: Files::new(path),
        };
        for object in parts.objects()? {
            package.add(&mut parts, object, find)?;
        }
        Ok(package)
    }

    /// Reads an object; of those that a grid can do without it is noted why one is not read.
    fn add(
        &mut self,
        parts: &mut Parts<'_>,
        object: Object,
        find: &dyn Fn(&str) -> Result<FileBytes, ParseError>,
    ) -> Result<(), ParseError> {
        let class = match object.kind.as_str() {
            "IjkGridRepresentation" => return self.add_grid(parts, object),
            "LocalDepth3dCrs" => {
                let text = parts.text(&object.name)?;
                let document = document(&self.path, &object.name, &text)?;
                let crs = Crs::read(self.part(&object.name), document.root_element())?;
                self.systems.push(crs);
                return Ok(());
            }
            "EpcExternalPartReference" => return self.add_file(parts, &object, find),
            "ContinuousProperty" => PropertyClass::Continuous,
            "DiscreteProperty" => PropertyClass::Discrete,
            "CategoricalProperty" => PropertyClass::Categorical,
            "TimeSeries" => {
                let text = parts.text(&object.name)?;
                let document = document(&self.path, &object.name, &text)?;
                self.series.push(TimeSeries::read(document.root_element()));
                return Ok(());
            }
            kind if OTHER_GRIDS.contains(&kind) => {
                let sentence = format!("{} is a {kind}, which is not read", object.name);
                self.not_read.push(sentence);
                return Ok(());
            }
            _ => return Ok(()),
        };
        let text = parts.text(&object.name)?;
        let part = self.part(&object.name);
        let read = document(&self.path, &object.name, &text).map(|document: Document<'_>| {
            let root = document.root_element();
            let named = |error: ParseError| {
                let title = xml::title(root);
                format!("the property {title:?} was not read: {error}")
            };
            Property::read(part, root, class).map_err(named)
        });
        match read.unwrap_or_else(|error| Err(error.to_string())) {
            Ok(property) => self.properties.push(property),
            Err(why) => self.not_read.push(why),
        }
        Ok(())
    }

    fn add_grid(&mut self, parts: &mut Parts<'_>, object: Object) -> Result<(), ParseError> {
        let part = self.part(&object.name);
        if !object.version.starts_with("2.0") {
            let message = format!(
                "is of RESQML {}: only 2.0.1 is read; write the package as that, or the grid as EGRID or ROFF",
                object.version
            );
            return Err(part.error(ErrorKind::Unsupported, message));
        }
        let text = parts.text(&object.name)?;
        let document = document(&self.path, &object.name, &text)?;
        let root = document.root_element();
        let grid = GridPart {
            uuid: xml::uuid(root),
            title: xml::title(root),
            object: GridObject::read(part, root)?,
            name: object.name,
        };
        self.grids.push(grid);
        Ok(())
    }

    /// The file that an object stands for.
    fn add_file(
        &mut self,
        parts: &mut Parts<'_>,
        object: &Object,
        find: &dyn Fn(&str) -> Result<FileBytes, ParseError>,
    ) -> Result<(), ParseError> {
        let text = parts.text(&object.name)?;
        let document = document(&self.path, &object.name, &text)?;
        let proxy = xml::uuid(document.root_element());
        for target in parts.external(&object.name)? {
            self.files.add(proxy.clone(), find(&target));
        }
        Ok(())
    }
}

/// The file that a package names: beside it, whatever folder it was once in; else by the name of the package.
fn beside(package: &Path, target: &str) -> PathBuf {
    let target = target.strip_prefix("file:///").unwrap_or(target);
    let name = target.rsplit(['/', '\\']).next().unwrap_or(target);
    let places = [package.with_file_name(target), package.with_file_name(name)];
    let renamed = package.with_extension("h5");
    match places.iter().find(|place| place.is_file()) {
        Some(place) => place.clone(),
        None if renamed.is_file() => renamed,
        None => places[0].clone(),
    }
}
