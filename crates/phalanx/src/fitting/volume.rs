//! Where the hand works in a recording.

use phalanx_camera::Camera;
use phalanx_hand::HandShape;

use super::consensus::{Posed, VolumeEstimate};
use super::report::{FitDoubt, FrameFit};
use super::starts;
use super::take::{Proportions, TakeFit, TakeSettings, fit_take};
use super::take_frame::TakeFrame;
use crate::error::{Error, Result};
use crate::progress::Progress;

/// Finds out where a hand works from what cameras saw in some frames, which are fitted together.
///
/// Nothing is assumed of where fingers or back of the hand point. `hand` says of which side it is; a mean one
/// will do ([`HandShape::adult`]), since its proportions are fitted. Frames count as for [`trusted_volume`].
///
/// # Errors
/// Frames with another number of masks or landmarks than cameras, or without any hand.
pub fn estimate_volume(
    cameras: &[Camera],
    frames: &[TakeFrame],
    hand: &HandShape,
    progress: &dyn Progress,
) -> Result<VolumeEstimate> {
    let settings = TakeSettings { hand: hand.clone(), proportions: Proportions::FromTake };
    trusted_volume(&fit_take(cameras, frames, &settings, progress)?)
}

/// Where a take's hand works, by the frames that nothing speaks against; where there are none, by all in which a hand
/// is seen.
///
/// # Errors
/// A take without any hand.
pub fn trusted_volume(take: &TakeFit) -> Result<VolumeEstimate> {
    let rest = take.volume.volume.rest_frame();
    let posed = |is_counted: fn(&FrameFit) -> bool| -> Vec<Posed> {
        let counted = take.frames.iter().filter(|fit| is_counted(fit));
        counted.map(|fit| (fit.pose, rest)).collect()
    };
    let trusted = posed(|fit| fit.doubts.is_empty());
    let poses = if trusted.is_empty() {
        posed(|fit| !fit.doubts.contains(&FitDoubt::NotSeen))
    } else {
        trusted
    };
    let (pose, rest) = poses.first().ok_or(Error::NoHand)?;
    let first = starts::frame_at(pose, rest, &take.hand);
    Ok(VolumeEstimate::of(&first, &poses, &take.hand))
}
