//! Small files of each format.

use strataray_parsers::cells::Head;
use strataray_parsers::egrid::{Egrid, GridUnit, PorosityModel};
use strataray_parsers::init;
use strataray_parsers::records::{Kind, RecordFile, RecordWriter};
use strataray_parsers::restart::RestartWriter;
use strataray_parsers::volume::{
    ByteOrder, Contents, Lattice, SampleType, SegyLayout, SegyWriter, metaimage, nrrd, vti,
};
use strataray_parsers::wells::Well;

/// A deck of one cell, with its corners at depths 0 and 1.
pub const CELL: &str = "SPECGRID\n1 1 1 1 F /\nCOORD\n0 0 0 0 0 1  1 0 0 1 0 1  0 1 0 0 1 1  1 1 0 1 1 1 /\nZCORN\n4*0 4*1 /\n";

/// One cell with a distinct depth per corner.
pub fn cell() -> Egrid {
    let ends = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    Egrid {
        dims: [1; 3],
        coord: ends
            .iter()
            .flat_map(|[x, y]| [*x, *y, 0.0, *x, *y, 1.0])
            .collect(),
        zcorn: (0_u8..8).map(f32::from).collect(),
        actnum: Some(vec![1]),
        coarse: None,
        map_units: None,
        map_axes: None,
        grid_unit: None,
        porosity_model: PorosityModel::Single,
        nnc: Vec::new(),
        local_nnc: Vec::new(),
        reservoirs: Vec::new(),
        local_grids: Vec::new(),
    }
}

/// The text twin of a binary file.
pub fn formatted(binary: &[u8]) -> Vec<u8> {
    let file = RecordFile::from_bytes(("A", binary.to_vec())).unwrap();
    let mut out = RecordWriter::formatted(Vec::new());
    for entry in file.entries() {
        let name = entry.name();
        match entry.kind {
            Kind::Inte => out.inte(name, &file.i32s(entry).unwrap()),
            Kind::Real => out.real(name, &file.f32s(entry).unwrap()),
            Kind::Doub => out.doub(name, &file.f64s(entry).unwrap()),
            Kind::Logi => out.logi(name, &file.bools(entry).unwrap()),
            Kind::Text(width) => out.text(name, width, &file.strings(entry).unwrap()),
            Kind::Mess => out.mess(name),
        }
        .unwrap();
    }
    out.finish().unwrap()
}

pub fn egrid() -> Vec<u8> {
    cell().write(Vec::new()).unwrap()
}

/// Every keyword that the reader knows, on 3 x 2 x 2 cells, and a local grid behind them.
pub fn rich_egrid() -> Vec<u8> {
    let grid = Egrid {
        dims: [3, 2, 2],
        coord: (0_u8..72).map(f32::from).collect(),
        zcorn: (0_u8..96).map(f32::from).collect(),
        actnum: Some((0..12).map(|n| i32::from(n != 6)).collect()),
        coarse: Some(vec![0; 12]),
        map_units: Some("METRES".into()),
        map_axes: Some([0.0, 1.0, 0.0, 0.0, 1.0, 0.0]),
        grid_unit: Some(GridUnit {
            length: "METRES".into(),
            is_map: false,
        }),
        porosity_model: PorosityModel::Dual,
        nnc: vec![[1, 6], [2, 24]],
        ..cell()
    };
    let mut out = RecordWriter::new(grid.write(Vec::new()).unwrap());
    out.chars("LGR", &["FINE"]).unwrap();
    out.chars("LGRPARNT", &[""]).unwrap();
    out.inte("GRIDHEAD", &[1, 2, 2, 2, 1]).unwrap();
    out.real("COORD", &[0.5; 54]).unwrap();
    out.real("ZCORN", &[1.5; 64]).unwrap();
    out.inte("ACTNUM", &[1, 1, 1, 1, 0, 1, 1, 1]).unwrap();
    out.inte("HOSTNUM", &[1; 8]).unwrap();
    out.mess("ENDLGR").unwrap();
    out.inte("NNCHEAD", &[2, 1]).unwrap();
    out.inte("NNCL", &[1, 8]).unwrap();
    out.inte("NNCG", &[2, 3]).unwrap();
    out.finish().unwrap()
}

/// A legacy grid of two cells, of which the file has both.
pub fn legacy() -> Vec<u8> {
    let mut out = RecordWriter::new(Vec::new());
    out.inte("DIMENS", &[2, 1, 1]).unwrap();
    for (i, x) in [(1, 0.0_f32), (2, 1.0)] {
        out.inte("COORDS", &[i, 1, 1, i, 1, 0, 0]).unwrap();
        let corner = |c: u8| {
            [
                x + f32::from(c & 1),
                f32::from(c >> 1 & 1),
                f32::from(c >> 2),
            ]
        };
        let corners: Vec<f32> = (0..8).flat_map(corner).collect();
        out.real("CORNERS", &corners).unwrap();
    }
    out.finish().unwrap()
}

/// A step with two wells, one of them in a local grid too.
pub fn wells() -> Vec<u8> {
    let mut out = RecordWriter::new(Vec::new());
    let mut head = [0; 40];
    for (item, value) in [
        (10, 2),
        (16, 2),
        (17, 2),
        (24, 12),
        (27, 1),
        (32, 15),
        (33, 5),
    ] {
        head[item] = value;
    }
    out.inte("SEQNUM", &[1]).unwrap();
    out.inte("INTEHEAD", &head).unwrap();
    out.logi("LOGIHEAD", &[true; 15]).unwrap();
    out.inte("IWEL", &[2; 24]).unwrap();
    out.chars("ZWEL", &["P1", "I2"]).unwrap();
    out.inte("ICON", &[2; 60]).unwrap();
    out.real("SCON", &[0.5; 20]).unwrap();
    out.chars("LGR", &["FINE"]).unwrap();
    head[16] = 1;
    out.inte("INTEHEAD", &head).unwrap();
    out.inte("IWEL", &[1; 12]).unwrap();
    out.chars("ZWEL", &["I2"]).unwrap();
    out.inte("LGWEL", &[2]).unwrap();
    out.inte("ICON", &[1; 30]).unwrap();
    out.inte("ENDLGR", &[]).unwrap();
    out.finish().unwrap()
}

/// SMSPEC and UNSMRY in one file, as both readers can have it, or an ESMRY.
pub fn summary(is_extended: bool) -> Vec<u8> {
    let mut out = RecordWriter::new(Vec::new());
    if is_extended {
        out.inte("START", &[1, 1, 2000, 0, 0, 0, 0]).unwrap();
        out.text("KEYCHECK", 12, &["TIME", "WOPR:P1"]).unwrap();
        out.chars("UNITS", &["DAYS", "SM3/DAY"]).unwrap();
        out.inte("RSTEP", &[0, 1]).unwrap();
        out.real("V0", &[1.0, 2.0]).unwrap();
        out.real("V1", &[3.0, 4.0]).unwrap();
        return out.finish().unwrap();
    }
    out.inte("DIMENS", &[4, 2, 2, 2]).unwrap();
    out.chars("KEYWORDS", &["TIME", "WOPR", "BPR", "ROFT"])
        .unwrap();
    out.chars("WGNAMES", &["", "P1", "", ""]).unwrap();
    out.inte("NUMS", &[0, 1, 8, 425_986]).unwrap();
    out.chars("UNITS", &["DAYS", "SM3/DAY", "BARSA", "SM3"])
        .unwrap();
    out.inte("STARTDAT", &[1, 1, 2000, 0, 0, 0]).unwrap();
    for n in 0..3_u8 {
        out.inte("SEQHDR", &[i32::from(n)]).unwrap();
        out.real("PARAMS", &[f32::from(n); 4]).unwrap();
    }
    out.finish().unwrap()
}

/// A grid of one cell with a property, as ROFF text.
pub fn roff_text() -> String {
    "roff-asc\n#ROFF file#\ntag filedata\nint byteswaptest 1\nchar filetype \"grid\"\nendtag\n\
     tag dimensions\nint nX 1 int nY 1 int nZ 1\nendtag\n\
     tag cornerLines\narray float data 24\n0 0 -2 0 0 -1  0 1 -2 0 1 -1  1 0 -2 1 0 -1  1 1 -2 1 1 -1\nendtag\n\
     tag zvalues\narray byte splitEnz 8\n1 1 1 1 1 1 1 1\narray float data 8\n-2 -1 -2 -1 -2 -1 -2 -1\nendtag\n\
     tag active\narray bool data 1\n1\nendtag\n\
     tag parameter\nchar name \"PORO\"\narray float data 1\n0.25\nendtag\n"
        .into()
}

/// The same in binary.
pub fn roff_binary() -> Vec<u8> {
    let mut bytes =
        b"roff-bin\0#ROFF file#\0tag\0filedata\0int\0byteswaptest\0\x01\0\0\0endtag\0".to_vec();
    bytes.extend(b"tag\0dimensions\0");
    for name in ["nX", "nY", "nZ"] {
        bytes.extend([b"int\0", name.as_bytes(), b"\0\x01\0\0\0"].concat());
    }
    bytes.extend(b"endtag\0");
    let mut floats = |tag: &str, before: &[u8], values: &[f32]| {
        bytes.extend(
            [
                b"tag\0",
                tag.as_bytes(),
                b"\0",
                before,
                b"array\0float\0data\0",
            ]
            .concat(),
        );
        bytes.extend((values.len() as i32).to_le_bytes());
        values.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        bytes.extend(b"endtag\0");
    };
    let line = |n: u8| [f32::from(n / 2), f32::from(n % 2), -2.0];
    let lines = (0..4).flat_map(|n| [line(n), line(n)]).flatten();
    floats("cornerLines", b"", &lines.collect::<Vec<f32>>());
    let splits = b"array\0byte\0splitEnz\0\x08\0\0\0\x01\x01\x01\x01\x01\x01\x01\x01";
    floats(
        "zvalues",
        splits,
        &[-2.0, -1.0, -2.0, -1.0, -2.0, -1.0, -2.0, -1.0],
    );
    floats("parameter", b"char\0name\0PORO\0", &[0.25]);
    bytes
}

/// An array of every type, and one whose count takes two headers and whose values stand in small blocks.
pub fn records() -> Vec<u8> {
    let mut out = RecordWriter::new(Vec::new());
    out.inte("IN", &[1, -2]).unwrap();
    out.real("RE", &[0.5; 3]).unwrap();
    out.doub("DO", &[0.25; 2]).unwrap();
    out.logi("LO", &[true, false]).unwrap();
    out.chars("CH", &["ONE", "TWO"]).unwrap();
    out.text("TX", 12, &["ELEVEN CHARS"]).unwrap();
    out.mess("ME").unwrap();
    let mut bytes = out.finish().unwrap();
    for (count, kind) in [(0_i32, b"X231"), (6, b"REAL")] {
        let marker = 16_i32.to_be_bytes();
        let count = count.to_be_bytes();
        bytes.extend([&marker, &b"BLOCKS  "[..], &count, kind, &marker].concat());
    }
    for _ in 0..3 {
        let marker = 8_i32.to_be_bytes();
        bytes.extend([&marker[..], &[0x40; 8], &marker].concat());
    }
    bytes
}

/// What the heads of [`init`] and [`restart`] say.
pub fn head() -> Head {
    Head {
        dims: [1; 3],
        active: 1,
        date: "2001-06-30".into(),
        ..Head::default()
    }
}

pub fn init() -> Vec<u8> {
    let arrays = [("PORO", vec![0.25]), ("PERMX", vec![100.0])];
    init::write(Vec::new(), &head(), arrays).unwrap()
}

/// Steps with these reports, as many days after the start, each with a PRESSURE of 100 more than that.
pub fn restart(reports: [u32; 2]) -> Vec<u8> {
    let mut writer = RestartWriter::new(Vec::new());
    for report in reports {
        let pressure = [("PRESSURE", vec![100.0 + report as f32])];
        let days = f64::from(report);
        let wells = ["P1", "I2"].map(Well::named);
        writer
            .step(report, days, &head(), &wells, pressure)
            .unwrap();
    }
    writer.finish().unwrap()
}

/// A deck of 3 x 2 x 2 cells with most of what the reader knows; it includes `PORO.INC`.
pub fn rich_deck() -> String {
    let coord: String = (0..12)
        .map(|pillar| format!(" {0} {1} 0.5 {0} {1} 9.5\n", pillar % 4, pillar / 4))
        .collect();
    let zcorn: String = (0..4)
        .map(|plane| format!("24*{plane}.25 -- plane\n"))
        .collect();
    format!(
        "SPECGRID\n3 2 2 1 F /\nMAPAXES\n0 1 0 0 1 0 /\nGRIDUNIT\n'METRES' ' ' /\nGDORIENT\nINC INC INC DOWN RIGHT /\n\
         COORD\n{coord}/\nZCORN\n{zcorn}/\nACTNUM\n6*1 0 5*1 /\nINCLUDE\n 'PORO.INC' /\n\
         FAULTS\n'F1' 1 1 1 2 1 2 'X' /\n/\nMULTFLT\n'F*' 0.1 /\n/\nBOX\n1 2 1 1 1 2 /\nNTG\n4*0.5 /\nENDBOX\n\
         EQUALS\n PORO 0.2 1 1 1 1 1 1 /\n PERMX 50 /\n/\nCOPY\n PERMX PERMY /\n/\nADDZCORN\n 1.5 1 2 /\n/\n\
         PINCH\n/\nSATNUM\n 1 2 3 4 5 6\n 1 2 3 4 5 6 /\n"
    )
}

/// The file that [`rich_deck`] includes.
pub const PORO: &str = "PORO\n 12*0.25 / of all cells\n";

/// Wells of a cell grid, over two dates.
pub const SCHEDULE: &str = "START
 1 JAN 2020 /
SCHEDULE
WELSPECS
 'P1' 'G' 1 1 1* OIL /
 'I1' 'G' 2 2 1* WATER /
/
COMPDAT
 'P1' 2* 1 2 OPEN 3* 0.3 3* X /
 'I1' 2 2 1 1 SHUT /
/
WCONPROD
 'P*' OPEN ORAT 100 /
/
DATES
 1 FEB 2020 /
/
WCONINJE
 I1 WATER OPEN RATE 50 /
/
WELOPEN
 P1 SHUT /
 I1 OPEN 2 2 1 /
/
TSTEP
 28 31 /
";

/// Paths of two wells, with names and columns.
pub const PATHS: &str = "# two wells
X Y TVD MD
WELLNAME: A-1
6507.1 725 2542 2590
6523.5 757 2549 2626.6
-999
'B 2'
550.7, 1020.2, 2410, 2410
551, 1004.1, 2422.2, 2430.2
555.2, 993.9, 2425, 2441.6
";

/// A well of RMS with two logs.
pub const RMS_WELL: &str = "1.0
Undefined
A 1 461499.9 5932000.1 25.5
2
MD UNK lin
Facies DISC 0 Shale 1 Sand
461499.9 5932000.1 1000 1025.5 0
461500.9 5932001.1 1100 1127.5 1
";

/// A path as ResInsight writes it.
pub const JSON_PATH: &str = r#"{"name": "A-1", "path": [
 {"x": 1, "y": 2, "z": 3, "md": 4},
 {"x": 1.5, "y": 2.5, "z": 30, "md": 34}
]}"#;

/// Images of `dims` samples: raw and compressed, in each format.
pub fn images(dims: [usize; 3]) -> Vec<(&'static str, Vec<u8>)> {
    let contents = Contents {
        lattice: Lattice::straight(dims, [10.0, 20.0, 30.0], [1.0, 2.0, 4.0]),
        sample: SampleType::I16,
        byte_order: ByteOrder::Little,
        name: "density".into(),
    };
    let count = contents.lattice.samples();
    let values = || (0..count).map(|n| (n % 1000) as f64);
    let text = |bytes: Vec<u8>| {
        let head = String::from_utf8_lossy(&bytes).into_owned();
        let head = head
            .split("\n\n")
            .next()
            .unwrap()
            .replace("encoding: raw", "encoding: ascii");
        let numbers: String = values().map(|v| format!("{v} ")).collect();
        format!("{head}\n\n{numbers}").into_bytes()
    };
    let plain = nrrd::write(Vec::new(), &contents, false, values()).unwrap();
    vec![
        ("text.nrrd", text(plain.clone())),
        ("plain.nrrd", plain),
        (
            "packed.nrrd",
            nrrd::write(Vec::new(), &contents, true, values()).unwrap(),
        ),
        (
            "plain.mha",
            metaimage::write(Vec::new(), &contents, false, values()).unwrap(),
        ),
        (
            "packed.mha",
            metaimage::write(Vec::new(), &contents, true, values()).unwrap(),
        ),
        (
            "plain.vti",
            vti::write(Vec::new(), &contents, values()).unwrap(),
        ),
        ("base64.vti", VTI.into()),
    ]
}

/// An image of two samples, compressed and in base64.
pub const VTI: &str = "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\" compressor=\"vtkZLibDataCompressor\">\n\
     <ImageData WholeExtent=\"0 1 0 0 0 0\" Spacing=\"1 1 1\" Origin=\"0 0 0\"><Piece><PointData>\n\
     <DataArray type=\"UInt8\" Name=\"a\" format=\"binary\">\n\
     AQAAAAIAAAAAAAAACgAAAA==eJxjZAIAAAYABA==\n</DataArray></PointData></Piece></ImageData></VTKFile>\n";

/// Traces of two inlines and three crosslines, without the last one.
pub fn segy(samples: usize) -> Vec<u8> {
    let layout = SegyLayout {
        sample: SampleType::F32,
        byte_order: ByteOrder::Big,
        samples,
        interval: 4.0,
        delay: 0,
        text: "a survey".into(),
    };
    let mut out = SegyWriter::new(Vec::new(), layout).unwrap();
    for n in 0..5_u8 {
        let (i, j) = (n / 3, n % 3);
        let place = [1000.0 + 20.0 * f64::from(i), 2000.0 + 25.0 * f64::from(j)];
        let trace: Vec<f32> = (0..samples).map(|k| k as f32 + f32::from(n)).collect();
        out.trace(i32::from(i) + 10, i32::from(j) + 20, place, &trace)
            .unwrap();
    }
    out.finish().unwrap()
}
