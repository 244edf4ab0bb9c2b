//! What the system says of this process, and what it is given.

use std::time::Duration;

/// Begins this process anew with a runtime folder where it has none: graphics drivers look for a display there and
/// print a complaint of their own without one, and variables can be set safely only for a program that starts.
#[cfg(target_os = "linux")]
pub fn give_runtime_folder() {
    use std::os::unix::process::CommandExt;
    const VARIABLE: &str = "XDG_RUNTIME_DIR";
    let is_folder = |path: &std::ffi::OsString| std::path::Path::new(path).is_dir();
    let folder = std::env::temp_dir();
    if std::env::var_os(VARIABLE).is_some_and(|f| is_folder(&f)) || !folder.is_dir() {
        return;
    }
    let Ok(program) = std::env::current_exe() else {
        return;
    };
    let mut command = std::process::Command::new(program);
    let mut arguments = std::env::args_os();
    if let Some(name) = arguments.next() {
        command.arg0(name);
    }
    // This comes back only where it fails, and then the process goes on without the folder.
    let _ = command.args(arguments).env(VARIABLE, folder).exec();
}

/// Nothing is needed on other systems.
#[cfg(not(target_os = "linux"))]
pub fn give_runtime_folder() {}

/// CPU time of this process so far, where the system tells (Linux), else zero.
pub fn cpu_time() -> Duration {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // Fields 14 and 15, user and system time in ticks of 10 ms, counted behind the command's name.
    let fields: Vec<&str> = stat
        .rsplit(')')
        .next()
        .unwrap_or_default()
        .split_whitespace()
        .collect();
    let ticks = |n: usize| {
        fields
            .get(n)
            .and_then(|f| f.parse::<u64>().ok())
            .unwrap_or(0)
    };
    Duration::from_millis(10 * (ticks(11) + ticks(12)))
}

/// Most memory in bytes that this process has held since its start or the last [`forget_peak`],
/// where the system tells (Linux).
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix(" kB")?.trim().parse().ok()?;
    Some(1024 * kilobytes)
}

/// Lets [`peak_memory`] start anew from what is held now; false where the system does not (all but Linux).
pub fn forget_peak() -> bool {
    // The number is the kernel's for "reset the peak"; nothing else is touched.
    std::fs::write("/proc/self/clear_refs", "5").is_ok()
}
