//! Shows poses in the terminal, a character for two pixels:
//! `cargo run -p phalanx-render --example terminal -- index.mcp=70 index.pip=90`

use std::error::Error;

use glam::{DAffine3, DVec3};
use phalanx_camera::{Camera, Intrinsics};
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_render::{Renderer, Supersampling};

/// From nothing covered to all of it.
const SHADES: [char; 5] = [' ', '.', 'o', 'O', '@'];

fn main() -> Result<(), Box<dyn Error>> {
    let mut pose = Pose::REST;
    for argument in std::env::args().skip(1) {
        let (name, value) = argument.split_once('=').ok_or("usage: terminal NAME=DEGREES ...")?;
        let dof: Dof = name.parse()?;
        pose[dof] = dof.unit().from_file(value.parse()?);
    }
    let hand = HandShape::adult().pose(&pose, &DAffine3::IDENTITY);
    // The back of the hand from above, the fingers pointing up.
    let middle = DVec3::new(0.0, 0.0, 80.0);
    let intrinsics = Intrinsics::pinhole(80, 90, 210.0);
    let camera = Camera::look_at("above", intrinsics, middle + 700.0 * DVec3::Y, middle, DVec3::Z)?;
    let coverage = Renderer::new(&camera)?.coverage(&hand.primitives, Supersampling::X4)?;
    for y in (0..coverage.height() - 1).step_by(2) {
        let line = (0..coverage.width()).map(|x| {
            let covered = u32::from(coverage[(x, y)].0[0]) + u32::from(coverage[(x, y + 1)].0[0]);
            SHADES[(covered * 4).div_ceil(510) as usize]
        });
        println!("{}", line.collect::<String>().trim_end());
    }
    Ok(())
}
