//! One line of the report.

use serde::Serialize;

/// What one method came to on one take, through some of its cameras. `None` stands for what has no
/// reference, or what the method does not say. Of a refused frame the best constant's errors count, all of
/// its finger states are wrong, and nothing of what is seen is covered.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The take's name.
    pub take: String,
    /// The names of the cameras that were used.
    pub cameras: Vec<String>,
    /// `masks`, `photographs`, `landmarks` or `masks+landmarks`.
    pub input: &'static str,
    /// The method's name.
    pub method: &'static str,
    /// How many frames there are.
    pub frames: usize,
    /// Frames without an answer.
    pub refused: usize,
    /// Frames with an answer that the method doubts.
    pub doubted: usize,
    /// Distance of the joints from the reference, mm.
    pub joints_mm: Option<Spread>,
    /// Finger states.
    pub states: Option<States>,
    /// Mean error of the angles between bones, degrees.
    pub bone_angles_deg: Option<f64>,
    /// The same of the median of each angle.
    pub best_constant_deg: Option<f64>,
    /// Intersection over union with the masks.
    pub iou: Option<Iou>,
    /// Distance of the joints from the landmarks in the pictures of the cameras that were used, as a share
    /// of the hand's length there.
    pub reprojection: Option<Reprojection>,
    /// Share of the joints' coordinates within what the deviations promise.
    pub coverage: Option<Coverage>,
    /// Distance of a joint from its place that the deviations promise, root mean square of each joint, mean
    /// over joints and frames, mm.
    pub std_mm: Option<f64>,
    /// CPU time a frame, ms.
    pub ms: Option<Milliseconds>,
}

/// Mean, median and 95th percentile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct Spread {
    pub mean: f64,
    pub median: f64,
    pub p95: f64,
}

/// How many finger states are right.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct States {
    pub right: usize,
    pub of: usize,
}

/// The mean over frames and views, and the share of frames in which every view reaches 0.88.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct Iou {
    pub mean: f64,
    pub least_above_088: f64,
}

/// Median and 90th percentile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct Reprojection {
    pub median: f64,
    pub p90: f64,
}

/// Shares within the central 50, 68 and 95 %.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct Coverage {
    #[serde(rename = "50")]
    pub half: f64,
    #[serde(rename = "68")]
    pub one_sigma: f64,
    #[serde(rename = "95")]
    pub two_sigma: f64,
}

/// Median and 95th percentile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct Milliseconds {
    pub median: f64,
    pub p95: f64,
}
