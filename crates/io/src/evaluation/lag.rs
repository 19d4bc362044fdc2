//! How much later a take says what a reference says.

use glam::DVec3;
use phalanx_hand::{Dof, JOINTS};

use crate::evaluation::reference::{Clock, Reference};
use crate::export::frame_rate;
use crate::take::Take;

/// The longest lag that is looked for, s.
const LONGEST: f64 = 1.0;
/// Fewer common instants tell no lag.
const LEAST: usize = 20;
/// A correlation below this is no match: the motions have nothing in common.
const LEAST_CORRELATION: f64 = 0.5;

/// A flatter peak tells no lag: rounding alone would choose it.
const LEAST_CURVE: f64 = 1e-4;

/// A lag with how well the two motions then agree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lag {
    /// By how much the take is late, s; negative if it is early.
    pub seconds: f64,
    /// The correlation of the velocities at that lag, −1 to 1.
    pub correlation: f64,
}

/// The lag at which the velocities of all angles and joints correlate best, to a part of a frame
/// (parabola through the best three); none where too little moves or too little is common.
pub fn lag(take: &Take, reference: &Reference) -> Option<Lag> {
    if reference.clock == Clock::Frame {
        return None;
    }
    let step = 1.0 / frame_rate(take);
    let start = take.frames.first()?.time.max(*reference.instants.first()?);
    let end = take.frames.last()?.time.min(*reference.instants.last()?);
    let count = ((end - start) / step).floor().max(0.0) as usize;
    // Bounded by the take's own length, whatever times a file holds.
    let count = count.min(4 * take.frames.len());
    let most = (LONGEST / step).round() as usize;
    let most = most.min(count / 2);
    if count < LEAST || most == 0 {
        return None;
    }
    let channels: Vec<[Vec<f64>; 2]> = (0..Dof::COUNT + 3 * JOINTS)
        .map(|channel| {
            [take_signal(take, channel), reference_signal(reference, channel)]
                .map(|signal| velocities(&signal, start, step, count))
        })
        .filter(|[a, b]| [a, b].iter().all(|signal| signal.iter().any(|v| !v.is_nan())))
        .collect();
    let shifts = -(most as isize)..=most as isize;
    let correlations: Vec<f64> = shifts.map(|shift| correlation(&channels, shift)).collect();
    let best = (1..correlations.len() - 1)
        .filter(|&k| !correlations[k].is_nan())
        .max_by(|&a, &b| correlations[a].total_cmp(&correlations[b]))?;
    let [before, at, after] = [best - 1, best, best + 1].map(|k| correlations[k]);
    if at < LEAST_CORRELATION || at < before || at < after {
        return None;
    }
    // A steady motion correlates with itself at any lag.
    let curve = before - 2.0 * at + after;
    if curve > -LEAST_CURVE {
        return None;
    }
    let part = 0.5 * (before - after) / curve;
    let shift = best as f64 - most as f64 + part;
    Some(Lag { seconds: shift * step, correlation: at })
}

/// One of the 28 numbers, or after them one coordinate of a joint.
fn channel_of(pose: &[f64; Dof::COUNT], joints: &[DVec3; JOINTS], channel: usize) -> f64 {
    match channel.checked_sub(Dof::COUNT) {
        None => pose[channel],
        Some(k) => joints[k / 3][k % 3],
    }
}

/// Pairs of time and value.
fn take_signal(take: &Take, channel: usize) -> Vec<(f64, f64)> {
    let found = take.frames.iter().filter_map(|f| Some((f.time, f.estimate.as_ref()?)));
    found.map(|(time, e)| (time, channel_of(&e.pose.0, &e.joints, channel))).collect()
}

fn reference_signal(reference: &Reference, channel: usize) -> Vec<(f64, f64)> {
    let rows = reference.poses.iter().zip(&reference.joints);
    let values = rows.map(|(pose, joints)| channel_of(pose, joints, channel));
    reference.instants.iter().copied().zip(values).filter(|(_, value)| !value.is_nan()).collect()
}

/// Differences of a signal on an even grid, NaN outside it.
fn velocities(signal: &[(f64, f64)], start: f64, step: f64, count: usize) -> Vec<f64> {
    let at = |k: usize| interpolated(signal, start + k as f64 * step);
    (0..count).map(|k| at(k + 1) - at(k)).collect()
}

fn interpolated(signal: &[(f64, f64)], time: f64) -> f64 {
    let after = signal.partition_point(|&(other, _)| other < time);
    match (after.checked_sub(1).map(|before| signal[before]), signal.get(after)) {
        (Some((t0, v0)), Some(&(t1, v1))) => v0 + (v1 - v0) * (time - t0) / (t1 - t0),
        (None, Some(&(t1, v1))) if t1 - time < 1e-9 => v1,
        _ => f64::NAN,
    }
}

/// The correlation of the take's velocities with the reference's `shift` steps before.
fn correlation(channels: &[[Vec<f64>; 2]], shift: isize) -> f64 {
    let mut sum = 0.0;
    let mut weight = 0.0;
    for [take, reference] in channels {
        let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
        for (k, x) in take.iter().enumerate() {
            let other = k.checked_add_signed(-shift).and_then(|k| reference.get(k));
            let Some(y) = other.filter(|y| !y.is_nan() && !x.is_nan()) else { continue };
            xy += x * y;
            xx += x * x;
            yy += y * y;
        }
        let scale = (xx * yy).sqrt();
        if scale > 0.0 {
            sum += xy / scale;
            weight += 1.0;
        }
    }
    if weight > 0.0 { sum / weight } else { f64::NAN }
}
