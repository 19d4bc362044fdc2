//! References: what another instrument, or the hand that was drawn, says of the same motion.

use glam::DVec3;
use phalanx_hand::{Dof, JOINTS};

use crate::error::{Error, Result};
use crate::export::{Coordinate, CoordinateNames};
use crate::take::{JOINT_NAMES, Take};

/// Angles or joints over time; NaN where there is nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// By what its rows are matched with a take's frames.
    pub clock: Clock,
    /// Each row's time, s, or frame number.
    pub instants: Vec<f64>,
    /// Each row's 28 numbers, rad and mm.
    pub poses: Vec<[f64; Dof::COUNT]>,
    /// Each row's joints, mm.
    pub joints: Vec<[DVec3; JOINTS]>,
}

/// What tells when a row of a reference was.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// Its time, s.
    Time,
    /// Its frame's number.
    Frame,
}

impl From<&Take> for Reference {
    /// A take as what another is compared with, by their times.
    fn from(take: &Take) -> Self {
        let mut reference = Self::new(Clock::Time);
        for frame in &take.frames {
            let estimate = frame.estimate.as_ref();
            reference.instants.push(frame.time);
            reference.poses.push(estimate.map_or([f64::NAN; Dof::COUNT], |found| found.pose.0));
            reference.joints.push(estimate.map_or([DVec3::NAN; JOINTS], |found| found.joints));
        }
        reference
    }
}

/// A number of a pose, or a joint's along an axis, with what the file's numbers are multiplied by.
#[derive(Debug, Clone, Copy)]
pub(super) enum Entry {
    Dof(Dof, f64),
    Joint(usize, usize, f64),
}

impl Reference {
    pub(super) fn new(clock: Clock) -> Self {
        Self { clock, instants: Vec::new(), poses: Vec::new(), joints: Vec::new() }
    }

    pub(super) fn push(&mut self, instant: f64, entries: impl Iterator<Item = (Entry, f64)>) {
        let mut pose = [f64::NAN; Dof::COUNT];
        let mut joints = [DVec3::NAN; JOINTS];
        for (entry, value) in entries {
            match entry {
                Entry::Dof(dof, scale) => pose[dof.index()] = dof.unit().from_file(value * scale),
                Entry::Joint(joint, axis, scale) => joints[joint][axis] = value * scale,
            }
        }
        self.instants.push(instant);
        self.poses.push(pose);
        self.joints.push(joints);
    }

    /// Refuses what cannot be compared.
    pub(super) fn checked(self) -> Result<Self> {
        let instants = &self.instants;
        if instants.is_empty() {
            return Err(problem("it has no row"));
        }
        if !instants.iter().all(|instant| instant.is_finite())
            || instants.windows(2).any(|pair| pair[1] <= pair[0])
        {
            return Err(problem("its times do not ascend"));
        }
        Ok(self)
    }
}

pub(super) fn problem(what: impl Into<String>) -> Error {
    Error::Reference { what: what.into() }
}

pub(super) fn number(text: &str) -> Result<f64> {
    if text.is_empty() {
        return Ok(f64::NAN);
    }
    text.parse().map_err(|_| problem(format!("'{}' is not a number", text.escape_debug())))
}

/// Reads a TRC file: markers by the names of the joints, mm or m.
///
/// # Errors
/// Another format or unit, no joint among the markers, a short row, times that do not ascend.
pub fn read_trc(text: &str) -> Result<Reference> {
    let mut lines = text.lines();
    let first = lines.next().unwrap_or_default();
    if !first.starts_with("PathFileType") {
        return Err(problem("it does not begin as TRC does, with 'PathFileType'"));
    }
    let names: Vec<&str> = lines.next().unwrap_or_default().split('\t').map(str::trim).collect();
    let values: Vec<&str> = lines.next().unwrap_or_default().split('\t').map(str::trim).collect();
    let units = names.iter().position(|name| *name == "Units").and_then(|at| values.get(at));
    let scale = match units {
        Some(&"mm") => 1.0,
        Some(&"m") => 1000.0,
        other => return Err(problem(format!("its unit is {other:?}, neither mm nor m"))),
    };
    // Each marker's name stands over the first of its three columns.
    let markers = lines.next().unwrap_or_default().split('\t').enumerate();
    let entries: Vec<(usize, Entry)> = markers
        .filter_map(|(column, name)| {
            let joint = JOINT_NAMES.iter().position(|other| *other == name.trim())?;
            Some([0, 1, 2].map(|axis| (column + axis, Entry::Joint(joint, axis, scale))))
        })
        .flatten()
        .collect();
    if entries.is_empty() {
        return Err(problem("none of its markers has a joint's name, such as 'index_tip'"));
    }
    let mut reference = Reference::new(Clock::Time);
    for line in lines.skip(1).filter(|line| !line.trim().is_empty()) {
        let cells: Vec<&str> = line.split('\t').map(str::trim).collect();
        push_row(&mut reference, &cells, 1, &entries)?;
    }
    reference.checked()
}

fn push_row(
    reference: &mut Reference,
    cells: &[&str],
    time: usize,
    entries: &[(usize, Entry)],
) -> Result<()> {
    let cell = |column: usize| {
        let cell = cells.get(column).ok_or_else(|| problem("a row is short of columns"))?;
        number(cell)
    };
    let values: Vec<(Entry, f64)> =
        entries.iter().map(|&(column, entry)| Ok((entry, cell(column)?))).collect::<Result<_>>()?;
    reference.push(cell(time)?, values.into_iter());
    Ok(())
}

/// Reads a MOT or STO file: columns by the names of phalanx, OpenSim's ARMS hand or myoHand,
/// whichever knows the most of them.
///
/// # Errors
/// Another format, no known column, a short row, times that do not ascend.
pub fn read_motion_file(text: &str) -> Result<Reference> {
    let (header, body) =
        text.split_once("endheader").ok_or_else(|| problem("it has no line 'endheader'"))?;
    let radians = !header.lines().any(|line| line.trim() == "inDegrees=yes");
    let scale = if radians { 1_f64.to_degrees() } else { 1.0 };
    let mut lines = body.lines().skip(1);
    let names: Vec<&str> = lines.next().unwrap_or_default().split_whitespace().collect();
    let models = [CoordinateNames::Phalanx, CoordinateNames::OpenSim, CoordinateNames::MyoHand];
    let known = models.map(|model| columns(&names, &model.coordinates(), scale));
    let entries = known.into_iter().max_by_key(Vec::len).unwrap_or_default();
    if entries.is_empty() {
        return Err(problem("none of its columns has a known name"));
    }
    let mut reference = Reference::new(Clock::Time);
    for line in lines.filter(|line| !line.trim().is_empty()) {
        let cells: Vec<&str> = line.split_whitespace().collect();
        push_row(&mut reference, &cells, 0, &entries)?;
    }
    reference.checked()
}

/// The columns that a model knows, angles only: what its lengths are in is not said.
fn columns(names: &[&str], coordinates: &[Coordinate], scale: f64) -> Vec<(usize, Entry)> {
    let known = names.iter().enumerate().filter_map(|(column, name)| {
        let coordinate = coordinates.iter().find(|coordinate| coordinate.name == *name)?;
        let is_angle = coordinate.dof.unit() == phalanx_hand::Unit::Angle;
        is_angle.then_some((column, Entry::Dof(coordinate.dof, coordinate.sign * scale)))
    });
    known.collect()
}
