//! Draws a hand as each camera of a rig sees it: `cargo run --example views -- RIG.toml OUT_DIR`.

use std::error::Error;
use std::path::Path;

use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_render::{Appearance, Renderer};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [rig, folder] = arguments.as_slice() else {
        return Err("usage: views RIG.toml OUT_DIR".into());
    };
    let rig = Rig::from_toml(&std::fs::read_to_string(rig)?)?;
    let mut pose = Pose::REST;
    pose[Dof::IndexPip] = 40_f64.to_radians();
    pose[Dof::RingMcp] = 50_f64.to_radians();
    let hand = HandShape::adult().pose(&pose, &rig.volume.rest_frame());
    for camera in &rig.cameras {
        let mut renderer = Renderer::new(camera)?;
        let file = |kind: &str| Path::new(folder).join(format!("{}-{kind}.png", camera.name));
        renderer.silhouette(&hand.primitives)?.save(file("silhouette"))?;
        renderer.shade(&hand.primitives, &Appearance::default(), 1)?.save(file("shaded"))?;
    }
    Ok(())
}
