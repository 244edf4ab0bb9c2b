//! A progress bar on a terminal for what takes over a second, and Ctrl-C to cancel it.

use std::borrow::Cow;
use std::time::{Duration, Instant};

use super::{Verbosity, cancel};

/// Says what is going on, on standard error.
pub struct Reporter {
    verbosity: Verbosity,
}

impl Reporter {
    /// A reporter as talkative as the user wants.
    pub fn new(verbosity: Verbosity) -> Self {
        Self { verbosity }
    }

    /// A sentence that users should see, such as what was not loaded.
    pub fn note(&self, text: &str) {
        if !self.verbosity.quiet {
            eprintln!("strataray: note: {text}");
        }
    }

    /// A sentence for those who asked for more.
    pub fn detail(&self, text: &str) {
        if self.verbosity.verbose {
            eprintln!("strataray: {text}");
        }
    }

    /// Runs `work` with a callback that is told the fraction done, draws a bar once a second has
    /// passed, and returns false when Ctrl-C was pressed: `work` should end early then.
    pub fn bar<T>(
        &self,
        what: impl Into<Cow<'static, str>>,
        work: impl FnOnce(&(dyn Fn(f64) -> bool + Sync)) -> T,
    ) -> T {
        if let Err(error) = cancel::listen() {
            self.note(&format!("Ctrl-C leaves unfinished files behind: {error}"));
        }
        let bar = indicatif::ProgressBar::hidden();
        bar.set_length(1000);
        let style = indicatif::ProgressStyle::with_template("{msg} {wide_bar} {percent}% {eta}");
        if let Ok(style) = style {
            bar.set_style(style);
        }
        bar.set_message(what);
        let start = Instant::now();
        let progress = |fraction: f64| {
            let late = start.elapsed() > Duration::from_secs(1);
            if late && bar.is_hidden() && !self.verbosity.quiet {
                bar.set_draw_target(indicatif::ProgressDrawTarget::stderr());
            }
            bar.set_position((1000.0 * fraction) as u64);
            !cancel::asked()
        };
        let result = cancel::cancelable(|| work(&progress));
        bar.finish_and_clear();
        result
    }
}
