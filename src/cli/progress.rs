//! A progress bar on a terminal for what takes over a second.

use std::time::{Duration, Instant};

use super::Verbosity;

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

    /// Runs `work` with a callback that draws a bar once a second has passed.
    pub fn bar<T>(
        &self,
        what: &'static str,
        work: impl FnOnce(&(dyn Fn(f64) -> bool + Sync)) -> T,
    ) -> T {
        if self.verbosity.quiet {
            return work(&|_| true);
        }
        let bar = indicatif::ProgressBar::hidden();
        bar.set_length(1000);
        let style = indicatif::ProgressStyle::with_template("{msg} {wide_bar} {percent}% {eta}");
        if let Ok(style) = style {
            bar.set_style(style);
        }
        bar.set_message(what);
        let start = Instant::now();
        let result = work(&|fraction| {
            if bar.is_hidden() && start.elapsed() > Duration::from_secs(1) {
                bar.set_draw_target(indicatif::ProgressDrawTarget::stderr());
            }
            bar.set_position((1000.0 * fraction) as u64);
            true
        });
        bar.finish_and_clear();
        result
    }
}
