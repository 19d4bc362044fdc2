//! `cargo xtask headline`: the README's table, Table 1 beside what was never seen.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Args;
use serde::Deserialize;

use crate::files;

const BEGIN: &str = "<!-- written by cargo xtask headline -->\n";
const END: &str = "<!-- end -->\n";

#[derive(Args)]
pub(crate) struct Arguments {
    /// What `cargo xtask eval-table1 --json` wrote.
    #[arg(long, value_name = "FILE", default_value = "target/table1.json")]
    table1: PathBuf,
    /// What `cargo xtask eval-held-out --json` wrote.
    #[arg(long, value_name = "FILE", default_value = "target/held-out.json")]
    held_out: PathBuf,
}

/// The rows of either file, as far as they are of interest here.
#[derive(Deserialize)]
struct Table {
    rows: Vec<Row>,
}

#[derive(Deserialize)]
struct Row {
    #[serde(alias = "data_set")]
    train: String,
    #[serde(default)]
    test: String,
    #[serde(alias = "kernels")]
    method: String,
    #[serde(default)]
    counts: String,
    views: usize,
    mae_deg: f64,
    mean_predictor_mae_deg: f64,
}

/// A line of the table: what was learnt from, what was tested on, in words and by name.
struct Line {
    learnt: &'static str,
    tested: &'static str,
    train: &'static str,
    test: &'static str,
}

const LINES: [Line; 4] = [
    Line {
        learnt: "half of one take",
        tested: "its other half, as in Table 1",
        train: "complex",
        test: "",
    },
    Line { learnt: "one take", tested: "ten other takes", train: "complex", test: "unseen" },
    Line { learnt: "5,000 random poses", tested: "ten takes", train: "random", test: "unseen" },
    Line {
        learnt: "5,000 random poses, damaged",
        tested: "ten takes, with other hands, cameras turned by 1–3° and ragged silhouettes",
        train: "random_augmented",
        test: "all",
    },
];

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let (table1, held_out) = (read(&arguments.table1)?, read(&arguments.held_out)?);
    let rows: Vec<Row> =
        table1.rows.into_iter().filter(|row| row.counts == "paper").chain(held_out.rows).collect();
    let table = table(&rows)?;
    let path = files::in_repository("README.md");
    let readme = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let (before, rest) = readme.split_once(BEGIN).context("README.md: no place for the table")?;
    let (_, after) = rest.split_once(END).context("README.md: the table's place has no end")?;
    files::write_whole(&path, format!("{before}{BEGIN}{table}{END}{after}").as_bytes())?;
    files::print(&table)
}

fn read(path: &Path) -> Result<Table> {
    let name = || path.display().to_string();
    serde_json::from_slice(&std::fs::read(path).with_context(name)?).with_context(name)
}

fn table(rows: &[Row]) -> Result<String> {
    let mut table = String::from(
        "| learnt from | tested on | guessing the mean | “both”, one view | “both”, three | dense kernels, three |\n\
         |---|---|--:|--:|--:|--:|\n",
    );
    for line in &LINES {
        let of = |method: &str, views: usize| {
            let is = |row: &&Row| {
                (row.train.as_str(), row.test.as_str()) == (line.train, line.test)
                    && (row.method.as_str(), row.views) == (method, views)
            };
            let row = rows.iter().find(is);
            row.with_context(|| format!("no row of {} {} {method} {views}", line.train, line.test))
        };
        let dense = if line.test.is_empty() { "kernel_ridge" } else { "kernel" };
        let shown = [of("both", 1)?, of("both", 3)?, of(dense, 3)?];
        let guess = shown[0].mean_predictor_mae_deg;
        ensure!(guess > 0.0, "nothing varies in {}", line.train);
        let [one, three, dense] = shown.map(|row| {
            format!("{:.1}° ({:.2})", row.mae_deg, row.mae_deg / row.mean_predictor_mae_deg)
        });
        let Line { learnt, tested, .. } = line;
        writeln!(table, "| {learnt} | {tested} | {guess:.1}° | {one} | {three} | {dense} |")?;
    }
    Ok(table)
}
