//! `cargo xtask bench-peers`: our crates beside the best packages that do the same, on the same
//! data, in one run and on one thread each. Writes docs/results/peers.md.

mod data;
mod hand;
mod kmeans;
mod page;
mod prediction;
mod problems;
mod programs;
mod row;
mod shape_contexts;
mod widths;

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::{Args, ValueEnum};

use crate::files;
use crate::page::Page;
use programs::Peers;
use row::Row;

const PAGE: Page<'_> = Page {
    file: "peers.md",
    command: "cargo xtask bench-peers --peers DIR",
    title: "Beside others",
};

#[derive(Args)]
pub struct Arguments {
    /// The folder of the peers' scripts.
    #[arg(long, value_name = "DIR")]
    peers: PathBuf,
    /// Only these parts; the page is then printed and docs/results/peers.md left as it is.
    #[arg(long, value_delimiter = ',')]
    only: Vec<Part>,
    /// Also write the rows to this file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// A part of the page.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Sinc and Friedman's problems at a given width, beside fastrvm.
    Rvm,
    /// Friedman's problems with learnt widths, beside a dense Gaussian process.
    Widths,
    /// Many outputs at once.
    Hand,
    /// Codebooks of 100,000 histograms.
    Kmeans,
    /// The shape contexts of one silhouette.
    ShapeContexts,
    /// One sample to 24 numbers.
    Prediction,
}

impl Part {
    fn rows(self, peers: &Peers) -> Result<Vec<Row>> {
        match self {
            Self::Rvm => problems::rows(peers),
            Self::Widths => widths::rows(peers),
            Self::Hand => hand::rows(peers),
            Self::Kmeans => kmeans::rows(peers),
            Self::ShapeContexts => shape_contexts::rows(peers),
            Self::Prediction => prediction::rows(peers),
        }
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let peers = Peers::install(&arguments.peers);
    let parts = if arguments.only.is_empty() { Part::value_variants() } else { &arguments.only };
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut rows = Vec::new();
    for part in parts {
        rows.extend(one_thread.install(|| part.rows(&peers))?);
    }
    if let Some(path) = &arguments.json {
        files::write_whole(path, &serde_json::to_vec_pretty(&rows).context("rows to JSON")?)?;
    }
    let body = page::body(&rows, &peers);
    if arguments.only.is_empty() {
        PAGE.write(&body)?;
    }
    files::print(&PAGE.text(&body))
}
