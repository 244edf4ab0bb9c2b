//! VTU: cells as hexahedra of VTK, in XML with the arrays behind it as they are in memory.
//!
//! x is east, y north and z up, all of them in the unit of the map. Cells share the points that they share in the grid:
//! not across faults. Corners are numbered so that volumes are positive.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::num::NonZero;
use std::path::Path;

use glam::DVec3;

use super::contents::Contents;
use super::error::{ExportError, failed};
use super::of_step;
use super::output::Output;

/// Number of hexahedra among the kinds of cells of VTK.
const HEXAHEDRON: u8 = 12;
/// Corners of a cell, number `di + 2 dj + 4 dk`, in the order of VTK: around the upper face, then around the lower one.
const AROUND: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];

/// Writes one file, or where several steps differ one for each and a list of them.
pub(super) fn write(
    contents: &Contents<'_>,
    path: &Path,
    output: &mut Output<'_>,
) -> Result<(), ExportError> {
    let mesh = Mesh::of(contents);
    let steps = contents.changing_steps();
    let arrays = 8 + contents.properties.len();
    output.expect(arrays * contents.count() * steps.len().max(1));
    if let [] | [_] = steps {
        return write_step(contents, &mesh, steps.first().copied(), path, output);
    }
    for step in steps {
        write_step(contents, &mesh, Some(*step), &of_step(path, *step), output)?;
    }
    let list = path.with_extension("pvd");
    output.write(&list, |mut file| {
        file.write_all(list_of(contents, path, steps).as_bytes())
    })
}

/// The list of the files of steps, by days.
fn list_of(contents: &Contents<'_>, path: &Path, steps: &[usize]) -> String {
    let mut text =
        String::from("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\">\n<Collection>\n");
    for step in steps {
        let file = of_step(path, *step);
        let file = file.file_name().unwrap_or_default().to_string_lossy();
        let days = days(contents, *step);
        let file = escaped(&file);
        text += &format!("<DataSet timestep=\"{days}\" part=\"0\" file=\"{file}\"/>\n");
    }
    text + "</Collection>\n</VTKFile>\n"
}

fn days(contents: &Contents<'_>, step: usize) -> f64 {
    contents.case.steps.get(step).map_or(0.0, |s| s.days)
}

fn write_step(
    contents: &Contents<'_>,
    mesh: &Mesh,
    step: Option<usize>,
    path: &Path,
    output: &mut Output<'_>,
) -> Result<(), ExportError> {
    let mut cells = Arrays::default();
    for (axis, name) in ["I", "J", "K"].into_iter().enumerate() {
        let grid = contents.grid();
        let numbers = contents
            .cells()
            .map(|at| grid.cell_name(at).ijk[axis] as i32);
        cells.add(name, 1, &numbers.collect::<Vec<i32>>());
    }
    if contents.grid().patches().len() > 1 {
        // 0 is the main grid, local ones follow in the order of the file.
        let grids = contents.cells().map(|at| contents.grid().patch_of(at));
        let numbers = grids.map(|number| number.unwrap_or(0) as i32);
        cells.add("GRID", 1, &numbers.collect::<Vec<i32>>());
    }
    for property in &contents.properties {
        let values = contents.values(&property.name, step.unwrap_or_default())?;
        if let Some(values) = values {
            cells.add(&property.name, 1, &values);
        }
        output.advance(contents.count())?;
    }
    let file = output.file(path)?;
    let about = about(contents, step);
    write_file(file, &about, mesh, cells).map_err(failed(path))?;
    output.advance(8 * contents.count())
}

/// What the file is, for people, and its time.
fn about(contents: &Contents<'_>, step: Option<usize>) -> String {
    let about = &contents.case.about;
    let mut units: Vec<String> = vec![format!("coordinates {}", contents.map_unit())];
    let named = contents.properties.iter().filter(|p| !p.unit.is_empty());
    units.extend(named.map(|p| format!("{} {}", p.name, p.unit)));
    let text = format!(
        "{}: x east, y north, z up (minus depth). Units: {}",
        about.name,
        units.join(", ")
    );
    // Two hyphens end a comment.
    let mut xml = format!("<!-- {} -->\n", text.replace("--", "- -"));
    if let Some(step) = step {
        let days = days(contents, step);
        xml += &format!(
            "<FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">{days}</DataArray>\n</FieldData>\n"
        );
    }
    xml
}

fn write_file(file: File, about: &str, mesh: &Mesh, cells: Arrays) -> io::Result<()> {
    let mut arrays = cells;
    let cell_data = std::mem::take(&mut arrays.xml);
    arrays.add("Points", 3, mesh.points.as_flattened());
    let points = std::mem::take(&mut arrays.xml);
    arrays.add("connectivity", 1, &mesh.corners);
    let count = mesh.corners.len() / 8;
    arrays.add(
        "offsets",
        1,
        &(1..=count).map(|n| 8 * n as i64).collect::<Vec<i64>>(),
    );
    arrays.add("types", 1, &vec![HEXAHEDRON; count]);
    let mut out = BufWriter::new(file);
    write!(
        out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
         <UnstructuredGrid>\n{about}<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{count}\">\n\
         <CellData>\n{cell_data}</CellData>\n<Points>\n{points}</Points>\n<Cells>\n{}</Cells>\n\
         </Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_",
        mesh.points.len(),
        arrays.xml
    )?;
    out.write_all(&arrays.bytes)?;
    out.write_all(b"\n</AppendedData>\n</VTKFile>\n")?;
    out.flush()
}

/// Arrays that stand behind the XML, and the XML that says where.
#[derive(Default)]
struct Arrays {
    xml: String,
    bytes: Vec<u8>,
}

impl Arrays {
    fn add<T: Number>(&mut self, name: &str, components: usize, values: &[T]) {
        let (kind, name, offset) = (T::KIND, escaped(name), self.bytes.len());
        // Writing to a string does not fail.
        let _ = writeln!(
            self.xml,
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\"/>"
        );
        let length = size_of_val(values) as u64;
        self.bytes.extend(length.to_le_bytes());
        values.iter().for_each(|v| v.append(&mut self.bytes));
    }
}

/// A number that VTK has.
trait Number: Copy {
    const KIND: &'static str;
    fn append(self, bytes: &mut Vec<u8>);
}

macro_rules! number {
    ($number:ty, $kind:literal) => {
        impl Number for $number {
            const KIND: &'static str = $kind;
            fn append(self, bytes: &mut Vec<u8>) {
                bytes.extend(self.to_le_bytes());
            }
        }
    };
}
number!(u8, "UInt8");
number!(i32, "Int32");
number!(i64, "Int64");
number!(f32, "Float32");
number!(f64, "Float64");

fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}

/// Points, and eight of them for each cell.
struct Mesh {
    points: Vec<[f64; 3]>,
    corners: Vec<i64>,
}

impl Mesh {
    fn of(contents: &Contents<'_>) -> Self {
        let grid = contents.grid();
        let map = contents.map_from_grid();
        // Left-handed cells begin with their lower face.
        let is_turned = grid.signed_bulk_volume() * map.matrix3.determinant() < 0.0;
        let order = match is_turned {
            true => std::array::from_fn(|n| AROUND[(n + 4) % 8]),
            false => AROUND,
        };
        // Of each depth of the grid the number of its point, once it has one.
        let mut numbers: Vec<Option<NonZero<u32>>> = vec![None; grid.depths().len()];
        let mut points = Vec::new();
        let mut corners = Vec::with_capacity(8 * contents.count());
        for ijk in contents.cells() {
            let places = grid.hexahedron(ijk).0;
            corners.extend(order.map(|corner| {
                let number = &mut numbers[grid.corner_entry(ijk, corner)];
                let known = number.get_or_insert_with(|| {
                    let place: DVec3 = map.transform_point3(places[corner]);
                    points.push(place.to_array());
                    NonZero::<u32>::MIN.saturating_add(points.len() as u32 - 1)
                });
                i64::from(known.get()) - 1
            }));
        }
        Self { points, corners }
    }
}
