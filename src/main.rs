//! The `strataray` command: argument parsing only, see [`cli`].

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}
