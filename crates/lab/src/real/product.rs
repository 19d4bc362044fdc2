//! A model trained for the take's cameras and hand where it works, then frame by frame `phalanx estimate`, with and without
//! `--refine`.

use std::sync::OnceLock;

use anyhow::{Result, anyhow};
use image::{DynamicImage, RgbImage};
use phalanx::{
    Estimate, Estimator, Framing, Picture, Preset, Progress, RefinedEstimate, Refiner, TakeFit,
    Trainer, Workspace, trusted_volume,
};
use phalanx_camera::Rig;
use phalanx_io::take::TakeHeader;
use phalanx_refine::PoseFitSettings;
use phalanx_segmentation::{Mask, SkinModel};

use super::method::{Found, Method, Outcome, Sequence, each_frame};
use super::take::Input;
use super::whole_take::Fits;

/// The models for some of a take's cameras, one for each input, each trained when it is first asked for.
#[derive(Default)]
pub struct Products([OnceLock<Result<Product>>; Input::ALL.len()]);

impl Products {
    /// That of a sequence, or why there is none.
    fn of(
        &self,
        sequence: &Sequence<'_>,
        fits: &Fits,
        progress: &dyn Progress,
    ) -> Result<&Result<Product>> {
        let cell = &self.0[sequence.input as usize];
        if let Some(product) = cell.get() {
            return Ok(product);
        }
        let product = match fits.take(sequence, progress)? {
            Ok(take) => Product::train(sequence, take, progress),
            Err(error) => Err(anyhow!("{error}")),
        };
        Ok(cell.get_or_init(|| product))
    }

    /// What is made of the estimate of each frame; all are refused if there is no model.
    fn answers(
        &self,
        sequence: &Sequence<'_>,
        fits: &Fits,
        progress: &dyn Progress,
        found: impl Fn(&Product, Estimate) -> Result<Found> + Sync,
    ) -> Result<Vec<Outcome>> {
        match self.of(sequence, fits, progress)? {
            Ok(product) => {
                each_frame(sequence, progress, Workspace::default, |workspace, _, pictures| {
                    found(product, product.estimate(sequence.input, pictures, workspace)?)
                })
            }
            Err(reason) => {
                let refused = |_| Outcome { found: Err(anyhow!("{reason:#}")), cpu_ms: None };
                Ok(sequence.frames.iter().map(refused).collect())
            }
        }
    }
}

/// A model for some of a take's cameras.
struct Product {
    estimator: Estimator,
    refiner: Refiner,
    skin: SkinModel,
}

impl Product {
    /// Trains for a sequence's cameras and the take's hand where it works, as `phalanx track --save-hand`, `phalanx rig volume`
    /// and `phalanx train --hand --preset fast --framing window` do.
    ///
    /// # Errors
    /// A take without any hand, or nothing that can be learnt.
    fn train(sequence: &Sequence<'_>, take: &TakeFit, progress: &dyn Progress) -> Result<Self> {
        let rig = Rig { cameras: sequence.cameras(), volume: trusted_volume(take)?.volume };
        let trainer = Trainer::preset(Preset::Fast).framing(Framing::Window);
        let estimator = trainer.fit(&rig, &take.hand, progress)?;
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
        let RefinedEstimate { refined, fit, .. } = fitted;
        let mut found = self.found(&refined);
        if !fit.converged {
            found.doubts.push("stopped before it settled".to_owned());
        }
        Ok(found)
    }

    fn found(&self, estimate: &Estimate) -> Found {
        let Estimate { pose, std, doubts, .. } = estimate;
        let Rig { cameras, volume } = self.estimator.rig();
        let header = TakeHeader {
            hand: self.estimator.hand().clone(),
            world_from_hand: volume.rest_frame(),
            views: cameras.iter().map(|camera| camera.name.clone()).collect(),
            rate_hz: None,
            model: None,
        };
        Found {
            deviations: header.estimate(*pose, *std).joint_std,
            doubts: doubts.iter().map(|doubt| format!("{doubt:?}")).collect(),
            ..Found::posed(&header.hand, pose, &header.world_from_hand)
        }
    }
}

/// `phalanx estimate`.
pub struct Estimated<'a> {
    /// The models.
    pub products: &'a Products,
    /// What says where the hand works.
    pub fits: &'a Fits,
}

impl Method for Estimated<'_> {
    fn name(&self) -> &'static str {
        "estimate"
    }

    fn run(&self, sequence: &Sequence<'_>, progress: &dyn Progress) -> Result<Vec<Outcome>> {
        let found = |product: &Product, estimate| Ok(product.found(&estimate));
        self.products.answers(sequence, self.fits, progress, found)
    }
}

/// `phalanx estimate --refine`.
pub struct RefinedFrames<'a> {
    /// The models.
    pub products: &'a Products,
    /// What says where the hand works.
    pub fits: &'a Fits,
}

impl Method for RefinedFrames<'_> {
    fn name(&self) -> &'static str {
        "refined"
    }

    fn run(&self, sequence: &Sequence<'_>, progress: &dyn Progress) -> Result<Vec<Outcome>> {
        self.products.answers(sequence, self.fits, progress, Product::refine)
    }
}
