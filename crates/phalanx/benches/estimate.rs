//! Three cameras, one thread: pictures to a pose, and a pose to its part of the training set.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use image::RgbImage;
use phalanx::{
    Estimator, FixedPoses, NoProgress, OrientationRule, Picture, RegressorConfig, Training,
    Workspace, describe_each,
};
use phalanx_camera::Rig;
use phalanx_hand::{Digit, Dof, HandShape, Pose};
use phalanx_render::{Appearance, Renderer};
use phalanx_rvm::{Stop, TwoStageSelection};
use phalanx_segmentation::{Mask, SkinModel};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// The training half of the paper's § 5.2.
const SAMPLES: usize = 837;
const PICTURE: (u32, u32) = (640, 480);

fn rig() -> Rig {
    Rig::from_toml(include_str!("../fixtures/desk.toml")).expect("a valid rig")
}

/// A hand whose digits bend independently, turned about the forearm.
fn pose(index: usize) -> Pose {
    let mut random = Pcg64Mcg::seed_from_u64(index as u64);
    let mut uniform = || f64::from(random.next_u32()) / f64::from(u32::MAX);
    let mut pose = Pose::REST;
    for digit in Digit::ALL {
        let curl = uniform();
        for joint in digit.dofs().into_iter().skip(1) {
            pose[joint] = 0.9 * curl * joint.range().1;
        }
    }
    pose[Dof::ThetaZ] = (60.0 * uniform() - 30.0).to_radians();
    pose
}

/// What all estimators of this file are learnt from.
struct TrainingSet {
    rig: Rig,
    hand: HandShape,
    poses: Vec<Pose>,
}

impl TrainingSet {
    fn new() -> Self {
        let (rig, hand) = (rig(), HandShape::adult());
        Self { rig, hand, poses: (0..SAMPLES).map(pose).collect() }
    }

    fn estimator(&self, regressor: RegressorConfig) -> Estimator {
        let training = Training { regressor, ..Training::default() };
        training.run(&self.rig, &self.hand, &self.poses, &NoProgress).expect("a good training set")
    }
}

/// A hand that was not trained on, through every camera of the rig at the size of a webcam's
/// picture: coloured, and as masks.
fn pictures(rig: &Rig, hand: &HandShape) -> (Vec<RgbImage>, Vec<Mask>) {
    let solids = hand.pose(&pose(SAMPLES), &rig.volume.rest_frame()).primitives;
    let draw = |camera: &phalanx_camera::Camera| {
        let large = camera.intrinsics.resized(PICTURE.0, PICTURE.1);
        let mut renderer = Renderer::new(&camera.with_intrinsics(large)).expect("a valid camera");
        let photograph = renderer.shade(&solids, &Appearance::default(), 1);
        (photograph.expect("in front"), renderer.silhouette(&solids).expect("in front").into())
    };
    rig.cameras.iter().map(draw).unzip()
}

fn estimate(c: &mut Criterion) {
    let set = TrainingSet::new();
    let (photographs, masks) = pictures(&set.rig, &set.hand);
    let skin = SkinModel::builtin();
    let photographs: Vec<Picture> =
        photographs.iter().map(|image| Picture::Photograph(image, &skin)).collect();
    let masks: Vec<Picture> = masks.iter().map(Picture::Mask).collect();
    let both = RegressorConfig::Cascade(TwoStageSelection {
        features: Stop::Count(34),
        samples: Stop::Count(38),
        ..TwoStageSelection::default()
    });
    let mut workspace = Workspace::default();
    for (name, regressor) in [("kernel ridge", Training::default().regressor), ("both", both)] {
        let estimator = set.estimator(regressor);
        for (kind, pictures) in [("photographs", &photographs), ("masks", &masks)] {
            c.bench_function(&format!("three 640x480 {kind} to a pose/{name}"), |b| {
                b.iter(|| estimator.estimate(black_box(pictures), &mut workspace).expect("a hand"));
            });
        }
    }
}

fn training(c: &mut Criterion) {
    let (rig, hand) = (rig(), HandShape::adult());
    let poses: Vec<Pose> = (0..10).map(pose).collect();
    c.bench_function("draw and describe ten poses in three views", |b| {
        b.iter(|| {
            let scenes = FixedPoses { rig: &rig, hand: &hand, poses: black_box(&poses) };
            describe_each(&rig, &scenes, OrientationRule::default(), &NoProgress)
                .expect("cameras draw")
        });
    });
}

criterion_group!(benches, estimate, training);
criterion_main!(benches);
