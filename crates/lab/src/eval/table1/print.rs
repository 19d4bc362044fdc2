//! The table on standard output.

use comfy_table::{Table, presets};

use anyhow::Result;

use super::paper::PaperRow;
use super::row::{Row, SPLITS};
use crate::files;

pub(crate) const HEADER: [&str; 12] = [
    "views",
    "data set",
    "kernels",
    "ftrs.",
    "smpls.",
    "avg.",
    "ratio",
    "STD",
    "worst",
    "which dof",
    "paper avg. / STD / worst",
    "paper which",
];

/// How the cells are to be read.
pub(crate) fn legend() -> String {
    format!(
        "means of {SPLITS} random even splits, in degrees over the\n\
         active angles. Ratio: avg. over the error of predicting the training mean. ~: to which of three\n\
         cells the paper's figure belongs is a guess; ·: not legible."
    )
}

pub(crate) fn print(rows: &[Row]) -> Result<()> {
    files::print(&format!(
        "# Table 1\n\nPrinted by `cargo xtask eval-table1`: {}\n\n\
         Test poses are neighbours of training poses here, in the same sequence. What to expect of poses\n\
         that were never seen, `cargo xtask eval-held-out` tells.\n\n\
         ## At the paper's counts\n\n{}\n\n## At equal counts: those of three views\n\n{}\n",
        legend(),
        table(rows, "paper"),
        table(rows, "equal")
    ))
}

fn table(rows: &[Row], counts: &str) -> Table {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN).set_header(HEADER).add_rows(lines(rows, counts));
    table
}

/// The table's lines at the paper's or at equal counts, each block after its mean predictor.
pub(crate) fn lines<'a>(rows: impl IntoIterator<Item = &'a Row>, counts: &str) -> Vec<Vec<String>> {
    let mut lines = Vec::new();
    let mut block: Option<(usize, &str)> = None;
    for row in rows.into_iter().filter(|row| row.counts == counts) {
        let this = (row.views, row.data_set.as_str());
        if block != Some(this) {
            block = Some(this);
            lines.push(mean_predictor_cells(row));
        }
        lines.push(cells(row));
    }
    lines
}

fn mean_predictor_cells(row: &Row) -> Vec<String> {
    let mean = format!("{:.2}", row.mean_predictor_mae_deg);
    let text = ["", "", "(mean)", "", "", &mean, "1.000", "", "", "", "", ""];
    let mut cells: Vec<String> = text.map(str::to_owned).into();
    cells[0] = row.views.to_string();
    cells[1].clone_from(&row.data_set);
    cells
}

fn cells(row: &Row) -> Vec<String> {
    vec![
        row.views.to_string(),
        row.data_set.clone(),
        row.kernels.to_owned(),
        row.selected_features.to_string(),
        match row.selected_samples {
            0 => "–".to_owned(),
            count => count.to_string(),
        },
        format!("{:.2}", row.mae_deg),
        format!("{:.3}", row.mae_deg / row.mean_predictor_mae_deg),
        format!("{:.2}", row.std_deg),
        format!("{:.1}", row.worst_deg),
        row.worst_dof.to_owned(),
        row.paper.as_ref().map_or_else(String::new, paper_figures),
        row.paper.as_ref().map_or_else(String::new, |paper| paper.worst_dof.to_owned()),
    ]
}

fn paper_figures(paper: &PaperRow) -> String {
    let figure = |name: &str, value: Option<f64>| match value {
        None => "·".to_owned(),
        Some(value) if paper.guessed.contains(&name) => format!("~{value:.1}"),
        Some(value) => format!("{value:.1}"),
    };
    format!(
        "{} / {} / {}",
        figure("mae_deg", paper.mae_deg),
        figure("std_deg", paper.std_deg),
        figure("worst_deg", paper.worst_deg)
    )
}
