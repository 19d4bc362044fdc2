//! Random scenes of hands before a rig's cameras.

use std::f64::consts::FRAC_PI_2;

use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, Pose, sample_pose};
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::synthesis::augmentation::Augmentation;
use crate::synthesis::rng::ItemRng;
use crate::synthesis::scene::{Scene, SceneSource};
use crate::window::Framing;

/// How far the arm of a hand anywhere leans in θ_X and in θ_Y, degrees: a person who sits or stands
/// before the cameras and reaches for the middle of the volume.
pub(crate) const LEAN_DEG: f64 = 30.0;

/// How far wrists bend that are not kept straight, degrees: about half of what they can.
const WRIST_DEG: [(Dof, [f64; 2]); 2] =
    [(Dof::WristFlexion, [-30.0, 50.0]), (Dof::WristDeviation, [-25.0, 15.0])];

/// Where the poses of random scenes come from. θ_Z, the turn about the forearm, is uniform in
/// 0° … 90°; the fingers of all but recorded poses follow [`sample_pose`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum PoseSource {
    /// The wrist is in the middle of the working volume and the arm as it is at rest.
    Centred,
    /// The wrist is anywhere in the working volume, the arm leans by up to 30° in θ_X and θ_Y.
    Anywhere,
    /// As `Anywhere`, and the wrist bends.
    AnywhereBent,
    /// Recorded poses in turn, as often as it takes. θ_Z is drawn where it is the same in all.
    Recorded(Vec<Pose>),
}

impl PoseSource {
    /// The source for estimators that look at pictures so.
    pub fn for_framing(framing: Framing) -> Self {
        match framing {
            Framing::Picture => Self::Centred,
            Framing::Window => Self::Anywhere,
        }
    }
}

/// Draws random scenes: a pose, a hand, cameras and silhouettes for each. The scene of a number is
/// always the same, so that a larger run begins with a smaller one.
///
/// ```
/// use phalanx::{PoseSource, SceneSampler, SceneSource};
/// use phalanx_camera::Rig;
/// use phalanx_hand::HandShape;
///
/// let rig = Rig::from_toml(include_str!("../../fixtures/desk.toml"))?;
/// let hand = HandShape::adult();
/// let sampler = SceneSampler::new(PoseSource::Centred);
/// let scenes = sampler.scenes(&rig, &hand, 100);
/// assert_eq!(scenes.count(), 100);
/// assert_eq!(scenes.scene(7), sampler.scenes(&rig, &hand, 1000).scene(7));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneSampler {
    /// Where poses come from.
    pub poses: PoseSource,
    /// How hands, cameras and silhouettes differ from what the rig is made for.
    pub augmentation: Augmentation,
    /// The seed of the poses.
    pub pose_seed: u64,
    /// The seed of the augmentation.
    pub augmentation_seed: u64,
}

impl SceneSampler {
    /// Scenes with the augmentation that estimators are meant to stand, drawn from seed 0.
    pub fn new(poses: PoseSource) -> Self {
        Self { poses, augmentation: Augmentation::default(), pose_seed: 1, augmentation_seed: 2 }
    }

    /// The same scenes drawn from another seed. Seeds have no scene in common.
    #[must_use]
    pub fn with_seed(self, seed: u32) -> Self {
        // The low byte tells apart what is drawn: poses or augmentation, to learn from or to test with.
        let of = |purpose: u64| u64::from(seed) << 8 | purpose;
        Self {
            pose_seed: of(self.pose_seed & 0xff),
            augmentation_seed: of(self.augmentation_seed & 0xff),
            ..self
        }
    }

    /// Scenes of the same kind that this sampler does not draw, to find out how an estimator errs on
    /// what it was not trained on. Recorded poses are the same, before other cameras and of other
    /// hands.
    #[must_use]
    pub fn fresh(&self) -> Self {
        let other = |seed: u64| (seed & !0xff) | ((seed & 0xff) + 5);
        Self {
            pose_seed: other(self.pose_seed),
            augmentation_seed: other(self.augmentation_seed),
            ..self.clone()
        }
    }

    /// So many scenes of a hand before a rig's cameras.
    pub fn scenes<'a>(
        &'a self,
        rig: &'a Rig,
        hand: &'a HandShape,
        count: usize,
    ) -> SampledScenes<'a> {
        let turns = match &self.poses {
            PoseSource::Recorded(poses) => {
                poses.iter().any(|pose| pose[Dof::ThetaZ] != poses[0][Dof::ThetaZ])
            }
            PoseSource::Centred | PoseSource::Anywhere | PoseSource::AnywhereBent => false,
        };
        SampledScenes { sampler: self, rig, hand, count, turns }
    }

    /// Refuses recorded poses of which there are none.
    pub(crate) fn check(&self) -> Result<()> {
        match &self.poses {
            PoseSource::Recorded(poses) if poses.is_empty() => Err(Error::TooFewPoses { found: 0 }),
            _ => Ok(()),
        }
    }
}

/// The scenes that a [`SceneSampler`] draws for a rig and a hand.
#[derive(Debug, Clone)]
pub struct SampledScenes<'a> {
    sampler: &'a SceneSampler,
    rig: &'a Rig,
    hand: &'a HandShape,
    count: usize,
    /// Whether recorded poses turn about the forearm by themselves.
    turns: bool,
}

impl SampledScenes<'_> {
    /// The pose of a scene.
    pub fn pose(&self, number: usize) -> Pose {
        let mut random = ItemRng::new(self.sampler.pose_seed, number as u64);
        let mut pose = match &self.sampler.poses {
            PoseSource::Centred => sample_pose(|| random.uniform()),
            PoseSource::Anywhere => self.placed(&mut random),
            PoseSource::AnywhereBent => {
                let mut pose = self.placed(&mut random);
                for (dof, [low, high]) in WRIST_DEG {
                    pose[dof] = random.between(low, high).to_radians();
                }
                pose
            }
            PoseSource::Recorded(poses) => {
                poses.get(number % poses.len().max(1)).copied().unwrap_or(Pose::REST)
            }
        };
        if !self.turns {
            pose[Dof::ThetaZ] = random.between(0.0, FRAC_PI_2);
        }
        pose
    }

    /// The poses of all scenes in order.
    pub fn poses(&self) -> impl Iterator<Item = Pose> {
        (0..self.count).map(|number| self.pose(number))
    }

    /// A coupled pose with its wrist anywhere in the working volume, its arm leaning.
    fn placed(&self, random: &mut ItemRng) -> Pose {
        let mut pose = sample_pose(|| random.uniform());
        let size_mm = self.rig.volume.size;
        for (dof, size) in [Dof::TX, Dof::TY, Dof::TZ].into_iter().zip(size_mm.to_array()) {
            pose[dof] = random.between(-0.5 * size, 0.5 * size);
        }
        for dof in [Dof::ThetaX, Dof::ThetaY] {
            pose[dof] = random.between(-LEAN_DEG, LEAN_DEG).to_radians();
        }
        pose
    }
}

impl SceneSource for SampledScenes<'_> {
    fn count(&self) -> usize {
        self.count
    }

    fn scene(&self, number: usize) -> Scene {
        let SceneSampler { augmentation, augmentation_seed, .. } = self.sampler;
        augmentation.scene(self.rig, self.hand, self.pose(number), *augmentation_seed, number)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn rig() -> Rig {
        Rig::from_toml(include_str!("../../fixtures/desk.toml")).unwrap()
    }

    proptest! {
        #![proptest_config(crate::property::cases(64))]

        #[test]
        fn no_seed_draws_the_scenes_of_another_nor_fresh_ones(
            one in any::<u32>(),
            other in any::<u32>(),
            number in 0_usize..1000,
        ) {
            let (rig, hand) = (rig(), HandShape::adult());
            let sampler = |seed| SceneSampler::new(PoseSource::Anywhere).with_seed(seed);
            let scene = |sampler: &SceneSampler| sampler.scenes(&rig, &hand, 1000).scene(number);
            prop_assert_eq!(scene(&sampler(one)) == scene(&sampler(other)), one == other);
            prop_assert!(scene(&sampler(one)) != scene(&sampler(other).fresh()));
        }
    }

    #[test]
    fn recorded_poses_come_in_turn_and_turn_if_they_did_not() {
        let (rig, hand) = (rig(), HandShape::adult());
        let pose = |turn: f64, curl: f64| {
            let mut pose = Pose::REST;
            (pose[Dof::ThetaZ], pose[Dof::IndexPip]) = (turn, curl);
            pose
        };
        let drawn = |poses: &[Pose]| -> Vec<Pose> {
            let sampler = SceneSampler::new(PoseSource::Recorded(poses.to_vec()));
            sampler.scenes(&rig, &hand, 5).poses().collect()
        };
        let turned = [pose(0.1, 0.0), pose(0.2, 0.5)];
        assert_eq!(drawn(&turned), [turned[0], turned[1], turned[0], turned[1], turned[0]]);
        let still = drawn(&[pose(0.1, 0.0), pose(0.1, 0.5)]);
        for (number, pose) in still.iter().enumerate() {
            assert_eq!(pose[Dof::IndexPip], [0.0, 0.5][number % 2]);
            assert!((0.0..FRAC_PI_2).contains(&pose[Dof::ThetaZ]) && pose[Dof::ThetaZ] != 0.1);
        }
    }
}
