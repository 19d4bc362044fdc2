//! Estimates of hands seen through windows, which tell where a hand is.

use phalanx_camera::{Rig, Volume};
use phalanx_hand::{Dof, HandShape, Pose};
use serde::{Deserialize, Serialize};

use crate::checking::usual::quantile;
use crate::error::{Error, Result};
use crate::estimator::estimate::Estimate;
use crate::estimator::observation::ObservedView;
use crate::localize::global_pose::initial_global;
use crate::synthesis::sampler::LEAN_DEG;
use crate::window::{Framing, PicturedHand};

/// What a hand's place in its windows tells.
pub(crate) const PLACED: [Dof; 5] = [Dof::ThetaX, Dof::ThetaY, Dof::TX, Dof::TY, Dof::TZ];

/// The numbers that windows tell where they are looked through, and regression does not.
pub(crate) fn placed(framing: Framing) -> &'static [Dof] {
    match framing {
        Framing::Picture => &[],
        Framing::Window => &PLACED,
    }
}

/// A pose without what windows tell.
pub(crate) fn unplaced(pose: &Pose, framing: Framing) -> Pose {
    let mut pose = *pose;
    for &dof in placed(framing) {
        pose[dof] = Pose::REST[dof];
    }
    pose
}

/// Standard deviations of the θ_X, θ_Y, t_X, t_Y and t_Z of a hand, radians and mm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PlacementErrors(pub [f64; PLACED.len()]);

/// Shares of a normal distribution's errors and how many standard deviations these are within.
const OF_NORMAL: [(f64, f64); 2] = [(0.6827, 1.0), (0.95, 1.96)];

impl PlacementErrors {
    /// From estimates and the truth of each, at least one: as wide as it takes for both 68 % and 95 % of
    /// the errors to be as near as a normal distribution has them. Errors along the only view there is have
    /// longer tails.
    pub(crate) fn learn(pairs: &[(Pose, Pose)]) -> Self {
        Self(PLACED.map(|dof| {
            let errors =
                || pairs.iter().map(|(estimate, truth)| (estimate[dof] - truth[dof]).abs());
            let width = |(share, deviations)| quantile(errors().collect(), share) / deviations;
            OF_NORMAL.map(width).into_iter().fold(f64::MIN_POSITIVE, f64::max)
        }))
    }

    /// Before anything is learnt or seen: hands anywhere in the volume, whose arms lean as those of
    /// [`PoseSource::Anywhere`](crate::PoseSource::Anywhere) do.
    pub(crate) fn of_anywhere(volume: &Volume) -> Self {
        // A uniform distribution's deviation is its width over the root of twelve.
        let uniform = |width: f64| width / 12.0_f64.sqrt();
        let lean = uniform(2.0 * LEAN_DEG.to_radians());
        let [x, y, z] = volume.size.to_array().map(uniform);
        Self([lean, lean, x, y, z])
    }

    /// Refuses what is no standard deviation.
    pub(crate) fn check(&self) -> Result<()> {
        let found = self.0.iter().filter(|std| **std > 0.0 && std.is_finite()).count();
        if found == PLACED.len() {
            return Ok(());
        }
        Err(Error::Mismatch { part: "deviations of a placement", found, expected: PLACED.len() })
    }
}

/// An estimate whose hand is put where its windows show it.
pub(crate) fn place(
    rig: &Rig,
    hand: &HandShape,
    errors: &PlacementErrors,
    estimate: Estimate,
) -> Result<Estimate> {
    let hand_in = |view: &ObservedView| Some(view.window.as_ref()?.pictured_hand());
    let hands: Vec<Option<PicturedHand>> = estimate.observation.views.iter().map(hand_in).collect();
    let pose = initial_global(rig, hand, &estimate.pose, &hands)?.pose;
    let mut std = estimate.std;
    for (dof, error) in PLACED.into_iter().zip(errors.0) {
        std[dof.index()] = Some(error);
    }
    let joints = hand.pose(&pose, &rig.volume.rest_frame()).joints;
    Ok(Estimate { pose, std, joints, ..estimate })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// Estimates with errors spread evenly up to `most` in every placed number, of which a tenth is ten
    /// times as large in the last.
    fn pairs(most: f64) -> Vec<(Pose, Pose)> {
        let pair = |k: u32| {
            let share = (f64::from(k) * 0.618_034).fract();
            let mut estimate = Pose::REST;
            for dof in PLACED {
                estimate[dof] = most * share;
            }
            if k.is_multiple_of(10) {
                estimate[Dof::TZ] *= 10.0;
            }
            (estimate, Pose::REST)
        };
        (0..1000).map(pair).collect()
    }

    #[test]
    fn deviations_hold_for_most_errors_and_for_long_tails() {
        let PlacementErrors(deviations) = PlacementErrors::learn(&pairs(3.0));
        for even in &deviations[..4] {
            assert!((even / 3.0 - 0.6827).abs() < 0.02, "{even}");
        }
        // One in twenty is beyond half of what the tenth reaches.
        let tail = deviations[4];
        assert!((tail - 15.0 / 1.96).abs() < 1.0, "{tail}");
    }

    #[test]
    fn nothing_learnt_is_the_volume() {
        let (forearm, up) = (DVec3::Z, DVec3::Y);
        let volume = Volume { center: DVec3::ZERO, size: DVec3::splat(120.0), forearm, up };
        let PlacementErrors([lean, _, x, y, z]) = PlacementErrors::of_anywhere(&volume);
        assert!([x, y, z].iter().all(|std| (std - 34.64).abs() < 0.01));
        assert!((lean.to_degrees() - 17.32).abs() < 0.01);
    }
}
