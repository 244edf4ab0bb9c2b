//! Damaged files end in an error, or in something complete: never in a panic or half an array.

use std::path::Path;

use fastrand::Rng;
use strataray_parsers::deck::{Grdecl, MemoryFiles};
use strataray_parsers::egrid::Egrid;
use strataray_parsers::records::RecordFile;
use strataray_parsers::summary::Summary;
use strataray_parsers::{At, ErrorKind, ParseError, Warnings, init, restart, wells};

use super::fixtures::{self, PORO, rich_deck, rich_egrid};

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
fn mutated(bytes: &[u8], random: &mut Rng) -> Vec<u8> {
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
            assert!(
                !error.message.is_empty() && !error.to_string().contains('\n'),
                "{error}"
            );
            errors += 1;
        }
    }
    assert!(
        (ROUNDS / 10..ROUNDS * 99 / 100).contains(&errors),
        "{errors} errors"
    );
}

fn check_grid(dims: [usize; 3], lengths: [usize; 2], actnum: Option<&[i32]>) {
    let [ni, nj, nk] = dims;
    assert_eq!(lengths, [6 * (ni + 1) * (nj + 1), 8 * ni * nj * nk]);
    assert!(actnum.is_none_or(|actnum| actnum.len() == ni * nj * nk));
}

#[test]
fn mutated_egrid() {
    mutate(1, &rich_egrid(), |bytes| {
        let grid = Egrid::from_bytes(("A.EGRID", bytes), &mut Warnings::default())?;
        check_grid(
            grid.dims,
            [grid.coord.len(), grid.zcorn.len()],
            grid.actnum.as_deref(),
        );
        assert!(grid.coord.iter().chain(&grid.zcorn).all(|v| v.is_finite()));
        for local in &grid.local_grids {
            let lengths = [local.coord.len(), local.zcorn.len()];
            let [ni, nj, _] = local.dims;
            // Of one coordinate system or several.
            let pillars = 6 * (ni + 1) * (nj + 1);
            assert!(lengths[0].is_multiple_of(pillars));
            check_grid(local.dims, [pillars, lengths[1]], local.actnum.as_deref());
        }
        Ok(())
    });
}

#[test]
fn mutated_legacy_grid() {
    for (seed, bytes) in [
        (8, fixtures::legacy()),
        (9, fixtures::formatted(&fixtures::legacy())),
    ] {
        mutate(seed, &bytes, |bytes| {
            let grid = Egrid::from_bytes(("A.GRID", bytes), &mut Warnings::default())?;
            let lengths = [grid.coord.len(), grid.zcorn.len()];
            check_grid(grid.dims, lengths, grid.actnum.as_deref());
            Ok(())
        });
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
    let values = |summary: &Summary| {
        assert!(summary.dates().len() <= summary.steps.len());
        for vector in &summary.vectors {
            let values = summary.values(vector)?;
            assert_eq!(values.len(), summary.steps.len(), "{vector}");
        }
        Ok(())
    };
    for (seed, is_text) in [(11, false), (12, true)] {
        let bytes = fixtures::summary(false);
        let bytes = if is_text {
            fixtures::formatted(&bytes)
        } else {
            bytes
        };
        mutate(seed, &bytes, |bytes| {
            let file = || ("A.UNSMRY", bytes.clone());
            values(&Summary::from_bytes(
                file(),
                file(),
                &mut Warnings::default(),
            )?)
        });
    }
    mutate(13, &fixtures::summary(true), |bytes| {
        let mut warnings = Warnings::default();
        values(&Summary::extended_from_bytes(
            ("A.ESMRY", bytes),
            &mut warnings,
        )?)
    });
}

/// Decodes every array in every way; one that can be decoded has as many values as its header says.
fn decode(file: &RecordFile) {
    for entry in file.entries() {
        let lengths = [
            file.f32s(entry).map(|values| values.len()),
            file.f64s(entry).map(|values| values.len()),
            file.i32s(entry).map(|values| values.len()),
            file.bools(entry).map(|values| values.len()),
            file.strings(entry).map(|values| values.len()),
        ];
        for length in lengths.into_iter().flatten() {
            assert_eq!(length as u64, entry.count, "{}", entry.name());
        }
    }
}

#[test]
fn mutated_records() {
    mutate(5, &fixtures::records(), |bytes| {
        decode(&RecordFile::from_bytes(("A", bytes))?);
        Ok(())
    });
}

#[test]
fn mutated_formatted_records() {
    let text = fixtures::formatted(&fixtures::records());
    mutate(6, &text, |bytes| {
        let file = RecordFile::from_bytes(("A", bytes))?;
        decode(&file);
        // Values are looked at when they are decoded.
        let entries = file.entries().iter().filter(|entry| entry.is_numeric());
        entries.map(|entry| file.f64s(entry).map(drop)).collect()
    });
}

#[test]
fn mutated_formatted_egrid() {
    let text = fixtures::formatted(&rich_egrid());
    mutate(7, &text, |bytes| {
        let grid = Egrid::from_bytes(("A.FEGRID", bytes), &mut Warnings::default())?;
        let lengths = [grid.coord.len(), grid.zcorn.len()];
        check_grid(grid.dims, lengths, grid.actnum.as_deref());
        Ok(())
    });
}

#[test]
fn mutated_init() {
    mutate(2, &fixtures::init(), |bytes| {
        let arrays = init::from_bytes(("A.INIT", bytes.clone()), &mut Warnings::default())?;
        decode(arrays.file());
        arrays.head()?;
        // What is read leniently is read strictly too, unless it ends early.
        RecordFile::from_bytes(("A.INIT", bytes)).map(drop)
    });
}

#[test]
fn mutated_restart() {
    mutate(3, &fixtures::restart([1, 20]), |bytes| {
        let steps = restart::unified_from_bytes(("A.UNRST", bytes), &mut Warnings::default())?;
        assert!(!steps.is_empty());
        for step in &steps {
            step.wells()?;
            decode(step.arrays.file());
        }
        Ok(())
    });
}

fn read_deck(bytes: Vec<u8>) -> Result<Grdecl, ParseError> {
    let files = [("A", bytes), ("PORO.INC", PORO.into())];
    let files = MemoryFiles::from_iter(files);
    Grdecl::read_from(&files, Path::new("A"), &[], &mut Warnings::default())
}

#[test]
fn mutated_deck() {
    mutate(4, rich_deck().as_bytes(), |bytes| {
        let grid = read_deck(bytes)?;
        check_grid(
            grid.dims,
            [grid.coord.len(), grid.zcorn.len()],
            grid.actnum.as_deref(),
        );
        assert!(grid.coord.iter().chain(&grid.zcorn).all(|v| v.is_finite()));
        let cells: usize = grid.dims.iter().product();
        assert!(grid.properties.iter().all(|p| p.values.len() == cells));
        for fault in &grid.faults {
            let ends = [fault.i, fault.j, fault.k];
            assert!(
                ends.iter()
                    .zip(grid.dims)
                    .all(|([first, last], n)| first <= last && *last <= n)
            );
        }
        Ok(())
    });
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
