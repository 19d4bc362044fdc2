//! Finds the proportions of a hand from twelve frames of it moving:
//! `cargo run --release -p phalanx-refine --example own_hand`.

use std::error::Error;

use phalanx_camera::Rig;
use phalanx_hand::{Digit, Dof, HandShape, Pose};
use phalanx_refine::{BundleAdjustment, BundleFrame, PosePrior, SilhouetteObservation};
use phalanx_render::Renderer;

const FRAMES: u32 = 12;

fn main() -> Result<(), Box<dyn Error>> {
    let rig = Rig::from_toml(include_str!("../fixtures/desk.toml"))?;
    let (mean, rest) = (HandShape::adult(), rig.volume.rest_frame());
    // A smaller hand, its middle and ring fingers longer than such hands' mostly are.
    let mut own = mean.scaled(|| 0.95);
    for finger in [&mut own.middle, &mut own.ring] {
        finger.lengths_mm = finger.lengths_mm.map(|length| 1.08 * length);
    }

    let mut deviations = [0.15; Dof::COUNT];
    for dof in [Dof::TX, Dof::TY, Dof::TZ, Dof::ThetaX, Dof::ThetaY] {
        deviations[dof.index()] = 0.0; // known
    }
    let mut frames = Vec::new();
    for frame in 0..FRAMES {
        let truth = moving(f64::from(frame), 0.0);
        let primitives = own.pose(&truth, &rest).primitives;
        let mut evidence = Vec::new();
        for camera in &rig.cameras {
            let mask = Renderer::new(camera)?.silhouette(&primitives)?;
            evidence.push(SilhouetteObservation::new(camera, &mask.into())?);
        }
        let start = moving(f64::from(frame), 0.1); // an estimate, not quite right
        let prior = PosePrior::independent(start, &deviations)?;
        frames.push(BundleFrame { observations: evidence, landmarks: Vec::new(), start, prior });
    }
    let found = BundleAdjustment::default().run(&mean, &rest, &frames)?;

    println!("length of each finger, mm   mean hand   found   true");
    let length = |hand: &HandShape, k: usize| hand.fingers()[k].lengths_mm.iter().sum::<f64>();
    for (k, finger) in Digit::FINGERS.into_iter().enumerate() {
        let [mean, found, own] = [&mean, &found.hand, &own].map(|hand| length(hand, k));
        println!("{:<26} {mean:>10.1} {found:>7.1} {own:>6.1}", format!("{finger:?}"));
    }
    Ok(())
}

/// A hand that opens and closes finger by finger while it turns; `off` is added to every flexion.
fn moving(frame: f64, off: f64) -> Pose {
    let mut pose = Pose::REST;
    for (k, digit) in (0_u32..).zip(Digit::ALL) {
        let bend = 0.5 - 0.5 * (0.9 * frame + 1.3 * f64::from(k)).cos();
        let [_, flexions @ ..] = digit.dofs();
        for (dof, most) in flexions.into_iter().zip([0.5, 0.9, 0.6]) {
            pose[dof] = most * bend + off;
        }
    }
    pose[Dof::ThetaZ] = 0.3 + 0.08 * frame;
    pose
}
