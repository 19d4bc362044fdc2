//! CSV files with named columns.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow};
use csv::{ReaderBuilder, StringRecord, Trim};

/// A file's rows.
pub(super) struct Table {
    path: PathBuf,
    header: StringRecord,
    rows: Vec<StringRecord>,
}

/// One row of a table.
pub(super) struct Row<'a> {
    table: &'a Table,
    cells: &'a StringRecord,
}

impl Table {
    /// Reads a file; nothing where there is none.
    pub(super) fn open(path: &Path) -> Result<Option<Self>> {
        if !path.is_file() {
            return Ok(None);
        }
        let read = || {
            let mut reader = ReaderBuilder::new().trim(Trim::All).from_path(path)?;
            let header = reader.headers()?.clone();
            let rows = reader.records().collect::<Result<_, _>>()?;
            Ok::<_, csv::Error>(Self { path: path.to_owned(), header, rows })
        };
        read().map(Some).with_context(|| path.display().to_string())
    }

    /// The number of a column.
    pub(super) fn column(&self, name: &str) -> Result<usize> {
        let place = self.header.iter().position(|column| column == name);
        place.with_context(|| format!("{}: no column '{name}'", self.path.display()))
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        self.rows.iter().map(|cells| Row { table: self, cells })
    }
}

impl Row<'_> {
    /// A cell.
    pub(super) fn text(&self, column: usize) -> &str {
        self.cells.get(column).unwrap_or_default()
    }

    /// A cell's number; nothing where it is blank or NaN.
    pub(super) fn number(&self, column: usize) -> Result<Option<f64>> {
        let text = self.text(column);
        if text.is_empty() {
            return Ok(None);
        }
        let number: f64 =
            text.parse().map_err(|_| anyhow!(self.at(&format!("'{text}' is no number"))))?;
        Ok(Some(number).filter(|number| number.is_finite()))
    }

    /// A message about this row, with its place.
    pub(super) fn at(&self, message: &str) -> String {
        let line = self.cells.position().map_or(0, csv::Position::line);
        format!("{}, line {line}: {message}", self.table.path.display())
    }
}
