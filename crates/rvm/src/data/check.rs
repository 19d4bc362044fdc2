//! Checks shared by every fitter.

use faer::MatRef;

use crate::error::{Error, Result};

/// Largest magnitude whose square, summed over any real data set, stays finite.
const LARGEST: f64 = 1e150;

/// Is this a number that the arithmetic here can square and sum?
pub(crate) fn usable(value: f64) -> bool {
    value.abs() < LARGEST
}

/// Refuses empty matrices and entries that are not [`usable`].
pub(crate) fn matrix(what: &'static str, x: MatRef<'_, f64>) -> Result<()> {
    let (rows, columns) = x.shape();
    if rows == 0 || columns == 0 {
        return Err(Error::Empty { what, rows, columns });
    }
    for column in 0..columns {
        for row in 0..rows {
            let value = x[(row, column)];
            if !usable(value) {
                return Err(Error::BadValue { what, row, column, value });
            }
        }
    }
    Ok(())
}

/// Refuses a length other than the expected one.
pub(crate) fn length(what: &'static str, expected: usize, found: usize) -> Result<()> {
    if expected == found { Ok(()) } else { Err(Error::Shape { what, expected, found }) }
}

/// Refuses room for other than so many means and standard deviations.
pub(crate) fn answers(outputs: usize, mean: &[f64], std: &[f64]) -> Result<()> {
    length("means", outputs, mean.len())?;
    length("standard deviations", outputs, std.len())
}

/// Refuses anything but a positive, finite number.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<()> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(Error::Parameter { name, value, requirement: "positive and finite" })
    }
}

/// Refuses a limit on iterations of zero.
pub(crate) fn iterations(max_iterations: usize) -> Result<()> {
    if max_iterations > 0 {
        return Ok(());
    }
    Err(Error::Parameter { name: "max_iterations", value: 0.0, requirement: "at least 1" })
}

/// Refuses a count of columns that is zero or more than there are.
pub(crate) fn count(requested: usize, available: usize) -> Result<()> {
    if (1..=available).contains(&requested) {
        Ok(())
    } else {
        Err(Error::Count { requested, available })
    }
}

/// Refuses indices that are not ascending or not below `available`.
pub(crate) fn indices(what: &'static str, indices: &[usize], available: usize) -> Result<()> {
    let ascends = |place: usize| place == 0 || indices[place - 1] < indices[place];
    for (place, &index) in indices.iter().enumerate() {
        if index >= available || !ascends(place) {
            return Err(Error::Index { what, index, available });
        }
    }
    Ok(())
}

/// Refuses an empty grid of penalties, and any that is not positive and finite.
pub(crate) fn grid(grid: &[f64]) -> Result<()> {
    if grid.is_empty() {
        return Err(Error::Empty { what: "grid of lambda", rows: 1, columns: 0 });
    }
    grid.iter().try_for_each(|&lambda| positive("lambda", lambda))
}

/// Refuses a model whose parts have this `problem`, if it is `present`.
pub(crate) fn part(field: &'static str, problem: &'static str, present: bool) -> Result<()> {
    if present { Err(Error::Parts { field, problem }) } else { Ok(()) }
}

/// Refuses parts of another length than expected (`None`: one that overflows), and such as are not
/// [`usable`].
pub(crate) fn numbers(field: &'static str, values: &[f64], expected: Option<usize>) -> Result<()> {
    part(field, "has the wrong length", Some(values.len()) != expected)?;
    part(field, "holds an unusable number", !values.iter().all(|&v| usable(v)))
}
