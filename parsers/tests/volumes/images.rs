//! NRRD, MetaImage, VTK ImageData and raw samples of all types.

use strataray_parsers::volume::{
    self, ByteOrder, Contents, Format, Options, RawLayout, SampleType, metaimage, nrrd, vti,
};
use strataray_parsers::{At, ErrorKind};

use super::{DIMS, apart, check_values, contents, open, rotated, values};

type Write = fn(&Contents, Vec<f64>) -> std::io::Result<Vec<u8>>;

const WRITERS: [(&str, Format, Write); 5] = [
    ("A.nrrd", Format::Nrrd, |c, v| {
        nrrd::write(Vec::new(), c, false, v)
    }),
    ("B.nrrd", Format::Nrrd, |c, v| {
        nrrd::write(Vec::new(), c, true, v)
    }),
    ("A.mha", Format::MetaImage, |c, v| {
        metaimage::write(Vec::new(), c, false, v)
    }),
    ("B.mha", Format::MetaImage, |c, v| {
        metaimage::write(Vec::new(), c, true, v)
    }),
    ("A.vti", Format::Vti, |c, v| vti::write(Vec::new(), c, v)),
];

#[test]
fn all_types_are_read_back() {
    let all = values(rotated().region());
    let mut written = 0;
    for (name, format, write) in WRITERS {
        for kind in SampleType::ALL {
            for order in [ByteOrder::Little, ByteOrder::Big] {
                let contents = contents(kind, order);
                let Ok(bytes) = write(&contents, all.clone()) else {
                    let none = [SampleType::I24, SampleType::U24, SampleType::Ibm32];
                    assert!(none.contains(&kind), "{name} {kind:?}");
                    continue;
                };
                let volume = open(name, bytes).unwrap();
                assert_eq!((volume.format, volume.sample), (format, kind));
                assert!(apart(&volume.lattice, &rotated()) < 1e-9, "{name}");
                assert_eq!(volume.name, "amplitude");
                assert!(volume.notes.is_empty());
                check_values(&volume);
                written += 1;
            }
        }
    }
    assert_eq!(written, 5 * 10 * 2);
}

#[test]
fn compressed_and_raw_twins_are_equal() {
    let all = values(rotated().region());
    let contents = contents(SampleType::I16, ByteOrder::Big);
    for pair in [[0, 1], [2, 3]] {
        let [raw, packed] = pair.map(|n| WRITERS[n].2(&contents, all.clone()).unwrap());
        assert_ne!(raw, packed);
        let [raw_volume, packed_volume] =
            [raw, packed.clone()].map(|bytes| open("A", bytes).unwrap());
        let region = raw_volume.lattice.region();
        assert_eq!(
            raw_volume.f64s(region).unwrap(),
            packed_volume.f64s(region).unwrap()
        );
        // A stream that is cut, and one that is damaged.
        let cut = open("A", packed[..packed.len() - 40].to_vec()).unwrap();
        assert_eq!(cut.f64s(region).unwrap_err().kind, ErrorKind::Truncated);
        let mut damaged = packed;
        let middle = damaged.len() - 60;
        damaged[middle..middle + 20].fill(0xff);
        let damaged = open("A", damaged).unwrap();
        assert!(damaged.f64s(region).is_err());
        // An error does not spoil the next reading.
        assert!(damaged.f64s(region).is_err());
    }
}

#[test]
fn samples_that_are_cut_are_refused() {
    let all = values(rotated().region());
    for n in [0, 2, 4] {
        let (name, _, write) = WRITERS[n];
        let bytes = write(&contents(SampleType::F64, ByteOrder::Little), all.clone()).unwrap();
        let cut = bytes[..bytes.len() - 100].to_vec();
        let error = open(name, cut).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Truncated, "{error}");
        assert!(open(name, bytes).is_ok());
    }
}

#[test]
fn writers_refuse_what_they_cannot_say() {
    let all = values(rotated().region());
    let mut sheared = contents(SampleType::F32, ByteOrder::Little);
    sheared.lattice.edges[1][0] += 5.0;
    for (name, _, write) in WRITERS {
        let right = contents(SampleType::U8, ByteOrder::Little);
        assert!(write(&right, all.clone()).is_ok());
        assert!(write(&right, all[1..].to_vec()).is_err(), "{name} too few");
        let mut wrong = all.clone();
        wrong[3] = 256.0;
        assert!(write(&right, wrong.clone()).is_err(), "{name} no u8");
        wrong[3] = f64::NAN;
        assert!(write(&right, wrong).is_err(), "{name} NaN");
        let is_written = write(&sheared, all.clone());
        assert_eq!(is_written.is_ok(), name.ends_with("nrrd"), "{name}");
        if let Ok(bytes) = is_written {
            let volume = open(name, bytes).unwrap();
            assert!(apart(&volume.lattice, &sheared.lattice) < 1e-9);
            assert!(apart(&volume.lattice, &rotated()) > 4.0);
        }
    }
}

/// `null` of a file, or of the options where the file has none, stands for no value.
#[test]
fn no_values_are_nan() {
    let bytes = nrrd::write(
        Vec::new(),
        &contents(SampleType::I16, ByteOrder::Little),
        false,
        values(rotated().region()),
    );
    let bytes = bytes.unwrap();
    let read = |null| {
        let options = Options {
            null,
            ..Options::default()
        };
        let volume = volume::from_bytes(("A", bytes.clone()), &options).unwrap();
        volume.f32s(volume.lattice.region()).unwrap()
    };
    let expected = values(rotated().region());
    let count = expected.iter().filter(|v| **v == 7.0).count();
    assert!(count > 0);
    let nans = |values: &[f32]| values.iter().filter(|v| v.is_nan()).count();
    assert_eq!(nans(&read(None)), 0);
    assert_eq!(nans(&read(Some(7.0))), count);
    assert_eq!(nans(&read(Some(-999.25))), 0);
    assert_eq!(nans(&read(Some(1e9))), 0, "beyond the type");
}

#[test]
fn components_of_samples() {
    let read = |sizes: &str, kinds: &str, component: usize| {
        let head = format!(
            "NRRD0004\ntype: uint8\ndimension: 4\nsizes: {sizes}\nkinds: {kinds}\nencoding: raw\n\n"
        );
        let bytes = [head.as_bytes(), &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]].concat();
        let options = Options {
            component,
            ..Options::default()
        };
        let volume = volume::from_bytes(("A", bytes), &options)?;
        assert_eq!(volume.notes.iter().count(), 1);
        volume.f64s(volume.lattice.region())
    };
    let inner = |component| read("3 2 2 1", "vector domain domain domain", component);
    assert_eq!(inner(0).unwrap(), [1.0, 4.0, 7.0, 10.0]);
    assert_eq!(inner(2).unwrap(), [3.0, 6.0, 9.0, 12.0]);
    assert_eq!(inner(3).unwrap_err().kind, ErrorKind::BadValue);
    let outer = |component| read("2 2 1 3", "domain domain domain list", component);
    assert_eq!(outer(0).unwrap(), [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(outer(2).unwrap(), [9.0, 10.0, 11.0, 12.0]);
}

#[test]
fn headers_of_nrrd() {
    let head = "NRRD0005\n# made by hand\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 1 2\n\
                space directions: (0,2,0) (-3,0,0) (0,0,4)\nspace origin: (10,20,30)\nspace units: \"mm\" \"mm\" \"mm\"\n\
                kinds: domain domain domain\nendian: big\nencoding: raw\ncontent: a test\nby:=hand\n\n";
    let bytes = [head.as_bytes(), &[0, 1, 0, 2, 0, 3, 0, 4]].concat();
    let volume = open("A", bytes).unwrap();
    assert_eq!(volume.lattice.place([1.0, 0.0, 1.0]), [10.0, 22.0, 34.0]);
    assert_eq!(
        (volume.frame.as_str(), volume.name.as_str()),
        ("left-posterior-superior", "a test")
    );
    assert_eq!(volume.axes[2].unit, "mm");
    assert_eq!(volume.header, ["made by hand", "by:=hand"]);
    assert_eq!(
        volume.f64s(volume.lattice.region()).unwrap(),
        [1.0, 2.0, 3.0, 4.0]
    );
    // Cells begin half a step before their samples.
    let head = "NRRD0002\ntype: uchar\ndimension: 2\nsizes: 2 2\nspacings: 2 4\naxis mins: 10 20\ncenterings: cell node\nencoding: txt\n\n";
    let read = |head: &str| open("A", [head.as_bytes(), b"1 2 3 4"].concat());
    let volume = read(head).unwrap();
    assert_eq!(
        (volume.lattice.dims, volume.lattice.origin),
        ([2, 2, 1], [11.0, 20.0, 0.0])
    );
    let error = read(&head.replace("uchar", "short").replace("txt", "raw")).unwrap_err();
    assert_eq!(
        (error.kind, error.keyword.as_str()),
        (ErrorKind::Truncated, "")
    );
    let error = read(&head.replace("sizes: 2 2", "sizes: 2")).unwrap_err();
    assert_eq!(error.at, At::Line { line: 3, column: 1 });
    for bad in [
        "4294967296 4294967296",
        "99999999999 99999999",
        "0 2",
        "-1 2",
    ] {
        let error = read(&head.replace("sizes: 2 2", &format!("sizes: {bad}"))).unwrap_err();
        assert!(
            matches!(
                error.kind,
                ErrorKind::TooLarge | ErrorKind::BadValue | ErrorKind::WrongCount
            ),
            "{error}"
        );
    }
}

#[test]
fn raw_samples() {
    let bytes: Vec<u8> = values(rotated().region())
        .iter()
        .map(|v| *v as u8)
        .collect();
    let [ni, nj, nk] = DIMS;
    let layout: RawLayout = format!("{ni}x{nj}x{nk}:u8:1,2,4:10,20,30").parse().unwrap();
    let options = Options {
        raw: Some(layout),
        ..Options::default()
    };
    let volume = volume::from_bytes(("A.raw", bytes.clone()), &options).unwrap();
    assert_eq!(volume.lattice.place([1.0; 3]), [11.0, 22.0, 34.0]);
    check_values(&volume);
    let longer = [&bytes[..], &[0; 5]].concat();
    let longer = volume::from_bytes(("A.raw", longer), &options).unwrap();
    assert_eq!(longer.notes.iter().count(), 1);
    let error = open("A.raw", bytes).unwrap_err();
    assert_eq!(error.kind, ErrorKind::NotThisFormat);
    for wrong in [
        "",
        "7x5",
        "7x5x4",
        "7x5x4:u9",
        "7x5x4:u8:1,1",
        "7x5x4:u8:1,1,1:0,0,0:1",
    ] {
        assert!(wrong.parse::<RawLayout>().is_err(), "{wrong}");
    }
}
