//! One frame of a hand whose motion is known.

use glam::DAffine3;
use phalanx_hand::Pose;
use phalanx_refine::{Evidence, Level, PoseFit, PoseFitSettings, SilhouetteObservation};

use super::motion::{Motion, NUMBERS};
use super::noise::MotionNoise;
use super::seen::Seen;
use crate::error::Result;
use crate::fitting::found::{Found, views_used};
use crate::fitting::frame_fit::FrameFitter;
use crate::fitting::{consensus, frame_fit, misfit, starts};

/// A frame fitted near where its hand was predicted.
pub(super) struct Followed {
    pub(super) found: Found,
    /// What each view showed it as.
    pub(super) silhouettes: Vec<Option<SilhouetteObservation>>,
    /// What is known of the motion after it.
    pub(super) motion: Motion,
    /// How far each number came out from where it was predicted, and the variance of that and of what is
    /// left of it.
    pub(super) offset: [f64; NUMBERS],
    pub(super) before: [f64; NUMBERS],
    pub(super) after: [f64; NUMBERS],
}

/// How frames are fitted from starts that were screened already.
pub(super) fn settings() -> PoseFitSettings {
    let usual = consensus::near();
    let level = |level: &Level| Level { steps: STEPS, ..*level };
    let levels = usual.levels.last().map(level).into_iter().collect();
    PoseFitSettings { levels, ..usual }
}

/// Steps from a start that screening left.
const STEPS: usize = 6;

/// Starts before any step.
const AS_THEY_ARE: Level = Level { reach: 12.0, every: 4, steps: 0 };

/// Of other postures so many are followed a few steps.
const POSTURES: usize = 3;

/// Another posture is taken if it is nearer to agreeing with the views by so much.
const BETTER: f64 = 0.95;

/// A frame as it is looked at.
struct Frame<'a> {
    fitter: &'a FrameFitter<'a>,
    rest: DAffine3,
    evidence: frame_fit::Seen,
    views: usize,
    predicted: &'a Motion,
    noise: &'a MotionNoise,
}

/// A pose fitted to it.
struct Fitted {
    refined: PoseFit,
    /// How many times the variance of each number was taken to be what was predicted.
    inflated: [f64; NUMBERS],
    misfit: f64,
}

/// Fits a frame from where its hand is predicted or from where it was last, whichever is nearer; from other
/// postures too if it is further from agreeing with the views than `enough`. `None` of a frame that no view sees a hand in.
pub(super) fn follow(
    fitter: &FrameFitter<'_>,
    seen: &Seen,
    last: &Motion,
    predicted: &Motion,
    noise: &MotionNoise,
    enough: f64,
) -> Result<Option<Followed>> {
    let (hand, rest) = (fitter.hand, predicted.rest);
    let crops = seen.crops(fitter.ball(&rest));
    let points = seen.points.clone();
    let left_out = fitter.weights.left_out(points.len());
    let silhouettes = fitter.silhouettes_of(&crops, &rest);
    let evidence = fitter.used(silhouettes.clone(), &points, &left_out, &rest);
    if Evidence::from(&evidence).is_empty() {
        return Ok(None);
    }
    let views = views_used(&crops, &points, &left_out);
    let frame = Frame { fitter, rest, evidence, views, predicted, noise };
    let still = starts::in_frame(&last.pose, &last.rest, &rest, hand);
    let Some(mut best) = frame.fitted(&[predicted.pose, still])? else { return Ok(None) };
    if best.misfit > enough
        && let Some(other) = frame.in_other_postures(&best.refined.pose)?
        && other.misfit < BETTER * best.misfit
    {
        best = other;
    }
    let Fitted { refined, inflated, misfit } = best;
    let covariance: Vec<f64> = refined.covariance.iter().map(|own| own / noise.unit()).collect();
    let motion = predicted.corrected(&refined.pose, &covariance, &inflated, hand);
    let (offset, before) = (offset(&refined.pose, predicted), predicted.variances());
    let after = std::array::from_fn(|k| covariance[k * NUMBERS + k]);
    let found = Found { rest, refined, crops, points, left_out, backwards: 0.0, misfit };
    Ok(Some(Followed { found, silhouettes, motion, offset, before, after }))
}

impl Frame<'_> {
    /// The pose that the best of some starts leads to; `None` where none can be drawn or the views leave it
    /// open.
    fn fitted(&self, starts: &[Pose]) -> Result<Option<Fitted>> {
        let Self { fitter, rest, evidence, predicted, noise, .. } = self;
        let screened = fitter.screen(rest, evidence, starts)?;
        let Some(start) = screened.first().map(|start| start.pose) else { return Ok(None) };
        let inflated = MotionNoise::inflation(&offset(&start, predicted), &predicted.variances());
        let prior = fitter.prior.product(&predicted.prior(noise.unit(), &inflated)?)?;
        let settings = fitter.refinement;
        let refined = match settings.fit_near(fitter.hand, rest, evidence, &start, &prior) {
            Ok(refined) => refined,
            Err(phalanx_refine::Error::Precision { .. }) => return Ok(None),
            Err(error) => return Err(error.into()),
        };
        let misfit = misfit::of_fit(&refined, self.views);
        Ok(Some(Fitted { refined, inflated, misfit }))
    }

    /// The same from a pose with every finger straight or folded.
    fn in_other_postures(&self, pose: &Pose) -> Result<Option<Fitted>> {
        let Self { fitter, rest, evidence, .. } = self;
        let postures = starts::postures(pose);
        let (settings, prior) = (fitter.refinement, fitter.prior);
        let mut likely =
            settings.screen(fitter.hand, rest, evidence, &postures, prior, AS_THEY_ARE)?;
        likely.sort_by(|a, b| a.energy.total_cmp(&b.energy));
        let likely: Vec<Pose> = likely.iter().take(POSTURES).map(|start| start.pose).collect();
        self.fitted(&likely)
    }
}

/// How far each number of a pose is from where it was predicted.
fn offset(pose: &Pose, predicted: &Motion) -> [f64; NUMBERS] {
    std::array::from_fn(|k| pose.0[k] - predicted.pose.0[k])
}
