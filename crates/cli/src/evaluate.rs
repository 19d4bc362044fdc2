//! `phalanx evaluate`.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use phalanx_hand::{Dof, Pose, Unit, may_be_radians};
use phalanx_io::evaluation::{
    Evaluation, LEVELS, Lag, Reference, Scores, evaluate, lag, read_csv, read_motion_file, read_trc,
};
use phalanx_io::take::JOINT_NAMES;
use serde_json::{Value, json};

use crate::counts::counted;
use crate::form::Form;
use crate::take_file;
use phalanx_cli::reading;

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
            "csv" => Ok(read_csv(reading::open(path)?)?),
            "trc" => Ok(read_trc(&reading::read_text(path)?)?),
            "mot" | "sto" => Ok(read_motion_file(&reading::read_text(path)?)?),
            "jsonl" | "npz" => Ok(Reference::from(&take_file::read(path)?)),
            _ => bail!("a reference's name ends with .csv, .trc, .mot, .sto, .jsonl or .npz"),
        }
    };
    let reference = read().with_context(|| path.display().to_string())?;
    if may_be_radians(reference.poses.iter().copied().map(Pose)) {
        eprintln!("phalanx: {}: no angle exceeds 6.28°: are they radians?", path.display());
    }
    Ok(reference)
}

/// What was compared, in the units of files.
struct Compared<'a> {
    name: &'static str,
    unit: &'static str,
    /// The mean error; of a joint along X, Y and Z.
    bias: Vec<f64>,
    mean: f64,
    rms: f64,
    count: usize,
    /// The share found within each level, where there are deviations.
    found: Option<&'a [f64]>,
}

impl<'a> Compared<'a> {
    /// `scale` is a file's number over ours.
    fn new<const N: usize>(
        name: &'static str,
        (unit, scale): (&'static str, f64),
        scores: &'a Scores<N>,
    ) -> Option<Self> {
        (scores.count > 0).then(|| Self {
            name,
            unit,
            bias: scores.bias.map(|bias| bias * scale).to_vec(),
            mean: scores.mean * scale,
            rms: scores.rms * scale,
            count: scores.count,
            found: (scores.promised > 0).then_some(&scores.coverage),
        })
    }

    fn line(&self) -> String {
        let Self { name, unit, mean, rms, .. } = self;
        let bias = self.bias.iter().map(|bias| format!("{bias:>8.2}")).collect::<Vec<_>>().concat();
        let share = |level: usize| match self.found {
            Some(found) => format!("{:>5.0}%", 100.0 * found[level]),
            None => format!("{:>6}", "-"),
        };
        let shares: String = (0..LEVELS.len()).map(share).collect();
        format!("{name:18}{bias}{mean:>8.2}{rms:>8.2} {unit:3} {shares}\n")
    }

    fn json(&self) -> Value {
        let reliability = (0..LEVELS.len()).map(|level| {
            json!({ "promised": LEVELS[level].0, "found": self.found.map(|found| found[level]) })
        });
        let bias = match &*self.bias {
            [bias] => json!(bias),
            along_axes => json!(along_axes),
        };
        json!({
            "name": self.name, "unit": self.unit, "count": self.count,
            "bias": bias, "mean": self.mean, "rms": self.rms,
            "reliability": reliability.collect::<Vec<_>>(),
        })
    }
}

fn numbers(evaluation: &Evaluation) -> Vec<Compared<'_>> {
    let dofs = Dof::ALL.into_iter().zip(&evaluation.dofs);
    let compared = dofs.filter_map(|(dof, scores)| match dof.unit() {
        Unit::Angle => Compared::new(dof.name(), ("deg", 1_f64.to_degrees()), scores),
        Unit::Length => Compared::new(dof.name(), ("mm", 1.0), scores),
    });
    compared.collect()
}

fn joints(evaluation: &Evaluation) -> Vec<Compared<'_>> {
    let joints = JOINT_NAMES.into_iter().zip(&evaluation.joints);
    joints.filter_map(|(name, scores)| Compared::new(name, ("mm", 1.0), scores)).collect()
}

fn text(evaluation: &Evaluation, lag: Option<Lag>) -> String {
    let mut text = format!(
        "{} compared, {} without a row of the reference\n",
        counted(evaluation.matched, "frame"),
        evaluation.unmatched
    );
    let _ = match lag {
        Some(Lag { seconds, correlation }) => writeln!(
            text,
            "the take is {:.1} ms late by correlation ({correlation:.2})",
            1000.0 * seconds
        ),
        None => writeln!(text, "no lag can be told"),
    };
    let (numbers, joints) = (numbers(evaluation), joints(evaluation));
    text + &table(&["bias"], &numbers)
        + &diagram("angles and places", &numbers)
        + &table(&["bias x", "y", "z"], &joints)
        + &diagram("joints", &joints)
}

/// How many characters of a diagram are 100 %.
const WIDTH: f64 = 50.0;

/// A reliability diagram of all together: a bar as long as what was found, and a mark where it was promised to end.
fn diagram(all: &str, compared: &[Compared<'_>]) -> String {
    let with_deviations = compared.iter().filter_map(|own| Some((own.found?, own.count as f64)));
    let with_deviations: Vec<(&[f64], f64)> = with_deviations.collect();
    if with_deviations.is_empty() {
        return String::new();
    }
    let count: f64 = with_deviations.iter().map(|(_, count)| count).sum();
    let line = |level: usize| {
        let promised = LEVELS[level].0;
        let within = with_deviations.iter().map(|(found, count)| found[level] * count);
        let found = within.sum::<f64>() / count;
        let [mark, end] = [promised, found].map(|share| (WIDTH * share).round() as usize);
        let at = |place: usize| match place {
            _ if place == mark => '|',
            _ if place < end => '=',
            _ => ' ',
        };
        let bar: String = (0..=WIDTH as usize).map(at).collect();
        format!("{:>5.0}% {bar} {:>5.0}%\n", 100.0 * promised, 100.0 * found)
    };
    let lines: String = (0..LEVELS.len()).map(line).collect();
    format!("\nreliability of all {all}: | promised, = found\n{lines}")
}

/// A line for each, unless there is none.
fn table(biases: &[&str], compared: &[Compared<'_>]) -> String {
    if compared.is_empty() {
        return String::new();
    }
    let names = biases.iter().map(|bias| format!("{bias:>8}")).collect::<Vec<_>>().concat();
    let blank = " ".repeat(18 + 8 * (biases.len() + 2) + 5);
    let levels = LEVELS.map(|(level, _)| format!("{:>5.0}%", 100.0 * level)).concat();
    let lines: String = compared.iter().map(Compared::line).collect();
    format!(
        "\n{:18}{names}{:>8}{:>8}      found within what is promised of\n{blank}{levels}\n{lines}",
        "", "mean", "rms"
    )
}

fn json(evaluation: &Evaluation, lag: Option<Lag>) -> Value {
    let compared = numbers(evaluation).into_iter().chain(joints(evaluation));
    json!({
        "matched": evaluation.matched,
        "unmatched": evaluation.unmatched,
        "lag": lag.map(|lag| json!({ "seconds": lag.seconds, "correlation": lag.correlation })),
        "compared": compared.map(|compared| compared.json()).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(found: &[f64]) -> Vec<String> {
        let (bias, found) = (vec![0.0], Some(found));
        let own = Compared { name: "a", unit: "deg", bias, mean: 0.0, rms: 0.0, count: 10, found };
        diagram("angles", &[own]).lines().skip(2).map(str::to_owned).collect()
    }

    #[test]
    fn a_bar_ends_at_its_mark_where_deviations_hold() {
        let lines = lines(&LEVELS.map(|(level, _)| level));
        assert_eq!(lines.len(), LEVELS.len());
        assert!(lines.iter().all(|line| line.contains("=| ")), "{lines:?}");
    }

    #[test]
    fn a_bar_is_short_where_deviations_are_too_small_and_there_is_none_without_them() {
        let short = lines(&[0.0; LEVELS.len()]);
        assert!(short.iter().all(|line| line.contains('|') && !line.contains('=')), "{short:?}");
        assert_eq!(diagram("angles", &[]), "");
    }
}
