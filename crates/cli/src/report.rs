//! `phalanx report`.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use phalanx_cli::files::Output;
use phalanx_io::report::{
    FrameChoice, NamedRange, RangeOfMotion, print_page, range_table, to_csv, to_json, to_text,
};
use phalanx_io::take::Take;

use crate::counts::counted;
use crate::form::Form;
use crate::take_file;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The take: .csv, .jsonl or .npz.
    #[arg(value_name = "TAKE")]
    take: PathBuf,
    /// A second one, to stand beside it with the differences (the second less the first).
    #[arg(value_name = "TAKE2")]
    second: Option<PathBuf>,
    /// Count doubted frames, too.
    #[arg(long)]
    all_frames: bool,
    /// Where the table goes, as .csv or as .html to print; else it is printed as text.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    form: Form,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let first = range(&arguments.take, arguments)?;
    let second = arguments.second.as_deref().map(|path| range(path, arguments)).transpose()?;
    let names = names(&arguments.take, arguments.second.as_deref());
    let table = range_table(
        NamedRange { name: &names[0], range: &first },
        second.as_ref().map(|range| NamedRange { name: &names[1], range }),
    );
    let json = to_json(&table);
    let Some(out) = &arguments.out else {
        return arguments.form.print(&json, || Ok(to_text(&table)));
    };
    let inputs: Vec<&PathBuf> = std::iter::once(&arguments.take).chain(&arguments.second).collect();
    let output = Output::new(out, &inputs)?;
    match take_file::extension(out).as_str() {
        "csv" => output.write(&to_csv(&table)?)?,
        "html" => output.write(print_page(&table).as_bytes())?,
        _ => bail!("{}: the name must end with .csv or .html", out.display()),
    }
    arguments.form.say_json(&output, &json)
}

/// What two takes are called: by their files' names, or by all of their paths where these are the same.
fn names(first: &Path, second: Option<&Path>) -> [String; 2] {
    let names = [Some(first), second].map(|path| path.map(take_file::name).unwrap_or_default());
    if names[0] != names[1] {
        return names;
    }
    [Some(first), second].map(|path| path.map(|own| own.display().to_string()).unwrap_or_default())
}

fn range(path: &Path, arguments: &Arguments) -> Result<RangeOfMotion> {
    let take = take_file::read(path)?;
    let choice = if arguments.all_frames { FrameChoice::All } else { FrameChoice::Trusted };
    RangeOfMotion::of(&take, choice).with_context(|| {
        format!(
            "{}: no frame can be trusted: {} (--all-frames counts doubted ones)",
            path.display(),
            doubts(&take)
        )
    })
}

/// What speaks against a take's frames, each with the number of frames, the most frequent first.
fn doubts(take: &Take) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for doubt in take.frames.iter().flat_map(|frame| &frame.doubts) {
        *counts.entry(doubt).or_default() += 1;
    }
    let mut counts: Vec<(&str, usize)> = counts.into_iter().collect();
    counts.sort_by_key(|&(_, count)| Reverse(count));
    let frames = counted(take.frames.len(), "frame");
    let said = counts.iter().map(|(doubt, count)| format!("{doubt} in {count} of {frames}"));
    said.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_of_one_name_are_told_apart_by_their_folders() {
        let names = |first, second| super::names(Path::new(first), Some(Path::new(second)));
        assert_eq!(names("before.csv", "after.csv"), ["before", "after"]);
        assert_eq!(
            names("before/take.csv", "after/take.csv"),
            ["before/take.csv", "after/take.csv"]
        );
    }
}
