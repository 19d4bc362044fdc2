//! Fig. 6: how many vectors survive a threshold.

use anyhow::{Context, Result};
use phalanx_rvm::{AgarwalTriggs, Bandwidth, Kernel, Stop};
use rayon::prelude::*;
use serde_json::json;

use super::{Experiment, Figure, Finding, Table, Verdict};
use crate::context::Lab;
use crate::data::described::Samples;
use crate::figures::chart::{Axis, Chart, Mark, Series};

pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "fig-6",
    place: "Fig. 6, § 5.1",
    title: "selected vectors against the threshold",
    claim: "on open-close the same threshold T_a keeps more relevance vectors with one view than with \
            three, for linear and for Gaussian columns.",
    run,
};

const SPLITS: u64 = 5;
/// Thresholds a decade, and decades from the lowest: the columns' norms follow from the kernel.
const PER_DECADE: i32 = 4;
const DECADES: i32 = 3;
const KERNELS: [(&str, Kernel, f64); 2] = [
    ("linear", Kernel::Linear, 0.01),
    ("Gaussian", Kernel::Gaussian(Bandwidth::Relative(1.0)), 0.1),
];
/// The priors compared; the first is drawn. ν bounds what survives at any threshold: only with a
/// weak one does the threshold decide over all of the columns.
const NU: [f64; 3] = [1e-6, 1e-4, 1e-2];
/// The threshold decides where it leaves less than this share of what the prior alone leaves.
const CUT: f64 = 0.95;
/// The claim holds if one view keeps more at this share of the thresholds that decide, and in
/// part if it does at half of them.
const NEARLY_ALWAYS: f64 = 0.9;

/// Mean numbers of vectors kept at each threshold.
struct Curves {
    kernel: &'static str,
    nu: f64,
    thresholds: Vec<f64>,
    one: Vec<f64>,
    three: Vec<f64>,
    /// Of the splits' thresholds at which the two differ, the share where one view keeps more:
    /// of all, and of those that decide. None where they never differ.
    share: Option<f64>,
    deciding_share: Option<f64>,
}

fn run(lab: &Lab<'_>) -> Result<Finding> {
    let described = lab.open_close()?;
    let [(_, one), (_, three)] = lab.one_and_all()?;
    let train = |views: &[usize]| -> Result<Vec<Samples>> {
        (0..SPLITS).into_par_iter().map(|seed| Ok(described.halves(views, seed)?.train)).collect()
    };
    let (one, three) = (train(&one)?, train(&three)?);
    lab.progress.begin("fit at every threshold", KERNELS.len() * NU.len());
    let mut curves = Vec::new();
    for (name, kernel, lowest) in KERNELS {
        let thresholds: Vec<f64> = (0..=DECADES * PER_DECADE)
            .map(|k| lowest * 10_f64.powf(f64::from(k) / f64::from(PER_DECADE)))
            .collect();
        for nu in NU {
            // How many survive is settled long before the weights are.
            let bridges =
                AgarwalTriggs { kernel, nu, max_iterations: 300, ..AgarwalTriggs::default() };
            let one = kept(&one, bridges, &thresholds)?;
            let three = kept(&three, bridges, &thresholds)?;
            curves.push(Curves::new(name, nu, thresholds.clone(), &one, &three));
            lab.progress.step();
        }
    }
    finding(&curves)
}

/// How many columns each split keeps at each threshold.
fn kept(splits: &[Samples], bridges: AgarwalTriggs, thresholds: &[f64]) -> Result<Vec<Vec<usize>>> {
    let runs: Vec<(&Samples, f64)> =
        splits.iter().flat_map(|split| thresholds.iter().map(move |&t| (split, t))).collect();
    let counts: Vec<usize> = runs
        .into_par_iter()
        .map(|(samples, threshold)| {
            let bridges = AgarwalTriggs { stop: Stop::Threshold(threshold), ..bridges };
            let fit = bridges.fit(samples.x.as_ref(), samples.y.as_ref())?;
            Ok(fit.model.weights().ncols())
        })
        .collect::<Result<_>>()?;
    Ok(counts.chunks(thresholds.len()).map(<[usize]>::to_vec).collect())
}

impl Curves {
    fn new(
        kernel: &'static str,
        nu: f64,
        thresholds: Vec<f64>,
        one: &[Vec<usize>],
        three: &[Vec<usize>],
    ) -> Self {
        let cut = |counts: &[usize], t: usize| (counts[t] as f64) < CUT * counts[0] as f64;
        let (mut all, mut deciding) = (Tally::default(), Tally::default());
        for (one, three) in one.iter().zip(three) {
            for t in 0..thresholds.len() {
                all.add(one[t], three[t]);
                if cut(one, t) || cut(three, t) {
                    deciding.add(one[t], three[t]);
                }
            }
        }
        let mean = |splits: &[Vec<usize>]| {
            let at = |t| splits.iter().map(|counts| counts[t]).sum::<usize>() as f64;
            (0..thresholds.len()).map(|t| at(t) / splits.len() as f64).collect()
        };
        Self {
            one: mean(one),
            three: mean(three),
            share: all.share(),
            deciding_share: deciding.share(),
            kernel,
            nu,
            thresholds,
        }
    }

    fn chart(&self) -> Chart {
        let series = |name, counts: &[f64]| {
            let points = self.thresholds.iter().copied().zip(counts.iter().copied()).collect();
            Series::new(name, Mark::LineAndDots, points)
        };
        Chart {
            x: Axis::logarithmic("threshold on a column's norm"),
            y: Axis::from_zero("vectors kept"),
            series: vec![series("one view", &self.one), series("three views", &self.three)],
        }
    }
}

/// How often one view keeps more vectors than three, where they differ.
#[derive(Default)]
struct Tally {
    more: usize,
    apart: usize,
}

impl Tally {
    fn add(&mut self, one: usize, three: usize) {
        self.more += usize::from(one > three);
        self.apart += usize::from(one != three);
    }

    fn share(&self) -> Option<f64> {
        (self.apart > 0).then(|| self.more as f64 / self.apart as f64)
    }
}

fn finding(curves: &[Curves]) -> Result<Finding> {
    let drawn: Vec<&Curves> = curves.iter().filter(|curve| curve.nu == NU[0]).collect();
    let share = |curve: &&Curves| {
        let share = curve.deciding_share;
        share.with_context(|| format!("no threshold tells the {} columns apart", curve.kernel))
    };
    let shares = drawn.iter().map(share).collect::<Result<Vec<f64>>>()?;
    let claims: Vec<bool> =
        shares.iter().flat_map(|share| [0.5, NEARLY_ALWAYS].map(|least| *share >= least)).collect();
    let words = |(share, curve): (&f64, &&Curves)| {
        format!("{:.0} % with {} columns", 100.0 * share, curve.kernel)
    };
    let shares: Vec<String> = shares.iter().zip(&drawn).map(words).collect();
    let figures = drawn.iter().map(|curve| {
        let caption =
            format!("{} columns, ν = {:e}, mean of {SPLITS} splits.", curve.kernel, curve.nu);
        Figure::chart(caption, &curve.chart())
    });
    let (table, rows) = table(curves);
    Ok(Finding {
        verdict: Verdict::of(&claims),
        sentence: format!(
            "Of the thresholds that decide, and at which the two differ, one view keeps more \
             vectors at {}.",
            shares.join(" and at ")
        ),
        notes: vec![format!(
            "Below some threshold the prior ν alone says how many columns survive, and there the \
             counts say nothing of T_a; the paper does not give its ν. Counted are the thresholds \
             that leave less than {:.0} % of what the lowest leaves, to either.",
            100.0 * CUT
        )],
        tables: vec![table],
        figures: figures.collect::<Result<_>>()?,
        json: json!({ "rows": rows }),
    })
}

fn table(curves: &[Curves]) -> (Table, Vec<serde_json::Value>) {
    let mut table = Table::new(
        format!(
            "Vectors kept by one view / by three at some thresholds T, mean of {SPLITS} splits, and \
             at which share of the thresholds one view keeps more."
        ),
        ["columns", "ν", "kept", "", "", "more, where T decides", "anywhere"],
    );
    let percent = |share: Option<f64>| {
        share.map_or_else(|| "–".to_owned(), |share| format!("{:.0} %", 100.0 * share))
    };
    let mut rows = Vec::new();
    for curve in curves {
        let at = |t: usize| {
            format!("T = {:.3}: {:.0} / {:.0}", curve.thresholds[t], curve.one[t], curve.three[t])
        };
        table.row([
            curve.kernel.to_owned(),
            format!("{:e}", curve.nu),
            at(0),
            at(6),
            at(8),
            percent(curve.deciding_share),
            percent(curve.share),
        ]);
        for (t, &threshold) in curve.thresholds.iter().enumerate() {
            rows.push(json!({
                "kernel": curve.kernel, "nu": curve.nu, "threshold": threshold,
                "one_view": curve.one[t], "three_views": curve.three[t],
            }));
        }
    }
    (table, rows)
}
