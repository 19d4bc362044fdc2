//! `cargo xtask merge`: joins the parts of a training that was run in shards.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use phalanx_cli::parts;

use crate::files;
use crate::progress;
use crate::recipes::train;

#[derive(Args)]
pub struct Arguments {
    /// The parts that `cargo xtask train --shard` wrote, in any order.
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,
    /// Learn too how estimates err, as `train --preset NAME --hypotheses` does.
    #[arg(long)]
    hypotheses: bool,
    /// Where the model goes.
    #[arg(long, value_name = "FILE", default_value = "target/hand.phalanx")]
    out: PathBuf,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let out = files::output(&arguments.out, &arguments.parts)?;
    let merged = parts::merged(&arguments.parts)?;
    let bar = progress::Bar::new();
    let estimator = train::finish(merged, arguments.hypotheses, &bar)?;
    drop(bar);
    train::save(&estimator, &out)
}
