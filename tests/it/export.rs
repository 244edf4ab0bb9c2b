//! What is exported is read back equal: cells, values, steps, units, in every format.

use std::path::{Path, PathBuf};
use std::process::Command;

use glam::DVec3;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use serde_json::{Value, json};
use strataray::case::{Case, Kind, load};
use strataray::export::{self, Contents, ExportError, Written};
use strataray::model::topology::Face;
use strataray::model::{CellIndex, Ijk, Spaces};
use strataray::parsers::roff::RoffFile;
use strataray::view::{View, look, resolve};

use crate::common;

fn open(path: &Path) -> Case {
    load::open(path).unwrap()
}

fn view(case: &Case, written: &Value) -> View {
    resolve(&look::opening(case, written).unwrap(), case).unwrap()
}

/// Names of the properties of the files.
fn of_files(case: &Case) -> Vec<String> {
    let all = case.properties.iter().filter(|p| p.kind != Kind::Derived);
    all.map(|p| p.name.clone()).collect()
}

fn write(
    case: &Case,
    view: Option<&View>,
    names: &[&str],
    steps: &[usize],
    path: &Path,
) -> Result<Written, ExportError> {
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    let contents = Contents::new(case, view, &names, steps)?;
    export::write(&contents, path, &|_| true)
}

fn all_steps(case: &Case) -> Vec<usize> {
    (0..case.steps.len()).collect()
}

/// What differs between two cases: geometry of all cells, active cells, units, and some properties at some steps.
fn differences(a: &Case, b: &Case, names: &[String], steps: &[[usize; 2]]) -> Vec<String> {
    let mut found = Vec::new();
    let mut note = |is_equal: bool, what: String| found.extend((!is_equal).then_some(what));
    let dims = a.grid.dims();
    note(dims == b.grid.dims(), "dims".into());
    note(
        a.grid.active_cells() == b.grid.active_cells(),
        "active".into(),
    );
    note(a.grid.map_axes() == b.grid.map_axes(), "map axes".into());
    note(
        a.about.length_unit == b.about.length_unit,
        "length unit".into(),
    );
    note(a.about.map_unit == b.about.map_unit, "map unit".into());
    if !found.is_empty() {
        return found;
    }
    let mut note = |is_equal: bool, what: String| found.extend((!is_equal).then_some(what));
    let ends = |case: &Case| -> Vec<_> {
        let pillars = case.grid.pillars().iter();
        pillars
            .flat_map(|p| [p.top, p.bottom])
            .map(|end| end.as_vec3())
            .collect()
    };
    note(ends(a) == ends(b), "pillars".into());
    let depths = |case: &Case| -> Vec<f32> {
        let cells = (0..dims.cells() as u32).map(|n| dims.ijk(CellIndex(n)));
        let of = |ijk| (0..8).map(move |c| case.grid.corner_depth(ijk, c) as f32);
        cells.flat_map(of).collect()
    };
    note(depths(a) == depths(b), "depths".into());
    for name in names {
        note(a.unit(name) == b.unit(name), format!("unit of {name}"));
        for [step_a, step_b] in steps {
            let fields = [a.field(name, *step_a).ok(), b.field(name, *step_b).ok()];
            note(fields[0] == fields[1], format!("{name} at {step_a}"));
        }
    }
    found
}

#[test]
fn ok_eclipse_files_read_back_equal() {
    for model in common::models() {
        let case = open(&model);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("COPY.EGRID");
        let names = of_files(&case);
        let given: Vec<&str> = names.iter().map(String::as_str).collect();
        let written = write(&case, None, &given, &all_steps(&case), &path).unwrap();
        assert_eq!((written.files.len(), &written.notes[..]), (3, &[][..]));
        let copy = open(&path);
        assert_eq!(copy.about.notes, [""; 0]);
        assert_eq!(copy.steps, case.steps);
        assert_eq!(of_files(&copy), names);
        assert_eq!(copy.connections, case.connections);
        let mut steps: Vec<_> = all_steps(&case).into_iter().map(|n| [n, n]).collect();
        assert_eq!(differences(&case, &copy, &names, &steps), [""; 0]);
        // The twin: another step has other values.
        steps.iter_mut().for_each(|pair| pair[1] = 0);
        assert!(!differences(&case, &copy, &names, &steps).is_empty());
    }
}

#[test]
fn ok_text_reads_back_equal_by_step() {
    let case = open(&common::sample());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("copy.grdecl");
    let names = ["PORO", "SATNUM", "SWAT", "PRESSURE"];
    write(&case, None, &names, &[3], &path).unwrap();
    let copy = open(&path);
    let names = names.map(str::to_owned);
    let differ = |copy: &Case, step| differences(&case, copy, &names[..3], &[[step, 0]]);
    assert_eq!(differ(&copy, 3), [""; 0]);
    assert_eq!(differ(&copy, 2), ["SWAT at 2"]);
    // Of several steps each has a file of its own, which is added to the grid.
    let written = write(&case, None, &["PORO", "SWAT"], &[2, 5], &path).unwrap();
    let ends = |file: &PathBuf| file.file_name().unwrap().to_str().unwrap().to_owned();
    let files: Vec<String> = written.files.iter().map(ends).collect();
    assert_eq!(
        files,
        ["copy.grdecl", "copy_0002.grdecl", "copy_0005.grdecl"]
    );
    for step in [2, 5] {
        let added = folder.path().join(format!("copy_000{step}.grdecl"));
        let copy = load::open_with(&path, &[added]).unwrap();
        let names = ["PORO", "SWAT"].map(str::to_owned);
        assert_eq!(differences(&case, &copy, &names, &[[step, 0]]), [""; 0]);
    }
}

#[test]
fn ok_decks_keep_their_digits() {
    // Coordinates that 32 bits do not have.
    let deck = "MAPAXES\n 0 1 0 0 1 0 /\nGRIDUNIT\n METRES /\nSPECGRID\n 1 1 1 1 F /\nCOORD\n \
        456789.123 5934567.891 0 456789.123 5934567.891 9 456799.123 5934567.891 0 456799.123 5934567.891 9\n \
        456789.123 5934577.891 0 456789.123 5934577.891 9 456799.123 5934577.891 0 456799.123 5934577.891 9 /\n\
        ZCORN\n 4*1234.5678 4*1244.5678 /\nPORO\n 0.25 /\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.grdecl");
    std::fs::write(&path, deck).unwrap();
    let case = open(&path);
    let again = folder.path().join("b.grdecl");
    write(&case, None, &["PORO"], &[], &again).unwrap();
    let copy = open(&again);
    assert_eq!(copy.grid.pillars(), case.grid.pillars());
    assert_eq!(copy.grid.depths(), case.grid.depths());
    // EGRID files have 32 bits.
    let egrid = folder.path().join("c.egrid");
    let written = write(&case, None, &["PORO"], &[], &egrid).unwrap();
    assert_eq!(written.files[1], folder.path().join("c.init"));
    let rounded = open(&egrid);
    assert_ne!(rounded.grid.pillars(), case.grid.pillars());
    assert_eq!(
        differences(&case, &rounded, &["PORO".into()], &[[0, 0]]),
        [""; 0]
    );
}

/// Where the corners of all cells lie on the map, z being the depth.
fn on_map(case: &Case) -> impl Fn(DVec3) -> DVec3 {
    let spaces = Spaces::new(case.grid.map_axes(), 1.0);
    move |place| spaces.map_from_world(spaces.world_from_grid.transform_point3(place))
}

#[test]
fn ok_roff_reads_back_on_the_map() {
    for model in common::models() {
        let case = open(&model);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("copy.roff");
        let last = case.steps.len() - 1;
        write(&case, None, &["PORO", "SATNUM", "SWAT"], &[0, last], &path).unwrap();
        let file = RoffFile::open(&path).unwrap();
        let read = file.grid().unwrap().unwrap().pillars();
        let dims = case.grid.dims();
        let depth = |n: usize| {
            let (ni, nj) = (dims.ni, dims.nj);
            let [x, y, z] = [n % (2 * ni), n / (2 * ni) % (2 * nj), n / (4 * ni * nj)];
            let ijk = Ijk {
                i: x / 2,
                j: y / 2,
                k: z / 2,
            };
            case.grid
                .corner_depth(ijk, x % 2 + 2 * (y % 2) + 4 * (z % 2))
        };
        for (n, found) in read.zcorn.iter().enumerate() {
            assert_eq!(*found, depth(n), "{}: {n}", model.display());
        }
        let map = on_map(&case);
        let ends = case.grid.pillars().iter().flat_map(|p| [p.top, p.bottom]);
        for (expected, found) in ends.zip(read.coord.chunks_exact(3)) {
            let apart = map(expected).distance(DVec3::from_slice(found));
            // Half a unit of 32 bits along each axis, for pillars some 60 km away from the origin.
            assert!(apart < 4e-3 || expected.x == 0.0, "{apart}");
        }
        let date = |n: usize| {
            case.steps[n]
                .date
                .split(' ')
                .next()
                .unwrap()
                .replace('-', "")
        };
        let dated = [0, last].map(|n| format!("SWAT_{}", date(n)));
        let parameters = file.parameters().unwrap();
        let names: Vec<&str> = parameters.iter().map(|p| p.name.as_str()).collect();
        assert_eq!(names, ["PORO", "SATNUM", &dated[0], &dated[1]]);
        assert!(parameters[1].is_discrete && !parameters[0].is_discrete);
        for (parameter, (name, step)) in
            parameters
                .iter()
                .zip([("PORO", 0), ("SATNUM", 0), ("SWAT", 0), ("SWAT", last)])
        {
            let field = case.field(name, step).unwrap();
            let values = file.values(parameter).unwrap();
            for (n, found) in values.iter().enumerate() {
                let expected = field.value(&case.grid, CellIndex(n as u32));
                assert!(expected.map_or(found.is_nan(), |v| f64::from(v) == *found));
            }
        }
    }
}

/// A part of the file, given the name of an array: its bytes, without their count.
fn appended<'a>(bytes: &'a [u8], name: &str) -> &'a [u8] {
    let start = bytes.windows(6).position(|w| w == b"raw\">\n").unwrap() + 7;
    let xml = std::str::from_utf8(&bytes[..start]).unwrap();
    let (_, rest) = xml.split_once(&format!("Name=\"{name}\"")).unwrap();
    let (_, rest) = rest.split_once("offset=\"").unwrap();
    let offset: usize = rest.split_once('"').unwrap().0.parse().unwrap();
    let data = &bytes[start + offset..];
    let length = u64::from_le_bytes(data[..8].try_into().unwrap()) as usize;
    &data[8..8 + length]
}

#[test]
fn ok_vtu_has_cells_points_and_values() {
    let case = open(&common::sample());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("copy.vtu");
    // The grid of the sample has faults: cells share points, but not across these.
    let seen = view(&case, &json!({"property": "SWAT", "filter": {"k": [2, 3]}}));
    let written = write(&case, Some(&seen), &["PORO", "SWAT"], &[1, 4], &path).unwrap();
    assert_eq!(written.files.len(), 3);
    let list = std::fs::read_to_string(path.with_extension("pvd")).unwrap();
    let days = case.steps[4].days;
    assert!(list.contains(&format!(
        "timestep=\"{days}\" part=\"0\" file=\"copy_0004.vtu\""
    )));
    let bytes = std::fs::read(folder.path().join("copy_0004.vtu")).unwrap();
    let drawn = seen.seen_cells(&case.grid);
    let count = drawn.iter().filter(|d| **d).count();
    let floats = |name: &str| -> Vec<f32> { bytemuck::pod_collect_to_vec(appended(&bytes, name)) };
    let values = case.field("SWAT", 4).unwrap();
    let expected = values.values().iter().zip(&drawn).filter(|(_, d)| **d);
    assert!(floats("SWAT").iter().eq(expected.map(|(v, _)| v)));
    let layers: Vec<i32> = bytemuck::pod_collect_to_vec(appended(&bytes, "K"));
    assert!(layers.len() == count && layers.iter().all(|k| [2, 3].contains(k)));
    let points: Vec<f64> = bytemuck::pod_collect_to_vec(appended(&bytes, "Points"));
    let corners: Vec<i64> = bytemuck::pod_collect_to_vec(appended(&bytes, "connectivity"));
    assert_eq!(corners.len(), 8 * count);
    assert!(points.len() / 3 > count && points.len() / 3 < 3 * count);
    let place = |n: i64| DVec3::from_slice(&points[3 * n as usize..][..3]);
    let map = on_map(&case);
    let dims = case.grid.dims();
    let cells = case.grid.active_cells().iter().zip(&drawn);
    let cells = cells.filter(|(_, d)| **d).map(|(cell, _)| dims.ijk(*cell));
    for (ijk, corners) in cells.zip(corners.chunks_exact(8)) {
        let mut sum = DVec3::ZERO;
        for corner in case.grid.hexahedron(ijk).0 {
            let at = map(corner) * DVec3::new(1.0, 1.0, -1.0);
            let nearest = corners.iter().map(|n| place(*n).distance(at));
            assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-6);
            sum += at;
        }
        // From the first corner along the axes of VTK: right-handed.
        let [a, b, d, e] = [0, 1, 3, 4].map(|n| place(corners[n]));
        assert!((b - a).cross(d - a).dot(e - a) >= 0.0, "{ijk:?}");
        let middle = corners.iter().map(|n| place(*n)).sum::<DVec3>();
        assert!(middle.distance(sum) < 1e-5);
    }
}

/// Rows of a CSV file without its heads.
fn rows(path: &Path) -> Vec<Vec<String>> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    assert_eq!(reader.headers().unwrap().len(), 10);
    let row = |row: csv::StringRecord| row.iter().map(str::to_owned).collect();
    reader.records().map(|r| row(r.unwrap())).collect()
}

#[test]
fn ok_tables_have_the_same_rows() {
    let case = open(&common::sample());
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let filter = json!({"k": "2-4", "properties": [{"name": "SWAT", "min": 0.5}]});
    let seen = view(
        &case,
        &json!({"property": "SWAT", "step": 3, "filter": filter}),
    );
    let names = ["PORO", "SWAT"];
    for name in ["a.csv", "a.parquet"] {
        write(&case, Some(&seen), &names, &[0, 3], &file(name)).unwrap();
    }
    let rows = rows(&file("a.csv"));
    let drawn = seen.seen_cells(&case.grid);
    let count = drawn.iter().filter(|d| **d).count();
    assert!(count > 100 && rows.len() == 3 * count, "{count}");
    let first = [&case.about.name, "global"].map(str::to_owned);
    let dims = case.grid.dims();
    for row in &rows {
        assert_eq!(row[..2], first);
        let ijk = [2, 3, 4].map(|n| row[n].parse::<usize>().unwrap());
        let cell = dims.cell(dims.one_based(ijk).unwrap());
        let step = row[6].parse::<usize>().ok();
        let date = step.map_or("", |n| &case.steps[n].date);
        assert_eq!(row[5], date);
        let value = case.field(&row[7], step.unwrap_or(0)).unwrap();
        assert_eq!(row[8], value.value(&case.grid, cell).unwrap().to_string());
        assert!(drawn[case.grid.active_index(cell).unwrap().0 as usize]);
        assert_eq!(row[9], case.unit(&row[7]));
    }
    let table = SerializedFileReader::new(std::fs::File::open(file("a.parquet")).unwrap()).unwrap();
    let texts = |row: parquet::record::Row| -> Vec<String> {
        let text = |field: &Field| match field {
            Field::Null => String::new(),
            Field::Str(text) => text.clone(),
            Field::Int(n) => n.to_string(),
            Field::Float(v) => v.to_string(),
            other => panic!("{other:?}"),
        };
        row.get_column_iter()
            .map(|(_, field)| text(field))
            .collect()
    };
    let of_parquet = table.get_row_iter(None).unwrap().map(|r| texts(r.unwrap()));
    assert!(of_parquet.eq(rows));
}

#[test]
fn ok_local_grids_are_in_tables_and_meshes_and_no_other_files() {
    let Some(model) = common::data("lgr_nnc/LGR_TESTMOD.EGRID") else {
        return;
    };
    let case = open(&model);
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    write(&case, None, &["PORO"], &[], &file("a.csv")).unwrap();
    let rows = rows(&file("a.csv"));
    let mut grids: Vec<&str> = rows.iter().map(|row| row[1].as_str()).collect();
    grids.sort_unstable();
    grids.dedup();
    assert_eq!(grids, ["LGR1", "LGR2", "global"]);
    write(&case, None, &["PORO"], &[], &file("a.vtu")).unwrap();
    let bytes = std::fs::read(file("a.vtu")).unwrap();
    let numbers: Vec<i32> = bytemuck::pod_collect_to_vec(appended(&bytes, "GRID"));
    let count = |grid: &str| rows.iter().filter(|row| row[1] == grid).count();
    let of = |number: i32| numbers.iter().filter(|n| **n == number).count();
    // Sectors of the radial grid are two cells each in space.
    let [global, cartesian, radial] = ["global", "LGR1", "LGR2"].map(count);
    assert_eq!([of(0), of(1), of(2)], [global, cartesian, 2 * radial]);
    // Files of one grid have all cells of the main one, those that are refined too.
    let written = write(&case, None, &["PORO"], &[], &file("A.EGRID")).unwrap();
    assert!(written.notes[0].starts_with("local grids are not written"));
    let copy = open(&file("A.EGRID"));
    assert_eq!(copy.grid.active_cells().len(), 30);
    let field = copy.field("PORO", 0).unwrap();
    assert!(count("global") < 30);
    for row in rows.iter().filter(|row| row[1] == "global") {
        let ijk = [2, 3, 4].map(|n| row[n].parse::<usize>().unwrap());
        let dims = copy.grid.dims();
        let cell = dims.cell(dims.one_based(ijk).unwrap());
        let value = field.value(&copy.grid, cell).unwrap();
        assert_eq!(row[8], value.to_string());
    }
}

#[test]
fn ok_undefined_values_are_left_out_or_marked() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let deck = "SPECGRID\n 2 1 1 1 F /\nCOORD\n 0 0 0 0 0 9 1 0 0 1 0 9 2 0 0 2 0 9\n \
        0 1 0 0 1 9 1 1 0 1 1 9 2 1 0 2 1 9 /\nZCORN\n 8*0 8*9 /\nPORO\n 0.25 1* /\n";
    std::fs::write(file("a.grdecl"), deck).unwrap();
    let case = open(&file("a.grdecl"));
    assert!(case.field("PORO", 0).unwrap().values()[1].is_nan());
    for name in ["b.grdecl", "B.EGRID"] {
        write(&case, None, &["PORO"], &[], &file(name)).unwrap();
        let copy = open(&file(name));
        let fields = [&case, &copy].map(|case| case.field("PORO", 0).unwrap());
        assert_eq!(fields[0], fields[1], "{name}");
    }
    write(&case, None, &["PORO"], &[], &file("b.csv")).unwrap();
    assert_eq!(rows(&file("b.csv")).len(), 1);
    write(&case, None, &["PORO"], &[], &file("b.vtu")).unwrap();
    let bytes = std::fs::read(file("b.vtu")).unwrap();
    let values: Vec<f32> = bytemuck::pod_collect_to_vec(appended(&bytes, "PORO"));
    assert!(values[0] == 0.25 && values[1].is_nan());
}

#[test]
fn ok_surfaces_have_hull_faults_and_wells() {
    let Some(reek) = common::data("reek/REEK.EGRID") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    for (model, wells) in [(common::sample(), 0..99), (reek, 8..9)] {
        let case = open(&model);
        let path = folder.path().join("a.glb");
        let scene = json!({"property": "SWAT", "step": "last", "filter": {"j": [5, 20]}});
        let seen = view(&case, &scene);
        write(&case, Some(&seen), &["SWAT"], &[], &path).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!(
            (&bytes[..4], word(4), word(8)),
            (&b"glTF"[..], 2, bytes.len())
        );
        let text = &bytes[20..20 + word(12)];
        let scene: Value = serde_json::from_slice(text).unwrap();
        let nodes = scene["nodes"].as_array().unwrap();
        let names: Vec<&str> = nodes.iter().map(|n| n["name"].as_str().unwrap()).collect();
        assert_eq!(names[..2], [&case.about.name, "hull"]);
        let of = |start: &str| names.iter().filter(|n| n.starts_with(start)).count();
        assert!(wells.contains(&of("well ")), "{names:?}");
        assert!(
            of("fault ") >= case.about.named_faults.len().min(1),
            "{names:?}"
        );
        let drawn = seen.seen_cells(&case.grid);
        let faces = case.grid.boundary_faces(&drawn);
        let hull = &scene["meshes"][nodes[1]["mesh"].as_u64().unwrap() as usize];
        let array = |name: &str| {
            let number = &hull["primitives"][0]["attributes"][name];
            &scene["accessors"][number.as_u64().unwrap() as usize]
        };
        assert_eq!(array("POSITION")["count"], json!(4 * faces.len()));
        let at = |array: &Value| {
            let view = &scene["bufferViews"][array["bufferView"].as_u64().unwrap() as usize];
            28 + text.len() + view["byteOffset"].as_u64().unwrap() as usize
        };
        // The first corner of the first face lies where it is in the world, and has the color of its value.
        let (cell, face): (_, Face) = faces[0];
        let corner = case.grid.hexahedron(cell).0[face.corners()[0][0]];
        let world = seen.world.spaces.world_from_grid.transform_point3(corner);
        let exact = |v: &Value| DVec3::from_array(serde_json::from_value(v.clone()).unwrap());
        let start = at(array("POSITION"));
        let local: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes[start..start + 12]);
        let local = DVec3::new(local[0].into(), local[1].into(), local[2].into());
        let found = exact(&nodes[0]["translation"]) + exact(&nodes[0]["scale"]) * local;
        // Both cases are in meters.
        assert_eq!(case.about.length_unit, "METRES");
        let expected = DVec3::new(world.x, world.z, -world.y);
        assert!(found.distance(expected) < 1e-2, "{found} {expected}");
        let active = case.grid.active_index(case.grid.dims().cell(cell)).unwrap();
        let value = seen.shown.cells.field.values()[active.0 as usize];
        let transfer = &seen.style.transfer;
        let srgb = transfer.srgb(transfer.position(f64::from(value)));
        let start = at(array("COLOR_0"));
        let linear: Vec<u16> = bytemuck::pod_collect_to_vec(&bytes[start..start + 8]);
        for (srgb, linear) in srgb.into_iter().zip(linear) {
            let expected = ((srgb + 0.055) / 1.055)
                .powf(2.4)
                .max(srgb / 12.92 * f64::from(srgb < 0.04));
            assert!((f64::from(linear) / 65535.0 - expected).abs() < 1e-3);
        }
    }
}

#[test]
fn ok_names_are_cut_and_said() {
    let case = open(&common::sample());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.grdecl");
    let names = ["THICKNESS", "SWAT-SWAT@0", "ACTNUM"];
    let written = write(&case, None, &names, &[4], &path).unwrap();
    let notes = [
        "THICKNESS is written as THICKNES",
        "SWAT-SWAT@0 is written as D_SWAT_S",
        "ACTNUM is written as ACTNUM_",
    ];
    assert_eq!(written.notes, notes);
    let copy = open(&path);
    for (name, cut) in [("THICKNESS", "THICKNES"), ("SWAT-SWAT@0", "D_SWAT_S")] {
        let fields = [(&case, name, 4), (&copy, cut, 0)];
        let [a, b] = fields.map(|(case, name, step)| case.field(name, step).unwrap());
        assert_eq!(a, b);
    }
    // Other formats keep them.
    let path = folder.path().join("a.roff");
    let written = write(&case, None, &names, &[4], &path).unwrap();
    assert_eq!(written.notes, [""; 0]);
    let names = ["SWAT-SWAT@0", "SWAT-SWAT@1"];
    let path = folder.path().join("b.egrid");
    let error = write(&case, None, &names, &[4], &path).unwrap_err();
    assert!(
        error.to_string().contains("would both be D_SWAT_S"),
        "{error}"
    );
}

#[test]
fn err_nothing_is_left_of_what_fails() {
    let folder = tempfile::tempdir().unwrap();
    let sample = common::copy_of_sample(folder.path());
    let case = open(&sample);
    let names = || -> Vec<_> {
        let mut names: Vec<_> = std::fs::read_dir(folder.path())
            .unwrap()
            .map(|e| e.unwrap().file_name())
            .collect();
        names.sort();
        names
    };
    let before = names();
    for (_, ending, _) in export::Format::ALL {
        let path = folder.path().join(format!("new.{ending}"));
        let seen = view(&case, &json!({"property": "SWAT"}));
        let properties = ["PORO", "SWAT"].map(str::to_owned);
        let contents = Contents::new(&case, Some(&seen), &properties, &[0, 1]).unwrap();
        let canceled = export::write(&contents, &path, &|part| part < 0.6);
        assert!(matches!(canceled, Err(ExportError::Canceled)), "{ending}");
        assert_eq!(names(), before, "{ending}");
    }
    // Nor are the case's own files replaced, or what is beside them taken for a part of a new case.
    let length = sample.metadata().unwrap().len();
    let error = write(&case, None, &["SWAT"], &[0], &sample).unwrap_err();
    assert!(matches!(error, ExportError::Source(_)), "{error}");
    std::fs::write(folder.path().join("OLD.UNRST"), "old").unwrap();
    let error = write(
        &case,
        None,
        &["PORO"],
        &[],
        &folder.path().join("OLD.EGRID"),
    )
    .unwrap_err();
    assert!(error.to_string().contains("OLD.UNRST is left"), "{error}");
    assert_eq!(
        (names().len(), sample.metadata().unwrap().len()),
        (before.len() + 1, length)
    );
}

/// Runs the command on the sample; whether it worked, what it printed, and what it said.
fn run(arguments: &[&str], output: &Path) -> (bool, String, String) {
    let made = Command::new(env!("CARGO_BIN_EXE_strataray"))
        .arg("export")
        .arg(common::sample())
        .args(arguments)
        .arg("-o")
        .arg(output)
        .output()
        .unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (made.status.success(), text(made.stdout), text(made.stderr))
}

#[test]
fn ok_the_command_writes_steps_and_the_cells_of_a_scene() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let case = open(&common::sample());
    std::fs::write(file("scene.json"), r#"{"filter": {"k": [1, 1]}}"#).unwrap();
    let scene = file("scene.json");
    let scene = ["--scene", scene.to_str().unwrap()];
    let date = case.steps[1].date.as_str();
    let steps = format!("last, {date},3..4");
    let with = ["--property", "swat", "PORO", "--steps", &steps];
    let (ok, printed, said) = run(&[&with[..], &scene].concat(), &file("a.csv"));
    assert!(ok, "{said}");
    assert_eq!(printed.trim(), file("a.csv").to_str().unwrap());
    let rows = rows(&file("a.csv"));
    let top = case
        .grid
        .active_cells()
        .iter()
        .filter(|c| case.grid.dims().ijk(**c).k == 0);
    assert_eq!(rows.len(), 5 * top.count());
    let last = (case.steps.len() - 1).to_string();
    let mut steps: Vec<&str> = rows.iter().map(|row| row[6].as_str()).collect();
    steps.dedup();
    assert_eq!(steps, ["", "1", "3", "4", &last]);
    let (ok, _, said) = run(&["--property", "SOIL"], &file("a.glb"));
    assert!(ok && file("a.glb").exists(), "{said}");
}

#[test]
fn err_the_command_says_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("none");
    for (arguments, name, words) in [
        (
            &["--property", "PORO"][..],
            "a.obj",
            ".vtu, .csv, .parquet, .glb",
        ),
        (
            &["--property", "NOPE"],
            "a.roff",
            "there is no property NOPE",
        ),
        (&[], "a.csv", "--property"),
        (
            &["--property", "SWAT", "--steps", "99"],
            "a.csv",
            "no step 99",
        ),
        (
            &["--property", "SWAT", "--steps", "0,1"],
            "a.glb",
            "one step",
        ),
        (&["--property", "SWAT"], "none/a.csv", "cannot write"),
        (
            &["--scene", missing.to_str().unwrap()],
            "a.vtu",
            "cannot read",
        ),
    ] {
        let (ok, _, said) = run(arguments, &folder.path().join(name));
        assert!(!ok && said.contains(words), "{arguments:?} {name}: {said}");
        assert_eq!(said.lines().count(), 1, "{said}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

/// What Python with xtgeo, resfo, pyvista and pyarrow says of a case that is exported; `None` where there is none, which
/// the variable STRATARAY_PYTHON names.
fn read_by_others(case: &Path) -> Option<String> {
    let python = std::env::var_os("STRATARAY_PYTHON").unwrap_or_else(|| "python3".into());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/export.py");
    let made = Command::new(&python)
        .arg(script)
        .arg(env!("CARGO_BIN_EXE_strataray"))
        .arg(case)
        .args(["PORO", "SWAT"])
        .output();
    let Ok(made) = made else {
        eprintln!("SKIPPED: there is no {}", python.display());
        return None;
    };
    let printed = String::from_utf8_lossy(&made.stdout).into_owned();
    if made.status.code() == Some(77) {
        eprintln!("SKIPPED: {printed}");
        return None;
    }
    let said = String::from_utf8_lossy(&made.stderr);
    assert!(made.status.success(), "{}: {printed}{said}", case.display());
    Some(printed)
}

#[test]
fn ok_other_programs_read_the_same() {
    let reek = common::data("reek/REEK.EGRID");
    for case in [common::sample()].into_iter().chain(reek) {
        let Some(printed) = read_by_others(&case) else {
            return;
        };
        assert!(printed.lines().count() > 30, "{printed}");
    }
}
