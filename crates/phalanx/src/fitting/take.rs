//! Whole takes: the hand first, then all frames, each in the light of its neighbours.

use glam::DAffine3;
use phalanx_camera::{Camera, Volume};
use phalanx_hand::HandShape;
use phalanx_refine::{PoseFitSettings, PosePrior};
use rayon::prelude::*;

use super::consensus::{self, VolumeEstimate};
use super::found::Found;
use super::frame_fit::{FrameFitter, WORTH_ANOTHER};
use super::knowledge::ViewKnowledge;
use super::known::Known;
use super::misfit;
use super::mistake::{self, Asked};
use super::observation::fitted_hand;
use super::passes;
use super::proportions::{self, HandEvidence, KnownHand};
use super::report::{FrameFit, Reporter};
use super::size;
use super::starts;
use super::take_frame::TakeFrame;
use super::times::Times;
use super::views;
use super::weights::ViewWeights;
use super::wrong_view;
use crate::error::{Error, Result};
use crate::progress::Progress;

/// How takes are fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct TakeSettings {
    /// The hand, which may be a mean one, and its side.
    pub hand: HandShape,
    /// Whether the hand is that person's.
    pub proportions: Proportions,
}

/// Where a hand's proportions come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Proportions {
    /// They are fitted to the take, and kept if those fitted to half of it fit the other half better.
    FromTake,
    /// They are given.
    Given,
}

impl Default for TakeSettings {
    /// A right hand like any other.
    fn default() -> Self {
        Self { hand: HandShape::adult(), proportions: Proportions::FromTake }
    }
}

/// A fitted take.
#[derive(Debug, Clone)]
pub struct TakeFit {
    /// The person's hand.
    pub hand: HandShape,
    /// Where it works; poses are said in [`Volume::rest_frame`].
    pub volume: VolumeEstimate,
    /// Frame by frame.
    pub frames: Vec<FrameFit>,
    pub(super) known: Known,
    tells_side: bool,
}

impl TakeFit {
    /// Whether the take told the hand's proportions. Else they are those of the hand that was given, all larger or smaller
    /// by one factor where the take told its size.
    pub fn is_hand_learnt(&self) -> bool {
        self.known.hand.is_learnt()
    }

    /// Whether the take tells the hand's side. Else a hand of the other side explains it about as well, or two cameras saw it in
    /// too few frames to ask.
    pub fn tells_side(&self) -> bool {
        self.tells_side
    }
}

/// How often the hand is learnt at most, each time from frames fitted with it as it was before: a finger that was
/// taken for another finds its place with a hand that fits.
const ROUNDS: usize = 4;

/// Fits a whole take: where the hand works, its proportions, and its pose in every frame.
///
/// Frames are in the order of time, and may be further apart in some places than in others where they say when they
/// were ([`TakeFrame::at`]); without times they follow each other at one pace. Nothing else is needed; the same
/// frames give the same fit, at any number of threads. If the hand seems to be of the other side, or two cameras to have
/// each other's pictures, every frame is doubted.
///
/// # Errors
/// Frames with another number of masks or landmarks than cameras or not in the order of time, or no frame in which
/// any camera sees a hand: landmarks alone need two cameras.
pub fn fit_take(
    cameras: &[Camera],
    frames: &[TakeFrame],
    settings: &TakeSettings,
    progress: &dyn Progress,
) -> Result<TakeFit> {
    let (prior, refinement) = (starts::pose_prior()?, consensus::searching(cameras.len()));
    let believing = consensus::believing();
    let times = &Times::of(frames)?;
    let take = Take::of((cameras, times), &settings.hand, &prior, &refinement);
    let keys = consensus::key_frames(cameras, frames, &take.fitter(Weights::Relative), progress)?;
    let mut best: Option<Around<'_>> = None;
    let places: Vec<DAffine3> = keys.iter().map(|key| key.frame(&take.hand.shape)).collect();
    for middle in consensus::agreed(&places, &take.hand.shape)? {
        let around =
            take.clone().around(middle, frames, settings.proportions, &believing, progress)?;
        if best.as_ref().is_none_or(|best| around.misfit() < best.misfit()) {
            best = Some(around);
        }
    }
    let Around { take, middle, found } = best.ok_or(Error::NoHand)?;
    let volume = VolumeEstimate::around(&middle, found.iter().flatten(), &take.hand.shape);
    let searching = FrameFitter { refinement: &refinement, ..take.fitter(Weights::Relative) };
    let Asked { mistake, tells_side } =
        mistake::of_take(&searching, cameras, frames, &found, progress)?;
    let known = Known { hand: take.hand.clone(), weights: take.weights.clone(), mistake };
    let frames = take.reports(&found, &known, &volume.volume)?;
    let forearm = settings.hand.forearm.clone();
    let hand = HandShape { forearm, ..take.hand.shape.clone() };
    Ok(TakeFit { hand, volume, frames, known, tells_side })
}

/// A take that is being fitted.
#[derive(Clone)]
struct Take<'a> {
    cameras: &'a [Camera],
    times: &'a Times,
    prior: &'a PosePrior,
    refinement: &'a PoseFitSettings,
    mean: HandShape,
    hand: KnownHand,
    weights: ViewWeights,
    /// Which share of the variance of what views show is the same in every frame.
    persistent: f64,
}

/// A take whose frames were fitted around where its hand may be.
struct Around<'a> {
    take: Take<'a>,
    middle: DAffine3,
    found: Vec<Option<Found>>,
}

impl Around<'_> {
    /// How far its views are from agreeing with its frames, in all; a frame without a hand explains nothing.
    fn misfit(&self) -> f64 {
        let of_nothing = misfit::of_views(&[], self.take.cameras.len());
        let of_frame =
            |found: &Option<Found>| found.as_ref().map_or(of_nothing, Found::misfit_of_all_views);
        self.found.iter().map(of_frame).sum()
    }
}

/// Which weights views are fitted with.
#[derive(Clone, Copy)]
enum Weights {
    /// As their borders are known.
    Absolute,
    /// The same beside the best view's.
    Relative,
}

impl<'a> Take<'a> {
    fn of(
        (cameras, times): (&'a [Camera], &'a Times),
        hand: &HandShape,
        prior: &'a PosePrior,
        refinement: &'a PoseFitSettings,
    ) -> Self {
        let mean = fitted_hand(hand);
        let hand = KnownHand::anyone(&mean);
        let weights = ViewWeights::unknown(cameras.len());
        Self { cameras, times, prior, refinement, mean, hand, weights, persistent: 0.0 }
    }

    fn fitter(&self, weights: Weights) -> FrameFitter<'_> {
        let weights = match weights {
            Weights::Absolute => self.weights.clone(),
            Weights::Relative => self.weights.relative(),
        };
        let Self { prior, refinement, hand, .. } = self;
        FrameFitter { hand: &hand.shape, prior, refinement, weights }
    }

    /// Fits the hand and all frames, which are first looked for near a place.
    fn around(
        mut self,
        middle: DAffine3,
        frames: &[TakeFrame],
        proportions: Proportions,
        believing: &'a PoseFitSettings,
        progress: &dyn Progress,
    ) -> Result<Around<'a>> {
        let thought = self.clone();
        let mut found = self.found_near(frames, &middle, proportions, progress)?;
        while let Some(view) =
            wrong_view::of_take(&self.fitter(Weights::Relative), &found, progress)?
        {
            let mut weights = self.weights.clone();
            weights.wrong[view] = true;
            // A wrong view may have told another size.
            self = Take { weights, ..thought.clone() };
            found = self.found_near(frames, &middle, proportions, progress)?;
        }
        let found = self.agreeing(&found, progress)?;
        let fitter = self.fitter(Weights::Relative);
        let found = passes::recovered(self.cameras, frames, &fitter, &found, progress)?;
        self.refinement = believing;
        self.weigh(&found)?;
        let found = self.in_rounds(found, proportions, &middle, progress)?;
        let found = self.agreeing(&found, progress)?;
        self.weigh(&found)?;
        Ok(Around { take: self, middle, found })
    }

    /// All frames, looked for near a place with a hand of about that person's size.
    fn found_near(
        &mut self,
        frames: &[TakeFrame],
        place: &DAffine3,
        proportions: Proportions,
        progress: &dyn Progress,
    ) -> Result<Vec<Option<Found>>> {
        if proportions == Proportions::FromTake {
            self.find_size(frames, place, progress)?;
        }
        let fitter = self.fitter(Weights::Relative);
        let found = passes::first(self.cameras, frames, &fitter, &[*place], progress)?;
        passes::again(&fitter, &found, self.times, progress)
    }

    /// All frames without the views that contradict the others.
    fn agreeing(
        &mut self,
        found: &[Option<Found>],
        progress: &dyn Progress,
    ) -> Result<Vec<Option<Found>>> {
        self.weights.limits = views::limits(&self.fitter(Weights::Relative), found)?;
        passes::agreeing(&self.fitter(Weights::Relative), found, progress)
    }

    /// Finds out roughly how large the hand is, near a place.
    fn find_size(
        &mut self,
        frames: &[TakeFrame],
        place: &DAffine3,
        progress: &dyn Progress,
    ) -> Result<()> {
        let fitter = self.fitter(Weights::Relative);
        if let Some(size) = size::of_hand(&fitter, self.cameras, frames, place, progress)? {
            self.mean = self.mean.scaled(|| size);
            self.hand = KnownHand::anyone(&self.mean);
        }
        Ok(())
    }

    /// Learns the hand and fits the frames with it in turn, for as long as views agree better with each round.
    fn in_rounds(
        &mut self,
        mut found: Vec<Option<Found>>,
        proportions: Proportions,
        place: &DAffine3,
        progress: &dyn Progress,
    ) -> Result<Vec<Option<Found>>> {
        let mut least = f64::INFINITY;
        for _ in 0..ROUNDS {
            let before = self.clone();
            let is_learnt = proportions == Proportions::FromTake && self.learn(&found, place)?;
            let fitter = self.fitter(Weights::Relative);
            let next = passes::again(&fitter, &found, self.times, progress)?;
            let next = passes::swept(&fitter, next, self.times, progress)?;
            let misfit: f64 = next.iter().flatten().map(|found| found.misfit).sum();
            if misfit >= least {
                *self = before;
                break;
            }
            let is_worth_another = misfit < (1.0 - WORTH_ANOTHER) * least;
            (found, least) = (next, misfit);
            self.weigh(&found)?;
            if !is_learnt || !is_worth_another {
                break;
            }
        }
        Ok(found)
    }

    /// Learns the hand's proportions; whether these frames tell any.
    fn learn(&mut self, found: &[Option<Found>], place: &DAffine3) -> Result<bool> {
        let fitter = self.fitter(Weights::Relative);
        let learnt = proportions::learn(&self.mean, &fitter, found, place, self.border())?;
        let is_learnt = learnt.is_some();
        if let Some(learnt) = learnt {
            self.hand = learnt;
        }
        Ok(is_learnt)
    }

    /// Finds out how well borders and points are known.
    fn weigh(&mut self, found: &[Option<Found>]) -> Result<()> {
        let known = ViewKnowledge::of(&self.fitter(Weights::Absolute), found)?;
        (self.weights, self.persistent) = (known.weights, known.persistent);
        Ok(())
    }

    /// What borders tell of the hand's proportions.
    fn border(&self) -> HandEvidence {
        HandEvidence { independent: self.weights.most(), persistent: self.persistent }
    }

    /// The report of every frame.
    fn reports(
        &self,
        found: &[Option<Found>],
        known: &Known,
        volume: &Volume,
    ) -> Result<Vec<FrameFit>> {
        let rest: DAffine3 = volume.rest_frame();
        let fitter = &self.fitter(Weights::Absolute);
        let reporter = Reporter { cameras: self.cameras, fitter, known, rest };
        let report =
            |found: &Option<Found>| found.as_ref().map(|own| reporter.report(own)).transpose();
        let seen: Vec<Option<FrameFit>> = found.par_iter().map(report).collect::<Result<_>>()?;
        let fill = |k: usize| -> Result<FrameFit> {
            if let Some(seen) = &seen[k] {
                return Ok(seen.clone());
            }
            let fitted = (0..seen.len()).filter_map(|other| Some((other, seen[other].as_ref()?)));
            let away = |other: usize| self.times.between(other, k);
            let nearest = fitted.min_by(|(a, _), (b, _)| away(*a).total_cmp(&away(*b)));
            Ok(reporter.not_seen(nearest.ok_or(Error::NoHand)?.1))
        };
        (0..seen.len()).map(fill).collect()
    }
}
