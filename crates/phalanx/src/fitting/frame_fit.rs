//! One frame: where the hand is, and the pose that explains what all views saw.

use glam::DAffine3;
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_refine::{
    Evidence, LandmarkObservation, Level, PoseFit, PoseFitSettings, PosePrior, Posterior, Screened,
    SilhouetteObservation,
};

use super::misfit;
use super::observation::{self, Sight};
use super::points::{CameraPoints, palm_frames};
use super::starts;
use super::weights::ViewWeights;
use crate::error::Result;
use crate::localize::{BoundingSphere, HandCrop, Placement};

/// Palm directions about the forearm that are tried where none is known: 45° apart, half of which steps
/// make up for.
const TURNS: usize = 8;

/// Of the guesses where a hand may be so many are followed, and of the palm directions of each.
const GUESSES: usize = 2;
const STARTS: usize = 2;

/// Of screened starts so many are fitted fully.
const KEPT: usize = 3;

/// Starts that are this near to each other lead to the same pose, radians.
const SAME: f64 = 0.15;

/// How wide what leaves a picture must be, mm: half as wide as a finger.
const LEAVES: f64 = 8.0;

/// From how far borders pull a start at first, three fingers' radii, and how many steps are taken; places are
/// looked at a finger's radius apart.
const COARSE: Level = Level { reach: 12.0, every: 8, steps: 4 };

/// Many starts take one step first, and the best so many all of them (successive halving, Jamieson and
/// Talwalkar 2016).
const GLANCE: Level = Level { steps: 1, ..COARSE };
const SCREENED: usize = 6;

/// Digits are tried in other postures so often at most: each round may put another digit right.
const ROUNDS: usize = 3;

/// Share of what speaks against a fit that a round must win to be followed by another.
pub(super) const WORTH_ANOTHER: f64 = 0.02;

/// How frames are fitted.
pub(super) struct FrameFitter<'a> {
    pub(super) hand: &'a HandShape,
    pub(super) prior: &'a PosePrior,
    pub(super) refinement: &'a PoseFitSettings,
    /// How much what each view shows counts.
    pub(super) weights: ViewWeights,
}

/// What the views of a frame tell.
pub(super) struct Seen {
    pub(super) silhouettes: Vec<SilhouetteObservation>,
    pub(super) landmarks: Vec<LandmarkObservation>,
}

impl<'a> From<&'a Seen> for Evidence<'a> {
    fn from(seen: &'a Seen) -> Self {
        Self { silhouettes: &seen.silhouettes, landmarks: &seen.landmarks }
    }
}

/// A pose found.
#[derive(Debug, Clone)]
pub(super) struct Found {
    /// The frame of the hand at rest that the pose is in.
    pub(super) rest: DAffine3,
    pub(super) refined: PoseFit,
    /// What each view sees.
    pub(super) crops: Vec<Option<HandCrop>>,
    /// What a detector saw, camera by camera.
    pub(super) points: Vec<Option<CameraPoints>>,
    /// The views that disagree with the others, in this frame or in the whole take, and are left out: the crops, then the
    /// points.
    pub(super) left_out: Vec<bool>,
    /// How far the views together are from agreeing with it.
    pub(super) misfit: f64,
}

impl Found {
    /// A pose without anything seen.
    #[cfg(test)]
    pub(super) fn at(pose: Pose, misfit: f64) -> Self {
        let refined = PoseFit {
            pose,
            covariance: Vec::new(),
            ious: Vec::new(),
            unexplained: Vec::new(),
            landmarks_unexplained: Vec::new(),
            boundary_rms_px: 0.0,
            nuisance_fitted: false,
            energy: 0.0,
            converged: true,
            steps: 0,
        };
        let (crops, points, left_out) = (Vec::new(), Vec::new(), Vec::new());
        Self { rest: DAffine3::IDENTITY, refined, crops, points, left_out, misfit }
    }

    /// The hand's frame: its origin at the wrist, z along the forearm.
    pub(super) fn frame(&self, hand: &HandShape) -> DAffine3 {
        starts::frame_at(&self.refined.pose, &self.rest, hand)
    }

    /// Whether a camera's points are left out.
    pub(super) fn left_out_points(&self, camera: usize) -> bool {
        self.left_out[self.crops.len() + camera]
    }

    /// Of how many cameras something is used.
    pub(super) fn cameras_used(&self) -> usize {
        let is_used = |&camera: &usize| {
            self.crops[camera].is_some() && !self.left_out[camera]
                || self.points[camera].is_some() && !self.left_out_points(camera)
        };
        (0..self.crops.len()).filter(is_used).count()
    }

    /// How far all views are from agreeing with it; those that are left out explain nothing.
    pub(super) fn misfit_of_all_views(&self) -> f64 {
        let none_left_out = vec![false; self.left_out.len()];
        misfit::of_fit(&self.refined, views_used(&self.crops, &self.points, &none_left_out))
    }

    /// The pose in another frame of rest.
    pub(super) fn pose_in(&self, rest: &DAffine3, hand: &HandShape) -> Pose {
        starts::in_frame(&self.refined.pose, &self.rest, rest, hand)
    }
}

/// Where a hand may be, and the poses to begin with.
struct Guess {
    rest: DAffine3,
    starts: Vec<Pose>,
}

/// A guess after a few steps from each of its starts.
struct Screening {
    rest: DAffine3,
    screened: Vec<Screened>,
    crops: Vec<Option<HandCrop>>,
    evidence: Seen,
    views: usize,
    misfit: f64,
}

impl FrameFitter<'_> {
    /// The same with something else known of poses.
    pub(super) fn with_prior<'a>(&'a self, prior: &'a PosePrior) -> FrameFitter<'a> {
        FrameFitter { prior, weights: self.weights.clone(), ..*self }
    }

    /// Looks for a hand with nothing known but what the views saw: at every placement, in every
    /// direction about the forearm; `None` where no view has anything like a hand.
    pub(super) fn search(&self, sight: &Sight) -> Result<Option<Found>> {
        let guess = |placement: &Placement| {
            let turned = (0..TURNS).flat_map(|turn| {
                let mut pose = Pose::REST;
                pose[Dof::ThetaZ] = std::f64::consts::TAU * turn as f64 / TURNS as f64;
                starts::extremes(&pose)
            });
            let rest = starts::frame_of(placement.wrist, placement.arm);
            Guess { rest, starts: turned.collect() }
        };
        self.best_of(sight, self.by_points(sight).chain(sight.placements.iter().map(guess)))
    }

    /// Where the points of two cameras say that the hand is.
    fn by_points(&self, sight: &Sight) -> impl Iterator<Item = Guess> {
        let at = |rest: DAffine3| Guess { rest, starts: starts::extremes(&Pose::REST).to_vec() };
        palm_frames(&sight.points, self.hand.side).into_iter().take(GUESSES).map(at)
    }

    /// Looks for a hand near where hands of other frames are: `frames` are theirs.
    pub(super) fn search_near(&self, sight: &Sight, frames: &[DAffine3]) -> Result<Option<Found>> {
        let at = |rest: DAffine3| Guess { rest, starts: starts::extremes(&Pose::REST).to_vec() };
        let own = sight.placements.iter().take(GUESSES).flat_map(|placement| {
            let turned = frames.iter().map(|frame| starts::turned_to(placement, frame));
            let moved = |frame: &DAffine3| DAffine3 { translation: placement.wrist, ..*frame };
            turned.chain(frames.iter().map(moved))
        });
        let near = own.chain(frames.iter().copied()).map(at);
        self.best_of(sight, self.by_points(sight).chain(near))
    }

    /// The best fit among some guesses.
    fn best_of(
        &self,
        sight: &Sight,
        guesses: impl Iterator<Item = Guess>,
    ) -> Result<Option<Found>> {
        let mut screenings: Vec<Screening> = Vec::new();
        for guess in guesses {
            screenings.extend(self.screened(sight, guess)?);
        }
        screenings.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
        screenings.truncate(GUESSES);
        let mut best: Option<Found> = None;
        for Screening { rest, screened, crops, evidence, views, .. } in screenings {
            let starts = distinct(&screened, STARTS);
            let postures: Vec<Pose> = starts.iter().take(1).flat_map(starts::postures).collect();
            let fits = self.fits(&rest, &evidence, &[starts, postures].concat())?;
            let Some(refined) = fits.into_iter().next() else { continue };
            let misfit = misfit::of_fit(&refined, views);
            if best.as_ref().is_none_or(|best| misfit < best.misfit) {
                let points = sight.points.clone();
                let left_out = self.weights.left_out(points.len());
                best = Some(Found { rest, refined, crops, points, left_out, misfit });
            }
            // A guess that views agree with needs no other beside it.
            if misfit < 1.0 {
                break;
            }
        }
        Ok(best)
    }

    fn screened(&self, sight: &Sight, guess: Guess) -> Result<Option<Screening>> {
        let Guess { rest, starts } = guess;
        let crops = sight.crops(self.ball(&rest));
        let left_out = self.weights.left_out(sight.points.len());
        let evidence = self.seen(&crops, &sight.points, &left_out, &rest);
        if Evidence::from(&evidence).is_empty() {
            return Ok(None);
        }
        let views = views_used(&crops, &sight.points, &left_out);
        let screened = self.screen(&rest, &evidence, &starts)?;
        let Some(first) = screened.first() else { return Ok(None) };
        let misfit = self.misfit(&rest, &evidence, &first.pose, views)?;
        Ok(Some(Screening { rest, screened, crops, evidence, views, misfit }))
    }

    /// How far `views` views together are from agreeing with a pose.
    fn misfit(&self, rest: &DAffine3, evidence: &Seen, pose: &Pose, views: usize) -> Result<f64> {
        let of_view = |seen: &SilhouetteObservation| {
            let agreement = self.refinement.agreement(self.hand, rest, seen, pose)?;
            Ok(misfit::of_view(&agreement))
        };
        let of_points = |seen: &LandmarkObservation| {
            let unexplained = self.refinement.landmark_agreement(self.hand, rest, seen, pose)?;
            Ok(misfit::of_points(unexplained))
        };
        let borders = evidence.silhouettes.iter().map(of_view);
        let points = evidence.landmarks.iter().map(of_points);
        let seen: Vec<f64> = borders.chain(points).collect::<Result<_>>()?;
        Ok(misfit::of_views(&seen, views))
    }

    /// The ball that holds a hand with its wrist and arm as a frame has them.
    pub(super) fn ball(&self, frame: &DAffine3) -> BoundingSphere {
        let length = observation::length_mm(self.hand);
        observation::ball_of(frame.translation, frame.matrix3.z_axis, length)
    }

    /// What the crops and the points of views that are not left out tell of a hand with its wrist and arm as a
    /// frame has them.
    pub(super) fn seen(
        &self,
        crops: &[Option<HandCrop>],
        points: &[Option<CameraPoints>],
        left_out: &[bool],
        frame: &DAffine3,
    ) -> Seen {
        let (crops_out, points_out) = left_out.split_at(crops.len());
        let views = crops.iter().zip(crops_out).zip(&self.weights.borders);
        let used = views.filter(|((_, left_out), _)| !**left_out);
        let silhouettes = used.filter_map(|((crop, _), weight)| {
            Some(self.evidence_of(crop.as_ref()?, frame)?.weighted(*weight))
        });
        let cameras = (0..points.len()).filter(|&camera| !points_out[camera]);
        let landmarks = cameras.filter_map(|camera| self.points_of(points, camera, frame));
        Seen { silhouettes: silhouettes.collect(), landmarks: landmarks.collect() }
    }

    /// What the points of a camera tell.
    pub(super) fn points_of(
        &self,
        points: &[Option<CameraPoints>],
        camera: usize,
        frame: &DAffine3,
    ) -> Option<LandmarkObservation> {
        points[camera].as_ref()?.observation(&self.weights.points[camera], frame)
    }

    /// What a crop tells; `None` of one without a border.
    pub(super) fn evidence_of(
        &self,
        crop: &HandCrop,
        frame: &DAffine3,
    ) -> Option<SilhouetteObservation> {
        let length = observation::length_mm(self.hand);
        let arm = observation::arm_of(frame.translation, frame.matrix3.z_axis, length);
        crop.evidence(&arm).ok()
    }

    /// Whether what a view shows leaves its picture elsewhere than along the arm of the pose.
    pub(super) fn leaves_picture(&self, found: &Found, view: usize) -> bool {
        let frame = found.frame(self.hand);
        let length = observation::length_mm(self.hand);
        let palm = observation::palm_of(frame.translation, frame.matrix3.z_axis, length);
        let Some(crop) = &found.crops[view] else { return false };
        crop.exits.width_ahead_of(&palm) > LEAVES
    }

    /// How well a pose is known by the views that it was fitted to, each of the hand's proportions being known
    /// to a standard deviation; `None` where they leave it open.
    pub(super) fn posterior(&self, found: &Found, hand_std: &[f64]) -> Result<Option<Posterior>> {
        // About the hand's own frame, where no angle is near the edge of its range.
        let frame = found.frame(self.hand);
        let evidence = &self.seen(&found.crops, &found.points, &found.left_out, &frame);
        let own = found.pose_in(&frame, self.hand);
        let posterior =
            self.refinement.posterior(self.hand, &frame, evidence, &own, self.prior, hand_std);
        match posterior {
            Ok(posterior) => Ok(Some(posterior)),
            Err(phalanx_refine::Error::Precision { .. } | phalanx_refine::Error::NoObservation) => {
                Ok(None)
            }
            Err(error) => Err(error.into()),
        }
    }

    /// A pose fitted once more, the arm cut at its wrist and some views left out: from where it is, from
    /// some other poses in its frame of rest, and from other postures of its fingers if asked for. The best of
    /// [`hypotheses`](Self::hypotheses).
    pub(super) fn again(
        &self,
        found: &Found,
        left_out: &[bool],
        others: &[&Found],
        postures: Postures<'_>,
    ) -> Result<Option<Found>> {
        Ok(self.hypotheses(found, left_out, others, postures)?.into_iter().next())
    }

    /// The poses that such a fit's starts lead to, the best first.
    pub(super) fn hypotheses(
        &self,
        found: &Found,
        left_out: &[bool],
        others: &[&Found],
        postures: Postures<'_>,
    ) -> Result<Vec<Found>> {
        let rest = found.frame(self.hand);
        let evidence = self.seen(&found.crops, &found.points, left_out, &rest);
        if Evidence::from(&evidence).is_empty() {
            return Ok(Vec::new());
        }
        let own = found.pose_in(&rest, self.hand);
        let mut starts = vec![own];
        starts.extend(others.iter().map(|other| other.pose_in(&rest, self.hand)));
        match postures {
            Postures::Given => {}
            Postures::Each(poses) => {
                starts.extend(poses.iter().map(|digits| starts::with_digits(&own, digits)));
                starts.extend(starts::each_digit(&own));
                starts.extend(starts::exchanged(&own));
            }
            Postures::All => starts.extend(starts::postures(&own)),
        }
        let used = views_used(&found.crops, &found.points, left_out);
        let hypothesis = |refined: PoseFit| Found {
            rest,
            misfit: misfit::of_fit(&refined, used),
            refined,
            left_out: left_out.to_vec(),
            ..found.clone()
        };
        Ok(self.fits(&rest, &evidence, &starts)?.into_iter().map(hypothesis).collect())
    }

    /// A pose fitted once more with each digit in other postures, as often as that wins something.
    pub(super) fn improved(&self, mut found: Found) -> Result<Found> {
        for _ in 0..ROUNDS {
            let Some(again) = self.again(&found, &found.left_out, &[], Postures::Each(&[]))? else {
                break;
            };
            let won = found.refined.energy - again.refined.energy;
            let is_worth_another = won > WORTH_ANOTHER * found.refined.energy;
            found = again;
            if !is_worth_another {
                break;
            }
        }
        Ok(found)
    }

    /// The fits from some starts, all of which are screened and the best few fitted fully; the best first.
    fn fits(&self, rest: &DAffine3, evidence: &Seen, starts: &[Pose]) -> Result<Vec<PoseFit>> {
        let glanced = self.screen_at(GLANCE, rest, evidence, starts)?;
        let screened = self.screen(rest, evidence, &distinct(&glanced, SCREENED))?;
        let mut fits: Vec<PoseFit> = Vec::new();
        for start in distinct(&screened, KEPT) {
            match self.refinement.fit(self.hand, rest, evidence, &start, self.prior) {
                Ok(refined) => fits.push(refined),
                // One view may leave a pose without a covariance; other poses have one.
                Err(phalanx_refine::Error::Precision { .. }) => {}
                Err(error) => return Err(error.into()),
            }
        }
        fits.sort_by(|a, b| a.energy.total_cmp(&b.energy));
        Ok(fits)
    }

    /// Starts after a few coarse steps, the best first.
    pub(super) fn screen(
        &self,
        rest: &DAffine3,
        evidence: &Seen,
        starts: &[Pose],
    ) -> Result<Vec<Screened>> {
        self.screen_at(COARSE, rest, evidence, starts)
    }

    /// Starts after the steps of a level, the best first.
    fn screen_at(
        &self,
        level: Level,
        rest: &DAffine3,
        evidence: &Seen,
        starts: &[Pose],
    ) -> Result<Vec<Screened>> {
        let mut screened =
            self.refinement.screen(self.hand, rest, evidence, starts, self.prior, level)?;
        screened.sort_by(|a, b| a.energy.total_cmp(&b.energy));
        Ok(screened)
    }
}

/// How many views that are not left out should show the hand: all masks that there are, if any shows it, and
/// all points.
pub(super) fn views_used(
    crops: &[Option<HandCrop>],
    points: &[Option<CameraPoints>],
    left_out: &[bool],
) -> usize {
    let (crops_out, points_out) = left_out.split_at(crops.len());
    let points = points.iter().zip(points_out);
    let with_points = points.filter(|(points, left_out)| points.is_some() && !**left_out).count();
    if with_points > 0 && crops.iter().all(Option::is_none) {
        return with_points;
    }
    crops_out.iter().filter(|left_out| !**left_out).count() + with_points
}

/// Which postures of the fingers a fit starts from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Postures<'a> {
    /// Those that are given.
    Given,
    /// Also with each digit alone in other postures, and with the digits of some poses.
    Each(&'a [Pose]),
    /// Also with every finger straight or folded, in all combinations.
    All,
}

/// The best few poses that differ from each other.
fn distinct(screened: &[Screened], most: usize) -> Vec<Pose> {
    let mut chosen: Vec<Pose> = Vec::new();
    for Screened { pose, .. } in screened {
        let differs = |other: &Pose| {
            let angles = Dof::ALL.iter().filter(|dof| dof.index() < Dof::TX.index());
            angles.into_iter().any(|&dof| (pose[dof] - other[dof]).abs() > SAME)
        };
        if chosen.len() < most && chosen.iter().all(differs) {
            chosen.push(*pose);
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_that_is_left_out_is_not_explained() {
        let found = Found::at(Pose::REST, 0.0);
        let refined = PoseFit { ious: vec![0.95], unexplained: vec![0.02], ..found.refined };
        let of = |left_out: &[bool]| {
            let (crops, left_out) = (vec![None; left_out.len()], left_out.to_vec());
            Found { refined: refined.clone(), crops, left_out, ..Found::at(Pose::REST, 0.0) }
        };
        let [one, two] = [of(&[false]), of(&[false, true])].map(|own| own.misfit_of_all_views());
        assert!(one < 0.2 && two > 1.0, "{one} {two}");
        assert!(two < misfit::of_views(&[], 2));
    }
}
