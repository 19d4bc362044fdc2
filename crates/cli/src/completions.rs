//! `phalanx completions`.

use anyhow::Result;
use clap::Args;
use clap_complete::Shell;
use phalanx_cli::files::print;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The shell.
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// Prints a shell's completions of the program.
pub(crate) fn run(arguments: &Arguments, mut program: clap::Command) -> Result<()> {
    let name = program.get_name().to_owned();
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut program, name, &mut script);
    print(&String::from_utf8(script)?)
}
