//! Kalibr's chains of cameras.

use glam::{DMat3, DVec3};

use crate::calibration::field::Field;
use crate::calibration::fields::Fields;
use crate::calibration::record::{Pose, Record};
use crate::calibration::value::{Map, Value, get};
use crate::error::{Error, Result};

/// From the camera before.
const LINK: &str = "T_cn_cnm1";

/// Whether sections are those of a chain.
pub(super) fn is_chain(root: &Map) -> bool {
    let sections = || root.iter().filter_map(|(_, value)| value.as_map());
    sections().any(|section| get(section, LINK).is_some())
        || sections().any(|s| get(s, "camera_model").is_some() && get(s, "intrinsics").is_some())
}

/// The cameras; the first one's frame is the world.
pub(super) fn records(root: &Map) -> Result<Vec<Record>> {
    let mut before: Option<Pose> = None;
    let mut records = Vec::new();
    for (name, value) in root {
        let Some(section) = value.as_map() else { continue };
        let link = get(section, LINK).map(|link| link_pose(name, link)).transpose()?;
        let pose = match (before, link) {
            (None, None) => Pose { rotation: DMat3::IDENTITY, translation: DVec3::ZERO },
            (Some(before), Some(link)) => link.after(&before),
            (Some(_), None) => return Err(Error::field(name, LINK, "is missing")),
            (None, Some(_)) => {
                return Err(Error::field(
                    name,
                    LINK,
                    "leads from a camera that is not in the file",
                ));
            }
        };
        before = Some(pose);
        // What the camera says itself, with its place in the chain as R and t.
        let mut section: Map = section
            .iter()
            .filter(|(key, _)| key != LINK && Field::of(key) != Field::Rotation)
            .cloned()
            .collect();
        let numbers =
            |numbers: &[f64]| Value::List(numbers.iter().map(|&n| Value::Number(n)).collect());
        section.push(("R".to_owned(), numbers(&pose.rotation.transpose().to_cols_array())));
        section.push(("t".to_owned(), numbers(&pose.translation.to_array())));
        records.push(Fields::of(name, &section).record()?);
    }
    Ok(records)
}

fn link_pose(name: &str, link: &Value) -> Result<Pose> {
    let wrong = || Error::field(name, LINK, "is no matrix of 4×4 numbers");
    let numbers: [f64; 16] = link.numbers().and_then(|n| n.try_into().ok()).ok_or_else(wrong)?;
    let column = |i: usize| DVec3::new(numbers[i], numbers[4 + i], numbers[8 + i]);
    Ok(Pose { rotation: DMat3::from_cols(column(0), column(1), column(2)), translation: column(3) })
}
