//! References as CSV: a row an instant, or a row a joint.

use std::collections::BTreeMap;
use std::io::Read;

use csv::StringRecord;

use crate::commas;
use crate::error::Result;
use crate::evaluation::reference::{Clock, Entry, Reference, number, problem};
use crate::take::JOINT_NAMES;

/// The entry that a column names.
fn entry(name: &str) -> Option<Entry> {
    if let Ok(dof) = name.parse() {
        return Some(Entry::Dof(dof, 1.0));
    }
    let (joint, axis) = name.rsplit_once('_')?;
    let axis = AXES.iter().position(|other| *other == axis)?;
    Some(Entry::Joint(joint_of(joint)?, axis, 1.0))
}

const AXES: [&str; 3] = ["x", "y", "z"];

fn joint_of(name: &str) -> Option<usize> {
    JOINT_NAMES.iter().position(|other| *other == name)
}

/// Reads a CSV file with a column `time` (s) or `frame` in one of two forms; an empty cell is no number:
///
/// * a row an instant: any of the 28 numbers and of the joints' coordinates by the names of a take's CSV;
/// * a row a joint: its name or its number from 0 to 20 in the column `joint`, and where it is in `x`, `y`, `z`
///   or `x_mm` … (mm), or in `x_m` … (m).
///
/// # Errors
/// Malformed CSV, no column of a time or number, a cell that is none, times that do not ascend, a joint that
/// is none or stands twice at an instant.
pub fn read_csv(reader: impl Read) -> Result<Reference> {
    let mut csv = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(reader);
    let names = csv.headers().map_err(|error| problem(error.to_string()))?.clone();
    commas::check(&names).map_err(problem)?;
    let column = |name: &str| names.iter().position(|other| other == name);
    let (clock, instant) = match (column("time"), column("frame")) {
        (Some(time), _) => (Clock::Time, time),
        (None, Some(frame)) => (Clock::Frame, frame),
        (None, None) => return Err(problem("it has neither a column 'time' nor 'frame'")),
    };
    let records = csv.records().map(|record| record.map_err(|error| problem(error.to_string())));
    match column("joint") {
        Some(joint) => joint_rows(Reference::new(clock), (instant, joint), &names, records),
        None => instant_rows(Reference::new(clock), instant, &names, records),
    }
}

fn instant_rows(
    mut reference: Reference,
    instant: usize,
    names: &StringRecord,
    records: impl Iterator<Item = Result<StringRecord>>,
) -> Result<Reference> {
    let entries: Vec<(usize, Entry)> = names
        .iter()
        .enumerate()
        .filter_map(|(column, name)| Some((column, entry(name)?)))
        .collect();
    if entries.is_empty() {
        return Err(problem("it has no column of an angle or a joint, such as 'index.pip'"));
    }
    for record in records {
        let record = record?;
        let cells: Vec<(Entry, f64)> = entries
            .iter()
            .map(|&(column, entry)| Ok((entry, number(&record[column])?)))
            .collect::<Result<_>>()?;
        reference.push(number(&record[instant])?, cells.into_iter());
    }
    reference.checked()
}

fn joint_rows(
    mut reference: Reference,
    (instant, joint): (usize, usize),
    names: &StringRecord,
    records: impl Iterator<Item = Result<StringRecord>>,
) -> Result<Reference> {
    let (places, scale) = places(names)?;
    // Rows of one instant may stand apart; a time is known by its bits.
    let mut rows: BTreeMap<u64, (f64, BTreeMap<usize, [f64; 3]>)> = BTreeMap::new();
    for record in records {
        let record = record?;
        let at = number(&record[instant])?;
        let name = &record[joint];
        let numbered = name.parse().ok().filter(|&joint: &usize| joint < JOINT_NAMES.len());
        let joint = numbered.or_else(|| joint_of(name)).ok_or_else(|| {
            let name = name.escape_debug();
            problem(format!("'{name}' is no joint: 0 to 20, or a name such as 'index_tip'"))
        })?;
        let mut place = [0.0; 3];
        for (own, &column) in place.iter_mut().zip(&places) {
            *own = number(&record[column])?;
        }
        let (_, row) = rows.entry(at.to_bits()).or_insert_with(|| (at, BTreeMap::new()));
        if row.insert(joint, place).is_some() {
            return Err(problem(format!("joint '{name}' stands twice at {at}")));
        }
    }
    let mut rows: Vec<(f64, BTreeMap<usize, [f64; 3]>)> = rows.into_values().collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (at, row) in rows {
        let entries = row.into_iter().flat_map(|(joint, place)| {
            [0, 1, 2].map(|axis| (Entry::Joint(joint, axis, scale), place[axis]))
        });
        reference.push(at, entries);
    }
    reference.checked()
}

/// The columns of the three coordinates, and how many mm their unit is.
fn places(names: &StringRecord) -> Result<([usize; 3], f64)> {
    for (end, scale) in [("", 1.0), ("_mm", 1.0), ("_m", 1000.0)] {
        let of = |axis: &str| names.iter().position(|name| name == format!("{axis}{end}"));
        if let [Some(x), Some(y), Some(z)] = AXES.map(of) {
            return Ok(([x, y, z], scale));
        }
    }
    Err(problem(
        "beside 'joint' there are no columns x, y, z (mm), x_mm, y_mm, z_mm or x_m, y_m, z_m",
    ))
}
