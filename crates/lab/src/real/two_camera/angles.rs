//! Bone-to-bone angles of the 21 joints, against those of the reference.

use std::fmt::Write;
use std::path::Path;

use anyhow::{Context, Result};
use glam::DVec3;
use phalanx_hand::{Digit, JOINTS};

/// Degrees by which the reference's two views may differ for it to count.
const AGREED_DEG: f64 = 10.0;
/// Frames in which an angle must be agreed on for it to be judged.
const LEAST_FRAMES: usize = 10;

/// The reference's angles in its order: a digit's name and the bones' common joint, with the joint
/// before and the joint after.
const DIGITS: [&str; 5] = ["thumb", "index", "middle", "ring", "pinky"];
const PLACES: [[&str; 3]; 2] = [["CMC", "MCP", "IP"], ["MCP", "PIP", "DIP"]];

/// How many there are.
pub(super) const COUNT: usize = 15;

/// The unsigned angles between consecutive bones, degrees, in the reference's order.
pub(super) fn of_joints(joints: &[DVec3; JOINTS]) -> [f64; COUNT] {
    std::array::from_fn(|k| {
        let (digit, place) = (k / 3, k % 3);
        let at = 1 + 4 * digit + place;
        let before = if place == 0 { 0 } else { at - 1 };
        let bones = [joints[at] - joints[before], joints[at + 1] - joints[at]];
        bones[0].angle_between(bones[1]).to_degrees()
    })
}

/// The reference's angles for the frames of these names: nothing where its views disagree.
pub(super) fn reference(folder: &Path, names: &[&str]) -> Result<Vec<[Option<f64>; COUNT]>> {
    let path = folder.join("reference-angles.csv");
    let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect())
        .collect();
    let of_frame = |name: &&str| {
        let number: f64 = name.parse().unwrap_or(f64::NAN);
        let row = rows.iter().find(|row| row[0] == number);
        std::array::from_fn(|k| {
            let row = row?;
            let (angle, off) = (*row.get(1 + k)?, *row.get(1 + COUNT + k)?);
            (angle.is_finite() && off < AGREED_DEG).then_some(angle)
        })
    };
    Ok(names.iter().map(of_frame).collect())
}

/// Mean absolute differences, angle by angle, beside those of the best constant; and in how many frames
/// the reference is beyond what the joint can do.
pub(super) fn table(found: &[[f64; COUNT]], reference: &[[Option<f64>; COUNT]]) -> String {
    let mut text = String::from(
        "angle        frames   ours  best constant, degrees  reference beyond the joint\n",
    );
    for k in 0..COUNT {
        let pairs: Vec<(f64, f64)> =
            found.iter().zip(reference).filter_map(|(f, r)| Some((f[k], r[k]?))).collect();
        let (digit, place) = (DIGITS[k / 3], PLACES[usize::from(k >= 3)][k % 3]);
        if pairs.len() < LEAST_FRAMES {
            writeln!(text, "{digit:6} {place:4} {:7}      –", pairs.len()).expect("to a string");
            continue;
        }
        let count = pairs.len() as f64;
        let ours = pairs.iter().map(|(found, truth)| (found - truth).abs()).sum::<f64>() / count;
        let mut truths: Vec<f64> = pairs.iter().map(|pair| pair.1).collect();
        truths.sort_by(f64::total_cmp);
        let median = truths[truths.len() / 2];
        let constant = truths.iter().map(|truth| (truth - median).abs()).sum::<f64>() / count;
        let most = Digit::ALL[k / 3].dofs()[1 + k % 3].range().1.to_degrees();
        let beyond = truths.iter().filter(|&&truth| truth > most).count();
        let frames = pairs.len();
        writeln!(text, "{digit:6} {place:4} {frames:7}  {ours:5.1}  {constant:5.1}  {beyond:25}")
            .expect("to a string");
    }
    text
}
