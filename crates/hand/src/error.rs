//! What can be wrong with a pose, a shape or their files.

/// An error of this crate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A name that is none of the 28 numbers of a pose.
    #[error(
        "'{name}' names no degree of freedom (the names are like 'index.pip' or 'global.theta_z')"
    )]
    UnknownDof {
        /// The name that was met.
        name: String,
    },
    /// A file of poses that is not well-formed CSV.
    #[error("poses: {}", reason(.0))]
    Csv(csv::Error),
    /// A file of poses whose columns are separated by something else than commas.
    #[error(
        "poses: the columns are separated by {separator:?}: separate them by commas, and write numbers with points"
    )]
    Separator {
        /// What separates them.
        separator: char,
    },
    /// A file of poses with no column of a pose.
    #[error("poses: the first line, '{line}', names no column of a pose, such as 'index.pip'")]
    NoColumn {
        /// The file's first line, or its beginning.
        line: String,
    },
    /// A cell of a file of poses that is not a finite number.
    #[error("poses: row {row}, column '{column}': '{value}' is not a finite number")]
    BadCell {
        /// Row after the header, from 1.
        row: usize,
        /// The column's name.
        column: String,
        /// The text of the cell.
        value: String,
    },
    /// A file of poses in which the same column stands twice.
    #[error("poses: column '{column}' stands twice")]
    RepeatedColumn {
        /// The column's name.
        column: String,
    },
    /// A file of poses with no row, or with nothing at all.
    #[error("poses: the file holds no {what}")]
    NoPoses {
        /// What is absent.
        what: &'static str,
    },
    /// A hand file that is not well-formed TOML or lacks a field.
    #[error("hand: line {line}: {message}")]
    Toml {
        /// The line at fault, from 1.
        line: usize,
        /// The parser's message.
        message: String,
    },
    /// A number of a hand shape outside what a hand can have.
    #[error("hand: {field} = {value} is outside {low}..{high}")]
    BadShape {
        /// The field, as in the file.
        field: String,
        /// Its value.
        value: f64,
        /// Lowest value allowed.
        low: f64,
        /// Highest value allowed.
        high: f64,
    },
}

impl From<csv::Error> for Error {
    fn from(error: csv::Error) -> Self {
        Self::Csv(error)
    }
}

/// What is wrong with a file, by its lines.
fn reason(error: &csv::Error) -> String {
    let line = error.position().map_or(1, csv::Position::line);
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("line {line} has {len} cells, lines before it have {expected_len}")
        }
        csv::ErrorKind::Utf8 { .. } => format!("line {line} is not UTF-8: save the file as UTF-8"),
        _ => error.to_string(),
    }
}

/// A result of this crate.
pub type Result<T> = std::result::Result<T, Error>;
