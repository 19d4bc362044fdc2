//! A take as JSON Lines: the header on the first line, then a line a frame.

use std::io::{BufRead, Write};

use glam::DVec3;
use phalanx_hand::{Dof, JOINTS, Pose};
use serde::{Deserialize, Serialize};

use crate::error::unwritten;
use crate::error::{Error, Result};
use crate::take::by_name::{ByDof, ByJoint};
use crate::take::frames::{FrameView, LeftOut, PoseEstimate, Take, TakeFrame, TakeHeader};
use crate::take::header;
use crate::take::validate::FrameOrder;

/// The JSON form of [`TakeFrame`]: degrees, millimetres and seconds.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FrameLine {
    frame: u64,
    time: f64,
    pose: Option<ByDof<f64>>,
    std: Option<ByDof<Option<f64>>>,
    joints_mm: Option<ByJoint<[f64; 3]>>,
    joints_std_mm: Option<ByJoint<[f64; 3]>>,
    quality: Option<f64>,
    views: Vec<ViewLine>,
    doubts: Vec<String>,
}

/// The JSON form of [`FrameView`].
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ViewLine {
    view: String,
    used: bool,
    overlap: Option<f64>,
    #[serde(default)]
    left_out: Option<LeftOut>,
}

/// Writes the frames of a take as they come, by the schema of [`json_schema`](super::json_schema).
pub struct JsonLinesWriter<W: Write> {
    writer: W,
    header: TakeHeader,
    order: FrameOrder,
}

impl<W: Write> JsonLinesWriter<W> {
    /// Writes the header's line.
    ///
    /// # Errors
    /// A header that does not keep to [`Take::validate`]; what the writer reports.
    pub fn new(header: TakeHeader, mut writer: W) -> Result<Self> {
        header.validate()?;
        writeln!(writer, "{}", header::to_json(&header)).map_err(|error| unwritten(&error))?;
        Ok(Self { writer, header, order: FrameOrder::default() })
    }

    /// Goes on after a frame, the index and time of which are given, that was written before.
    ///
    /// # Errors
    /// A header that does not keep to [`Take::validate`].
    pub fn after(header: TakeHeader, last: (u64, f64), writer: W) -> Result<Self> {
        header.validate()?;
        Ok(Self { writer, header, order: FrameOrder::after(last) })
    }

    /// Writes a frame's line. Angles and lengths have four decimals, times six.
    ///
    /// # Errors
    /// A frame that does not keep to [`Take::validate`]; what the writer reports.
    pub fn push(&mut self, frame: &TakeFrame) -> Result<()> {
        self.order.check(frame, &self.header)?;
        let line = serde_json::to_string(&FrameLine::new(&self.header, frame));
        let line = line.map_err(|error| unwritten(&error))?;
        writeln!(self.writer, "{line}").map_err(|error| unwritten(&error))
    }

    /// Hands on what is still held back.
    ///
    /// # Errors
    /// What the writer reports.
    pub fn flush(&mut self) -> Result<()> {
        self.writer.flush().map_err(|error| unwritten(&error))
    }
}

/// Writes a take as JSON Lines, as [`JsonLinesWriter`] does.
///
/// # Errors
/// A take that does not keep to [`Take::validate`]; what the writer reports.
pub fn write_json_lines(take: &Take, writer: impl Write) -> Result<()> {
    let mut lines = JsonLinesWriter::new(take.header.clone(), writer)?;
    take.frames.iter().try_for_each(|frame| lines.push(frame))?;
    lines.flush()
}

/// Reads what [`write_json_lines`] writes.
///
/// # Errors
/// A line that is not by the schema, a frame that does not keep to [`Take::validate`].
pub fn read_json_lines(reader: impl BufRead) -> Result<Take> {
    let mut lines = (1..).zip(reader.lines()).map(|(number, line)| match line {
        Ok(line) => Ok((number, line)),
        Err(error) => Err(Error::TakeLine { line: number, what: error.to_string() }),
    });
    let first = lines.next().transpose()?.map(|(_, line)| line).unwrap_or_default();
    let header = header::from_json(&first)?;
    let mut frames = Vec::new();
    for line in lines {
        let (line, text) = line?;
        if !text.trim().is_empty() {
            let parsed: std::result::Result<FrameLine, _> = serde_json::from_str(&text);
            let frame = parsed.map_err(|error| error.to_string());
            let frame = frame.and_then(|frame| frame.frame(&header));
            frames.push(frame.map_err(|what| Error::TakeLine { line, what })?);
        }
    }
    let take = Take { header, frames };
    take.validate()?;
    Ok(take)
}

impl FrameLine {
    fn new(header: &TakeHeader, frame: &TakeFrame) -> Self {
        let estimate = frame.estimate.as_ref();
        let of = |dof: Dof, value: f64| rounded(dof.unit().to_file(value));
        let points =
            |points: [DVec3; JOINTS]| ByJoint::from(points.map(|p| p.to_array().map(rounded)));
        let views = header.views.iter().zip(&frame.views).map(|(name, view)| ViewLine {
            view: name.clone(),
            used: view.used,
            overlap: view.overlap.map(rounded),
            left_out: view.left_out,
        });
        Self {
            frame: frame.index,
            time: (frame.time * 1e6).round() / 1e6,
            pose: estimate.map(|e| Dof::ALL.map(|dof| of(dof, e.pose[dof])).into()),
            std: estimate
                .map(|e| Dof::ALL.map(|dof| e.std[dof.index()].map(|s| of(dof, s))).into()),
            joints_mm: estimate.map(|e| points(e.joints)),
            joints_std_mm: estimate.and_then(|e| e.joint_std).map(points),
            quality: frame.quality().map(rounded),
            views: views.collect(),
            doubts: frame.doubts.clone(),
        }
    }

    fn frame(self, header: &TakeHeader) -> std::result::Result<TakeFrame, String> {
        let views = header.views.iter().map(|name| {
            let line = self.views.iter().find(|line| line.view == *name);
            let line = line.ok_or_else(|| format!("the view '{name}' is absent"))?;
            Ok(FrameView { used: line.used, overlap: line.overlap, left_out: line.left_out })
        });
        let views = views.collect::<std::result::Result<Vec<_>, String>>()?;
        if self.views.len() != views.len() {
            return Err("it speaks of more views than the header".to_owned());
        }
        let points = |points: ByJoint<[f64; 3]>| points.0.map(DVec3::from_array);
        let estimate = match (self.pose, self.std, self.joints_mm) {
            (None, None, None) => None,
            (Some(pose), Some(std), Some(joints)) => Some(PoseEstimate {
                pose: Pose(Dof::ALL.map(|dof| dof.unit().from_file(pose.0[dof.index()]))),
                std: Dof::ALL.map(|dof| std.0[dof.index()].map(|s| dof.unit().from_file(s))),
                joints: points(joints),
                joint_std: self.joints_std_mm.map(points),
            }),
            _ => return Err("pose, std and joints_mm must all be there, or all null".to_owned()),
        };
        let Self { frame: index, time, doubts, .. } = self;
        Ok(TakeFrame { index, time, estimate, views, doubts })
    }
}

/// To four decimals.
fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
