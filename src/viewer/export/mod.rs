//! Pictures of any size and films, made for files beside the window, on a device of their own.

mod still;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread::JoinHandle;

use super::state::CompareLayout;
use crate::case::Case;
use crate::export::{self, Contents, ExportError};
use crate::picture::film::{Film, FilmFormat, FilmShape};
use crate::picture::filming::{FilmingError, shoot};
use crate::render::{self, RenderError};
use crate::scene::{Scene, Space};
use crate::view::{Sequence, Shown, Turn, resolve, step};

/// What is to be made.
#[derive(Clone)]
pub struct ExportSpec {
    /// Of which case.
    pub case: Arc<Case>,
    /// How it looks; `size` is the picture's.
    pub scene: Scene,
    /// One picture, or a film.
    pub kind: ExportKind,
    /// ExportKind of file of a film.
    pub format: FilmFormat,
    /// Without title, legend and axes.
    pub plain: bool,
    /// The second picture of a still, and how both are shown.
    pub compared: Option<Compared>,
    /// Cells that are marked in a still, by I, J, K from 1.
    pub marked: Vec<[usize; 3]>,
}

/// A picture beside another one.
#[derive(Clone)]
pub struct Compared {
    /// Of which case.
    pub case: Arc<Case>,
    /// How it looks.
    pub scene: Scene,
    /// How both are shown.
    pub layout: CompareLayout,
}

impl ExportSpec {
    /// Ending of the file; `None` for a folder of numbered pictures.
    pub fn ending(&self) -> Option<&'static str> {
        match self.kind {
            ExportKind::Still => Some("png"),
            ExportKind::Cells => Some("vtu"),
            _ => self.format.ending(),
        }
    }
}

/// What kind of file is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ExportKind {
    /// A picture.
    Still,
    /// The drawn cells with their values, or surfaces, in the format of the file's ending.
    Cells,
    /// A film of all time steps.
    Steps {
        /// Pictures a second.
        fps: f64,
    },
    /// A film of a turn around the model.
    Orbit {
        /// Pictures a second.
        fps: f64,
        /// Pictures.
        views: usize,
    },
}

/// Parts of [`Export::done`].
const WHOLE: f64 = 1e6;

/// A file that is being made.
pub struct Export {
    /// What it is.
    pub what: String,
    answer: Receiver<Result<String, String>>,
    done: Arc<AtomicU32>,
    cancel: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Export {
    /// Begins to make a file; `wake` is called now and then, and at the end.
    pub fn begin(spec: ExportSpec, path: PathBuf, wake: impl Fn() + Send + 'static) -> Self {
        let (send, answer) = channel();
        let done = Arc::new(AtomicU32::new(0));
        let cancel = Arc::new(AtomicBool::new(false));
        let what = format!("writing {}", path.display());
        let (shared_done, shared_cancel) = (done.clone(), cancel.clone());
        let thread = std::thread::spawn(move || {
            let progress = |part: f64| {
                let now = (WHOLE * part) as u32;
                // A hundred times in all, not for each tile.
                if now.abs_diff(shared_done.load(Ordering::Relaxed)) > (WHOLE / 100.0) as u32 {
                    shared_done.store(now, Ordering::Relaxed);
                    wake();
                }
                !shared_cancel.load(Ordering::Relaxed)
            };
            let made = match make(&spec, &path, &progress) {
                Ok(notes) => Ok([vec![format!("saved {}", path.display())], notes]
                    .concat()
                    .join("; ")),
                Err(error) if is_canceled(&*error) => Err(format!(
                    "{} was canceled; nothing was written",
                    path.display()
                )),
                Err(error) => Err(error.to_string()),
            };
            // The window may be gone.
            let _ = send.send(made);
            wake();
        });
        Self {
            what,
            answer,
            done,
            cancel,
            thread: Some(thread),
        }
    }

    /// Part that is done, 0 to 1.
    pub fn done(&self) -> f32 {
        (f64::from(self.done.load(Ordering::Relaxed)) / WHOLE) as f32
    }

    /// Asks to stop.
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// What came of it; `None` while it is being made.
    pub fn poll(&self) -> Option<Result<String, String>> {
        match self.answer.try_recv() {
            Ok(made) => Some(made),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err(format!("{} ended without an answer", self.what)))
            }
        }
    }
}

impl Drop for Export {
    /// Waits for the thread: drivers do not like a process that ends while they draw.
    fn drop(&mut self) {
        self.cancel();
        if let Some(thread) = self.thread.take() {
            // One that panicked has nothing more to do.
            let _ = thread.join();
        }
    }
}

pub(super) type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

/// True where nobody wants the file anymore.
fn is_canceled(error: &(dyn std::error::Error + 'static)) -> bool {
    let of_image = error.downcast_ref::<RenderError>();
    let of_film = error.downcast_ref::<FilmingError>();
    let of_cells = error.downcast_ref::<ExportError>();
    matches!(of_image, Some(RenderError::Canceled))
        || matches!(of_cells, Some(ExportError::Canceled))
        || matches!(of_film, Some(FilmingError::Render(RenderError::Canceled)))
}

/// Writes the cells that the scene draws, where they are on the map, with the values of its property at its step; what
/// to say of it.
fn cells(spec: &ExportSpec, path: &Path, progress: &dyn Fn(f64) -> bool) -> Fallible<Vec<String>> {
    let view = resolve(&spec.scene.clone().in_space(Space::Map), &spec.case)?;
    let Shown { property, step, .. } = &view.shown;
    let names = [property.clone()];
    let contents = Contents::new(&spec.case, Some(&view), &names, &[*step])?;
    Ok(export::write(&contents, path, progress)?.notes)
}

/// Makes the file; what to say of it.
fn make(spec: &ExportSpec, path: &Path, progress: &dyn Fn(f64) -> bool) -> Fallible<Vec<String>> {
    let case = &spec.case.in_space(spec.scene.space);
    let (fps, sequence) = match spec.kind {
        ExportKind::Still => return still::still(spec, path, progress).map(|()| Vec::new()),
        ExportKind::Cells => return cells(spec, path, progress),
        ExportKind::Steps { fps } => {
            let steps = step::steps(case, None, 1)?;
            // Looking at all values is a small part of the work.
            let looks = |part: f64| progress(0.05 * part);
            let Some(sequence) = Sequence::over_steps(&spec.scene, case, &steps, &looks)? else {
                return Err(RenderError::Canceled.into());
            };
            (fps, sequence)
        }
        ExportKind::Orbit { fps, views } => {
            let turn = Turn {
                degrees: 360.0,
                views,
            };
            (fps, Sequence::around(&spec.scene, case, turn)?)
        }
    };
    let shape = FilmShape {
        size: spec.scene.size,
        pictures: u32::try_from(sequence.count())?,
        fps,
        hold: 0.0,
    };
    let film = Film::create(path, shape)?;
    let mut renderer = render::executor(None)?.renderer(&case.grid)?;
    shoot(&mut *renderer, case, &sequence, film, spec.plain, progress)?;
    Ok(Vec::new())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    fn spec(kind: ExportKind) -> ExportSpec {
        let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/scissor/SCISSOR.EGRID");
        ExportSpec {
            case: Arc::new(crate::case::load::open(&sample).unwrap()),
            scene: Scene {
                size: [64, 48],
                ..Scene::default()
            },
            kind,
            format: FilmFormat::Gif,
            plain: true,
            compared: None,
            marked: Vec::new(),
        }
    }

    fn made(spec: ExportSpec, path: PathBuf, cancels: bool) -> Result<String, String> {
        let export = Export::begin(spec, path, || {});
        if cancels {
            export.cancel();
        }
        loop {
            if let Some(done) = export.poll() {
                return done;
            }
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
    }

    #[test]
    fn cells_are_written_as_the_ending_says() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        let cells = |property: &str| {
            let mut spec = spec(ExportKind::Cells);
            spec.scene.property = Some(property.into());
            spec
        };
        let said = made(cells("SWAT"), file("a.vtu"), false).unwrap();
        assert_eq!(said, format!("saved {}", file("a.vtu").display()));
        let said = made(cells("THICKNESS"), file("a.grdecl"), false).unwrap();
        assert!(
            said.ends_with("; THICKNESS is written as THICKNES"),
            "{said}"
        );
        let error = made(cells("SWAT"), file("a.csv"), true).unwrap_err();
        assert!(error.contains("canceled"), "{error}");
        let error = made(cells("SWAT"), file("a.obj"), false).unwrap_err();
        assert!(error.contains(".parquet"), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn pictures_and_films_are_written_or_not_at_all() {
        if render::executor(None).is_err() {
            assert!(std::env::var_os("REQUIRE_GPU").is_none());
            return;
        }
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        made(spec(ExportKind::Still), file("a.png"), false).unwrap();
        assert!(image::open(file("a.png")).unwrap().width() == 64);
        let orbit = ExportKind::Orbit { fps: 5.0, views: 3 };
        made(spec(orbit), file("turn.gif"), false).unwrap();
        assert!(file("turn.gif").metadata().unwrap().len() > 100);
        let error = made(spec(ExportKind::Steps { fps: 5.0 }), file("b.gif"), true).unwrap_err();
        assert!(
            error.contains("canceled") && !file("b.gif").exists(),
            "{error}"
        );
        let error = made(spec(ExportKind::Still), file("c.tiff"), false).unwrap_err();
        assert!(error.contains("c.tiff"), "{error}");
    }
}
