//! `cargo xtask report`: every experiment, and one page for a reader of the paper.

mod course;
mod html;

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use clap::Args;

use crate::context::Lab;
use crate::files;
use crate::paper::{self, ALL};
use course::Course;
use html::Section;

#[derive(Args)]
pub struct Arguments {
    /// A folder of real photographs; without it their parts are left out.
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Where the page goes, and every experiment's JSON and figures.
    #[arg(long, value_name = "DIR", default_value = "target/report")]
    out: PathBuf,
}

/// Runs all experiments. One that fails is named in its section, on standard error and by exit
/// code 1; the others' results are kept.
pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode> {
    let course = Course::new(ALL.len());
    let lab = Lab::new(arguments.data.as_deref(), &course)?;
    let mut sections = Vec::new();
    for experiment in ALL {
        course.enter(experiment.name);
        let outcome = (experiment.run)(&lab);
        if let Ok(finding) = &outcome {
            paper::write(experiment, finding, &arguments.out)?;
        }
        sections.push(Section { experiment, outcome });
    }
    drop(course);
    let path = arguments.out.join("index.html");
    files::write_whole(&path, html::page(&sections).as_bytes())?;
    files::print(&format!("{}\n", path.display()))?;
    let mut code = ExitCode::SUCCESS;
    for Section { experiment, outcome } in &sections {
        if let Err(error) = outcome {
            eprintln!("error: {}: {error:#}", experiment.name);
            code = ExitCode::from(1);
        }
    }
    Ok(code)
}
