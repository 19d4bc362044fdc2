//! Scenes to descriptors, without keeping the shape contexts in between.

use phalanx::{Error, Progress, Result, SceneDescriber, SceneSource, ViewConfig};
use phalanx_camera::Rig;
use phalanx_multiview::{Scratch, ViewEncoders};
use rayon::prelude::*;

/// Codebooks of some of a rig's cameras.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ViewCodebooks {
    /// The cameras' numbers in the rig, in the order of the codebooks.
    pub(crate) views: Vec<usize>,
    /// Their codebooks.
    pub(crate) codebooks: ViewEncoders,
}

impl ViewCodebooks {
    /// The descriptor x of one scene from the shape contexts of all the rig's cameras.
    ///
    /// # Errors
    /// What the codebooks say of the contexts, or another number of cameras.
    pub(crate) fn describe(
        &self,
        contexts: &[Vec<f32>],
        scratch: &mut Scratch,
    ) -> Result<Vec<f64>> {
        let view = |&v: &usize| contexts.get(v).map(Vec::as_slice);
        let seen: Option<Vec<&[f32]>> = self.views.iter().map(view).collect();
        let expected = self.views.iter().max().map_or(0, |last| last + 1);
        let found = contexts.len();
        let seen = seen.ok_or(Error::Mismatch { part: "views of the scene", found, expected })?;
        let mut x = vec![0.0; self.codebooks.dim()];
        self.codebooks.describe(&seen, scratch, &mut x)?;
        Ok(x)
    }
}

/// Draws scenes through every camera of a rig and describes each with several codebooks, in
/// parallel: for every scene of `numbers`, in order, one descriptor for each of `codebooks`. The
/// shape contexts, a hundred times larger, are forgotten at once.
///
/// # Errors
/// A camera that cannot draw at all; of each scene, that a camera cannot see or describe it.
pub(crate) fn describe_with(
    rig: &Rig,
    scenes: &dyn SceneSource,
    numbers: &[usize],
    view_config: impl Into<ViewConfig>,
    codebooks: &[ViewCodebooks],
    progress: &dyn Progress,
) -> Result<Vec<Result<Vec<Vec<f64>>>>> {
    let describer = SceneDescriber::new(rig, view_config)?;
    let describe = |(describer, scratch): &mut (SceneDescriber, Scratch), &number: &usize| {
        let described = describer.contexts(&scenes.scene(number)).and_then(|contexts| {
            codebooks.iter().map(|codebooks| codebooks.describe(&contexts, scratch)).collect()
        });
        progress.step();
        described.map_err(|reason| Error::TrainingPose { pose: number, reason: Box::new(reason) })
    };
    let memory = || (describer.clone(), Scratch::default());
    Ok(numbers.par_iter().map_init(memory, describe).collect())
}
