//! Estimates and what refinement makes of them, with the time that both take.

use anyhow::Result;
use phalanx::{
    Estimate, Estimator, Framing, Picture, Progress, SceneDescriber, SceneSource, Workspace,
};
use phalanx_hand::Pose;
use phalanx_refine::PoseFitSettings;
use phalanx_segmentation::Silhouette;
use rayon::prelude::*;

use crate::clock::thread_ms;
use crate::data::sets::Set;
use crate::eval::held_out::Ground;
use crate::eval::held_out::refined::{self, Starts};

/// How estimates are refined.
#[derive(Clone)]
pub(crate) struct Refining {
    pub(crate) refinement: PoseFitSettings,
    pub(crate) starts: Starts,
    pub(crate) believed: Believed,
    pub(crate) hand: Hand,
}

/// The pose that refinement is told was estimated.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Believed {
    Estimate,
    /// Shows where a perfect estimate would lead.
    Truth,
}

/// The hand that is refined with.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Hand {
    Mean,
    Calibrated,
}

/// One scene of a test, looked at.
pub(crate) struct Look {
    pub(crate) truth: Pose,
    pub(crate) estimate: Pose,
    pub(crate) refined: Pose,
    /// Milliseconds of one thread from the silhouettes, or from masks where they are looked at
    /// through windows, to the estimate, and from it to the refined pose.
    pub(crate) estimate_ms: f64,
    pub(crate) refine_ms: f64,
}

impl Refining {
    /// With the mean hand, all that there is switched on.
    pub(crate) fn whole() -> Self {
        Self {
            refinement: PoseFitSettings::of_strangers(),
            starts: Starts::Hypotheses,
            believed: Believed::Estimate,
            hand: Hand::Mean,
        }
    }

    /// Every so-manieth scene of a test; nothing of those in which a camera shows no hand.
    pub(crate) fn looks(
        &self,
        estimator: &Estimator,
        set: &Set<'_>,
        every: usize,
        ground: &Ground,
        progress: &dyn Progress,
    ) -> Result<Vec<Option<Look>>> {
        let refiner = refined::refiner(estimator, ground, self.refinement.clone())?;
        let own = match self.hand {
            Hand::Mean => vec![refiner],
            Hand::Calibrated => {
                let views: Vec<usize> = (0..ground.rig.cameras.len()).collect();
                refined::own_hands(estimator, &refiner, &views, set, ground, progress)?
            }
        };
        let describer = SceneDescriber::new(&ground.rig, estimator.descriptor().view_config())?;
        let numbers: Vec<usize> = (0..set.count()).step_by(every).collect();
        progress.begin(&format!("refine {}", set.name), numbers.len());
        let memory = || (describer.clone(), Workspace::default());
        let look = |(describer, workspace): &mut (SceneDescriber, Workspace), &number: &usize| {
            let scene = set.scene(number);
            let refiner = &own[number % set.hands() % own.len()];
            let (estimate_ms, estimate) = match estimator.framing() {
                Framing::Picture => {
                    let Ok(seen) = describer.silhouettes(&scene) else { return Ok(None) };
                    let seen: Vec<Silhouette> = seen.cloned().collect();
                    let (ms, estimate) =
                        thread_ms(|| estimator.estimate_silhouettes(&seen, workspace));
                    (ms, estimate?)
                }
                Framing::Window => {
                    let masks = describer.masks(&scene)?;
                    let pictures: Vec<Picture<'_>> = masks.iter().map(Picture::Mask).collect();
                    let (ms, estimate) = thread_ms(|| estimator.estimate(&pictures, workspace));
                    let Ok(estimate) = estimate else { return Ok(None) };
                    (ms, estimate)
                }
            };
            let believed = match self.believed {
                Believed::Estimate => estimate.clone(),
                Believed::Truth => Estimate { pose: scene.pose, ..estimate.clone() },
            };
            let (refine_ms, refined) =
                thread_ms(|| refined::refine(estimator, refiner, believed, self.starts));
            progress.step();
            Ok(Some(Look {
                truth: scene.pose,
                estimate: estimate.pose,
                refined: refined?,
                estimate_ms,
                refine_ms,
            }))
        };
        numbers.par_iter().map_init(memory, look).collect()
    }
}
