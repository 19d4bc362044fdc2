//! `cargo xtask train`: learns an estimator and saves it.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use phalanx::{Regressor, Training};
use phalanx_camera::Rig;

use crate::data_set::DataSet;
use crate::table1::{PaperCounts, TableMethod};
use crate::{files, progress};

#[derive(Args)]
pub(crate) struct Arguments {
    /// `open-close`, `complex`, or a file of poses (CSV, degrees); where θ_Z does not vary in
    /// it, each pose is repeated at seven angles from 0° to 90°.
    #[arg(long, default_value = "complex")]
    data_set: String,
    /// The cameras: names from the rig separated by commas, or `1` for the top view, `3` for all.
    #[arg(long, default_value = "3")]
    views: String,
    /// The regressor.
    #[arg(long, value_enum, default_value = "kernel_ridge")]
    kernels: TableMethod,
    /// The rig, TOML; the desk of fixtures/ by default.
    #[arg(long, value_name = "FILE.toml")]
    rig: Option<PathBuf>,
    /// The hand, TOML; the mean adult of fixtures/ by default.
    #[arg(long, value_name = "FILE.toml")]
    hand: Option<PathBuf>,
    /// Where the model goes.
    #[arg(long, value_name = "FILE", default_value = "target/hand.phalanx")]
    out: PathBuf,
}

/// The regressor, with the paper's counts where it selects; dense kernel regression is that of
/// [`Training`], for pictures that were not drawn.
fn regressor(method: TableMethod, counts: PaperCounts) -> Regressor {
    match method {
        TableMethod::KernelRidge => Training::default().regressor,
        method => method.regressor(counts).expect("nearest neighbours cannot be asked for"),
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let data_set = match arguments.data_set.as_str() {
        name @ ("open-close" | "complex") => DataSet::stored(name)?,
        path => DataSet::from_file("poses", path.as_ref())?,
    };
    let rig = files::rig(arguments.rig.as_deref())?;
    let hand = files::hand(arguments.hand.as_deref())?;
    let rig = views(&rig, &arguments.views)?;
    let counts = PaperCounts::paper(rig.cameras.len(), &data_set.name);
    let regressor = regressor(arguments.kernels, counts);
    let training = Training { regressor, ..Training::default() };
    let bar = progress::Bar::new();
    let estimator = training.run(&rig, &hand, &data_set.poses, &bar)?;
    drop(bar);
    let bytes = estimator.to_bytes()?;
    files::write_whole(&arguments.out, &bytes)?;
    let names: Vec<&str> = rig.cameras.iter().map(|camera| camera.name.as_str()).collect();
    files::print(&format!(
        "{}: {} poses of '{}' through {}; reads {} features, {} kernel centres; {} KiB\n",
        arguments.out.display(),
        data_set.poses.len(),
        data_set.name,
        names.join(", "),
        estimator.model().selected_features().len(),
        estimator.model().kept_samples().len(),
        bytes.len().div_ceil(1024),
    ))
}

/// The cameras that were asked for.
fn views(rig: &Rig, views: &str) -> Result<Rig> {
    let rig = match views {
        "3" => rig.clone(),
        "1" => rig.select(&["top"])?,
        names => rig.select(&names.split(',').map(str::trim).collect::<Vec<_>>())?,
    };
    Ok(rig)
}
