//! The result of a fit, and its report.

use crate::model::Model;

/// The result of a fit: the model and a report.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit<M = Model> {
    /// The model.
    pub model: M,
    /// How the fitting went.
    pub report: Report,
}

/// How a fit went. A fit that did not converge is not an error; the model is the best that was
/// found.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Report {
    /// Steps taken, over all traces.
    pub iterations: usize,
    /// Did every trace converge?
    pub converged: bool,
    /// One per independent optimisation: one per target of
    /// [`RelevanceVectorMachine`](crate::RelevanceVectorMachine), one per stage of
    /// [`TwoStageSelection`](crate::TwoStageSelection), otherwise one.
    pub traces: Vec<Trace>,
    /// The penalty that was chosen: λ of [`KernelRidge`](crate::KernelRidge) and
    /// [`NystromRidge`](crate::NystromRidge), ν/m of [`AgarwalTriggs`](crate::AgarwalTriggs) and of
    /// the last stage of [`TwoStageSelection`](crate::TwoStageSelection).
    pub penalty: Option<f64>,
}

/// The course of one optimisation.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// Did it converge before its limit on iterations?
    pub converged: bool,
    /// The objective after each step, in standardised units; each fitter documents which.
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

/// Progress of an evidence maximisation after a step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// The target being fitted; 0 if all are fitted together.
    pub target: usize,
    /// Steps taken so far, those of restarts among them.
    pub iteration: usize,
    /// Log evidence of the current ascent, in nats. Restarts begin lower.
    pub evidence: f64,
    /// Columns that are active.
    pub vectors: usize,
}
