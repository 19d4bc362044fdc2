//! The product as its programs are used: a model trained for the take's cameras, then frame by frame
//! `phalanx estimate`, with and without `--refine`.

use anyhow::Result;
use image::{DynamicImage, RgbImage};
use phalanx::{
    Estimate, Estimator, Framing, Picture, Preset, Progress, RefinedEstimate, Refiner, Trainer,
    Workspace,
};
use phalanx_camera::{Rig, Volume};
use phalanx_hand::HandShape;
use phalanx_refine::{PoseFit, PoseFitSettings};
use phalanx_segmentation::{ForearmCue, Mask, SkinModel};

use super::deviation::PoseCovariance;
use super::method::{Found, Method, Outcome, Sequence, each_frame};
use super::take::{Input, Take};

/// Side of the cube in which the hand works by the default of `phalanx import-calibration`, mm.
const SIDE_MM: f64 = 300.0;

/// Overlap below which `phalanx estimate` doubts a refined hand.
const GOOD_OVERLAP: f64 = 0.8;

/// A model for some of a take's cameras.
pub struct Product {
    estimator: Estimator,
    refiner: Refiner,
    skin: SkinModel,
}

impl Product {
    /// Imports the take's calibration and trains for the cameras of these numbers, as
    /// `phalanx train --preset fast --framing window` does.
    ///
    /// # Errors
    /// Cameras for which no volume can be guessed, such as a single one, or nothing can be learnt.
    pub fn train(take: &Take, views: &[usize], progress: &dyn Progress) -> Result<Self> {
        let all: Vec<usize> = (0..take.cameras.len()).collect();
        let volume = Volume::between(&take.cameras(&all), SIDE_MM)?;
        let rig = Rig { cameras: take.cameras(views), volume };
        let hand = HandShape { side: take.side, ..HandShape::adult() };
        let trainer = Trainer::preset(Preset::Fast).framing(Framing::Window);
        let estimator = trainer.fit(&rig, &hand, progress)?;
        let refinement = PoseFitSettings::of_strangers();
        let refiner = Refiner::for_estimator(&estimator, refinement)?;
        Ok(Self { estimator, refiner, skin: SkinModel::builtin() })
    }

    fn estimate(
        &self,
        input: Input,
        pictures: &[DynamicImage],
        workspace: &mut Workspace,
    ) -> Result<Estimate> {
        Ok(match input {
            Input::Masks | Input::MasksAndLandmarks => {
                let masks: Vec<Mask> = pictures.iter().map(phalanx::mask_from).collect();
                let masks: Vec<Picture<'_>> = masks.iter().map(Picture::Mask).collect();
                self.estimator.estimate(&masks, workspace)?
            }
            Input::Photographs | Input::Landmarks => {
                let images: Vec<RgbImage> = pictures.iter().map(phalanx::photograph_from).collect();
                let images: Vec<Picture<'_>> =
                    images.iter().map(|image| Picture::Photograph(image, &self.skin)).collect();
                self.estimator.estimate(&images, workspace)?
            }
        })
    }

    fn refine(&self, estimate: Estimate) -> Result<Found> {
        let fitted = self.refiner.refine_estimate(&self.estimator, estimate)?;
        let RefinedEstimate { estimate, fit, .. } = fitted;
        let prior = self.refiner.prior(&estimate.pose, &estimate.std)?;
        let covariance = PoseCovariance::new(prior.dofs(), &fit.covariance);
        let (hand, rest) = (self.refiner.hand(), self.refiner.rest());
        let found = Found::posed(hand, &fit.pose, rest, Some(&covariance));
        Ok(Found { doubts: [forearm_doubts(&estimate), fit_doubts(&fit)].concat(), ..found })
    }
}

/// What `phalanx estimate` says of forearms.
fn forearm_doubts(estimate: &Estimate) -> Vec<String> {
    let doubt = |forearm: &phalanx_segmentation::Forearm| match forearm.cue {
        ForearmCue::SmoothEnd => Some("a forearm's end was guessed".to_owned()),
        ForearmCue::Border if forearm.crossings > 1 => Some("more than one forearm".to_owned()),
        ForearmCue::Border => None,
    };
    let views = estimate.observation.views.iter();
    views.filter_map(|view| doubt(&view.silhouette.forearm)).collect()
}

/// What `phalanx estimate --refine` says of a fit.
fn fit_doubts(refined: &PoseFit) -> Vec<String> {
    let overlaps = refined.ious.iter().filter(|&&overlap| overlap < GOOD_OVERLAP);
    let doubts = overlaps.map(|overlap| format!("overlaps a silhouette by {overlap:.2} only"));
    let unsettled = (!refined.converged).then(|| "stopped before it settled".to_owned());
    doubts.chain(unsettled).collect()
}

/// `phalanx estimate`.
pub struct Estimated<'a>(pub &'a Product);

impl Method for Estimated<'_> {
    fn name(&self) -> &'static str {
        "estimate"
    }

    fn run(&self, sequence: &Sequence<'_>, progress: &dyn Progress) -> Result<Vec<Outcome>> {
        let Product { estimator, .. } = self.0;
        let rest = estimator.rig().volume.rest_frame();
        each_frame(sequence, progress, Workspace::default, |workspace, _, pictures| {
            let estimate = self.0.estimate(sequence.input, pictures, workspace)?;
            let covariance =
                PoseCovariance::independent(&estimate.std.map(Option::unwrap_or_default));
            let found = Found::posed(estimator.hand(), &estimate.pose, &rest, Some(&covariance));
            Ok(Found { doubts: forearm_doubts(&estimate), ..found })
        })
    }
}

/// `phalanx estimate --refine`.
pub struct RefinedFrames<'a>(pub &'a Product);

impl Method for RefinedFrames<'_> {
    fn name(&self) -> &'static str {
        "refined"
    }

    fn run(&self, sequence: &Sequence<'_>, progress: &dyn Progress) -> Result<Vec<Outcome>> {
        each_frame(sequence, progress, Workspace::default, |workspace, _, pictures| {
            let estimate = self.0.estimate(sequence.input, pictures, workspace)?;
            self.0.refine(estimate)
        })
    }
}
