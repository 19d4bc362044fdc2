//! `cargo xtask merge`: joins the parts of a training that was run in shards.

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use phalanx::PartialTraining;

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
    let mut merged: Option<PartialTraining> = None;
    for path in &arguments.parts {
        let name = || path.display().to_string();
        let part = PartialTraining::from_bytes(&std::fs::read(path).with_context(name)?)
            .with_context(name)?;
        match &mut merged {
            None => merged = Some(part),
            Some(merged) => merged.merge(part).with_context(name)?,
        }
    }
    let bar = progress::Bar::new();
    let merged = merged.context("there is no part")?;
    let estimator = train::finish(merged, arguments.hypotheses, &bar)?;
    drop(bar);
    train::save(&estimator, &out)
}
