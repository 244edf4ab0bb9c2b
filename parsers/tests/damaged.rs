//! Real files and volumes, damaged a thousand times each: no panic, no long wait, no more memory than there are bytes for.
//!
//! Memory is counted by the allocator of this binary, which holds this one test alone, so that nothing else counts.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic, reason = "tests")]

#[path = "bytes/fixtures.rs"]
#[allow(dead_code, reason = "shared with other tests")]
mod fixtures;
#[path = "bytes/properties.rs"]
#[allow(dead_code, reason = "shared with other tests and with fuzzing")]
mod properties;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use fastrand::Rng;
use peak_alloc::PeakAlloc;
use properties::{READERS, Reader, holds};
use strataray_parsers::volume::{self, Options};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Mutations of a file.
const ROUNDS: usize = 1000;
/// Longer files are damaged in their first part, most often in a shorter one.
const LONGEST: usize = 4 << 20;
const SHORT: usize = 1 << 15;
const SLOWEST: Duration = Duration::from_secs(2);
/// What a reader may hold at a time, for no bytes and for each byte of a file.
const MOST_MEMORY: usize = 64 << 20;
const MOST_PER_BYTE: usize = 32;

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => files(&path, found),
            false => found.push(path),
        }
    }
}

/// The readers that a file is for, by its extension; text that is no grid is damaged as a deck.
fn readers(path: &Path) -> Vec<Reader> {
    let extension = path.extension().and_then(|e| e.to_str());
    let extension = extension.unwrap_or_default().to_ascii_uppercase();
    let names: &[&str] = match extension.as_str() {
        "EGRID" | "FEGRID" | "GRID" => &["egrid", "records"],
        "INIT" | "FINIT" => &["init"],
        "UNRST" | "FUNRST" => &["restart", "wells"],
        "SMSPEC" | "UNSMRY" => &["summary"],
        "ESMRY" => &["esmry"],
        "ROFF" => &["roff"],
        "SGY" | "SEGY" => &["segy"],
        "NRRD" | "NHDR" | "MHA" | "MHD" | "VTI" => &["volume"],
        "PNG" | "CSV" | "JSON" | "MD" => &[],
        x if x.starts_with('X') && x.len() == 5 => &["restart", "wells"],
        "SCH" => &["deck", "schedule", "paths"],
        _ => &["deck", "schedule"],
    };
    let named = READERS.iter().filter(|(name, _)| names.contains(name));
    named.map(|(_, reader)| *reader).collect()
}

/// Flips a bit, cuts, splices, or repeats a part.
fn damaged(bytes: &[u8], random: &mut Rng) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..random.usize(1..4) {
        if bytes.is_empty() {
            break;
        }
        let at = random.usize(..bytes.len());
        let end = (at + random.usize(1..64)).min(bytes.len());
        match random.u8(..4) {
            0 => bytes[at] ^= 1 << random.u8(..8),
            1 if random.bool() => bytes.truncate(at),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let from = random.usize(..bytes.len());
                let part = bytes[from..(from + end - at).min(bytes.len())].to_vec();
                drop(bytes.splice(at..at, part));
            }
            _ => {
                let part = bytes[at..end].repeat(random.usize(1..20));
                drop(bytes.splice(at..at, part));
            }
        }
    }
    bytes
}

/// What reading cost at most.
#[derive(Debug, Default)]
struct Cost {
    readings: usize,
    slowest: (Duration, PathBuf),
    largest: (usize, PathBuf),
}

impl Cost {
    fn add(&mut self, path: &Path, seed: usize, reader: Reader, bytes: &[u8]) {
        MEMORY.reset_peak_usage();
        let before = MEMORY.current_usage();
        let timed = || {
            let start = Instant::now();
            holds(reader, bytes.to_vec());
            start.elapsed()
        };
        let mut time = timed();
        let held = MEMORY.peak_usage().saturating_sub(before);
        if time > SLOWEST {
            // The machine may have been busy with something else.
            time = timed();
        }
        assert!(time < SLOWEST, "{} {seed}: {time:?}", path.display());
        let most = MOST_MEMORY + MOST_PER_BYTE * bytes.len();
        assert!(held < most, "{} {seed}: {held} bytes", path.display());
        self.readings += 1;
        if time > self.slowest.0 {
            self.slowest = (time, path.to_owned());
        }
        if held > self.largest.0 {
            self.largest = (held, path.to_owned());
        }
    }
}

/// Reads damaged copies of a file.
fn damage(path: &Path, bytes: &[u8], readers: &[Reader], cost: &mut Cost) {
    let whole = &bytes[..bytes.len().min(LONGEST)];
    for seed in 0..ROUNDS {
        let mut random = Rng::with_seed(seed as u64);
        // Most of a long file is more of the same.
        let length = match seed % 50 {
            0 => whole.len(),
            _ => whole.len().min(SHORT),
        };
        let bytes = damaged(&whole[..length], &mut random);
        for reader in readers {
            cost.add(path, seed, *reader, &bytes);
        }
    }
}

/// Volumes, of which there are none among the real files.
fn volumes() -> Vec<(&'static str, Vec<u8>)> {
    let mut all = fixtures::images([50, 40, 10]);
    all.push(("a.sgy", fixtures::segy(2000)));
    all
}

/// What opening a volume and reading it in slabs takes at most, beside the bytes of the file.
fn held(bytes: Vec<u8>) -> usize {
    MEMORY.reset_peak_usage();
    let before = MEMORY.current_usage();
    let volume = volume::from_bytes(("A", bytes), &Options::default()).unwrap();
    for slab in volume.slabs(1 << 16) {
        volume.f32s(slab).unwrap();
    }
    MEMORY.peak_usage() - before
}

/// Samples are not held, but those of text, in the bytes of their type.
fn volumes_are_read_in_slabs() {
    const SAMPLES: usize = 256 * 256 * 40;
    for (name, bytes) in fixtures::images([256, 256, 40]) {
        let held = held(bytes);
        let most = match name.starts_with("text") {
            true => 2 * SAMPLES + (3 << 20),
            false => 3 << 20,
        };
        assert!(held < most, "{name}: {held} bytes");
    }
    let bytes = fixtures::segy(60_000);
    assert!(held(bytes) < 3 << 20);
}

#[test]
fn damaged_files() {
    volumes_are_read_in_slabs();
    let mut cost = Cost::default();
    for (name, bytes) in volumes() {
        let path = Path::new(name);
        damage(path, &bytes, &readers(path), &mut cost);
    }
    println!("{cost:?}");
    let Some(data) = std::env::var_os("STRATARAY_DATA") else {
        println!("STRATARAY_DATA is not set: the test on real files is left out");
        return;
    };
    let (mut paths, mut count) = (Vec::new(), 0);
    files(Path::new(&data), &mut paths);
    paths.sort();
    for path in &paths {
        let readers = readers(path);
        if readers.is_empty() {
            continue;
        }
        count += 1;
        damage(path, &std::fs::read(path).unwrap(), &readers, &mut cost);
    }
    assert!(count > 50, "only {count} files");
    println!(
        "{count} files, {} readings; slowest {:?} ({}); most memory {:.1} MB ({})",
        cost.readings,
        cost.slowest.0,
        cost.slowest.1.display(),
        cost.largest.0 as f64 / 1e6,
        cost.largest.1.display()
    );
}
