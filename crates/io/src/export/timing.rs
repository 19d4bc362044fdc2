//! Even times for formats that know a rate only, and poses without gaps.

use phalanx_hand::Pose;

use crate::error::{Error, Result};
use crate::take::Take;

/// The frame rate, Hz: as the header says, else the mean of the frames' own times; 1 of a single
/// frame.
pub fn frame_rate(take: &Take) -> f64 {
    let ends = take.frames.first().zip(take.frames.last());
    let span = ends.map_or(0.0, |(first, last)| last.time - first.time);
    let mean = if span > 0.0 { (take.frames.len() - 1) as f64 / span } else { 1.0 };
    take.header.rate_hz.unwrap_or(mean)
}

/// The largest distance of a frame's time from an even beat at [`frame_rate`], s. Formats that
/// know a rate only ([`bvh`](super::bvh()), [`c3d`](super::c3d())) shift frames by up to so much.
pub fn largest_jitter(take: &Take) -> f64 {
    let Some(first) = take.frames.first() else { return 0.0 };
    let rate = frame_rate(take);
    let apart = |(k, time): (usize, f64)| (time - first.time - k as f64 / rate).abs();
    take.frames.iter().map(|frame| frame.time).enumerate().map(apart).fold(0.0, f64::max)
}

/// A pose a frame, the one before where none was found, and the first one before that.
pub(super) fn filled_poses(take: &Take, format: &'static str) -> Result<Vec<Pose>> {
    let found = |pose: &Option<Pose>| pose.is_some();
    let poses = take.frames.iter().map(|frame| frame.estimate.as_ref().map(|e| e.pose));
    let poses: Vec<Option<Pose>> = poses.collect();
    let first = poses.iter().copied().find(found).flatten();
    let first = first.ok_or(Error::NoPose { format })?;
    let filled = poses.into_iter().scan(first, |last, pose| {
        *last = pose.unwrap_or(*last);
        Some(*last)
    });
    Ok(filled.collect())
}
