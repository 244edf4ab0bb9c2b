//! What commands write on standard output.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write};

/// Writes to standard output. Where nobody reads on, as with `| head`, the command has done what it was asked for
/// and ends.
pub fn write(text: Arguments<'_>) {
    let Err(error) = std::io::stdout().lock().write_fmt(text) else {
        return;
    };
    if error.kind() == ErrorKind::BrokenPipe {
        std::process::exit(0);
    }
    eprintln!("strataray: cannot write on standard output: {error}");
    std::process::exit(1);
}

/// As `print!`, by [`write`].
macro_rules! say {
    ($($text:tt)*) => {
        $crate::cli::output::write(format_args!($($text)*))
    };
}

/// As `println!`, by [`write`].
macro_rules! say_line {
    ($($text:tt)*) => {
        $crate::cli::output::write(format_args!("{}\n", format_args!($($text)*)))
    };
}
