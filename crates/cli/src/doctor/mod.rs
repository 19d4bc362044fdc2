//! `phalanx doctor`: what works, what is wrong, and what to do next.

mod consistency;
mod pictures;
mod programs;

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use clap::Args;
use serde_json::json;

use crate::finding::{Finding, State};
use crate::form::Form;
use crate::input;
use crate::recording::source::RecordingArguments;
use crate::rig::check;
use crate::segment::SegmentArguments;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The cameras, as `phalanx rig import` writes them.
    #[arg(long, value_name = "FILE.toml")]
    rig: Option<PathBuf>,
    /// A model, to be compared with the rig.
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// What the cameras recorded, as `phalanx track` takes it.
    #[arg(value_name = "RECORDING", requires = "rig")]
    recordings: Vec<String>,
    #[command(flatten)]
    segment: SegmentArguments,
    #[command(flatten)]
    form: Form,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode> {
    let findings = findings(arguments);
    let next = next(arguments, &findings);
    let said = json!({ "findings": findings, "next": next });
    arguments.form.print(&said, || Ok(text(&findings, &next)))?;
    let broken = findings.iter().any(|finding| finding.state == State::Broken);
    Ok(if broken { ExitCode::from(2) } else { ExitCode::SUCCESS })
}

/// Everything that is found; what cannot be read is a finding, and the rest is looked at all the same.
fn findings(arguments: &Arguments) -> Vec<Finding> {
    let mut findings = programs::findings();
    let rig = arguments.rig.as_ref().map(|path| check::read(path));
    let model = arguments.model.as_ref().map(|path| input::model(path));
    for (what, error) in [
        ("rig", rig.as_ref().and_then(|rig| rig.as_ref().err())),
        ("model", model.as_ref().and_then(|model| model.as_ref().err())),
    ] {
        findings.extend(error.map(|error| Finding::broken(what, format!("{error:#}"))));
    }
    let (rig, model) = (rig.and_then(Result::ok), model.and_then(Result::ok));
    findings.extend(rig.iter().flat_map(consistency::of_rig));
    findings.extend(model.as_ref().map(consistency::of_model));
    if let (Some(rig), Some(model)) = (&rig, &model) {
        findings.extend(consistency::between(rig, model));
    }
    if let Some(rig) = rig.filter(|_| !arguments.recordings.is_empty()) {
        let recordings = arguments.recordings.clone();
        let recording = RecordingArguments {
            recordings,
            segment: arguments.segment.clone(),
            ..RecordingArguments::default()
        };
        findings.extend(pictures::findings(&rig, &recording));
    }
    findings
}

/// What to do next.
fn next(arguments: &Arguments, findings: &[Finding]) -> String {
    if let Some(finding) = findings.iter().find(|finding| finding.state == State::Broken) {
        return format!("mend what is broken, first {}", finding.what);
    }
    let Some(rig) = &arguments.rig else {
        return "phalanx rig import CALIBRATION --unit mm --out rig.toml makes a rig of your calibration; \
                phalanx demo needs no camera"
            .to_owned();
    };
    let rig = rig.display();
    if arguments.recordings.is_empty() {
        return format!("phalanx doctor --rig {rig} RECORDING looks at what your cameras see");
    }
    let given = arguments.segment.given();
    let is_left = findings.iter().any(|finding| finding.what == pictures::LEFT_HAND);
    let side = if is_left { " --side left" } else { "" };
    let recordings = arguments.recordings.join(" ");
    format!("phalanx track --rig {rig} {recordings}{given}{side} --out take.csv")
}

fn text(findings: &[Finding], next: &str) -> String {
    let wide = findings.iter().map(|finding| finding.what.chars().count()).max().unwrap_or(0);
    let line = |finding: &Finding| {
        format!("{:7} {:wide$}  {}\n", finding.state.name(), finding.what, finding.text)
    };
    let lines: String = findings.iter().map(line).collect();
    format!("{lines}\nnext: {next}\n")
}
