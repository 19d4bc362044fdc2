//! `phalanx man`: the manual, made of the commands' help.

mod markdown;

use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};
use clap::Args;
use clap_mangen::Man;
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
    // Gives each subcommand its whole name.
    program.build();
    if arguments.markdown {
        return Output::new(out, &[] as &[PathBuf])?.write(markdown::page(&program).as_bytes());
    }
    ensure!(out.is_dir(), "{}: there is no such folder", out.display());
    write_pages(&program, out)
}

/// Writes the pages of a command and of all its subcommands, each whole or not at all.
fn write_pages(command: &clap::Command, folder: &Path) -> Result<()> {
    let page = Man::new(command.clone());
    let mut bytes = Vec::new();
    page.render(&mut bytes)?;
    Output::new(&folder.join(page.get_filename()), &[] as &[&Path])?.write(&bytes)?;
    let mut shown = command.get_subcommands().filter(|subcommand| !subcommand.is_hide_set());
    shown.try_for_each(|subcommand| write_pages(subcommand, folder))
}
