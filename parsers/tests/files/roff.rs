//! ROFF files, binary in both byte orders and as text.

use strataray_parsers::roff::{Kind, Pillars, RoffFile, RoffGrid, RoffWriter};
use strataray_parsers::{ErrorKind, ParseError};

/// A writer of one of the forms.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    Little,
    Big,
    Text,
}

const FORMS: [Form; 3] = [Form::Little, Form::Big, Form::Text];

struct Out(Form, Vec<u8>);

impl Out {
    fn new(form: Form) -> Self {
        let mut out = Self(form, Vec::new());
        match form {
            Form::Text => out
                .1
                .extend(b"roff-asc\n#ROFF file#\n#Creator: by hand, 2.0#\n"),
            _ => out.1.extend(b"roff-bin\0#ROFF file#\0#Creator: by hand#\0"),
        }
        out.words("tag filedata");
        out.words("int byteswaptest");
        out.value(Kind::Int, 1.0);
        out.words("endtag");
        out
    }

    fn words(&mut self, words: &str) {
        for word in words.split(' ') {
            self.1.extend(word.bytes());
            self.1.push(if self.0 == Form::Text { b'\n' } else { 0 });
        }
    }

    fn string(&mut self, text: &str) {
        match self.0 {
            Form::Text => self.1.extend(format!("\"{text}\"\n").bytes()),
            _ => self.1.extend([text.as_bytes(), &[0]].concat()),
        }
    }

    fn value(&mut self, kind: Kind, value: f64) {
        let mut bytes = match kind {
            Kind::Bool if self.0 == Form::Text => {
                let word: &[u8] = if value == 0.0 { b" False " } else { b" True " };
                return self.1.extend(word);
            }
            _ if self.0 == Form::Text => return self.1.extend(format!(" {value} ").bytes()),
            Kind::Bool | Kind::Byte | Kind::Char => vec![value as u8],
            Kind::Int => (value as i32).to_le_bytes().to_vec(),
            Kind::Float => (value as f32).to_le_bytes().to_vec(),
            Kind::Double => value.to_le_bytes().to_vec(),
        };
        if self.0 == Form::Big {
            bytes.reverse();
        }
        self.1.extend(bytes);
    }

    fn array(&mut self, kind: Kind, name: &str, values: &[f64]) {
        let word = match kind {
            Kind::Bool => "bool",
            Kind::Byte => "byte",
            Kind::Char => "char",
            Kind::Int => "int",
            Kind::Float => "float",
            Kind::Double => "double",
        };
        self.words(&format!("array {word} {name}"));
        self.value(Kind::Int, values.len() as f64);
        if self.0 == Form::Text {
            self.1.push(b'\n');
        }
        values.iter().for_each(|v| self.value(kind, *v));
        if self.0 == Form::Text {
            self.1.push(b'\n');
        }
    }

    fn tag(&mut self, name: &str, items: &[(&str, Kind, f64)]) {
        self.words(&format!("tag {name}"));
        for (name, kind, value) in items {
            let word = if *kind == Kind::Int { "int" } else { "float" };
            self.words(&format!("{word} {name}"));
            self.value(*kind, *value);
            if self.0 == Form::Text {
                self.1.push(b'\n');
            }
        }
        self.words("endtag");
    }

    fn dimensions(&mut self, dims: [usize; 3]) {
        let [nx, ny, nz] = dims.map(|n| n as f64);
        let items = [("nX", nx), ("nY", ny), ("nZ", nz)];
        self.tag("dimensions", &items.map(|(name, n)| (name, Kind::Int, n)));
    }

    fn read(&self) -> Result<RoffFile, ParseError> {
        RoffFile::from_bytes(("A.ROFF", self.1.clone()))
    }
}

const DIMS: [usize; 3] = [3, 2, 4];

/// Depth of a corner of a cell, layers from the top: all different.
fn depth([i, j, k]: [usize; 3], c: usize) -> f64 {
    let (di, dj, dk) = (c & 1, c >> 1 & 1, c >> 2);
    1000.0
        + 10.0 * (k + dk) as f64
        + (i + 3 * j) as f64 / 8.0
        + (di + 2 * dj + 4 * dk) as f64 / 64.0
}

/// A grid whose nodes have values for each of the cells around them.
fn write(form: Form, split: u8, depth: impl Fn([usize; 3], usize) -> f64) -> Out {
    let [ni, nj, nk] = DIMS;
    let mut out = Out::new(form);
    out.dimensions(DIMS);
    let offset = [
        ("xoffset", 460_000.0),
        ("yoffset", 5_930_000.0),
        ("zoffset", 0.0),
    ];
    out.tag("translate", &offset.map(|(n, v)| (n, Kind::Float, v)));
    let scale = [("xscale", 1.0), ("yscale", 1.0), ("zscale", -1.0)];
    out.tag("scale", &scale.map(|(n, v)| (n, Kind::Float, v)));
    out.words("tag subgrids");
    out.array(Kind::Int, "nLayers", &[1.0, 3.0]);
    out.words("endtag");
    let (mut lines, mut splits, mut z) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..=ni {
        for j in 0..=nj {
            let [x, y] = [i, j].map(|n| 50.0 * n as f64);
            lines.extend([x + 1.0, y, -1100.0, x, y + 2.0, -1000.0]);
            for k in 0..=nk {
                splits.push(f64::from(split));
                // South-west, south-east, north-west, north-east, first below the node, then above.
                for n in 0..8_usize {
                    let (east, north, above) = (n & 1, n >> 1 & 1, n >> 2);
                    // The cell around the node, or one inside where there is none.
                    let place = |node: usize, plus: usize, most: usize| {
                        (node + plus).saturating_sub(1).min(most - 1)
                    };
                    let cell = [
                        place(i, east, ni),
                        place(j, north, nj),
                        nk - 1 - place(k, above, nk),
                    ];
                    // Which of its corners is at the node, whose number counts from the bottom.
                    let corner = i - cell[0] + 2 * (j - cell[1]) + 4 * (nk - k - cell[2]);
                    let is_written = match split {
                        1 => n == 0,
                        2 => n % 4 == 0,
                        4 => n < 4,
                        _ => true,
                    };
                    if is_written {
                        z.push(-depth(cell, corner));
                    }
                }
            }
        }
    }
    out.words("tag cornerLines");
    out.array(Kind::Float, "data", &lines);
    out.words("endtag");
    out.words("tag zvalues");
    out.array(Kind::Byte, "splitEnz", &splits);
    out.array(Kind::Float, "data", &z);
    out.words("endtag");
    out.words("tag active");
    let active: Vec<f64> = (0..ni * nj * nk)
        .map(|n| f64::from(u8::from(n % 5 != 0)))
        .collect();
    out.array(Kind::Bool, "data", &active);
    out.words("endtag");
    out.words("tag eof");
    out.words("endtag");
    out
}

fn corner_depths(zcorn: &[f64]) -> impl Fn([usize; 3], usize) -> f64 {
    let [ni, nj, _] = DIMS;
    move |[i, j, k], c| {
        let (di, dj, dk) = (c & 1, c >> 1 & 1, c >> 2);
        zcorn[2 * i + di + 2 * ni * (2 * j + dj) + 4 * ni * nj * (2 * k + dk)]
    }
}

fn cells() -> impl Iterator<Item = [usize; 3]> {
    let [ni, nj, nk] = DIMS;
    (0..ni * nj * nk).map(move |n| [n % ni, n / ni % nj, n / ni / nj])
}

#[test]
fn ok_a_grid_in_every_form() {
    for form in FORMS {
        let file = write(form, 8, depth).read().unwrap();
        let grid = file.grid().unwrap().unwrap();
        assert_eq!((grid.dims, &grid.subgrids[..]), (DIMS, &[1, 3][..]));
        let pillars = grid.pillars();
        // The second pillar along i, from its upper end.
        let second = [
            460_050.0,
            5_930_002.0,
            1000.0,
            460_051.0,
            5_930_000.0,
            1100.0,
        ];
        assert_eq!(pillars.coord[6..12], second);
        let found = corner_depths(&pillars.zcorn);
        let actnum = pillars.actnum.unwrap();
        for (n, ijk) in cells().enumerate() {
            for c in 0..8 {
                assert_eq!(found(ijk, c), depth(ijk, c), "{ijk:?} {c}");
            }
            let [i, j, k] = ijk;
            let in_file = (i * DIMS[1] + j) * DIMS[2] + DIMS[2] - 1 - k;
            assert_eq!(actnum[n], i32::from(!in_file.is_multiple_of(5)));
        }
    }
}

#[test]
fn ok_fewer_values_at_nodes() {
    // Depths that depend on the node alone, on what is below and above it, on the column.
    let node = |[i, j, k]: [usize; 3], c: usize| {
        let [di, dj, dk] = [c & 1, c >> 1 & 1, c >> 2];
        1000.0 + (i + di) as f64 + 4.0 * (j + dj) as f64 + 16.0 * (k + dk) as f64
    };
    let gaps = |ijk: [usize; 3], c: usize| node(ijk, c) + (c >> 2) as f64 / 2.0;
    let faults = |ijk: [usize; 3], c: usize| node(ijk, c) + (2 * ijk[0] + ijk[1]) as f64 / 8.0;
    let check = |split: u8, depth: &dyn Fn([usize; 3], usize) -> f64| {
        let file = write(Form::Little, split, depth).read().unwrap();
        let pillars = file.grid().unwrap().unwrap().pillars();
        let found = corner_depths(&pillars.zcorn);
        for ijk in cells() {
            for c in 0..8 {
                assert_eq!(found(ijk, c), depth(ijk, c), "{split}: {ijk:?} {c}");
            }
        }
    };
    check(1, &node);
    check(2, &node);
    check(2, &gaps);
    check(4, &node);
    check(4, &faults);
    check(8, &gaps);
    check(8, &faults);
}

#[test]
fn ok_parameters_in_every_form() {
    for form in FORMS {
        let mut out = Out::new(form);
        out.dimensions([2, 1, 2]);
        out.words("tag parameter");
        out.words("char name");
        out.string("Net to gross");
        out.array(Kind::Float, "data", &[0.1, 0.2, -999.0, 0.4]);
        out.words("endtag");
        out.words("tag parameter");
        out.words("char name");
        out.string("FACIES");
        out.words("array char codeNames");
        out.value(Kind::Int, 2.0);
        out.string("shale");
        out.string("sand");
        out.array(Kind::Int, "codeValues", &[0.0, 7.0]);
        out.array(Kind::Byte, "data", &[7.0, 0.0, 255.0, 7.0]);
        out.words("endtag");
        let file = out.read().unwrap();
        assert!(file.grid().unwrap().is_none());
        let parameters = file.parameters().unwrap();
        let [ntg, facies] = &parameters[..] else {
            panic!("{parameters:?}");
        };
        assert_eq!(
            (ntg.name.as_str(), ntg.is_discrete),
            ("Net to gross", false)
        );
        let values = file.values(ntg).unwrap();
        // In the file k runs fastest, from the bottom.
        let expected = [0.2, 0.4, 0.1].map(|v: f32| f64::from(v));
        assert_eq!([values[0], values[1], values[2]], expected);
        assert!(values[3].is_nan());
        assert_eq!((facies.name.as_str(), facies.is_discrete), ("FACIES", true));
        let codes = [(0, "shale".to_owned()), (7, "sand".to_owned())];
        assert_eq!(facies.codes, codes);
        let values = file.values(facies).unwrap();
        assert_eq!([values[0], values[1], values[2]], [0.0, 7.0, 7.0]);
        assert!(values[3].is_nan());
    }
}

#[test]
fn err_what_is_damaged() {
    let whole = write(Form::Text, 8, depth).1;
    let said = |from: &str, to: &str| {
        let text = String::from_utf8(whole.clone()).unwrap();
        assert!(text.contains(from), "{from}");
        let file = RoffFile::from_bytes(("A.ROFF", text.replacen(from, to, 1).into_bytes()));
        let error = match file.map(|file| file.grid()) {
            Err(error) | Ok(Err(error)) => error,
            Ok(Ok(_)) => panic!("was read"),
        };
        (error.kind, error.to_string())
    };
    let (kind, text) = said("roff-asc", "roff-xml");
    assert_eq!(kind, ErrorKind::NotThisFormat);
    assert!(text.ends_with("it starts with neither roff-bin nor roff-asc"));
    let (kind, text) = said("nX\n 3", "nX\n 4");
    assert_eq!(kind, ErrorKind::WrongCount);
    assert!(
        text.ends_with("data: expected 90 values, found 72"),
        "{text}"
    );
    let (kind, _) = said("nX\n 3", "nX\n 2000000000");
    assert_eq!(kind, ErrorKind::BadValue);
    let (kind, text) = said("-1100", "x");
    assert_eq!(kind, ErrorKind::BadValue);
    assert!(text.contains("\"x\" is not a number"), "{text}");
    let (kind, _) = said("-1100", "nan");
    assert_eq!(kind, ErrorKind::BadValue);
    let (kind, text) = said("float\ndata\n 72", "float\ndata\n 720000");
    assert_eq!(kind, ErrorKind::Truncated);
    assert!(
        text.ends_with("cornerLines: the file ends before the 720000 values of data"),
        "{text}"
    );
    let (kind, _) = said("splitEnz\n 60 \n 8", "splitEnz\n 60 \n 3");
    assert_eq!(kind, ErrorKind::BadValue);
    let (kind, text) = said("zvalues", "zvaluos");
    assert_eq!(kind, ErrorKind::MissingKeyword);
    assert_eq!(
        text,
        "A.ROFF: zvalues: is missing; a grid needs dimensions, cornerLines and zvalues"
    );
    for form in FORMS {
        let whole = write(form, 8, depth).1;
        for length in (1..whole.len() - 20).step_by(7) {
            let cut = RoffFile::from_bytes(("A.ROFF", whole[..length].to_vec()));
            let grid = cut.and_then(|file| file.grid());
            assert!(
                !grid.is_ok_and(|g| g.is_some_and(|g| g.active.is_some())),
                "{length}"
            );
        }
    }
}

/// Pillars whose corners have these depths.
fn pillars(depth: &dyn Fn([usize; 3], usize) -> f64) -> Pillars {
    let [ni, nj, nk] = DIMS;
    let mut zcorn = vec![0.0; 8 * ni * nj * nk];
    for [i, j, k] in cells() {
        for c in 0..8 {
            let (di, dj, dk) = (c & 1, c >> 1 & 1, c >> 2);
            let at = 2 * i + di + 2 * ni * (2 * j + dj) + 4 * ni * nj * (2 * k + dk);
            zcorn[at] = depth([i, j, k], c);
        }
    }
    let (mut coord, mut actnum) = (Vec::new(), Vec::new());
    for j in 0..=nj {
        for i in 0..=ni {
            let [x, y] = [460_000.0 + 50.0 * i as f64, 5_930_000.0 + 25.0 * j as f64];
            coord.extend([x + 0.5, y, 1000.0, x, y + 0.25, 1100.0]);
        }
    }
    actnum.extend(cells().map(|[i, j, k]| i32::from(i + j != k)));
    Pillars {
        dims: DIMS,
        coord,
        zcorn,
        actnum: Some(actnum),
    }
}

#[test]
fn ok_what_is_written_reads_back_equal() {
    let node = |[i, j, k]: [usize; 3], c: usize| {
        let [di, dj, dk] = [c & 1, c >> 1 & 1, c >> 2];
        1000.0 + (i + di) as f64 + 4.0 * (j + dj) as f64 + 16.0 * (k + dk) as f64
    };
    let gaps = |ijk: [usize; 3], c: usize| node(ijk, c) + (c >> 2) as f64 / 2.0;
    let faults = |ijk: [usize; 3], c: usize| node(ijk, c) + (2 * ijk[0] + ijk[1]) as f64 / 8.0;
    let mixed = |ijk: [usize; 3], c: usize| match ijk[0] {
        0 => node(ijk, c),
        1 => gaps(ijk, c),
        _ => depth(ijk, c),
    };
    let nodes = (DIMS[0] + 1) * (DIMS[1] + 1) * (DIMS[2] + 1);
    let most = |split: u8| move |splits: &[u8]| splits.iter().all(|s| *s <= split);
    check_written(&node, &move |splits| splits == vec![1; nodes]);
    check_written(&gaps, &most(2));
    check_written(&faults, &most(4));
    check_written(&depth, &most(8));
    check_written(&mixed, &|splits| {
        [1, 2, 8].iter().all(|s| splits.contains(s))
    });
}

fn check_written(depth: &dyn Fn([usize; 3], usize) -> f64, has: &dyn Fn(&[u8]) -> bool) {
    let pillars = pillars(depth);
    let grid = RoffGrid::of(&pillars, [460_000.0, 5_930_000.0]);
    assert!(has(&grid.splits), "{:?}", grid.splits);
    let mut writer = RoffWriter::new(Vec::new(), &grid).unwrap();
    let mut poro: Vec<f32> = (0..24_u8).map(|n| f32::from(n) / 8.0).collect();
    poro[7] = f32::NAN;
    writer.real("PORO", &poro).unwrap();
    let facies: Vec<Option<i32>> = (0..24).map(|n| (n != 5).then_some(n % 3)).collect();
    let codes = [(0, "shale".to_owned()), (2, "sand".to_owned())];
    writer.discrete("FACIES", &codes, &facies).unwrap();
    let bytes = writer.finish().unwrap();
    let file = RoffFile::from_bytes(("A.ROFF", bytes)).unwrap();
    assert_eq!(file.tags().last().unwrap().name, "eof");
    let read = file.grid().unwrap().unwrap();
    assert_eq!(read, grid);
    assert_eq!(read.pillars(), pillars);
    let parameters = file.parameters().unwrap();
    assert_eq!(parameters[1].codes, codes);
    let values = |n: usize| file.values(&parameters[n]).unwrap();
    for (n, (real, whole)) in values(0).into_iter().zip(values(1)).enumerate() {
        assert!(real == f64::from(poro[n]) || n == 7 && real.is_nan());
        assert!(facies[n].map_or(whole.is_nan(), |v| whole == f64::from(v)));
    }
}

#[test]
fn err_what_cannot_be_written() {
    let good = RoffGrid::of(&pillars(&depth), [0.0; 2]);
    let refused = |change: &dyn Fn(&mut RoffGrid)| {
        let mut grid = good.clone();
        change(&mut grid);
        let written = RoffWriter::new(Vec::new(), &grid);
        written.map(drop).unwrap_err().to_string()
    };
    let text = refused(&|grid| grid.z.truncate(3));
    assert!(text.starts_with("zvalues: expected"), "{text}");
    let text = refused(&|grid| grid.corner_lines[4] = f64::NAN);
    assert_eq!(text, "cornerLines: value 5 is not a finite number");
    assert!(refused(&|grid| grid.dims[0] = 0).contains("not supported"));
    let mut writer = RoffWriter::new(Vec::new(), &good).unwrap();
    let mut real = |name: &str, values: &[f32]| {
        let written = writer.real(name, values);
        written.unwrap_err().to_string()
    };
    assert_eq!(real("A", &[0.5; 23]), "A: expected 24 values, found 23");
    assert_eq!(real("A", &[f32::INFINITY; 24]), "A: value 1 is infinite");
    assert!(real("A\0", &[0.5; 24]).contains("holds a zero"));
}
