//! Cases are opened in the background.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};

use crate::case::load::{self, CasePaths};
use crate::case::{Case, GridPool};
use crate::scene::Scene;
use crate::view::look;

/// A case, and what of it is shown at first.
pub struct Opened {
    /// The case.
    pub case: Arc<Case>,
    /// The scene in which it opens.
    pub first: Box<Scene>,
}

/// A case that is being opened.
pub struct Loading {
    answer: Receiver<Result<Opened, String>>,
    stage: Arc<Mutex<String>>,
    cancel: Arc<AtomicBool>,
}

impl Loading {
    /// Begins to open, with a property in front where the case has it and the grid of one that is open where they are equal;
    /// `wake` is called when that comes to
    /// another stage, and at the end.
    pub fn begin(
        paths: CasePaths,
        property: Option<String>,
        pool: Arc<GridPool>,
        wake: impl Fn() + Send + 'static,
    ) -> Self {
        let (send, answer) = channel();
        let stage = Arc::new(Mutex::new(String::new()));
        let cancel = Arc::new(AtomicBool::new(false));
        let (shared_stage, shared_cancel) = (stage.clone(), cancel.clone());
        std::thread::spawn(move || {
            let progress = |stage: &str| {
                let mut shared = shared_stage.lock().unwrap_or_else(PoisonError::into_inner);
                stage.clone_into(&mut shared);
                wake();
                !shared_cancel.load(Ordering::Relaxed)
            };
            let case = match load::open_paths(&paths, &pool, &progress) {
                Ok(Some(case)) => {
                    progress("values");
                    let property = property.filter(|p| look::varies(&case, p));
                    let written = property.map(|p| serde_json::json!({ "property": p }));
                    let first = look::opening(&case, &written.unwrap_or_default());
                    first.map_err(|e| e.to_string()).map(|first| Opened {
                        case: Arc::new(case),
                        first: Box::new(first),
                    })
                }
                Ok(None) => Err("opening it was canceled".into()),
                Err(error) => Err(error.to_string()),
            };
            // Nobody listens where the tab was closed meanwhile.
            let _ = send.send(case);
            wake();
        });
        Self {
            answer,
            stage,
            cancel,
        }
    }

    /// The case, or why there is none; `None` while it is being opened.
    pub fn poll(&self) -> Option<Result<Opened, String>> {
        match self.answer.try_recv() {
            Ok(case) => Some(case),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err("opening the case ended without an answer".into()))
            }
        }
    }

    /// What is being read, in words.
    pub fn stage(&self) -> String {
        let stage = self.stage.lock().unwrap_or_else(PoisonError::into_inner);
        match stage.as_str() {
            "" => "looking for its files".into(),
            stage => format!("reading {stage}"),
        }
    }

    /// Asks to stop before the next stage.
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }
}

impl Drop for Loading {
    fn drop(&mut self) {
        self.cancel();
    }
}
