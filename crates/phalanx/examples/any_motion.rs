//! Learns motion in general, then estimates and refines poses that it has not seen:
//! `cargo run --release -p phalanx --example any_motion`.

use std::error::Error;

use phalanx::{
    Augmentation, ItemRng, NoProgress, Preset, Refiner, Scene, SceneDescriber, SceneSource, Shard,
    Workspace,
};
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, Pose, sample_pose};
use phalanx_refine::PoseFitSettings;

/// Few, so that it takes seconds; the preset asks for more.
const LEARNT_FROM: usize = 2000;

/// Poses of the prior. Give these damage, and what is learnt knows other hands, too.
struct AnyMotion<'a> {
    rig: &'a Rig,
    hand: &'a HandShape,
    seed: u64,
    count: usize,
}

impl SceneSource for AnyMotion<'_> {
    fn count(&self) -> usize {
        self.count
    }

    fn scene(&self, number: usize) -> Scene {
        let mut random = ItemRng::new(self.seed, number as u64);
        let mut pose = sample_pose(|| random.uniform());
        pose[Dof::ThetaZ] = random.between(0.0, 90.0_f64.to_radians());
        Augmentation::NONE.scene(self.rig, self.hand, pose, self.seed, number)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let rig = Rig::from_toml(include_str!("../fixtures/desk.toml"))?;
    let hand = HandShape::adult();
    let scenes = |seed, count| AnyMotion { rig: &rig, hand: &hand, seed, count };
    let training = Preset::Fast.training();
    let learnt = training.shard(&rig, &hand, &scenes(1, LEARNT_FROM), Shard::WHOLE, &NoProgress)?;
    let estimator = learnt.finish(&NoProgress)?;
    let refiner = Refiner::for_estimator(&estimator, PoseFitSettings::default())?;

    let mut describer = SceneDescriber::new(&rig, estimator.descriptor().view_config())?;
    let mut workspace = Workspace::default();
    println!("mean error of the 20 joint angles");
    println!("estimated  refined  overlap in each view");
    let unseen = scenes(2, 6);
    for number in 0..unseen.count() {
        let scene = unseen.scene(number);
        let silhouettes: Vec<_> = describer.silhouettes(&scene)?.cloned().collect();
        let estimate = estimator.estimate_silhouettes(&silhouettes, &mut workspace)?;
        let refined = refiner.refine(&refiner.evidence(&silhouettes)?, &estimate)?;
        let [before, after] =
            [estimate.pose, refined.pose].map(|pose| error_deg(&pose, &scene.pose));
        println!("{before:8.1}°  {after:6.1}°  {:.3?}", refined.ious);
    }
    Ok(())
}

fn error_deg(one: &Pose, other: &Pose) -> f64 {
    let joints = Dof::ALL.into_iter().filter(|dof| dof.is_internal());
    let errors: Vec<f64> = joints.map(|dof| (one[dof] - other[dof]).abs().to_degrees()).collect();
    errors.iter().sum::<f64>() / errors.len() as f64
}
