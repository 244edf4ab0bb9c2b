//! From a case and a sequence of views to a film in a file.

use crate::case::Case;
use crate::picture::film::Film;
use crate::picture::{Layout, PictureError, finished};
use crate::render::{RenderError, Renderer};
use crate::view::{SceneError, Sequence};

/// Why there is no film.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FilmingError {
    /// A view cannot be shown.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A picture cannot be made.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The file cannot be written.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

/// Makes the pictures of a sequence, whose size is that of the film, and writes them; with what stands beside and
/// over the volume unless `plain`, at the same places in all. `progress` is told the fraction done; where it returns
/// false, nothing is written.
///
/// # Errors
/// When a view cannot be shown, a picture cannot be made or the film cannot be written, and
/// [`RenderError::Canceled`] where `progress` returned false.
pub fn shoot(
    renderer: &mut dyn Renderer,
    case: &Case,
    sequence: &Sequence,
    mut film: Film,
    plain: bool,
    progress: &dyn Fn(f64) -> bool,
) -> Result<(), FilmingError> {
    let layout = Layout::of_picture(case, &sequence.view(0, case)?, plain);
    let sequence = sequence.clone().sized(layout.volume_size())?;
    let count = sequence.count() as f64;
    for n in 0..sequence.count() {
        let done = |f: f64| progress((n as f64 + f) / count);
        let view = sequence.view(n, case)?;
        let frame = renderer.render(&view, &done)?;
        film.add(&finished(&frame.image, case, &view, &layout).pixels)?;
        if !done(1.0) {
            return Err(RenderError::Canceled.into());
        }
    }
    film.finish()?;
    Ok(())
}
