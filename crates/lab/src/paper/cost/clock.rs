//! Timing work, and how times grow.

use std::time::{Duration, Instant};

use anyhow::Result;

/// Shortest stretch of time that one reading of the clock covers.
const STRETCH: Duration = Duration::from_millis(2);
/// Readings, of which the median counts.
const READINGS: usize = 5;

/// Seconds that work takes, the median of several readings of as many calls as fill a
/// stretch.
pub(super) fn seconds(mut work: impl FnMut() -> Result<()>) -> Result<f64> {
    let begin = Instant::now();
    work()?;
    let once = begin.elapsed().as_secs_f64().max(1e-9);
    let calls = (STRETCH.as_secs_f64() / once).ceil().clamp(1.0, 1e5) as usize;
    let mut reading = || {
        let begin = Instant::now();
        for _ in 0..calls {
            work()?;
        }
        Ok(begin.elapsed().as_secs_f64() / calls as f64)
    };
    let mut readings = (0..READINGS).map(|_| reading()).collect::<Result<Vec<_>>>()?;
    readings.sort_unstable_by(f64::total_cmp);
    Ok(readings[READINGS / 2])
}

/// How a time grows with a size: the exponent of the power law that fits best, by least squares
/// on logarithms.
pub(super) fn exponent(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean_x = logs.iter().map(|p| p.0).sum::<f64>() / count;
    let mean_y = logs.iter().map(|p| p.1).sum::<f64>() / count;
    let product: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    product / logs.iter().map(|(x, _)| (x - mean_x).powi(2)).sum::<f64>()
}

/// Three digits and a unit.
pub(super) fn duration(seconds: f64) -> String {
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
    fn a_power_law_has_its_exponent() {
        let points: Vec<(f64, f64)> = [1.0, 2.0, 5.0].map(|x: f64| (x, 3.0 * x.powf(1.5))).into();
        assert!((exponent(&points) - 1.5).abs() < 1e-12);
    }

    #[test]
    fn durations_have_three_digits() {
        assert_eq!(duration(1.234e-5), "12.3 µs");
        assert_eq!(duration(0.17), "170 ms");
        assert_eq!(duration(7.0), "7.00 s");
    }
}
