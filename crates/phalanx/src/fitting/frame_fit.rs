//! One frame: where the hand is, and the pose that explains what all views saw.

use glam::DAffine3;
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_refine::{
    Evidence, LandmarkObservation, Level, PoseFit, PoseFitSettings, PosePrior, Posterior, Screened,
    SilhouetteObservation,
};

use super::found::{Found, views_used};
use super::misfit;
use super::observation;
use super::points::CameraPoints;
use super::starts;
use super::weights::ViewWeights;
use crate::error::Result;
use crate::localize::{BoundingSphere, HandCrop};

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

impl FrameFitter<'_> {
    /// The same with something else known of poses.
    pub(super) fn with_prior<'a>(&'a self, prior: &'a PosePrior) -> FrameFitter<'a> {
        FrameFitter { prior, weights: self.weights.clone(), ..*self }
    }

    /// The ball that holds a hand with its wrist and arm as a frame has them.
    pub(super) fn ball(&self, frame: &DAffine3) -> BoundingSphere {
        let length = self.hand.length_mm();
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
        let used = crops.iter().zip(left_out).map(|(crop, left_out)| match left_out {
            true => None,
            false => self.evidence_of(crop.as_ref()?, frame),
        });
        self.used(used.collect(), points, left_out, frame)
    }

    /// The same of what the crops tell.
    pub(super) fn used(
        &self,
        silhouettes: Vec<Option<SilhouetteObservation>>,
        points: &[Option<CameraPoints>],
        left_out: &[bool],
        frame: &DAffine3,
    ) -> Seen {
        let (crops_out, points_out) = left_out.split_at(silhouettes.len());
        let views = silhouettes.into_iter().zip(crops_out).zip(&self.weights.borders);
        let used = views.filter(|((_, left_out), _)| !**left_out);
        let silhouettes = used.filter_map(|((seen, _), weight)| Some(seen?.weighted(*weight)));
        let cameras = (0..points.len()).filter(|&camera| !points_out[camera]);
        let landmarks = cameras.filter_map(|camera| self.points_of(points, camera, frame));
        Seen { silhouettes: silhouettes.collect(), landmarks: landmarks.collect() }
    }

    /// What each view of a frame shows of its hand, also of those that are left out; `None` of one without a border.
    pub(super) fn silhouettes(&self, found: &Found) -> Vec<Option<SilhouetteObservation>> {
        self.silhouettes_of(&found.crops, &found.frame(self.hand))
    }

    /// What each crop shows of a hand with its wrist and arm as a frame has them.
    pub(super) fn silhouettes_of(
        &self,
        crops: &[Option<HandCrop>],
        frame: &DAffine3,
    ) -> Vec<Option<SilhouetteObservation>> {
        crops.iter().map(|crop| self.evidence_of(crop.as_ref()?, frame)).collect()
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
        let length = self.hand.length_mm();
        let arm = observation::arm_of(frame.translation, frame.matrix3.z_axis, length);
        crop.evidence(&arm).ok()
    }

    /// Whether what a view shows leaves its picture elsewhere than along the arm of the pose.
    pub(super) fn leaves_picture(&self, found: &Found, view: usize) -> bool {
        let frame = found.frame(self.hand);
        let length = self.hand.length_mm();
        let palm = observation::palm_of(frame.translation, frame.matrix3.z_axis, length);
        let Some(crop) = &found.crops[view] else { return false };
        crop.exits.width_ahead_of(&palm) > LEAVES
    }

    /// Whether that is so of a view that was used.
    pub(super) fn is_cut_off(&self, found: &Found) -> bool {
        let is_used = |view: &usize| found.crops[*view].is_some() && !found.left_out[*view];
        let mut used = (0..found.crops.len()).filter(is_used);
        used.any(|view| self.leaves_picture(found, view))
    }

    /// How well a pose is known by the views that it was fitted to, which show these
    /// [`silhouettes`](Self::silhouettes), each of the hand's proportions being known to a standard deviation; `None` where
    /// they leave it open.
    pub(super) fn posterior(
        &self,
        found: &Found,
        silhouettes: Vec<Option<SilhouetteObservation>>,
        hand_std: &[f64],
    ) -> Result<Option<Posterior>> {
        // About the hand's own frame, where no angle is near the edge of its range.
        let frame = found.frame(self.hand);
        let evidence = &self.used(silhouettes, &found.points, &found.left_out, &frame);
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
        let used = views_used(&found.crops, &found.points, left_out);
        let own = found.pose_in(&rest, self.hand);
        let mut starts = vec![own];
        starts.extend(others.iter().map(|other| other.pose_in(&rest, self.hand)));
        match postures {
            Postures::Given => {}
            Postures::Each(poses) => {
                starts.extend(poses.iter().map(|digits| starts::with_digits(&own, digits)));
                starts.extend(starts::each_digit(&own));
                // One view hardly tells fingers from each other: any of several orders fits it.
                if used > 1 {
                    starts.extend(starts::exchanged(&own));
                }
            }
            Postures::All => starts.extend(starts::postures(&own)),
        }
        let hypothesis = |refined: PoseFit| Found {
            rest,
            misfit: misfit::of_fit(&refined, used) + found.backwards,
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
    pub(super) fn fits(
        &self,
        rest: &DAffine3,
        evidence: &Seen,
        starts: &[Pose],
    ) -> Result<Vec<PoseFit>> {
        let screened = self.screen_few(rest, evidence, starts)?;
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

    /// Of many starts the few that are best after one step, after some more, the best first.
    pub(super) fn screen_few(
        &self,
        rest: &DAffine3,
        evidence: &Seen,
        starts: &[Pose],
    ) -> Result<Vec<Screened>> {
        let glanced = self.screen_at(GLANCE, rest, evidence, starts)?;
        self.screen(rest, evidence, &distinct(&glanced, SCREENED))
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
pub(super) fn distinct(screened: &[Screened], most: usize) -> Vec<Pose> {
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
