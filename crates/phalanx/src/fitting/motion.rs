//! How far a hand's joints move from one frame to the next, and what that tells of a frame beside others.

use phalanx_hand::{Dof, Pose};
use phalanx_refine::PosePrior;

use super::frame_fit::Found;
use crate::error::Result;

/// Standard deviations of how far each joint angle moves from one frame to the next, radians; infinite for
/// where the hand is and how it is turned, of which silhouettes tell enough.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Motion([f64; Dof::COUNT]);

/// An angle that never moves further than this may still do so, radians: what the fits of two frames of a
/// still hand differ by.
const LEAST: f64 = 0.02;

/// Degrees of freedom of the distribution that changes follow: the fewest that have a variance.
pub(super) const FREEDOM: f64 = 3.0;

impl Motion {
    /// Of a take's poses; `None` where no frame follows another.
    pub(super) fn of(found: &[Option<Found>]) -> Option<Self> {
        let pairs =
            || found.windows(2).filter_map(|pair| Some((pair[0].as_ref()?, pair[1].as_ref()?)));
        let count = pairs().count();
        let deviation = |dof: Dof| {
            let square = |(one, other): (&Found, &Found)| {
                (other.refined.pose[dof] - one.refined.pose[dof]).powi(2)
            };
            (pairs().map(square).sum::<f64>() / count as f64).sqrt().max(LEAST)
        };
        let of = |dof: Dof| if dof.is_internal() { deviation(dof) } else { f64::INFINITY };
        (count > 0).then(|| Self(Dof::ALL.map(of)))
    }

    /// What speaks against one pose so many frames after another: joints walk at random, mostly slowly and at
    /// times fast (Student's distribution).
    pub(super) fn against(&self, one: &Pose, other: &Pose, away: usize) -> f64 {
        let of = |dof: Dof| {
            let deviations = (other[dof] - one[dof]) / self.0[dof.index()];
            let square = deviations * deviations / away as f64;
            0.5 * (FREEDOM + 1.0) * (square / FREEDOM).ln_1p()
        };
        Dof::ALL.map(of).iter().sum()
    }

    /// What is known of a pose beside those of other frames, each with how many frames it is away: joints
    /// walk at random.
    pub(super) fn beside(
        &self,
        prior: &PosePrior,
        others: &[(usize, &Found)],
    ) -> Result<PosePrior> {
        others.iter().try_fold(prior.clone(), |prior, (away, other)| {
            let moved = self.0.map(|deviation| deviation * (*away as f64).sqrt());
            Ok(prior.product(&PosePrior::independent(other.refined.pose, &moved)?)?)
        })
    }
}
