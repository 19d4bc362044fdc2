//! How far the hand of a take moves along the line of sight of its only camera, of which silhouettes tell little: as far
//! as it moves across.

use glam::{DAffine3, DQuat, DVec3};
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_refine::PosePrior;

use super::found::Found;
use super::motion::{mean, unlikely};
use super::times::Times;
use crate::error::Result;

/// How a hand moves before one camera, along any axis and about any.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LineOfSight {
    /// Where it is on average, mm in the world.
    middle: DVec3,
    /// Variance of how far it is from there along an axis, mm².
    spread: f64,
    /// Mean squares of how far it moves along an axis, mm², and turns about one, radians², in the usual time from one
    /// frame to the next.
    way: f64,
    turn: f64,
}

/// What the fits of two frames of a still hand differ by, mm and radians: one camera tells its distance to some per cent,
/// and how it is turned to some ten degrees. Choices.
const LEAST_WAY: f64 = 20.0;
const LEAST_TURN: f64 = 0.2;

const PLACE: [Dof; 3] = [Dof::TX, Dof::TY, Dof::TZ];
const TURN: [Dof; 3] = [Dof::ThetaX, Dof::ThetaY, Dof::ThetaZ];

impl LineOfSight {
    /// Of what was found in a take; `None` of several cameras, or where no frame follows another.
    pub(super) fn of(found: &[Option<Found>], times: &Times, hand: &HandShape) -> Option<Self> {
        let camera = found.iter().flatten().next()?.only_camera()?.centre();
        let frame = |found: &Option<Found>| Some(found.as_ref()?.frame(hand));
        Self::of_frames(&found.iter().map(frame).collect::<Vec<_>>(), camera, times)
    }

    /// Of the frames of hands before a camera. Only directions from the camera are compared: they do not depend on how far
    /// away each hand is taken to be.
    fn of_frames(frames: &[Option<DAffine3>], camera: DVec3, times: &Times) -> Option<Self> {
        let direction = |frame: &DAffine3| (frame.translation - camera).normalize_or_zero();
        let seen: Vec<&DAffine3> = frames.iter().flatten().collect();
        let distance = |frame: &&DAffine3| frame.translation.distance(camera);
        let mut distances: Vec<f64> = seen.iter().map(distance).collect();
        distances.sort_by(f64::total_cmp);
        let distance = *distances.get(distances.len() / 2)?;
        let ahead = seen.iter().copied().map(direction).sum::<DVec3>().normalize_or_zero();
        // Across there are two axes.
        let across = |one: DVec3, other: DVec3| (distance * one.distance(other)).powi(2) / 2.0;
        let spread = mean(seen.iter().map(|frame| across(direction(frame), ahead)))?;
        let pairs = || {
            let pair = |k: usize| Some((frames[k - 1]?, frames[k]?, times.between(k - 1, k)));
            (1..frames.len()).filter_map(pair)
        };
        let way = mean(pairs().map(|(a, b, steps)| across(direction(&a), direction(&b)) / steps))?;
        let rolled = |a: &DAffine3, b: &DAffine3| turn(a, b).dot(direction(a)).powi(2);
        let turn = mean(pairs().map(|(a, b, steps)| rolled(&a, &b) / steps))?;
        Some(Self {
            middle: camera + ahead * distance,
            spread: spread.max(LEAST_WAY.powi(2)),
            way: way.max(LEAST_WAY.powi(2)),
            turn: turn.max(LEAST_TURN.powi(2)),
        })
    }

    /// Variances of how far a hand is from where it was so many usual steps away along an axis, mm², and of how far it is
    /// turned about one, radians²; infinite where a frame is no nearer than any is, as of joints
    /// ([`Motion::known`](super::motion::Motion)).
    fn variances(&self, steps: f64) -> [f64; 2] {
        let told = (self.way * steps).recip() - (2.0 * self.spread).recip();
        [told.max(0.0).recip(), self.turn * steps]
    }

    /// What speaks against one hand so many steps after another, as of joints
    /// ([`Motion::against`](super::motion::Motion::against)).
    pub(super) fn against(&self, one: &DAffine3, other: &DAffine3, steps: f64) -> f64 {
        let [way, turned] = self.variances(steps);
        let moved = (other.translation - one.translation).to_array().map(|x| x * x / way);
        let turned = turn(one, other).to_array().map(|x| x * x / turned);
        moved.into_iter().chain(turned).map(unlikely).sum()
    }

    /// What is known of where a hand is, said in a frame of rest that it is near, also beside those of other frames, each with
    /// how many steps it is away.
    pub(super) fn beside(
        &self,
        prior: &PosePrior,
        rest: &DAffine3,
        others: &[(f64, &Found)],
        hand: &HandShape,
    ) -> Result<PosePrior> {
        let known = |place: f64, turn: f64| {
            let mut known = [f64::INFINITY; Dof::COUNT];
            for (place_dof, turn_dof) in PLACE.into_iter().zip(TURN) {
                known[place_dof.index()] = place.sqrt();
                known[turn_dof.index()] = turn.sqrt();
            }
            known
        };
        let mut middle = Pose::REST;
        let at = rest.inverse().transform_point3(self.middle).to_array();
        for (dof, at) in PLACE.into_iter().zip(at) {
            middle[dof] = at;
        }
        let of_take = PosePrior::independent(middle, &known(self.spread, f64::INFINITY))?;
        others.iter().try_fold(prior.product(&of_take)?, |prior, (steps, other)| {
            let [way, turn] = self.variances(*steps);
            let beside = PosePrior::independent(other.pose_in(rest, hand), &known(way, turn))?;
            Ok(prior.product(&beside)?)
        })
    }
}

/// The turn from one frame to another: its axis, as long as its angle in radians.
fn turn(one: &DAffine3, other: &DAffine3) -> DVec3 {
    DQuat::from_mat3(&(other.matrix3 * one.matrix3.transpose())).to_scaled_axis()
}

#[cfg(test)]
mod tests {
    use glam::DMat3;

    use super::*;

    const CAMERA: DVec3 = DVec3::new(0.0, 0.0, -600.0);

    /// A hand that goes to and fro across the view and turns in the picture, each frame at a distance of its own.
    fn frames(across: f64, distance: impl Fn(usize) -> f64) -> Vec<Option<DAffine3>> {
        let frame = |k: usize| {
            let to_and_fro = (0.7 * k as f64).sin();
            let at = DVec3::new(across * to_and_fro, 0.0, 600.0) / 600.0;
            let turn = DMat3::from_rotation_z(0.4 * to_and_fro);
            Some(DAffine3::from_mat3_translation(turn, CAMERA + at * distance(k)))
        };
        (0..40).map(frame).collect()
    }

    fn of(frames: &[Option<DAffine3>]) -> LineOfSight {
        LineOfSight::of_frames(frames, CAMERA, &Times::even(frames.len())).unwrap()
    }

    #[test]
    fn how_far_a_hand_moves_is_seen_across() {
        let (still, moving) = (of(&frames(0.0, |_| 600.0)), of(&frames(120.0, |_| 600.0)));
        assert_eq!([still.spread, still.way], [LEAST_WAY.powi(2); 2]);
        // A sine's variance is half its square; two axes share it.
        let expected = 120.0 * 120.0 / 4.0;
        assert!((moving.spread / expected - 1.0).abs() < 0.1, "{moving:?}");
        // Wrong distances make no other motion.
        let wrong = of(&frames(120.0, |k| if k % 4 == 0 { 350.0 } else { 600.0 }));
        assert!((wrong.spread / moving.spread - 1.0).abs() < 0.1, "{wrong:?}");
        assert!((wrong.way / moving.way - 1.0).abs() < 0.1, "{wrong:?}");
        assert!(wrong.middle.distance(moving.middle) < 10.0, "{wrong:?}");
    }

    #[test]
    fn a_hand_that_jumps_along_the_line_of_sight_is_less_likely() {
        let all = frames(60.0, |_| 600.0);
        let line = of(&all);
        let [one, next] = [all[10], all[11]].map(Option::unwrap);
        let jump = |by: f64| DAffine3 { translation: next.translation + DVec3::Z * by, ..next };
        let against = |other: &DAffine3| line.against(&one, other, 1.0);
        assert!(against(&next) < against(&jump(60.0)));
        assert!(against(&jump(60.0)) < against(&jump(-150.0)));
        // Half turned: palm for back.
        let turned = DAffine3 { matrix3: next.matrix3 * DMat3::from_rotation_y(3.0), ..next };
        assert!(against(&jump(60.0)) < against(&turned));
    }

    #[test]
    fn a_frame_tells_where_the_next_is() {
        let (all, hand) = (frames(60.0, |_| 600.0), HandShape::adult());
        let line = of(&all);
        let rest = all[11].unwrap();
        let prior = super::super::starts::pose_prior().unwrap();
        let alone = line.beside(&prior, &rest, &[], &hand).unwrap();
        let before = Found { rest: all[10].unwrap(), ..Found::at(Pose::REST, 0.0) };
        let beside = line.beside(&prior, &rest, &[(1.0, &before)], &hand).unwrap();
        for dof in PLACE {
            assert!((alone.deviation(dof) / line.spread.sqrt() - 1.0).abs() < 0.01);
        }
        assert!(beside.deviation(Dof::TZ) < alone.deviation(Dof::TZ));
        assert!(beside.deviation(Dof::ThetaX) < alone.deviation(Dof::ThetaX));
        assert_eq!(beside.deviation(Dof::IndexPip), prior.deviation(Dof::IndexPip));
    }
}
