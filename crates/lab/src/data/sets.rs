//! What is learnt from and what is tested on.

use clap::ValueEnum;
use phalanx::{
    Augmentation, Framing, ItemRng, MaskNoise, PoseSource, Scene, SceneSampler, SceneSource,
    ShapeVariation, Trainer,
};
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, Pose, sample_pose, sample_pose_independent};

use crate::data::data_set::THETA_Z_DEG;
use crate::data::trajectories::complex_take;

/// Silhouettes from each camera in a test set.
pub(crate) const TEST_SAMPLES: usize = 2000;
/// Takes of `complex` in the test sets of motion; none is the stored one.
const TAKES: u64 = 10;
/// Halfway between the θ_Z of the training sequences, degrees.
const BETWEEN_DEG: [f64; 6] = [7.5, 22.5, 37.5, 52.5, 67.5, 82.5];
/// How far the bones and radii of other people's hands differ from the mean hand's.
const SPREAD: f64 = 0.1;

/// Seeds of tests: poses, the angles that they are turned by, damage. A [`SceneSampler`] has 1 and 2 to
/// learn from, 6 and 7 where it is fresh.
const TEST_POSES: u64 = 3;
const TEST_ANGLES: u64 = 4;
const TEST_DAMAGE: u64 = 5;

/// Poses of a hand, seen through a rig that may be damaged.
pub(crate) struct Set<'a> {
    pub(crate) name: &'static str,
    pub(crate) rig: &'a Rig,
    pub(crate) hand: &'a HandShape,
    pub(crate) poses: Vec<Pose>,
    damage: Augmentation,
    seed: u64,
}

impl Set<'_> {
    /// How many hands are seen in turn: scene `number` shows hand `number` modulo this.
    pub(crate) fn hands(&self) -> usize {
        match self.damage.hands {
            ShapeVariation::Several { count, .. } => count,
            ShapeVariation::Given | ShapeVariation::Each { .. } => 1,
        }
    }

    /// Other motion of the same hands, damaged alike: takes of `complex` that no test holds.
    pub(crate) fn other_motion(&self) -> Self {
        let frames: Vec<Pose> = (TAKES + 1..=2 * TAKES).flat_map(complex_take).collect();
        let poses = turned_at_random(&frames, &BETWEEN_DEG);
        Self { poses, damage: self.damage.clone(), ..*self }
    }
}

impl SceneSource for Set<'_> {
    fn count(&self) -> usize {
        self.poses.len()
    }

    fn scene(&self, number: usize) -> Scene {
        self.damage.scene(self.rig, self.hand, self.poses[number], self.seed, number)
    }
}

/// The cameras' tilt, 1° to 3°, in training with damage and in the test with all of it.
fn turned(low_deg: f64, high_deg: f64) -> Augmentation {
    Augmentation { camera_turn: low_deg.to_radians()..=high_deg.to_radians(), ..Augmentation::NONE }
}

/// How many random samples may be asked for, on the command line: a hundred to ten million.
pub(crate) fn samples(text: &str) -> Result<usize, String> {
    let samples: usize = text.parse().map_err(|error| format!("{error}"))?;
    if (100..=10_000_000).contains(&samples) {
        return Ok(samples);
    }
    Err(format!("{samples} is not between 100 and 10,000,000"))
}

/// Poses as they are, to learn from.
pub(crate) fn clean<'a>(
    name: &'static str,
    rig: &'a Rig,
    hand: &'a HandShape,
    poses: Vec<Pose>,
) -> Set<'a> {
    let seed = SceneSampler::new(PoseSource::Centred).augmentation_seed;
    Set { name, rig, hand, poses, damage: Augmentation::NONE, seed }
}

/// Scenes from which it is learnt how a preset's estimates err.
pub(crate) const ERROR_SCENES: usize = Trainer::ERROR_SAMPLES;

/// The sampler of training scenes, whose damage is of choice.
fn sampler(poses: PoseSource, augment: Augment) -> SceneSampler {
    let sampler = SceneSampler::new(poses);
    match augment {
        Augment::No => SceneSampler { augmentation: Augmentation::NONE, ..sampler },
        Augment::Yes => sampler,
    }
}

/// So many scenes of a sampler, their poses drawn.
fn drawn<'a>(
    name: &'static str,
    sampler: &SceneSampler,
    rig: &'a Rig,
    hand: &'a HandShape,
    samples: usize,
) -> Set<'a> {
    let poses = sampler.scenes(rig, hand, samples).poses().collect();
    Set {
        name,
        rig,
        hand,
        poses,
        damage: sampler.augmentation.clone(),
        seed: sampler.augmentation_seed,
    }
}

/// What a preset learns from that looks at hands so.
pub(crate) fn for_preset<'a>(
    framing: Framing,
    rig: &'a Rig,
    hand: &'a HandShape,
    samples: usize,
) -> Set<'a> {
    let name = match framing {
        Framing::Picture => "random_augmented",
        Framing::Window => "placed",
    };
    let sampler = SceneSampler::new(PoseSource::for_framing(framing));
    drawn(name, &sampler, rig, hand, samples)
}

/// From what it learns how its estimates err.
pub(crate) fn fresh_for<'a>(framing: Framing, rig: &'a Rig, hand: &'a HandShape) -> Set<'a> {
    let sampler = SceneSampler::new(PoseSource::for_framing(framing)).fresh();
    drawn("fresh", &sampler, rig, hand, ERROR_SCENES)
}

/// Hands anywhere in the rig's volume with wrists that bend, as those of people who are not told to keep
/// them straight.
pub(crate) fn loosely_placed<'a>(rig: &'a Rig, hand: &'a HandShape, samples: usize) -> Set<'a> {
    drawn("loosely_placed", &SceneSampler::new(PoseSource::AnywhereBent), rig, hand, samples)
}

/// Independent poses from the coupled prior to learn from, θ_Z uniform in 0° … 90°. A larger set
/// begins with the smaller one. With `augment`, every sample has a hand of its own, cameras turned
/// by up to 3° and ragged silhouettes.
pub(crate) fn random<'a>(
    rig: &'a Rig,
    hand: &'a HandShape,
    samples: usize,
    augment: Augment,
) -> Set<'a> {
    let name = match augment {
        Augment::No => "random",
        Augment::Yes => "random_augmented",
    };
    drawn(name, &sampler(PoseSource::Centred, augment), rig, hand, samples)
}

/// Samples like those of [`random`], none of which it holds: to learn how an estimator errs on what
/// it was not trained on.
pub(crate) fn fresh<'a>(
    rig: &'a Rig,
    hand: &'a HandShape,
    samples: usize,
    augment: Augment,
) -> Set<'a> {
    drawn("fresh", &sampler(PoseSource::Centred, augment).fresh(), rig, hand, samples)
}

/// Whether training samples are damaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Augment {
    No,
    Yes,
}

/// What an estimator is tested on that it never saw.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub(crate) enum Test {
    /// Ten other takes of `complex`, at the trained θ_Z.
    Unseen,
    /// The same at θ_Z halfway between the trained ones.
    ThetaBetween,
    /// Independent poses from the coupled prior.
    Random,
    /// All joints drawn independently in their ranges.
    Uncoupled,
    /// `unseen` with eight other hands.
    Hands,
    /// `unseen` with every camera turned about the hand by 1°.
    #[value(name = "cameras_1")]
    Cameras1,
    /// `unseen` with every camera turned about the hand by 3°.
    #[value(name = "cameras_3")]
    Cameras3,
    /// `unseen` with ragged silhouettes.
    Ragged,
    /// `unseen` with every image rolled by up to 30°.
    Rolled,
    /// Eight other hands, cameras turned by 1–3°, ragged silhouettes, θ_Z between.
    All,
    /// Independent poses anywhere in the rig's volume, the arm leaning by up to 30° in θ_X and θ_Y.
    Placed,
    /// Motion from a file.
    Poses,
}

impl Test {
    /// All that whole pictures can be described of, but motion from outside.
    pub(crate) const SYNTHETIC: [Self; 10] = [
        Self::Unseen,
        Self::ThetaBetween,
        Self::Random,
        Self::Uncoupled,
        Self::Hands,
        Self::Cameras1,
        Self::Cameras3,
        Self::Ragged,
        Self::Rolled,
        Self::All,
    ];

    /// The name in tables and JSON.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Unseen => "unseen",
            Self::ThetaBetween => "theta_between",
            Self::Random => "random",
            Self::Uncoupled => "uncoupled",
            Self::Hands => "hands",
            Self::Cameras1 => "cameras_1",
            Self::Cameras3 => "cameras_3",
            Self::Ragged => "ragged",
            Self::Rolled => "rolled",
            Self::All => "all",
            Self::Placed => "placed",
            Self::Poses => "poses",
        }
    }

    /// The test set; `motion` is that of [`Test::Poses`].
    pub(crate) fn set<'a>(self, rig: &'a Rig, hand: &'a HandShape, motion: &[Pose]) -> Set<'a> {
        let poses = match self {
            Self::ThetaBetween | Self::All => takes(&BETWEEN_DEG),
            Self::Random => {
                independent(TEST_SAMPLES, TEST_POSES, |random| sample_pose(|| random.uniform()))
            }
            Self::Uncoupled => independent(TEST_SAMPLES, TEST_POSES, |random| {
                sample_pose_independent(|| random.uniform())
            }),
            Self::Placed => {
                let anywhere = SceneSampler::new(PoseSource::Anywhere);
                let sampler = SceneSampler { pose_seed: TEST_POSES, ..anywhere };
                sampler.scenes(rig, hand, TEST_SAMPLES).poses().collect()
            }
            Self::Poses => outside(motion),
            _ => takes(&THETA_Z_DEG),
        };
        Set { name: self.name(), rig, hand, poses, damage: self.damage(), seed: TEST_DAMAGE }
    }

    fn damage(self) -> Augmentation {
        let hands = ShapeVariation::Several { count: 8, spread: SPREAD };
        match self {
            Self::Hands => Augmentation { hands, ..Augmentation::NONE },
            Self::Cameras1 => turned(1.0, 1.0),
            Self::Cameras3 => turned(3.0, 3.0),
            Self::Ragged => Augmentation { mask_noise: MaskNoise::Boundary, ..Augmentation::NONE },
            Self::Rolled => Augmentation { camera_roll: 30_f64.to_radians(), ..Augmentation::NONE },
            Self::All => {
                Augmentation { hands, mask_noise: MaskNoise::Boundary, ..turned(1.0, 3.0) }
            }
            Self::Unseen
            | Self::ThetaBetween
            | Self::Random
            | Self::Uncoupled
            | Self::Placed
            | Self::Poses => Augmentation::NONE,
        }
    }
}

/// Frames of the unseen takes, evenly spaced, each at one of some angles.
fn takes(theta_z_deg: &[f64]) -> Vec<Pose> {
    let frames: Vec<Pose> = (1..=TAKES).flat_map(complex_take).collect();
    turned_at_random(&frames, theta_z_deg)
}

/// Frames of outside motion, evenly spaced. Where they do not turn about the forearm, each is at
/// one of the trained angles, and few frames are gone through several times.
fn outside(motion: &[Pose]) -> Vec<Pose> {
    let turns = motion.iter().any(|pose| pose[Dof::ThetaZ] != motion[0][Dof::ThetaZ]);
    if turns && motion.len() <= TEST_SAMPLES {
        return motion.to_vec();
    }
    if turns {
        return evenly_spaced(motion);
    }
    turned_at_random(motion, &THETA_Z_DEG)
}

fn turned_at_random(frames: &[Pose], theta_z_deg: &[f64]) -> Vec<Pose> {
    let turned = |(i, mut pose): (usize, Pose)| {
        let angle = ItemRng::new(TEST_ANGLES, i as u64).below(theta_z_deg.len());
        pose[Dof::ThetaZ] = theta_z_deg[angle].to_radians();
        pose
    };
    evenly_spaced(frames).into_iter().enumerate().map(turned).collect()
}

/// As many frames as a test set has.
fn evenly_spaced(frames: &[Pose]) -> Vec<Pose> {
    let rounds = TEST_SAMPLES.div_ceil(frames.len());
    let step = |i: usize| i * rounds * frames.len() / TEST_SAMPLES % frames.len();
    (0..TEST_SAMPLES).map(|i| frames[step(i)]).collect()
}

/// Independent poses, θ_Z uniform in 0° … 90°.
fn independent(samples: usize, seed: u64, pose: impl Fn(&mut ItemRng) -> Pose) -> Vec<Pose> {
    let draw = |i: usize| {
        let mut random = ItemRng::new(seed, i as u64);
        let mut pose = pose(&mut random);
        pose[Dof::ThetaZ] = random.between(0.0, std::f64::consts::FRAC_PI_2);
        pose
    };
    (0..samples).map(draw).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files;

    fn poses_of(test: Test) -> Vec<Pose> {
        let (rig, hand) = (files::rig(None).unwrap(), files::hand(None).unwrap());
        test.set(&rig, &hand, &[]).poses
    }

    #[test]
    fn every_test_has_as_many_samples() {
        for test in Test::SYNTHETIC {
            assert_eq!(poses_of(test).len(), TEST_SAMPLES, "{}", test.name());
        }
    }

    #[test]
    fn theta_is_between_where_it_is_said_to_be() {
        for test in [Test::ThetaBetween, Test::All] {
            for pose in poses_of(test) {
                let degrees = pose[Dof::ThetaZ].to_degrees();
                assert!((degrees / 15.0).fract() > 0.4, "{degrees}");
            }
        }
    }

    #[test]
    fn what_is_tested_on_is_not_what_is_learnt_from() {
        let (rig, hand) = (files::rig(None).unwrap(), files::hand(None).unwrap());
        let learnt = random(&rig, &hand, 3000, Augment::No).poses;
        for pose in poses_of(Test::Random) {
            assert!(!learnt.contains(&pose));
        }
    }

    #[test]
    fn a_larger_random_set_begins_with_the_smaller() {
        let (rig, hand) = (files::rig(None).unwrap(), files::hand(None).unwrap());
        let set = |samples| random(&rig, &hand, samples, Augment::Yes);
        let (small, large) = (set(100), set(200));
        for number in 0..100 {
            assert_eq!(small.scene(number), large.scene(number));
        }
    }

    #[test]
    fn damaged_sets_are_the_same_motion() {
        let unseen = poses_of(Test::Unseen);
        for test in [Test::Hands, Test::Cameras1, Test::Cameras3, Test::Ragged, Test::Rolled] {
            assert_eq!(poses_of(test), unseen, "{}", test.name());
        }
    }

    #[test]
    fn a_number_of_samples_is_sensible() {
        assert_eq!(samples("100"), Ok(100));
        for text in ["99", "0", "10000001", "-3", "many"] {
            assert!(samples(text).is_err(), "{text}");
        }
    }
}
