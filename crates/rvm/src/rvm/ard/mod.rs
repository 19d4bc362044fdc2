//! Relevance vector machines with optimised length scales.

mod evidence;
mod lbfgs;

use faer::{Mat, MatRef};

use crate::basis::design::Design;
use crate::basis::kernel::{Bandwidth, Kernel};
use crate::data::check;
use crate::data::problem::Problem;
use crate::data::scaler::StandardScaler;
use crate::data::size::ProblemSize;
use crate::error::{Error, Result};
use crate::model::report::{Fit, Progress, Report, Trace};
use crate::rvm::ard::evidence::Widths;
use crate::rvm::ard::lbfgs::Point;
use crate::rvm::multi_output::{MultiOutputRvm, Vectors};

/// An input whose width is below this share of the greatest is not read: over all the samples it
/// moves no exponent by as much.
const IRRELEVANT: f64 = 1e-6;

/// Which inputs share a length scale.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum LengthScales {
    /// One for all inputs.
    Shared,
    /// One for each input: automatic relevance determination.
    Ard,
    /// One for each block of consecutive inputs. The sizes of the blocks add up to the number of
    /// inputs.
    Blocks(Vec<usize>),
}

/// [`MultiOutputRvm`] with optimised length scales: one for all inputs, for each input, or for
/// blocks of them. For one target it is Tipping's "η-RVM" (2001, section 4.2 and appendix C). No
/// phalanx pipeline uses it; it is for those who use this crate alone.
///
/// The evidence is maximised in turns: over the vectors at fixed length scales, as in
/// [`MultiOutputRvm`], and over the logs of length scales and precisions at fixed vectors, by
/// L-BFGS with the closed-form gradient. The trace holds the evidence after each turn. Irrelevant
/// inputs are dropped ([`Model::selected_features`](crate::Model::selected_features));
/// [`Model::length_scales`](crate::Model::length_scales) returns the optimised scales.
///
/// ```
/// use phalanx_rvm::{ArdRvm, LengthScales, faer::Mat};
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// // Of three inputs the first matters much, the second little, and the third not at all.
/// let x = Mat::from_fn(3, 150, |i, t| ((t * (7 + 6 * i)) as f64 * 0.618).fract() * 4.0);
/// let y = Mat::from_fn(1, 150, |_, t| (2.0 * x[(0, t)]).sin() + 0.3 * x[(1, t)]);
///
/// let each = ArdRvm::default().fit(x.as_ref(), y.as_ref())?; // `LengthScales::Ard`
/// let scales = each.model.length_scales().expect("Gaussians have them");
/// assert!(scales[0] < scales[1]);
///
/// let one = ArdRvm { length_scales: LengthScales::Shared, ..ArdRvm::default() };
/// let one = one.fit(x.as_ref(), y.as_ref())?;
/// assert!(each.report.traces[0].objective.last() > one.report.traces[0].objective.last());
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ArdRvm {
    /// The machine. Its kernel must be Gaussian; its bandwidth is the initial one.
    pub rvm: MultiOutputRvm,
    /// Which inputs share a width.
    pub length_scales: LengthScales,
    /// Maximum number of turns, at least 1.
    pub rounds: usize,
    /// Maximum number of L-BFGS steps in a turn, at least 1.
    pub steps: usize,
}

impl Default for ArdRvm {
    fn default() -> Self {
        Self {
            rvm: MultiOutputRvm::default(),
            length_scales: LengthScales::Ard,
            rounds: 10,
            steps: 25,
        }
    }
}

impl ArdRvm {
    /// Fits X (K×I) to Y (m×I).
    pub fn fit(&self, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Fit> {
        self.fit_observed(x, y, &|_| ())
    }

    /// Checks the settings and the size of a problem before there are data. [`fit`](Self::fit) can
    /// still fail because of the values of the data.
    pub fn check(&self, size: ProblemSize) -> Result<()> {
        self.start()?;
        self.ties(size.inputs)?;
        self.rvm.check(size)
    }

    /// Like [`fit`](Self::fit), with a call of `observe` after each step over the vectors.
    pub fn fit_observed(
        &self,
        x: MatRef<'_, f64>,
        y: MatRef<'_, f64>,
        observe: &dyn Fn(Progress),
    ) -> Result<Fit> {
        let bandwidth = self.start()?;
        let problem = Problem::new(x, y)?;
        let ties = self.ties(x.nrows())?;
        let inputs = problem.features();
        let mut learning = Learning {
            ties: inputs.iter().map(|&i| ties[i]).collect(),
            widths: vec![
                bandwidth.magnitude(inputs.len()).ln();
                ties.iter().max().map_or(0, |t| t + 1)
            ],
            vectors: Vectors::default(),
            problem,
            inputs,
        };
        let mut objective: Vec<f64> = Vec::new();
        loop {
            let (fit, vectors) = learning.climb_vectors(&self.rvm, x, y, observe)?;
            let gained = objective.last().map_or(f64::INFINITY, |last| vectors.evidence - last);
            objective.push(vectors.evidence);
            let converged = gained <= self.rvm.tolerance || vectors.columns.is_empty();
            learning.vectors = vectors;
            let is_last = converged || objective.len() == self.rounds;
            if is_last || !learning.climb_widths(self) {
                let trace = Trace { converged, objective };
                return Ok(Fit { model: fit.model, report: Report::new(vec![trace], None) });
            }
        }
    }

    /// The width to start from, once the settings are found in range.
    fn start(&self) -> Result<Bandwidth> {
        let Kernel::Gaussian(bandwidth) = self.rvm.kernel else {
            return Err(Error::NoWidth);
        };
        check::iterations(self.rounds)?;
        check::iterations(self.steps)?;
        bandwidth.check()?;
        Ok(bandwidth)
    }

    /// Which width each input has.
    fn ties(&self, inputs: usize) -> Result<Vec<usize>> {
        Ok(match &self.length_scales {
            LengthScales::Shared => vec![0; inputs],
            LengthScales::Ard => (0..inputs).collect(),
            LengthScales::Blocks(blocks) => {
                let of_all = blocks.iter().fold(0_usize, |sum, &block| sum.saturating_add(block));
                check::length("inputs of all blocks", inputs, of_all)?;
                let of_block = |(tie, &size): (usize, &usize)| std::iter::repeat_n(tie, size);
                blocks.iter().enumerate().flat_map(of_block).collect()
            }
        })
    }
}

/// What is known so far.
struct Learning {
    problem: Problem,
    /// The inputs that vary, and which width each of them has.
    inputs: Vec<usize>,
    ties: Vec<usize>,
    /// Logs of the widths on standardised inputs.
    widths: Vec<f64>,
    vectors: Vectors,
}

impl Learning {
    /// The best vectors at these widths.
    fn climb_vectors(
        &self,
        rvm: &MultiOutputRvm,
        x: MatRef<'_, f64>,
        y: MatRef<'_, f64>,
        observe: &dyn Fn(Progress),
    ) -> Result<(Fit, Vectors)> {
        // Scaled by their widths' roots the inputs want a Gaussian of width 1.
        let mut scale = self.problem.inputs.scale().to_vec();
        let greatest = self.ties.iter().map(|&tie| self.widths[tie].exp()).fold(0.0, f64::max);
        for (&input, &tie) in self.inputs.iter().zip(&self.ties) {
            let width = self.widths[tie].exp();
            let relevant = width > IRRELEVANT * greatest;
            scale[input] = if relevant { scale[input] / width.sqrt() } else { 0.0 };
        }
        let inputs = StandardScaler::from_parts(self.problem.inputs.mean().to_vec(), scale)?;
        let scaled = Problem::scaled(inputs, x, y)?;
        let design = Design::full(&scaled, Kernel::Gaussian(Bandwidth::Gamma(1.0)))?;
        rvm.resume(&design, &self.vectors, observe)
    }

    /// The best widths for these vectors; whether working precision tells any.
    fn climb_widths(&mut self, settings: &ArdRvm) -> bool {
        let z = crate::linalg::subrows(self.problem.z.as_ref(), &self.inputs);
        let all = &self.problem.y;
        let varying: Vec<usize> =
            (0..all.ncols()).filter(|&j| all.col(j).iter().any(|&v| v != 0.0)).collect();
        let y = Mat::from_fn(all.nrows(), varying.len(), |t, v| all[(t, varying[v])]);
        let widths = Widths {
            z: z.as_ref(),
            y: y.as_ref(),
            ties: &self.ties,
            count: self.widths.len(),
            vectors: &self.vectors.columns,
            floor: settings.rvm.noise_floor,
        };
        let mut at = self.widths.clone();
        at.extend(self.vectors.alpha.iter().map(|alpha| alpha.ln()));
        let Some((value, gradient)) = widths.evaluate(&at) else { return false };
        let start = Point { at, value, gradient };
        let found = lbfgs::maximise(start, settings.steps, settings.rvm.tolerance, |at| {
            widths.evaluate(at)
        });
        let (logs, alphas) = found.at.split_at(self.widths.len());
        self.widths = logs.to_vec();
        self.vectors.alpha = alphas.iter().map(|log| log.exp()).collect();
        true
    }
}
