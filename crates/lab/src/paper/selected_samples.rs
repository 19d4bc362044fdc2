//! § 5.2: are the samples that the Gaussian regressor keeps near a fist?

use anyhow::Result;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use serde_json::json;

use super::paper_model::Trial;
use super::statistics::Mean;
use super::{Experiment, Figure, Finding, Table, Verdict};
use crate::context::Lab;
use crate::data::described::Described;
use crate::eval::table1::{PaperCounts, TableMethod};
use crate::figures::chart::{Axis, Chart, Mark, Series};

pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "section-5-2-selected",
    place: "§ 5.2",
    title: "which samples are kept",
    claim: "with one view as with three, most of the few samples of open-close that the Gaussian \
            regressor keeps are hands that are nearly fists.",
    run,
};

const METHODS: [TableMethod; 3] = [TableMethod::Gauss, TableMethod::Both, TableMethod::Forward];
/// How many random even splits: on open-close, of which the paper speaks, each keeps but ten
/// samples, and whether half of them are fists needs many splits to tell.
fn splits(set: &str) -> u64 {
    if set == "open-close" { 20 } else { 5 }
}

/// Draws of as many samples at random, for what chance alone would give.
const DRAWS: usize = 1000;

/// What one method keeps with one choice of cameras.
struct Kept {
    set: String,
    views: &'static str,
    method: &'static str,
    splits: Vec<OneSplit>,
}

struct OneSplit {
    /// Flexions of the kept samples and of the whole training half, degrees.
    kept: Vec<f64>,
    training: Vec<f64>,
    /// Where each kept sample lies in the training half: the percentage that is less flexed.
    percentiles: Vec<f64>,
    /// Means of percentiles of random draws.
    chance: Vec<f64>,
}

impl Kept {
    fn over_splits(&self, of: impl Fn(&OneSplit) -> f64) -> Mean {
        Mean::of(&self.splits.iter().map(of).collect::<Vec<_>>())
    }

    fn percentile(&self) -> Mean {
        self.over_splits(|split| mean(&split.percentiles))
    }

    /// Which part of the kept samples is among the most flexed third, and which among the least.
    fn fists(&self) -> Mean {
        self.over_splits(|split| share(&split.percentiles, |p| p > 200.0 / 3.0))
    }

    fn flat(&self) -> f64 {
        self.over_splits(|split| share(&split.percentiles, |p| p < 100.0 / 3.0)).value
    }

    /// Between what 95 % of random choices have their mean percentile over the splits.
    fn chance(&self) -> (f64, f64) {
        let over_splits =
            |draw| mean(&self.splits.iter().map(|s| s.chance[draw]).collect::<Vec<_>>());
        let mut draws: Vec<f64> = (0..DRAWS).map(over_splits).collect();
        draws.sort_unstable_by(f64::total_cmp);
        (draws[DRAWS * 25 / 1000], draws[DRAWS * 975 / 1000])
    }
}

fn run(lab: &Lab<'_>) -> Result<Finding> {
    let mut all = Vec::new();
    for described in [lab.open_close()?, lab.complex()?] {
        for (words, views) in lab.one_and_all()? {
            all.extend(kept(lab, described, words, &views)?);
        }
    }
    let of = |set: &str, method: TableMethod| -> Vec<&Kept> {
        all.iter().filter(|kept| kept.set == set && kept.method == method.name()).collect()
    };
    let claimed = of("open-close", TableMethod::Gauss);
    let leans = |kept: &&Kept| kept.percentile().value > kept.chance().1;
    let most = |kept: &&Kept| kept.fists().value > 0.5;
    let claims: Vec<bool> = claimed.iter().map(leans).chain(claimed.iter().map(most)).collect();
    let words = |kept: &&Kept| {
        let ((low, high), fists) = (kept.chance(), kept.fists());
        format!(
            "{:.0} ± {:.0} % of them with {} (mean percentile {:.0}, chance {low:.0} to {high:.0})",
            100.0 * fists.value,
            100.0 * fists.standard_error,
            kept.views,
            kept.percentile().value
        )
    };
    Ok(Finding {
        verdict: Verdict::of(&claims),
        sentence: format!(
            "Of the samples of open-close that gauss keeps, the most flexed third of the hands \
             makes up {}; by chance it would be a third.",
            claimed.iter().map(words).collect::<Vec<_>>().join(" and ")
        ),
        notes: notes(&claimed, &of("open-close", TableMethod::Forward)),
        tables: vec![table(&all)],
        figures: figures(&all)?,
        json: json!({ "rows": all.iter().map(row).collect::<Vec<_>>() }),
    })
}

/// What all methods keep with some cameras.
fn kept(
    lab: &Lab<'_>,
    described: &Described,
    words: &'static str,
    views: &[usize],
) -> Result<Vec<Kept>> {
    let counts = PaperCounts::paper(views.len(), &described.name);
    let seeds = splits(&described.name);
    lab.progress.begin("split, fit", seeds as usize);
    let splits: Vec<Result<Vec<OneSplit>>> = (0..seeds)
        .into_par_iter()
        .map(|seed| {
            let trial = Trial::new(described, views, counts, &METHODS, seed)?;
            let training = trial.halves.train.flexion();
            lab.progress.step();
            Ok(trial.models.iter().map(|m| one_split(&training, m.kept_samples(), seed)).collect())
        })
        .collect();
    let mut splits = splits.into_iter().collect::<Result<Vec<_>>>()?;
    // The last method's are taken off first.
    let take = |method: &TableMethod| Kept {
        set: described.name.clone(),
        views: words,
        method: method.name(),
        splits: splits.iter_mut().filter_map(Vec::pop).collect(),
    };
    let mut all: Vec<Kept> = METHODS.iter().rev().map(take).collect();
    all.reverse();
    Ok(all)
}

fn one_split(training: &[f64], kept: &[usize], seed: u64) -> OneSplit {
    let places = percentiles(training);
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut order: Vec<usize> = (0..training.len()).collect();
    let mut draw = || {
        for k in 0..kept.len() {
            let rest = (order.len() - k) as u64;
            order.swap(k, k + (random.next_u64() % rest) as usize);
        }
        mean(&order[..kept.len()].iter().map(|&i| places[i]).collect::<Vec<_>>())
    };
    OneSplit {
        chance: (0..DRAWS).map(|_| draw()).collect(),
        percentiles: kept.iter().map(|&i| places[i]).collect(),
        kept: kept.iter().map(|&i| training[i]).collect(),
        training: training.to_vec(),
    }
}

/// Which percentage of the values is below each of them, equal ones counted by half.
fn percentiles(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let place = |value: &f64| {
        let below = sorted.partition_point(|other| other < value);
        let up_to = sorted.partition_point(|other| other <= value);
        50.0 * (below + up_to) as f64 / sorted.len() as f64
    };
    values.iter().map(place).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn share(values: &[f64], is: impl Fn(f64) -> bool) -> f64 {
    values.iter().filter(|value| is(**value)).count() as f64 / values.len() as f64
}

fn notes(gauss: &[&Kept], forward: &[&Kept]) -> Vec<String> {
    let words = |kept: &&Kept| {
        format!(
            "{:.0} % and {:.0} % with {}",
            100.0 * kept.fists().value,
            100.0 * kept.flat(),
            kept.views
        )
    };
    let list = |all: &[&Kept]| all.iter().map(words).collect::<Vec<_>>().join(", ");
    vec![
        format!(
            "Most and least flexed third: gauss keeps {}; forward selection, which takes at each \
             step the sample that lowers the error most, keeps {}.",
            list(gauss),
            list(forward)
        ),
        "The paper counts no fists, so what near-fist means is decided here: the most flexed third \
         of the training half. Thirds and percentiles count samples and not degrees, so that it does \
         not matter where a motion lingers."
            .to_owned(),
    ]
}

fn table(all: &[Kept]) -> Table {
    let header = [
        "data set",
        "kernels",
        "views",
        "kept",
        "mean flexion",
        "of the half",
        "percentile",
        "chance",
        "flattest third",
        "fist third",
    ];
    let caption = format!(
        "Mean flexion of the fingers, degrees, of the samples kept and of the training half, over \
         {} random even splits ({} of complex); mean percentile of the kept ones in the half, ± its standard \
         error; the interval of 95 % of as many samples drawn at random; and which part of the kept \
         ones is in the least and the most flexed third.",
        splits("open-close"),
        splits("complex")
    );
    let mut table = Table::new(caption, header);
    for kept in all {
        let Mean { value, standard_error } = kept.percentile();
        let (low, high) = kept.chance();
        table.row([
            kept.set.clone(),
            kept.method.to_owned(),
            kept.views.to_owned(),
            format!("{:.0}", kept.over_splits(|split| split.kept.len() as f64).value),
            format!("{:.1}", kept.over_splits(|split| mean(&split.kept)).value),
            format!("{:.1}", kept.over_splits(|split| mean(&split.training)).value),
            format!("{value:.0} ± {standard_error:.0}"),
            format!("{low:.0} – {high:.0}"),
            format!("{:.0} %", 100.0 * kept.flat()),
            format!("{:.0} %", 100.0 * kept.fists().value),
        ]);
    }
    table
}

/// For each data set and choice of cameras, which part is flexed less than so much.
fn figures(all: &[Kept]) -> Result<Vec<Figure>> {
    let pooled = |kept: &Kept, of: fn(&OneSplit) -> &[f64]| {
        let mut values: Vec<f64> = kept.splits.iter().flat_map(|s| of(s).iter().copied()).collect();
        values.sort_unstable_by(f64::total_cmp);
        let count = values.len() as f64;
        let steps = values.into_iter().enumerate();
        steps.map(|(k, value)| (value, 100.0 * (k + 1) as f64 / count)).collect::<Vec<_>>()
    };
    let figure = |methods: &[Kept]| {
        let mut series: Vec<Series> = methods
            .iter()
            .map(|kept| Series::new(kept.method, Mark::Line, pooled(kept, |split| &split.kept)))
            .collect();
        let whole = pooled(&methods[0], |split| &split.training);
        series.push(Series::new("all samples", Mark::Line, whole));
        let chart = Chart {
            x: Axis::linear("mean flexion of the fingers, degrees"),
            y: Axis::from_zero("% of the samples up to it"),
            series,
        };
        let Kept { set, views, .. } = &methods[0];
        let caption = format!(
            "{set}, {views}: how flexed the kept samples are. A line below that of all samples \
             means fists."
        );
        Figure::chart(caption, &chart)
    };
    all.chunks(METHODS.len()).map(figure).collect()
}

fn row(kept: &Kept) -> serde_json::Value {
    let (low, high) = kept.chance();
    json!({
        "data_set": kept.set, "views": kept.views, "kernels": kept.method,
        "kept": kept.over_splits(|split| split.kept.len() as f64).value,
        "kept_flexion_deg": kept.over_splits(|split| mean(&split.kept)).value,
        "training_flexion_deg": kept.over_splits(|split| mean(&split.training)).value,
        "percentile": kept.percentile().value,
        "percentile_standard_error": kept.percentile().standard_error,
        "chance_low": low, "chance_high": high,
        "flattest_third_share": kept.flat(), "fist_third_share": kept.fists().value,
    })
}

#[cfg(test)]
mod tests {
    use super::percentiles;

    #[test]
    fn percentiles_share_ties() {
        assert_eq!(percentiles(&[3.0, 1.0, 1.0, 7.0]), [62.5, 25.0, 25.0, 87.5]);
    }
}
