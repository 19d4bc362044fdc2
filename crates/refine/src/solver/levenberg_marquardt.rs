//! Damped least squares (Levenberg 1944, Marquardt 1963), coarse to fine.

use phalanx_hand::Primitive;
use phalanx_segmentation::Mask;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::geometry::correspondence::ViewMatcher;
use crate::observation::silhouette::SilhouetteObservation;
use crate::priors::gaussian::GaussianPenalty;
use crate::priors::nuisance::ExtrinsicsCorrection;
use crate::solver::loss::RobustLoss;
use crate::solver::matched_frame::{FramePoint, MatchedFrame};
use crate::solver::normal_equations::{BoundaryEnergy, NormalEquations, Step, solve};
use crate::solver::problem::{FrameParameters, Problem, SharedParameters};

/// Where a fit is.
#[derive(Debug, Clone)]
pub(crate) struct State {
    pub(crate) frames: Vec<FrameParameters>,
    pub(crate) shared: SharedParameters,
}

/// The energy of a state, and its normal equations.
struct Linearisation {
    energy: f64,
    frames: Vec<NormalEquations>,
    shared_prior: Vec<GaussianPenalty>,
}

/// How a fit ended.
#[derive(Clone)]
pub(crate) struct Outcome {
    pub(crate) state: State,
    pub(crate) energy: f64,
    pub(crate) frames: Vec<NormalEquations>,
    pub(crate) converged: bool,
    pub(crate) steps: usize,
}

impl Outcome {
    /// The better of two, with the steps of both.
    pub(crate) fn or(self, other: Self) -> Self {
        let steps = self.steps + other.steps;
        let better = if other.energy < self.energy { other } else { self };
        Self { steps, ..better }
    }

    /// For each view of the first frame, the share of its boundary that is unexplained.
    pub(crate) fn unexplained(&self, loss: RobustLoss) -> Vec<f64> {
        let share = |boundary: &BoundaryEnergy| {
            loss.unexplained(boundary.energy, boundary.count, boundary.areas)
        };
        self.frames[0].boundaries.iter().map(share).collect()
    }

    /// For each view with landmarks of the first frame, how much of them is unexplained.
    pub(crate) fn landmarks_unexplained(&self) -> Vec<f64> {
        self.frames[0].landmarks.clone()
    }

    /// Root of the mean robust squared distance of the boundaries, px, given their noise.
    pub(crate) fn boundary_rms_px(&self, noise: f64) -> f64 {
        let boundaries = || self.frames.iter().flat_map(|frame| &frame.boundaries);
        let energy: f64 = boundaries().map(|boundary| boundary.energy).sum();
        let count: usize = boundaries().map(|boundary| boundary.count).sum();
        noise * (2.0 * energy / count.max(1) as f64).sqrt()
    }
}

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stop {
    /// Steps at most.
    pub(crate) steps: usize,
    /// Share of the energy that a step must win.
    pub(crate) gain: f64,
    /// The energy below which the first step must promise to lead.
    pub(crate) target_energy: f64,
}

/// The target of a fit that is worth its steps whatever energy they lead to.
pub(crate) const ANY_ENERGY: f64 = f64::INFINITY;

/// The damping that a descent begins with, which is little: with a tenth of it a third of all first steps lead up, as
/// places of the boundary belong to other primitives after them.
const FIRST_DAMPING: f64 = 1e-2;

/// A frame has converged where the next step promises to win less than this: half the square of the
/// gradient's norm as the curvature scales it (the Newton decrement; Boyd and Vandenberghe 2004, § 9.5.1). The
/// pose is then within a fifth of a standard deviation of the minimum, by its own curvature. Where longer
/// steps won nothing it is the damped step that says so.
const CONVERGED: f64 = 0.02;

/// Descends from a state until steps win no more.
pub(crate) fn levenberg_marquardt(
    problem: &Problem<'_>,
    start: State,
    loss: RobustLoss,
    stop: Stop,
    views: &mut [Vec<ViewMatcher>],
) -> Result<Outcome> {
    let mut state = start;
    let mut linearisation = linearise(problem, &state, loss, views)?;
    let (mut damping, mut wins, mut steps) = (FIRST_DAMPING, true, 0);
    while steps < stop.steps && wins {
        steps += 1;
        let Some(step) = solve(&linearisation.frames, &linearisation.shared_prior, damping) else {
            damping = f64::max(10.0 * damping, FIRST_DAMPING);
            continue;
        };
        if step.predicted_decrease < CONVERGED * state.frames.len() as f64 {
            break;
        }
        if steps == 1 && linearisation.energy - step.predicted_decrease > stop.target_energy {
            break;
        }
        let candidate = moved(problem, &state, &step);
        match linearise_below(problem, &candidate, loss, linearisation.energy, views) {
            Ok(Some(next)) if next.energy < linearisation.energy => {
                wins = linearisation.energy - next.energy >= stop.gain * linearisation.energy;
                (state, linearisation) = (candidate, next);
                damping *= 0.3;
            }
            // A step too long: also one that led to where a camera cannot draw the hand.
            Ok(_) | Err(Error::Render { .. }) => damping *= 10.0,
            Err(error) => return Err(error),
        }
    }
    let Linearisation { energy, frames, shared_prior } = linearisation;
    let left = solve(&frames, &shared_prior, damping).map(|step| step.predicted_decrease);
    let converged = left.is_some_and(|left| left < CONVERGED * state.frames.len() as f64);
    Ok(Outcome { state, energy, frames, converged, steps })
}

fn linearise(
    problem: &Problem<'_>,
    state: &State,
    loss: RobustLoss,
    views: &mut [Vec<ViewMatcher>],
) -> Result<Linearisation> {
    let linearisation = linearise_below(problem, state, loss, f64::INFINITY, views)?;
    Ok(linearisation.expect("no energy is above infinity"))
}

/// The energy of a state and its normal equations; `None` where the boundaries of a frame alone are surely above `most`,
/// which is found out before any slope is worked out.
fn linearise_below(
    problem: &Problem<'_>,
    state: &State,
    loss: RobustLoss,
    most: f64,
    views: &mut [Vec<ViewMatcher>],
) -> Result<Option<Linearisation>> {
    let (mut energy, shared_prior) = problem.shared_prior(&state.shared);
    let frames = state.frames.par_iter().zip(&mut *views).enumerate();
    // All are matched, whatever comes of one: matchers begin with what they matched before.
    let matched: Vec<Result<Option<MatchedFrame<'_>>>> = frames
        .map(|(frame, (parameters, views))| {
            FramePoint { problem, frame, parameters, shared: &state.shared, loss }
                .matched(views, most)
        })
        .collect();
    let matched: Option<Vec<MatchedFrame<'_>>> = matched.into_iter().collect::<Result<_>>()?;
    let Some(matched) = matched else { return Ok(None) };
    let frames = matched.into_par_iter().zip(&*views);
    let frames: Vec<NormalEquations> =
        frames.map(|(frame, views)| frame.linearised(views)).collect();
    for frame in &frames {
        energy += frame.energy;
    }
    Ok(Some(Linearisation { energy, frames, shared_prior }))
}

/// How well each view of each frame agrees with its silhouette: intersection over union.
pub(crate) fn ious(
    problem: &Problem<'_>,
    state: &State,
    views: &mut [Vec<ViewMatcher>],
) -> Result<Vec<Vec<f64>>> {
    let hand = state.shared.shape.hand(problem.given);
    let mut drawn = Mask::default();
    let mut of_frame = |k: usize, views: &mut [ViewMatcher]| -> Result<Vec<f64>> {
        let parameters = &state.frames[k];
        let posed = hand.pose(&parameters.pose, problem.rest);
        let of_view = |(v, (view, seen)): (usize, (&mut ViewMatcher, &SilhouetteObservation))| {
            let motion = problem.motion(parameters, &state.shared, v);
            let moved: Vec<Primitive> =
                posed.primitives.iter().map(|primitive| primitive.moved(&motion)).collect();
            view.draw(&moved, seen, &mut drawn)?;
            Ok(seen.iou(&drawn))
        };
        views
            .iter_mut()
            .zip(problem.frames[k].evidence.silhouettes)
            .enumerate()
            .map(of_view)
            .collect()
    };
    views.iter_mut().enumerate().map(|(k, views)| of_frame(k, views)).collect()
}

fn moved(problem: &Problem<'_>, state: &State, step: &Step) -> State {
    let mut state = state.clone();
    for ((parameters, frame), step) in state.frames.iter_mut().zip(&problem.frames).zip(&step.own) {
        let (pose, step) = step.split_at(frame.prior.dofs().len());
        for (&dof, step) in frame.prior.dofs().iter().zip(pose) {
            parameters.pose[dof] += step;
        }
        // Steps of margins are not taken: they are found anew for every pose.
        let steps =
            step[frame.evidence.silhouettes.len()..].chunks_exact(ExtrinsicsCorrection::NUMBERS);
        parameters.corrections.iter_mut().zip(steps).for_each(|(own, step)| own.stepped(step));
    }
    let hand = step.shared.len() - ExtrinsicsCorrection::NUMBERS * state.shared.corrections.len();
    let (hand, cameras) = step.shared.split_at(hand);
    for (number, step) in state.shared.shape.logarithms.iter_mut().zip(hand) {
        *number += step;
    }
    let steps = cameras.chunks_exact(ExtrinsicsCorrection::NUMBERS);
    state.shared.corrections.iter_mut().zip(steps).for_each(|(own, step)| own.stepped(step));
    state
}
