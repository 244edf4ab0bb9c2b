//! Pictures are made on a thread of their own, so that the window never waits for one.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

use glam::DVec2;

use super::job::{Answer, ImageJob, PickPurpose, RenderRequest};
use super::render_session::RenderSession;
use crate::case::Case;

/// The thread that makes pictures, one at a time.
pub struct Worker {
    /// Gone when the thread is to end.
    jobs: Option<Sender<ImageJob>>,
    answers: Receiver<Answer>,
    cancel: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts it; `wake` is called with each answer.
    pub fn start(wake: impl Fn() + Send + 'static) -> Self {
        let (jobs, inbox) = channel::<ImageJob>();
        let (outbox, answers) = channel();
        let cancel = Arc::new(AtomicBool::new(false));
        let canceled = cancel.clone();
        let thread = std::thread::spawn(move || {
            let say = |answer| {
                // The window may be gone.
                let _ = outbox.send(answer);
                wake();
            };
            let mut session = RenderSession::default();
            if let Err(error) = session.open(&say) {
                say(Answer::Failed(error));
            }
            for job in inbox {
                let is_picture = matches!(job, ImageJob::Picture { .. });
                let answer = AssertUnwindSafe(|| session.answer(job, &canceled, &say));
                say(catch_unwind(answer).unwrap_or_else(|_| {
                    // A driver or library gave up; what it left behind is not to be trusted.
                    session = RenderSession::default();
                    let sentence = "the graphics driver crashed; change any setting to retry";
                    match is_picture {
                        true => Answer::Failed(sentence.into()),
                        false => Answer::Refused(sentence.into()),
                    }
                }));
            }
        });
        Self {
            jobs: Some(jobs),
            answers,
            cancel,
            thread: Some(thread),
        }
    }

    /// Asks for a picture, or how far two are apart. A picture asked for before must have been answered.
    pub fn ask(&self, job: ImageJob) {
        self.cancel.store(false, Ordering::Relaxed);
        self.send(job);
    }

    /// Asks what is seen at a place, after what is being made or has been left.
    pub fn pick(&self, side: usize, wanted: RenderRequest, at: DVec2, why: PickPurpose) {
        self.send(ImageJob::Pick {
            side,
            wanted,
            at,
            why,
        });
    }

    /// Frees what is kept of a case, after what is being made.
    pub fn forget(&self, case: &Arc<Case>) {
        let grid = Arc::downgrade(&case.grid);
        self.send(ImageJob::Forget(Arc::downgrade(case), grid));
    }

    fn send(&self, job: ImageJob) {
        // The thread lives as long as this; were it gone, its silence would be seen by `poll`.
        let _ = self.jobs.as_ref().map(|jobs| jobs.send(job));
    }

    /// Asks to leave the picture that is being made.
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// What has been said since the last call.
    pub fn poll(&self) -> Vec<Answer> {
        self.answers.try_iter().collect()
    }
}

impl Drop for Worker {
    /// Waits for the thread: drivers do not like a process that ends while they draw.
    fn drop(&mut self) {
        self.cancel();
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            // One that panicked has nothing more to do.
            let _ = thread.join();
        }
    }
}
