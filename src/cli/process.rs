//! What the system says of this process.

use std::time::Duration;

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
