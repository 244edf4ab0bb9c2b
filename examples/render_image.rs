//! Renders the oil of a case at its last step, as `strataray render` does.
//!
//! `cargo run --release --example render_image -- samples/scissor/SCISSOR.EGRID oil.png`

use std::path::Path;

use strataray::{Session, picture};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(case), Some(output)) = (arguments.next(), arguments.next()) else {
        return Err("usage: render_image CASE IMAGE.png".into());
    };
    let mut session = Session::open(case)?;
    // The keys of a scene file; what they leave out follows the case.
    let scene = session.scene(r#"{"property": "SOIL", "size": [1200, 800]}"#)?;
    let image = session.picture(&scene)?;
    picture::write_png(Path::new(&output), image.size, &image.pixels)?;
    Ok(())
}
