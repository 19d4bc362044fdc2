//! How well one view agrees with a posed hand.

use glam::DAffine3;
use phalanx_hand::{HandShape, Pose};

use crate::error::Result;
use crate::geometry::correspondence::View;
use crate::observation::silhouette::Evidence;
use crate::pose_fit::settings::Refinement;

/// How well what one camera saw agrees with a posed hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// Intersection over union of the drawn and the observed silhouette, of what is known.
    pub overlap: f64,
    /// How much of the border the pose leaves unexplained: the mean robust squared distance over the
    /// most that it can be, 0 to 1.
    pub unexplained: f64,
}

impl Refinement {
    /// Compares one view with a hand in a pose, at the finest level; no fit need have used it.
    ///
    /// # Errors
    /// A parameter out of its range, or a hand that the camera cannot draw.
    pub fn agreement(
        &self,
        hand: &HandShape,
        rest: &DAffine3,
        evidence: &Evidence,
        pose: &Pose,
    ) -> Result<Agreement> {
        self.check()?;
        let mut view = View::new(evidence)?;
        view.compare(&hand.pose(pose, rest).primitives, evidence, 1)?;
        let scale = evidence.pixels_per_mm(rest.transform_point3(pose.translation()));
        let distances: Vec<f64> =
            view.matches.iter().map(|found| scale * found.passing.distance).collect();
        let measure = self.finest();
        let margin = measure.margin(&distances);
        let energy: f64 = distances.iter().map(|distance| measure.energy(distance - margin)).sum();
        Ok(Agreement {
            overlap: evidence.overlap(view.drawn()),
            unexplained: measure.unexplained(energy, distances.len()),
        })
    }
}
