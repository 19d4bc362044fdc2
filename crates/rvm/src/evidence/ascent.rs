//! Taking steps until none gains.

use super::{Evidence, Targets};
use crate::{Error, Result, Trace, check};

/// Steps between two computations from scratch, besides one for each active column: then the
/// computation, which costs about a step for each, hardly matters.
const STEPS_BETWEEN: usize = 10;

/// How the evidence is climbed.
pub(crate) struct Ascent {
    /// Least noise variance, as a share of the target's variance, in (0, 1].
    pub(crate) noise_floor: f64,
    /// Steps that gain no more, in nats, are not taken; above 0.
    pub(crate) tolerance: f64,
    /// Most steps, at least 1.
    pub(crate) max_iterations: usize,
    /// Most active columns.
    pub(crate) most: usize,
}

impl Ascent {
    pub(crate) fn check(&self) -> Result<()> {
        check::positive("tolerance", self.tolerance)?;
        check::iterations(self.max_iterations)?;
        if self.noise_floor > 0.0 && self.noise_floor <= 1.0 {
            return Ok(());
        }
        Err(Error::Parameter {
            name: "noise_floor",
            value: self.noise_floor,
            requirement: "above 0 and at most 1",
        })
    }

    /// Takes the step that gains the most, again and again. It has converged when nothing gains
    /// by numbers computed from scratch.
    pub(crate) fn run<'a>(&self, targets: Targets<'a>) -> Result<(Evidence<'a>, Trace)> {
        let mut evidence = Evidence::new(targets, self.noise_floor, self.most)?;
        let mut trace = Trace { converged: false, objective: Vec::new() };
        loop {
            let step = evidence.best_step();
            let gains = step.gain > self.tolerance;
            if !gains && evidence.stale == 0 {
                trace.converged = true;
                break;
            }
            if !gains || evidence.stale >= STEPS_BETWEEN + evidence.active.len() {
                evidence.refresh()?;
                continue;
            }
            if trace.objective.len() == self.max_iterations {
                break;
            }
            evidence.take(&step);
            trace.objective.push(evidence.value());
        }
        Ok((evidence, trace))
    }
}
