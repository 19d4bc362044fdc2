//! How much memory processes have held.

/// The most that this process has held so far, bytes, where the system tells.
pub(crate) fn peak() -> Option<usize> {
    peak_of("self")
}

/// The most that a process that runs has held so far, by its number; bytes.
pub(crate) fn peak_of(process: &str) -> Option<usize> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: usize = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kibibytes)
}
