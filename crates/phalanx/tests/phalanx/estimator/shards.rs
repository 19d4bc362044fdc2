//! Training in shards: the same bytes however it is cut, and clear refusals.

use phalanx::{
    Augmentation, Error, LossReason, NoProgress, OrientationRule, PartialTraining, RegressorConfig,
    Scene, SceneSource, SceneSubset, Shard, Trainer, Training,
};
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, sample_pose};
use phalanx_rvm::{
    AgarwalTriggs, Bandwidth, Kernel, KernelRidge, NystromRidge, Regularisation, Stop,
    TwoStageSelection,
};

use super::desk::{self, top};

/// Independent poses before one camera.
struct Random {
    rig: Rig,
    hand: HandShape,
    count: usize,
}

impl Random {
    fn new(count: usize) -> Self {
        Self { rig: top(), hand: HandShape::adult(), count }
    }

    fn shard(
        &self,
        regressor: &RegressorConfig,
        index: usize,
        count: usize,
    ) -> Result<PartialTraining, Error> {
        let quick = desk::training(OrientationRule::default());
        let training = Training { regressor: regressor.clone(), ..quick };
        training.shard(&self.rig, &self.hand, self, Shard::new(index, count)?, &NoProgress)
    }
}

impl SceneSource for Random {
    fn count(&self) -> usize {
        self.count
    }

    fn scene(&self, number: usize) -> Scene {
        let mut random = phalanx::ItemRng::new(1, number as u64);
        let pose = sample_pose(|| random.uniform());
        Augmentation::NONE.scene(&self.rig, &self.hand, pose, 2, number)
    }
}

fn linear() -> RegressorConfig {
    RegressorConfig::Bridges(AgarwalTriggs {
        kernel: Kernel::Linear,
        stop: Stop::Count(20),
        ..AgarwalTriggs::default()
    })
}

#[test]
fn merged_shards_are_the_bytes_of_one_run_at_any_number_of_threads() {
    let scenes = Random::new(1100);
    let run = |threads: usize, shards: &[(usize, usize)]| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let parts = shards.iter().map(|&(index, count)| {
                let part = scenes.shard(&linear(), index, count).unwrap();
                PartialTraining::from_bytes(&part.to_bytes().unwrap()).unwrap()
            });
            let merged = parts.reduce(|mut a, b| {
                a.merge(b).unwrap();
                a
            });
            merged.unwrap().finish(&NoProgress).unwrap().to_bytes().unwrap()
        })
    };
    let whole = run(1, &[(1, 1)]);
    assert_eq!(run(2, &[(2, 2), (1, 2)]), whole);
    // More shards than blocks: some are empty.
    assert_eq!(run(8, &[(3, 3), (1, 3), (2, 3)]), whole);
}

#[test]
fn four_shards_of_kernel_regression_are_one_run() {
    let scenes = Random::new(1100);
    let nystrom = RegressorConfig::Nystrom(NystromRidge::default());
    let bytes = |part: PartialTraining| part.finish(&NoProgress).unwrap().to_bytes().unwrap();
    let whole = bytes(scenes.shard(&nystrom, 1, 1).unwrap());
    let mut merged = scenes.shard(&nystrom, 4, 4).unwrap();
    for index in [2, 1, 3] {
        merged.merge(scenes.shard(&nystrom, index, 4).unwrap()).unwrap();
    }
    assert!(bytes(merged) == whole);
}

#[test]
fn a_missing_or_repeated_part_is_named() {
    let scenes = Random::new(1100);
    let first = scenes.shard(&linear(), 1, 2).unwrap();
    let error = first.clone().finish(&NoProgress).unwrap_err();
    assert_eq!(error.to_string(), "a part is missing: none holds samples 1024 to 1099");
    let error = first.clone().merge(first).unwrap_err();
    assert_eq!(error.to_string(), "two parts both hold samples 0 to 1023");
}

#[test]
fn parts_of_other_trainings_are_refused() {
    let part = |count: usize, regressor: &RegressorConfig| {
        Random::new(count).shard(regressor, 1, 2).unwrap()
    };
    let mut one = part(200, &linear());
    let error = one.merge(part(201, &linear())).unwrap_err();
    assert!(error.to_string().ends_with("their numbers of scenes"), "{error}");
    let gaussian = RegressorConfig::Nystrom(NystromRidge::default());
    let error = one.merge(part(200, &gaussian)).unwrap_err();
    assert!(error.to_string().ends_with("their regressors"), "{error}");
}

#[test]
fn more_samples_than_a_regressor_keeps_are_refused_before_any_work() {
    for (regressor, count) in [
        (RegressorConfig::Cascade(TwoStageSelection::default()), usize::MAX / 2),
        (RegressorConfig::KernelRidge(KernelRidge::default()), 14_000),
    ] {
        let error = Random::new(count).shard(&regressor, 1, 1).unwrap_err();
        assert!(matches!(error, Error::TooManySamples { found, .. } if found == count), "{error}");
    }
}

#[test]
fn what_keeps_its_samples_learns_in_shards_too() {
    let scenes = Random::new(1100);
    let dense = RegressorConfig::KernelRidge(KernelRidge {
        bandwidth: Bandwidth::Relative(0.5),
        regularisation: Regularisation::Fixed(0.01),
    });
    let shard = |index, count| {
        let part = scenes.shard(&dense, index, count).unwrap();
        PartialTraining::from_bytes(&part.to_bytes().unwrap()).unwrap()
    };
    let mut merged = shard(2, 2);
    merged.merge(shard(1, 2)).unwrap();
    assert_eq!(merged.finish(&NoProgress).unwrap(), shard(1, 1).finish(&NoProgress).unwrap());
}

/// Motion in cycles: every second pose is turned.
struct Cycles(Random);

impl SceneSource for Cycles {
    fn count(&self) -> usize {
        self.0.count
    }

    fn scene(&self, number: usize) -> Scene {
        let mut scene = self.0.scene(number);
        scene.pose[Dof::ThetaZ] = [0.0, 0.6][number % 2];
        scene
    }
}

#[test]
fn a_subset_sees_every_phase_of_a_periodic_motion() {
    let cycles = Cycles(Random::new(4000));
    let subset = SceneSubset::new(&cycles, 1000);
    let turned = |number: &usize| subset.scene(*number).pose[Dof::ThetaZ] > 0.0;
    let turned = (0..subset.count()).filter(turned).count();
    assert_eq!(subset.count(), 1000);
    // Binomial: the standard deviation is 16.
    assert!((420..580).contains(&turned), "{turned}");
}

#[test]
fn a_damaged_part_is_refused() {
    let bytes = Random::new(120).shard(&linear(), 1, 1).unwrap().to_bytes().unwrap();
    assert!(PartialTraining::from_bytes(&bytes).is_ok());
    for length in [0, 7, 23, bytes.len() - 1] {
        assert!(PartialTraining::from_bytes(&bytes[..length]).is_err(), "{length} bytes");
    }
    for byte in (0..bytes.len()).step_by(997) {
        let mut flipped = bytes.clone();
        flipped[byte] ^= 0x10;
        assert!(PartialTraining::from_bytes(&flipped).is_err(), "byte {byte}");
    }
    let model = b"PHALANX\0and so on";
    let error = PartialTraining::from_bytes(model).unwrap_err();
    assert!(error.to_string().starts_with("not a phalanx training part"), "{error}");
}

#[test]
fn shards_of_a_trainer_are_one_run_with_its_error_model() {
    let (rig, hand) = (top(), HandShape::adult());
    let quick = Training { regressor: linear(), ..desk::training(OrientationRule::default()) };
    let trainer = Trainer::new(quick, 1100).error_samples(60);
    let shard = |index, count| {
        let shard = Shard::new(index, count).unwrap();
        trainer.fit_shard(&rig, &hand, shard, &NoProgress).unwrap()
    };
    let mut merged = shard(2, 2);
    merged.merge(PartialTraining::from_bytes(&shard(1, 2).to_bytes().unwrap()).unwrap()).unwrap();
    let merged = merged.finish(&NoProgress).unwrap();
    assert!(merged.error_model().is_some());
    assert_eq!(merged, trainer.fit(&rig, &hand, &NoProgress).unwrap());
}

/// Poses of which every so-manieth is out of sight.
struct OutOfSight {
    all: Random,
    every: usize,
}

impl SceneSource for OutOfSight {
    fn count(&self) -> usize {
        self.all.count
    }

    fn scene(&self, number: usize) -> Scene {
        let mut scene = self.all.scene(number);
        if number % self.every == 3 {
            scene.pose[Dof::TX] = 5000.0;
        }
        scene
    }
}

#[test]
fn lost_scenes_are_counted_with_a_reason_and_too_many_refused() {
    let training = Training { regressor: linear(), ..desk::training(OrientationRule::default()) };
    let learn = |every: usize| {
        let scenes = OutOfSight { all: Random::new(200), every };
        training.shard(&scenes.all.rig, &scenes.all.hand, &scenes, Shard::WHOLE, &NoProgress)
    };
    let part = learn(40).unwrap();
    let lost: Vec<_> = part.losses().iter().collect();
    assert_eq!(lost, [("top", LossReason::NoHand, 5)]);
    assert_eq!(PartialTraining::from_bytes(&part.to_bytes().unwrap()).unwrap(), part);
    assert!(part.finish(&NoProgress).is_ok());
    let message = learn(10).unwrap_err().to_string();
    let expected = "20 of 200 training scenes cannot be used, more than 5 %: camera 'top': no hand";
    assert!(message.starts_with(expected), "{message}");
    assert!(message.contains("(scene 3: "), "{message}");
}

/// Broken off after its first block and gone on with, a training has the bytes of an unbroken one.
#[test]
fn a_broken_off_training_goes_on_to_the_same_bytes() {
    let quick = desk::training(OrientationRule::default());
    let training = Training { regressor: linear(), ..quick };
    let trainer = Trainer::new(training, 2100).error_samples(100);
    let (rig, hand) = (top(), HandShape::adult());
    let mut kept = Vec::new();
    let mut keep = |part: &PartialTraining| kept.push(part.to_bytes().unwrap());
    let whole = trainer.resume_shard(&rig, &hand, Shard::WHOLE, None, &mut keep, &NoProgress);
    let whole = whole.unwrap().to_bytes().unwrap();
    assert_eq!(kept.len(), 3);
    assert!(kept[2] == whole);
    let read = |bytes: &[u8]| PartialTraining::from_bytes(bytes).unwrap();
    assert_eq!(read(&kept[1]).seen(), 2048);
    let resume = |trainer: &Trainer, shard: Shard, earlier: &[u8]| {
        let earlier = Some(read(earlier));
        trainer.resume_shard(&rig, &hand, shard, earlier, &mut |_| {}, &NoProgress)
    };
    for earlier in &kept {
        assert!(resume(&trainer, Shard::WHOLE, earlier).unwrap().to_bytes().unwrap() == whole);
    }
    let other = resume(&trainer.clone().seed(1), Shard::WHOLE, &kept[0]);
    assert!(matches!(other, Err(Error::ForeignPart { .. })));
    let other = resume(&trainer, Shard::new(1, 3).unwrap(), &kept[1]);
    assert!(matches!(other, Err(Error::ForeignPart { what: "their shards" })));
}
