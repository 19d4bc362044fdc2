//! Ascent to a local optimum, and restarts.

use crate::data::check;
use crate::error::{Error, Result};
use crate::model::report::{Progress, Trace};
use crate::rvm::marginal_likelihood::MarginalLikelihood;
use crate::rvm::marginal_likelihood::targets::Targets;

/// Steps between two computations from scratch, besides one for each active column: then the
/// computation, which costs about a step for each, hardly matters.
const STEPS_BETWEEN: usize = 10;
/// A restart leaves out one, two or three of so many parts of the active columns, in turn.
const PARTS: usize = 6;

/// Settings of the ascent.
pub(crate) struct Ascent {
    /// Least noise variance, as a share of the target's variance, in (0, 1].
    pub(crate) noise_floor: f64,
    /// Log evidence that each active column must add, in nats; at least 0.
    pub(crate) min_evidence_gain: f64,
    /// Steps that gain no more, in nats, are not taken; above 0.
    pub(crate) tolerance: f64,
    /// Most steps, at least 1.
    pub(crate) max_iterations: usize,
    /// Number of restarts.
    pub(crate) restarts: usize,
    /// Maximum number of active columns.
    pub(crate) most: usize,
}

impl Ascent {
    pub(crate) fn check(&self) -> Result<()> {
        check::positive("tolerance", self.tolerance)?;
        check::iterations(self.max_iterations)?;
        if !(self.min_evidence_gain >= 0.0 && self.min_evidence_gain.is_finite()) {
            let requirement = "at least 0 and finite";
            return Err(Error::Parameter {
                name: "min_evidence_gain",
                value: self.min_evidence_gain,
                requirement,
            });
        }
        if self.noise_floor > 0.0 && self.noise_floor <= 1.0 {
            return Ok(());
        }
        Err(Error::Parameter {
            name: "noise_floor",
            value: self.noise_floor,
            requirement: "above 0 and at most 1",
        })
    }

    /// The start: no column is active.
    pub(crate) fn start<'a>(&self, targets: Targets<'a>) -> Result<MarginalLikelihood<'a>> {
        MarginalLikelihood::new(targets, self.noise_floor, self.most, self.min_evidence_gain)
    }

    /// Ascends from the given start, then restarts from the best solution without some neighbouring
    /// columns (iterated local search: Lourenço, Martin and Stützle 2003), since changes of one
    /// column at a time have many local optima.
    pub(crate) fn run<'a>(
        &self,
        mut best: MarginalLikelihood<'a>,
        observe: &dyn Fn(Progress),
    ) -> Result<(MarginalLikelihood<'a>, Trace)> {
        let (mut objective, mut left) = (Vec::new(), self.max_iterations);
        let mut converged = self.climb(&mut best, &mut left, |progress| {
            objective.push(progress.evidence);
            observe(progress);
        })?;
        for round in 0..self.restarts {
            if best.active.len() == 0 || !converged {
                break;
            }
            let mut other = best.without(&neighbours(&best, round))?;
            converged = self.climb(&mut other, &mut left, observe)?;
            if other.objective() > best.objective() + self.tolerance {
                objective.push(other.value());
                best = other;
            }
        }
        Ok((best, Trace { converged, objective }))
    }

    /// Takes the best step until none gains. Convergence is checked with quantities computed from
    /// scratch; where targets without noise lead to where these are lost to rounding, the steps since
    /// they were last computed are taken back, and the ascent ends.
    fn climb(
        &self,
        evidence: &mut MarginalLikelihood<'_>,
        left: &mut usize,
        mut observe: impl FnMut(Progress),
    ) -> Result<bool> {
        let mut computed = evidence.clone();
        loop {
            let step = evidence.best_step();
            let gains = step.gain > self.tolerance;
            if !gains && evidence.stale == 0 {
                return Ok(true);
            }
            if !gains || evidence.stale >= STEPS_BETWEEN + evidence.active.len() {
                match evidence.refresh() {
                    Ok(()) => computed.clone_from(evidence),
                    Err(Error::Singular { .. }) => {
                        *evidence = computed;
                        return Ok(false);
                    }
                    Err(error) => return Err(error),
                }
                continue;
            }
            if *left == 0 {
                return Ok(false);
            }
            *left -= 1;
            evidence.take(step.change);
            observe(Progress {
                target: 0,
                iteration: self.max_iterations - *left,
                evidence: evidence.value(),
                vectors: evidence.active.len(),
            });
        }
    }
}

/// An active column and those most correlated with it, another one in every round.
fn neighbours(evidence: &MarginalLikelihood<'_>, round: usize) -> Vec<usize> {
    // By their precisions, so that the order of the samples does not matter.
    let (active, alpha) = evidence.active();
    let mut places: Vec<usize> = (0..active.len()).collect();
    places.sort_by(|&a, &b| alpha[a].total_cmp(&alpha[b]));
    let mut columns: Vec<usize> = places.into_iter().map(|i| active[i]).collect();
    // Steps of the golden section visit them evenly, whatever their number.
    let share = (round as f64 * 0.618_033_988_749_894_9).fract();
    let middle = columns[(share * columns.len() as f64) as usize];
    let gram = evidence.targets.gram;
    let correlation = |k: usize| gram[(k, middle)].powi(2) / gram[(k, k)];
    columns.sort_by(|&a, &b| correlation(b).total_cmp(&correlation(a)));
    columns.truncate((columns.len() * (round % 3 + 1)).div_ceil(PARTS));
    columns
}
