//! VTK ImageData in all its encodings.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use strataray_parsers::ErrorKind;
use strataray_parsers::volume::{self, Options};

use super::{DIMS, check_values, open, rotated, values};

const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

fn base64(bytes: &[u8]) -> Vec<u8> {
    let group = |three: &[u8]| {
        let bits = (0..3).fold(0, |bits, n| {
            bits << 8 | u32::from(three.get(n).copied().unwrap_or(0))
        });
        let letter = |n: usize| match n <= three.len() {
            true => LETTERS[(bits >> (18 - 6 * n) & 63) as usize],
            false => b'=',
        };
        [0, 1, 2, 3].map(letter)
    };
    bytes.chunks(3).flat_map(group).collect()
}

/// Header and blocks of the compressed array, by 32-bit numbers.
fn packed(bytes: &[u8], block: usize) -> [Vec<u8>; 2] {
    let blocks: Vec<Vec<u8>> = bytes
        .chunks(block)
        .map(|block| {
            let mut out = ZlibEncoder::new(Vec::new(), Compression::default());
            out.write_all(block).unwrap();
            out.finish().unwrap()
        })
        .collect();
    let mut words = vec![blocks.len(), block, bytes.len() % block];
    words.extend(blocks.iter().map(Vec::len));
    let words = words.iter().flat_map(|word| (*word as u32).to_le_bytes());
    [words.collect(), blocks.concat()]
}

/// A file with one array of cells or points in this form.
fn file(form: &str, is_packed: bool, kind: &str, block: usize) -> Vec<u8> {
    let all = values(rotated().region());
    let bytes: Vec<u8> = match kind {
        "UInt8" => all.iter().map(|v| *v as u8).collect(),
        _ => all.iter().flat_map(|v| (*v as f32).to_le_bytes()).collect(),
    };
    let [ni, nj, nk] = DIMS;
    let compressor = if is_packed {
        " compressor=\"vtkZLibDataCompressor\""
    } else {
        ""
    };
    let plain = [&(bytes.len() as u32).to_le_bytes()[..], &bytes].concat();
    let data = match (form, is_packed) {
        ("ascii", _) => all
            .iter()
            .map(|v| format!("{v} "))
            .collect::<String>()
            .into_bytes(),
        ("raw", false) => plain,
        ("raw", true) => packed(&bytes, block).concat(),
        (_, false) => base64(&plain),
        (_, true) => packed(&bytes, block).map(|part| base64(&part)).concat(),
    };
    let is_inline = matches!(form, "ascii" | "binary");
    let format = if is_inline { form } else { "appended" };
    let head = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\"{compressor}>\n\
         <!-- an image > by hand -->\n<ImageData WholeExtent=\"2 {} 0 {nj} 0 {nk}\" Origin=\"1 2 3\" Spacing=\"2 1 1\">\n\
         <Piece Extent=\"2 {} 0 {nj} 0 {nk}\">\n<PointData>\n</PointData>\n<CellData>\n\
         <DataArray type=\"{kind}\" Name=\"density\" format=\"{format}\" offset=\"3\">\n  ",
        ni + 2,
        ni + 2
    );
    let inside = "\n</DataArray>\n</CellData></Piece></ImageData>\n";
    let encoding = if form == "raw" { "raw" } else { "base64" };
    let appended = format!("<AppendedData encoding=\"{encoding}\">\n _xyz");
    match is_inline {
        true => [head.as_bytes(), &data, inside.as_bytes(), b"</VTKFile>"].concat(),
        false => [
            head.as_bytes(),
            inside.as_bytes(),
            appended.as_bytes(),
            &data,
            b"\n</AppendedData></VTKFile>",
        ]
        .concat(),
    }
}

#[test]
fn every_encoding() {
    for form in ["ascii", "binary", "raw", "base64"] {
        for is_packed in [false, true] {
            for (kind, block) in [
                ("UInt8", 64),
                ("Float32", 70),
                ("Float32", 35),
                ("Float32", 4096),
            ] {
                let volume = open("A.vti", file(form, is_packed, kind, block)).unwrap();
                // Cells have their values in the middle.
                assert_eq!(volume.lattice.origin, [6.0, 2.5, 3.5]);
                assert_eq!(volume.lattice.spacing(), [2.0, 1.0, 1.0]);
                check_values(&volume);
            }
        }
    }
}

#[test]
fn wrong_files() {
    let text = |from: &str, to: &str| {
        let text = String::from_utf8(file("ascii", false, "Float32", 0)).unwrap();
        assert!(text.contains(from), "{from}");
        open("A.vti", text.replacen(from, to, 1).into())
    };
    assert!(text("ImageData", "ImageData").is_ok());
    for (from, to, kind) in [
        (
            "type=\"ImageData\"",
            "type=\"UnstructuredGrid\"",
            ErrorKind::Unsupported,
        ),
        (
            "version=\"0.1\"",
            "compressor=\"vtkLZ4DataCompressor\"",
            ErrorKind::Unsupported,
        ),
        (
            "WholeExtent=\"2 9",
            "WholeExtent=\"2 8",
            ErrorKind::Unsupported,
        ),
        (
            "WholeExtent=\"2 9 0",
            "WholeExtent=\"2 9",
            ErrorKind::BadValue,
        ),
        (
            "</CellData>",
            "</CellData></Piece><Piece Extent=\"0 0 0 0 0 0\">",
            ErrorKind::Unsupported,
        ),
        (
            "type=\"Float32\"",
            "type=\"String\"",
            ErrorKind::Unsupported,
        ),
        (
            "offset=\"3\"",
            "NumberOfComponents=\"2\"",
            ErrorKind::WrongCount,
        ),
        (
            "offset=\"3\"",
            "NumberOfComponents=\"-1\"",
            ErrorKind::BadValue,
        ),
        ("DataArray type", "Array type", ErrorKind::MissingKeyword),
        (
            "format=\"ascii\"",
            "format=\"appended\"",
            ErrorKind::MissingKeyword,
        ),
        ("0 7 14", "0 x 14", ErrorKind::BadValue),
    ] {
        let error = text(from, to).unwrap_err();
        assert_eq!(error.kind, kind, "{to}: {error}");
    }
    let mut cut = file("raw", true, "Float32", 64);
    cut.truncate(cut.len() - 60);
    assert_eq!(open("A.vti", cut).unwrap_err().kind, ErrorKind::Truncated);
    let options = Options {
        array: Some("pressure".into()),
        ..Options::default()
    };
    let bytes = file("ascii", false, "Float32", 0);
    let error = volume::from_bytes(("A.vti", bytes), &options).unwrap_err();
    assert!(error.message.contains("it has density"), "{error}");
}
