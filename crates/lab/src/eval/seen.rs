//! Tests as all cameras see them.

use anyhow::Result;
use phalanx::{Mask, OrientationRule, Progress, SceneDescriber, SceneSource};
use phalanx_camera::Rig;
use phalanx_hand::{HandShape, Pose};
use rayon::prelude::*;

use crate::data::sets::Test;

/// The poses of a test and their masks, one a camera.
pub(crate) struct Seen {
    pub(crate) test: &'static str,
    pub(crate) scenes: Vec<(Pose, Vec<Mask>)>,
}

impl Seen {
    /// Every so-manieth scene of a test, if every camera shows it.
    pub(crate) fn of(
        test: Test,
        (rig, hand): (&Rig, &HandShape),
        every: usize,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let set = test.set(rig, hand, &[]);
        let describer = SceneDescriber::new(rig, OrientationRule::default())?;
        let numbers: Vec<usize> = (0..set.count()).step_by(every).collect();
        progress.begin(set.name, numbers.len());
        let see = |describer: &mut SceneDescriber, number: usize| {
            let scene = set.scene(number);
            progress.step();
            drop(describer.silhouettes(&scene).ok()?);
            let masks = describer.masks(&scene).ok()?.to_vec();
            Some((scene.pose, masks))
        };
        let scenes = numbers.into_par_iter().map_init(|| describer.clone(), see);
        Ok(Self { test: set.name, scenes: scenes.flatten().collect() })
    }
}
