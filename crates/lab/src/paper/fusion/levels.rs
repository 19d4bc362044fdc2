//! The levels at which views can be joined, each fitted on one half of a split and tested on
//! whatever it is given.

use anyhow::Result;
use faer::{Mat, MatRef};
use phalanx::RegressorConfig;
use phalanx_hand::Dof;
use phalanx_multiview::{Estimate, inverse_variance, mean};
use phalanx_rvm::Regressor as _;
use phalanx_rvm::{Model, Ridge};

use super::descriptors::Descriptors;
use crate::data::split::Split;
use crate::eval::table1::{PaperCounts, TableMethod};

/// Which regressors there are.
#[derive(Clone, Copy)]
pub(super) enum Level<'a> {
    /// One, of the pooled histogram.
    Low,
    /// One, of the views' histograms joined.
    Intermediate,
    /// The same, of codebooks as large as that of all views together.
    IntermediateLarge,
    /// One for each view, of its part of the intermediate descriptor.
    High,
    /// One for each view, of a codebook as large as that of all views together.
    HighLarge,
    /// One that serves every camera, of the pooled codebook: it learns θ_Z as a camera sees it,
    /// which is less by the camera's azimuth about the forearm (radians, one per view).
    Shared(&'a [f64]),
}

/// How many samples the regressors keep.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kept {
    /// The paper's count, shared by the regressors.
    InAll,
    /// The paper's count in every regressor.
    Each,
    /// All: dense kernel ridge regression.
    Dense,
}

/// How estimates of single views are joined.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Join {
    /// There is only one.
    Alone,
    Mean,
    InverseVariance,
    /// A linear combination for each output, its weights from estimates of samples that their
    /// regressors had not seen.
    Stacked,
}

/// What a regressor says of every sample, 28 × I each.
struct Prediction {
    mean: Mat<f64>,
    std: Mat<f64>,
}

/// The training half of one split.
pub(super) struct Training<'a> {
    pub(super) x: &'a Descriptors,
    pub(super) y: &'a Mat<f64>,
    pub(super) active: &'a [Dof],
    pub(super) counts: PaperCounts,
    pub(super) seed: u64,
}

impl Level<'_> {
    /// The name in tables.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Low => "low: pooled, 90 centres",
            Self::Intermediate => "intermediate: 30 centres a view",
            Self::IntermediateLarge => "intermediate: 90 centres a view",
            Self::High => "high: 30 centres a view",
            Self::HighLarge => "high: 90 centres a view",
            Self::Shared(_) => "high: one regressor for all, 90 centres",
        }
    }

    /// The descriptors of each regressor's estimates.
    fn inputs<'b>(&self, x: &'b Descriptors) -> &'b [Mat<f64>] {
        match self {
            Self::Low => std::slice::from_ref(&x.pooled),
            Self::Intermediate => std::slice::from_ref(&x.joined),
            Self::IntermediateLarge => std::slice::from_ref(&x.joined_large),
            Self::High => &x.parts,
            Self::HighLarge => &x.large,
            Self::Shared(_) => &x.alike,
        }
    }

    /// The numbers of samples that are told apart at this level.
    pub(super) fn kept(&self) -> &'static [Kept] {
        match self {
            Self::High | Self::HighLarge => &[Kept::InAll, Kept::Each, Kept::Dense],
            _ => &[Kept::InAll, Kept::Dense],
        }
    }

    /// The ways in which estimates are joined at this level.
    pub(super) fn joins(&self) -> &'static [Join] {
        match self {
            Self::Low | Self::Intermediate | Self::IntermediateLarge => &[Join::Alone],
            Self::High | Self::HighLarge | Self::Shared(_) => {
                &[Join::Mean, Join::InverseVariance, Join::Stacked]
            }
        }
    }

    /// Estimates of every test set, 28 × I, for each of the joins.
    pub(super) fn estimates(
        &self,
        training: &Training<'_>,
        kept: Kept,
        tests: &[&Descriptors],
    ) -> Result<Vec<(Join, Vec<Mat<f64>>)>> {
        let inputs = self.inputs(training.x);
        let models = self.fit(training, kept, inputs, training.y)?;
        let predictions: Vec<Vec<Prediction>> = tests
            .iter()
            .map(|test| self.predict(&models, self.inputs(test)))
            .collect::<Result<_>>()?;
        let stacking = if self.joins().contains(&Join::Stacked) {
            self.stacking(training, kept)?
        } else {
            Vec::new()
        };
        let join = |&join: &Join| {
            let joined = |views: &Vec<Prediction>| match join {
                Join::Alone => Ok(views[0].mean.clone()),
                Join::Stacked => stacked(&stacking, training.active, views),
                Join::Mean | Join::InverseVariance => each_sample(join, views),
            };
            Ok((join, predictions.iter().map(joined).collect::<Result<_>>()?))
        };
        self.joins().iter().map(join).collect()
    }

    /// The regressors: one for each view, or the one.
    fn fit(
        &self,
        training: &Training<'_>,
        kept: Kept,
        inputs: &[Mat<f64>],
        y: &Mat<f64>,
    ) -> Result<Vec<Model>> {
        if let Self::Shared(azimuths) = self {
            let turned: Vec<Mat<f64>> = azimuths.iter().map(|&azimuth| turn(y, -azimuth)).collect();
            let regressor = kept.regressor(training.counts, 0, 1);
            return Ok(vec![regressor.fit(&side_by_side(inputs), &side_by_side(&turned))?.model]);
        }
        let fit = |(part, x): (usize, &Mat<f64>)| {
            let regressor = kept.regressor(training.counts, part, inputs.len());
            Ok(regressor.fit(x, y)?.model)
        };
        inputs.iter().enumerate().map(fit).collect()
    }

    /// What each regressor, or the one for each view, says.
    fn predict(&self, models: &[Model], inputs: &[Mat<f64>]) -> Result<Vec<Prediction>> {
        let predict = |(view, x): (usize, &Mat<f64>)| {
            let model = models.get(view).unwrap_or(&models[0]);
            let (mean, std) = model.predict_with_std(x.as_ref())?;
            let mean = match self {
                Self::Shared(azimuths) => turn(&mean, azimuths[view]),
                _ => mean,
            };
            Ok(Prediction { mean, std })
        };
        inputs.iter().enumerate().map(predict).collect()
    }

    /// For each active output a regression of the truth on the views' estimates. The training
    /// half is halved again, and each half estimated by regressors of the other: estimates of
    /// samples that a regressor was fitted to would flatter it.
    fn stacking(&self, training: &Training<'_>, kept: Kept) -> Result<Vec<Model>> {
        let inputs = self.inputs(training.x);
        let folds = Split::even(training.y.ncols(), training.seed);
        let mut estimates: Vec<Mat<f64>> =
            inputs.iter().map(|_| Mat::zeros(Dof::COUNT, training.y.ncols())).collect();
        for (known, unknown) in [(&folds.train, &folds.test), (&folds.test, &folds.train)] {
            let of = |samples: &[usize]| -> Vec<Mat<f64>> {
                inputs.iter().map(|x| columns(x, samples)).collect()
            };
            let models = self.fit(training, kept, &of(known), &columns(training.y, known))?;
            let predictions = self.predict(&models, &of(unknown))?;
            for (estimates, prediction) in estimates.iter_mut().zip(&predictions) {
                for (k, &sample) in unknown.iter().enumerate() {
                    estimates.col_mut(sample).copy_from(prediction.mean.col(k));
                }
            }
        }
        let views: Vec<MatRef<'_, f64>> = estimates.iter().map(Mat::as_ref).collect();
        let fit = |dof: &Dof| {
            let truth = training.y.row(dof.index());
            let truth = Mat::from_fn(1, training.y.ncols(), |_, i| truth[i]);
            Ok(Ridge::default().fit(of_output(&views, *dof).as_ref(), truth.as_ref())?.model)
        };
        training.active.iter().map(fit).collect()
    }
}

impl Kept {
    /// The regressor of one of `parts`.
    fn regressor(self, counts: PaperCounts, part: usize, parts: usize) -> RegressorConfig {
        let all = counts.gauss_samples;
        let (method, gauss_samples) = match self {
            Self::InAll => (TableMethod::Gauss, all / parts + usize::from(part < all % parts)),
            Self::Each => (TableMethod::Gauss, all),
            Self::Dense => (TableMethod::KernelRidge, all),
        };
        let regressor = method.regressor(PaperCounts { gauss_samples, ..counts });
        regressor.expect("both methods fit something")
    }
}

/// Joins the views' estimates sample by sample.
fn each_sample(join: Join, views: &[Prediction]) -> Result<Mat<f64>> {
    let mut joined = Mat::zeros(views[0].mean.nrows(), views[0].mean.ncols());
    for i in 0..joined.ncols() {
        let estimates: Vec<Estimate<'_>> = views
            .iter()
            .map(|of| Estimate { mean: of.mean.col_as_slice(i), std: of.std.col_as_slice(i) })
            .collect();
        let column = match join {
            Join::InverseVariance => inverse_variance(&estimates)?.0,
            _ => mean(&estimates.iter().map(|estimate| estimate.mean).collect::<Vec<_>>())?,
        };
        joined.col_as_slice_mut(i).copy_from_slice(&column);
    }
    Ok(joined)
}

/// Joins the views' estimates by a regression for each active output; the others stay 0.
fn stacked(stacking: &[Model], active: &[Dof], views: &[Prediction]) -> Result<Mat<f64>> {
    let views: Vec<MatRef<'_, f64>> = views.iter().map(|view| view.mean.as_ref()).collect();
    let mut joined = Mat::zeros(Dof::COUNT, views[0].ncols());
    for (model, &dof) in stacking.iter().zip(active) {
        let estimates = model.predict(of_output(&views, dof).as_ref())?;
        joined.row_mut(dof.index()).copy_from(estimates.row(0));
    }
    Ok(joined)
}

/// The views' estimates of one output, views × I.
fn of_output(views: &[MatRef<'_, f64>], dof: Dof) -> Mat<f64> {
    Mat::from_fn(views.len(), views[0].ncols(), |view, i| views[view][(dof.index(), i)])
}

/// Poses turned about the forearm, radians.
fn turn(y: &Mat<f64>, by: f64) -> Mat<f64> {
    let mut turned = y.clone();
    turned.row_mut(Dof::ThetaZ.index()).iter_mut().for_each(|angle| *angle += by);
    turned
}

fn columns(matrix: &Mat<f64>, which: &[usize]) -> Mat<f64> {
    Mat::from_fn(matrix.nrows(), which.len(), |row, k| matrix[(row, which[k])])
}

fn side_by_side(matrices: &[Mat<f64>]) -> Mat<f64> {
    let each = matrices[0].ncols();
    Mat::from_fn(matrices[0].nrows(), each * matrices.len(), |row, i| {
        matrices[i / each][(row, i % each)]
    })
}
