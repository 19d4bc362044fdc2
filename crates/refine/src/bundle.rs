//! The proportions of a person's hand, and where the cameras stand, from several frames.

use glam::DAffine3;
use phalanx_camera::Camera;
use phalanx_hand::{HandShape, Pose};
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::geometry::correspondence::View;
use crate::observation::silhouette::Evidence;
use crate::pose_fit::settings::Refinement;
use crate::priors::nuisance::{CameraDoubt, Doubt, HandDoubt};
use crate::priors::pose::PosePrior;
use crate::solver::levenberg_marquardt::{ANY_ENERGY, State, overlaps};
use crate::solver::normal_equations::shared_covariance;
use crate::solver::problem::{Frame, Freedom, Problem};

/// How a hand is fitted to several frames of it.
///
/// Each frame is refined for itself; then the poses of all frames and what they share are fitted
/// together. What cannot be told from the frames stays as it was given.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// How poses are refined.
    pub refinement: Refinement,
    /// How far the hand may be from the given one.
    pub hand: HandDoubt,
    /// How far the cameras may be from where they are said to stand; `None` where that is certain.
    pub cameras: Option<CameraDoubt>,
}

impl Default for Calibration {
    /// Cameras are taken as they are given.
    fn default() -> Self {
        let doubt = Doubt::default();
        Self {
            refinement: Refinement { doubt: Some(doubt), ..Refinement::default() },
            hand: HandDoubt { size: 0.05, each: 0.06 },
            cameras: None,
        }
    }
}

/// One frame to calibrate from.
#[derive(Debug, Clone)]
pub struct CalibrationFrame {
    /// What each camera saw; the same cameras in every frame where cameras are fitted.
    pub evidence: Vec<Evidence>,
    /// Where to start.
    pub start: Pose,
    /// What is known of the pose.
    pub prior: PosePrior,
}

/// A calibrated hand.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibrated {
    /// The hand.
    pub hand: HandShape,
    /// How well each of its proportions is known, standard deviations of logarithms: the size's, then
    /// one for every bone and radius in the order of [`HandShape::varied`].
    pub hand_std: Vec<f64>,
    /// The cameras; those that were doubted and do not move, where they were found to stand, the others as given.
    pub cameras: Vec<Camera>,
    /// The pose in each frame.
    pub poses: Vec<Pose>,
    /// Intersection over union of the drawn and the observed silhouettes, frame by frame and view
    /// by view.
    pub overlaps: Vec<Vec<f64>>,
    /// Root of the mean (robust) squared distance of the borders, px.
    pub border_px: f64,
    /// Whether the last steps won nothing worth having.
    pub converged: bool,
}

impl Calibration {
    /// Fits `given`, whose frame at rest is mapped to the world by `rest`, to the frames.
    ///
    /// # Errors
    /// No frame or no evidence, frames that differ in their views, a parameter out of its range, a
    /// hand that no one has or that a camera cannot draw.
    pub fn run(
        &self,
        given: &HandShape,
        rest: &DAffine3,
        frames: &[CalibrationFrame],
    ) -> Result<Calibrated> {
        self.refinement.check()?;
        let first = frames.first().ok_or(Error::NoEvidence)?;
        for (frame, CalibrationFrame { evidence, .. }) in frames.iter().enumerate() {
            let (found, expected) = (evidence.len(), first.evidence.len());
            if found != expected && self.cameras.is_some() {
                return Err(Error::ViewCount { frame, found, expected });
            }
        }
        let refine = |frame: &CalibrationFrame| {
            let CalibrationFrame { evidence, start, prior } = frame;
            self.refinement.run(given, rest, evidence, start, prior).map(|refined| refined.pose)
        };
        let starts: Vec<Pose> = frames.par_iter().map(refine).collect::<Result<_>>()?;
        let problem = Problem {
            given,
            rest,
            frames: frames
                .iter()
                .map(|frame| Frame { evidence: &frame.evidence, prior: &frame.prior })
                .collect(),
            freedom: Freedom { hand: Some(self.hand), cameras: self.cameras },
        };
        let start = State {
            moments: (0..).zip(&starts).map(|(k, pose)| problem.moment(k, pose)).collect(),
            shared: problem.shared(),
        };
        let views = frames.iter().map(|frame| frame.evidence.iter().map(View::new).collect());
        let mut views: Vec<Vec<View>> = views.collect::<Result<_>>()?;
        let outcome = self.refinement.descend_from(1, &problem, start, ANY_ENERGY, &mut views)?;
        let overlaps = overlaps(&problem, &outcome.state, self.refinement.finest(), &mut views)?;
        let shared = &outcome.state.shared;
        let camera = |(k, evidence): (usize, &Evidence)| {
            let correction = shared.corrections.get(k);
            let moved = correction.map(|own| own.camera(evidence.camera(), rest.translation));
            moved.unwrap_or_else(|| evidence.camera().clone())
        };
        let (_, known) = problem.shared_prior(shared);
        let covariance = shared_covariance(&outcome.frames, &known).ok_or_else(|| {
            let reason = "leaves proportions open that the silhouettes do not tell".to_owned();
            Error::Precision { reason }
        })?;
        let numbers = 0..shared.proportions.logarithms.len();
        Ok(Calibrated {
            hand: shared.proportions.hand(given),
            hand_std: numbers.map(|k| covariance[(k, k)].max(0.0).sqrt()).collect(),
            cameras: first.evidence.iter().enumerate().map(camera).collect(),
            poses: outcome.state.moments.iter().map(|moment| moment.pose).collect(),
            overlaps,
            border_px: outcome.border_px(self.refinement.noise),
            converged: outcome.converged,
        })
    }
}
