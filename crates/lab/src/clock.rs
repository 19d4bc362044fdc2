//! The one clock of all experiments: CPU time, so that what else the computer does counts as little as it
//! can.

use std::time::Duration;

use cpu_time::{ProcessTime, ThreadTime};

/// Shortest stretch of time that one reading of the clock covers.
const STRETCH: Duration = Duration::from_millis(2);
/// Readings, of which the median counts.
const READINGS: usize = 5;

/// CPU seconds of this process, all its threads together, that some work takes, and what it makes.
pub(crate) fn timed<T, E>(work: impl FnOnce() -> Result<T, E>) -> Result<(f64, T), E> {
    let start = ProcessTime::now();
    let made = work()?;
    Ok((start.elapsed().as_secs_f64(), made))
}

/// CPU milliseconds of this thread that some work takes, and what it makes.
pub(crate) fn thread_ms<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = ThreadTime::now();
    let made = work();
    (1e3 * start.elapsed().as_secs_f64(), made)
}

/// CPU seconds that one of `times` repetitions of something quick takes.
pub(crate) fn each<E>(times: u32, mut work: impl FnMut() -> Result<(), E>) -> Result<f64, E> {
    let (seconds, ()) = timed(|| (0..times).try_for_each(|_| work()))?;
    Ok(seconds / f64::from(times))
}

/// CPU seconds that work takes, the median of several readings of as many calls as fill a stretch.
pub(crate) fn seconds(mut work: impl FnMut() -> anyhow::Result<()>) -> anyhow::Result<f64> {
    let once = each(1, &mut work)?.max(1e-9);
    let calls = (STRETCH.as_secs_f64() / once).ceil().clamp(1.0, 1e5) as u32;
    let readings =
        (0..READINGS).map(|_| each(calls, &mut work)).collect::<anyhow::Result<Vec<_>>>()?;
    Ok(median(readings).unwrap_or(f64::NAN))
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

/// Three digits and a unit.
pub(crate) fn duration(seconds: f64) -> String {
    let units = [(1.0, "s"), (1e-3, "ms"), (1e-6, "µs")];
    let (size, unit) = units.into_iter().find(|(size, _)| seconds >= *size).unwrap_or((1e-9, "ns"));
    let value = seconds / size;
    let decimals = if value < 10.0 { 2 } else { usize::from(value < 100.0) };
    format!("{value:.decimals$} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_have_three_digits() {
        assert_eq!(duration(1.234e-5), "12.3 µs");
        assert_eq!(duration(0.17), "170 ms");
        assert_eq!(duration(7.0), "7.00 s");
    }

    #[test]
    fn the_median_is_the_middle_value() {
        assert_eq!(median([3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median([]), None);
    }
}
