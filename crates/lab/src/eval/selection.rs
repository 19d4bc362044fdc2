//! `cargo xtask selection`: error against kept samples and fit time, for every way of choosing
//! which samples to keep.

use anyhow::Result;
use clap::Args;
use comfy_table::{Table, presets};
use faer::Mat;
use phalanx::OrientationRule;
use phalanx_multiview::CodebookTrainer;
use phalanx_rvm::{
    AgarwalTriggs, Bandwidth, BasisSpec, Fit, Kernel, MultiOutputRvm, NystromRidge,
    OrthogonalLeastSquares, PilotSample, Ridge, Stop, SufficientStatistics, random_subset,
};

use crate::clock::timed;
use crate::data::described::Samples;
use crate::data::sets::{self, Augment, Set, Test};
use crate::eval::held_out::errors::active_angles;
use crate::eval::held_out::learner::{codebooks, describe, pilot_contexts};
use crate::files;
use crate::metrics::{AngleErrors, mean_predictor};
use crate::page::Page;
use crate::progress;

const PAGE: Page<'_> =
    Page { file: "selection.md", command: "cargo xtask selection", title: "Which samples to keep" };
/// Training samples, every one of which could be kept.
const SAMPLES: usize = 3000;
const KEPT: [usize; 3] = [40, 100, 300];
const TESTS: [Test; 2] = [Test::Unseen, Test::All];
/// Width of every method's kernels, as suits few among many inputs.
const WIDTH: Bandwidth = Bandwidth::Relative(0.3);
const KERNEL: Kernel = Kernel::Gaussian(WIDTH);
/// Penalty on the weights where the method does not choose its own: it only keeps nearly dependent
/// columns apart.
const LAMBDA: f64 = 1e-3;
/// Seed of the random choice.
const SEED: u64 = 1;

#[derive(Args)]
pub struct Arguments {}

/// A way of choosing samples to keep, and of fitting their weights to all.
#[derive(Clone, Copy)]
enum Selector {
    Bridges,
    Random,
    Forward,
    MultivariateRvm,
    Nystrom,
}

impl Selector {
    const ALL: [Self; 5] =
        [Self::Bridges, Self::Random, Self::Forward, Self::MultivariateRvm, Self::Nystrom];

    fn name(self) -> &'static str {
        match self {
            Self::Bridges => "column-wise bridges",
            Self::Random => "random choice",
            Self::Forward => "forward selection",
            Self::MultivariateRvm => "multivariate RVM",
            Self::Nystrom => "subset of regressors",
        }
    }

    /// Fits all samples with Gaussians on `count` of them.
    fn fit(self, samples: &Samples, count: usize) -> Result<Fit> {
        let (x, y) = (samples.x.as_ref(), samples.y.as_ref());
        Ok(match self {
            Self::Bridges => AgarwalTriggs {
                kernel: KERNEL,
                stop: Stop::Count(count),
                ..AgarwalTriggs::default()
            }
            .fit(x, y)?,
            Self::Random => on_random_samples(samples, count)?,
            Self::Forward => {
                OrthogonalLeastSquares { kernel: KERNEL, count, lambda: LAMBDA, sweeps: 0 }
                    .fit(x, y)?
            }
            Self::MultivariateRvm => MultiOutputRvm {
                kernel: KERNEL,
                max_columns: Some(count),
                ..MultiOutputRvm::default()
            }
            .fit(x, y)?,
            Self::Nystrom => {
                let centres = random_subset(x.ncols(), count, SEED);
                NystromRidge { bandwidth: WIDTH, ..NystromRidge::default() }
                    .fit_on(x, y, &centres)?
            }
        })
    }
}

/// Ridge regression on the Gaussians of randomly chosen samples.
fn on_random_samples(samples: &Samples, count: usize) -> Result<Fit> {
    let chosen = random_subset(samples.x.ncols(), count, SEED);
    let of = |all: &Mat<f64>| Mat::from_fn(all.nrows(), count, |row, k| all[(row, chosen[k])]);
    let (pilot_x, pilot_y) = (of(&samples.x), of(&samples.y));
    let pilot = PilotSample { x: pilot_x.as_ref(), y: pilot_y.as_ref(), samples: &chosen };
    let columns = BasisSpec::new(&pilot, KERNEL)?;
    let mut sums = SufficientStatistics::new(&columns);
    sums.add(&columns, samples.x.as_ref(), samples.y.as_ref())?;
    Ok(Ridge { kernel: KERNEL, lambda: LAMBDA }.fit_sums(&columns, &sums)?)
}

/// Writes the page and prints it.
pub(crate) fn run(_: &Arguments) -> Result<()> {
    let (rig, hand, rule) = (files::rig(None)?, files::hand(None)?, OrientationRule::default());
    let bar = progress::Bar::new();
    let train = sets::random(&rig, &hand, SAMPLES, Augment::Yes);
    let views: Vec<usize> = (0..rig.cameras.len()).collect();
    let contexts = pilot_contexts(&train, rule, &bar)?;
    let books = [codebooks(&contexts, &views, &CodebookTrainer::default())?];
    drop(contexts);
    let seen = |set: &Set<'_>| -> Result<Samples> {
        Ok(describe(set, rule, &books, &bar)?.samples.swap_remove(0))
    };
    let learnt = seen(&train)?;
    let tests = TESTS.map(|test| seen(&test.set(&rig, &hand, &[])));
    let tests = tests.into_iter().collect::<Result<Vec<_>>>()?;
    drop(bar);
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN).set_header([
        "samples kept by",
        "asked for",
        "kept",
        "`unseen`, degrees",
        "`all`, degrees",
        "fit, s",
    ]);
    for selector in Selector::ALL {
        for count in KEPT {
            let (seconds, fit) = timed(|| selector.fit(&learnt, count))?;
            let model = fit.model;
            let kept = model.kept_samples().len();
            let mut row = vec![selector.name().to_owned(), count.to_string(), kept.to_string()];
            for test in &tests {
                row.push(compared(&model.predict(test.x.as_ref())?, &learnt, test));
            }
            row.push(format!("{seconds:.2}"));
            table.add_row(row);
        }
    }
    PAGE.publish(&body(&table))
}

/// The mean error over the active angles and, in brackets, over the mean predictor's.
fn compared(estimates: &Mat<f64>, learnt: &Samples, test: &Samples) -> String {
    let error = |estimates: &Mat<f64>| {
        AngleErrors::new(estimates.as_ref(), test.y.as_ref(), &active_angles()).mae()
    };
    let mae = error(estimates);
    let guessed = error(&mean_predictor(&learnt.y, test.y.ncols()));
    format!("{mae:.2} ({:.2})", mae / guessed)
}

/// What the page says around its table.
fn body(table: &Table) -> String {
    format!(
        "Mean absolute error over the 21 active angles and, in brackets, over that of predicting the training\n\
         mean, against the samples kept and the time that the fit takes. Learnt from {SAMPLES} random poses,\n\
         augmented, with three views and the paper's descriptors; every sample is a candidate, and every\n\
         method has Gaussians of the same width.\n\n{table}\n"
    )
}
