//! What is known of a take's hand from elsewhere. It scores, and nothing else.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use glam::{DVec2, DVec3};
use phalanx_hand::JOINTS;

use super::angles::{self, BoneAngles, FingerState};
use super::frame::FrameName;
use super::table::Table;

/// Degrees by which the reference's views may differ for an angle to count.
const AGREED_DEG: f64 = 10.0;

/// The 21 points of one frame, those that are known.
pub type Points<V> = [Option<V>; JOINTS];

/// Everything that is known of a take. A map without entries stands for a file that is not there.
#[derive(Debug, Clone, Default)]
pub struct Reference {
    /// The joints in the world, mm.
    pub joints: BTreeMap<FrameName, Points<DVec3>>,
    /// Angles between bones, degrees; those that the reference's views agree on.
    pub angles: BTreeMap<FrameName, [Option<f64>; angles::COUNT]>,
    /// Thumb, index, middle, ring, little finger; nothing where people could not tell.
    pub states: BTreeMap<FrameName, [Option<FingerState>; 5]>,
    /// A detector's points in each camera's pictures, px; in the order of the cameras.
    pub landmarks: Vec<BTreeMap<FrameName, Points<DVec2>>>,
}

impl Reference {
    /// Reads what there is in a take's folder, landmarks for cameras of these names.
    ///
    /// # Errors
    /// A file that is no table of the form expected; names it and the line.
    pub fn read(folder: &Path, cameras: &[&str]) -> Result<Self> {
        let landmarks = cameras.iter().map(|camera| {
            let of = Table::open(&folder.join(format!("landmarks-{camera}.csv")))?;
            points(of, ["x_px", "y_px"], DVec2::from_array)
        });
        Ok(Self {
            joints: points(
                Table::open(&folder.join("reference-joints.csv"))?,
                ["x_mm", "y_mm", "z_mm"],
                DVec3::from_array,
            )?,
            angles: bone_angles(Table::open(&folder.join("reference-angles.csv"))?)?,
            states: finger_states(Table::open(&folder.join("finger-states.csv"))?)?,
            landmarks: landmarks.collect::<Result<_>>()?,
        })
    }
}

/// One point a row: `frame`, `joint` and its coordinates.
fn points<const N: usize, V>(
    table: Option<Table>,
    coordinates: [&str; N],
    of_array: impl Fn([f64; N]) -> V,
) -> Result<BTreeMap<FrameName, Points<V>>> {
    let mut frames = BTreeMap::new();
    let Some(table) = table else { return Ok(frames) };
    let (frame, joint) = (table.column("frame")?, table.column("joint")?);
    let mut columns = [0; N];
    for (column, name) in columns.iter_mut().zip(coordinates) {
        *column = table.column(name)?;
    }
    for row in table.rows() {
        let number = row.number(joint)?.unwrap_or(f64::NAN);
        let known = (0..JOINTS).find(|&joint| joint as f64 == number);
        let joint = known.with_context(|| row.at(&format!("joint {number} is not 0 to 20")))?;
        let mut values = [0.0; N];
        let mut is_whole = true;
        for (value, &column) in values.iter_mut().zip(&columns) {
            let read = row.number(column)?;
            is_whole &= read.is_some();
            *value = read.unwrap_or(f64::NAN);
        }
        let points: &mut Points<V> = frames
            .entry(FrameName::from(row.text(frame)))
            .or_insert_with(|| [const { None }; JOINTS]);
        ensure!(points[joint].is_none(), row.at(&format!("joint {joint} comes twice")));
        points[joint] = is_whole.then(|| of_array(values));
    }
    Ok(frames)
}

/// A row a frame: the angles, and by how much the reference's views disagree about each.
fn bone_angles(table: Option<Table>) -> Result<BTreeMap<FrameName, [Option<f64>; angles::COUNT]>> {
    let mut frames = BTreeMap::new();
    let Some(table) = table else { return Ok(frames) };
    let frame = table.column("frame")?;
    let names: [String; angles::COUNT] = std::array::from_fn(angles::name);
    let columns: Vec<usize> =
        names.iter().map(|name| table.column(&format!("{name}_deg"))).collect::<Result<_>>()?;
    // A reference that does not say how sure it is is believed.
    let disagreements: Vec<Option<usize>> =
        names.iter().map(|name| table.column(&format!("{name}_disagreement_deg")).ok()).collect();
    for row in table.rows() {
        let mut angles: BoneAngles<Option<f64>> = [None; angles::COUNT];
        for ((angle, &column), disagreement) in angles.iter_mut().zip(&columns).zip(&disagreements)
        {
            let apart = match disagreement {
                Some(column) => row.number(*column)?,
                None => Some(0.0),
            };
            *angle = row.number(column)?.filter(|_| apart.is_some_and(|apart| apart < AGREED_DEG));
        }
        frames.insert(FrameName::from(row.text(frame)), angles);
    }
    Ok(frames)
}

/// A row a frame: a finger a column.
fn finger_states(table: Option<Table>) -> Result<BTreeMap<FrameName, [Option<FingerState>; 5]>> {
    let mut frames = BTreeMap::new();
    let Some(table) = table else { return Ok(frames) };
    let frame = table.column("frame")?;
    let fingers = ["thumb", "index", "middle", "ring", "little"];
    let columns: Vec<usize> =
        fingers.iter().map(|finger| table.column(finger)).collect::<Result<_>>()?;
    for row in table.rows() {
        let mut states = [None; 5];
        for (state, &column) in states.iter_mut().zip(&columns) {
            *state = match row.text(column) {
                "extended" => Some(FingerState::Extended),
                "folded" => Some(FingerState::Folded),
                "" => None,
                other => {
                    return Err(anyhow::anyhow!(
                        row.at(&format!("'{other}' is neither extended nor folded nor blank"))
                    ));
                }
            };
        }
        frames.insert(FrameName::from(row.text(frame)), states);
    }
    Ok(frames)
}
