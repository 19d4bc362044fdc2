//! `phalanx evaluate`.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use phalanx_hand::{Dof, Unit};
use phalanx_io::evaluation::{
    Evaluation, LEVELS, Lag, Reference, Scores, evaluate, lag, read_csv, read_motion_file, read_trc,
};
use phalanx_io::take::JOINT_NAMES;
use serde_json::{Value, json};

use crate::form::Form;
use crate::take_file;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The take: .csv, .jsonl or .npz.
    #[arg(value_name = "TAKE")]
    take: PathBuf,
    /// What another instrument says: .csv with columns named as a take's or with a row a joint (frame or time,
    /// joint, x, y, z), .trc with the joints as markers, .mot with columns named by phalanx, OpenSim's ARMS hand or
    /// myoHand, or another take as .jsonl or .npz.
    #[arg(long, value_name = "FILE")]
    reference: PathBuf,
    /// Take the lag that is found from the take's times before comparing.
    #[arg(long)]
    align: bool,
    #[command(flatten)]
    form: Form,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let take = take_file::read(&arguments.take)?;
    let reference = reference(&arguments.reference)?;
    let lag = lag(&take, &reference);
    let shift = match (arguments.align, lag) {
        (true, Some(lag)) => lag.seconds,
        (true, None) => bail!("no lag can be told from these motions, so they cannot be aligned"),
        (false, _) => 0.0,
    };
    let evaluation = evaluate(&take, &reference, shift);
    ensure!(
        evaluation.matched > 0,
        "no frame of the take has a row of the reference; do their times begin alike?"
    );
    arguments.form.print(&json(&evaluation, lag), || Ok(text(&evaluation, lag)))
}

fn reference(path: &Path) -> Result<Reference> {
    let read = || -> Result<Reference> {
        match take_file::extension(path).as_str() {
            "csv" => Ok(read_csv(std::fs::File::open(path)?)?),
            "trc" => Ok(read_trc(&std::fs::read_to_string(path)?)?),
            "mot" | "sto" => Ok(read_motion_file(&std::fs::read_to_string(path)?)?),
            "jsonl" | "npz" => Ok(Reference::from(&take_file::read(path)?)),
            _ => bail!("a reference's name ends with .csv, .trc, .mot, .sto, .jsonl or .npz"),
        }
    };
    read().with_context(|| path.display().to_string())
}

/// Each compared number or joint with its unit and what a file's number is of ours.
fn compared(evaluation: &Evaluation) -> Vec<(&'static str, &'static str, f64, &Scores)> {
    let dofs = Dof::ALL.into_iter().zip(&evaluation.dofs).map(|(dof, scores)| match dof.unit() {
        Unit::Angle => (dof.name(), "deg", 1_f64.to_degrees(), scores),
        Unit::Length => (dof.name(), "mm", 1.0, scores),
    });
    let joints = JOINT_NAMES.into_iter().zip(&evaluation.joints);
    let all = dofs.chain(joints.map(|(name, scores)| (name, "mm", 1.0, scores)));
    all.filter(|(.., scores)| scores.count > 0).collect()
}

fn text(evaluation: &Evaluation, lag: Option<Lag>) -> String {
    let mut text = format!(
        "{} frames compared, {} without a row of the reference\n",
        evaluation.matched, evaluation.unmatched
    );
    let _ = match lag {
        Some(Lag { seconds, correlation }) => writeln!(
            text,
            "the take is {:.1} ms late by correlation ({correlation:.2})",
            1000.0 * seconds
        ),
        None => writeln!(text, "no lag can be told"),
    };
    let levels = LEVELS.map(|(level, _)| format!("{:>5.0}%", 100.0 * level)).concat();
    let _ = writeln!(
        text,
        "\n{:18}{:>8}{:>8}{:>8}      within what is promised of",
        "", "bias", "mean", "rms"
    );
    let _ = writeln!(text, "{:18}{:>8}{:>8}{:>8}     {levels}", "", "", "", "");
    for (name, unit, scale, scores) in compared(evaluation) {
        let [bias, mean, rms] = [scores.bias, scores.mean, scores.rms].map(|e| e * scale);
        let promised = scores.coverage.map(|share| match scores.promised {
            0 => format!("{:>6}", "-"),
            _ => format!("{:>5.0}%", 100.0 * share),
        });
        let _ = writeln!(
            text,
            "{name:18}{bias:>8.2}{mean:>8.2}{rms:>8.2} {unit:3} {}",
            promised.concat()
        );
    }
    text
}

fn json(evaluation: &Evaluation, lag: Option<Lag>) -> Value {
    let entry = |(name, unit, scale, scores): (&str, &str, f64, &Scores)| {
        let coverage = LEVELS.iter().zip(scores.coverage).map(|((level, _), share)| {
            json!({ "promised": level, "found": (scores.promised > 0).then_some(share) })
        });
        json!({
            "name": name, "unit": unit, "count": scores.count,
            "bias": scores.bias * scale, "mean": scores.mean * scale, "rms": scores.rms * scale,
            "reliability": coverage.collect::<Vec<_>>(),
        })
    };
    json!({
        "matched": evaluation.matched,
        "unmatched": evaluation.unmatched,
        "lag": lag.map(|lag| json!({ "seconds": lag.seconds, "correlation": lag.correlation })),
        "compared": compared(evaluation).into_iter().map(entry).collect::<Vec<_>>(),
    })
}
