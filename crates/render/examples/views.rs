//! Draws a hand as each camera of a rig sees it, in every way that there is; the README's pictures are those
//! of the desk's top camera: `cargo run --example views -- crates/render/fixtures/desk.toml OUT_DIR`.

use std::error::Error;
use std::path::Path;

use image::{GrayImage, Luma};
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_render::{Appearance, DepthMap, Renderer, Supersampling};

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
        renderer.coverage(&hand.primitives, Supersampling::X4)?.save(file("coverage"))?;
        grey(&renderer.depth(&hand.primitives)?).save(file("depth"))?;
        renderer.shade(&hand.primitives, &Appearance::default(), 1)?.save(file("shaded"))?;
    }
    Ok(())
}

/// The nearest depth is white, the furthest dark, and where nothing is seen it is black.
fn grey(map: &DepthMap) -> GrayImage {
    let seen = || map.depths.iter().copied().filter(|depth| depth.is_finite());
    let [near, far] = [seen().fold(f32::MAX, f32::min), seen().fold(f32::MIN, f32::max)];
    let shade = |depth: f32| {
        if depth.is_finite() { 255.0 - 205.0 * (depth - near) / (far - near) } else { 0.0 }
    };
    GrayImage::from_fn(map.width, map.height, |x, y| {
        Luma([shade(map.depths[(y * map.width + x) as usize]) as u8])
    })
}
