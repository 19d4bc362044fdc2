//! Tables whose columns are separated by something else than commas.

use csv::StringRecord;

/// Says so of what spreadsheets of some languages write.
pub(crate) fn check(header: &StringRecord) -> Result<(), String> {
    let other = [';', '\t']
        .into_iter()
        .find(|&separator| header.len() == 1 && header.iter().any(|name| name.contains(separator)));
    match other {
        Some(separator) => Err(format!(
            "the columns are separated by {separator:?}: separate them by commas, and write numbers with points"
        )),
        None => Ok(()),
    }
}
