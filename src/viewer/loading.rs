//! Cases are opened in the background.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use crate::case::Case;
use crate::load;

/// A case that is being opened.
pub struct Loading {
    answer: Receiver<Result<Case, String>>,
}

impl Loading {
    /// Begins to open; `wake` is called when that is done.
    pub fn begin(path: PathBuf, wake: impl FnOnce() + Send + 'static) -> Self {
        let (send, answer) = channel();
        std::thread::spawn(move || {
            let case = load::open(&path).map_err(|e| e.to_string());
            // Nobody listens where the tab was closed meanwhile.
            let _ = send.send(case);
            wake();
        });
        Self { answer }
    }

    /// The case, or why there is none; `None` while it is being opened.
    pub fn poll(&self) -> Option<Result<Arc<Case>, String>> {
        match self.answer.try_recv() {
            Ok(case) => Some(case.map(Arc::new)),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err("opening the case ended without an answer".into()))
            }
        }
    }
}
