//! The held-out table on standard output.

use std::fmt::Write;

use comfy_table::{Table, presets};

use super::row::Row;

/// One table for each training set and number of views: tests down, methods across.
pub(crate) fn tables(rows: &[Row]) -> String {
    let mut text = String::from(
        "# What was never seen\n\nPrinted by `cargo xtask eval-held-out`: mean absolute error over the 21 active angles in\n\
         degrees and, in brackets, over that of predicting the training mean.\n",
    );
    let block = |row: &Row| (row.train, row.train_samples, row.views);
    let mut blocks: Vec<_> = rows.iter().map(block).collect();
    blocks.dedup();
    let mut named = Vec::new();
    for of in blocks {
        if named.contains(&of) {
            continue;
        }
        named.push(of);
        let (train, samples, views) = of;
        let rows: Vec<&Row> = rows.iter().filter(|row| block(row) == of).collect();
        let _ = write!(
            text,
            "\n## Trained on `{train}`, {samples} samples, {views} view{}\n\n{}\n",
            if views == 1 { "" } else { "s" },
            table(&rows)
        );
    }
    text
}

fn table(rows: &[&Row]) -> Table {
    let distinct = |name: fn(&Row) -> &'static str| {
        let mut names: Vec<&str> = Vec::new();
        for row in rows {
            if !names.contains(&name(row)) {
                names.push(name(row));
            }
        }
        names
    };
    let methods = distinct(|row| row.method);
    let mut table = Table::new();
    let header = std::iter::once("test").chain(methods.iter().copied());
    table.load_style(presets::ASCII_MARKDOWN).set_header(header);
    for test in distinct(|row| row.test) {
        let cell = |method: &&str| {
            let row = rows.iter().find(|row| row.test == test && row.method == *method);
            row.map_or_else(String::new, |row| cell(row))
        };
        table.add_row(std::iter::once(test.to_owned()).chain(methods.iter().map(cell)));
    }
    table
}

fn cell(row: &Row) -> String {
    let ratio = row.mae_deg / row.mean_predictor_mae_deg;
    match row.us_per_estimate {
        None => format!("{:.2} ({ratio:.2})", row.mae_deg),
        Some(time) => format!("{:.2} ({ratio:.2}) {time:.0} µs", row.mae_deg),
    }
}
