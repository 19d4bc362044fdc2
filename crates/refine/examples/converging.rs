//! Draws the README's figure: three views of a hand, held against a wrong guess and against what that
//! becomes. `cargo run --release -p phalanx-refine --example converging > crates/refine/figures/converging.svg`

use phalanx_segmentation::Mask;
use std::error::Error;
use std::fmt::Write;

use phalanx_camera::Rig;
use phalanx_hand::{Digit, Dof, HandShape, Pose};
use phalanx_refine::{PoseFitSettings, PosePrior, SilhouetteObservation};
use phalanx_render::Renderer;

/// What is both observed and drawn, only observed, only drawn.
const COLOURS: [&str; 3] = ["#b8b8b8", "#d95f02", "#1f78b4"];

fn main() -> Result<(), Box<dyn Error>> {
    let rig = Rig::from_toml(include_str!("../fixtures/desk.toml"))?;
    let (hand, rest) = (HandShape::adult(), rig.volume.rest_frame());
    let draw = |pose: &Pose| -> Result<Vec<Mask>, Box<dyn Error>> {
        let primitives = hand.pose(pose, &rest).primitives;
        let view = |camera| Ok(Renderer::new(camera)?.silhouette(&primitives)?.into());
        rig.cameras.iter().map(view).collect()
    };
    let truth = bent([0.2, 0.3, 0.9, 1.2, 0.5], 0.9);
    let guess = bent([0.4, 0.6, 0.7, 0.9, 0.8], 0.7);
    let observed = draw(&truth)?;

    let views = rig.cameras.iter().zip(&observed);
    let evidence: Vec<SilhouetteObservation> = views
        .map(|(camera, mask)| SilhouetteObservation::new(camera, mask))
        .collect::<Result<_, _>>()?;
    let mut deviations = [0.3; Dof::COUNT];
    for dof in [Dof::TX, Dof::TY, Dof::TZ, Dof::ThetaX, Dof::ThetaY] {
        deviations[dof.index()] = 0.0; // known
    }
    let prior = PosePrior::independent(guess, &deviations)?;
    let refined = PoseFitSettings::default().fit(&hand, &rest, &evidence, &guess, &prior)?;

    let (width, height) = observed[0].dimensions();
    println!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {} {}">"#,
        width * observed.len() as u32,
        2 * height
    );
    println!(r#"<rect width="100%" height="100%" fill="white"/>"#);
    for (row, pose) in (0_u32..).zip([&guess, &refined.pose]) {
        for (column, (seen, drawn)) in (0_u32..).zip(observed.iter().zip(draw(pose)?)) {
            compare(seen, &drawn, [column * width, row * height])?;
        }
    }
    println!("</svg>");
    Ok(())
}

/// A hand whose digits are bent by so much, turned about its arm, radians.
fn bent(bends: [f64; 5], theta_z: f64) -> Pose {
    let mut pose = Pose::REST;
    for (digit, bend) in Digit::ALL.into_iter().zip(bends) {
        let [_, flexions @ ..] = digit.dofs();
        for (dof, share) in flexions.into_iter().zip([0.6, 1.0, 0.7]) {
            pose[dof] = share * bend;
        }
    }
    pose[Dof::ThetaZ] = theta_z;
    pose
}

/// Two masks, one on the other: runs of pixels of one kind, row by row.
fn compare(observed: &Mask, drawn: &Mask, at: [u32; 2]) -> std::fmt::Result {
    let kind = |x, y| match [observed, drawn].map(|mask| mask.is_hand(x, y)) {
        [true, true] => Some(0),
        [true, false] => Some(1),
        [false, true] => Some(2),
        [false, false] => None,
    };
    let mut runs = COLOURS.map(|_| String::new());
    for y in 0..observed.height() {
        let mut x = 0;
        while x < observed.width() {
            let start = x;
            while x < observed.width() && kind(x, y) == kind(start, y) {
                x += 1;
            }
            if let Some(kind) = kind(start, y) {
                let length = x - start;
                write!(runs[kind], "M{} {}h{length}v1h-{length}z", at[0] + start, at[1] + y)?;
            }
        }
    }
    for (colour, path) in COLOURS.iter().zip(runs) {
        println!(r#"<path fill="{colour}" d="{path}"/>"#);
    }
    Ok(())
}
