//! Learns a hand that closes from three cameras, then looks at photographs it draws of poses in
//! between: `cargo run --release -p phalanx --example closing_hand`.

use std::error::Error;

use phalanx::{NoProgress, Picture, Training, Workspace};
use phalanx_camera::Rig;
use phalanx_hand::{Digit, Dof, HandShape, Pose};
use phalanx_render::{Appearance, Renderer};
use phalanx_segmentation::SkinModel;

/// All fingers bent by a share of a fist, the hand turned about the forearm.
fn closing(closed: f64, theta_z_deg: f64) -> Pose {
    let mut pose = Pose::REST;
    for finger in Digit::FINGERS {
        for (dof, degrees) in finger.dofs().into_iter().zip([0.0, 70.0, 88.0, 55.0]) {
            pose[dof] = (closed * degrees).to_radians();
        }
    }
    pose[Dof::ThetaZ] = theta_z_deg.to_radians();
    pose
}

fn main() -> Result<(), Box<dyn Error>> {
    let rig = Rig::from_toml(include_str!("../fixtures/desk.toml"))?;
    let hand = HandShape::adult();
    let stages = (0..=20).map(|k| f64::from(k) / 20.0);
    let poses: Vec<Pose> = stages
        .flat_map(|closed| [0.0, 20.0, 40.0, 60.0].map(|theta_z| closing(closed, theta_z)))
        .collect();
    let estimator = Training::default().run(&rig, &hand, &poses, &NoProgress)?;
    println!(
        "learnt from {} poses; the model takes {} bytes",
        poses.len(),
        estimator.to_bytes()?.len()
    );

    let skin = SkinModel::builtin();
    let mut workspace = Workspace::default();
    println!("closed  turned      index.pip  global.theta_z");
    for (closed, theta_z) in [(0.12, 10.0), (0.43, 30.0), (0.68, 50.0), (0.93, 10.0)] {
        let truth = closing(closed, theta_z);
        let solids = hand.pose(&truth, &rig.volume.rest_frame()).primitives;
        let mut photographs = Vec::new();
        for camera in &rig.cameras {
            photographs.push(Renderer::new(camera)?.shade(&solids, &Appearance::default(), 1)?);
        }
        let pictures: Vec<_> =
            photographs.iter().map(|photograph| Picture::Photograph(photograph, &skin)).collect();
        let estimate = estimator.estimate(&pictures, &mut workspace)?;
        let compare = |dof: Dof| {
            let [found, truth] = [estimate.pose[dof], truth[dof]].map(f64::to_degrees);
            let std = estimate.std[dof.index()].unwrap_or_default().to_degrees();
            format!("{found:.1} ± {std:.1} ({truth:.1})")
        };
        println!("{closed:6}  {theta_z:5}°  {}  {}", compare(Dof::IndexPip), compare(Dof::ThetaZ));
    }
    Ok(())
}
