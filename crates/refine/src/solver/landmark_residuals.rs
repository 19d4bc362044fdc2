//! What landmarks say of a frame: how far each joint is drawn from its point.

use glam::{DVec2, DVec3};
use phalanx_hand::{Bone, JOINTS, PosedHand};

use crate::observation::landmarks::{LandmarkObservation, Projection};
use crate::solver::jacobian::{Place, Rows};
use crate::solver::loss::RobustLoss;
use crate::solver::normal_equations::NormalEquations;

/// A point that was seen and its joint as it is drawn.
struct Drawn {
    joint: usize,
    /// How far the joint is from the point, px.
    offset: DVec2,
    slopes: [DVec3; 2],
    confidence: f64,
}

/// The points of one view beside a posed hand.
pub(crate) struct LandmarkResiduals<'a> {
    place: Place<'a>,
    seen: &'a LandmarkObservation,
    loss: RobustLoss,
    drawn: Vec<Drawn>,
    /// The robust squared distances, and the share of the most that they can be.
    energy: f64,
    pub(crate) unexplained: f64,
}

/// Which unknowns a view's rows have besides those of the pose.
pub(crate) struct Slots<'a> {
    /// Where the numbers of the camera's place begin among the frame's own unknowns, or the shared ones.
    pub(crate) own_place: Option<usize>,
    pub(crate) shared_place: Option<usize>,
    /// How the joints move with each of the hand's proportions.
    pub(crate) shape: Option<&'a [[DVec3; JOINTS]]>,
}

impl<'a> LandmarkResiduals<'a> {
    /// Of a view whose camera stands at `place`. A joint that cannot be drawn is as far off as can be.
    pub(crate) fn new(
        seen: &'a LandmarkObservation,
        place: Place<'a>,
        posed: &PosedHand,
        loss: RobustLoss,
    ) -> Self {
        let loss = loss.of_landmarks(seen.std());
        let (mut drawn, mut energy, mut most) = (Vec::with_capacity(JOINTS), 0.0, 0.0);
        for (joint, point) in seen.points().iter().enumerate() {
            let Some(point) = point else { continue };
            most += point.confidence * loss.most();
            let Some(projection) = Projection::of(seen.camera(), place.moved(posed.joints[joint]))
            else {
                energy += point.confidence * loss.most();
                continue;
            };
            let offset = projection.at - point.at;
            energy += point.confidence * loss.energy(offset.length());
            let (slopes, confidence) = (projection.slopes, point.confidence);
            drawn.push(Drawn { joint, offset, slopes, confidence });
        }
        let unexplained = if most > 0.0 { energy / most } else { 0.0 };
        Self { place, seen, loss, drawn, energy, unexplained }
    }

    /// Adds them to the normal equations of a frame in which there are `views` views.
    pub(crate) fn add_to(
        &self,
        system: &mut NormalEquations,
        posed: &PosedHand,
        views: usize,
        slots: &Slots<'_>,
        rows: &mut Rows,
    ) {
        let [of_energy, of_slope] =
            self.loss.belief(self.unexplained, views).map(|share| share * self.seen.weight());
        system.add_landmarks(of_energy * self.energy, self.unexplained);
        for Drawn { joint, offset, slopes, confidence } in &self.drawn {
            let bones = [Bone::of_joint(*joint); 3];
            let weight = of_slope * confidence * self.loss.weight(offset.length());
            for (residual, slope) in offset.to_array().into_iter().zip(slopes) {
                let contact = self.place.joint(&bones, posed.joints[*joint], *slope);
                rows.clear();
                rows.of_pose(&contact);
                if let Some(first) = slots.own_place {
                    rows.own.extend(self.place.row(&contact, first));
                }
                if let Some(shape) = slots.shape {
                    rows.of_joint(&contact, shape, *joint);
                }
                if let Some(first) = slots.shared_place {
                    rows.shared.extend(self.place.row(&contact, first));
                }
                // The energy of both axes is one and was added.
                system.add(residual, 0.0, weight, &rows.own, &rows.shared);
            }
        }
    }
}
