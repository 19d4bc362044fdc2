//! Draws the README's figure: an open hand, a pointing one and a fist, seen from above.
//! `cargo run -p phalanx-hand --example poses > crates/hand/figures/poses.svg`

use glam::{DAffine3, DVec3};
use phalanx_hand::{Digit, HandShape, JOINTS, Pose, PosedHand, Primitive};

/// The width and height of a hand's part of the picture, mm.
const WIDTH: f64 = 190.0;
const HEIGHT: f64 = 250.0;

/// How bent a digit's three joints are, degrees.
const BENT: [f64; 3] = [70.0, 95.0, 60.0];
const BENT_THUMB: [f64; 3] = [35.0, 40.0, 50.0];

fn main() {
    println!(r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {} {HEIGHT}">"#, 3.0 * WIDTH);
    println!(r#"<rect width="100%" height="100%" fill="white"/>"#);
    let pointing = &Digit::ALL[2..];
    for (place, bent) in [&[], pointing, &Digit::ALL[..]].into_iter().enumerate() {
        let hand = HandShape::adult().pose(&pose(bent), &DAffine3::IDENTITY);
        draw(&hand, (place as f64 + 0.55) * WIDTH);
    }
    println!("</svg>");
}

/// A pose in which these digits are bent.
fn pose(bent: &[Digit]) -> Pose {
    let mut pose = Pose::REST;
    for &digit in bent {
        let [_, flexions @ ..] = digit.dofs();
        let angles = if digit == Digit::Thumb { BENT_THUMB } else { BENT };
        for (dof, angle) in flexions.into_iter().zip(angles) {
            pose[dof] = angle.to_radians();
        }
    }
    pose
}

/// The solids, the lower ones first, and the joints on top.
fn draw(hand: &PosedHand, middle: f64) {
    let place = |point: DVec3| [middle - point.x, HEIGHT - 45.0 - point.z];
    let height = |solid: &Primitive| solid.spheres().iter().map(|b| b.center.y).sum::<f64>();
    let mut solids: Vec<&Primitive> = hand.primitives.iter().collect();
    solids.sort_by(|a, b| {
        (height(a) / a.spheres().len() as f64).total_cmp(&(height(b) / b.spheres().len() as f64))
    });
    for solid in solids {
        let spheres = solid.spheres().iter().map(|sphere| (place(sphere.center), sphere.radius));
        let spheres: Vec<_> = spheres.collect();
        println!(r##"<path fill="#e8c4a8" stroke="#b08968" d="{}"/>"##, outline(&spheres));
    }
    for finger in (1..JOINTS).step_by(4) {
        let chain = std::iter::once(0).chain(finger..finger + 4);
        let points: Vec<_> = chain.map(|joint| place(hand.joints[joint])).collect();
        let path: Vec<_> = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        println!(r##"<polyline fill="none" stroke="#305070" points="{}"/>"##, path.join(" "));
        for [x, y] in points {
            println!(r##"<circle cx="{x:.1}" cy="{y:.1}" r="2" fill="#305070"/>"##);
        }
    }
}

/// The hull of some discs: in each direction, where the disc is that reaches furthest.
fn outline(discs: &[([f64; 2], f64)]) -> String {
    let corners: Vec<String> = (0..60)
        .map(|step| {
            let (sin, cos) = (f64::from(step) / 60.0 * std::f64::consts::TAU).sin_cos();
            let reach = |&([x, y], radius): &([f64; 2], f64)| x * cos + y * sin + radius;
            let furthest = discs.iter().max_by(|a, b| reach(a).total_cmp(&reach(b)));
            let &([x, y], radius) = furthest.expect("a solid has spheres");
            format!("{:.1} {:.1}", x + radius * cos, y + radius * sin)
        })
        .collect();
    format!("M{}Z", corners.join("L"))
}
