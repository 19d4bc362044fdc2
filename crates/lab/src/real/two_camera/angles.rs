//! The table of bone-to-bone angles, against those of the reference.

use std::fmt::Write;

use phalanx_hand::Digit;

use crate::real::angles::{BoneAngles, COUNT, name};

/// Frames in which an angle must be agreed on for it to be judged.
const LEAST_FRAMES: usize = 10;

/// Mean absolute differences, angle by angle, beside those of the best constant; and in how many frames
/// the reference is beyond what the joint can do.
pub(super) fn table(found: &[BoneAngles<f64>], reference: &[BoneAngles<Option<f64>>]) -> String {
    let mut text = String::from(
        "angle        frames   ours  best constant, degrees  reference beyond the joint\n",
    );
    for k in 0..COUNT {
        let pairs: Vec<(f64, f64)> =
            found.iter().zip(reference).filter_map(|(f, r)| Some((f[k], r[k]?))).collect();
        let name = name(k);
        let (digit, place) = name.split_once('_').unwrap_or((&name, ""));
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
