//! Trying a property on some cases, in a process of its own.

use std::fs::File;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

use super::discovery::Property;
use phalanx_lab::files;

/// A property that has not answered by then hangs.
const PATIENCE: Duration = Duration::from_mins(20);

/// How long a failure is made smaller, ms.
const SHRINKING_MS: u32 = 120_000;

/// The most of what a failed test says that is kept, characters.
const LONGEST_MESSAGE: usize = 2_000;

/// Which cases are tried.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) struct Draw {
    pub(super) rng_seed: u64,
    pub(super) cases: u32,
}

/// How long the cases took, s, or what the test says of the one that failed.
pub(super) fn run(property: &Property, draw: Draw) -> Result<Result<f64, String>> {
    // To a file, since nobody would read a pipe until the end.
    let log = files::in_repository("target/properties.log");
    let out = File::create(&log).with_context(|| log.display().to_string())?;
    let begin = Instant::now();
    let mut child = Command::new(&property.program)
        .current_dir(&property.folder)
        .args(["--exact", &property.name])
        .env("PROPTEST_RNG_SEED", draw.rng_seed.to_string())
        .env("PROPTEST_CASES", draw.cases.to_string())
        .env("PROPTEST_MAX_GLOBAL_REJECTS", draw.cases.saturating_mul(100).to_string())
        .env("PROPTEST_MAX_SHRINK_TIME", SHRINKING_MS.to_string())
        .stdin(Stdio::null())
        .stderr(out.try_clone()?)
        .stdout(out)
        .spawn()
        .with_context(|| property.program.display().to_string())?;
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if begin.elapsed() > PATIENCE {
            child.kill()?;
            child.wait()?;
            return Ok(Err(format!("no answer within {} minutes", PATIENCE.as_secs() / 60)));
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    if status.success() {
        return Ok(Ok(begin.elapsed().as_secs_f64()));
    }
    let said = std::fs::read(&log).with_context(|| log.display().to_string())?;
    Ok(Err(message(&String::from_utf8_lossy(&said))))
}

/// What failed and the smallest input on which it does, out of all that a test says.
fn message(said: &str) -> String {
    let start = ["Test failed:", "Test aborted:"].iter().find_map(|&mark| said.find(mark));
    let said = &said[start.unwrap_or(0)..];
    let end = said.find("\tsuccesses:").unwrap_or(said.len());
    said[..end].trim_end().chars().take(LONGEST_MESSAGE).collect()
}
