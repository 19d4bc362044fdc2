//! In which form a command says what it found or did.

use anyhow::Result;
use clap::Args;
use phalanx_cli::files::{Output, print};
use serde::Serialize;

/// The option of every command that prints something.
#[derive(Args, Debug, Clone, Copy)]
pub(crate) struct Form {
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl Form {
    /// Prints what was found on standard output: text for people, or the value as JSON.
    pub(crate) fn print(
        self,
        value: &impl Serialize,
        text: impl FnOnce() -> Result<String>,
    ) -> Result<()> {
        print(&if self.json { pretty(value)? } else { text()? })
    }

    /// Says a line about a result that was written, after its name, or the value as JSON; on standard error
    /// where the result itself is on standard output.
    pub(crate) fn say(
        self,
        out: &Output,
        value: &impl Serialize,
        text: impl FnOnce() -> String,
    ) -> Result<()> {
        match (self.json, out.is_standard_output()) {
            (false, _) => out.say(&text()),
            (true, false) => print(&pretty(value)?),
            (true, true) => {
                eprint!("{}", pretty(value)?);
                Ok(())
            }
        }
    }

    /// Says something as JSON where that is asked for, and nothing else: text is said on standard error on
    /// the way.
    pub(crate) fn say_json(self, out: &Output, value: &impl Serialize) -> Result<()> {
        if self.json { self.say(out, value, String::new) } else { Ok(()) }
    }
}

fn pretty(value: &impl Serialize) -> Result<String> {
    Ok(serde_json::to_string_pretty(value)? + "\n")
}
