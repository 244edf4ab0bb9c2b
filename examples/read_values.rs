//! Prints the mean of a property over the active cells at each step.
//!
//! `cargo run --release --example read_values -- samples/scissor/SCISSOR.EGRID SOIL`

use strataray::Session;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(case), Some(property)) = (arguments.next(), arguments.next()) else {
        return Err("usage: read_values CASE PROPERTY".into());
    };
    let session = Session::open(case)?;
    for (number, step) in session.case().steps.iter().enumerate() {
        let values = session.values(&property, &number.to_string())?;
        let known = values.active().iter().filter(|v| !v.is_nan());
        let (sum, count) = known.fold((0.0, 0), |(sum, n), v| (sum + f64::from(*v), n + 1));
        match count {
            0 => println!("{}  no values", step.date),
            _ => println!(
                "{}  {:.4} {}",
                step.date,
                sum / f64::from(count),
                values.unit
            ),
        }
    }
    Ok(())
}
