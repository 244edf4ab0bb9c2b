//! Lists what a volume is: `cargo run --example list_volume -- SEISMIC.sgy`, with a layout behind it for raw samples.

use std::path::Path;

use strataray_parsers::volume::{self, Options};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let path = arguments
        .next()
        .ok_or("name a volume, such as SEISMIC.sgy")?;
    let layout = arguments.next().map(|text| text.to_string_lossy().parse());
    let options = Options {
        raw: layout.transpose()?,
        ..Options::default()
    };
    let volume = volume::open(Path::new(&path), &options)?;
    let [ni, nj, nk] = volume.lattice.dims;
    let (format, kind) = (volume.format.name(), volume.sample.name());
    println!("{format}, {ni} x {nj} x {nk} samples of the type {kind}");
    if !volume.name.is_empty() {
        println!("values: {} {}", volume.name, volume.unit);
    }
    println!("origin: {:?} {}", volume.lattice.origin, volume.frame);
    for (axis, edge) in volume.axes.iter().zip(volume.lattice.edges) {
        println!("step: {edge:?} {} {}", axis.name, axis.unit);
    }
    if let Some(survey) = &volume.survey {
        println!("{survey:?}");
    }
    for line in &volume.header {
        println!("| {line}");
    }
    for note in volume.notes.iter() {
        eprintln!("{note}");
    }
    match volume.range()? {
        Some(range) => println!(
            "values from {} to {}, and {} samples without one",
            range.low, range.high, range.absent
        ),
        None => println!("no values"),
    }
    Ok(())
}
