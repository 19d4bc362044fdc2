//! Figs. 8 and 9: estimated against true angles along open-close.

use anyhow::{Context, Result};
use faer::Mat;
use phalanx_hand::Dof;
use phalanx_rvm::Model;
use rayon::prelude::*;
use serde_json::json;

use super::paper_model::Trial;
use super::statistics::Mean;
use super::{Experiment, Figure, Finding, Table, Verdict};
use crate::context::Lab;
use crate::data::described::Halves;
use crate::eval::table1::{PaperCounts, TableMethod};
use crate::figures::chart::{Axis, Chart, Mark, Series};
use crate::metrics::{AngleErrors, mean_predictor};

pub(crate) const FIG_8: Experiment = Experiment {
    name: "fig-8",
    place: "Fig. 8",
    title: "two angles from two or three features",
    claim: "three linear features of one view, or two of three views, give a rough approximation \
            of the pose, shown for the index finger's middle joint and for θ_Z; and three views \
            are more accurate although they have fewer.",
    run: few_features,
};

pub(crate) const FIG_9: Experiment = Experiment {
    name: "fig-9",
    place: "Fig. 9",
    title: "the same angles from selected features and samples",
    claim: "with 13 features of one view, or 12 of three views, and 29 samples, three views are \
            more accurate, more evidently so for θ_Z than for the finger.",
    run: features_and_samples,
};

/// What the paper calls the index finger's interphalangeal joint, and θ_Z.
const ANGLES: [Dof; 2] = [Dof::IndexPip, Dof::ThetaZ];
/// Random even splits; the first is drawn.
const SPLITS: u64 = 8;

/// Cameras and counts.
struct Setting {
    words: String,
    selected: String,
    splits: Vec<OneSplit>,
}

/// One split: of each angle, what is estimated and what is true.
struct OneSplit {
    angles: [Estimated; 2],
    overall_mae_deg: f64,
}

struct Estimated {
    /// Truth and estimate of every test sample in the paper's order, degrees.
    samples: Vec<(f64, f64)>,
    mae_deg: f64,
    mean_predictor_mae_deg: f64,
}

impl Setting {
    fn mae(&self, angle: usize) -> Mean {
        self.mean(|split| split.angles[angle].mae_deg)
    }

    fn mean(&self, of: impl Fn(&OneSplit) -> f64) -> Mean {
        Mean::of(&self.splits.iter().map(of).collect::<Vec<_>>())
    }

    /// The error as a part of the mean predictor's.
    fn ratio(&self, angle: usize) -> f64 {
        self.mae(angle).value / self.mean(|split| split.angles[angle].mean_predictor_mae_deg).value
    }

    /// By which part another setting's error of an angle is smaller, split by split.
    fn gain(&self, other: &Self, angle: usize) -> Mean {
        let pairs = self.splits.iter().zip(&other.splits);
        let gain = |(a, b): (&OneSplit, &OneSplit)| {
            1.0 - b.angles[angle].mae_deg / a.angles[angle].mae_deg
        };
        Mean::of(&pairs.map(gain).collect::<Vec<_>>())
    }
}

fn few_features(lab: &Lab<'_>) -> Result<Finding> {
    let settings = settings(lab, TableMethod::Lin)?;
    let [one, three, _] = &settings;
    let rough = [0, 1].map(|angle| [one, three].iter().all(|s| s.ratio(angle) < 0.5));
    let better = [0, 1].iter().all(|&angle| one.gain(three, angle).is_above(0.0));
    let percent = |setting: &Setting, angle| 100.0 * setting.ratio(angle);
    let sentence = format!(
        "Errors as parts of the mean predictor's: {:.0} % (PIP) and {:.0} % (θ_Z) with three \
         features of one view, {:.0} % and {:.0} % with two of three views.",
        percent(one, 0),
        percent(one, 1),
        percent(three, 0),
        percent(three, 1)
    );
    let mut finding = finding(&settings, &[rough[0], rough[1], better], sentence)?;
    let [one, three] = [vec![lab.single()?], lab.all_views()].map(|views| turn_alone(lab, &views));
    finding.notes.insert(
        0,
        format!(
            "Columns are kept for all outputs together: twenty of them are angles of the fingers, \
             and θ_Z is one. Fitted to θ_Z alone, as many features bring its error to {:.0} % of \
             the mean predictor's with one view and {:.0} % with three.",
            100.0 * one?,
            100.0 * three?
        ),
    );
    Ok(finding)
}

/// The error of θ_Z as a part of the mean predictor's where the linear features are chosen for it
/// alone.
fn turn_alone(lab: &Lab<'_>, views: &[usize]) -> Result<f64> {
    let described = lab.open_close()?;
    let counts = PaperCounts::paper(views.len(), &described.name);
    let regressor = TableMethod::Lin.regressor(counts).context("it fits nothing")?;
    // One target and not 28 of which 27 are zero: the prior grows with the number of targets.
    let only = |y: &Mat<f64>| y.subrows(Dof::ThetaZ.index(), 1).to_owned();
    let ratio = |seed| -> Result<f64> {
        let Halves { train, test, .. } = described.halves(views, seed)?;
        let (train_y, truth) = (only(&train.y), only(&test.y));
        let estimates = regressor.fit(&train.x, &train_y)?.model.predict(test.x.as_ref())?;
        let guesses = mean_predictor(&train_y, truth.ncols());
        let error = |estimates: &Mat<f64>| (estimates - &truth).norm_l1();
        Ok(error(&estimates) / error(&guesses))
    };
    let ratios: Vec<Result<f64>> = (0..SPLITS).into_par_iter().map(ratio).collect();
    Ok(Mean::of(&ratios.into_iter().collect::<Result<Vec<_>>>()?).value)
}

fn features_and_samples(lab: &Lab<'_>) -> Result<Finding> {
    let settings = settings(lab, TableMethod::Both)?;
    let [one, three, _] = &settings;
    let gains = [0, 1].map(|angle| one.gain(three, angle));
    let better = gains.iter().all(|gain| gain.is_above(0.0));
    let sentence = format!(
        "From one view to three the error of PIP changes from {:.2}° to {:.2}° and that of θ_Z from \
         {:.2}° to {:.2}°.",
        one.mae(0).value,
        three.mae(0).value,
        one.mae(1).value,
        three.mae(1).value
    );
    finding(&settings, &[better, gains[1].value > gains[0].value], sentence)
}

fn finding(settings: &[Setting; 3], claims: &[bool], sentence: String) -> Result<Finding> {
    let [one, three, equal] = settings;
    let words = |single: &Setting| {
        let gain = |angle| {
            let Mean { value, standard_error } = single.gain(three, angle);
            format!("{:+.0} ± {:.0} %", -100.0 * value, 100.0 * standard_error)
        };
        format!("{} for PIP and {} for θ_Z", gain(0), gain(1))
    };
    Ok(Finding {
        verdict: Verdict::of(claims),
        sentence,
        notes: vec![
            format!(
                "Three views change the error, against one view at the paper's counts, by {}; \
                 against one view with as many columns as three views have, by {}.",
                words(one),
                words(equal)
            ),
            "The samples are those of the test half in the order of the paper: turn after turn, \
             and within a turn as the hand closes. Each is estimated by itself."
                .to_owned(),
        ],
        tables: vec![table(settings)],
        figures: figures(&settings[..2])?,
        json: json!({ "rows": settings.iter().flat_map(rows).collect::<Vec<_>>() }),
    })
}

/// One view and three at the paper's counts; then one view at those of three.
fn settings(lab: &Lab<'_>, method: TableMethod) -> Result<[Setting; 3]> {
    let (one, three) = (vec![lab.single()?], lab.all_views());
    let counts = |views: &[usize]| PaperCounts::paper(views.len(), "open-close");
    Ok([
        setting(lab, method, "one view", &one, counts(&one))?,
        setting(lab, method, "three views", &three, counts(&three))?,
        setting(lab, method, "one view, counts of three", &one, counts(&three))?,
    ])
}

fn setting(
    lab: &Lab<'_>,
    method: TableMethod,
    words: &str,
    views: &[usize],
    counts: PaperCounts,
) -> Result<Setting> {
    let described = lab.open_close()?;
    lab.progress.begin("split, fit, test", SPLITS as usize);
    let splits: Vec<Result<(OneSplit, String)>> = (0..SPLITS)
        .into_par_iter()
        .map(|seed| {
            let trial = Trial::new(described, views, counts, &[method], seed)?;
            let (model, Halves { train, test, .. }) = (&trial.models[0], &trial.halves);
            let estimates = model.predict(test.x.as_ref())?;
            let guesses = mean_predictor(&train.y, test.y.ncols());
            let split = OneSplit {
                angles: ANGLES.map(|angle| Estimated::new(angle, &test.y, &estimates, &guesses)),
                overall_mae_deg: mae(&estimates, &test.y, &described.active),
            };
            lab.progress.step();
            Ok((split, selected(model)))
        })
        .collect();
    let (splits, mut selected): (Vec<_>, Vec<_>) =
        splits.into_iter().collect::<Result<Vec<_>>>()?.into_iter().unzip();
    Ok(Setting { words: words.to_owned(), selected: selected.swap_remove(0), splits })
}

impl Estimated {
    fn new(angle: Dof, truth: &Mat<f64>, estimates: &Mat<f64>, guesses: &Mat<f64>) -> Self {
        let row = |of: &Mat<f64>, angle: Dof| -> Vec<f64> {
            of.row(angle.index()).iter().map(|value| value.to_degrees()).collect()
        };
        let turns = row(truth, Dof::ThetaZ);
        // Samples are stored frame by frame; the paper plays the motion through turn after turn.
        let mut order: Vec<usize> = (0..turns.len()).collect();
        order.sort_by(|a, b| turns[*a].total_cmp(&turns[*b]).then(a.cmp(b)));
        let (true_values, estimated) = (row(truth, angle), row(estimates, angle));
        Self {
            samples: order.into_iter().map(|i| (true_values[i], estimated[i])).collect(),
            mae_deg: mae(estimates, truth, &[angle]),
            mean_predictor_mae_deg: mae(guesses, truth, &[angle]),
        }
    }
}

fn mae(estimates: &Mat<f64>, truth: &Mat<f64>, dofs: &[Dof]) -> f64 {
    AngleErrors::new(estimates.as_ref(), truth.as_ref(), dofs).mae()
}

/// What a model kept, in words.
fn selected(model: &Model) -> String {
    let features = model.selected_features().len();
    match model.kept_samples().len() {
        0 => format!("{features} features"),
        samples => format!("{features} features, {samples} samples"),
    }
}

fn table(settings: &[Setting]) -> Table {
    let header = ["views", "selected", "PIP", "ratio", "θ_Z", "ratio", "all angles"];
    let caption = format!(
        "Mean absolute errors on the test half in degrees, ± standard errors over {SPLITS} random \
         even splits, of the index finger's PIP joint and of θ_Z, with their ratios to the mean \
         predictor's; and over all angles that vary."
    );
    let mut table = Table::new(caption, header);
    let degrees = |mean: Mean| format!("{:.2} ± {:.2}", mean.value, mean.standard_error);
    for setting in settings {
        table.row([
            setting.words.clone(),
            setting.selected.clone(),
            degrees(setting.mae(0)),
            format!("{:.2}", setting.ratio(0)),
            degrees(setting.mae(1)),
            format!("{:.2}", setting.ratio(1)),
            degrees(setting.mean(|split| split.overall_mae_deg)),
        ]);
    }
    table
}

/// Each angle with each choice of cameras, on the first split.
fn figures(settings: &[Setting]) -> Result<Vec<Figure>> {
    let labels = [("index PIP, degrees", "the index finger's PIP joint"), ("θ_Z, degrees", "θ_Z")];
    let figure = |setting: &Setting, angle: usize| {
        let Setting { words, selected, splits } = setting;
        let samples = &splits[0].angles[angle].samples;
        let line = |name, of: fn(&(f64, f64)) -> f64| {
            let points = samples.iter().enumerate().map(|(k, pair)| (k as f64, of(pair)));
            Series::new(name, Mark::Line, points.collect())
        };
        let chart = Chart {
            x: Axis::linear("test sample"),
            y: Axis::linear(labels[angle].0),
            series: vec![line("estimate", |pair| pair.1), line("truth", |pair| pair.0)],
        };
        Figure::chart(format!("{words}, {selected}: {}.", labels[angle].1), &chart)
    };
    let pairs = [0, 1].into_iter().flat_map(|angle| settings.iter().map(move |s| (s, angle)));
    pairs.map(|(setting, angle)| figure(setting, angle)).collect()
}

fn rows(setting: &Setting) -> Vec<serde_json::Value> {
    let row = |(k, angle): (usize, &Dof)| {
        let (mae, ratio) = (setting.mae(k), setting.ratio(k));
        json!({
            "setting": setting.words, "selected": setting.selected, "dof": angle.name(),
            "mae_deg": mae.value, "standard_error_deg": mae.standard_error,
            "ratio_to_mean_predictor": ratio,
        })
    };
    ANGLES.iter().enumerate().map(row).collect()
}
