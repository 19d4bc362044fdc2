//! How far a hand's joints move from one frame to the next, and what that tells of a frame beside others.

use phalanx_hand::{Dof, Pose};
use phalanx_refine::PosePrior;

use super::found::Found;
use super::times::Times;
use crate::error::Result;

/// How the joint angles of a take move.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Motion {
    /// Mean squares of how far each moves in the usual time from one frame to the next, radians²; infinite for where the
    /// hand is and how it is turned, of which silhouettes tell enough.
    steps: [f64; Dof::COUNT],
    /// Variances of each, whatever the frame.
    any: [f64; Dof::COUNT],
}

/// An angle that never moves further than this may still do so, radians: what the fits of two frames of a
/// still hand differ by.
const LEAST: f64 = 0.02;

/// Degrees of freedom of the distribution that changes follow: the fewest that have a variance.
pub(super) const FREEDOM: f64 = 3.0;

impl Motion {
    /// Of what was found in a take, as [`of`](Self::of) its poses.
    pub(super) fn of_found(
        found: &[Option<Found>],
        times: &Times,
        prior: &PosePrior,
    ) -> Option<Self> {
        let pose = |found: &Option<Found>| Some(found.as_ref()?.refined.pose);
        Self::of(&found.iter().map(pose).collect::<Vec<_>>(), times, prior)
    }

    /// Of a take's poses, of which this was known before; `None` where no frame follows another.
    fn of(poses: &[Option<Pose>], times: &Times, prior: &PosePrior) -> Option<Self> {
        let pairs = || {
            let pair = |k: usize| Some((poses[k - 1]?, poses[k]?, times.between(k - 1, k)));
            (1..poses.len()).filter_map(pair)
        };
        let step = |dof: Dof| {
            let squares = pairs().map(|(one, other, away)| (other[dof] - one[dof]).powi(2) / away);
            mean(squares).unwrap_or(0.0).max(LEAST.powi(2))
        };
        let any = |dof: Dof| {
            let values = || poses.iter().flatten().map(|pose| pose[dof]);
            let middle = mean(values()).unwrap_or(0.0);
            let variance = mean(values().map(|value| (value - middle).powi(2)));
            variance.unwrap_or(0.0).max(prior.deviation(dof).powi(2))
        };
        let is_any = pairs().next().is_some();
        let step = |dof: Dof| if dof.is_internal() { step(dof) } else { f64::INFINITY };
        is_any.then(|| Self { steps: Dof::ALL.map(step), any: Dof::ALL.map(any) })
    }

    /// How well an angle is known by that of a frame so many usual steps away, a standard deviation, beside what any frame of
    /// the take tells of it: any two frames differ by twice the variance. Of stills, and of frames so far away that they
    /// are not nearer than any, that is nothing (infinite).
    fn known(&self, dof: Dof, away: f64) -> f64 {
        let told = (self.steps[dof.index()] * away).recip() - (2.0 * self.any[dof.index()]).recip();
        told.max(0.0).sqrt().recip()
    }

    /// What speaks against one pose so many steps after another: joints walk at random, mostly slowly and at
    /// times fast (Student's distribution).
    pub(super) fn against(&self, one: &Pose, other: &Pose, away: f64) -> f64 {
        let of = |dof: Dof| unlikely(((other[dof] - one[dof]) / self.known(dof, away)).powi(2));
        Dof::ALL.map(of).iter().sum()
    }

    /// What is known of a pose beside those of other frames, each with how many steps it is away: joints
    /// walk at random.
    pub(super) fn beside(&self, prior: &PosePrior, others: &[(f64, &Found)]) -> Result<PosePrior> {
        others.iter().try_fold(prior.clone(), |prior, (away, other)| {
            let known = Dof::ALL.map(|dof| self.known(dof, *away));
            Ok(prior.product(&PosePrior::independent(other.refined.pose, &known)?)?)
        })
    }
}

/// What speaks against a change of this square over its variance, by Student's distribution.
pub(super) fn unlikely(square: f64) -> f64 {
    0.5 * (FREEDOM + 1.0) * (square / FREEDOM).ln_1p()
}

/// `None` of no values.
pub(super) fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::fitting::take_frame::TakeFrame;
    use crate::synthesis::postures::coupled;

    fn bent(angles: &[f64]) -> Vec<Option<Pose>> {
        let pose = |&angle: &f64| {
            let mut pose = Pose::REST;
            pose[Dof::IndexPip] = angle;
            Some(pose)
        };
        angles.iter().map(pose).collect()
    }

    proptest! {
        #![proptest_config(crate::property::cases(64))]

        #[test]
        fn a_frame_further_away_tells_no_more(
            angles in prop::collection::vec(0.0..1.8_f64, 2..20),
            away in 0.1..30.0_f64,
        ) {
            let times = Times::even(angles.len());
            let motion =
                Motion::of(&bent(&angles), &times, coupled()).expect("one frame follows another");
            let (nearer, further) =
                (motion.known(Dof::IndexPip, away), motion.known(Dof::IndexPip, away + 1.0));
            prop_assert!(nearer > 0.0 && nearer <= further, "{nearer} {further}");
        }
    }

    /// Frames that are missing make a motion no faster.
    #[test]
    fn a_motion_is_as_fast_as_it_is_in_time() {
        let all: Vec<f64> = (0..60).map(|k| 0.01 * f64::from(k * k % 23)).collect();
        let known = |kept: &dyn Fn(&usize) -> bool| {
            let numbers: Vec<usize> = (0..all.len()).filter(kept).collect();
            let angles: Vec<f64> = numbers.iter().map(|&k| all[k]).collect();
            let frame = |&k: &usize| TakeFrame::default().at(k as f64 / 30.0);
            let times = Times::of(&numbers.iter().map(frame).collect::<Vec<_>>()).unwrap();
            Motion::of(&bent(&angles), &times, coupled()).unwrap().known(Dof::IndexPip, 1.0)
        };
        let (whole, with_a_pause) = (known(&|_| true), known(&|k| !(20..40).contains(k)));
        assert!((with_a_pause / whole - 1.0).abs() < 0.15, "{with_a_pause} {whole}");
    }

    #[test]
    fn a_slow_motion_is_known_by_its_neighbours_and_stills_are_not() {
        let slow: Vec<f64> = (0..40).map(|k| 0.9 - 0.9 * (0.1 * f64::from(k)).cos()).collect();
        let known = |angles: &[f64]| {
            let motion = Motion::of(&bent(angles), &Times::even(angles.len()), coupled());
            motion.unwrap().known(Dof::IndexPip, 1.0)
        };
        assert!(known(&slow) < 0.1, "{}", known(&slow));
        // Straight or folded, one as often as the other, in no order.
        let stills: Vec<f64> = (0..40).map(|k| if k * k % 7 < 3 { 0.0 } else { 1.8 }).collect();
        assert!(known(&stills).is_infinite(), "{}", known(&stills));
    }
}
