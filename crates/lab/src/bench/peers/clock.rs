//! CPU time, so that what else the computer does counts as little as it can.

use anyhow::Result;
use cpu_time::ProcessTime;

/// CPU seconds of this process that some work takes, and what it makes.
pub(crate) fn timed<T, E>(work: impl FnOnce() -> Result<T, E>) -> Result<(f64, T), E> {
    let start = ProcessTime::now();
    let made = work()?;
    Ok((start.elapsed().as_secs_f64(), made))
}

/// CPU seconds that one of `times` repetitions of something quick takes.
pub(crate) fn each<E>(times: u32, mut work: impl FnMut() -> Result<(), E>) -> Result<f64, E> {
    let (seconds, ()) = timed(|| (0..times).try_for_each(|_| work()))?;
    Ok(seconds / f64::from(times))
}

/// The middle value; none of no values.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// The middle of what is measured of several runs; NaN of none.
pub(crate) fn middle<T>(runs: &[T], of: fn(&T) -> f64) -> f64 {
    median(runs.iter().map(of)).unwrap_or(f64::NAN)
}
