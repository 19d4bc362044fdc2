//! Learning an estimator for a rig and a hand.

use phalanx_camera::Rig;
use phalanx_hand::{HandShape, Pose};
use phalanx_multiview::CodebookTrainer;
use phalanx_rvm::{Bandwidth, KernelRidge, Regularisation};

use crate::error::{Error, Result};
use crate::estimator::model::Estimator;
use crate::features::describer::{OrientationRule, ViewConfig};
use crate::features::descriptor::{Descriptor, ExtraFeatures};
use crate::progress::Progress;
use crate::synthesis::scene::FixedPoses;
use crate::synthesis::scene_describer::PoseContexts;
use crate::training::cameras::Cameras;
use crate::training::regressor::RegressorConfig;
use crate::training::shard::Shard;
use crate::window::Framing;

/// How an estimator is learnt. The default is the paper's descriptor, turned to the forearm's axis,
/// with dense kernel regression.
///
/// Its kernels are wider and its penalty stronger than leave-one-out would choose: the left-out
/// sample has neighbours in its own sequence, while a photographed hand has none, and narrow
/// kernels answer it with the mean.
#[derive(Debug, Clone)]
pub struct Training {
    /// Which way shape contexts are turned.
    pub orientation: OrientationRule,
    /// What of the pictures is looked at.
    pub framing: Framing,
    /// The codebooks.
    pub vocabulary: CodebookTrainer,
    /// What is described with them.
    pub encoding: Encoding,
    /// The regressor.
    pub regressor: RegressorConfig,
    /// Whether cameras may be missing.
    pub answers_from: Cameras,
}

/// What of the silhouettes is described.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// Soft counts of the shape contexts, the paper's.
    SoftHistogram,
    /// Residuals of the shape contexts to the nearest centres, and beside them the hand's coverage
    /// of a coarse grid.
    Vlad,
}

impl Default for Training {
    fn default() -> Self {
        Self {
            orientation: OrientationRule::default(),
            framing: Framing::default(),
            vocabulary: CodebookTrainer::default(),
            encoding: Encoding::SoftHistogram,
            regressor: RegressorConfig::KernelRidge(KernelRidge {
                bandwidth: Bandwidth::Relative(0.5),
                regularisation: Regularisation::Fixed(0.01),
            }),
            answers_from: Cameras::default(),
        }
    }
}

impl Training {
    /// Most scenes whose shape contexts codebooks are learnt from, chosen at random.
    pub const CODEBOOK_SCENES: usize = 1000;

    /// Draws `poses` of the hand through the rig, describes them and learns an estimator, as
    /// [`shard`](Self::shard) does, but that every pose must be seen. The same input gives the same
    /// estimator at any number of threads.
    ///
    /// # Errors
    /// A rig, hand or pose that cannot be drawn or described, more poses than the regressor takes, or
    /// what the stages report.
    pub fn run(
        &self,
        rig: &Rig,
        hand: &HandShape,
        poses: &[Pose],
        progress: &dyn Progress,
    ) -> Result<Estimator> {
        rig.validate()?;
        hand.validate()?;
        if poses.len() < 2 {
            return Err(Error::TooFewPoses { found: poses.len() });
        }
        let scenes = FixedPoses { rig, hand, poses };
        let part = self.shard(rig, hand, &scenes, Shard::WHOLE, progress)?;
        if let Some((pose, reason)) = part.losses().first() {
            return Err(Error::LostPose { pose, reason: reason.to_owned() });
        }
        part.finish(progress)
    }

    /// A length that descriptors of so many views have at least.
    pub(crate) fn least_dim(&self, views: usize) -> usize {
        views.saturating_mul(match self.encoding {
            Encoding::SoftHistogram => self.vocabulary.centres / views.max(1),
            Encoding::Vlad => self.vocabulary.centres * phalanx_shape_context::BINS,
        })
    }

    /// Bytes that are held at most, roughly: the shape contexts of the scenes that codebooks are learnt
    /// from, the pilot's codes, or what is kept of the samples, twice: beside it stands its copy, the file of the
    /// unfinished part or later the network's samples in one piece.
    pub(crate) fn bytes(&self, views: usize, codebook: usize, pilot: usize, own: usize) -> usize {
        /// Of one view of a scene: a contour of some 300 points.
        const CONTEXTS: usize = 300 * phalanx_shape_context::BINS * size_of::<f32>();
        /// Of what else there is: the program, codebooks, and what was freed and is not given back. Measured.
        const OTHERS: usize = 200 << 20;
        let contexts = codebook.saturating_mul(views).saturating_mul(CONTEXTS);
        let code = views.saturating_mul(self.vocabulary.centres * phalanx_shape_context::BINS);
        let piloted = pilot.saturating_mul(code).saturating_mul(size_of::<f64>());
        let kept = own.saturating_mul(self.regressor.bytes(views)).saturating_mul(2);
        contexts.max(piloted).max(kept).saturating_add(OTHERS)
    }

    /// How pictures are looked at.
    pub(crate) fn view_config(&self) -> ViewConfig {
        ViewConfig { orientation: self.orientation, framing: self.framing }
    }

    /// The descriptor, with codebooks learnt from shape contexts.
    pub(crate) fn descriptor(&self, contexts: &[PoseContexts]) -> Result<Descriptor> {
        let (bins, view_config) = (phalanx_shape_context::BINS, self.view_config());
        let (encoders, features) = match self.encoding {
            Encoding::SoftHistogram => {
                (self.vocabulary.fit(contexts, bins)?, ExtraFeatures::Nothing)
            }
            Encoding::Vlad => {
                (self.vocabulary.fit_residuals(contexts, bins)?, ExtraFeatures::OccupancyGrid)
            }
        };
        Ok(Descriptor::new(view_config, encoders, features))
    }
}
