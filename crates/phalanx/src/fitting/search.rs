//! Looking for a hand in one frame: where it may be, and which of the places views agree with.

use glam::DAffine3;
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_refine::{Evidence, LandmarkObservation, Screened, SilhouetteObservation};

use super::found::{Found, views_used};
use super::frame_fit::{FrameFitter, Seen, distinct};
use super::misfit;
use super::observation::{Sight, holds, holds_most};
use super::points::palm_frames;
use super::starts;
use crate::error::Result;
use crate::localize::{HandCrop, Placement};

/// Palm directions about the forearm that are tried where none is known: 45° apart, half of which steps
/// make up for.
pub(super) const TURNS: usize = 8;

/// Of the guesses where a hand may be so many are followed, and of the palm directions of each.
const GUESSES: usize = 2;
const STARTS: usize = 2;

/// Where a hand may be, and the poses to begin with.
struct Guess {
    rest: DAffine3,
    starts: Vec<Pose>,
    follow: Follow,
}

/// Which of a guess's starts are followed a few steps.
#[derive(Clone, Copy)]
enum Follow {
    All,
    Few,
}

impl Guess {
    fn at(rest: DAffine3) -> Self {
        Self { rest, starts: starts::extremes(&Pose::REST).to_vec(), follow: Follow::All }
    }

    /// Adds the poses to begin with where the hand's frame may also be.
    fn add(&mut self, frame: &DAffine3, hand: &HandShape) {
        let moved = |pose| starts::in_frame(&pose, frame, &self.rest, hand);
        for start in starts::extremes(&Pose::REST).map(moved) {
            if !self.starts.contains(&start) {
                self.starts.push(start);
            }
        }
    }
}

/// A guess after a few steps from each of its starts.
struct Screening {
    rest: DAffine3,
    screened: Vec<Screened>,
    crops: Vec<Option<HandCrop>>,
    evidence: Seen,
    views: usize,
    backwards: f64,
    misfit: f64,
}

/// Looks for a hand with nothing known but what the views saw: at every placement, in every
/// direction about the forearm; `None` where no view has anything like a hand.
pub(super) fn anywhere(fitter: &FrameFitter<'_>, sight: &Sight) -> Result<Option<Found>> {
    anywhere_with(Follow::All, fitter, sight)
}

/// The same of a hand that is known: only the best of the poses are followed.
pub(super) fn known_anywhere(fitter: &FrameFitter<'_>, sight: &Sight) -> Result<Option<Found>> {
    anywhere_with(Follow::Few, fitter, sight)
}

fn anywhere_with(follow: Follow, fitter: &FrameFitter<'_>, sight: &Sight) -> Result<Option<Found>> {
    let guess = |placement: &Placement| {
        let turned = (0..TURNS).flat_map(|turn| {
            let mut pose = Pose::REST;
            pose[Dof::ThetaZ] = std::f64::consts::TAU * turn as f64 / TURNS as f64;
            starts::extremes(&pose)
        });
        let rest = starts::frame_of(placement.wrist, placement.arm);
        Guess { starts: turned.collect(), follow, ..Guess::at(rest) }
    };
    let guesses = by_points(fitter, sight).chain(sight.placements.iter().map(guess));
    best_of(fitter, sight, guesses)
}

/// Where the points of two cameras say that the hand is.
fn by_points(fitter: &FrameFitter<'_>, sight: &Sight) -> impl Iterator<Item = Guess> {
    palm_frames(&sight.points, fitter.hand.side).into_iter().take(GUESSES).map(Guess::at)
}

/// Looks for a hand near where hands of other frames are: `frames` are theirs.
pub(super) fn near(
    fitter: &FrameFitter<'_>,
    sight: &Sight,
    frames: &[DAffine3],
) -> Result<Option<Found>> {
    let near = frames_near(sight, frames).map(Guess::at);
    best_of(fitter, sight, by_points(fitter, sight).chain(near))
}

/// Looks for a hand where hands of other frames are, whatever this frame shows elsewhere.
pub(super) fn at(
    fitter: &FrameFitter<'_>,
    sight: &Sight,
    frames: &[DAffine3],
) -> Result<Option<Found>> {
    best_of(fitter, sight, frames.iter().copied().map(Guess::at))
}

/// Looks near them for a hand that is known: guesses that are near each other are looked at in the same crops, and only the
/// best of their poses are followed.
pub(super) fn near_together(
    fitter: &FrameFitter<'_>,
    sight: &Sight,
    frames: &[DAffine3],
) -> Result<Option<Found>> {
    let is_near =
        |one: &DAffine3, other: &DAffine3| holds_most(fitter.ball(one), fitter.ball(other));
    let mut guesses: Vec<Guess> = Vec::new();
    for frame in frames_near(sight, frames) {
        match guesses.iter_mut().find(|guess| is_near(&guess.rest, &frame)) {
            Some(guess) => guess.add(&frame, fitter.hand),
            None => guesses.push(Guess { follow: Follow::Few, ..Guess::at(frame) }),
        }
    }
    let found = best_of(fitter, sight, by_points(fitter, sight).chain(guesses))?;
    Ok(found.map(|found| centred(fitter, sight, found)))
}

/// Where a hand may be whose frame is like some others: where this frame shows one, and where they are.
fn frames_near(sight: &Sight, frames: &[DAffine3]) -> impl Iterator<Item = DAffine3> {
    let own = sight.placements.iter().take(GUESSES).flat_map(|placement| {
        let turned = frames.iter().map(|frame| starts::turned_to(placement, frame));
        let moved = |frame: &DAffine3| DAffine3 { translation: placement.wrist, ..*frame };
        turned.chain(frames.iter().map(moved))
    });
    own.chain(frames.iter().copied())
}

/// The best fit among some guesses.
fn best_of(
    fitter: &FrameFitter<'_>,
    sight: &Sight,
    guesses: impl Iterator<Item = Guess>,
) -> Result<Option<Found>> {
    let mut screenings: Vec<Screening> = Vec::new();
    for guess in guesses {
        screenings.extend(screened(fitter, sight, guess)?);
    }
    screenings.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
    screenings.truncate(GUESSES);
    let mut best: Option<Found> = None;
    for Screening { rest, screened, crops, evidence, views, backwards, .. } in screenings {
        let starts = distinct(&screened, STARTS);
        let postures: Vec<Pose> = starts.iter().take(1).flat_map(starts::postures).collect();
        let fits = fitter.fits(&rest, &evidence, &[starts, postures].concat())?;
        let Some(refined) = fits.into_iter().next() else { continue };
        let misfit = misfit::of_fit(&refined, views) + backwards;
        if best.as_ref().is_none_or(|best| misfit < best.misfit) {
            let points = sight.points.clone();
            let left_out = fitter.weights.left_out(points.len());
            best = Some(Found { rest, refined, crops, points, left_out, backwards, misfit });
        }
        // A guess that views agree with needs no other beside it.
        if misfit < 1.0 {
            break;
        }
    }
    Ok(best)
}

/// A frame whose crops hold its hand.
fn centred(fitter: &FrameFitter<'_>, sight: &Sight, found: Found) -> Found {
    let ball = fitter.ball(&found.frame(fitter.hand));
    if holds(fitter.ball(&found.rest), ball) {
        return found;
    }
    Found { crops: sight.crops(ball), ..found }
}

/// A guess after a few steps; `None` where no view shows anything there.
fn screened(fitter: &FrameFitter<'_>, sight: &Sight, guess: Guess) -> Result<Option<Screening>> {
    let Guess { rest, starts, follow } = guess;
    let crops = sight.crops(fitter.ball(&rest));
    let left_out = fitter.weights.left_out(sight.points.len());
    let evidence = fitter.seen(&crops, &sight.points, &left_out, &rest);
    if Evidence::from(&evidence).is_empty() {
        return Ok(None);
    }
    let views = views_used(&crops, &sight.points, &left_out);
    let screened = match follow {
        Follow::All => fitter.screen(&rest, &evidence, &starts)?,
        Follow::Few => fitter.screen_few(&rest, &evidence, &starts)?,
    };
    let Some(first) = screened.first() else { return Ok(None) };
    let frame = starts::frame_at(&first.pose, &rest, fitter.hand);
    let backwards = sight.backwards(&frame);
    let misfit = misfit_of(fitter, &rest, &evidence, &first.pose, views)? + backwards;
    Ok(Some(Screening { rest, screened, crops, evidence, views, backwards, misfit }))
}

/// How far `views` views together are from agreeing with a pose.
fn misfit_of(
    fitter: &FrameFitter<'_>,
    rest: &DAffine3,
    evidence: &Seen,
    pose: &Pose,
    views: usize,
) -> Result<f64> {
    let of_view = |seen: &SilhouetteObservation| {
        let agreement = fitter.refinement.agreement(fitter.hand, rest, seen, pose)?;
        Ok(misfit::of_view(&agreement))
    };
    let of_points = |seen: &LandmarkObservation| {
        let unexplained = fitter.refinement.landmark_agreement(fitter.hand, rest, seen, pose)?;
        Ok(misfit::of_points(unexplained))
    };
    let borders = evidence.silhouettes.iter().map(of_view);
    let points = evidence.landmarks.iter().map(of_points);
    let seen: Vec<f64> = borders.chain(points).collect::<Result<_>>()?;
    Ok(misfit::of_views(&seen, views))
}
