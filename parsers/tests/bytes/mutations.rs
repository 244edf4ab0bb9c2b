//! Damaged files end in an error, or in something complete: never in a panic or half an array.

use std::path::Path;

use fastrand::Rng;
use strataray_parsers::deck::{Grdecl, MemoryFiles};
use strataray_parsers::records::RecordFile;
use strataray_parsers::{At, ErrorKind, ParseError, Warnings, restart, wells};

use super::fixtures::{self, PORO, rich_deck, rich_egrid};
use super::properties;

const ROUNDS: usize = 10_000;

/// Bytes that mean something to the readers of text and of records.
const PIECES: [&[u8]; 20] = [
    b"/",
    b"*",
    b"'",
    b"-",
    b"--",
    b"\n",
    b"\r",
    b" ",
    b".",
    b"1e999",
    b"9999999999*",
    b"INCLUDE\n'A' /\n",
    b"BOX\n",
    &[0, 0, 0, 0],
    &[0, 0, 0, 1],
    &[0, 0, 0, 16],
    &[0, 0, 3, 0xe8],
    &[0x7f, 0xff, 0xff, 0xff],
    &[0xff, 0xff, 0xff, 0xff],
    &[0x80, 0, 0, 0],
];

/// `bytes` with one to three changes.
pub fn mutated(bytes: &[u8], random: &mut Rng) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..random.usize(1..4) {
        if bytes.is_empty() {
            break;
        }
        let at = random.usize(..bytes.len());
        let end = (at + random.usize(1..40)).min(bytes.len());
        let piece = PIECES[random.usize(..PIECES.len())];
        match random.u8(..7) {
            0 => bytes[at] ^= 1 << random.u8(..8),
            1 => bytes[at] = random.u8(..),
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(at..end)),
            4 => bytes.extend_from_within(at..end),
            5 => drop(bytes.splice(at..at, piece.iter().copied())),
            _ => drop(bytes.splice(
                at..(at + piece.len()).min(bytes.len()),
                piece.iter().copied(),
            )),
        }
    }
    bytes
}

/// Reads mutations of a file; some must fail, and some, changed where it does not matter, must not.
fn mutate(seed: u64, bytes: &[u8], read: impl Fn(Vec<u8>) -> Result<(), ParseError>) {
    assert!(read(bytes.to_vec()).is_ok(), "not mutated");
    let mut random = Rng::with_seed(seed);
    let mut errors = 0;
    for _ in 0..ROUNDS {
        if let Err(error) = read(mutated(bytes, &mut random)) {
            assert_ne!(error.kind, ErrorKind::Other, "{error}");
            errors += 1;
        }
    }
    assert!(
        (ROUNDS / 10..ROUNDS * 99 / 100).contains(&errors),
        "{errors} errors"
    );
}

#[test]
fn mutated_egrid() {
    mutate(1, &rich_egrid(), properties::egrid);
}

#[test]
fn mutated_legacy_grid() {
    for (seed, bytes) in [
        (8, fixtures::legacy()),
        (9, fixtures::formatted(&fixtures::legacy())),
    ] {
        mutate(seed, &bytes, properties::egrid);
    }
}

#[test]
fn mutated_wells() {
    mutate(10, &fixtures::wells(), |bytes| {
        let mut warnings = Warnings::default();
        for step in restart::unified_from_bytes(("A.UNRST", bytes), &mut warnings)? {
            for well in wells::read(&step.arrays)? {
                assert!(well.completions.len() <= 60 && !well.name.is_empty());
            }
        }
        // Files that end early are read up to there.
        match warnings.is_empty() {
            true => Ok(()),
            false => Err(ParseError::of(
                ErrorKind::Truncated,
                Path::new("A"),
                At::File,
                "",
                "cut",
            )),
        }
    });
}

#[test]
fn mutated_summary() {
    let bytes = fixtures::summary(false);
    mutate(11, &bytes, properties::summary);
    mutate(12, &fixtures::formatted(&bytes), properties::summary);
    mutate(13, &fixtures::summary(true), properties::esmry);
}

#[test]
fn mutated_roff() {
    mutate(14, &fixtures::roff_binary(), properties::roff);
    mutate(15, fixtures::roff_text().as_bytes(), properties::roff);
}

#[test]
fn mutated_schedules_and_paths() {
    mutate(16, fixtures::SCHEDULE.as_bytes(), properties::schedule);
    for (seed, text) in [
        (17, fixtures::PATHS),
        (18, fixtures::RMS_WELL),
        (19, fixtures::JSON_PATH),
    ] {
        mutate(seed, text.as_bytes(), properties::paths);
    }
}

#[test]
fn mutated_volumes() {
    for (n, (_, bytes)) in fixtures::images([3, 2, 2]).into_iter().enumerate() {
        mutate(20 + n as u64, &bytes, properties::volume);
    }
    let bytes = fixtures::segy(4);
    mutate(30, &bytes, properties::segy);
    // Without the text header more of the changes are of what means something.
    mutate(31, &bytes[3200..], |bytes| {
        properties::segy([vec![0x40; 3200], bytes].concat())
    });
}

#[test]
fn mutated_records() {
    mutate(5, &fixtures::records(), properties::records);
}

#[test]
fn mutated_formatted_records() {
    let text = fixtures::formatted(&fixtures::records());
    mutate(6, &text, |bytes| {
        properties::records(bytes.clone())?;
        let file = RecordFile::from_bytes(("A", bytes))?;
        // Values are looked at when they are decoded.
        let mut entries = file.entries().iter().filter(|entry| entry.is_numeric());
        entries.try_for_each(|entry| file.f64s(entry).map(drop))
    });
}

#[test]
fn mutated_formatted_egrid() {
    let text = fixtures::formatted(&rich_egrid());
    mutate(7, &text, properties::egrid);
}

#[test]
fn mutated_init() {
    mutate(2, &fixtures::init(), |bytes| {
        properties::init(bytes.clone())?;
        // What is read leniently is read strictly too, unless it ends early.
        RecordFile::from_bytes(("A.INIT", bytes)).map(drop)
    });
}

#[test]
fn mutated_restart() {
    mutate(3, &fixtures::restart([1, 20]), properties::restart);
}

fn read_deck(bytes: Vec<u8>) -> Result<Grdecl, ParseError> {
    let files = [("A", bytes), ("PORO.INC", PORO.into())];
    let files = MemoryFiles::from_iter(files);
    Grdecl::read_from(&files, Path::new("A"), &[], &mut Warnings::default())
}

#[test]
fn mutated_deck() {
    mutate(4, rich_deck().as_bytes(), properties::deck);
}

#[test]
fn truncated_decks_are_errors_or_complete() {
    let deck = rich_deck();
    let whole = read_deck(deck.clone().into()).unwrap();
    // Depths are shifted at the end of the deck.
    let [needed, shifted] = ["ACTNUM", "ADDZCORN"].map(|keyword| deck.find(keyword).unwrap());
    for length in 0..deck.len() {
        let grid = read_deck(deck.as_bytes()[..length].into());
        if length + 8 < needed {
            assert!(grid.is_err(), "{length}");
        } else if let Ok(grid) = grid {
            assert_eq!(grid.coord, whole.coord, "{length}");
            assert_eq!(grid.zcorn == whole.zcorn, length > shifted + 18, "{length}");
        }
    }
}
