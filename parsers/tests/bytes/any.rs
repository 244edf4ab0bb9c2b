//! Properties over arbitrary bytes and arbitrary content: no bytes make a reader panic, and what a writer writes the
//! reader reads back.

use std::path::Path;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;
use strataray_parsers::cells::Head;
use strataray_parsers::deck::{DeckWriter, Grdecl, GridText, MemoryFiles};
use strataray_parsers::egrid::{Egrid, PorosityModel};
use strataray_parsers::records::{RecordFile, RecordWriter};
use strataray_parsers::restart::{self, RestartWriter};
use strataray_parsers::wells::Well;
use strataray_parsers::{Warnings, init};

use super::fixtures::cell;
use super::properties::{BINARY_HEAD, LEGACY_HEAD, READERS, TEXT_HEAD, behind, holds};

/// Text that means something to a reader, so that bytes get beyond the first check.
const WORDS: [&str; 64] = [
    "SPECGRID\n",
    "DIMENS\n",
    "COORD\n",
    "ZCORN\n",
    "ACTNUM\n",
    "PORO\n",
    "BOX\n",
    "ENDBOX\n",
    "EQUALS\n",
    "COPY\n",
    "EQUALREG\n",
    "OPERATE\n",
    "OPERATER\n",
    "MULTNUM\n",
    "EDIT\n",
    "RUNSPEC\n",
    "DUALPORO\n",
    "DPGRID\n",
    "CARFIN\n",
    "L 6*1 2 2 2 /\n",
    "NXFIN\n",
    "REFINE\n",
    "ENDFIN\n",
    "RADIAL\n",
    "INRAD\n",
    "DRV\n",
    "DTHETAV\n",
    "DZ\n",
    "TOPS\n",
    "FAULTS\n",
    "INCLUDE\n",
    "IMPORT\n",
    "GDFILE\n",
    "ADDZCORN\n",
    "GRIDOPTS\n",
    "SKIP\n",
    "PATHS\n",
    "'ANY.FILE' ",
    "'PORO' ",
    "/\n",
    "1 ",
    "2 ",
    "0.5 ",
    "-1 ",
    "1* ",
    "999999999*1 ",
    "-- ",
    "roff-asc\n",
    "tag ",
    "array float data ",
    "endtag\n",
    " 'PORO    '           2 'REAL'\n",
    " 'INTEHEAD'           1 'INTE'\n",
    "\r",
    "WELSPECS\n",
    "COMPDAT\n",
    "WELOPEN\n",
    "DATES\n",
    "TSTEP\n",
    "WLIST\n",
    "'P*' ",
    "1 JAN 2020 ",
    "WELLNAME: A\n",
    "1 2 3\n4 5 6\n",
];

/// Lines and pieces of the headers of volumes.
const VOLUME_WORDS: [&str; 52] = [
    "NRRD0005\n",
    "type: uint8\n",
    "type: float\n",
    "endian: big\n",
    "dimension: 3\n",
    "dimension: 4\n",
    "sizes: 2 1 2\n",
    "sizes: 3 2 1 2\n",
    "sizes: 99999999999 9999999999 1\n",
    "sizes: 0 1 1\n",
    "kinds: vector domain domain domain\n",
    "space directions: (1,0,0) (0,1,0) (0,0,1)\n",
    "space directions: none (0,1,0) (0,0,1) (1\n",
    "space origin: (1,2,3)\n",
    "axis mins: 1 2 nan\n",
    "spacings: 1 nan 3\n",
    "centerings: cell cell cell\n",
    "encoding: raw\n",
    "encoding: gzip\n",
    "encoding: ascii\n",
    "byte skip: -1\n",
    "byte skip: 18446744073709551615\n",
    "line skip: 1\n",
    "line skip: 9223372036854775807\n",
    "data file: LIST\n",
    "data file: a%03d 1 9999999999 1\n",
    "\n",
    "1 2 3 4 ",
    "NDims = 3\n",
    "DimSize = 2 1 2\n",
    "ElementType = MET_UCHAR\n",
    "ElementNumberOfChannels = 2\n",
    "ElementSpacing = 1 0 inf\n",
    "TransformMatrix = 1 0 0 0 1 0 0 0 1\n",
    "BinaryData = False\n",
    "CompressedData = True\n",
    "HeaderSize = -1\n",
    "ElementDataFile = LOCAL\n",
    "ElementDataFile = LIST\n",
    "<VTKFile type=\"ImageData\" header_type=\"UInt64\">",
    "<VTKFile type=\"ImageData\" compressor=\"vtkZLibDataCompressor\">",
    "<ImageData WholeExtent=\"0 1 0 0 0 1\">",
    "<ImageData WholeExtent=\"-1e300 1e300 0 1 0 1\">",
    "<PointData><DataArray type=\"UInt8\" format=\"appended\" offset=\"0\"/></PointData>",
    "<PointData><DataArray type=\"UInt8\" format=\"appended\" offset=\"18446744073709551615\"/>",
    "<CellData><DataArray type=\"UInt8\" format=\"ascii\">",
    "<CellData><DataArray type=\"UInt8\" format=\"binary\">",
    "<AppendedData encoding=\"raw\">_",
    "<AppendedData encoding=\"base64\">_",
    "AQAAAAIAAAAAAAAACgAAAA==",
    "<!-- ",
    "{\"size\": [1, 1, 4], \"type\": \"u8\", \"file\": \"A\"}",
];

fn volume_words() -> impl Strategy<Value = Vec<u8>> {
    let words = vec(select(&VOLUME_WORDS[..]), 0..16);
    (words, vec(any::<u8>(), 0..100))
        .prop_map(|(words, bytes)| [words.concat().into_bytes(), bytes].concat())
}

fn words() -> impl Strategy<Value = Vec<u8>> {
    vec(select(&WORDS[..]), 0..60).prop_map(|words| words.concat().into_bytes())
}

/// Binary arrays whose heads and data need not fit.
fn arrays() -> impl Strategy<Value = Vec<u8>> {
    let names = [
        "GRIDHEAD", "FILEHEAD", "COORD   ", "ZCORN   ", "ACTNUM  ", "INTEHEAD", "SEQNUM  ",
        "DOUBHEAD", "IWEL    ", "ZWEL    ", "ICON    ", "KEYWORDS", "PARAMS  ", "LGR     ",
        "NNC1    ", "START   ", "V0      ", "DIMENS  ",
    ];
    let kinds = [
        *b"INTE", *b"REAL", *b"DOUB", *b"CHAR", *b"LOGI", *b"MESS", *b"X231", *b"C012",
    ];
    let count = prop_oneof![8 => 0..30_i32, 1 => any::<i32>()];
    let word = prop_oneof![4 => 0..5_i32, 1 => any::<i32>()];
    let array = (
        select(names.to_vec()),
        count,
        select(kinds.to_vec()),
        vec(word, 0..30),
    );
    vec(array, 0..12).prop_map(|arrays| {
        let mut bytes = Vec::new();
        for (name, count, kind, words) in arrays {
            let (marker, length) = (16_i32.to_be_bytes(), (4 * words.len() as i32).to_be_bytes());
            let head = [
                &marker[..],
                name.as_bytes(),
                &count.to_be_bytes(),
                &kind,
                &marker,
            ];
            bytes.extend(head.concat());
            if !words.is_empty() {
                bytes.extend(length);
                words
                    .iter()
                    .for_each(|word| bytes.extend(word.to_be_bytes()));
                bytes.extend(length);
            }
        }
        bytes
    })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 500,
        // Failures are mended, and become tests of their own.
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn no_bytes_make_a_reader_panic(bytes in vec(any::<u8>(), 0..2000)) {
        for (_, reader) in READERS {
            for head in [&[], BINARY_HEAD, TEXT_HEAD, LEGACY_HEAD] {
                holds(reader, behind(head, &bytes));
            }
        }
    }

    #[test]
    fn no_words_make_a_reader_panic(text in words()) {
        for (_, reader) in READERS {
            holds(reader, text.clone());
        }
        // Behind a grid, what is done to it is reached.
        let grid = super::fixtures::rich_deck().into_bytes();
        holds(super::properties::deck, [grid, text].concat());
    }

    #[test]
    fn no_headers_of_volumes_make_a_reader_panic(text in volume_words(), bytes in vec(any::<u8>(), 0..400)) {
        holds(super::properties::volume, text.clone());
        for (_, head) in super::fixtures::images([2, 1, 2]) {
            // Beginning as an image does, and going on with anything.
            let start = text.len() * 7 % head.len();
            holds(super::properties::volume, [&head[..start], &text].concat());
        }
        // Words of the binary header and of the first trace.
        let mut survey = super::fixtures::segy(4);
        for pair in bytes.chunks_exact(2) {
            let at = 3200 + usize::from(pair[0]) * 5 / 2;
            survey[at] = pair[1];
        }
        holds(super::properties::segy, survey);
    }

    #[test]
    fn no_arrays_make_a_reader_panic(bytes in arrays()) {
        for (_, reader) in READERS {
            holds(reader, bytes.clone());
        }
    }

    #[test]
    fn arrays_are_read_back(
        whole in vec(any::<i32>(), 0..2500),
        reals in vec(any::<f32>(), 0..2500),
        doubles in vec(any::<f64>(), 0..50),
        flags in vec(any::<bool>(), 0..50),
        strings in vec("[ -~]{0,8}", 0..120),
    ) {
        for is_text in [false, true] {
            let mut out = if is_text {
                RecordWriter::formatted(Vec::new())
            } else {
                RecordWriter::new(Vec::new())
            };
            out.inte("WHOLE", &whole).unwrap();
            out.real("REALS", &reals).unwrap();
            out.doub("DOUBLES", &doubles).unwrap();
            out.logi("FLAGS", &flags).unwrap();
            // Quotes end strings in text.
            let strings: Vec<_> = strings.iter().map(|s| s.replace('\'', "_")).collect();
            out.chars("STRINGS", &strings).unwrap();
            let file = RecordFile::from_bytes(("A", out.finish().unwrap())).unwrap();
            let entry = |name: &str| file.find(name).unwrap();
            prop_assert_eq!(file.i32s(entry("WHOLE")).unwrap(), whole.clone());
            // As text they have eight digits, and fourteen; all that is no number is the same.
            let near = |a: f64, b: f64, digits: f64| {
                a == b || a.is_nan() && b.is_nan() || is_text && (a - b).abs() <= digits * b.abs()
            };
            let read = file.f32s(entry("REALS")).unwrap();
            prop_assert_eq!(read.len(), reals.len());
            for (a, b) in read.iter().zip(&reals) {
                // Numbers near zero have fewer digits.
                let is_small = is_text && b.abs() < f32::MIN_POSITIVE && (a - b).abs() <= 1e-44;
                prop_assert!(is_small || near(f64::from(*a), f64::from(*b), 1e-7), "{} {}", a, b);
            }
            let read = file.f64s(entry("DOUBLES")).unwrap();
            prop_assert_eq!(read.len(), doubles.len());
            for (a, b) in read.iter().zip(&doubles) {
                let is_small = is_text && b.abs() < 1e-300 && (a - b).abs() <= 1e-313;
                prop_assert!(is_small || near(*a, *b, 1e-13), "{} {}", a, b);
            }
            prop_assert_eq!(file.bools(entry("FLAGS")).unwrap(), flags.clone());
            let trimmed: Vec<_> = strings.iter().map(|s| s.trim_end().to_owned()).collect();
            prop_assert_eq!(file.strings(entry("STRINGS")).unwrap(), trimmed);
        }
    }

    #[test]
    fn grids_are_read_back(
        dims in [1..4_usize, 1..4_usize, 1..4_usize],
        seed in any::<u64>(),
        model in select(vec![PorosityModel::Single, PorosityModel::Dual]),
        is_given in any::<bool>(),
    ) {
        let mut random = fastrand::Rng::with_seed(seed);
        let [ni, nj, nk] = dims;
        let mut reals = |n: usize| (0..n).map(|_| 1e4 * (random.f32() - 0.5)).collect::<Vec<_>>();
        let (coord, zcorn) = (reals(6 * (ni + 1) * (nj + 1)), reals(8 * ni * nj * nk));
        let actnum = (0..ni * nj * nk).map(|_| random.i32(0..4)).collect();
        let grid = Egrid {
            dims,
            coord,
            zcorn,
            actnum: is_given.then_some(actnum),
            porosity_model: model,
            ..cell()
        };
        let bytes = grid.write(Vec::new()).unwrap();
        let mut warnings = Warnings::default();
        let read = Egrid::from_bytes(("A.EGRID", bytes), &mut warnings).unwrap();
        prop_assert_eq!(&read, &grid);
        // As a deck, and its properties.
        let poro: Vec<f64> = (0..ni * nj * nk).map(|_| random.f64()).collect();
        let mut out = DeckWriter::new(Vec::new());
        let text = GridText {
            dims,
            coord: &grid.coord,
            zcorn: &grid.zcorn,
            actnum: grid.actnum.as_deref(),
            map_axes: None,
            map_units: None,
            grid_unit: None,
        };
        out.grid(&text).unwrap();
        out.property("PORO", &poro).unwrap();
        let files = MemoryFiles::from_iter([("A", out.finish().unwrap())]);
        let read = Grdecl::read_from(&files, Path::new("A"), &[], &mut warnings).unwrap();
        // A number of the fewest digits that is this one in 32 bits may be another one in 64.
        let narrow = |values: &[f64]| values.iter().map(|v| *v as f32).collect::<Vec<_>>();
        prop_assert_eq!((narrow(&read.coord), narrow(&read.zcorn)), (grid.coord, grid.zcorn));
        prop_assert_eq!((read.actnum, &read.properties[0].values), (grid.actnum, &poro));
    }

    #[test]
    fn results_are_read_back(
        active in 1..40_usize,
        steps in vec((0..1000_u32, 0.0..1e5_f64), 1..5),
        year in 1900..2100_i32,
        seed in any::<u64>(),
    ) {
        let mut random = fastrand::Rng::with_seed(seed);
        let head = Head {
            dims: [active as i32, 1, 1],
            active: active as i32,
            date: format!("{year}-06-30"),
            ..Head::default()
        };
        let values: Vec<f32> = (0..active).map(|_| random.f32()).collect();
        let bytes = init::write(Vec::new(), &head, [("PORO", values.clone())]).unwrap();
        let arrays = init::from_bytes(("A.INIT", bytes), &mut Warnings::default()).unwrap();
        prop_assert_eq!(arrays.values(arrays.find("PORO").unwrap()).unwrap(), values.clone());
        prop_assert_eq!(arrays.head().unwrap().date, head.date.clone());
        let mut out = RestartWriter::new(Vec::new());
        for (report, days) in &steps {
            let pressure = [("PRESSURE", values.clone())];
            out.step(*report, *days, &head, &[Well::named("P1")], pressure).unwrap();
        }
        let bytes = out.finish().unwrap();
        let read = restart::unified_from_bytes(("A.UNRST", bytes), &mut Warnings::default()).unwrap();
        let read: Vec<_> = read.iter().map(|step| (step.report, step.days)).collect();
        prop_assert_eq!(read, steps);
    }
}
