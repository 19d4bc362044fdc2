//! Turns a calibration in OpenCV's conventions into a rig file; MM is the unit of its lengths, such
//! as the side of a chessboard's squares:
//! `cargo run --example from_opencv -- calibration.json 25 > rig.toml`

use phalanx_camera::{Rig, Volume, cameras_from_opencv_json};

/// The side of the cube in which the hand is expected, mm.
const SIDE: f64 = 150.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, unit_mm] = arguments.as_slice() else {
        return Err("usage: from_opencv CALIBRATION.json MM".into());
    };
    let cameras = cameras_from_opencv_json(&std::fs::read_to_string(path)?, unit_mm.parse()?)?;
    let volume = Volume::between(&cameras, SIDE)?;
    print!("{}", Rig { cameras, volume }.to_toml()?);
    Ok(())
}
