//! How well a rig tells where a point is: what a pixel is worth at the hand's place, and how far off a
//! triangulated point is if every camera errs by one pixel.
//! `cargo run --example accuracy -- rig.toml`

use glam::{DVec2, DVec3};
use phalanx_camera::{Camera, Ray, Rig, triangulate};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("usage: accuracy RIG.toml")?;
    let rig = Rig::from_toml(&std::fs::read_to_string(path)?)?;
    let target = rig.volume.center;
    for camera in &rig.cameras {
        let depth = camera.extrinsics.to_camera(target).z;
        println!(
            "{}: {depth:.0} mm away, {:.2} mm to a pixel",
            camera.name,
            depth / camera.intrinsics.fx
        );
    }
    for (index, first) in rig.cameras.iter().enumerate() {
        for second in &rig.cameras[index + 1..] {
            let off = worst(&[first, second], target).ok_or("the rig does not see its volume")?;
            println!("{} and {}: up to {off:.2} mm off", first.name, second.name);
        }
    }
    Ok(())
}

/// The largest error of a point that two cameras see, each a pixel off to any of four sides.
fn worst(cameras: &[&Camera; 2], target: DVec3) -> Option<f64> {
    let sides = [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y];
    let ray = |camera: &Camera, off: DVec2| -> Option<Ray> {
        camera.unproject(camera.project(target)? + off)
    };
    let mut worst = 0.0_f64;
    for first in sides {
        for second in sides {
            let rays = [ray(cameras[0], first)?, ray(cameras[1], second)?];
            worst = worst.max(triangulate(&rays).ok()?.point.distance(target));
        }
    }
    Some(worst)
}
