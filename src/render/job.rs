//! Work in pieces: whoever asked for it looks at the clock between them, or drops it.

use std::cell::Cell;
use std::pin::Pin;
use std::rc::Rc;
use std::task::{Context, Poll, Waker};
use std::time::Instant;

use super::RenderError;

/// What is left to do of something.
pub type Work<'a, T> = Pin<Box<dyn Future<Output = Result<T, RenderError>> + 'a>>;

/// Work under way. It goes on only while it is advanced, and dropping it cancels it: what is half made is
/// forgotten, what was there before stays.
pub struct Job<'a, T> {
    /// `None` once it has ended.
    work: Option<Work<'a, T>>,
    done: Rc<Cell<f64>>,
}

impl<'a, T> Job<'a, T> {
    /// The work that `begin` makes, which tells how far it is.
    pub fn new(begin: impl FnOnce(Progress) -> Work<'a, T>) -> Self {
        let done = Rc::default();
        let progress = Progress {
            done: Rc::clone(&done),
        };
        Self {
            work: Some(begin(progress)),
            done,
        }
    }

    /// Goes on until a point in time, by a piece at least; `None` where there is more to do. A piece takes a GPU
    /// less than a tenth of a second.
    ///
    /// # Errors
    /// When the work fails; it has ended then.
    pub fn advance(&mut self, until: Instant) -> Result<Option<T>, RenderError> {
        loop {
            if let Some(made) = self.piece()? {
                return Ok(Some(made));
            }
            if self.work.is_none() || Instant::now() >= until {
                return Ok(None);
            }
        }
    }

    /// How far the stage under way is, 0 to 1: what is prepared counts by itself, and then the image.
    pub fn done(&self) -> f64 {
        self.done.get()
    }

    /// Does all of it, and tells between its pieces how far it is.
    ///
    /// # Errors
    /// When the work fails, and [`RenderError::Canceled`] where `progress` returned false.
    pub fn run(mut self, progress: &dyn Fn(f64) -> bool) -> Result<T, RenderError> {
        loop {
            match self.piece()? {
                Some(made) => return Ok(made),
                None if self.work.is_some() && progress(self.done()) => {}
                None => return Err(RenderError::Canceled),
            }
        }
    }

    fn piece(&mut self) -> Result<Option<T>, RenderError> {
        let Some(work) = &mut self.work else {
            return Ok(None);
        };
        // Nobody has to wake it: it is asked again.
        match work.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
            Poll::Pending => Ok(None),
            Poll::Ready(made) => {
                self.work = None;
                made.map(Some)
            }
        }
    }
}

/// Tells how far work is. Each time the work rests, so that it can be left there.
#[derive(Debug, Clone)]
pub struct Progress {
    done: Rc<Cell<f64>>,
}

impl Progress {
    /// So much of it is done, 0 to 1.
    pub async fn reached(&self, fraction: f64) {
        self.done.set(fraction);
        Rest(false).await;
    }

    /// Rests without a word.
    pub async fn rest(&self) {
        Rest(false).await;
    }
}

/// Is ready when it is asked for the second time.
struct Rest(bool);

impl Future for Rest {
    type Output = ();

    fn poll(mut self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<()> {
        match std::mem::replace(&mut self.0, true) {
            true => Poll::Ready(()),
            false => Poll::Pending,
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    /// Counts pieces, of which there are four.
    fn counting(count: &Cell<u32>) -> Job<'_, u32> {
        Job::new(|progress| {
            Box::pin(async move {
                for n in 1..=4 {
                    count.set(n);
                    progress.reached(f64::from(n) / 4.0).await;
                }
                Ok(count.get())
            })
        })
    }

    #[test]
    fn a_job_goes_on_by_pieces_and_ends_once() {
        let count = Cell::new(0);
        let mut job = counting(&count);
        let past = Instant::now();
        for n in 1..=4 {
            assert_eq!(job.advance(past).unwrap(), None);
            assert_eq!((count.get(), job.done()), (n, f64::from(n) / 4.0));
        }
        assert_eq!(job.advance(past).unwrap(), Some(4));
        assert_eq!(job.advance(past).unwrap(), None);
        let all = counting(&count).advance(past + std::time::Duration::from_secs(60));
        assert_eq!(all.unwrap(), Some(4));
    }

    #[test]
    fn a_job_that_nobody_wants_ends_where_it_is() {
        let count = Cell::new(0);
        let until = |most: f64| counting(&count).run(&|done| done < most);
        assert!(matches!(until(0.5), Err(RenderError::Canceled)));
        assert_eq!(count.get(), 2);
        assert_eq!(until(2.0).unwrap(), 4);
    }
}
