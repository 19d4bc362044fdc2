//! The paper's figures and claims, one experiment each, on the same small harness.

mod cost;
mod descriptor_noise;
mod digits_out;
mod error_by_turn;
mod estimated_angles;
mod finding;
mod fusion;
mod held_out;
mod manifold;
mod nearest_pose;
mod orientations;
pub(crate) mod page;
mod paper_model;
mod rolled;
mod selected_features;
mod selected_samples;
mod shape_context;
mod sparsity;
mod statistics;
mod table1;
mod thresholds;
mod voting_places;

use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::Args;
use clap::builder::PossibleValuesParser;

use crate::context::Lab;
use crate::files;
use crate::progress;

pub(crate) use finding::{Content, Figure, Finding, Table, Verdict};

/// One of the paper's figures or claims, and how it is put to the test.
pub(crate) struct Experiment {
    /// Its command.
    pub(crate) name: &'static str,
    /// Where the paper has it.
    pub(crate) place: &'static str,
    pub(crate) title: &'static str,
    /// What the paper shows or claims, in our words.
    pub(crate) claim: &'static str,
    pub(crate) run: fn(&Lab<'_>) -> Result<Finding>,
}

/// In the order of the paper.
pub(crate) const ALL: &[Experiment] = &[
    shape_context::EXPERIMENT,
    orientations::EXPERIMENT,
    fusion::EXPERIMENT,
    manifold::EXPERIMENT,
    nearest_pose::EXPERIMENT,
    sparsity::EXPERIMENT,
    thresholds::EXPERIMENT,
    table1::EXPERIMENT,
    error_by_turn::EXPERIMENT,
    selected_samples::EXPERIMENT,
    descriptor_noise::EXPERIMENT,
    selected_features::EXPERIMENT,
    estimated_angles::FIG_8,
    estimated_angles::FIG_9,
    cost::EXPERIMENT,
    held_out::EXPERIMENT,
    rolled::EXPERIMENT,
];

#[derive(Args)]
pub struct Arguments {
    /// Which one.
    #[arg(value_parser = PossibleValuesParser::new(ALL.iter().map(|e| e.name)))]
    name: String,
    /// A folder of real photographs; without it their part is left out.
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Where its JSON and its figures go.
    #[arg(long, value_name = "DIR", default_value = "target/report")]
    out: PathBuf,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let bar = progress::Bar::new();
    let lab = Lab::new(arguments.data.as_deref(), &bar)?;
    let experiment = ALL.iter().find(|experiment| experiment.name == arguments.name);
    let experiment = experiment.expect("the parser knows the names");
    let finding = (experiment.run)(&lab)?;
    drop(bar);
    write(experiment, &finding, &arguments.out)?;
    files::print(&text(experiment, &finding))
}

/// Writes an experiment's JSON and figures under its name.
pub(crate) fn write(experiment: &Experiment, finding: &Finding, folder: &Path) -> Result<()> {
    let mut json = serde_json::to_vec_pretty(&finding.json)?;
    json.push(b'\n');
    files::write_whole(&folder.join(format!("{}.json", experiment.name)), &json)?;
    for (k, figure) in finding.figures.iter().enumerate() {
        let (extension, _, bytes) = figure.file();
        let name = format!("{}-{}.{extension}", experiment.name, k + 1);
        files::write_whole(&folder.join(name), bytes)?;
    }
    Ok(())
}

/// What a terminal shows.
fn text(experiment: &Experiment, finding: &Finding) -> String {
    let Experiment { place, title, claim, .. } = experiment;
    let (verdict, sentence) = (finding.verdict.words(), &finding.sentence);
    let mut text =
        format!("# {place}: {title}\n\nThe paper: {claim}\n\nVerdict: {verdict}. {sentence}\n\n");
    text.extend(finding.notes.iter().map(|note| format!("{note}\n\n")));
    text.extend(finding.tables.iter().map(|table| format!("{}\n", table.markdown())));
    text
}
