//! What programs take that are started here.

use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use anyhow::{Context, Result, ensure};

use crate::memory;

pub(crate) const MEBIBYTE: f64 = (1 << 20) as f64;

/// What a program took, all its threads together.
pub(crate) struct Taken {
    pub(crate) cpu_seconds: f64,
    /// The most memory that it held, bytes.
    pub(crate) peak: f64,
}

/// Runs a program to its end; what it prints is thrown away.
pub(crate) fn run(program: &mut Command) -> Result<Taken> {
    let unknown = "this system does not say what a program took";
    let before = cpu_seconds().context(unknown)?;
    let mut child = program.stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
    let process = child.id().to_string();
    let mut peak = None;
    let status = loop {
        peak = memory::peak_of(&process).max(peak);
        if let Some(status) = child.try_wait()? {
            break status;
        }
        sleep(Duration::from_millis(20));
    };
    ensure!(status.success(), "{program:?}: {status}");
    let cpu_seconds = cpu_seconds().context(unknown)? - before;
    Ok(Taken { cpu_seconds, peak: peak.context(unknown)? as f64 })
}

/// CPU time of all programs that were started here and have ended, where the system tells.
fn cpu_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // Behind the program's name, which may hold anything: cutime and cstime, in hundredths of a second.
    let (_, fields) = stat.rsplit_once(')')?;
    let ticks = fields.split_whitespace().skip(13).take(2).map(str::parse::<u64>);
    Some(ticks.sum::<Result<u64, _>>().ok()? as f64 / 100.0)
}
