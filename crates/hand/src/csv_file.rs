//! Files of poses: CSV with the names of [`Dof`] as columns, degrees and millimetres.

use std::io::{Read, Write};

use crate::dof::Dof;
use crate::error::{Error, Result};
use crate::pose::{Pose, may_be_radians};

/// The name of the column that tells which frame a row belongs to.
const FRAME: &str = "frame";
/// What the name of a deviation's column ends with.
const STD: &str = "_std";

/// The poses of a file, with what a reader should be told about it.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseTable {
    /// The poses, a row each.
    pub poses: Vec<Pose>,
    /// The `frame` column, if the file has one, a row each.
    pub frames: Option<Vec<String>>,
    /// What is odd but legal: columns that were passed over, values outside plausible ranges, angles that may be
    /// radians.
    pub warnings: Vec<String>,
}

impl PoseTable {
    /// Reads poses. Columns are found by name, absent ones are 0; a column with a dot in its
    /// name must be one of the 28, or the deviation of one (`index.pip_std`), which is no pose; others are
    /// passed over with a warning. So is a row in which every number is empty: a frame without a hand in the
    /// table of a take. Lines that begin with `#` are comments.
    ///
    /// # Errors
    /// Malformed CSV, columns separated by something else than commas, an unknown or repeated column, none of a
    /// pose, a cell that is no finite number, no row with a pose.
    ///
    /// ```
    /// use phalanx_hand::{Dof, PoseTable};
    ///
    /// let table = PoseTable::read("frame,index.pip\n0,30\n1,60\n".as_bytes())?;
    /// assert_eq!(table.poses[1][Dof::IndexPip], 60_f64.to_radians());
    /// assert_eq!(table.frames, Some(vec!["0".to_owned(), "1".to_owned()]));
    /// assert!(PoseTable::read("index.knee\n30\n".as_bytes()).is_err());
    /// # Ok::<(), phalanx_hand::Error>(())
    /// ```
    pub fn read(reader: impl Read) -> Result<Self> {
        let mut csv =
            csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(reader);
        let mut warnings = Vec::new();
        let columns = columns(csv.headers()?, &mut warnings)?;
        let frame_column = csv.headers()?.iter().position(|name| name == FRAME);

        let (mut poses, mut frames) = (Vec::new(), Vec::new());
        let mut empty = 0;
        for (row, record) in csv.records().enumerate() {
            let record = record?;
            if columns.iter().all(|&(column, _)| record[column].is_empty()) {
                empty += 1;
                continue;
            }
            let mut pose = Pose::REST;
            for &(column, dof) in &columns {
                pose[dof] = dof.unit().from_file(number(&record[column], row + 1, dof)?);
            }
            frames.extend(frame_column.map(|column| record[column].to_owned()));
            poses.push(pose);
        }
        if poses.is_empty() {
            return Err(Error::NoPoses { what: "row" });
        }
        if empty > 0 {
            warnings.push(format!("{empty} rows without a pose are left out"));
        }
        if may_be_radians(poses.iter().copied()) {
            warnings.push("no angle exceeds 6.28: are they radians? Degrees are read".to_owned());
        }
        warnings.extend(range_warning(&poses));
        Ok(Self { poses, frames: frame_column.map(|_| frames), warnings })
    }
}

/// Which column holds which number.
fn columns(header: &csv::StringRecord, warnings: &mut Vec<String>) -> Result<Vec<(usize, Dof)>> {
    if let Some(separator) = other_separator(header) {
        return Err(Error::Separator { separator });
    }
    let mut columns: Vec<(usize, Dof)> = Vec::new();
    let mut others = Vec::new();
    for (column, name) in header.iter().enumerate() {
        match name.parse::<Dof>() {
            Ok(dof) if columns.iter().any(|&(_, known)| known == dof) => {
                return Err(Error::RepeatedColumn { column: name.to_owned() });
            }
            Ok(dof) => columns.push((column, dof)),
            Err(_) if name == FRAME || is_deviation(name) => {}
            Err(error) if name.contains('.') => return Err(error),
            Err(_) => others.push(name),
        }
    }
    if columns.is_empty() {
        return Err(no_column(header));
    }
    warnings.extend(others_warning(&others));
    Ok(columns)
}

/// What separates the columns of spreadsheets of some languages.
fn other_separator(header: &csv::StringRecord) -> Option<char> {
    [';', '\t'].into_iter().find(|&separator| header.iter().any(|name| name.contains(separator)))
}

fn no_column(header: &csv::StringRecord) -> Error {
    const SHOWN: usize = 60;
    let line = header.iter().collect::<Vec<_>>().join(",");
    match line.char_indices().nth(SHOWN) {
        _ if line.is_empty() => Error::NoPoses { what: "line" },
        Some((end, _)) => Error::NoColumn { line: format!("{}…", &line[..end]) },
        None => Error::NoColumn { line },
    }
}

/// Whether a column holds the deviations of one of the 28 numbers.
fn is_deviation(name: &str) -> bool {
    name.strip_suffix(STD).is_some_and(|dof| dof.parse::<Dof>().is_ok())
}

/// What is said of columns that hold no pose; a take has more than a hundred.
fn others_warning(others: &[&str]) -> Option<String> {
    const NAMED: usize = 5;
    let named =
        others.iter().take(NAMED).map(|name| format!("'{name}'")).collect::<Vec<_>>().join(", ");
    match others.len() {
        0 => None,
        count if count > NAMED => {
            Some(format!("columns passed over: {named} and {} more", count - NAMED))
        }
        _ => Some(format!("columns passed over: {named}")),
    }
}

fn number(text: &str, row: usize, dof: Dof) -> Result<f64> {
    let finite = text.parse().ok().filter(|value: &f64| value.is_finite());
    finite.ok_or_else(|| Error::BadCell {
        row,
        column: dof.name().to_owned(),
        value: text.to_owned(),
    })
}

fn range_warning(poses: &[Pose]) -> Option<String> {
    let mut outside = [0_usize; Dof::COUNT];
    for dof in poses.iter().flat_map(Pose::out_of_range) {
        outside[dof.index()] += 1;
    }
    let named: Vec<String> = Dof::ALL
        .into_iter()
        .filter(|dof| outside[dof.index()] > 0)
        .map(|dof| format!("{dof} ({})", outside[dof.index()]))
        .collect();
    (!named.is_empty()).then(|| {
        format!("outside the plausible range (rows): {}; kept as they are", named.join(", "))
    })
}

/// Writes poses as CSV, with a `frame` column counting from 0, the columns `dofs`, and four
/// decimals.
///
/// # Errors
/// What the writer reports.
///
/// ```
/// use phalanx_hand::{Dof, Pose, write_poses};
///
/// let mut pose = Pose::REST;
/// pose[Dof::ThetaZ] = 90_f64.to_radians();
/// let mut file = Vec::new();
/// write_poses(&mut file, &[pose], &[Dof::ThetaZ, Dof::TX])?;
/// assert_eq!(file, b"frame,global.theta_z,global.t_x\n0,90.0000,0.0000\n");
/// # Ok::<(), phalanx_hand::Error>(())
/// ```
pub fn write_poses(writer: impl Write, poses: &[Pose], dofs: &[Dof]) -> Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(std::iter::once(FRAME).chain(dofs.iter().map(|dof| dof.name())))?;
    for (frame, pose) in poses.iter().enumerate() {
        let cells = dofs.iter().map(|&dof| format!("{:.4}", dof.unit().to_file(pose[dof])));
        csv.write_record(std::iter::once(frame.to_string()).chain(cells))?;
    }
    csv.flush().map_err(csv::Error::from)?;
    Ok(())
}
