//! Tells when a case's files have changed, as those of a simulation that is still running do.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, SystemTime};

/// How often the files are looked at.
const INTERVAL: Duration = Duration::from_secs(1);
/// Looks after which a change is told though it goes on, as that of a file to which a simulation adds all the time.
const PATIENCE: usize = 10;

/// What was seen of a file; `None` where it is not there.
type Seen = Option<(u64, Option<SystemTime>)>;

/// What happened to the files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// They changed, and have been still for a moment since, or change for long.
    Written,
    /// One of them is gone.
    Gone,
}

/// Looks at files until it is dropped.
pub struct Watch {
    changes: Receiver<Change>,
    ends: Arc<AtomicBool>,
}

impl Watch {
    /// Begins to look; `wake` is called when there is something to tell.
    pub fn begin(files: Vec<PathBuf>, wake: impl Fn() + Send + 'static) -> Self {
        let (send, changes) = channel();
        let ends = Arc::new(AtomicBool::new(false));
        let ended = ends.clone();
        std::thread::spawn(move || {
            let look = || -> Vec<Seen> { files.iter().map(|f| seen(f)).collect() };
            let mut told = look();
            let mut before = told.clone();
            let mut waited = 0;
            while !ended.load(Ordering::Relaxed) {
                std::thread::sleep(INTERVAL);
                let now = look();
                // A writer takes its time: what changes from look to look is waited for.
                waited = if now == told { 0 } else { waited + 1 };
                if now != told && (now == before || waited > PATIENCE) {
                    let is_gone = now.iter().any(Option::is_none);
                    let change = if is_gone {
                        Change::Gone
                    } else {
                        Change::Written
                    };
                    if send.send(change).is_err() {
                        return;
                    }
                    wake();
                    told.clone_from(&now);
                    waited = 0;
                }
                before = now;
            }
        });
        Self { changes, ends }
    }

    /// What happened since the last call.
    pub fn poll(&self) -> Option<Change> {
        self.changes.try_iter().last()
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
    }
}

fn seen(file: &Path) -> Seen {
    let data = std::fs::metadata(file).ok()?;
    Some((data.len(), data.modified().ok()))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_told_once_it_is_over() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("A.UNRST");
        std::fs::write(&file, "one").unwrap();
        let (send, woken) = channel();
        let watch = Watch::begin(vec![file.clone()], move || send.send(()).unwrap());
        std::thread::sleep(INTERVAL / 2);
        assert_eq!(watch.poll(), None);
        std::fs::write(&file, "one and two").unwrap();
        woken.recv_timeout(10 * INTERVAL).unwrap();
        assert_eq!(watch.poll(), Some(Change::Written));
        std::fs::remove_file(&file).unwrap();
        woken.recv_timeout(10 * INTERVAL).unwrap();
        assert_eq!(watch.poll(), Some(Change::Gone));
        assert!(woken.recv_timeout(2 * INTERVAL).is_err());
    }
}
