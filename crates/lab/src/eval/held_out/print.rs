//! The held-out table on standard output.

use std::fmt::Write;

use comfy_table::{Table, presets};

use super::row::Row;

/// The rows of one training set and number of views: tests down, methods across.
pub(crate) struct Block<'a> {
    rows: Vec<&'a Row>,
}

/// All blocks, in the order of their first rows.
pub(crate) fn blocks(rows: &[Row]) -> Vec<Block<'_>> {
    let mut blocks: Vec<Block<'_>> = Vec::new();
    let of = |row: &Row| (row.train, row.train_samples, row.views);
    for row in rows {
        match blocks.iter_mut().find(|block| of(block.rows[0]) == of(row)) {
            Some(block) => block.rows.push(row),
            None => blocks.push(Block { rows: vec![row] }),
        }
    }
    blocks
}

impl Block<'_> {
    pub(crate) fn title(&self) -> String {
        let Row { train, train_samples, views, .. } = self.rows[0];
        let views = if *views == 1 { "1 view".to_owned() } else { format!("{views} views") };
        format!("Trained on `{train}`, {train_samples} samples, {views}")
    }

    pub(crate) fn methods(&self) -> Vec<&'static str> {
        distinct(self.rows.iter().map(|row| row.method))
    }

    /// The test's name, then each method's error.
    pub(crate) fn cells(&self) -> Vec<Vec<String>> {
        self.cells_of(cell)
    }

    /// Whether estimates were refined.
    fn is_refined(&self) -> bool {
        self.methods().iter().any(|method| method.starts_with("refined"))
    }

    fn cells_of(&self, cell: fn(&Row) -> String) -> Vec<Vec<String>> {
        let line = |test: &'static str| {
            let cell = |method: &str| {
                let row = self.rows.iter().find(|row| row.test == test && row.method == method);
                row.map_or_else(String::new, |row| cell(row))
            };
            std::iter::once(test.to_owned()).chain(self.methods().into_iter().map(cell)).collect()
        };
        distinct(self.rows.iter().map(|row| row.test)).into_iter().map(line).collect()
    }
}

fn distinct(names: impl Iterator<Item = &'static str>) -> Vec<&'static str> {
    let mut found = Vec::new();
    for name in names {
        if !found.contains(&name) {
            found.push(name);
        }
    }
    found
}

fn cell(row: &Row) -> String {
    let ratio = row.mae_deg / row.mean_predictor_mae_deg;
    match row.us_per_estimate {
        None => format!("{:.2} ({ratio:.2})", row.mae_deg),
        Some(time) => format!("{:.2} ({ratio:.2}) {time:.0} µs", row.mae_deg),
    }
}

fn worst(row: &Row) -> String {
    format!("{:.2} {}", row.worst_deg, row.worst_dof)
}

/// One table for each block, and one of the worst angles where estimates were refined.
pub(crate) fn tables(rows: &[Row]) -> String {
    let mut text = String::from(
        "# What was never seen\n\nPrinted by `cargo xtask eval-held-out`: mean absolute error over the 21 active angles in\n\
         degrees and, in brackets, over that of predicting the training mean.\n",
    );
    for block in blocks(rows) {
        let table = |cells| {
            let mut table = Table::new();
            let header = std::iter::once("test").chain(block.methods());
            table.load_style(presets::ASCII_MARKDOWN).set_header(header).add_rows(cells);
            table
        };
        let _ = write!(text, "\n## {}\n\n{}\n", block.title(), table(block.cells()));
        if block.is_refined() {
            let cells = block.cells_of(worst);
            let _ = write!(text, "\nThe worst angle, degrees:\n\n{}\n", table(cells));
        }
    }
    text
}
