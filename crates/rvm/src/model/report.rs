//! What a fit says about itself.

use crate::model::Model;

/// What a fitter returns: a fitted model, and how the fitting went.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit<M = Model> {
    /// The model.
    pub model: M,
    /// How the fitting went.
    pub report: Report,
}

/// How a fit went. Not converging is no error: the model is as good as it got.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Report {
    /// Steps taken, over all traces.
    pub iterations: usize,
    /// Did every trace converge?
    pub converged: bool,
    /// One per independent optimisation: one per target for Tipping, one per stage of a cascade,
    /// otherwise one.
    pub traces: Vec<Trace>,
    /// The penalty in use, where the fitter chooses or adapts one: λ of kernel ridge and Nyström
    /// regression, ν/m of bridges (of the last stage).
    pub penalty: Option<f64>,
}

/// The course of one optimisation.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// Did it converge before its limit on iterations?
    pub converged: bool,
    /// The objective after each step, in standardised units; what it is, each fitter says.
    pub objective: Vec<f64>,
}

impl Report {
    pub(crate) fn new(traces: Vec<Trace>, penalty: Option<f64>) -> Self {
        Self {
            iterations: traces.iter().map(|trace| trace.objective.len()).sum(),
            converged: traces.iter().all(|trace| trace.converged),
            traces,
            penalty,
        }
    }
}

/// Where a climb of the evidence stands after a step, for whoever watches.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// The target that is fitted; 0 where all are fitted together.
    pub target: usize,
    /// Steps taken so far, those of restarts among them.
    pub iteration: usize,
    /// Log evidence of the present climb, in nats: restarts begin lower.
    pub evidence: f64,
    /// Columns that are active.
    pub vectors: usize,
}
