//! Table 1: the errors of the three regressors, with each camera alone beside it.

use anyhow::{Context, Result};
use phalanx_hand::Dof;
use serde::Serialize;
use serde_json::json;

use super::{Experiment, Finding, Table, Verdict};
use crate::context::Lab;
use crate::eval::table1::{self, HEADER, Row, TableMethod, legend};

pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "table-1",
    place: "Table 1",
    title: "the errors on synthetic images",
    claim: "three views are more accurate than one; how much they gain depends on which single \
            view they are compared with; and with one view θ_Z of open-close is estimated worst.",
    run,
};

const METHODS: [TableMethod; 3] = [TableMethod::Lin, TableMethod::Gauss, TableMethod::Both];

/// A row and the cameras that it stands for.
#[derive(Serialize)]
struct Seen {
    cameras: Vec<String>,
    #[serde(flatten)]
    row: Row,
}

/// One method on one data set, at equal counts: the mean absolute error with each camera alone,
/// and with all, degrees.
struct Contest {
    data_set: String,
    kernels: &'static str,
    alone: Vec<f64>,
    all: f64,
}

impl Contest {
    /// By which part all cameras lower the error of a single one.
    fn gain(&self, single: f64) -> f64 {
        1.0 - self.all / single
    }

    /// How many cameras there are.
    fn views(&self) -> usize {
        self.alone.len()
    }

    fn best(&self) -> f64 {
        self.alone.iter().copied().fold(f64::INFINITY, f64::min)
    }

    fn worst(&self) -> f64 {
        self.alone.iter().copied().fold(0.0, f64::max)
    }
}

fn run(lab: &Lab<'_>) -> Result<Finding> {
    let (single, all) = (lab.single()?, lab.all_views());
    let one_and_all = [vec![single], all.clone()];
    let others: Vec<_> = all.iter().filter(|view| **view != single).map(|v| vec![*v]).collect();
    let (mut standing, mut alone) = (Vec::new(), Vec::new());
    for described in [lab.open_close()?, lab.complex()?] {
        let rows = table1::evaluate(described, &one_and_all, lab.progress)?;
        standing.extend(named(lab, &one_and_all, rows));
        let rows = table1::evaluate_equally(described, &others, all.len(), lab.progress)?;
        alone.extend(named(lab, &others, rows));
    }
    let contests = contests(lab, &standing, &alone)?;
    let (claims, sentence) = judged(single, &standing, &contests);
    let tables = vec![
        as_it_stands(&standing, "paper"),
        as_it_stands(&standing, "equal"),
        each_alone(lab, &contests),
    ];
    let notes = notes(&lab.rig.cameras[single].name, &standing, &contests)?;
    standing.extend(alone);
    Ok(Finding {
        verdict: Verdict::of(&claims),
        sentence,
        notes,
        tables,
        figures: Vec::new(),
        json: json!({ "rows": standing }),
    })
}

/// Gives the rows, equally many for each choice of cameras, their cameras' names.
fn named(lab: &Lab<'_>, choices: &[Vec<usize>], rows: Vec<Row>) -> Vec<Seen> {
    let each = rows.len() / choices.len();
    let name = |view: &usize| lab.rig.cameras[*view].name.clone();
    let cameras = |k: usize| choices[k / each].iter().map(name).collect();
    rows.into_iter().enumerate().map(|(k, row)| Seen { cameras: cameras(k), row }).collect()
}

/// Every method on both data sets, at the counts of all views.
fn contests(lab: &Lab<'_>, standing: &[Seen], alone: &[Seen]) -> Result<Vec<Contest>> {
    let mae = |data_set: &str, kernels: &str, cameras: &[String]| {
        let found = standing.iter().chain(alone).find(|Seen { cameras: of, row }| {
            of == cameras
                && row.counts == "equal"
                && row.data_set == data_set
                && row.kernels == kernels
        });
        let missing = || format!("no row of {kernels} on {data_set} for {cameras:?}");
        found.map(|seen| seen.row.mae_deg).with_context(missing)
    };
    let names: Vec<String> = lab.rig.cameras.iter().map(|camera| camera.name.clone()).collect();
    let contest = |data_set: &str, method: TableMethod| {
        let kernels = method.name();
        let alone = names.iter().map(|name| mae(data_set, kernels, std::slice::from_ref(name)));
        Ok(Contest {
            data_set: data_set.to_owned(),
            kernels,
            alone: alone.collect::<Result<_>>()?,
            all: mae(data_set, kernels, &names)?,
        })
    };
    ["open-close", "complex"]
        .iter()
        .flat_map(|set| METHODS.map(|method| contest(set, method)))
        .collect()
}

/// Three claims: more views are better than the single view at equal counts, everywhere; the gain
/// over the worst camera is, on average, at least twice that over the best; with one view θ_Z is
/// the worst angle of open-close for every method.
fn judged(single: usize, standing: &[Seen], contests: &[Contest]) -> (Vec<bool>, String) {
    let better = contests.iter().filter(|contest| contest.all < contest.alone[single]).count();
    let mean = |gain: fn(&Contest) -> f64| {
        100.0 * contests.iter().map(gain).sum::<f64>() / contests.len() as f64
    };
    let over_best = mean(|contest| contest.gain(contest.best()));
    let over_worst = mean(|contest| contest.gain(contest.worst()));
    let is_turn = |row: &&Row| row.worst_dof == Dof::ThetaZ.name();
    let turns = one_view_open_close(standing).filter(is_turn).count();
    let claims = vec![
        better == contests.len(),
        over_worst > 0.0 && over_worst >= 2.0 * over_best,
        turns == METHODS.len(),
    ];
    let sentence = format!(
        "At equal counts three views are more accurate than the top view in {better} of {} \
         comparisons; on average they lower the error by {over_best:.0} % against whichever camera \
         is best alone and by {over_worst:.0} % against the worst; with one view θ_Z of open-close \
         is worst for {turns} of {} methods.",
        contests.len(),
        METHODS.len()
    );
    (claims, sentence)
}

/// The paper's regressors on open-close with the single view, at the paper's counts.
fn one_view_open_close(standing: &[Seen]) -> impl Iterator<Item = &Row> {
    standing.iter().map(|seen| &seen.row).filter(|row| {
        row.views == 1
            && row.counts == "paper"
            && row.data_set == "open-close"
            && METHODS.iter().any(|method| method.name() == row.kernels)
    })
}

fn notes(single: &str, standing: &[Seen], contests: &[Contest]) -> Result<Vec<String>> {
    let paper = |views: usize, contest: &Contest| {
        let mut rows = standing.iter().map(|seen| &seen.row);
        let is = |row: &&Row| {
            (row.views, row.counts, row.kernels) == (views, "paper", contest.kernels)
                && row.data_set == contest.data_set
        };
        let missing = || format!("no row of {views} views for {}", contest.kernels);
        rows.find(is).map(|row| row.mae_deg).with_context(missing)
    };
    let pair =
        |contest| Ok((contest, paper(1, contest)?, paper(Contest::views(contest), contest)?));
    let lost: Vec<String> = contests
        .iter()
        .map(pair)
        .collect::<Result<Vec<_>>>()?
        .into_iter()
        .filter(|(_, one, all)| all >= one)
        .map(|(contest, one, all)| {
            format!("{} on {} ({one:.2}° → {all:.2}°)", contest.kernels, contest.data_set)
        })
        .collect();
    let mut notes = vec![format!(
        "The single view is the camera “{single}”. Degrees are not comparable with the paper's: \
         its motion is not public, and it does not give the error of the mean predictor."
    )];
    if !lost.is_empty() {
        notes.push(format!(
            "At the paper's own counts, which give three views one feature fewer on open-close, \
             they do not gain with {}.",
            lost.join(" and ")
        ));
    }
    Ok(notes)
}

/// The table as the paper has it, at its counts or at equal ones.
fn as_it_stands(standing: &[Seen], counts: &str) -> Table {
    let title = match counts {
        "paper" => "At the paper's counts",
        _ => "At equal counts, those of three views",
    };
    let mut table = Table::new(format!("{title}: {}", legend().replace('\n', " ")), HEADER);
    table.rows = table1::lines(standing.iter().map(|seen| &seen.row), counts);
    table
}

fn each_alone(lab: &Lab<'_>, contests: &[Contest]) -> Table {
    let mut header = vec!["data set".to_owned(), "kernels".to_owned()];
    header.extend(lab.rig.cameras.iter().map(|camera| format!("{} alone", camera.name)));
    header.extend(["all", "gain over best", "gain over worst"].map(str::to_owned));
    let caption = "Mean absolute error in degrees with each camera alone and with all, at equal \
                   counts, and by how much all lower the error of the best and of the worst camera.";
    let mut table = Table::new(caption, header);
    for contest in contests {
        let mut cells = vec![contest.data_set.clone(), contest.kernels.to_owned()];
        cells.extend(contest.alone.iter().map(|mae| format!("{mae:.2}")));
        cells.push(format!("{:.2}", contest.all));
        cells.push(format!("{:.0} %", 100.0 * contest.gain(contest.best())));
        cells.push(format!("{:.0} %", 100.0 * contest.gain(contest.worst())));
        table.row(cells);
    }
    table
}
