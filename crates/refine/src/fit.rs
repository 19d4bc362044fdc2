//! Damped least squares (Levenberg 1944, Marquardt 1963), coarse to fine.

use crate::Result;
use crate::problem::{Measure, Moment, Problem, Shared};
use crate::system::{self, FrameSystem, Step};
use crate::view::View;

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
    shared_prior: Vec<(f64, f64)>,
}

/// How a fit ended.
pub(crate) struct Outcome {
    pub(crate) state: State,
    pub(crate) energy: f64,
    pub(crate) frames: Vec<FrameSystem>,
    pub(crate) converged: bool,
    pub(crate) steps: usize,
}

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stop {
    /// Steps at most.
    pub(crate) steps: usize,
    /// Share of the energy that a step must win.
    pub(crate) gain: f64,
}

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
        let Some(step) = system::solve(&look.frames, &look.shared_prior, damping) else {
            damping = f64::max(10.0 * damping, 1e-3);
            continue;
        };
        let candidate = moved(problem, &state, &step);
        let next = look_at(problem, &candidate, measure, views)?;
        if next.energy < look.energy {
            converged = look.energy - next.energy < stop.gain * look.energy;
            (state, look) = (candidate, next);
            damping *= 0.3;
        } else {
            converged = damping > 1e4;
            damping *= 10.0;
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
    let mut frames = Vec::with_capacity(state.moments.len());
    for (frame, (moment, views)) in state.moments.iter().zip(views).enumerate() {
        let (own, system) = problem.look(frame, moment, &state.shared, measure, views)?;
        energy += own;
        frames.push(system);
    }
    Ok(Look { energy, frames, shared_prior })
}

fn moved(problem: &Problem<'_>, state: &State, step: &Step) -> State {
    let mut state = state.clone();
    for ((moment, frame), step) in state.moments.iter_mut().zip(&problem.frames).zip(&step.poses) {
        let (pose, margins) = step.split_at(frame.prior.dofs().len());
        for (&dof, step) in frame.prior.dofs().iter().zip(pose) {
            moment.pose[dof] += step;
        }
        for (margin, step) in moment.margins.iter_mut().zip(margins) {
            *margin += step;
        }
    }
    let mut rest = step.shared.iter();
    let mut take = || rest.next().copied().unwrap_or(0.0);
    if problem.freedom.hand.is_some() {
        state.shared.proportions.logarithms.iter_mut().for_each(|number| *number += take());
    }
    if problem.freedom.cameras.is_some() {
        for part in state.shared.corrections.iter_mut().flatten() {
            *part += glam::DVec3::new(take(), take(), take());
        }
    }
    state
}
