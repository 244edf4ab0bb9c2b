//! Ctrl-C: asks work that can be canceled to stop, and ends the program where there is none.

use std::sync::Once;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::Relaxed;

/// Exit code of a program that Ctrl-C ended.
const INTERRUPTED: i32 = 130;

static WORKING: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);

/// Runs work that looks at [`asked`] often, and then cleans up and ends.
pub fn cancelable<T>(work: impl FnOnce() -> T) -> T {
    WORKING.store(true, Relaxed);
    let result = work();
    WORKING.store(false, Relaxed);
    result
}

/// True once Ctrl-C was pressed during cancelable work. Pressed again it ends the program at once.
pub fn asked() -> bool {
    ASKED.load(Relaxed)
}

/// Catches Ctrl-C from now on.
///
/// # Errors
/// When the system does not allow it; Ctrl-C then ends the program as it does by itself.
pub fn listen() -> Result<(), ctrlc::Error> {
    static FIRST: Once = Once::new();
    let mut result = Ok(());
    FIRST.call_once(|| {
        result = ctrlc::set_handler(|| {
            if !WORKING.load(Relaxed) || ASKED.swap(true, Relaxed) {
                std::process::exit(INTERRUPTED);
            }
        });
    });
    result
}
