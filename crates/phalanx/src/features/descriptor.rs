//! From the silhouettes of all views to the vector that a regressor reads.

use phalanx_camera::Rig;
use phalanx_codebook::Encoder;
use phalanx_multiview::{Scratch, ViewEncoders};
use phalanx_segmentation::Silhouette;
use phalanx_shape_context::BINS;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::features::describer::{Describer, OrientationRule, ViewConfig};
use crate::features::occupancy::{OCCUPANCY, occupancy_into};
use crate::progress::Progress;
use crate::synthesis::scene::SceneSource;
use crate::synthesis::scene_describer::SceneDescriber;

/// What a regressor reads of the silhouettes: codes of their shape contexts, view by view, and then
/// what is put beside them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Descriptor {
    view_config: ViewConfig,
    codes: ViewEncoders,
    extra_features: ExtraFeatures,
}

/// What is put beside the codes of the shape contexts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum ExtraFeatures {
    /// Nothing, as in the paper.
    Nothing,
    /// How much of each cell of a 24 × 18 grid over the picture is hand, for each view. Shape
    /// contexts know where points lie among each other; this knows where they lie in the picture,
    /// which a calibrated camera gives a meaning.
    OccupancyGrid,
}

/// Memory that describing one sample after another uses again.
#[derive(Debug, Clone, Default)]
pub(crate) struct Memory {
    pub(crate) describer: Describer,
    contexts: Vec<Vec<f32>>,
    coding: Scratch,
}

impl Descriptor {
    /// Puts a descriptor together.
    pub fn new(
        view_config: impl Into<ViewConfig>,
        codes: ViewEncoders,
        extra_features: ExtraFeatures,
    ) -> Self {
        Self { view_config: view_config.into(), codes, extra_features }
    }

    /// Which way shape contexts are turned.
    pub fn orientation(&self) -> OrientationRule {
        self.view_config.orientation
    }

    /// How pictures are looked at.
    pub fn view_config(&self) -> ViewConfig {
        self.view_config
    }

    /// The encoders of the views' shape contexts.
    pub fn codes(&self) -> &ViewEncoders {
        &self.codes
    }

    /// What is put beside them.
    pub fn extra_features(&self) -> ExtraFeatures {
        self.extra_features
    }

    /// The number of views.
    pub fn views(&self) -> usize {
        self.codes.views().len()
    }

    /// The length of the vector.
    pub fn dim(&self) -> usize {
        self.blocks().iter().sum()
    }

    /// The lengths of its parts: each view's code, then what is beside, each view's again.
    pub(crate) fn blocks(&self) -> Vec<usize> {
        let extra_features = match self.extra_features {
            ExtraFeatures::Nothing => 0,
            ExtraFeatures::OccupancyGrid => self.views(),
        };
        let codes = self.codes.views().iter().map(Encoder::dim);
        codes.chain(std::iter::repeat_n(OCCUPANCY, extra_features)).collect()
    }

    /// Refuses encoders of something other than shape contexts.
    pub(crate) fn check(&self, rig: &Rig) -> Result<()> {
        let (found, expected) = (self.views(), rig.cameras.len());
        if found != expected {
            return Err(Error::Mismatch { part: "codebooks", found, expected });
        }
        for (camera, encoder) in rig.cameras.iter().zip(self.codes.views()) {
            let (found, expected) = (encoder.bins(), BINS);
            if found != expected {
                return Err(Error::CodebookBins { camera: camera.name.clone(), found, expected });
            }
        }
        Ok(())
    }

    /// Describes the silhouettes of cameras, by their numbers in the rig. The part of a camera that is
    /// missing is zero.
    pub(crate) fn describe<'a>(
        &self,
        rig: &Rig,
        silhouettes: impl Iterator<Item = (usize, &'a Silhouette)>,
        memory: &mut Memory,
        x: &mut Vec<f64>,
    ) -> Result<()> {
        let Memory { describer, contexts, coding } = memory;
        contexts.resize_with(self.views(), Vec::new);
        contexts.iter_mut().for_each(Vec::clear);
        x.clear();
        x.resize(self.dim(), 0.0);
        let (codes, extra_features) = x.split_at_mut(self.codes.dim());
        for (view, silhouette) in silhouettes {
            let described = describer.contexts(silhouette, self.view_config.orientation);
            let described = described.map_err(|reason| Error::ShapeContext {
                camera: rig.cameras[view].name.clone(),
                reason,
            })?;
            contexts[view].extend_from_slice(described.values());
            let mut cells = extra_features.chunks_exact_mut(OCCUPANCY);
            if let Some(cells) = cells.nth(view) {
                occupancy_into(&silhouette.mask, cells);
            }
        }
        let seen = contexts.iter().map(|view| (!view.is_empty()).then_some(view.as_slice()));
        self.codes.describe_some(&seen.collect::<Vec<_>>(), coding, codes)?;
        Ok(())
    }
}

/// Draws scenes through every camera of a rig and describes them, in parallel: for every scene of
/// `numbers`, in order, its descriptor. The shape contexts, a hundred times larger, are forgotten at
/// once.
///
/// # Errors
/// A camera that cannot draw at all; of each scene, that a camera cannot see or describe it.
pub fn describe_scenes(
    rig: &Rig,
    scenes: &dyn SceneSource,
    numbers: &[usize],
    descriptor: &Descriptor,
    progress: &dyn Progress,
) -> Result<Vec<Result<Vec<f64>>>> {
    let drawing = SceneDescriber::new(rig, descriptor.view_config)?;
    let describe = |(drawing, memory): &mut (SceneDescriber, Memory), &pose: &usize| {
        let mut x = Vec::new();
        let described = drawing.see(&scenes.scene(pose)).and_then(|_| {
            descriptor.describe(rig, drawing.seen().enumerate(), memory, &mut x)?;
            Ok(x)
        });
        progress.step();
        described.map_err(|reason| Error::TrainingPose { pose, reason: Box::new(reason) })
    };
    let memory = || (drawing.clone(), Memory::default());
    Ok(numbers.par_iter().map_init(memory, describe).collect())
}
