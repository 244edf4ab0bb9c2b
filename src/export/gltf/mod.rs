//! glTF: hull, faults and wells of a view as meshes with colors.
//!
//! Lengths are meters, y is up and z south. The root node has all else below it: its translation is the origin of the
//! coordinates on the map, and its scale the vertical exaggeration of the view, so that 1 there gives true proportions.

mod buffer;
mod tube;

use std::path::Path;

use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use strataray_parsers::units::LengthUnit;

use self::buffer::{Buffer, Mesh};
use super::contents::Contents;
use super::error::ExportError;
use super::output::Output;
use crate::model::topology::Face;
use crate::model::{Grid, Ijk};
use crate::view::View;
use crate::view::surfaces::fault_color;

/// Corners of the two triangles of a face, in the order of [`Face::corners`].
const TRIANGLES: [usize; 6] = [0, 1, 3, 0, 3, 2];

/// Writes the surfaces of the view, at its step and in the colors of its property.
pub(super) fn write(
    contents: &Contents<'_>,
    path: &Path,
    output: &mut Output<'_>,
) -> Result<(), ExportError> {
    let view = contents.view.ok_or(ExportError::NoView)?;
    output.expect(4);
    let space = Space::of(contents, view);
    let mut buffer = Buffer::default();
    let mut nodes = vec![root(contents, view, &space)];
    let grid = contents.grid();
    let hull = hull(grid, view, contents.drawn(), &space);
    add(&mut nodes, "hull", &hull, &mut buffer);
    output.advance(1)?;
    for (name, mesh) in faults(contents, view, &space) {
        add(&mut nodes, &format!("fault {name}"), &mesh, &mut buffer);
    }
    output.advance(1)?;
    for (number, head) in view.shown.wells.heads.iter().enumerate() {
        let capsules = view.shown.wells.capsules.iter();
        let own = capsules.filter(|capsule| capsule.well == number);
        let mut mesh = Mesh::default();
        own.for_each(|capsule| tube::add(&mut mesh, capsule, &space));
        add(
            &mut nodes,
            &format!("well {}", head.name),
            &mesh,
            &mut buffer,
        );
    }
    output.advance(1)?;
    output.write(path, |file| buffer.write(file, nodes))
}

/// Adds a node below the root, unless it has nothing.
fn add(nodes: &mut Vec<Value>, name: &str, mesh: &Mesh, buffer: &mut Buffer) {
    if !mesh.is_empty() {
        let mesh = buffer.add(name, mesh);
        nodes.push(json!({"name": name, "mesh": mesh}));
    }
}

fn root(contents: &Contents<'_>, view: &View, space: &Space) -> Value {
    let exaggeration = view.world.vertical_exaggeration;
    let [x, y, z] = space.local(space.origin).to_array();
    json!({
        "name": contents.case.about.name,
        "translation": [x, exaggeration * y, z],
        "scale": [1.0, exaggeration, 1.0],
        "extras": {
            // East, north and up, before the exaggeration.
            "origin_meters": space.true_place(space.origin).to_array(),
            "vertical_exaggeration": exaggeration,
            "property": view.shown.property,
            "unit": contents.case.unit(&view.shown.property),
            "range": view.style.transfer.true_range(),
            "step": view.shown.step,
        },
    })
}

/// From world space to that of the file.
struct Space {
    /// In world space.
    origin: DVec3,
    exaggeration: f64,
    /// Of a length unit of world space.
    meters: f64,
}

impl Space {
    fn of(contents: &Contents<'_>, view: &View) -> Self {
        let unit = LengthUnit::from_name(&contents.case.about.length_unit);
        let [low, high] = view.world.bounds;
        Self {
            origin: (0.5 * (low + high)).round(),
            exaggeration: view.world.vertical_exaggeration,
            meters: unit.map_or(1.0, LengthUnit::meters),
        }
    }

    /// East, north and up in meters.
    fn true_place(&self, world: DVec3) -> DVec3 {
        self.meters * DVec3::new(world.x, world.y, world.z / self.exaggeration)
    }

    /// A way in world space by the axes of the file.
    fn local(&self, way: DVec3) -> DVec3 {
        let [east, north, up] = self.true_place(way).to_array();
        DVec3::new(east, up, -north)
    }

    fn position(&self, world: DVec3) -> Vec3 {
        self.local(world - self.origin).as_vec3()
    }

    /// A normal in the file, of one in world space.
    fn normal(&self, world: DVec3) -> Vec3 {
        // Normals scale the other way.
        let file = DVec3::new(world.x, self.exaggeration * world.z, -world.y);
        file.normalize_or(DVec3::Y).as_vec3()
    }
}

/// The boundary faces of the drawn cells, each in the color of its cell's value.
fn hull(grid: &Grid, view: &View, drawn: &[bool], space: &Space) -> Mesh {
    let mut mesh = Mesh::default();
    let values = view.shown.cells.field.values();
    let transfer = &view.style.transfer;
    for (cell, face) in grid.boundary_faces(drawn) {
        let Some(active) = grid.active_index(grid.dims().cell(cell)) else {
            continue;
        };
        let position = transfer.position(f64::from(values[active.0 as usize]));
        let color = transfer.srgb(position);
        add_face(&mut mesh, (grid, view, space), (cell, face), color);
    }
    mesh
}

/// Faces of faults by name, in the order in which they are first met; those without a name last.
fn faults(contents: &Contents<'_>, view: &View, space: &Space) -> Vec<(String, Mesh)> {
    let named = &contents.case.about.named_faults;
    let mut meshes: Vec<Mesh> = (0..=named.len()).map(|_| Mesh::default()).collect();
    for (cell, face, fault) in view.fault_faces(contents.grid()) {
        let mesh = &mut meshes[fault.unwrap_or(named.len()).min(named.len())];
        let of = (contents.grid(), view, space);
        add_face(mesh, of, (cell, face), fault_color(fault));
    }
    let names = named.iter().map(|fault| fault.name.clone());
    names
        .chain(["without a name".to_owned()])
        .zip(meshes)
        .collect()
}

fn add_face(
    mesh: &mut Mesh,
    (grid, view, space): (&Grid, &View, &Space),
    (cell, face): (Ijk, Face),
    color: [f64; 3],
) {
    let corners = grid.hexahedron(cell).0;
    let world = view.world.spaces.world_from_grid;
    let first = mesh.positions.len() as u32;
    for corner in face.corners()[0] {
        let place = world.transform_point3(corners[corner]);
        mesh.positions.push(space.position(place));
        mesh.colors.push(buffer::color(color));
    }
    mesh.indices.extend(TRIANGLES.map(|n| first + n as u32));
}
