//! The layers of surfaces that rays can have, and the faces and colors of faults.

use super::faces::face_numbers;
use super::layout;
use crate::image::Blending;
use crate::model::Grid;
use crate::render::RenderError;
use crate::scene::Hull;
use crate::view::surfaces::{PALETTE, UNNAMED};
use crate::view::{Surfaces, View};

/// Which points of which faces make a layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// The nearest of an opaque hull.
    Hull,
    /// The nearest of a faint hull.
    Front,
    /// The last of a faint hull.
    Ground,
    /// Those of a sheet that lies behind so many others.
    Sheet(u32),
    /// The nearest of a well.
    Tube,
}

/// The layers that a ray can have.
pub fn layers(surfaces: Surfaces) -> Vec<Layer> {
    let sheets = match surfaces.faults {
        true => 0..layout::SHEET_LAYERS,
        false => 0..0,
    };
    let hull: &[Layer] = match surfaces.hull {
        Hull::Hidden => &[],
        Hull::Faint => &[Layer::Front, Layer::Ground],
        Hull::Opaque => &[Layer::Hull],
    };
    let hull = hull.iter().copied();
    let tubes = surfaces.wells.then_some(Layer::Tube);
    match surfaces.hull {
        // It has the colors of faults itself.
        Hull::Opaque => hull.chain(tubes).collect(),
        Hull::Hidden | Hull::Faint => hull.chain(sheets.map(Layer::Sheet)).chain(tubes).collect(),
    }
}

/// Numbers of the fault faces in rising order, and of their colors.
///
/// # Errors
/// As [`face_numbers`].
pub fn faults(model: &Grid, view: &View) -> Result<Vec<(u32, u32)>, RenderError> {
    let faces = view.fault_faces(model);
    let places: Vec<_> = faces.iter().map(|f| (f.0, f.1)).collect();
    let color = |fault: Option<usize>| fault.map_or(PALETTE.len(), |n| n % PALETTE.len()) as u32;
    let colors = faces.iter().map(|f| color(f.2));
    let mut faults: Vec<_> = face_numbers(model, &places)?
        .into_iter()
        .zip(colors)
        .collect();
    faults.sort_unstable();
    Ok(faults)
}

/// Colors of faults as they are blended; the last one is that of faults without a name.
pub fn palette(blending: Blending) -> [[f32; 4]; layout::FAULT_COLORS] {
    std::array::from_fn(|n| {
        let [r, g, b] = blending.of_srgb(*PALETTE.get(n).unwrap_or(&UNNAMED));
        [r, g, b, 1.0].map(|v| v as f32)
    })
}
