//! § 5.2: how the error grows as the hand turns its side to the single camera.

use anyhow::{Context, Result};
use faer::Mat;
use phalanx_hand::Dof;
use rayon::prelude::*;
use serde_json::json;

use super::paper_model::Trial;
use super::statistics::Mean;
use super::{Experiment, Figure, Finding, Table, Verdict};
use crate::context::Lab;
use crate::data::described::Described;
use crate::eval::table1::{PaperCounts, SPLITS, TableMethod};
use crate::figures::chart::{Axis, Chart, Mark, Series};
use crate::metrics::mean_predictor;

pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "section-5-2-turn",
    place: "§ 5.2",
    title: "the error against θ_Z",
    claim: "seen by the top camera alone, the pose is estimated the worse the further the hand has \
            turned about the forearm, since the fingers then point along the camera's axis and \
            offer it little; other cameras make up for that.",
    run,
};

/// The paper's three, and one that keeps all samples: what the cameras offer, whatever is selected.
const METHODS: [TableMethod; 4] =
    [TableMethod::Lin, TableMethod::Gauss, TableMethod::Both, TableMethod::KernelRidge];
const TURNS: usize = 7;
/// How many of the turns count as little, and as many as much, turned.
const END: usize = 3;

/// Mean absolute errors of the internal angles at each turn, degrees.
type ByTurn = [f64; TURNS];

/// One curve: a method's with one choice of cameras, and the mean predictor's.
struct Curve {
    set: String,
    views: &'static str,
    method: &'static str,
    /// Of every split.
    runs: Vec<ByTurn>,
    guessing: ByTurn,
}

impl Curve {
    fn mean(&self) -> ByTurn {
        std::array::from_fn(|turn| Mean::of(&self.at(turn)).value)
    }

    fn at(&self, turn: usize) -> Vec<f64> {
        self.runs.iter().map(|run| run[turn]).collect()
    }

    /// The error from 60° on as a multiple of that up to 30°.
    fn growth(&self) -> Mean {
        let of =
            |run: &ByTurn| run[TURNS - END..].iter().sum::<f64>() / run[..END].iter().sum::<f64>();
        Mean::of(&self.runs.iter().map(of).collect::<Vec<_>>())
    }
}

fn run(lab: &Lab<'_>) -> Result<Finding> {
    let mut curves = Vec::new();
    for described in [lab.open_close()?, lab.complex()?] {
        for (words, views) in lab.one_and_all()? {
            curves.extend(of_views(lab, described, words, &views)?);
        }
    }
    let (one, three): (Vec<_>, Vec<_>) = curves.iter().partition(|c| c.views == "one view");
    let judgements = ["open-close", "complex"].map(|set| Judgement::of(set, &one, &three));
    let claims: Vec<bool> = judgements.iter().flat_map(Judgement::claims).collect();
    let sentences: Vec<String> = judgements.iter().map(Judgement::sentence).collect();
    let mut notes = vec![
        "Errors are those of the 20 internal angles: θ_Z is left out, so that they can be \
         compared from one turn to another. The fingers move alike at every turn, so the mean \
         predictor's error is the same at all of them but for the chance of the split."
            .to_owned(),
    ];
    notes.push(causes(&one, &three)?);
    Ok(Finding {
        verdict: Verdict::of(&claims),
        sentence: format!(
            "Error of the fingers from 60° to 90° as a multiple of that from 0° to 30°, mean of lin, \
             gauss and both: {}.",
            sentences.join("; ")
        ),
        notes,
        tables: vec![table(&curves)],
        figures: figures(&one, &three)?,
        json: json!({ "rows": curves.iter().flat_map(rows).collect::<Vec<_>>() }),
    })
}

/// The growth of the paper's three methods on one data set.
struct Judgement {
    set: &'static str,
    /// With one view, and with three.
    growths: [f64; 2],
    /// With how many methods the error clearly grows for one view, and less for three views.
    grow: usize,
    less: usize,
}

impl Judgement {
    const METHODS: usize = 3;

    fn of(set: &'static str, one: &[&Curve], three: &[&Curve]) -> Self {
        let pairs = || {
            let pairs = one.iter().zip(three).filter(|(a, _)| a.set == set);
            pairs.filter(|(a, _)| a.method != TableMethod::KernelRidge.name())
        };
        let mean = |growths: Vec<f64>| growths.iter().sum::<f64>() / growths.len() as f64;
        Self {
            set,
            growths: [
                mean(pairs().map(|(a, _)| a.growth().value).collect()),
                mean(pairs().map(|(_, b)| b.growth().value).collect()),
            ],
            grow: pairs().filter(|(a, _)| a.growth().is_above(1.0)).count(),
            less: pairs().filter(|(a, b)| b.growth().value < a.growth().value).count(),
        }
    }

    fn claims(&self) -> [bool; 2] {
        [self.grow == Self::METHODS, self.less == Self::METHODS]
    }

    fn sentence(&self) -> String {
        let Self { set, growths: [one, three], grow, less } = self;
        format!(
            "on {set} {one:.2} with one view (clearly above 1 for {grow} of {} methods) and \
             {three:.2} with three (less for {less})",
            Self::METHODS
        )
    }
}

/// Whether it is the view or the regressor that the error grows with.
fn causes(one: &[&Curve], three: &[&Curve]) -> Result<String> {
    let dense = |curves: &[&Curve], set: &str| {
        let mut dense = curves.iter().filter(|c| c.method == TableMethod::KernelRidge.name());
        let found = dense.find(|c| c.set == set).context("dense kernels have no curve")?;
        anyhow::Ok(found.growth().value)
    };
    // The first turn against those in the middle, where every view is as good as at the first.
    let edge = |curve: &&Curve| {
        let mean = curve.mean();
        mean[0] * 3.0 / mean[1..4].iter().sum::<f64>()
    };
    let edges = one.iter().chain(three).map(edge).sum::<f64>() / (one.len() + three.len()) as f64;
    Ok(format!(
        "Two things may be mixed in a sparse regressor's curve. One is what the camera sees: a dense \
         regressor that keeps all samples has {:.2} times the error on open-close and {:.2} times on \
         complex with one view, {:.2} and {:.2} times with three. The other is that both ends of the \
         trained range have neighbours on one side only: at 0°, which is such an end, the error is \
         {edges:.2} times that from 15° to 45°, in the mean of all curves.",
        dense(one, "open-close")?,
        dense(one, "complex")?,
        dense(three, "open-close")?,
        dense(three, "complex")?
    ))
}

/// The curves of all methods with some cameras.
fn of_views(
    lab: &Lab<'_>,
    described: &Described,
    words: &'static str,
    views: &[usize],
) -> Result<Vec<Curve>> {
    let counts = PaperCounts::paper(views.len(), &described.name);
    lab.progress.begin("split, fit, test", SPLITS as usize);
    let splits: Vec<Result<Vec<ByTurn>>> = (0..SPLITS)
        .into_par_iter()
        .map(|seed| {
            let trial = Trial::new(described, views, counts, &METHODS, seed)?;
            let test = &trial.halves.test;
            let mut errors = vec![by_turn(
                &mean_predictor(&trial.halves.train.y, test.y.ncols()),
                &test.y,
                described,
            )];
            for model in &trial.models {
                errors.push(by_turn(&model.predict(test.x.as_ref())?, &test.y, described));
            }
            lab.progress.step();
            Ok(errors)
        })
        .collect();
    let splits = splits.into_iter().collect::<Result<Vec<_>>>()?;
    let runs = |k: usize| splits.iter().map(|split| split[k]).collect::<Vec<_>>();
    let guesses = runs(0);
    let guessing = std::array::from_fn(|turn| {
        guesses.iter().map(|run| run[turn]).sum::<f64>() / guesses.len() as f64
    });
    let curve = |(k, method): (usize, &TableMethod)| Curve {
        set: described.name.clone(),
        views: words,
        method: method.name(),
        runs: runs(k + 1),
        guessing,
    };
    Ok(METHODS.iter().enumerate().map(curve).collect())
}

/// The mean absolute error of the internal angles at each turn, degrees.
fn by_turn(estimates: &Mat<f64>, truth: &Mat<f64>, described: &Described) -> ByTurn {
    let internal = || described.active.iter().filter(|dof| dof.is_internal());
    let (mut sums, mut counts) = ([0.0; TURNS], [0_usize; TURNS]);
    for i in 0..truth.ncols() {
        let turn = turn_of(truth[(Dof::ThetaZ.index(), i)]);
        for dof in internal() {
            sums[turn] += (estimates[(dof.index(), i)] - truth[(dof.index(), i)]).abs();
            counts[turn] += 1;
        }
    }
    std::array::from_fn(|turn| (sums[turn] / counts[turn] as f64).to_degrees())
}

/// Which of the seven turns an angle is.
fn turn_of(theta_z: f64) -> usize {
    (theta_z.to_degrees() / 15.0).round() as usize
}

fn degrees(turn: usize) -> f64 {
    15.0 * turn as f64
}

fn table(curves: &[Curve]) -> Table {
    let mut header = ["data set", "kernels", "views"].map(str::to_owned).to_vec();
    header.extend((0..TURNS).map(|turn| format!("{:.0}°", degrees(turn))));
    header.extend(["(mean)", "growth"].map(str::to_owned));
    let caption = format!(
        "Mean absolute error of the internal angles in degrees at each θ_Z, over {SPLITS} random \
         even splits; (mean): the mean predictor's over all turns; growth: from 60° on as a \
         multiple of up to 30°, ± its standard error."
    );
    let mut table = Table::new(caption, header);
    for curve in curves {
        let mut cells = vec![curve.set.clone(), curve.method.to_owned(), curve.views.to_owned()];
        cells.extend(curve.mean().iter().map(|error| format!("{error:.2}")));
        cells.push(format!("{:.2}", curve.guessing.iter().sum::<f64>() / TURNS as f64));
        let Mean { value, standard_error } = curve.growth();
        cells.push(format!("{value:.2} ± {standard_error:.2}"));
        table.row(cells);
    }
    table
}

fn figures(one: &[&Curve], three: &[&Curve]) -> Result<Vec<Figure>> {
    let figure = |(a, b): (&&Curve, &&Curve)| {
        let series = [a, b].map(|curve| {
            let points = curve.mean().into_iter().enumerate().map(|(k, e)| (degrees(k), e));
            Series::new(curve.views, Mark::LineAndDots, points.collect())
        });
        let chart = Chart {
            x: Axis::linear("θ_Z, degrees"),
            y: Axis::from_zero("mean error of the fingers, degrees"),
            series: series.into(),
        };
        Figure::chart(
            format!("{} on {}: error of the fingers against θ_Z.", a.method, a.set),
            &chart,
        )
    };
    one.iter().zip(three).map(figure).collect()
}

fn rows(curve: &Curve) -> Vec<serde_json::Value> {
    let row = |turn| {
        let error = Mean::of(&curve.at(turn));
        json!({
            "data_set": curve.set, "views": curve.views, "kernels": curve.method,
            "theta_z_deg": degrees(turn), "internal_mae_deg": error.value,
            "standard_error_deg": error.standard_error,
            "mean_predictor_internal_mae_deg": curve.guessing[turn],
        })
    };
    (0..TURNS).map(row).collect()
}
