//! The binary container of glTF: JSON, and one buffer behind it.

use std::io::{self, BufWriter, Write};

use glam::Vec3;
use serde_json::{Value, json};

/// Types of numbers, and what buffers are for, as glTF numbers them.
const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// Triangles, with a color at each corner, and normals where they are not those of the triangles.
#[derive(Default)]
pub(super) struct Mesh {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub colors: Vec<[u16; 4]>,
    pub indices: Vec<u32>,
}

impl Mesh {
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }
}

/// A color of glTF, linear in 16 bits, of one in sRGB.
pub(super) fn color(srgb: [f64; 3]) -> [u16; 4] {
    let whole = |v: f64| (v.clamp(0.0, 1.0) * f64::from(u16::MAX)).round() as u16;
    let [r, g, b] = srgb.map(|v| {
        let linear = match v <= 0.040_45 {
            true => v / 12.92,
            false => ((v + 0.055) / 1.055).powf(2.4),
        };
        whole(linear)
    });
    [r, g, b, u16::MAX]
}

/// Meshes in the making.
#[derive(Default)]
pub(super) struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
}

impl Buffer {
    /// Adds a mesh and gives its number.
    pub fn add(&mut self, name: &str, mesh: &Mesh) -> usize {
        let points = |all: &[Vec3]| -> Vec<u8> {
            let numbers = all.iter().flat_map(Vec3::to_array);
            numbers.flat_map(f32::to_le_bytes).collect()
        };
        let start = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let bounds = mesh.positions.iter();
        let [low, high] = bounds.fold(start, |[a, b], p| [a.min(*p), b.max(*p)]);
        let kind = json!({"type": "VEC3", "componentType": FLOAT});
        let mut position = kind.clone();
        position["min"] = json!(low.to_array());
        position["max"] = json!(high.to_array());
        let mut attributes = json!({});
        attributes["POSITION"] = self.accessor(points(&mesh.positions), position, VERTICES);
        if !mesh.normals.is_empty() {
            attributes["NORMAL"] = self.accessor(points(&mesh.normals), kind, VERTICES);
        }
        let colors = mesh.colors.as_flattened().iter();
        let colors = colors.flat_map(|v| v.to_le_bytes()).collect();
        let kind = json!({"type": "VEC4", "componentType": UNSIGNED_SHORT, "normalized": true});
        attributes["COLOR_0"] = self.accessor(colors, kind, VERTICES);
        let indices = mesh.indices.iter().flat_map(|v| v.to_le_bytes()).collect();
        let kind = json!({"type": "SCALAR", "componentType": UNSIGNED_INT});
        let indices = self.accessor(indices, kind, INDICES);
        let primitive = json!({"attributes": attributes, "indices": indices, "material": 0});
        self.meshes
            .push(json!({"name": name, "primitives": [primitive]}));
        self.meshes.len() - 1
    }

    /// Adds an array, whose number it gives; all are made of 4-byte parts.
    fn accessor(&mut self, bytes: Vec<u8>, mut kind: Value, target: u32) -> Value {
        let size = match (kind["type"].as_str(), kind["componentType"].as_u64()) {
            (Some("VEC3"), _) => 12,
            (Some("VEC4"), _) => 8,
            _ => 4,
        };
        self.views.push(json!({
            "buffer": 0,
            "byteOffset": self.bytes.len(),
            "byteLength": bytes.len(),
            "target": target,
        }));
        kind["bufferView"] = json!(self.views.len() - 1);
        kind["count"] = json!(bytes.len() / size);
        self.bytes.extend(bytes);
        self.accessors.push(kind);
        json!(self.accessors.len() - 1)
    }

    /// Writes a file with these nodes, of which the first has all others below it.
    ///
    /// # Errors
    /// When writing fails, or the file would be larger than 4 GB.
    pub fn write(self, out: impl Write, mut nodes: Vec<Value>) -> io::Result<()> {
        let below: Vec<usize> = (1..nodes.len()).collect();
        if let Some(root) = nodes.first_mut().filter(|_| !below.is_empty()) {
            root["children"] = json!(below);
        }
        let mut text = serde_json::to_vec(&json!({
            "asset": {"version": "2.0", "generator": "StrataRay"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": nodes,
            "meshes": self.meshes,
            "materials": [{
                "doubleSided": true,
                "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0},
            }],
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": self.bytes.len()}],
        }))?;
        // Chunks end at multiples of 4.
        text.resize(text.len().next_multiple_of(4), b' ');
        let size = |length: usize| {
            let size = u32::try_from(length);
            size.map_err(|_| io::Error::other("more than 4 GB, which glTF does not have"))
        };
        let total = 12 + 8 + text.len() + 8 + self.bytes.len();
        let mut out = BufWriter::new(out);
        out.write_all(b"glTF")?;
        out.write_all(&2_u32.to_le_bytes())?;
        out.write_all(&size(total)?.to_le_bytes())?;
        for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &self.bytes)] {
            out.write_all(&size(chunk.len())?.to_le_bytes())?;
            out.write_all(kind)?;
            out.write_all(chunk)?;
        }
        out.flush()
    }
}
