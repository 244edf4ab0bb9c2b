//! Other programs read what is written here, and what they write is read: `others.py`.

use std::fs;
use std::path::Path;
use std::process::Command;

use strataray_parsers::volume::{
    self, ByteOrder, Options, SampleType, SegyLayout, SegyWriter, metaimage, nrrd, vti,
};

use super::{DIMS, apart, check_values, contents, rotated, value, values};

fn write_files(folder: &Path) {
    let all = || values(rotated().region());
    let contents = contents(SampleType::F32, ByteOrder::Big);
    let save = |name: &str, bytes: std::io::Result<Vec<u8>>| {
        fs::write(folder.join(name), bytes.unwrap()).unwrap()
    };
    for is_packed in [false, true] {
        let name = if is_packed { "packed" } else { "plain" };
        save(
            &format!("{name}.nrrd"),
            nrrd::write(Vec::new(), &contents, is_packed, all()),
        );
        save(
            &format!("{name}.mha"),
            metaimage::write(Vec::new(), &contents, is_packed, all()),
        );
    }
    save("plain.vti", vti::write(Vec::new(), &contents, all()));
    for (name, sample, byte_order) in [
        ("ibm.sgy", SampleType::Ibm32, ByteOrder::Big),
        ("ieee.sgy", SampleType::F32, ByteOrder::Big),
        ("little.sgy", SampleType::F32, ByteOrder::Little),
    ] {
        let layout = SegyLayout {
            sample,
            byte_order,
            samples: DIMS[2],
            interval: 4.0,
            delay: 100,
            text: "a survey by formula".into(),
        };
        let mut out = SegyWriter::new(Vec::new(), layout).unwrap();
        for i in 0..DIMS[0] {
            for j in 0..DIMS[1] {
                let trace: Vec<f32> = (0..DIMS[2]).map(|k| value([i, j, k]) as f32).collect();
                let [x, y, _] = rotated().place([i as f64, j as f64, 0.0]);
                out.trace(10 + 2 * i as i32, 20 + j as i32, [x, y], &trace)
                    .unwrap();
            }
        }
        save(name, out.finish());
    }
}

/// Runs the script; false where there is no Python with the packages.
fn run(folder: &Path) -> bool {
    let python = std::env::var_os("STRATARAY_PYTHON").unwrap_or_else(|| "python3".into());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/volumes/others.py");
    let Ok(made) = Command::new(&python).arg(script).arg(folder).output() else {
        eprintln!("SKIPPED: there is no {}", python.display());
        return false;
    };
    let printed = String::from_utf8_lossy(&made.stdout);
    let said = String::from_utf8_lossy(&made.stderr);
    if made.status.code() == Some(77) {
        eprintln!("SKIPPED: {printed}");
        return false;
    }
    assert!(made.status.success(), "{printed}{said}");
    println!("{printed}");
    assert!(printed.matches("ok: ").count() >= 20, "{printed}");
    true
}

#[test]
fn other_programs_agree() {
    let folder = tempfile::tempdir().unwrap();
    write_files(folder.path());
    if !run(folder.path()) {
        return;
    }
    let mut count = 0;
    for entry in fs::read_dir(folder.path()).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if !name.starts_with("theirs")
            || name.ends_with(".raw")
            || name.ends_with(".zraw")
            || name.ends_with(".gz")
        {
            continue;
        }
        let volume = volume::open(&path, &Options::default()).unwrap();
        let mut expected = rotated();
        if name.ends_with("sgy") {
            expected.origin[2] = 100.0;
        }
        // Hundredths in headers of traces; all else is told in full.
        let most = if name.ends_with("sgy") { 0.01 } else { 1e-6 };
        let off = apart(&volume.lattice, &expected);
        assert!(off < most, "{name}: {off} {:?}", volume.lattice);
        check_values(&volume);
        count += 1;
    }
    assert!(count >= 12, "{count} files");
}
