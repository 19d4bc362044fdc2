//! How well a fitted pose is known, the hand being known only so well.

use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, Side};
use glam::{DAffine3, DVec3};
use phalanx_hand::{Bone, Dof, HandShape, JOINTS, Pose};

use crate::error::{Error, Result};
use crate::observation::evidence::Evidence;
use crate::pose_fit::settings::PoseFitSettings;
use crate::priors::nuisance::ShapePrior;
use crate::priors::pose::PosePrior;
use crate::solver::loss::RobustLoss;
use crate::solver::matched_frame::FramePoint;
use crate::solver::problem::{Frame, FreeParameters, Problem};

/// How well a fitted hand is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Posterior {
    /// Standard deviation of each number of the pose, in its unit; 0 of those that were given.
    pub std: [f64; Dof::COUNT],
    /// Root mean square distance of each joint from where it is said to be, mm.
    pub joints: [f64; JOINTS],
}

impl PoseFitSettings {
    /// The deviations of a fitted pose (Laplace's approximation): from the curvature of the energy in
    /// pose and proportions together, where each proportion is known to a standard deviation of its
    /// logarithm, in the order of [`ShapePrior::deviations`]
    /// ([`BundleResult::hand_std`](crate::BundleResult::hand_std)). They are
    /// honest where the evidence is weighted by how its boundaries
    /// ([`weighted`](crate::SilhouetteObservation::weighted)) and its points
    /// ([`weighted`](crate::LandmarkObservation::weighted)) err together.
    ///
    /// # Errors
    /// No evidence, another number of proportions than the hand has, silhouettes that leave
    /// directions open, or a hand that a camera cannot draw.
    pub fn posterior<'e>(
        &self,
        hand: &HandShape,
        rest: &DAffine3,
        evidence: impl Into<Evidence<'e>>,
        pose: &Pose,
        prior: &PosePrior,
        hand_std: &[f64],
    ) -> Result<Posterior> {
        self.check()?;
        let evidence = evidence.into();
        if evidence.is_empty() {
            return Err(Error::NoObservation);
        }
        let anything = ShapePrior { size: 1.0, thickness: 1.0, each: 1.0 };
        let problem = Problem {
            given: hand,
            rest,
            frames: vec![Frame { evidence, prior }],
            freedom: FreeParameters { hand: Some(anything), cameras: None },
        };
        let (parameters, shared) = (problem.frame_parameters(0, pose), problem.shared());
        let count = shared.shape.logarithms.len();
        if hand_std.len() != count {
            let reason = format!("is of {} shape, the hand has {count}", hand_std.len());
            return Err(Error::Precision { reason });
        }
        let mut views = self.matchers(evidence.silhouettes)?;
        // Views that were fitted with are believed.
        let loss = RobustLoss { disagreement: f64::INFINITY, ..self.finest() };
        let at = FramePoint {
            problem: &problem,
            frame: 0,
            parameters: &parameters,
            shared: &shared,
            loss,
        };
        let system = at.linearised(&mut views)?;
        let mut hessian = system.whole_hessian();
        let own = hessian.nrows() - count;
        for (k, std) in hand_std.iter().enumerate() {
            hessian[(own + k, own + k)] += std.max(LEAST_STD).powi(-2);
        }
        let open = || Error::Precision {
            reason: "leaves directions open that the silhouettes do not tell".to_owned(),
        };
        // Scaled to a diagonal of ones: radians, millimetres and logarithms are far apart.
        let scale: Vec<f64> =
            (0..hessian.nrows()).map(|k| hessian[(k, k)].sqrt().recip()).collect();
        let scaled =
            Mat::from_fn(scale.len(), scale.len(), |i, j| hessian[(i, j)] * scale[i] * scale[j]);
        let inverse = scaled.llt(Side::Lower).map_err(|_| open())?.inverse();
        let covariance =
            Mat::from_fn(scale.len(), scale.len(), |i, j| inverse[(i, j)] * scale[i] * scale[j]);
        let dofs = prior.dofs();
        let mut std = [0.0; Dof::COUNT];
        for (k, dof) in dofs.iter().enumerate() {
            std[dof.index()] = covariance[(k, k)].max(0.0).sqrt();
        }
        let slopes =
            [joint_slopes(hand, rest, pose, dofs), shared.shape.joint_slopes(hand, pose, rest)]
                .concat();
        let unknowns: Vec<usize> = (0..dofs.len()).chain(own..own + count).collect();
        Ok(Posterior { std, joints: spreads(&covariance, &unknowns, &slopes) })
    }
}

/// A proportion is not known better than this, as a logarithm: a tenth of a per cent.
const LEAST_STD: f64 = 1e-3;

/// How each joint moves with each number of the pose.
fn joint_slopes(
    hand: &HandShape,
    rest: &DAffine3,
    pose: &Pose,
    dofs: &[Dof],
) -> Vec<[DVec3; JOINTS]> {
    let (joints, twists) = (hand.pose(pose, rest).joints, hand.twists(pose, rest));
    let slope = |dof: Dof, joint: usize| {
        let is_moved = Bone::of_joint(joint).is_moved_by(dof);
        if is_moved { twists.of(dof).velocity(joints[joint]) } else { DVec3::ZERO }
    };
    dofs.iter().map(|&dof| std::array::from_fn(|joint| slope(dof, joint))).collect()
}

/// The root of each joint's mean squared distance: of the trace of S C Sᵀ.
fn spreads(covariance: &Mat<f64>, unknowns: &[usize], slopes: &[[DVec3; JOINTS]]) -> [f64; JOINTS] {
    std::array::from_fn(|joint| {
        let mut square = 0.0;
        for (&i, one) in unknowns.iter().zip(slopes) {
            for (&j, other) in unknowns.iter().zip(slopes) {
                square += covariance[(i, j)] * one[joint].dot(other[joint]);
            }
        }
        square.max(0.0).sqrt()
    })
}
