//! What people are told of files that are not as they should be, word for word, in `sentences.txt`.
//!
//! `UPDATE_SENTENCES=1 cargo test --test bytes -- sentences` writes that file anew: read each sentence that changes as
//! somebody who has only the file and the sentence.

use std::fmt::Write;
use std::path::Path;

use strataray_parsers::deck::{DeckCells, Grdecl, MemoryFiles, Schedule};
use strataray_parsers::egrid::Egrid;
use strataray_parsers::records::{Entry, RecordFile, RecordWriter};
use strataray_parsers::roff::RoffFile;
use strataray_parsers::summary::Summary;
use strataray_parsers::volume::{self, Options};
use strataray_parsers::{ParseError, Warnings, case, init, paths, restart, wells};

use super::fixtures::{self, CELL};
use super::properties;

/// Sentences by the cases that provoke them.
#[derive(Default)]
struct Sentences(String);

impl Sentences {
    /// The warnings and the error of one case; at least one of them.
    fn add<T>(&mut self, title: &str, warnings: &Warnings, result: Result<T, ParseError>) {
        let start = self.0.len();
        writeln!(self.0, "{title}").unwrap();
        for warning in warnings.iter() {
            writeln!(self.0, "  warning: {warning}").unwrap();
        }
        if let Err(error) = result {
            writeln!(self.0, "  {:?}: {error}", error.kind).unwrap();
        }
        let said = &self.0[start..];
        assert!(said.lines().count() > 1, "nothing is said of: {title}");
    }

    fn deck(&mut self, title: &str, text: &str) {
        self.decks(title, &[("CASE.DATA", text.as_bytes().to_vec())]);
    }

    /// A grid of a cell with `text` behind it, which begins in line 8.
    fn cell(&mut self, text: &str) {
        let title = text.trim_end().replace('\n', " | ");
        self.deck(&title, &format!("{CELL}\n{text}"));
    }

    /// A grid of a cell with one part of it changed.
    fn changed(&mut self, title: &str, from: &str, to: &str) {
        let text = CELL.replace(from, to);
        assert_ne!(text, CELL, "{title}");
        self.deck(title, &text);
    }

    fn decks(&mut self, title: &str, files: &[(&str, Vec<u8>)]) {
        let main = Path::new(files[0].0);
        let files: MemoryFiles = files
            .iter()
            .map(|(name, bytes)| ((*name).to_owned(), bytes.clone()))
            .collect();
        let mut warnings = Warnings::default();
        let read = Grdecl::read_from(&files, main, &[], &mut warnings);
        self.add(title, &warnings, read);
    }

    fn records(
        &mut self,
        title: &str,
        bytes: &[u8],
        use_of: fn(&RecordFile, &Entry) -> Result<(), ParseError>,
    ) {
        let file = RecordFile::from_bytes(("CASE.INIT", bytes.to_vec()));
        let used = file.and_then(|file| {
            let mut entries = file.entries().iter();
            entries.try_for_each(|entry| use_of(&file, entry))
        });
        self.add(title, &Warnings::default(), used);
    }

    /// A volume, and the reading of its values.
    fn volume(&mut self, title: &str, name: &'static str, bytes: Vec<u8>) {
        match volume::from_bytes((name, bytes), &Options::default()) {
            Err(error) => self.add::<()>(title, &Warnings::default(), Err(error)),
            Ok(volume) => self.add(title, &volume.notes, volume.f32s(volume.lattice.region())),
        }
    }

    /// An image of text with one part of it changed.
    fn image(&mut self, title: &str, text: &str, from: &str, to: &str) {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text, "{title}");
        self.volume(title, "CASE.FILE", changed.into());
    }

    fn egrid(&mut self, title: &str, write: impl FnOnce(&mut RecordWriter<Vec<u8>>)) {
        let mut warnings = Warnings::default();
        let read = Egrid::from_bytes(("CASE.EGRID", written(write)), &mut warnings);
        self.add(title, &warnings, read);
    }

    fn restart(&mut self, title: &str, write: impl FnOnce(&mut RecordWriter<Vec<u8>>)) {
        let mut warnings = Warnings::default();
        let steps = restart::unified_from_bytes(("CASE.UNRST", written(write)), &mut warnings);
        let used = steps.and_then(|steps| {
            let mut steps = steps.iter();
            steps.try_for_each(|step| {
                step.wells()?;
                wells::read(&step.arrays).map(drop)
            })
        });
        self.add(title, &warnings, used);
    }

    fn summary(&mut self, title: &str, bytes: Vec<u8>) {
        let mut warnings = Warnings::default();
        let (spec, data) = (("CASE.SMSPEC", bytes.clone()), ("CASE.UNSMRY", bytes));
        let read = Summary::from_bytes(spec, data, &mut warnings);
        self.add(title, &warnings, read);
    }

    fn roff(&mut self, title: &str, from: &str, to: &str) {
        let text = fixtures::roff_text();
        let changed = text.replacen(from, to, 1);
        assert_ne!(text, changed, "{title}");
        let used = RoffFile::from_bytes(("CASE.ROFF", changed)).and_then(|file| {
            file.grid()?;
            let mut parameters = file.parameters()?.into_iter();
            parameters.try_for_each(|parameter| file.values(&parameter).map(drop))
        });
        self.add(title, &Warnings::default(), used);
    }
}

fn written(write: impl FnOnce(&mut RecordWriter<Vec<u8>>)) -> Vec<u8> {
    let mut out = RecordWriter::new(Vec::new());
    write(&mut out);
    out.finish().unwrap()
}

/// Decks that are wrong as a whole.
const DECKS: &[(&str, &str)] = &[
    ("an empty deck", ""),
    ("a deck of properties", "PORO\n 0.5 /\n"),
    (
        "block-centered without DY",
        "DIMENS\n 1 1 1 /\nDX\n 1 /\nDZ\n 1 /\nTOPS\n 1 /\n",
    ),
    (
        "block-centered without a size",
        "DIMENS\n 2 1 1 /\nDX\n 1 1* /\nDY\n 2*1 /\nDZ\n 2*1 /\nTOPS\n 2*1 /\n",
    ),
    (
        "block-centered without a top",
        "DIMENS\n 2 1 1 /\nDX\n 2*1 /\nDY\n 2*1 /\nDZ\n 2*1 /\nTOPS\n 1 1* /\n",
    ),
    (
        "block-centered with uneven layers",
        "DIMENS\n 1 1 2 /\nDX\n 1 2 /\nDY\n 2*1 /\nDZ\n 2*1 /\nTOPS\n 1 /\n",
    ),
    (
        "vectors of another length",
        "DIMENS\n 1 1 1 /\nDXV\n 2*1 /\nDYV\n 1 /\nDZV\n 1 /\nTOPS\n 1 /\n",
    ),
];

/// A part of the deck of one cell, and what stands there instead.
const CHANGES: &[(&str, &str, &str)] = &[
    ("two dimensions", "1 1 1 1 F", "1 1"),
    ("no cells", "1 1 1 1 F", "1 0 1 1 F"),
    ("several coordinate systems", "1 1 1 1 F", "1 1 1 2 F"),
    (
        "more cells than there can be",
        "1 1 1 1 F",
        "99999 99999 99999",
    ),
    (
        "more cells than the text describes",
        "1 1 1 1 F",
        "1290 1290 1290",
    ),
    ("too few depths", "4*0 4*1", "4*0 3*1"),
    ("a depth that is no number", "4*0 4*1", "4*0 4*1x"),
    ("an undefined depth", "4*0 4*1", "7*0 nan"),
    ("a depth left to its default", "4*0 4*1", "4*0 4*"),
    ("an impossible repeat count", "4*0 4*1", "0*1"),
    ("a missing slash", "1 1 1 /\nZCORN", "1 1 1\nZCORN"),
];

/// What stands behind the deck of one cell.
const BEHIND_A_CELL: &[&str] = &[
    "PORO\n 2*0.5 /\n",
    "PORO\n 0.x /\n",
    "PORO\n 0.5\n",
    "PORO\n 0.5 /\nPORO\n 0.6 /\n",
    "ACTNUM\n 0.5 /\n",
    "ACTNUM\n 2*1 /\n",
    "MAPAXES\n 1 2 3 /\n",
    "MAPAXES\n 1 2 3 4 5 z /\n",
    "MAPUNITS\n 'METRES /\n",
    "DIMENS\n 2 2 2 /\n",
    "MINPV\n small /\n",
    "BOX\n 1 0 1 1 1 1 /\n",
    "BOX\n 1 2 1 1 1 1 /\nPORO\n 0.5 /\nENDBOX\n",
    "FAULTS\n 'F' 1 1 1 1 1 1 'U' /\n/\n",
    "FAULTS\n 'F' 1 1 1 1 1 1 /\n/\n",
    "FAULTS\n 'F' 2 1 1 1 1 1 'X' /\n/\n",
    "FAULTS\n 'F' 1 2 1 1 1 1 'X' /\n/\n",
    "FAULTS\n 'F' 1001*1 /\n/\n",
    "MULTFLT\n 'F' much /\n/\n",
    "ADDZCORN\n 5 1 2 1 1 1 1 /\n/\n",
    "ADDZCORN\n 5 1 1 1 1 1 1 1 1 /\n/\n",
    "EQLZCORN\n 5 /\n/\n",
    "ADDZCORN\n 1e308 /\n 1e308 /\n/\n",
    "EQUALS\n PORO 0.5 1 2 1 1 1 1 /\n/\n",
    "EQUALS\n PORO half /\n/\n",
    "EQUALS\n PORO /\n/\n",
    "MULTIPLY\n TRANX 0.5 /\n/\n",
    "COPY\n PERMX PERMY /\n/\n",
    "COPYBOX\n PORO 1 1 /\n/\n",
    "PORO\n 0.5 /\nEQUALREG\n PORO 0.3 1 M /\n/\n",
    "PORO\n 0.5 /\nEQUALREG\n PORO 0.3 one /\n/\n",
    "PORO\n 0.5 /\nEQUALREG\n PORO 0.3 /\n/\n",
    "PORO\n 0.5 /\nEQUALREG\n PORO 0.3 1 Q /\n/\n",
    "PORO\n 0.5 /\nMULTNUM\n 1 /\nMULTIREG\n PORO 2 7 M /\n/\n",
    "PORO\n 0.5 /\nOPERATE\n PORO 6* CUBE PORO /\n/\n",
    "PORO\n 0 /\nOPERATE\n PORO 6* INV PORO /\n/\n",
    "EDIT\nADD\n PORV 1 /\n/\n",
    "CARFIN\n 'L' 1 2 4*1 2 2 2 /\nENDFIN\n",
    "RADFIN\n 'L' 4*1 3 4 /\nENDFIN\n",
    "RADFIN\n 'L' 4*1 3 4 1 /\nENDFIN\n",
    "RADFIN\n 'L' 4*1 3 4 1 1* 0.1 /\nENDFIN\n",
    "RADFIN\n 'L' 4*1 3 4 1 1* 0.1 9 /\nDTHETAV\n 4*80 /\nENDFIN\n",
    "RADFIN4\n 'L' 6*1 3 4 1 /\nENDFIN\n",
    "REFINE\n 'L' /\nENDFIN\n",
    "INCLUDE\n 'gone.inc' /\n",
    "INCLUDE\n /\n",
    "INCLUDE\n 'CASE.DATA' /\n",
    "IMPORT\n 'gone.bin' /\n",
    "GDFILE\n 'gone.egrid' /\n",
    "SKIP\nPORO\n",
    "NOECHO\n12 abc\n",
    "words at the end",
];

fn of_decks(all: &mut Sentences) {
    for (title, text) in DECKS {
        all.deck(title, text);
    }
    for (title, from, to) in CHANGES {
        all.changed(title, from, to);
    }
    for text in BEHIND_A_CELL {
        all.cell(text);
    }
    let radial = "RUNSPEC\nRADIAL\nDIMENS\n 1 1 1 /\nGRID\nDTHETAV\n 360 /\nDZ\n 1 /\nTOPS\n 1 /\n";
    all.deck("radial without radii", radial);
    all.deck(
        "radial, a whole circle",
        &format!("{radial}INRAD\n 1 /\nDRV\n 2 /\n"),
    );
    all.deck(
        "radial without room",
        &format!("{radial}INRAD\n 1 /\nOUTRAD\n 1 /\n"),
    );
    all.deck(
        "dual porosity of odd layers",
        &format!("RUNSPEC\nDUALPORO\nGRID\n{CELL}"),
    );
    all.deck(
        "depths that are cut off",
        CELL.trim_end().trim_end_matches('/'),
    );
}

fn of_files_of_decks(all: &mut Sentences) {
    let deck = |text: &str| ("CASE.DATA", text.as_bytes().to_vec());
    all.decks("a binary file", &[("CASE.DATA", fixtures::egrid())]);
    all.decks(
        "an error in an included file",
        &[
            deck("\nINCLUDE\n 'A.INC' /\n"),
            ("A.INC", b"SPECGRID\n 1 1 /\n".to_vec()),
        ],
    );
    all.decks(
        "GDFILE that is not there",
        &[deck("GDFILE\n 'gone.egrid' /\n")],
    );
    let other = [
        deck("SPECGRID\n 2 1 1 /\nGDFILE\n 'A.EGRID' /\n"),
        ("A.EGRID", fixtures::egrid()),
    ];
    all.decks("GDFILE of another grid", &other);
    let mut damaged = fixtures::egrid();
    damaged.truncate(900);
    all.decks(
        "GDFILE that is cut off",
        &[deck("GDFILE\n 'A.EGRID' /\n"), ("A.EGRID", damaged)],
    );
    let chain = |n: usize| (n.to_string(), format!("INCLUDE\n '{}' /\n", n + 1));
    let chain: MemoryFiles = (0..70).map(chain).collect();
    let nested = Grdecl::read_from(&chain, Path::new("0"), &[], &mut Warnings::default());
    // The chain itself is told too, and is long.
    let nested = nested.map_err(|mut error| {
        error.included_from.truncate(1);
        error
    });
    all.add("includes that are too deep", &Warnings::default(), nested);
    let files = MemoryFiles::from_iter([("A", "PORO\n 0.5 /\n")]);
    let large = DeckCells::read_from(
        &files,
        &["A".into()],
        [usize::MAX, 2, 2],
        &mut Warnings::default(),
    );
    all.add(
        "a grid beyond all memory",
        &Warnings::default(),
        large.map_err(|mut error| {
            error.message = error.message.replace(&usize::MAX.to_string(), "N");
            error
        }),
    );
    let many: String = (0..20).map(|n| format!(" A{n} 1 /\n")).collect();
    let sizes = "EQUALS\n DX 1 /\n DY 1 /\n DZ 1 /\n TOPS 1 /\n";
    let blank = " ".repeat(100_000);
    all.deck(
        "arrays beyond all memory",
        &format!("DIMENS\n 1000 1000 90 /\n{blank}\n{sizes}{many}/\n"),
    );
}

fn of_records(all: &mut Sentences) {
    let whole = fixtures::init();
    let poro = whole.windows(4).position(|w| w == b"PORO").unwrap();
    let changed = |at: usize, bytes: &[u8]| {
        let mut changed = whole.clone();
        changed[at..at + bytes.len()].copy_from_slice(bytes);
        changed
    };
    let f64s = |file: &RecordFile, entry: &Entry| match entry.is_numeric() {
        true => file.f64s(entry).map(drop),
        false => Ok(()),
    };
    all.records("an empty file", b"", f64s);
    all.records("another file", b"This is text.", f64s);
    all.records("one that ends within a header", &whole[..poro + 4], f64s);
    all.records(
        "one that ends within values",
        &whole[..whole.len() - 3],
        f64s,
    );
    all.records("a damaged marker", &changed(poro - 4, &[0, 0, 0, 17]), f64s);
    all.records(
        "a negative count",
        &changed(poro + 8, &(-1_i32).to_be_bytes()),
        f64s,
    );
    all.records(
        "a count that is too large",
        &changed(poro + 8, &i32::MAX.to_be_bytes()),
        f64s,
    );
    all.records("an unknown type", &changed(poro + 12, b"QUAD"), f64s);
    all.records(
        "a long count without its second header",
        &changed(poro + 12, b"X231"),
        f64s,
    );
    all.records(
        "blocks that do not agree",
        &changed(poro + 20, &[0, 0, 0, 2]),
        f64s,
    );
    let types = written(|out| {
        out.chars("NAMES", &["A"]).unwrap();
    });
    all.records("strings as numbers", &types, |file, entry| {
        file.f32s(entry).map(drop)
    });
    all.records("strings as integers", &types, |file, entry| {
        file.i32s(entry).map(drop)
    });
    all.records("strings as logicals", &types, |file, entry| {
        file.bools(entry).map(drop)
    });
    let numbers = written(|out| out.real("PORO", &[0.5]).unwrap());
    all.records("numbers as strings", &numbers, |file, entry| {
        file.strings(entry).map(drop)
    });
    all.records("a value that is not there", &numbers, |file, entry| {
        file.f32_at(entry, 7).map(drop)
    });
    for text in [
        " 'PORO    '           2 'REAL'\n 0.5\n",
        " 'PORO    '           2 'REAL'\n 0.5 many\n",
        " 'PORO    '           1 'REAL'\n 0.5 0.5\n 'NTG     '           1 'REAL'\n 1\n",
        " 'PORO    '           1 'REAL'\n 0.5\n'PERMX'\n",
        " 'NAMES   '           1 'CHAR'\n TOPS\n",
    ] {
        all.records(
            &format!("formatted: {}", text.replace('\n', " | ")),
            text.as_bytes(),
            f64s,
        );
    }
    let mut warnings = Warnings::default();
    let cut = init::from_bytes(
        ("CASE.INIT", whole[..whole.len() - 3].to_vec()),
        &mut warnings,
    );
    all.add("an INIT that is cut off", &warnings, cut);
}

fn of_grids(all: &mut Sentences) {
    let grid = |out: &mut RecordWriter<Vec<u8>>| {
        out.inte("GRIDHEAD", &[1, 1, 1, 1]).unwrap();
        out.real("COORD", &[0.5; 24]).unwrap();
        out.real("ZCORN", &[0.5; 8]).unwrap();
    };
    all.egrid("no grid", |out| out.real("PORO", &[0.5]).unwrap());
    all.egrid("a short head", |out| out.inte("GRIDHEAD", &[1, 1]).unwrap());
    all.egrid("another type", |out| {
        out.inte("GRIDHEAD", &[2, 1, 1, 1]).unwrap()
    });
    all.egrid("no cells", |out| {
        out.inte("GRIDHEAD", &[1, 0, 1, 1]).unwrap()
    });
    all.egrid("too many cells", |out| {
        out.inte("GRIDHEAD", &[1, 99999, 99999, 9]).unwrap()
    });
    all.egrid("no pillars", |out| {
        out.inte("GRIDHEAD", &[1, 1, 1, 1]).unwrap()
    });
    all.egrid("pillars of another grid", |out| {
        out.inte("GRIDHEAD", &[1, 2, 1, 1]).unwrap();
        out.real("COORD", &[0.5; 24]).unwrap();
        out.real("ZCORN", &[0.5; 8]).unwrap();
    });
    all.egrid("activity of another grid", |out| {
        grid(out);
        out.inte("ACTNUM", &[1, 1]).unwrap();
    });
    all.egrid("map axes of five numbers", |out| {
        out.real("MAPAXES", &[1.0; 5]).unwrap();
        grid(out);
    });
    all.egrid("several coordinate systems", |out| {
        out.inte("GRIDHEAD", &[1, 1, 1, 1]).unwrap();
        out.real("COORD", &[0.5; 48]).unwrap();
        out.real("ZCORN", &[0.5; 8]).unwrap();
    });
    all.egrid("a radial grid", |out| {
        let mut head = [0; 27];
        head[..4].fill(1);
        head[26] = 1;
        out.inte("GRIDHEAD", &head).unwrap();
        out.real("COORD", &[0.5; 24]).unwrap();
        out.real("ZCORN", &[0.5; 8]).unwrap();
    });
    all.egrid("a damaged local grid", |out| {
        grid(out);
        out.chars("LGR", &["FINE"]).unwrap();
        out.inte("GRIDHEAD", &[1, 2, 2]).unwrap();
        out.mess("ENDLGR").unwrap();
    });
    all.egrid("connections to cells that are not there", |out| {
        grid(out);
        out.inte("NNCHEAD", &[1, 0]).unwrap();
        out.inte("NNC1", &[1]).unwrap();
        out.inte("NNC2", &[9]).unwrap();
    });
}

fn of_legacy_grids(all: &mut Sentences) {
    let legacy = |out: &mut RecordWriter<Vec<u8>>, cell: [i32; 3], corners: usize| {
        out.inte("COORDS", &[cell[0], cell[1], cell[2], 1, 1])
            .unwrap();
        out.real("CORNERS", &vec![0.5; corners]).unwrap();
    };
    all.egrid("legacy: no dimensions", |out| legacy(out, [1; 3], 24));
    all.egrid("legacy: a cell outside", |out| {
        out.inte("DIMENS", &[1, 1, 1]).unwrap();
        legacy(out, [2, 1, 1], 24);
    });
    all.egrid("legacy: half the corners", |out| {
        out.inte("DIMENS", &[1, 1, 1]).unwrap();
        legacy(out, [1, 1, 1], 12);
    });
    all.egrid("legacy: radial", |out| {
        out.inte("DIMENS", &[1, 1, 1]).unwrap();
        out.chars("RADIAL", &["TRUE"]).unwrap();
        legacy(out, [1, 1, 1], 24);
    });
    all.egrid("legacy: a cell is missing", |out| {
        out.inte("DIMENS", &[1, 1, 2]).unwrap();
        legacy(out, [1, 1, 1], 24);
    });
}

fn of_results(all: &mut Sentences) {
    let step = |out: &mut RecordWriter<Vec<u8>>, report: i32, head: &[i32]| {
        out.inte("SEQNUM", &[report]).unwrap();
        out.inte("INTEHEAD", head).unwrap();
    };
    all.restart("no restart", |out| out.real("PORO", &[0.5]).unwrap());
    all.restart("steps without SEQNUM and times", |out| {
        out.inte("INTEHEAD", &[0; 70]).unwrap()
    });
    all.restart("a step without a head", |out| {
        out.inte("SEQNUM", &[1]).unwrap();
        out.real("SWAT", &[0.5]).unwrap();
        step(out, 2, &[0; 70]);
    });
    all.restart("a report twice", |out| {
        step(out, 1, &[0; 70]);
        step(out, 1, &[0; 70]);
    });
    all.restart("wells that are fewer than the head says", |out| {
        let mut head = [0; 70];
        (head[16], head[24], head[27]) = (3, 12, 1);
        step(out, 1, &head);
        out.inte("IWEL", &[1; 12]).unwrap();
        out.chars("ZWEL", &["P1"]).unwrap();
    });
    all.summary("no summary", fixtures::init());
    let spec = |out: &mut RecordWriter<Vec<u8>>, keyword: &str| {
        out.inte("DIMENS", &[1, 1, 1, 1]).unwrap();
        out.chars("KEYWORDS", &[keyword]).unwrap();
        out.chars("WGNAMES", &[""]).unwrap();
        out.inte("NUMS", &[0]).unwrap();
        out.chars("UNITS", &["DAYS"]).unwrap();
        out.inte("STARTDAT", &[1, 1, 2000]).unwrap();
    };
    all.summary("no steps", written(|out| spec(out, "TIME")));
    all.summary(
        "no times",
        written(|out| {
            spec(out, "FOPR");
            out.inte("MINISTEP", &[0]).unwrap();
            out.real("PARAMS", &[1.0]).unwrap();
        }),
    );
    all.summary(
        "steps of another length",
        written(|out| {
            spec(out, "TIME");
            for values in [vec![1.0], vec![1.0, 2.0]] {
                out.inte("MINISTEP", &[0]).unwrap();
                out.real("PARAMS", &values).unwrap();
            }
        }),
    );
    let mut warnings = Warnings::default();
    let read = Summary::extended_from_bytes(("CASE.ESMRY", fixtures::init()), &mut warnings);
    all.add("no ESMRY", &warnings, read);
}

fn of_images(all: &mut Sentences) {
    all.volume("volume: no format", "CASE.FILE", b"text".to_vec());
    all.volume("volume: raw samples alone", "CASE.raw", vec![0; 8]);
    let head =
        "NRRD0005\ntype: short\ndimension: 3\nsizes: 2 1 2\nendian: little\nencoding: raw\n\n";
    let nrrd = format!("{head}\0\0\0\0\0\0\0\0");
    for (title, from, to) in [
        ("no type", "type: short\n", ""),
        ("an unknown type", "short", "block"),
        ("another dimension", "dimension: 3", "dimension: 2"),
        ("five axes", "3\nsizes: 2 1 2", "5\nsizes: 1 1 2 1 2"),
        (
            "samples beyond all memory",
            "2 1 2",
            "4294967296 4294967296 2",
        ),
        ("no number", "2 1 2", "2 one 2"),
        ("more samples", "2 1 2", "2 2 2"),
        ("no order of bytes", "endian: little\n", ""),
        ("another encoding", "raw", "bzip2"),
        ("compressed from too much", "raw", "gzip"),
        ("no field", "endian: little", "little"),
        ("no end", "\n\n", "\n#"),
        (
            "a vector of two numbers",
            "endian",
            "space directions: (1,0) (0,1) (1,1)\nendian",
        ),
        ("another file", "endian", "data file: A.raw\nendian"),
        (
            "components",
            "2 1 2\n",
            "2 1 2\nkinds: vector domain domain\n",
        ),
        ("numbers of text", "raw", "ascii"),
        ("spacing without end", "endian", "spacings: inf 1 1\nendian"),
    ] {
        all.image(&format!("NRRD: {title}"), &nrrd, from, to);
    }
    let meta =
        "NDims = 3\nDimSize = 2 1 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n\0\0\0\0";
    for (title, from, to) in [
        ("no samples", "ElementDataFile", "Data"),
        ("an unknown type", "UCHAR", "STRING"),
        ("another number of axes", "NDims = 3", "NDims = 4"),
        ("slices that are not there", "LOCAL", "LIST\n"),
        ("slices without an end", "LOCAL", "a%d 1 99999999999 1"),
        ("more samples", "2 1 2", "2 2 2"),
    ] {
        all.image(&format!("MetaImage: {title}"), meta, from, to);
    }
    for (title, from, to) in [
        ("another kind of file", "\"ImageData\"", "\"PolyData\""),
        ("another compression", "vtkZLib", "vtkLZ4"),
        ("an extent of two numbers", "0 1 0 0 0 0", "0 1"),
        ("no array", "DataArray", "Array"),
        ("a damaged block", "eJxj", "eJAA"),
        ("another length", "0 1 0 0 0 0", "0 2 0 0 0 0"),
        ("no base64", "AQAA", "A*AA"),
        (
            "more blocks than bytes",
            "AQAAAAIAAAAAAAAA",
            "////fwIAAAAAAAAA",
        ),
        ("pieces", "<Piece>", "<Piece></Piece><Piece>"),
    ] {
        all.image(&format!("VTK: {title}"), fixtures::VTI, from, to);
    }
    let json = r#"{"size": [2, 1, 2], "type": "u8", "file": "A.raw"}"#;
    for (title, from, to) in [
        ("from memory", "A.raw", "B.raw"),
        ("an unknown type", "\"u8\"", "\"byte\""),
        ("an unknown key", "type", "kind"),
        ("no size", "[2, 1, 2]", "[2, 1]"),
        ("no JSON", "}", ""),
    ] {
        all.image(&format!("raw: {title}"), json, from, to);
    }
}

fn of_surveys(all: &mut Sentences) {
    let survey = fixtures::segy(4);
    let length = 240 + 16;
    let mut changed = |title: &str, changes: &[(usize, &[u8])]| {
        let mut bytes = survey.clone();
        for (number, value) in changes {
            bytes[number - 1..number - 1 + value.len()].copy_from_slice(value);
        }
        all.volume(&format!("SEG-Y: {title}"), "CASE.sgy", bytes);
    };
    changed("a place without a trace", &[]);
    changed("an unknown format code", &[(3225, &[0, 4])]);
    changed("another number of samples", &[(3221, &[0, 9])]);
    changed(
        "another number of samples in all headers",
        &[(3221, &[0, 9]), (3715, &[0, 9])],
    );
    changed("another interval", &[(3217, &[0, 9])]);
    changed("another start", &[(3600 + 109, &[0, 9])]);
    changed(
        "a number far away",
        &[(3600 + 189, &[0x7f, 0xff, 0xff, 0xff])],
    );
    changed("a repeated trace", &[(3600 + length + 193, &[0, 0, 0, 20])]);
    changed("a dead trace", &[(3600 + 29, &[0, 2])]);
    changed("a trace far away", &[(3600 + 181, &[0x7f, 0, 0, 0])]);
    changed(
        "a trace some bins away",
        &[(3600 + 181, &102_000_i32.to_be_bytes())],
    );
    changed("degrees", &[(3600 + 89, &[0, 2])]);
    changed("swapped bytes", &[(3297, &[2, 1, 4, 3])]);
    changed(
        "several headers of a trace",
        &[(3501, &[2, 0]), (3507, &[0, 0, 0, 1])],
    );
    changed(
        "more traces than bytes",
        &[(3501, &[2, 0]), (3513, &[1; 8])],
    );
    changed("text headers without an end", &[(3505, &[0xff, 0xff])]);
    all.volume("SEG-Y: no trace", "CASE.sgy", survey[..3700].to_vec());
}

fn of_roff(all: &mut Sentences) {
    all.roff("ROFF: another file", "roff-asc", "roff");
    all.roff("ROFF: no tag", "tag filedata", "filedata");
    all.roff("ROFF: an unknown type", "int nX 1", "long nX 1");
    all.roff("ROFF: no dimensions", "tag dimensions", "tag sizes");
    all.roff(
        "ROFF: dimensions beyond all memory",
        "int nX 1",
        "int nX 2147483647",
    );
    all.roff("ROFF: a word as a number", "0.25", "quarter");
    all.roff(
        "ROFF: a property without values",
        "array float data 1\n0.25\n",
        "",
    );
    all.roff(
        "ROFF: a count that is too large",
        "data 24",
        "data 25000000",
    );
    all.roff("ROFF: too few values", "data 24\n0 ", "data 23\n");
    all.roff(
        "ROFF: another splitting",
        "1 1 1 1 1 1 1 1",
        "1 1 1 1 1 1 1 3",
    );
}

fn of_resqml(all: &mut Sentences) {
    let mut object = |title: &str, kind: &str, from: &str, to: &str| {
        let package = fixtures::package(kind, |bytes| {
            let text = String::from_utf8(bytes).unwrap();
            assert!(text.contains(from), "{from}");
            text.replace(from, to).into_bytes()
        });
        all.add(title, &Warnings::default(), properties::resqml(package));
    };
    let grid = "IjkGrid";
    object(
        "RESQML: no number",
        grid,
        ">2</resqml2:Ni>",
        ">two</resqml2:Ni>",
    );
    object(
        "RESQML: more cells than arrays",
        grid,
        ">2</resqml2:Ni>",
        ">3</resqml2:Ni>",
    );
    object(
        "RESQML: dimensions beyond all memory",
        grid,
        ">2</resqml2:Ni>",
        ">99999999999</resqml2:Ni>",
    );
    object("RESQML: no layers", grid, "resqml2:Nk", "resqml2:Mk");
    object(
        "RESQML: no geometry",
        grid,
        "resqml2:Geometry",
        "resqml2:Genealogy",
    );
    object(
        "RESQML: another form of points",
        grid,
        "Point3dHdf5Array",
        "Point3dLatticeArray",
    );
    object("RESQML: a direction", grid, ">down<", ">not monotonic<");
    object("RESQML: no such dataset", grid, "/Points<", "/Nodes<");
    object(
        "RESQML: a unit of angles",
        "LocalDepth",
        "\"dega\"",
        "\"mila\"",
    );
    object("RESQML: another system", grid, "LocalCrs", "LocalTime");
    object(
        "RESQML: another version",
        "[Content",
        "version=2.0;type=obj_Ijk",
        "version=2.2;type=Ijk",
    );
    object(
        "RESQML: no file",
        "[Content",
        "EpcExternalPartReference\"",
        "Nothing\"",
    );
    object(
        "RESQML: a part that is not there",
        "[Content",
        "/obj_Ijk",
        "/Ijk",
    );
}

fn of_cases(all: &mut Sentences) {
    let folder = tempfile::tempdir().unwrap();
    let told = |error: ParseError| {
        let place = folder.path().display().to_string();
        let mut error = error;
        error.message = error.message.replace(&place, "FOLDER");
        let path = error.path.display().to_string();
        error.path = path.replace(&place, "FOLDER").into();
        error
    };
    let at = |name: &str| folder.path().join(name);
    let none = Warnings::default();
    all.add(
        "case: an empty folder",
        &none,
        case::find(folder.path()).map_err(told),
    );
    all.add(
        "case: nothing of the name",
        &none,
        case::find(&at("CASE")).map_err(told),
    );
    std::fs::write(at("CASE.EPC"), "").unwrap();
    std::fs::write(at("CASE.EGRID"), fixtures::egrid()).unwrap();
    std::fs::write(at("CASE.SMSPEC"), fixtures::summary(false)).unwrap();
    all.add(
        "case: another file of the case",
        &none,
        case::find(&at("CASE.DATA")).map_err(told),
    );
    let with = |name: &str| case::find_with(&at("CASE.EGRID"), &[at(name)]).map_err(told);
    all.add(
        "case: an added file that is not there",
        &none,
        with("GONE.INIT"),
    );
    all.add("case: a grid as an added file", &none, with("CASE.EGRID"));
    all.add("case: RESQML as an added file", &none, with("CASE.EPC"));
    all.add(
        "case: half of the curves as an added file",
        &none,
        with("CASE.SMSPEC"),
    );
    let lonely = case::find_summary(&at("CASE.EGRID")).map(drop);
    all.add("case: no curves", &none, lonely.map_err(told));
    let read = Egrid::read(&at("GONE.EGRID"), &mut Warnings::default());
    all.add("a file that is not there", &none, read.map_err(told));
    let read = Egrid::read(folder.path(), &mut Warnings::default());
    all.add("a folder as a file", &none, read.map_err(told));
}

fn of_wells(all: &mut Sentences) {
    let paths = |all: &mut Sentences, title: &str, text: &str| {
        let mut warnings = Warnings::default();
        let read = paths::from_bytes(("A.dev", text.to_owned()), &mut warnings);
        all.add(&format!("paths: {title}"), &warnings, read);
    };
    paths(all, "no rows", "WELLNAME: A\n");
    paths(all, "a word in a row", "WELLNAME: A\n1 2 3\n1 2x 3 4\n");
    paths(all, "a short row", "X Y TVD MD\n1 2 3 4\n1 2 3\n");
    paths(all, "two columns", "A\n1 2\n");
    paths(all, "one point", "A\n1 2 3\nB\n1 2 3\n4 5 6\n");
    paths(all, "angles", "MD INCL AZIM\n0 0 0\n");
    paths(all, "binary", "1 2 3\n\0");
    paths(all, "cut JSON", "{\"name\": \"A\", \"path\": [");
    paths(all, "JSON without a path", "{\"name\": \"A\"}");
    paths(all, "JSON without z", "{\"path\": [{\"x\": 1, \"y\": 2}]}");
    let rms = fixtures::RMS_WELL;
    paths(
        all,
        "RMS with a word in a row",
        &rms.replace("1100", "11oo"),
    );
    paths(
        all,
        "RMS with too few logs",
        &rms[..rms.find("MD").unwrap()],
    );
    let schedule = |all: &mut Sentences, title: &str, from: &str, to: &str| {
        let text = fixtures::SCHEDULE.replacen(from, to, 1);
        assert_ne!(text, fixtures::SCHEDULE, "{title}");
        let files = MemoryFiles::from_iter([("CASE.DATA", text)]);
        let path = [Path::new("CASE.DATA")];
        let mut warnings = Warnings::default();
        let read = Schedule::read_from(&files, &path, None, &mut warnings);
        all.add(&format!("schedule: {title}"), &warnings, read);
    };
    schedule(all, "a bad date", "1 FEB 2020", "1 FOO 2020");
    schedule(all, "no layers", "2* 1 2 OPEN", "2* 2* OPEN");
    schedule(all, "layers backward", "2* 1 2 OPEN", "2* 2 1 OPEN");
    schedule(all, "a broken number", "2 2 1 1 SHUT", "2 2.5 1 1 SHUT");
    schedule(all, "an unknown well", " P1 SHUT /", " P9 SHUT /");
    schedule(
        all,
        "an include that is gone",
        "TSTEP",
        "INCLUDE\n 'GONE.SCH' /\nTSTEP",
    );
    schedule(all, "no end", "28 31 /", "28 31");
}

#[test]
fn people_are_told_the_same_word_for_word() {
    let mut all = Sentences::default();
    of_decks(&mut all);
    of_files_of_decks(&mut all);
    of_records(&mut all);
    of_grids(&mut all);
    of_legacy_grids(&mut all);
    of_results(&mut all);
    of_roff(&mut all);
    of_resqml(&mut all);
    of_images(&mut all);
    of_surveys(&mut all);
    of_cases(&mut all);
    of_wells(&mut all);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bytes/sentences.txt");
    if std::env::var_os("UPDATE_SENTENCES").is_some() {
        std::fs::write(&path, &all.0).unwrap();
    }
    let known = std::fs::read_to_string(&path).unwrap_or_default();
    for (said, known) in all.0.lines().zip(known.lines()) {
        assert_eq!(
            said,
            known,
            "\nUPDATE_SENTENCES=1 writes {} anew",
            path.display()
        );
    }
    assert_eq!(all.0.lines().count(), known.lines().count());
}
