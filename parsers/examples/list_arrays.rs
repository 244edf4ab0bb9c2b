//! Lists the arrays of a binary file: `cargo run --example list_arrays -- CASE.INIT`.

use std::path::Path;

use strataray_parsers::Warnings;
use strataray_parsers::records::RecordFile;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args_os()
        .nth(1)
        .ok_or("name a binary file, such as CASE.INIT")?;
    let mut warnings = Warnings::default();
    // Lenient, so that a file that a simulator is still writing is listed too.
    let file = RecordFile::open_lenient(Path::new(&path), &mut warnings)?;
    println!("{:8}  {:>10}  type", "name", "count");
    for entry in file.entries() {
        println!("{:8}  {:>10}  {:?}", entry.name(), entry.count, entry.kind);
    }
    for warning in warnings.iter() {
        eprintln!("{warning}");
    }
    Ok(())
}
