//! A hand before the cameras, as it is drawn and described.

use glam::DAffine3;
use phalanx_camera::Rig;
use phalanx_hand::{HandShape, Pose};
use phalanx_rvm::random_subset;

/// One sample of training or testing: whose hand, in which pose, as which cameras see it.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// What an estimate should say.
    pub pose: Pose,
    /// Whose hand it is.
    pub hand: HandShape,
    /// How each camera sees it, in the order of the rig.
    pub views: Vec<SceneView>,
}

/// How one camera sees a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneView {
    /// The hand frame at rest, to the world. A camera that stands elsewhere than its calibration
    /// says sees just what it would see where it should stand, of a hand that is moved the other
    /// way.
    pub rest: DAffine3,
    /// The seed of the silhouette's ragged border; `None` for a clean one.
    pub ragged: Option<u64>,
}

impl Scene {
    /// What the rig is made for: the given hand, calibrated cameras, clean silhouettes.
    pub fn nominal(rig: &Rig, hand: &HandShape, pose: Pose) -> Self {
        let view = SceneView { rest: rig.volume.rest_frame(), ragged: None };
        Self { pose, hand: hand.clone(), views: vec![view; rig.cameras.len()] }
    }
}

/// Scenes that are made when they are drawn, so that there may be any number of them.
pub trait SceneSource: Sync {
    /// How many there are.
    fn count(&self) -> usize;

    /// One of them, by its number; always the same.
    fn scene(&self, number: usize) -> Scene;
}

/// Poses of one hand as the rig is made for.
#[derive(Debug, Clone, Copy)]
pub struct FixedPoses<'a> {
    /// The cameras.
    pub rig: &'a Rig,
    /// The hand.
    pub hand: &'a HandShape,
    /// Its poses.
    pub poses: &'a [Pose],
}

impl SceneSource for FixedPoses<'_> {
    fn count(&self) -> usize {
        self.poses.len()
    }

    fn scene(&self, number: usize) -> Scene {
        Scene::nominal(self.rig, self.hand, self.poses[number])
    }
}

/// The seed by which some scenes are chosen to stand for all. The few that codebooks are learnt from are
/// among the more of the pilot.
pub(crate) const SUBSET_SEED: u64 = 0;

/// Some scenes of others, chosen at random and in their order: every n-th of a periodic motion might see
/// a single phase of it.
pub struct SceneSubset<'a> {
    all: &'a dyn SceneSource,
    numbers: Vec<usize>,
}

impl<'a> SceneSubset<'a> {
    /// At most `most` of them; a smaller subset is part of a larger one.
    pub fn new(all: &'a dyn SceneSource, most: usize) -> Self {
        Self { all, numbers: random_subset(all.count(), most, SUBSET_SEED) }
    }

    /// The number among all scenes of one of these.
    pub fn number(&self, place: usize) -> usize {
        self.numbers[place]
    }
}

impl SceneSource for SceneSubset<'_> {
    fn count(&self) -> usize {
        self.numbers.len()
    }

    fn scene(&self, number: usize) -> Scene {
        self.all.scene(self.numbers[number])
    }
}
