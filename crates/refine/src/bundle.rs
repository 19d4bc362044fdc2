//! The proportions of a person's hand, and where the cameras stand, from several frames.

use glam::DAffine3;
use phalanx_camera::Camera;
use phalanx_hand::{HandShape, Pose};
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::geometry::correspondence::ViewMatcher;
use crate::observation::evidence::Evidence;
use crate::observation::landmarks::LandmarkObservation;
use crate::observation::silhouette::SilhouetteObservation;
use crate::pose_fit::settings::PoseFitSettings;
use crate::priors::nuisance::{ExtrinsicsPrior, NuisanceParameters, ShapePrior};
use crate::priors::pose::PosePrior;
use crate::solver::levenberg_marquardt::{ANY_ENERGY, State, ious};
use crate::solver::normal_equations::shared_covariance;
use crate::solver::problem::{Frame, FreeParameters, Problem};

/// How a hand is fitted to several frames of it.
///
/// Each frame is refined for itself; then the poses of all frames and what they share are fitted
/// together. What cannot be told from the frames stays as it was given.
#[derive(Debug, Clone, PartialEq)]
pub struct BundleAdjustment {
    /// How poses are refined.
    pub pose_fit: PoseFitSettings,
    /// How far the hand may be from the given one.
    pub hand: ShapePrior,
    /// How far the cameras may be from where they are said to stand; `None` where that is certain.
    pub cameras: Option<ExtrinsicsPrior>,
}

impl Default for BundleAdjustment {
    /// Cameras are taken as they are given.
    fn default() -> Self {
        let nuisance = NuisanceParameters::default();
        Self {
            pose_fit: PoseFitSettings { nuisance: Some(nuisance), ..PoseFitSettings::default() },
            hand: ShapePrior { size: 0.05, thickness: 0.06, each: 0.06 },
            cameras: None,
        }
    }
}

/// One frame to calibrate from.
#[derive(Debug, Clone)]
pub struct BundleFrame {
    /// What each camera saw; the same cameras in every frame where cameras are fitted.
    pub observations: Vec<SilhouetteObservation>,
    /// The landmarks of each camera that has some; of the same cameras in every frame where cameras are fitted.
    pub landmarks: Vec<LandmarkObservation>,
    /// Where to start.
    pub start: Pose,
    /// What is known of the pose.
    pub prior: PosePrior,
}

impl BundleFrame {
    /// All that was seen in it.
    pub fn evidence(&self) -> Evidence<'_> {
        Evidence { silhouettes: &self.observations, landmarks: &self.landmarks }
    }
}

/// A calibrated hand.
#[derive(Debug, Clone, PartialEq)]
pub struct BundleResult {
    /// The hand.
    pub hand: HandShape,
    /// How well each of its proportions is known, standard deviations of logarithms, in the order
    /// of [`ShapePrior::deviations`].
    pub hand_std: Vec<f64>,
    /// The cameras of the silhouettes, then those that have landmarks alone; those whose extrinsics were fitted and that do not move, where they were found to stand, the others as given.
    pub cameras: Vec<Camera>,
    /// The pose in each frame.
    pub poses: Vec<Pose>,
    /// Intersection over union of the drawn and the observed silhouettes, frame by frame and view
    /// by view.
    pub ious: Vec<Vec<f64>>,
    /// Root of the mean (robust) squared distance of the boundaries, px.
    pub boundary_rms_px: f64,
    /// Whether the last steps won nothing worth having.
    pub converged: bool,
}

impl BundleAdjustment {
    /// Fits `given`, whose frame at rest is mapped to the world by `rest`, to the frames.
    ///
    /// # Errors
    /// No frame or no observation, frames that differ in their views, a parameter out of its range, a
    /// hand that no one has or that a camera cannot draw.
    pub fn run(
        &self,
        given: &HandShape,
        rest: &DAffine3,
        frames: &[BundleFrame],
    ) -> Result<BundleResult> {
        self.pose_fit.check()?;
        let first = frames.first().ok_or(Error::NoObservation)?;
        for (frame, own) in frames.iter().enumerate() {
            let (found, expected) = (own.evidence().views(), first.evidence().views());
            if found != expected && self.cameras.is_some() {
                return Err(Error::ViewCount { frame, found, expected });
            }
        }
        let refine = |frame: &BundleFrame| {
            let BundleFrame { start, prior, .. } = frame;
            self.pose_fit.fit(given, rest, frame.evidence(), start, prior).map(|fit| fit.pose)
        };
        let starts: Vec<Pose> = frames.par_iter().map(refine).collect::<Result<_>>()?;
        let problem = Problem {
            given,
            rest,
            frames: frames
                .iter()
                .map(|frame| Frame { evidence: frame.evidence(), prior: &frame.prior })
                .collect(),
            freedom: FreeParameters { hand: Some(self.hand), cameras: self.cameras },
        };
        let start = State {
            frames: (0..).zip(&starts).map(|(k, pose)| problem.frame_parameters(k, pose)).collect(),
            shared: problem.shared(),
        };
        let views = frames.iter().map(|frame| self.pose_fit.matchers(&frame.observations));
        let mut views: Vec<Vec<ViewMatcher>> = views.collect::<Result<_>>()?;
        let outcome = self.pose_fit.levels_from(1, &problem, start, ANY_ENERGY, &mut views)?;
        let ious = ious(&problem, &outcome.state, &mut views)?;
        let shared = &outcome.state.shared;
        let camera = |(k, given): (usize, &Camera)| {
            let correction = shared.corrections.get(k);
            let moved = correction.map(|own| own.camera(given, rest.translation));
            moved.unwrap_or_else(|| given.clone())
        };
        let (_, known) = problem.shared_prior(shared);
        let covariance = shared_covariance(&outcome.frames, &known).ok_or_else(|| {
            let reason = "leaves shape open that the silhouettes do not tell".to_owned();
            Error::Precision { reason }
        })?;
        let numbers = 0..shared.shape.logarithms.len();
        Ok(BundleResult {
            hand: shared.shape.hand(given),
            hand_std: numbers.map(|k| covariance[(k, k)].max(0.0).sqrt()).collect(),
            cameras: first.evidence().cameras().map(camera).collect(),
            poses: outcome.state.frames.iter().map(|parameters| parameters.pose).collect(),
            ious,
            boundary_rms_px: outcome.boundary_rms_px(self.pose_fit.noise),
            converged: outcome.converged,
        })
    }
}
