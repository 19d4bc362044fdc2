//! Damped least squares (Levenberg 1944, Marquardt 1963), coarse to fine.

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::geometry::correspondence::View;
use crate::priors::gaussian::Known;
use crate::priors::nuisance::Correction;
use crate::solver::loss::Measure;
use crate::solver::normal_equations::{FrameSystem, Step, solve};
use crate::solver::problem::{Frame, Moment, Problem, Shared};
use crate::solver::residuals::linearise;

/// Where a fit is.
#[derive(Debug, Clone)]
pub(crate) struct State {
    pub(crate) moments: Vec<Moment>,
    pub(crate) shared: Shared,
}

/// The energy of a state, and its normal equations.
struct Look {
    energy: f64,
    frames: Vec<FrameSystem>,
    shared_prior: Vec<Known>,
}

/// How a fit ended.
#[derive(Clone)]
pub(crate) struct Outcome {
    pub(crate) state: State,
    pub(crate) energy: f64,
    pub(crate) frames: Vec<FrameSystem>,
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

    /// For each view of the first frame, the share of its border that is unexplained.
    pub(crate) fn unexplained(&self, measure: Measure) -> Vec<f64> {
        let borders = self.frames[0].borders.iter();
        borders.map(|border| measure.unexplained(border.energy, border.count)).collect()
    }

    /// Root of the mean robust squared distance of the borders, px, given their noise.
    pub(crate) fn border_px(&self, noise: f64) -> f64 {
        let borders = || self.frames.iter().flat_map(|frame| &frame.borders);
        let energy: f64 = borders().map(|border| border.energy).sum();
        let count: usize = borders().map(|border| border.count).sum();
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
    pub(crate) hope: f64,
}

/// The hope of a fit that is worth its steps whatever energy they lead to.
pub(crate) const ANY_ENERGY: f64 = f64::INFINITY;

/// Descends from a state until steps win no more.
pub(crate) fn descend(
    problem: &Problem<'_>,
    start: State,
    measure: Measure,
    stop: Stop,
    views: &mut [Vec<View>],
) -> Result<Outcome> {
    let mut state = start;
    let mut look = look_at(problem, &state, measure, views)?;
    let (mut damping, mut converged, mut steps) = (1e-3, false, 0);
    while steps < stop.steps && !converged {
        steps += 1;
        let Some(step) = solve(&look.frames, &look.shared_prior, damping) else {
            damping = f64::max(10.0 * damping, 1e-3);
            continue;
        };
        if steps == 1 && look.energy - step.promise > stop.hope {
            break;
        }
        let candidate = moved(problem, &state, &step);
        match look_at(problem, &candidate, measure, views) {
            Ok(next) if next.energy < look.energy => {
                converged = look.energy - next.energy < stop.gain * look.energy;
                (state, look) = (candidate, next);
                damping *= 0.3;
            }
            // A step too long: also one that led to where a camera cannot draw the hand.
            Ok(_) | Err(Error::Render { .. }) => {
                converged = damping > 1e4;
                damping *= 10.0;
            }
            Err(error) => return Err(error),
        }
    }
    let Look { energy, frames, .. } = look;
    Ok(Outcome { state, energy, frames, converged, steps })
}

fn look_at(
    problem: &Problem<'_>,
    state: &State,
    measure: Measure,
    views: &mut [Vec<View>],
) -> Result<Look> {
    let (mut energy, shared_prior) = problem.shared_prior(&state.shared);
    let looks = state.moments.par_iter().zip(views).enumerate();
    let frames: Vec<FrameSystem> = looks
        .map(|(frame, (moment, views))| {
            linearise(problem, frame, moment, &state.shared, measure, views)
        })
        .collect::<Result<_>>()?;
    for frame in &frames {
        energy += frame.energy;
    }
    Ok(Look { energy, frames, shared_prior })
}

/// How well each view of each frame agrees with its silhouette: intersection over union.
pub(crate) fn overlaps(
    problem: &Problem<'_>,
    state: &State,
    measure: Measure,
    views: &mut [Vec<View>],
) -> Result<Vec<Vec<f64>>> {
    // Draws the state; what was drawn last may be a step that was not taken.
    look_at(problem, state, measure, views)?;
    let of_frame = |(frame, views): (&Frame<'_>, &Vec<View>)| {
        views.iter().zip(frame.evidence).map(|(view, seen)| seen.overlap(view.drawn())).collect()
    };
    Ok(problem.frames.iter().zip(&*views).map(of_frame).collect())
}

fn moved(problem: &Problem<'_>, state: &State, step: &Step) -> State {
    let mut state = state.clone();
    for ((moment, frame), step) in state.moments.iter_mut().zip(&problem.frames).zip(&step.own) {
        let (pose, step) = step.split_at(frame.prior.dofs().len());
        for (&dof, step) in frame.prior.dofs().iter().zip(pose) {
            moment.pose[dof] += step;
        }
        // Steps of margins are not taken: they are found anew for every pose.
        let steps = step[frame.evidence.len()..].chunks_exact(Correction::NUMBERS);
        moment.corrections.iter_mut().zip(steps).for_each(|(own, step)| own.stepped(step));
    }
    let hand = step.shared.len() - Correction::NUMBERS * state.shared.corrections.len();
    let (hand, cameras) = step.shared.split_at(hand);
    for (number, step) in state.shared.proportions.logarithms.iter_mut().zip(hand) {
        *number += step;
    }
    let steps = cameras.chunks_exact(Correction::NUMBERS);
    state.shared.corrections.iter_mut().zip(steps).for_each(|(own, step)| own.stepped(step));
    state
}
