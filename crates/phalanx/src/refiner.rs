//! Estimates made better by drawing the hand and comparing.

use glam::DAffine3;
use phalanx_camera::{Camera, Rig};
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_refine::{
    BundleAdjustment, BundleFrame, BundleResult, PoseFit, PoseFitSettings, PosePrior,
    SilhouetteObservation,
};
use phalanx_segmentation::Silhouette;

use crate::error::{Error, Result};
use crate::estimator::answering::Workspace;
use crate::estimator::estimate::Estimate;
use crate::estimator::hypotheses::Hypothesis;
use crate::estimator::model::Estimator;
use crate::estimator::observation::Observation;
use crate::estimator::placement::PLACED;
use crate::estimator::refined_errors::RefinedDeviations;
use crate::features::describer::working_camera;
use crate::fit_chances;
use crate::images::picture::Picture;
use crate::synthesis::postures;
use crate::window::Framing;

/// Where borders stay further apart than this, px, other starts are worth their time. Two views leave
/// more open, so that what fits well may still be wrong; a hand that had to be doubted never fits as
/// well. Where the hand may be anywhere, its fingers are estimated less well, and a wrong posture is what
/// most doubts come from.
fn apart(refined: &PoseFit, estimate: &Estimate) -> f64 {
    let is_anywhere = estimate.observation.framing() == Framing::Window;
    match (refined.nuisance.is_some(), refined.ious.len()) {
        (true, _) if is_anywhere => 0.0, // always
        (true, _) => 0.35,
        (false, 2) => 0.28,
        (false, _) if is_anywhere => 0.3,
        (false, _) => 0.33,
    }
}

/// An estimate and what refinement made of it.
#[derive(Debug, Clone)]
pub struct RefinedEstimate {
    /// The estimate before refinement.
    pub estimate: Estimate,
    /// The refined one.
    pub refined: Estimate,
    /// How well it fits what was seen.
    pub fit: PoseFit,
    /// Other poses that explain what was seen, the more believable first.
    pub others: Vec<PoseFit>,
}

/// The fits of an estimate.
pub(crate) struct RefinedFits {
    pub(crate) best: PoseFit,
    /// Other poses that explain what was seen, the more believable first.
    others: Vec<PoseFit>,
    /// How well the best is known.
    pub(crate) deviations: RefinedDeviations,
}

/// Fits the hand to the silhouettes that it was estimated from.
#[derive(Debug, Clone)]
pub struct Refiner {
    cameras: Vec<Camera>,
    rest: DAffine3,
    hand: HandShape,
    postures: PosePrior,
    refinement: PoseFitSettings,
}

impl Refiner {
    /// For silhouettes at the working size from a rig's cameras. `poses` tell which numbers vary and
    /// how they go together, as those that an estimator was learnt from do.
    ///
    /// # Errors
    /// A camera without a window of the working size's shape, a hand that no one has, fewer than two
    /// different poses.
    pub fn new(
        rig: &Rig,
        hand: &HandShape,
        poses: &[Pose],
        refinement: PoseFitSettings,
    ) -> Result<Self> {
        Self::of(rig, hand, PosePrior::of_poses(poses)?, refinement)
    }

    fn of(
        rig: &Rig,
        hand: &HandShape,
        postures: PosePrior,
        refinement: PoseFitSettings,
    ) -> Result<Self> {
        hand.validate()?;
        Ok(Self {
            cameras: rig.cameras.iter().map(working_camera).collect::<Result<_>>()?,
            rest: rig.volume.rest_frame(),
            hand: hand.clone(),
            postures,
            refinement,
        })
    }

    /// For an estimator's rig and hand; angles go together as in the coupled prior
    /// ([`phalanx_hand::sample_pose`]).
    ///
    /// # Errors
    /// As of [`new`](Self::new).
    pub fn for_estimator(estimator: &Estimator, refinement: PoseFitSettings) -> Result<Self> {
        Self::of(estimator.rig(), estimator.hand(), postures::coupled().clone(), refinement)
    }

    /// The same for another hand, such as a calibrated one.
    ///
    /// # Errors
    /// A hand that no one has.
    pub fn with_hand(&self, hand: &HandShape) -> Result<Self> {
        hand.validate()?;
        Ok(Self { hand: hand.clone(), ..self.clone() })
    }

    /// The same, refining otherwise.
    #[must_use]
    pub fn with_refinement(&self, refinement: PoseFitSettings) -> Self {
        Self { refinement, ..self.clone() }
    }

    /// How many cameras look on.
    pub fn views(&self) -> usize {
        self.cameras.len()
    }

    /// How it refines.
    pub fn refinement(&self) -> &PoseFitSettings {
        &self.refinement
    }

    /// The hand that is fitted.
    pub fn hand(&self) -> &HandShape {
        &self.hand
    }

    /// The hand's frame at rest, to the world.
    pub fn rest(&self) -> &DAffine3 {
        &self.rest
    }

    /// What silhouettes at the working size, one per camera, tell.
    ///
    /// # Errors
    /// A silhouette of another size, or without a border.
    pub fn evidence(&self, silhouettes: &[Silhouette]) -> Result<Vec<SilhouetteObservation>> {
        self.check_count(silhouettes.len())?;
        let pairs = self.cameras.iter().zip(silhouettes);
        let evidence = pairs.map(|(camera, seen)| SilhouetteObservation::new(camera, &seen.mask));
        Ok(evidence.collect::<Result<_, _>>()?)
    }

    /// What the views of an observation tell of the pose.
    ///
    /// # Errors
    /// An observation without views or of more cameras, and as of [`evidence`](Self::evidence).
    pub fn evidence_of(&self, observation: &Observation) -> Result<Vec<SilhouetteObservation>> {
        let last = observation.views.iter().map(|view| view.camera).max();
        if last.is_none_or(|last| last >= self.cameras.len()) {
            return Err(self.wrong_count(observation.views.len()));
        }
        let views = observation.views.iter();
        views.map(|view| view.evidence(&self.cameras[view.camera])).collect()
    }

    fn check_count(&self, found: usize) -> Result<()> {
        if found == self.cameras.len() {
            return Ok(());
        }
        Err(self.wrong_count(found))
    }

    fn wrong_count(&self, found: usize) -> Error {
        let cameras = self.cameras.iter().map(|camera| camera.name.clone()).collect();
        Error::PictureCount { cameras, found }
    }

    /// What is known of a pose once it was estimated: that, and how numbers go together. Numbers that
    /// did not vary where the estimator learnt stay as estimated.
    ///
    /// # Errors
    /// An estimate that is not finite.
    pub fn prior(&self, pose: &Pose, std: &[Option<f64>; Dof::COUNT]) -> Result<PosePrior> {
        // A prior holds a number of no deviation where it is.
        let std = std.map(Option::unwrap_or_default);
        Ok(PosePrior::independent(*pose, &std)?.product(&self.postures)?)
    }

    /// One frame to calibrate a hand from.
    ///
    /// # Errors
    /// As of [`prior`](Self::prior).
    pub fn frame(&self, estimate: &Estimate) -> Result<BundleFrame> {
        let evidence = self.evidence_of(&estimate.observation)?;
        let prior = self.prior(&estimate.pose, &estimate.std)?;
        Ok(BundleFrame {
            observations: evidence,
            landmarks: Vec::new(),
            start: *prior.mean(),
            prior,
        })
    }

    /// Fits the hand's proportions to several frames of it.
    ///
    /// # Errors
    /// No frame, or frames that differ in their views.
    pub fn calibrate(
        &self,
        calibration: &BundleAdjustment,
        frames: &[BundleFrame],
    ) -> Result<BundleResult> {
        Ok(calibration.run(&self.hand, &self.rest, frames)?)
    }

    /// How well the pose of an estimate's fit is known, beside other fits.
    fn deviations(
        &self,
        evidence: &[SilhouetteObservation],
        estimate: &Estimate,
        (fit, others): (&PoseFit, &[PoseFit]),
    ) -> Result<RefinedDeviations> {
        let prior = self.prior(&estimate.pose, &estimate.std)?;
        let of_digits =
            self.refinement.posture_variance(&self.hand, &self.rest, evidence, fit, &prior)?;
        let of_others = fit_chances::variance_by_others(fit, others);
        let mut curvature = [None; Dof::COUNT];
        let diagonal = fit.covariance.iter().step_by(prior.dofs().len() + 1);
        for (dof, variance) in prior.dofs().iter().zip(diagonal) {
            curvature[dof.index()] = Some(variance.max(0.0).sqrt());
        }
        let postures = std::array::from_fn(|dof| (of_digits[dof] + of_others[dof]).sqrt());
        Ok(RefinedDeviations { curvature, postures })
    }

    /// Estimates the pose from the cameras' pictures and refines it, with every hypothesis that the
    /// estimator has about it.
    ///
    /// # Errors
    /// As of [`Estimator::estimate`] and [`refine`](Self::refine).
    pub fn estimate_and_refine<'p, P>(
        &self,
        estimator: &Estimator,
        pictures: &[P],
        workspace: &mut Workspace,
    ) -> Result<RefinedEstimate>
    where
        P: Into<Option<Picture<'p>>> + Copy,
    {
        self.refine_estimate(estimator, estimator.estimate(pictures, workspace)?)
    }

    /// Refines an estimate with every hypothesis that the estimator has about it. Deviations are those that
    /// such estimates are [known](crate::RefinedErrors) to have, where that was learnt: for the hand that the
    /// estimator has, and settings as [`PoseFitSettings::of_strangers`].
    ///
    /// # Errors
    /// As of [`refine`](Self::refine).
    pub fn refine_estimate(
        &self,
        estimator: &Estimator,
        estimate: Estimate,
    ) -> Result<RefinedEstimate> {
        let RefinedFits { best: fit, others, deviations } = self.fits(estimator, &estimate)?;
        let joints = self.hand.pose(&fit.pose, &self.rest).joints;
        let refined = Estimate { pose: fit.pose, joints, ..estimate.clone() };
        let refined = match estimator.refined_errors() {
            Some(errors) => errors.scaled(refined, &deviations, fit.nuisance.is_some()),
            None => Estimate { std: deviations.with_postures(1.0), ..refined },
        };
        let refined = estimator.checked(&self.hand, refined)?;
        Ok(RefinedEstimate { estimate, refined, fit, others })
    }

    /// The fits of an estimate with every hypothesis that the estimator has about it.
    pub(crate) fn fits(&self, estimator: &Estimator, estimate: &Estimate) -> Result<RefinedFits> {
        let evidence = self.evidence_of(&estimate.observation)?;
        let hypotheses = match estimator.error_model() {
            Some(_) => estimator.hypotheses(estimate, Self::starts(evidence.len()))?,
            None => Vec::new(),
        };
        let mut fits = self.refine_best(&evidence, estimate, &hypotheses)?.into_iter();
        let best =
            fits.next().ok_or(Error::Mismatch { part: "refined poses", found: 0, expected: 1 })?;
        let others: Vec<PoseFit> = fits.collect();
        let deviations = self.deviations(&evidence, estimate, (&best, &others))?;
        Ok(RefinedFits { best, others, deviations })
    }

    /// Refines an estimate and, where that leaves borders apart, a hand that may be anywhere had to be
    /// doubted, or there is one view alone, which several poses can explain, every hypothesis about it
    /// too; the pose to be believed first.
    ///
    /// # Errors
    /// As of [`refine`](Self::refine).
    pub fn refine_best(
        &self,
        evidence: &[SilhouetteObservation],
        estimate: &Estimate,
        hypotheses: &[Hypothesis],
    ) -> Result<Vec<PoseFit>> {
        if evidence.len() > 1 || hypotheses.is_empty() {
            let refined = self.refine(evidence, estimate)?;
            if hypotheses.is_empty() || refined.boundary_rms_px <= apart(&refined, estimate) {
                return Ok(vec![refined]);
            }
            // Palm and arm tell where the hand is, whatever the fingers do.
            let mut placed = hypotheses.to_vec();
            for hypothesis in &mut placed {
                for dof in PLACED {
                    hypothesis.pose[dof] = refined.pose[dof];
                }
            }
            return self.refine_hypotheses(evidence, estimate, &placed);
        }
        self.refine_hypotheses(evidence, estimate, hypotheses)
    }

    /// Refines an estimate.
    ///
    /// # Errors
    /// No evidence, or a hand that a camera cannot draw.
    pub fn refine(
        &self,
        evidence: &[SilhouetteObservation],
        estimate: &Estimate,
    ) -> Result<PoseFit> {
        let prior = self.prior(&estimate.pose, &estimate.std)?;
        let start = prior.mean();
        Ok(self.refinement.fit(&self.hand, &self.rest, evidence, start, &prior)?)
    }
}
