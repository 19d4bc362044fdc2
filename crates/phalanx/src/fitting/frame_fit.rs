//! One frame: where the hand is, and the pose that explains what all views saw.

use glam::DAffine3;
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_refine::{Level, PoseFit, PoseFitSettings, PosePrior, Screened, SilhouetteObservation};

use super::consensus::DISAGREEMENT;
use super::observation::{self, Sight};
use super::starts;
use crate::Result;
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

/// From how far borders pull a start at first, three fingers' radii, and how many steps are taken.
const COARSE: Level = Level { reach: 12.0, every: 4, steps: 4 };

/// How frames are fitted.
pub(super) struct FrameFitter<'a> {
    pub(super) hand: &'a HandShape,
    pub(super) prior: &'a PosePrior,
    pub(super) refinement: &'a PoseFitSettings,
    /// How much a place of each view's border counts.
    pub(super) weights: Vec<f64>,
}

/// A pose found.
#[derive(Clone)]
pub(super) struct Found {
    /// The frame of the hand at rest that the pose is in.
    pub(super) rest: DAffine3,
    pub(super) refined: PoseFit,
    /// What each view sees.
    pub(super) crops: Vec<Option<HandCrop>>,
    /// The views that disagree with the others and are left out.
    pub(super) left_out: Vec<bool>,
    /// How much of what the views saw is left unexplained, 0 to ½.
    pub(super) unexplained: f64,
}

impl Found {
    /// The hand's frame: its origin at the wrist, z along the forearm.
    pub(super) fn frame(&self, hand: &HandShape) -> DAffine3 {
        starts::frame_at(&self.refined.pose, &self.rest, hand)
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
    evidence: Vec<SilhouetteObservation>,
    unexplained: f64,
}

impl FrameFitter<'_> {
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
        self.best_of(sight, sight.placements.iter().map(guess))
    }

    /// Looks for a hand near where hands of other frames are: `frames` are theirs.
    pub(super) fn search_near(&self, sight: &Sight, frames: &[DAffine3]) -> Result<Option<Found>> {
        let at = |rest: DAffine3| Guess { rest, starts: starts::extremes(&Pose::REST).to_vec() };
        let own = sight.placements.iter().take(GUESSES).flat_map(|placement| {
            let turned = frames.iter().map(|frame| starts::turned_to(placement, frame));
            let moved = |frame: &DAffine3| DAffine3 { translation: placement.wrist, ..*frame };
            turned.chain(frames.iter().map(moved))
        });
        self.best_of(sight, own.chain(frames.iter().copied()).map(at))
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
        screenings.sort_by(|a, b| a.unexplained.total_cmp(&b.unexplained));
        screenings.truncate(GUESSES);
        let mut best: Option<Found> = None;
        for Screening { rest, screened, crops, evidence, .. } in screenings {
            let starts = distinct(&screened, STARTS);
            let postures: Vec<Pose> = starts.iter().flat_map(starts::postures).collect();
            let Some(refined) = self.fit(&rest, &evidence, &[starts, postures].concat())? else {
                continue;
            };
            let unexplained = mean_unexplained(&refined.unexplained, crops.len());
            if best.as_ref().is_none_or(|best| unexplained < best.unexplained) {
                let left_out = vec![false; crops.len()];
                best = Some(Found { rest, refined, crops, left_out, unexplained });
            }
        }
        Ok(best)
    }

    fn screened(&self, sight: &Sight, guess: Guess) -> Result<Option<Screening>> {
        let Guess { rest, starts } = guess;
        let crops = sight.crops(self.ball(&rest));
        let evidence = self.evidence(&crops, &vec![false; crops.len()], &rest);
        if evidence.is_empty() {
            return Ok(None);
        }
        let screened = self.screen(&rest, &evidence, &starts)?;
        let Some(first) = screened.first() else { return Ok(None) };
        let unexplained = mean_unexplained(&first.unexplained, crops.len());
        Ok(Some(Screening { rest, screened, crops, evidence, unexplained }))
    }

    /// The ball that holds a hand with its wrist and arm as a frame has them.
    fn ball(&self, frame: &DAffine3) -> BoundingSphere {
        let length = observation::length_mm(self.hand);
        observation::ball_of(frame.translation, frame.matrix3.z_axis, length)
    }

    /// What the crops of views that are not left out tell of a hand with its wrist and arm as a frame has
    /// them.
    pub(super) fn evidence(
        &self,
        crops: &[Option<HandCrop>],
        left_out: &[bool],
        frame: &DAffine3,
    ) -> Vec<SilhouetteObservation> {
        let views = crops.iter().zip(left_out).zip(&self.weights);
        let used = views.filter(|((_, left_out), _)| !**left_out);
        used.filter_map(|((crop, _), weight)| {
            Some(self.evidence_of(crop.as_ref()?, frame)?.weighted(*weight))
        })
        .collect()
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

    /// A pose fitted once more, the arm cut at its wrist and some views left out: from where it is, from
    /// some other poses in its frame of rest, and from other postures of its fingers if asked for.
    pub(super) fn again(
        &self,
        found: &Found,
        left_out: &[bool],
        others: &[&Found],
        postures: Postures,
    ) -> Result<Option<Found>> {
        let rest = found.frame(self.hand);
        let evidence = self.evidence(&found.crops, left_out, &rest);
        if evidence.is_empty() {
            return Ok(None);
        }
        let own = found.pose_in(&rest, self.hand);
        let mut starts = vec![own];
        starts.extend(others.iter().map(|other| other.pose_in(&rest, self.hand)));
        if postures == Postures::All {
            starts.extend(starts::postures(&own));
        }
        let Some(refined) = self.fit(&rest, &evidence, &starts)? else { return Ok(None) };
        let used = left_out.iter().filter(|left_out| !**left_out).count();
        let unexplained = mean_unexplained(&refined.unexplained, used);
        let (crops, left_out) = (found.crops.clone(), left_out.to_vec());
        Ok(Some(Found { rest, refined, crops, left_out, unexplained }))
    }

    /// The best fit from some starts, all of which are screened and the best few fitted fully.
    fn fit(
        &self,
        rest: &DAffine3,
        evidence: &[SilhouetteObservation],
        starts: &[Pose],
    ) -> Result<Option<PoseFit>> {
        let screened = self.screen(rest, evidence, starts)?;
        let mut best: Option<PoseFit> = None;
        for start in distinct(&screened, KEPT) {
            let refined = match self.refinement.fit(self.hand, rest, evidence, &start, self.prior) {
                Ok(refined) => refined,
                // One view may leave a pose without a covariance; other poses have one.
                Err(phalanx_refine::Error::Precision { .. }) => continue,
                Err(error) => return Err(error.into()),
            };
            if best.as_ref().is_none_or(|best| refined.energy < best.energy) {
                best = Some(refined);
            }
        }
        Ok(best)
    }

    /// Starts after a few coarse steps, the best first.
    fn screen(
        &self,
        rest: &DAffine3,
        evidence: &[SilhouetteObservation],
        starts: &[Pose],
    ) -> Result<Vec<Screened>> {
        let mut screened =
            self.refinement.screen(self.hand, rest, evidence, starts, self.prior, COARSE)?;
        screened.sort_by(|a, b| a.energy.total_cmp(&b.energy));
        Ok(screened)
    }
}

/// Which postures of the fingers a fit starts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Postures {
    /// Those that are given.
    Given,
    /// Also every finger straight or folded, in all combinations.
    All,
}

/// How much of what some views saw is left unexplained, each view counting less the less it agrees; one
/// without a border explains nothing.
fn mean_unexplained(unexplained: &[f64], views: usize) -> f64 {
    let limit = if views > 2 { DISAGREEMENT } else { f64::INFINITY };
    let robust = |share: f64| share / (1.0 + share / limit);
    let seen: f64 = unexplained.iter().map(|&share| robust(share)).sum();
    (seen + (views - unexplained.len()) as f64 * robust(1.0)) / views.max(1) as f64
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
