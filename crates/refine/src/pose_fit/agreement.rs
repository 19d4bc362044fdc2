//! How well one view agrees with a posed hand.

use glam::DAffine3;
use phalanx_hand::{HandShape, Pose};

use crate::error::Result;
use crate::geometry::correspondence::ViewMatcher;
use crate::geometry::drawn_term::DrawnTerm;
use crate::observation::landmarks::LandmarkObservation;
use crate::observation::silhouette::SilhouetteObservation;
use crate::pose_fit::settings::PoseFitSettings;
use crate::solver::jacobian::Place;
use crate::solver::landmark_residuals::LandmarkResiduals;

/// How well what one camera saw agrees with a posed hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// Intersection over union of the drawn and the observed silhouette, of what is known.
    pub iou: f64,
    /// How much of the boundary the pose leaves unexplained: the mean robust squared distance over the
    /// most that it can be, 0 to 1.
    pub unexplained: f64,
}

impl PoseFitSettings {
    /// Compares one view with a hand in a pose, at the finest level; no fit need have used it.
    ///
    /// # Errors
    /// A parameter out of its range, or a hand that the camera cannot draw.
    pub fn agreement(
        &self,
        hand: &HandShape,
        rest: &DAffine3,
        evidence: &SilhouetteObservation,
        pose: &Pose,
    ) -> Result<Agreement> {
        self.check()?;
        let mut view = ViewMatcher::new(evidence, self.noise)?;
        view.match_boundary(&hand.pose(pose, rest).primitives, evidence, 1, DrawnTerm::Outline)?;
        let scale = evidence.pixels_per_mm(rest.transform_point3(pose.translation()));
        let distances: Vec<f64> =
            view.correspondences.iter().map(|found| scale * found.approach.distance).collect();
        let loss = self.finest();
        let margin = loss.margin(&distances);
        let energy: f64 = distances.iter().map(|distance| loss.energy(distance - margin)).sum();
        Ok(Agreement {
            iou: evidence.iou(view.drawn()),
            unexplained: loss.unexplained(energy, distances.len(), 0.0),
        })
    }

    /// Compares one camera's landmarks with a hand in a pose, at the finest level: how much of them the pose
    /// leaves unexplained, 0 to 1.
    ///
    /// # Errors
    /// A parameter out of its range.
    pub fn landmark_agreement(
        &self,
        hand: &HandShape,
        rest: &DAffine3,
        evidence: &LandmarkObservation,
        pose: &Pose,
    ) -> Result<f64> {
        self.check()?;
        let posed = hand.pose(pose, rest);
        let place = Place::new(evidence.camera(), None, rest.translation);
        Ok(LandmarkResiduals::new(evidence, place, &posed, self.finest()).unexplained)
    }
}
