//! The 21 joints of each pose of a file, mm, in the frame of the hand at rest:
//! `cargo run --example joints -- poses.csv > joints.csv`

use glam::DAffine3;
use phalanx_hand::{HandShape, PoseTable};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("usage: joints POSES.csv")?;
    let table = PoseTable::read(std::fs::File::open(path)?)?;
    for warning in &table.warnings {
        eprintln!("{warning}");
    }
    let shape = HandShape::adult();
    println!("row,joint,x_mm,y_mm,z_mm");
    for (row, pose) in table.poses.iter().enumerate() {
        let hand = shape.pose(pose, &DAffine3::IDENTITY);
        for (joint, at) in hand.joints.iter().enumerate() {
            println!("{row},{joint},{:.2},{:.2},{:.2}", at.x, at.y, at.z);
        }
    }
    Ok(())
}
