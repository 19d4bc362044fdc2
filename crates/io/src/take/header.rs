//! The header of a take as JSON: the first of the JSON Lines, and a cell of the other forms.

use glam::{DAffine3, DMat3, DVec3};
use phalanx_hand::HandShape;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::take::frames::{FORMAT_VERSION, TakeHeader};

/// The mark of a take.
pub(super) const FORMAT: &str = "phalanx-take";

/// The JSON form of [`TakeHeader`].
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct HeaderLine {
    format: String,
    version: u32,
    units: Units,
    model: Option<String>,
    rate_hz: Option<f64>,
    views: Vec<String>,
    world_from_hand: Frame,
    hand: HandShape,
}

/// Said for the reader's sake: they are always these.
#[derive(Serialize, Deserialize, PartialEq, Default)]
#[serde(deny_unknown_fields)]
struct Units {
    angle: AngleUnit,
    length: LengthUnit,
    time: TimeUnit,
}

#[derive(Serialize, Deserialize, PartialEq, Default)]
#[serde(rename_all = "lowercase")]
enum AngleUnit {
    #[default]
    Deg,
}

#[derive(Serialize, Deserialize, PartialEq, Default)]
#[serde(rename_all = "lowercase")]
enum LengthUnit {
    #[default]
    Mm,
}

#[derive(Serialize, Deserialize, PartialEq, Default)]
#[serde(rename_all = "lowercase")]
enum TimeUnit {
    #[default]
    S,
}

/// A coordinate frame in the world.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Frame {
    origin_mm: DVec3,
    x_axis: DVec3,
    y_axis: DVec3,
    z_axis: DVec3,
}

impl HeaderLine {
    pub(super) fn new(header: &TakeHeader) -> Self {
        let DMat3 { x_axis, y_axis, z_axis } = header.world_from_hand.matrix3;
        Self {
            format: FORMAT.to_owned(),
            version: FORMAT_VERSION,
            units: Units::default(),
            model: header.model.clone(),
            rate_hz: header.rate_hz,
            views: header.views.clone(),
            world_from_hand: Frame {
                origin_mm: header.world_from_hand.translation,
                x_axis,
                y_axis,
                z_axis,
            },
            hand: header.hand.clone(),
        }
    }
}

/// The header as one line of JSON, without its end.
pub(super) fn to_json(header: &TakeHeader) -> String {
    serde_json::to_string(&HeaderLine::new(header)).expect("a plain structure with string keys")
}

/// Reads the header.
pub(super) fn from_json(json: &str) -> Result<TakeHeader> {
    #[derive(Deserialize)]
    struct Mark {
        format: String,
        version: u32,
    }
    let problem = |what: String| Error::TakeHeader { what };
    let mark: Mark = serde_json::from_str(json)
        .map_err(|error| problem(format!("it does not begin as a take does: {error}")))?;
    if mark.format != FORMAT {
        return Err(problem(format!("its format is '{}', not '{FORMAT}'", mark.format)));
    }
    if mark.version != FORMAT_VERSION {
        let version = mark.version;
        return Err(problem(format!(
            "it has version {version}; this phalanx reads version {FORMAT_VERSION}"
        )));
    }
    let line: HeaderLine =
        serde_json::from_str(json).map_err(|error| problem(error.to_string()))?;
    let Frame { origin_mm, x_axis, y_axis, z_axis } = line.world_from_hand;
    let rotation = DMat3::from_cols(x_axis, y_axis, z_axis);
    Ok(TakeHeader {
        hand: line.hand,
        world_from_hand: DAffine3::from_mat3_translation(rotation, origin_mm),
        views: line.views,
        rate_hz: line.rate_hz,
        model: line.model,
    })
}
