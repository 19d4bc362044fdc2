//! What the page is told of a take: names as JSON, numbers as typed arrays in base64.

use std::collections::{BTreeMap, BTreeSet};

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use glam::{DVec2, DVec3};
use phalanx_hand::{Dof, JOINTS, Side, Unit};
use serde_json::{Value, json};

use crate::error::{Error, Result};
use crate::model::{Skeleton, Skin};
use crate::report::{FrameChoice, NamedRange, RangeOfMotion, Table, range_table, short};
use crate::take::{FrameView, LeftOut, Take, TakeFrame};

/// A page with more frames would be more than browsers bear.
pub const MOST_FRAMES: usize = 20_000;

/// What one camera saw.
#[derive(Debug, Clone)]
pub struct ViewPictures {
    /// The camera's name.
    pub name: String,
    /// The pictures' width, px.
    pub width: u32,
    /// Their height, px.
    pub height: u32,
    /// The pictures, in the order of their frames.
    pub pictures: Vec<ViewPicture>,
}

/// One picture.
#[derive(Debug, Clone)]
pub struct ViewPicture {
    /// Which of the take's frames it is of, counted from 0.
    pub frame: usize,
    /// The picture as a JPEG file.
    pub jpeg: Vec<u8>,
    /// Where the estimated joints are in it, px; none for one that is not to be drawn.
    pub joints: [Option<DVec2>; JOINTS],
    /// The outline of the estimated hand in it, px, in pieces; none where it is not to be drawn.
    pub outline: Vec<Vec<DVec2>>,
}

/// The page's data.
pub(super) fn of(take: &Take, pictures: &[ViewPictures]) -> Result<Value> {
    let step = take.frames.len().div_ceil(MOST_FRAMES).max(1);
    let frames: Vec<&TakeFrame> = take.frames.iter().step_by(step).collect();
    let codes: BTreeSet<&str> =
        frames.iter().flat_map(|frame| &frame.doubts).map(String::as_str).collect();
    let code_at: BTreeMap<&str, u32> = codes.iter().copied().zip(0..).collect();
    let doubts: Vec<(u32, u32)> = (0..)
        .zip(&frames)
        .flat_map(|(k, frame)| frame.doubts.iter().map(move |doubt| (k, doubt)))
        .map(|(k, doubt)| (k, code_at[doubt.as_str()]))
        .collect();
    let estimates = || frames.iter().map(|frame| frame.estimate.as_ref());
    let overlaps = frames.iter().flat_map(|frame| &frame.views);
    let pictures = pictures.iter().map(|view| picture_data(view, take.frames.len(), step));
    Ok(json!({
        "about": about(take, step),
        "side": take.header.hand.side,
        "frames": frames.len(),
        "dofs": Dof::ALL.map(|dof| {
            json!({ "name": dof.name(), "unit": unit(dof), "positive": positive(dof) })
        }),
        "views": take.header.views,
        "codes": codes,
        "time": base64(frames.iter().map(|frame| frame.time.to_le_bytes())),
        "index": base64(frames.iter().map(|frame| (frame.index as f64).to_le_bytes())),
        "pose": reals(estimates().flat_map(|estimate| {
            Dof::ALL.map(|dof| estimate.map(|e| dof.unit().to_file(e.pose[dof])))
        })),
        "std": reals(estimates().flat_map(|estimate| {
            let std = |dof: Dof| estimate.and_then(|e| e.std[dof.index()]);
            Dof::ALL.map(|dof| std(dof).map(|std| dof.unit().to_file(std)))
        })),
        "quality": reals(frames.iter().map(|frame| frame.quality())),
        "overlap": reals(overlaps.clone().map(|view| view.overlap)),
        "used": base64(overlaps.clone().map(|view| [u8::from(view.used)])),
        "leftOut": base64(overlaps.map(|view| [left_out(view)])),
        "leftOutCodes": LeftOut::ALL.map(LeftOut::code),
        "doubtFrames": base64(doubts.iter().map(|(frame, _)| frame.to_le_bytes())),
        "doubtCodes": base64(doubts.iter().map(|(_, code)| code.to_le_bytes())),
        "skeleton": skeleton(&Skeleton::new(&take.header.hand)),
        "skin": skin(&Skin::new(&take.header.hand)),
        "pictures": pictures.collect::<Result<Vec<_>>>()?,
        "range": range(take),
    }))
}

/// Why a view was left out, counted from 1; 0 of one that was not.
fn left_out(view: &FrameView) -> u8 {
    let number = |why| LeftOut::ALL.iter().zip(1..).find(|(own, _)| **own == why);
    view.left_out.and_then(number).map_or(0, |(_, number)| number)
}

fn unit(dof: Dof) -> &'static str {
    match dof.unit() {
        Unit::Angle => "deg",
        Unit::Length => "mm",
    }
}

/// Which way a number grows, of either hand.
fn positive(dof: Dof) -> &'static str {
    match dof {
        Dof::ThumbAbduction => "away from the palm",
        Dof::MiddleAbduction | Dof::WristDeviation => "towards the thumb",
        Dof::IndexAbduction | Dof::RingAbduction | Dof::LittleAbduction => {
            "away from the middle finger"
        }
        Dof::ThetaX => "about X",
        Dof::ThetaY => "about Y",
        Dof::ThetaZ => "about Z",
        Dof::TX => "along X",
        Dof::TY => "along Y",
        Dof::TZ => "along Z",
        _ => "towards the palm",
    }
}

/// A sentence on the whole take.
fn about(take: &Take, step: usize) -> String {
    let side = match take.header.hand.side {
        Side::Right => "Right",
        Side::Left => "Left",
    };
    let found = take.frames.iter().filter(|frame| frame.estimate.is_some()).count();
    let trusted = take.frames.iter().filter(|frame| frame.is_trusted()).count();
    let mut text = format!(
        "{side} hand; {} frames, a hand in {found}, {trusted} without a doubt; cameras: {}",
        take.frames.len(),
        take.header.views.join(", ")
    );
    if let Some(model) = &take.header.model {
        text.extend(["; model ", model]);
    }
    if step > 1 {
        text.extend(["; of the frames every ", &step.to_string(), "th is shown"]);
    }
    text + "."
}

fn base64<const N: usize>(values: impl Iterator<Item = [u8; N]>) -> String {
    BASE64_STANDARD.encode(values.flatten().collect::<Vec<u8>>())
}

/// Reals of four bytes, NaN where there is nothing.
fn reals(values: impl Iterator<Item = Option<f64>>) -> String {
    base64(values.map(|value| (value.unwrap_or(f64::NAN) as f32).to_le_bytes()))
}

fn vectors(values: &[DVec3]) -> String {
    reals(values.iter().flat_map(DVec3::to_array).map(Some))
}

fn skeleton(skeleton: &Skeleton) -> Value {
    let bone = |bone: &crate::model::SkeletonBone| {
        let turns =
            bone.turns.iter().map(|(axis, dof)| json!({ "axis": axis, "dof": dof.index() }));
        json!({
            "parent": bone.parent,
            "offset": bone.offset,
            "rest": bone.rest.to_array(),
            "turns": turns.collect::<Vec<_>>(),
        })
    };
    skeleton.bones.iter().map(bone).collect()
}

fn skin(skin: &Skin) -> Value {
    json!({
        "positions": vectors(&skin.positions),
        "normals": vectors(&skin.normals),
        "bones": BASE64_STANDARD.encode(&skin.bones),
        "triangles": base64(skin.triangles.iter().flatten().map(|corner| corner.to_le_bytes())),
    })
}

/// The pictures of frames that the page shows.
fn picture_data(view: &ViewPictures, frames: usize, step: usize) -> Result<Value> {
    if let Some(beyond) = view.pictures.iter().find(|picture| picture.frame >= frames) {
        let what = format!("view '{}' has a picture of frame {}", view.name, beyond.frame);
        return Err(Error::Picture { what: format!("{what}; the take has {frames} frames") });
    }
    let shown = || view.pictures.iter().filter(|picture| picture.frame.is_multiple_of(step));
    let joints = shown().flat_map(|picture| picture.joints);
    let uri = |jpeg: &Vec<u8>| format!("data:image/jpeg;base64,{}", BASE64_STANDARD.encode(jpeg));
    Ok(json!({
        "name": view.name,
        "width": view.width,
        "height": view.height,
        "frames": shown().map(|picture| picture.frame / step).collect::<Vec<_>>(),
        "data": shown().map(|picture| uri(&picture.jpeg)).collect::<Vec<_>>(),
        "joints": reals(joints.flat_map(coordinates)),
        "outlines": shown().map(|picture| outline(&picture.outline)).collect::<Vec<_>>(),
    }))
}

/// The points of an outline, with a point that is none after each piece.
fn outline(pieces: &[Vec<DVec2>]) -> String {
    let points = pieces.iter().flat_map(|piece| piece.iter().copied().map(Some).chain([None]));
    reals(points.flat_map(coordinates))
}

fn coordinates(at: Option<DVec2>) -> [Option<f64>; 2] {
    [at.map(|at| at.x), at.map(|at| at.y)]
}

/// The range of motion of the frames without a doubt.
fn range(take: &Take) -> Value {
    let Some(range) = RangeOfMotion::of(take, FrameChoice::Trusted) else {
        return json!({ "notes": "No frame can be trusted.", "columns": [], "rows": [] });
    };
    let Table { rows, .. } = range_table(NamedRange { name: "", range: &range }, None);
    let cells = rows.iter().map(|row| {
        let cells = row.cells.iter().flatten().map(|cell| short(*cell));
        std::iter::once(row.name.clone()).chain(cells).collect::<Vec<_>>()
    });
    let notes = format!(
        "Degrees, ± a standard deviation, over the {} of {} frames without a doubt. A finger's total is the sum of its flexions where that is largest, less what is left where it is smallest.",
        range.counted, range.frames
    );
    json!({
        "notes": notes,
        "columns": ["smallest", "largest", "range"],
        "rows": cells.collect::<Vec<_>>(),
    })
}
