//! `phalanx man`: the manual, made of the commands' help.

mod markdown;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Args;
use phalanx_cli::files::Output;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The folder that the pages go to, or with --markdown the file; without one that page is printed.
    #[arg(value_name = "DIR", required_unless_present = "markdown")]
    out: Option<PathBuf>,
    /// Write one page in Markdown with all commands, in place of a manual page for each.
    #[arg(long)]
    markdown: bool,
}

/// Writes the manual of the program.
pub(crate) fn run(arguments: &Arguments, program: clap::Command) -> Result<()> {
    let out = arguments.out.as_deref().unwrap_or(Path::new("-"));
    let mut program = program.disable_help_subcommand(true);
    if arguments.markdown {
        // Gives each subcommand its whole name.
        program.build();
        return Output::new(out, &[] as &[PathBuf])?.write(markdown::page(&program).as_bytes());
    }
    ensure!(out.is_dir(), "{}: there is no such folder", out.display());
    clap_mangen::generate_to(program, out).with_context(|| out.display().to_string())
}
