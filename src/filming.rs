//! From a case and a sequence of views to a film in a file.

use crate::case::Case;
use crate::gpu::GpuError;
use crate::picture::film::Film;
use crate::picture::{PictureError, finished};
use crate::renderer::Renderer;
use crate::scene::{SceneError, Sequence};

/// Why there is no film.
#[derive(Debug, thiserror::Error)]
pub enum FilmingError {
    /// A view cannot be shown.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The device cannot make a picture.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The file cannot be written.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

/// Makes the pictures of a sequence and writes them, with title, legend and axes unless `plain`; false where
/// `progress`, which is told the fraction done, returned false: nothing was written then.
///
/// # Errors
/// When a view cannot be shown, a picture cannot be made or the film cannot be written.
pub fn shoot(
    renderer: &mut Renderer,
    case: &Case,
    sequence: &Sequence,
    mut film: Film,
    plain: bool,
    progress: &dyn Fn(f64) -> bool,
) -> Result<bool, FilmingError> {
    let count = sequence.count() as f64;
    for n in 0..sequence.count() {
        let done = |f: f64| progress((n as f64 + f) / count);
        let view = sequence.view(n, case)?;
        let Some(frame) = renderer.render(&case.grid, &view, &done)? else {
            return Ok(false);
        };
        film.add(&finished(&frame.image, case, &view, plain))?;
        if !done(1.0) {
            return Ok(false);
        }
    }
    film.finish()?;
    Ok(true)
}
