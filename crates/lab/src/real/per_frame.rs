//! Each frame of a run as a line of CSV: where a method is wrong, and whether it says so.

use anyhow::Result;
use serde::Serialize;

use super::method::{Outcome, Sequence};
use super::score::FrameScore;
use super::statistics::{mean, percentile};

/// A frame's line; cells without a reference are empty, lists are separated by spaces.
#[derive(Serialize)]
pub struct Line {
    take: String,
    cameras: String,
    input: &'static str,
    method: &'static str,
    frame: String,
    /// Mean distance of the joints.
    joints_mm: Option<f64>,
    /// Finger states that are wrong.
    wrong_states: usize,
    bone_angles_deg: Option<f64>,
    /// Of each view.
    overlaps: String,
    /// Median of each view, per cent of the hand's length.
    reprojection: String,
    left_out: String,
    /// Why the frame is doubted, or why it was refused.
    doubts: String,
}

/// A line for each frame of a run.
pub fn lines(
    sequence: &Sequence<'_>,
    method: &'static str,
    outcomes: &[Outcome],
    scores: &[FrameScore],
) -> Vec<Line> {
    let cameras: Vec<String> = sequence.cameras().into_iter().map(|c| c.name).collect();
    let line = |((frame, outcome), score): ((&_, &Outcome), &FrameScore)| {
        let (left_out, doubts) = match &outcome.found {
            Ok(found) => (found.left_out.join(" "), found.doubts.join(" ")),
            Err(error) => (String::new(), format!("refused: {error:#}")),
        };
        Line {
            take: sequence.take.name.clone(),
            cameras: cameras.join(" "),
            input: sequence.input.name(),
            method,
            frame: ToString::to_string(frame),
            joints_mm: mean(&score.joints_mm).map(tenths),
            wrong_states: score.states.iter().filter(|right| !**right).count(),
            bone_angles_deg: mean(&score.angles_deg).map(tenths),
            overlaps: spaced(score.overlaps.iter().map(|overlap| format!("{overlap:.3}"))),
            reprojection: spaced(score.reprojection.iter().map(|errors| {
                percentile(errors, 50)
                    .map_or("-".to_owned(), |share| format!("{:.1}", 100.0 * share))
            })),
            left_out,
            doubts,
        }
    };
    sequence.frames.iter().zip(outcomes).zip(scores).map(line).collect()
}

/// The lines as CSV with a header.
///
/// # Errors
/// None that can happen to text in memory.
pub fn csv(lines: &[Line]) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for line in lines {
        writer.serialize(line)?;
    }
    Ok(writer.into_inner().map_err(csv::IntoInnerError::into_error)?)
}

fn tenths(value: f64) -> f64 {
    (10.0 * value).round() / 10.0
}

fn spaced(cells: impl Iterator<Item = String>) -> String {
    cells.collect::<Vec<_>>().join(" ")
}
