//! From what is seen to a pose, and whether that explains it.

use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_refine::PosePrior;
use phalanx_segmentation::Silhouette;

use crate::checking::doubt::{Cause, ViewDoubt};
use crate::checking::quick_fit::QuickFit;
use crate::checking::usual::Explanation;
use crate::checking::{doubts, redraw};
use crate::error::{Error, Result};
use crate::estimator::estimate::{Estimate, NORMAL_TAIL, known};
use crate::estimator::expert::Expert;
use crate::estimator::model::Estimator;
use crate::estimator::observation::Observation;
use crate::estimator::placement::{PlacementErrors, place};
use crate::estimator::subset_regression;
use crate::features::descriptor;
use crate::synthesis::postures;
use crate::window::{Framing, WindowFinder};

/// Memory that one estimate after another uses again. It holds nothing to be read.
#[derive(Debug, Default)]
pub struct Workspace {
    pub(crate) windows: WindowFinder,
    pub(crate) description: descriptor::Memory,
    x: Vec<f64>,
    subsets: subset_regression::Memory,
    regression: phalanx_rvm::Scratch,
}

impl Estimator {
    /// Estimates the pose from one silhouette per camera, of any size, in the order of the rig's
    /// cameras. Where they are seen through windows is not known, nor then where the hand is: see
    /// [`estimate_observation`](Self::estimate_observation).
    ///
    /// # Errors
    /// Another number of silhouettes, or one that cannot be described.
    pub fn estimate_silhouettes(
        &self,
        silhouettes: &[Silhouette],
        workspace: &mut Workspace,
    ) -> Result<Estimate> {
        self.check_count(silhouettes.len())?;
        self.estimate_observation(Observation::of_silhouettes(silhouettes), workspace)
    }

    /// Estimates the pose from what was seen already, by some of the cameras. Where the views have windows,
    /// these tell position, θ_X and θ_Y, which what is seen through a window does not tell.
    ///
    /// # Errors
    /// No view, or of cameras that were not [learnt](Self::estimate) to answer from, a silhouette that
    /// cannot be described, or windows as of [`initial_global`](crate::initial_global).
    pub fn estimate_observation(
        &self,
        observation: Observation,
        workspace: &mut Workspace,
    ) -> Result<Estimate> {
        let expert = self.expert(&observation)?;
        self.describe(&observation, workspace)?;
        let estimate = self.answer(expert, observation, workspace)?;
        self.checked(self.hand(), estimate)
    }

    /// Describes what was seen, in the workspace.
    pub(crate) fn describe(
        &self,
        observation: &Observation,
        workspace: &mut Workspace,
    ) -> Result<()> {
        let Workspace { description, x, .. } = workspace;
        let views = observation.views.iter().map(|view| (view.camera, &view.silhouette));
        self.descriptor().describe(self.rig(), views, description, x)
    }

    /// An expert's answer to what was seen and is described in the workspace, unchecked.
    pub(crate) fn answer(
        &self,
        expert: Expert<'_>,
        observation: Observation,
        workspace: &mut Workspace,
    ) -> Result<Estimate> {
        let (pose, std) = regress(expert, workspace)?;
        let joints = self.hand().pose(&pose, &self.rig().volume.rest_frame()).joints;
        let (tails, overlaps, doubts) = ([NORMAL_TAIL; Dof::COUNT], Vec::new(), Vec::new());
        let estimate = Estimate { pose, std, tails, joints, observation, overlaps, doubts };
        match estimate.observation.framing() {
            Framing::Picture => Ok(estimate),
            Framing::Window => {
                let learnt = expert.errors.and_then(|errors| errors.placement);
                let errors =
                    learnt.unwrap_or_else(|| PlacementErrors::of_anywhere(&self.rig().volume));
                place(self.rig(), self.hand(), &errors, estimate)
            }
        }
    }

    /// An estimate of a hand with what it has in common with what was seen, and with the doubts that follow.
    pub(crate) fn checked(&self, hand: &HandShape, mut estimate: Estimate) -> Result<Estimate> {
        let mut short = Vec::new();
        if estimate.observation.framing() == self.framing() {
            estimate.overlaps = self.overlaps(hand, &estimate)?;
            let expert = self.expert(&estimate.observation)?;
            if expert.errors.is_some() {
                short = expert.short(&estimate.observation, &self.explanation(hand, &estimate)?);
            }
        }
        let mut doubts = doubts::of(self.rig(), &short, &estimate);
        let is_not_seen = |doubt: &&ViewDoubt| matches!(doubt.cause, Cause::NotSeen(_));
        doubts.extend(estimate.doubts.iter().filter(is_not_seen));
        doubts.sort_by_key(|doubt| doubt.view);
        estimate.doubts = doubts;
        Ok(estimate)
    }

    /// What an estimated hand and each view have in common.
    pub(crate) fn overlaps(&self, hand: &HandShape, estimate: &Estimate) -> Result<Vec<f64>> {
        let (cameras, rest) = (&self.rig().cameras, self.rig().volume.rest_frame());
        redraw::overlaps(cameras, hand, &rest, &estimate.pose, &estimate.observation)
    }

    /// How well an estimate of a hand explains what was seen.
    pub(crate) fn explanation(&self, hand: &HandShape, estimate: &Estimate) -> Result<Explanation> {
        let Estimate { pose, std, observation, overlaps, .. } = estimate;
        let rest = self.rig().volume.rest_frame();
        let std = std.map(Option::unwrap_or_default);
        let prior = PosePrior::independent(*pose, &std)?.product(postures::coupled())?;
        let fit = QuickFit::new(&self.rig().cameras, rest, observation);
        let fitted = fit.best(hand, &[*prior.mean()], &prior)?;
        let borders = fitted.map_or_else(|| vec![0.0; overlaps.len()], |fitted| fitted.borders);
        Ok(Explanation { overlaps: overlaps.clone(), borders })
    }
}

/// What an expert says of the descriptor in the workspace.
fn regress(
    expert: Expert<'_>,
    workspace: &mut Workspace,
) -> Result<(Pose, [Option<f64>; Dof::COUNT])> {
    let Workspace { x, subsets, regression, .. } = workspace;
    let (mut pose, mut std) = (Pose::REST, [0.0; Dof::COUNT]);
    expert.predict_into(x, (subsets, regression), &mut pose.0, &mut std)?;
    for dof in Dof::ALL {
        let (value, std) = (pose[dof], std[dof.index()]);
        if !value.is_finite() || std.is_nan() {
            let value = if value.is_finite() { std } else { value };
            return Err(Error::Overflow { dof: dof.name(), value });
        }
    }
    Ok((pose, std.map(known)))
}
