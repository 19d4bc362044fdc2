//! `cargo xtask headline`: the README's table of presets and refinement on unseen motion, and the table of
//! the paper's recipe in `docs/results/README.md`.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Args;
use serde::Deserialize;

use phalanx_lab::files;

const REFINED: &str = "<!-- refined: written by cargo xtask headline -->\n";
const PAPER: &str = "<!-- paper: written by cargo xtask headline -->\n";
const END: &str = "<!-- end -->\n";

/// The pages that the tables are in.
const FRONT_PAGE: &str = "README.md";
const RESULTS: &str = "docs/results/README.md";

/// A table whose files are not named stays as it is.
#[derive(Args)]
#[group(required = true, multiple = true)]
pub(crate) struct Arguments {
    /// What `cargo xtask eval-table1 --json` wrote.
    #[arg(long, value_name = "FILE", requires = "held_out")]
    table1: Option<PathBuf>,
    /// What `cargo xtask eval-held-out --json` wrote.
    #[arg(long, value_name = "FILE", requires = "table1")]
    held_out: Option<PathBuf>,
    /// What `cargo xtask eval-held-out --methods preset,refined,refined_own_hand --tests unseen,all
    /// --json` wrote.
    #[arg(long, value_name = "FILE")]
    refined: Option<PathBuf>,
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
    let mut tables = Vec::new();
    if let Some(path) = &arguments.refined {
        tables.push((FRONT_PAGE, REFINED, refined(&read(path)?.rows)?));
    }
    if let (Some(table1), Some(held_out)) = (&arguments.table1, &arguments.held_out) {
        let of_paper = read(table1)?.rows.into_iter().filter(|row| row.counts == "paper");
        let rows: Vec<Row> = of_paper.chain(read(held_out)?.rows).collect();
        tables.push((RESULTS, PAPER, paper(&rows)?));
    }
    for (page, place, table) in &tables {
        let path = files::in_repository(page);
        let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        let text = with_table(&text, place, table).with_context(|| path.display().to_string())?;
        files::write_whole(&path, text.as_bytes())?;
    }
    let tables: Vec<String> = tables.into_iter().map(|(.., table)| table).collect();
    files::print(&tables.join("\n"))
}

/// The page with a table in its place.
fn with_table(page: &str, begin: &str, table: &str) -> Result<String> {
    let (before, rest) = page.split_once(begin).context("there is no place for a table")?;
    let (_, after) = rest.split_once(END).context("a table's place has no end")?;
    Ok(format!("{before}{begin}{table}{END}{after}"))
}

fn read(path: &Path) -> Result<Table> {
    let name = || path.display().to_string();
    serde_json::from_slice(&std::fs::read(path).with_context(name)?).with_context(name)
}

/// The row of a training set, a test, a method and a number of views.
fn find<'a>(rows: &'a [Row], [train, test, method]: [&str; 3], views: usize) -> Result<&'a Row> {
    let is = |row: &&Row| {
        [row.train.as_str(), row.test.as_str(), row.method.as_str()] == [train, test, method]
            && row.views == views
    };
    let row = rows.iter().find(is);
    row.with_context(|| format!("no row of {train} {test} {method} {views}"))
}

fn error(row: &Row) -> String {
    format!("{:.1}° ({:.2})", row.mae_deg, row.mae_deg / row.mean_predictor_mae_deg)
}

fn refined(rows: &[Row]) -> Result<String> {
    const METHODS: [&str; 3] = ["preset", "refined", "refined_own_hand"];
    const TESTS: [(&str, &str); 2] = [
        ("unseen", "ten takes of motion"),
        ("all", "the same by other hands, cameras turned by 1–3°, ragged silhouettes"),
    ];
    let mut table = String::from(
        "| tested on | views | guessing the mean | estimated | refined | refined, own hand |\n\
         |---|--:|--:|--:|--:|--:|\n",
    );
    for (test, tested) in TESTS {
        for views in 1..=3 {
            let row = |method| find(rows, ["random_augmented", test, method], views);
            let guess = row(METHODS[0])?.mean_predictor_mae_deg;
            let cells = METHODS.map(|method| row(method).map(error));
            let [estimated, refined, own] = cells;
            let (estimated, refined, own) = (estimated?, refined?, own?);
            let tested = if views == 1 { tested } else { "" };
            writeln!(
                table,
                "| {tested} | {views} | {guess:.1}° | {estimated} | {refined} | {own} |"
            )?;
        }
    }
    Ok(table)
}

fn paper(rows: &[Row]) -> Result<String> {
    let mut table = String::from(
        "| learnt from | tested on | guessing the mean | “both”, one view | “both”, three | dense kernels, three |\n\
         |---|---|--:|--:|--:|--:|\n",
    );
    for Line { learnt, tested, train, test } in &LINES {
        let dense = if test.is_empty() { "kernel_ridge" } else { "kernel" };
        let of = |method, views| find(rows, [train, test, method], views);
        let shown = [of("both", 1)?, of("both", 3)?, of(dense, 3)?];
        let guess = shown[0].mean_predictor_mae_deg;
        ensure!(guess > 0.0, "nothing varies in {train}");
        let [one, three, dense] = shown.map(error);
        writeln!(table, "| {learnt} | {tested} | {guess:.1}° | {one} | {three} | {dense} |")?;
    }
    Ok(table)
}
