//! A take as CSV: a row a frame, degrees and millimetres, each number's deviation beside it.
//!
//! The header stands as JSON in the first row's cell of the last column, so that the file is a
//! plain table for whoever does not know of it.

use std::collections::BTreeMap;
use std::io::{Read, Write};

use glam::DVec3;
use phalanx_hand::{Dof, JOINTS, Pose};

use crate::commas;
use crate::error::unwritten;
use crate::error::{Error, Result};
use crate::take::frames::{
    FrameView, JOINT_NAMES, LeftOut, PoseEstimate, Take, TakeFrame, TakeHeader,
};
use crate::take::header;
use crate::take::validate::{FrameOrder, SEPARATOR};

/// The column of the header.
const HEADER: &str = "take";
/// What the name of a deviation's column ends with.
const STD: &str = "_std";
/// What the name of a view's overlap begins with.
const OVERLAP: &str = "overlap_";
/// The column of views that were left out, each as `NAME:why`. Older files have none.
const LEFT_OUT: &str = "left_out";
/// The ends of the names of a joint's three columns.
const AXES: [&str; 3] = ["_x", "_y", "_z"];

/// Writes the frames of a take as they come.
pub struct CsvWriter<W: Write> {
    csv: ::csv::Writer<W>,
    header: TakeHeader,
    /// The header's JSON until the first row has taken it.
    meta: String,
    order: FrameOrder,
}

impl<W: Write> CsvWriter<W> {
    /// Writes the names of the columns: `frame`, `time`, the 28 numbers and the 21 joints with
    /// their deviations, `quality`, the views' overlaps, the `views` that were used and those that were
    /// `left_out`, the `doubts`, and the header.
    ///
    /// # Errors
    /// A header that does not keep to [`Take::validate`]; what the writer reports.
    pub fn new(header: TakeHeader, writer: W) -> Result<Self> {
        header.validate()?;
        let mut csv = ::csv::Writer::from_writer(writer);
        csv.write_record(column_names(&header)).map_err(|error| unwritten(&error))?;
        Ok(Self { csv, meta: header::to_json(&header), header, order: FrameOrder::default() })
    }

    /// Goes on after a frame, the index and time of which are given, that was written before.
    ///
    /// # Errors
    /// A header that does not keep to [`Take::validate`].
    pub fn after(header: TakeHeader, last: (u64, f64), writer: W) -> Result<Self> {
        header.validate()?;
        let csv = ::csv::Writer::from_writer(writer);
        Ok(Self { csv, meta: String::new(), header, order: FrameOrder::after(last) })
    }

    /// Writes a frame. Angles and lengths have four decimals, times six.
    ///
    /// # Errors
    /// A frame that does not keep to [`Take::validate`]; what the writer reports.
    pub fn push(&mut self, frame: &TakeFrame) -> Result<()> {
        self.order.check(frame, &self.header)?;
        let meta = std::mem::take(&mut self.meta);
        self.csv
            .write_record(frame_cells(&self.header, frame, meta))
            .map_err(|error| unwritten(&error))
    }

    /// Hands on what is still held back.
    ///
    /// # Errors
    /// What the writer reports.
    pub fn flush(&mut self) -> Result<()> {
        self.csv.flush().map_err(|error| unwritten(&error))
    }
}

/// Writes a take as CSV, as [`CsvWriter`] does.
///
/// # Errors
/// A take that does not keep to [`Take::validate`]; what the writer reports.
pub fn write_csv(take: &Take, writer: impl Write) -> Result<()> {
    let mut csv = CsvWriter::new(take.header.clone(), writer)?;
    take.frames.iter().try_for_each(|frame| csv.push(frame))?;
    csv.flush()
}

fn column_names(header: &TakeHeader) -> Vec<String> {
    let mut names = vec!["frame".to_owned(), "time".to_owned()];
    let dofs = Dof::ALL.into_iter().map(|dof| dof.name().to_owned());
    for name in dofs.chain(joint_columns()) {
        let std = format!("{name}{STD}");
        names.extend([name, std]);
    }
    names.push("quality".to_owned());
    names.extend(header.views.iter().map(|view| format!("{OVERLAP}{view}")));
    names.extend(["views", LEFT_OUT, "doubts", HEADER].map(str::to_owned));
    names
}

fn joint_columns() -> impl Iterator<Item = String> {
    JOINT_NAMES.into_iter().flat_map(|joint| AXES.map(|axis| format!("{joint}{axis}")))
}

fn frame_cells(header: &TakeHeader, frame: &TakeFrame, meta: String) -> Vec<String> {
    let mut cells = vec![frame.index.to_string(), format!("{:.6}", frame.time)];
    let estimate = frame.estimate.as_ref();
    for dof in Dof::ALL {
        let number = |value: f64| dof.unit().to_file(value);
        let std = estimate.and_then(|estimate| estimate.std[dof.index()]);
        cells.push(decimal(estimate.map(|estimate| number(estimate.pose[dof]))));
        cells.push(decimal(std.map(number)));
    }
    for (joint, axis) in (0..JOINTS).flat_map(|joint| [0, 1, 2].map(|axis| (joint, axis))) {
        cells.push(decimal(estimate.map(|estimate| estimate.joints[joint][axis])));
        let std = estimate.and_then(|estimate| estimate.joint_std);
        cells.push(decimal(std.map(|std| std[joint][axis])));
    }
    cells.push(decimal(frame.quality()));
    cells.extend(frame.views.iter().map(|view| decimal(view.overlap)));
    let used = header.views.iter().zip(&frame.views).filter(|(_, view)| view.used);
    let separator = SEPARATOR.to_string();
    cells.push(used.map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(&separator));
    let left_out = header.views.iter().zip(&frame.views);
    let left_out = left_out.filter_map(|(name, view)| Some((name, view.left_out?)));
    let left_out = left_out.map(|(name, why)| format!("{name}:{}", why.code()));
    cells.push(left_out.collect::<Vec<_>>().join(&separator));
    cells.push(frame.doubts.join(&separator));
    cells.push(meta);
    cells
}

fn decimal(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("{value:.4}"))
}

/// Reads what [`write_csv`] writes. Columns are found by name and may stand in any order; those of
/// other names are passed over.
///
/// # Errors
/// Malformed CSV, an absent or repeated column, a cell that is no finite number, a frame that does
/// not keep to [`Take::validate`].
pub fn read_csv(reader: impl Read) -> Result<Take> {
    let mut csv = ::csv::ReaderBuilder::new().trim(::csv::Trim::All).from_reader(reader);
    let names = csv.headers().map_err(|error| unread(&error))?.clone();
    commas::check(&names).map_err(|what| Error::TakeLine { line: 1, what })?;
    let columns = Columns::new(&names)?;
    let column = columns.find(HEADER)?;
    let records = csv.records().collect::<std::result::Result<Vec<_>, _>>();
    let records = records.map_err(|error| unread(&error))?;
    let meta = records.iter().map(|record| &record[column]).find(|cell| !cell.is_empty());
    let header = header::from_json(meta.ok_or_else(|| Error::TakeHeader {
        what: format!("no cell of the column '{HEADER}' is filled"),
    })?)?;
    let layout = Layout::new(&columns, &header)?;
    let frames = records.iter().map(|record| layout.frame(&Row(record)));
    let take = Take { frames: frames.collect::<Result<_>>()?, header };
    take.validate()?;
    Ok(take)
}

fn unread(error: &::csv::Error) -> Error {
    let line = error.position().map_or(1, ::csv::Position::line);
    Error::TakeLine { line, what: error.to_string() }
}

/// Which column has which name.
struct Columns<'a>(BTreeMap<&'a str, usize>);

impl<'a> Columns<'a> {
    fn new(names: &'a ::csv::StringRecord) -> Result<Self> {
        let mut columns = BTreeMap::new();
        for (column, name) in names.iter().enumerate() {
            if columns.insert(name, column).is_some() {
                return Err(Error::TakeColumn { column: name.to_owned(), what: "stands twice" });
            }
        }
        Ok(Self(columns))
    }

    fn find(&self, name: &str) -> Result<usize> {
        let column = self.0.get(name).copied();
        column.ok_or_else(|| Error::TakeColumn { column: name.to_owned(), what: "is absent" })
    }

    /// A number's column and its deviation's.
    fn pair(&self, name: &str) -> Result<[usize; 2]> {
        Ok([self.find(name)?, self.find(&format!("{name}{STD}"))?])
    }
}

/// Where everything of a frame stands.
struct Layout<'a> {
    names: &'a [String],
    frame: usize,
    time: usize,
    dofs: Vec<[usize; 2]>,
    joints: Vec<[usize; 2]>,
    overlaps: Vec<usize>,
    views: usize,
    left_out: Option<usize>,
    doubts: usize,
}

impl<'a> Layout<'a> {
    fn new(columns: &Columns<'_>, header: &'a TakeHeader) -> Result<Self> {
        let overlaps = header.views.iter().map(|view| columns.find(&format!("{OVERLAP}{view}")));
        Ok(Self {
            names: &header.views,
            frame: columns.find("frame")?,
            time: columns.find("time")?,
            dofs: Dof::ALL.iter().map(|dof| columns.pair(dof.name())).collect::<Result<_>>()?,
            joints: joint_columns().map(|name| columns.pair(&name)).collect::<Result<_>>()?,
            overlaps: overlaps.collect::<Result<_>>()?,
            views: columns.find("views")?,
            left_out: columns.find(LEFT_OUT).ok(),
            doubts: columns.find("doubts")?,
        })
    }

    fn frame(&self, row: &Row<'_>) -> Result<TakeFrame> {
        let index = row.0[self.frame].parse();
        let used: Vec<&str> = row.list(self.views);
        if let Some(name) = used.iter().find(|name| !self.names.iter().any(|view| view == *name)) {
            return Err(row.problem(format!("no view is named '{name}'")));
        }
        let left_out = self.left_out(row)?;
        let views = self.names.iter().zip(&self.overlaps).map(|(name, &column)| {
            let name = name.as_str();
            let (used, left_out) = (used.contains(&name), left_out.get(name).copied());
            Ok(FrameView { used, overlap: row.number(column)?, left_out })
        });
        Ok(TakeFrame {
            index: index.map_err(|_| row.problem("the frame is no whole number".to_owned()))?,
            time: row.needed(self.time)?,
            estimate: self.estimate(row)?,
            views: views.collect::<Result<_>>()?,
            doubts: row.list(self.doubts).into_iter().map(str::to_owned).collect(),
        })
    }

    /// The views that were left out, and why.
    fn left_out<'r>(&self, row: &Row<'r>) -> Result<BTreeMap<&'r str, LeftOut>> {
        let entry = |entry: &'r str| {
            let known = entry.rsplit_once(':').and_then(|(name, code)| {
                let name = self.names.iter().any(|view| view == name).then_some(name)?;
                Some((name, LeftOut::of_code(code)?))
            });
            known.ok_or_else(|| row.problem(format!("'{entry}' is no view that was left out")))
        };
        let cell = self.left_out.map(|column| row.list(column)).unwrap_or_default();
        cell.into_iter().map(entry).collect()
    }

    /// The pose, unless the cell of its first number is empty.
    fn estimate(&self, row: &Row<'_>) -> Result<Option<PoseEstimate>> {
        let [first, _] = self.dofs[0];
        if row.number(first)?.is_none() {
            return Ok(None);
        }
        let (mut pose, mut std) = (Pose::REST, [None; Dof::COUNT]);
        for (dof, &[value, deviation]) in Dof::ALL.into_iter().zip(&self.dofs) {
            pose[dof] = dof.unit().from_file(row.needed(value)?);
            std[dof.index()] = row.number(deviation)?.map(|std| dof.unit().from_file(std));
        }
        let mut joints = [DVec3::ZERO; JOINTS];
        let mut joint_std = [DVec3::ZERO; JOINTS];
        let mut deviations = 0;
        for (k, &[value, deviation]) in self.joints.iter().enumerate() {
            joints[k / 3][k % 3] = row.needed(value)?;
            if let Some(std) = row.number(deviation)? {
                joint_std[k / 3][k % 3] = std;
                deviations += 1;
            }
        }
        let joint_std = match deviations {
            0 => None,
            all if all == self.joints.len() => Some(joint_std),
            _ => return Err(row.problem("some joints lack a deviation and some do not".to_owned())),
        };
        Ok(Some(PoseEstimate { pose, std, joints, joint_std }))
    }
}

/// A row after the column names.
struct Row<'a>(&'a ::csv::StringRecord);

impl<'a> Row<'a> {
    fn problem(&self, what: String) -> Error {
        Error::TakeLine { line: self.0.position().map_or(0, ::csv::Position::line), what }
    }

    /// The number of a cell, none of an empty one.
    fn number(&self, column: usize) -> Result<Option<f64>> {
        let text = &self.0[column];
        if text.is_empty() {
            return Ok(None);
        }
        let finite = text.parse().ok().filter(|value: &f64| value.is_finite());
        let problem = || self.problem(format!("'{text}' is not a finite number"));
        finite.map(Some).ok_or_else(problem)
    }

    fn needed(&self, column: usize) -> Result<f64> {
        let problem = || self.problem(format!("cell {} is empty", column + 1));
        self.number(column)?.ok_or_else(problem)
    }

    fn list(&self, column: usize) -> Vec<&'a str> {
        let cell = self.0[column].split(SEPARATOR);
        cell.map(str::trim).filter(|entry| !entry.is_empty()).collect()
    }
}
