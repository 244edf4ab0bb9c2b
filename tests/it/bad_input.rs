//! Damaged files end in one sentence with file and keyword, exit code 1, never a panic.

use crate::common;
use std::path::Path;
use std::process::Command;

/// Runs `info` on a file with this content; the sentence of its failure, or `None` where it worked.
fn info(folder: &Path, name: &str, content: &[u8]) -> Option<String> {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_strataray"))
        .args(["info", "--json"])
        .arg(&path)
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(!said.contains("panicked"), "{said}");
    if output.status.success() {
        return None;
    }
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert_eq!(
        said.lines().filter(|l| !l.contains("note:")).count(),
        1,
        "one sentence: {said}"
    );
    assert!(said.contains(name), "names the file: {said}");
    Some(said)
}

#[test]
fn err_truncated_grid() {
    let folder = tempfile::tempdir().unwrap();
    let whole = std::fs::read(common::sample()).unwrap();
    assert_eq!(info(folder.path(), "A.EGRID", &whole), None);
    for n in 1..=20 {
        let cut = whole.len() * n / 21 + n;
        let said = info(folder.path(), "A.EGRID", &whole[..cut])
            .unwrap_or_else(|| panic!("{cut} bytes were enough"));
        assert!(said.contains("@0x") || said.contains("missing"), "{said}");
    }
}

#[test]
fn err_impossible_counts_and_values() {
    let folder = tempfile::tempdir().unwrap();
    let whole = std::fs::read(common::sample()).unwrap();
    let at = |name: &[u8]| whole.windows(8).position(|w| w == name).unwrap();
    for (name, count) in [
        (b"COORD   ", -5i32),
        (b"ZCORN   ", i32::MAX),
        (b"ACTNUM  ", 7),
        (b"GRIDHEAD", 0),
    ] {
        let mut damaged = whole.clone();
        damaged[at(name) + 8..at(name) + 12].copy_from_slice(&count.to_be_bytes());
        let said = info(folder.path(), "B.EGRID", &damaged).unwrap();
        assert!(
            said.contains(std::str::from_utf8(name).unwrap().trim()),
            "{said}"
        );
    }
    // One that is no number is left out; where most are, there is no grid.
    let mut nan = whole.clone();
    let first_depth = at(b"ZCORN   ") + 28;
    nan[first_depth..first_depth + 4].copy_from_slice(&f32::NAN.to_be_bytes());
    assert_eq!(info(folder.path(), "B.EGRID", &nan), None);
    let end = at(b"ACTNUM  ") - 4;
    let depths = nan[first_depth..end].chunks_exact_mut(4008);
    depths.for_each(|block| block[..3996].as_chunks_mut().0.fill(f32::NAN.to_be_bytes()));
    assert!(
        info(folder.path(), "B.EGRID", &nan)
            .unwrap()
            .contains("not a finite number")
    );
    assert!(
        info(folder.path(), "B.EGRID", b"")
            .unwrap()
            .contains("empty")
    );
    assert!(
        info(
            folder.path(),
            "B.EGRID",
            b"this is no grid at all, only words"
        )
        .is_some()
    );
}

#[test]
fn err_damaged_deck() {
    let folder = tempfile::tempdir().unwrap();
    let deck = "SPECGRID\n 1 1 1 1 F /\nCOORD\n 0 0 0 0 0 9 1 0 0 1 0 9 0 1 0 0 1 9 1 1 0 1 1 9 /\nZCORN\n 4*1 4*2 /\nPORO\n 0.25/\n";
    assert_eq!(info(folder.path(), "c.grdecl", deck.as_bytes()), None);
    let without = |keyword: &str| {
        let at = deck.find(keyword).unwrap();
        let end = at + deck[at..].find('/').unwrap() + 2;
        format!("{}{}", &deck[..at], &deck[end..])
    };
    for keyword in ["SPECGRID", "COORD", "ZCORN"] {
        let said = info(folder.path(), "c.grdecl", without(keyword).as_bytes()).unwrap();
        assert!(said.contains(keyword), "{said}");
    }
    for (from, to, word) in [
        ("4*2", "3*2", "ZCORN"),
        ("4*2", "999999999*2", "ZCORN"),
        ("4*2", "4*nan", "ZCORN"),
        ("1 1 1 1 F", "-1 1 1 1 F", "SPECGRID"),
        ("1 1 1 1 F", "99999 99999 99999 1 F", "SPECGRID"),
        ("PORO", "INCLUDE\n 'gone.inc' /\nPORO", "gone.inc"),
    ] {
        let said = info(
            folder.path(),
            "c.grdecl",
            deck.replacen(from, to, 1).as_bytes(),
        )
        .unwrap();
        assert!(said.contains(word), "{to}: {said}");
    }
    for cut in 1..20 {
        // A deck that ends between keywords is whole again once ZCORN is there.
        let said = info(
            folder.path(),
            "c.grdecl",
            &deck.as_bytes()[..deck.len() * cut / 21],
        );
        assert!(said.is_some() || cut > 17, "{cut}");
    }
}

#[test]
fn results_of_another_grid_are_named_and_the_rest_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let sample = common::sample();
    std::fs::copy(&sample, folder.path().join("D.EGRID")).unwrap();
    std::fs::copy(sample.with_extension("INIT"), folder.path().join("D.INIT")).unwrap();
    let restart = std::fs::read(sample.with_extension("UNRST")).unwrap();
    // A simulator that is still writing: the last step is half there.
    std::fs::write(
        folder.path().join("d.unrst"),
        &restart[..restart.len() - 20_000],
    )
    .unwrap();
    let case = strataray::case::load::open(&folder.path().join("D")).unwrap();
    assert!(case.steps.len() >= 20, "{}", case.steps.len());
    assert!(
        case.about.notes.iter().any(|n| n.contains("left out")),
        "{:?}",
        case.about.notes
    );
    assert!(case.field("PORO", 0).is_ok() && case.field("swat", 3).is_ok());
    let mut init = std::fs::read(sample.with_extension("INIT")).unwrap();
    // INTEHEAD item 12, the number of active cells.
    init[24 + 4 + 44..24 + 4 + 48].copy_from_slice(&77i32.to_be_bytes());
    std::fs::write(folder.path().join("D.INIT"), &init).unwrap();
    let case = strataray::case::load::open(&folder.path().join("D.UNRST")).unwrap();
    assert!(
        case.about
            .notes
            .iter()
            .any(|n| n.contains("D.INIT") && n.contains("77 active")),
        "{:?}",
        case.about.notes
    );
    assert!(case.field("SWAT", 3).is_ok());
}

#[test]
fn a_reader_that_stops_reading_ends_a_command_quietly() {
    let sample = common::sample();
    let mut child = Command::new(env!("CARGO_BIN_EXE_strataray"))
        .args(["info", "--json"])
        .arg(sample)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.is_empty(), "{said}");
}
