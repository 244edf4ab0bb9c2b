//! Tells in which cells the middle of the model lies at some depths, and the porosity there. Needs no device.
//!
//! `cargo run --release --example locate_points -- samples/scissor/SCISSOR.EGRID`

use strataray::Session;
use strataray::model::Spaces;
use strataray::scene::Interpolation;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let case = std::env::args().nth(1).ok_or("usage: locate_points CASE")?;
    let session = Session::open(case)?;
    let grid = &session.case().grid;
    let [low, high] = grid.bounds().ok_or("the case has no active cell")?;
    let spaces = Spaces::new(grid.map_axes(), 1.0);
    // From the top of the model's box to its bottom, in map coordinates.
    let points: Vec<[f64; 3]> = (0..=10)
        .map(|n| {
            let middle = 0.5 * (low + high);
            let depth = low.z + (high.z - low.z) * f64::from(n) / 10.0;
            let world = spaces
                .world_from_grid
                .transform_point3(middle.with_z(depth));
            spaces.map_from_world(world).to_array()
        })
        .collect();
    let found = session.locate("PORO", "last", Interpolation::Cell, &points)?;
    for ([_, _, depth], location) in points.iter().zip(found) {
        match location {
            Some(at) => println!("{depth:9.1}  cell {:?}  PORO {:.3}", at.cell, at.value),
            None => println!("{depth:9.1}  no cell with a value"),
        }
    }
    Ok(())
}
