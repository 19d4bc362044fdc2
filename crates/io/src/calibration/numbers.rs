//! Plain rows of numbers.

use crate::error::{Error, Result};

/// The numbers of a line of text.
pub(super) fn of_line(line: &str, what: &str) -> Result<Vec<f64>> {
    let numbers =
        line.split_whitespace().map(|word| word.parse().ok().filter(|n: &f64| n.is_finite()));
    numbers.collect::<Option<_>>().ok_or_else(|| {
        Error::calibration(format!("{what}: `{line}` holds something that is no number"))
    })
}
