//! SEG-Y: lattices from numbers, places by least squares, and what is refused.

use strataray_parsers::volume::{
    self, ByteOrder, Options, Region, SampleType, SegyLayout, SegyOptions, SegyWriter, Vertical,
    VolumeFile,
};
use strataray_parsers::{ErrorKind, ParseError};

use super::{DIMS, value};

/// Numbers of the first trace, and their steps.
const FIRST: [i32; 2] = [1200, 340];
const STEP: [i32; 2] = [2, 3];

fn layout(sample: SampleType, byte_order: ByteOrder) -> SegyLayout {
    SegyLayout {
        sample,
        byte_order,
        samples: DIMS[2],
        interval: 4.0,
        delay: 1500,
        text: "a survey by formula".into(),
    }
}

/// Places of bins, rotated and sheared.
fn place([i, j]: [usize; 2]) -> [f64; 2] {
    let (i, j) = (i as f64, j as f64);
    [
        431_000.0 + 20.0 * i + 7.5 * j,
        6_470_000.0 - 9.0 * i + 21.0 * j,
    ]
}

fn trace([i, j]: [usize; 2]) -> Vec<f32> {
    (0..DIMS[2]).map(|k| value([i, j, k]) as f32).collect()
}

/// Inlines one behind the other, without some traces.
fn bins() -> Vec<[usize; 2]> {
    let all = (0..DIMS[0]).flat_map(|i| (0..DIMS[1]).map(move |j| [i, j]));
    all.filter(|bin| ![[0, 0], [3, 2], [6, 4]].contains(bin))
        .collect()
}

fn write(layout: SegyLayout, bins: &[[usize; 2]]) -> Vec<u8> {
    let mut out = SegyWriter::new(Vec::new(), layout).unwrap();
    for bin in bins {
        let number = |axis: usize| FIRST[axis] + STEP[axis] * bin[axis] as i32;
        out.trace(number(0), number(1), place(*bin), &trace(*bin))
            .unwrap();
    }
    out.finish().unwrap()
}

fn ibm() -> Vec<u8> {
    write(layout(SampleType::Ibm32, ByteOrder::Big), &bins())
}

fn read_by(bytes: Vec<u8>, segy: SegyOptions) -> Result<VolumeFile, ParseError> {
    let options = Options {
        segy,
        ..Options::default()
    };
    volume::from_bytes(("A.sgy", bytes), &options)
}

fn read(bytes: Vec<u8>) -> Result<VolumeFile, ParseError> {
    read_by(bytes, SegyOptions::default())
}

/// Puts a big-endian number at byte `number`, from 1, of the file.
fn put(bytes: &mut [u8], number: usize, value: &[u8]) {
    bytes[number - 1..number - 1 + value.len()].copy_from_slice(value);
}

/// Where the header of a trace begins, counted so that byte 1 of the header is at `start + 1`.
fn header(n: usize) -> usize {
    3600 + n * (240 + 4 * DIMS[2])
}

fn notes(volume: &VolumeFile) -> Vec<String> {
    volume
        .notes
        .iter()
        .map(|note| note.message.clone())
        .collect()
}

fn check_places(volume: &VolumeFile) {
    for bin in [[0, 0], [6, 4], [3, 1]] {
        let found = volume.lattice.place([bin[0] as f64, bin[1] as f64, 2.0]);
        let [x, y] = place(bin);
        assert!(
            (found[0] - x).hypot(found[1] - y) < 0.01,
            "{bin:?} {found:?}"
        );
        assert_eq!(found[2], 1508.0);
    }
}

/// All values, NaN where there is no trace.
fn check_values(volume: &VolumeFile, bins: &[[usize; 2]]) {
    let regions = [
        volume.lattice.region(),
        Region {
            start: [2, 1, 1],
            size: [3, 3, 2],
        },
    ];
    for region in regions.into_iter().chain(volume.slabs(25)) {
        let values = volume.f64s(region).unwrap();
        let [ni, nj, _] = region.size;
        for (n, found) in values.iter().enumerate() {
            let at = [n % ni, n / ni % nj, n / ni / nj];
            let at: [usize; 3] = std::array::from_fn(|axis| at[axis] + region.start[axis]);
            match bins.contains(&[at[0], at[1]]) {
                true => assert_eq!(*found, value(at), "{at:?}"),
                false => assert!(found.is_nan(), "{at:?}"),
            }
        }
    }
}

#[test]
fn a_sheared_survey_with_holes() {
    for order in [ByteOrder::Big, ByteOrder::Little] {
        for kind in [
            SampleType::Ibm32,
            SampleType::F32,
            SampleType::F64,
            SampleType::I8,
            SampleType::U8,
            SampleType::I16,
            SampleType::I24,
            SampleType::I32,
        ] {
            let volume = read(write(layout(kind, order), &bins())).unwrap();
            assert_eq!((volume.sample, volume.byte_order), (kind, order));
            assert_eq!(volume.lattice.dims, DIMS);
            let survey = volume.survey.as_ref().unwrap();
            assert_eq!((survey.first, survey.step), (FIRST, [2, 3]));
            assert_eq!((survey.absent, survey.repeated, survey.traces), (3, 0, 32));
            assert!(survey.residual.unwrap()[1] < 0.01);
            assert_eq!(volume.axes.clone().map(|a| a.unit), ["m", "m", "ms"]);
            assert_eq!(volume.header, layout_text());
            assert_eq!(
                notes(&volume),
                ["places without a trace: 3 of 35; they have no values"]
            );
            assert_eq!(volume.slow_axis(), 0);
            check_places(&volume);
            check_values(&volume, &bins());
        }
    }
}

fn layout_text() -> Vec<String> {
    let mut lines = vec!["C 1 a survey by formula".to_owned()];
    lines.extend((2..=40).map(|n| format!("C{n:2}")));
    lines
}

#[test]
fn traces_in_any_order() {
    let mut shuffled = bins();
    fastrand::Rng::with_seed(3).shuffle(&mut shuffled);
    check_values(
        &read(write(layout(SampleType::F32, ByteOrder::Big), &shuffled)).unwrap(),
        &bins(),
    );
    // Crosslines one behind the other, and a trace that comes twice.
    let mut turned = bins();
    turned.sort_by_key(|[i, j]| (*j, *i));
    turned.push(turned[5]);
    let mut bytes = write(layout(SampleType::F32, ByteOrder::Big), &turned);
    let last = bytes.len() - 4;
    put(&mut bytes, last + 1, &77_f32.to_be_bytes());
    let volume = read(bytes).unwrap();
    assert_eq!(volume.slow_axis(), 1);
    assert_eq!(volume.survey.as_ref().unwrap().repeated, 1);
    assert!(notes(&volume)[0].starts_with("traces with the numbers of another one: 1"));
    check_values(&volume, &bins());
}

#[test]
fn dead_traces_have_no_values() {
    let mut bytes = ibm();
    put(&mut bytes, header(4) + 29, &[0, 2]);
    // What fills a rectangle has no place either.
    put(&mut bytes, header(4) + 181, &[0; 8]);
    let volume = read(bytes).unwrap();
    let alive: Vec<_> = bins()
        .into_iter()
        .enumerate()
        .filter(|(n, _)| *n != 4)
        .map(|(_, b)| b)
        .collect();
    check_values(&volume, &alive);
    check_places(&volume);
    assert!(notes(&volume)[0].starts_with("traces marked as dead: 1"));
}

/// Numbers at other bytes are found where the options say, and their absence is told with what to do.
#[test]
fn bytes_can_be_set() {
    let mut bytes = ibm();
    for n in 0..bins().len() {
        let start = header(n);
        let moved: Vec<u8> = bytes[start + 188..start + 196].to_vec();
        put(&mut bytes, start + 9, &moved[..4]);
        put(&mut bytes, start + 21, &moved[4..]);
        put(
            &mut bytes,
            start + 189,
            &((n as i32 * 37) % 101).to_be_bytes(),
        );
        put(
            &mut bytes,
            start + 193,
            &((n as i32 * 53) % 97).to_be_bytes(),
        );
    }
    let error = read(bytes.clone()).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Mismatch, "{error}");
    let options = SegyOptions {
        inline: 9,
        crossline: 21,
        ..SegyOptions::default()
    };
    let volume = read_by(bytes.clone(), options.clone()).unwrap();
    check_values(&volume, &bins());
    check_places(&volume);
    for (inline, scalar) in [(0, 71), (238, 71), (9, 240), (9, 0), (u16::MAX, 71)] {
        let options = SegyOptions {
            inline,
            scalar,
            ..options.clone()
        };
        let error = read_by(bytes.clone(), options).unwrap_err();
        assert_eq!(error.kind, ErrorKind::BadValue);
    }
}

#[test]
fn places_that_are_no_lattice_are_refused() {
    let mut bytes = ibm();
    // Every other trace is moved by 10 bins.
    for n in (0..bins().len()).step_by(2) {
        put(&mut bytes, header(n) + 181, &43_150_000_i32.to_be_bytes());
    }
    let error = read(bytes.clone()).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Mismatch);
    assert!(error.message.contains("more than half a bin"), "{error}");
    let options = SegyOptions {
        coordinates: false,
        ..SegyOptions::default()
    };
    let volume = read_by(bytes, options).unwrap();
    assert_eq!(
        volume.lattice.place([1.0, 1.0, 0.0]),
        [1202.0, 343.0, 1500.0]
    );
    check_values(&volume, &bins());
    // One trace that is wrong is told.
    let mut bytes = ibm();
    put(&mut bytes, header(7) + 181, &43_109_000_i32.to_be_bytes());
    let volume = read(bytes).unwrap();
    assert!(
        notes(&volume)[1].contains("from its place on the lattice"),
        "{:?}",
        notes(&volume)
    );
}

#[test]
fn places_of_the_source_or_none() {
    let mut bytes = ibm();
    for n in 0..bins().len() {
        put(&mut bytes, header(n) + 181, &[0; 8]);
    }
    let volume = read(bytes.clone()).unwrap();
    check_places(&volume);
    assert!(notes(&volume)[1].contains("those of the source"));
    for n in 0..bins().len() {
        put(&mut bytes, header(n) + 73, &[0; 8]);
    }
    let volume = read(bytes).unwrap();
    assert_eq!(volume.lattice.origin, [1200.0, 340.0, 1500.0]);
    assert_eq!(volume.survey.as_ref().unwrap().residual, None);
    let mut bytes = ibm();
    put(&mut bytes, header(0) + 89, &[0, 2]);
    let volume = read(bytes).unwrap();
    assert!(notes(&volume)[1].contains("degrees"));
}

#[test]
fn a_line() {
    let line: Vec<_> = (0..6).map(|j| [0, j % DIMS[1]]).take(5).collect();
    let mut bytes = write(layout(SampleType::F32, ByteOrder::Big), &line);
    for n in 0..line.len() {
        put(&mut bytes, header(n) + 189, &[0; 8]);
    }
    let volume = read(bytes.clone()).unwrap();
    assert_eq!(volume.lattice.dims, [1, 5, 4]);
    assert_eq!(volume.axes[1].name, "cdp");
    // At a right angle, to the side on which x is of y.
    let [across, along, _] = volume.lattice.edges;
    assert!(
        (along[0] - 7.5).abs() < 1e-6
            && (across[0] - 21.0).abs() < 1e-6
            && (across[1] + 7.5).abs() < 1e-6
    );
    for n in 0..line.len() {
        put(&mut bytes, header(n) + 21, &[0; 4]);
    }
    let volume = read(bytes).unwrap();
    assert_eq!(volume.axes[1].name, "trace");
    assert_eq!(volume.slow_axis(), 1);
}

#[test]
fn intervals_and_lengths() {
    let depth = SegyOptions {
        vertical: Vertical::Depth,
        ..SegyOptions::default()
    };
    let volume = read_by(ibm(), depth).unwrap();
    assert_eq!(
        (volume.axes[2].name.as_str(), volume.axes[2].unit.as_str()),
        ("depth", "m")
    );
    // Without an interval that of the traces counts.
    let mut bytes = ibm();
    put(&mut bytes, 3217, &[0, 0]);
    assert_eq!(read(bytes.clone()).unwrap().lattice.edges[2][2], 4.0);
    for n in 0..bins().len() {
        put(&mut bytes, header(n) + 117, &[0, 0]);
    }
    assert_eq!(read(bytes).unwrap().lattice.edges[2][2], 1.0);
    // The number of samples of the traces, where the file fits with that alone.
    let mut bytes = ibm();
    put(&mut bytes, 3221, &[0, 100]);
    let volume = read(bytes.clone()).unwrap();
    assert_eq!(volume.lattice.dims, DIMS);
    assert!(notes(&volume)[0].contains("those of traces 4"));
    check_values(&volume, &bins());
    put(&mut bytes, header(0) + 115, &[0, 0]);
    assert_eq!(read(bytes).unwrap_err().kind, ErrorKind::Truncated);
    let mut cut = ibm();
    cut.truncate(cut.len() - 1);
    assert_eq!(read(cut).unwrap_err().kind, ErrorKind::Truncated);
    let mut bytes = ibm();
    put(&mut bytes, header(3) + 109, &[0, 8]);
    let error = read(bytes).unwrap_err();
    assert!(
        error.message.contains("begin at different times"),
        "{error}"
    );
    let mut bytes = ibm();
    put(&mut bytes, 3225, &[0, 4]);
    assert_eq!(read(bytes).unwrap_err().kind, ErrorKind::Unsupported);
}

#[test]
fn headers_of_rev_1_and_2() {
    // Extended text headers, of which the number is told or not.
    let plain = ibm();
    let mut extended = plain[..3600].to_vec();
    let end = b"((SEG: EndText))";
    let mut text = vec![b' '; 6400];
    text[3200..3200 + end.len()].copy_from_slice(end);
    extended.extend(text);
    extended.extend(&plain[3600..]);
    for (count, is_read) in [([0, 2], true), ([0xff, 0xff], true), ([0, 1], false)] {
        let mut bytes = extended.clone();
        put(&mut bytes, 3505, &count);
        match read(bytes) {
            Ok(volume) => {
                assert!(is_read);
                check_values(&volume, &bins());
            }
            Err(_) => assert!(!is_read),
        }
    }
    // In rev 0 the number means nothing, whatever it is, and so does the scalar of times.
    for revision in [[0, 0], [7, 7]] {
        let mut bytes = plain.clone();
        put(&mut bytes, 3501, &revision);
        put(&mut bytes, 3505, &[0, 9]);
        put(&mut bytes, header(0) + 215, &[0, 7]);
        check_places(&read(bytes).unwrap());
    }
    let mut bytes = plain.clone();
    for n in 0..bins().len() {
        put(&mut bytes, header(n) + 215, &(-10_i16).to_be_bytes());
    }
    assert_eq!(read(bytes).unwrap().lattice.origin[2], 150.0);
    // Rev 2: more samples, an interval that is no whole number, and a trailer.
    let mut bytes = plain.clone();
    put(&mut bytes, 3501, &[2, 0]);
    put(&mut bytes, 3221, &[0, 0]);
    put(&mut bytes, 3269, &4_i32.to_be_bytes());
    put(&mut bytes, 3273, &2500.5_f64.to_be_bytes());
    put(&mut bytes, 3529, &1_i32.to_be_bytes());
    bytes.extend([b' '; 3200]);
    let volume = read(bytes.clone()).unwrap();
    assert_eq!(volume.lattice.edges[2][2], 2.5005);
    check_values(&volume, &bins());
    put(&mut bytes, 3513, &1000_u64.to_be_bytes());
    assert_eq!(read(bytes.clone()).unwrap_err().kind, ErrorKind::Truncated);
    put(&mut bytes, 3507, &1_i32.to_be_bytes());
    assert_eq!(read(bytes).unwrap_err().kind, ErrorKind::Unsupported);
    // Little-endian without a word about it, as some programs write it.
    let mut bytes = write(layout(SampleType::F32, ByteOrder::Little), &bins());
    put(&mut bytes, 3297, &[0; 4]);
    put(&mut bytes, 3501, &[0; 2]);
    check_values(&read(bytes.clone()).unwrap(), &bins());
    let forced = SegyOptions {
        byte_order: Some(ByteOrder::Big),
        ..SegyOptions::default()
    };
    assert!(read_by(bytes, forced).is_err());
}

/// Without the name the content says what it is.
#[test]
fn known_by_its_content() {
    let volume = volume::from_bytes(("A", ibm()), &Options::default()).unwrap();
    assert_eq!(volume.format, volume::Format::Segy);
    let mut noise = ibm();
    noise[..3200]
        .iter_mut()
        .enumerate()
        .for_each(|(n, b)| *b = (n * 7) as u8);
    let error = volume::from_bytes(("A", noise), &Options::default()).unwrap_err();
    assert_eq!(error.kind, ErrorKind::NotThisFormat);
}

/// Counts that no file has.
#[test]
fn hostile_numbers() {
    let mut bytes = ibm();
    put(&mut bytes, header(0) + 189, &i32::MAX.to_be_bytes());
    put(&mut bytes, header(1) + 193, &i32::MIN.to_be_bytes());
    let error = read(bytes).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Mismatch);
    assert!(error.message.contains("32 traces on a lattice"), "{error}");
    for (number, value) in [
        (3521, u64::MAX),
        (3513, u64::MAX),
        (3273, f64::INFINITY.to_bits()),
    ] {
        let mut bytes = ibm();
        put(&mut bytes, 3501, &[2, 0]);
        put(&mut bytes, number, &value.to_be_bytes());
        assert!(read(bytes).is_err() || number == 3273, "{number}");
    }
}

#[test]
fn writers_refuse() {
    let of = |interval: f64, samples: usize| {
        let layout = SegyLayout {
            interval,
            samples,
            ..layout(SampleType::F32, ByteOrder::Big)
        };
        SegyWriter::new(Vec::new(), layout)
    };
    assert!(of(0.0, 4).is_err() && of(33.0, 4).is_err() && of(0.0005, 4).is_err());
    assert!(of(4.0, 0).is_err() && of(4.0, 70_000).is_err());
    let mut out = of(4.0, 4).unwrap();
    assert!(out.trace(1, 1, [0.0; 2], &[0.0; 3]).is_err());
    assert!(out.trace(1, 1, [1e9, 0.0], &[0.0; 4]).is_err());
    assert!(out.trace(1, 1, [1e6, 0.0], &[0.0; 4]).is_ok());
}
