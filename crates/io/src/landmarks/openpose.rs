//! OpenPose's JSON: a file a frame, people with flat lists of x, y and confidence.

use phalanx_hand::{JOINTS, Landmark, Landmarks, Side};
use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::landmarks::track::{LandmarkTrack, landmark};

#[derive(Deserialize)]
struct Outline {
    people: Option<IgnoredAny>,
}

#[derive(Deserialize)]
struct Frame {
    people: Vec<Person>,
}

#[derive(Deserialize)]
#[serde(default)]
#[derive(Default)]
struct Person {
    hand_left_keypoints_2d: Vec<f64>,
    hand_right_keypoints_2d: Vec<f64>,
}

/// Whether it is a frame of OpenPose.
pub(super) fn is_frame(text: &str) -> bool {
    serde_json::from_str(text).is_ok_and(|outline: Outline| outline.people.is_some())
}

/// Reads a frame: of several people the one whose hand is seen most surely.
pub(super) fn read(
    text: &str,
    side: Side,
    number: Option<u64>,
) -> Result<Vec<LandmarkTrack>, String> {
    let Frame { people } = serde_json::from_str(text).map_err(|error| error.to_string())?;
    let mut surest: Option<(f64, Landmarks)> = None;
    for (k, person) in people.into_iter().enumerate() {
        let (name, numbers) = match side {
            Side::Left => ("hand_left_keypoints_2d", person.hand_left_keypoints_2d),
            Side::Right => ("hand_right_keypoints_2d", person.hand_right_keypoints_2d),
        };
        if numbers.is_empty() {
            continue;
        }
        let (points, rest) = numbers.as_chunks();
        let points: &[[f64; 3]; JOINTS] =
            points.try_into().ok().filter(|_| rest.is_empty()).ok_or_else(|| {
                format!(
                    "person {k}: {name} has {} numbers, not 3 for each of {JOINTS}",
                    numbers.len()
                )
            })?;
        let points = points.map(|[x, y, confidence]| landmark(x, y, confidence));
        let sure: f64 = points.iter().flatten().map(|point: &Landmark| point.confidence).sum();
        if surest.as_ref().is_none_or(|(most, _)| sure > *most) {
            surest = Some((sure, points));
        }
    }
    let points = surest.map(|(_, points)| points);
    Ok(vec![LandmarkTrack::of(None, [(number, points)])?])
}
