//! Results of MediaPipe's hand landmarker as scripts save them: JSON, a result a frame.

use std::collections::BTreeMap;

use phalanx_hand::{Landmark, Landmarks, Side};
use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::landmarks::candidates::{Candidate, choose};
use crate::landmarks::track::{LandmarkTrack, hand, landmark};

/// What a document holds, looked at before it is read.
#[derive(Deserialize)]
struct Outline {
    frames: Option<IgnoredAny>,
    #[serde(alias = "cameras")]
    views: Option<IgnoredAny>,
}

/// The frames of one camera.
#[derive(Deserialize)]
struct OneView {
    frames: Vec<Option<Frame>>,
}

/// The frames of several by name.
#[derive(Deserialize)]
struct Views {
    #[serde(alias = "cameras")]
    views: BTreeMap<String, Vec<Option<Frame>>>,
}

/// A frame: the points of the one hand, or a result.
#[derive(Deserialize)]
#[serde(untagged)]
enum Frame {
    Hand(Vec<Option<Point>>),
    Result(HandResult),
}

/// A result of any of MediaPipe's interfaces.
#[derive(Deserialize)]
struct HandResult {
    #[serde(alias = "frame_number", alias = "frame_index", alias = "frame_id")]
    frame: Option<u64>,
    #[serde(
        alias = "hand_landmarks",
        alias = "handLandmarks",
        alias = "multi_hand_landmarks",
        alias = "multiHandLandmarks"
    )]
    landmarks: Option<Hands>,
    handedness: Option<Vec<Label>>,
    /// An older name of the same.
    handednesses: Option<Vec<Label>>,
    /// As in a mirror.
    #[serde(alias = "multiHandedness")]
    multi_handedness: Option<Vec<Label>>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Hands {
    One(Vec<Option<Point>>),
    Many(Vec<Hand>),
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Hand {
    Bare(Vec<Option<Point>>),
    Message {
        #[serde(alias = "landmarks")]
        landmark: Vec<Option<Point>>,
    },
}

/// A point; what stands third in a list is its depth. How visible a hand's points are MediaPipe does not
/// know: it writes 0.
#[derive(Deserialize)]
#[serde(untagged)]
enum Point {
    List(Vec<Option<f64>>),
    Named {
        // Absent is not null.
        #[serde(deserialize_with = "Option::deserialize")]
        x: Option<f64>,
        #[serde(deserialize_with = "Option::deserialize")]
        y: Option<f64>,
        #[serde(alias = "score", alias = "likelihood")]
        confidence: Option<f64>,
    },
}

/// Which hand it is.
#[derive(Deserialize)]
#[serde(untagged)]
enum Label {
    Text(String),
    Classes(Vec<Class>),
    Message { classification: Vec<Class> },
    Class(Class),
}

#[derive(Deserialize)]
struct Class {
    #[serde(alias = "category_name", alias = "categoryName")]
    label: String,
    score: Option<f64>,
}

/// Reads a document, or one a line; `number` is that of a file that holds one frame.
pub(super) fn read(
    text: &str,
    side: Side,
    number: Option<u64>,
) -> Result<Vec<LandmarkTrack>, String> {
    if text.trim_start().starts_with('[') {
        return Ok(vec![track(None, parsed(text)?, side, None)?]);
    }
    let mut documents = serde_json::Deserializer::from_str(text).into_iter::<Outline>();
    let first = documents.next().ok_or("it holds nothing")?.map_err(|error| reason(&error))?;
    if first.views.is_some() {
        let Views { views } = parsed(text)?;
        let of_view = |(camera, frames)| track(Some(camera), frames, side, None);
        return views.into_iter().map(of_view).collect();
    }
    if first.frames.is_some() {
        let OneView { frames } = parsed(text)?;
        return Ok(vec![track(None, frames, side, None)?]);
    }
    let lines = serde_json::Deserializer::from_str(text).into_iter::<Option<Frame>>();
    let frames: Vec<Option<Frame>> =
        lines.collect::<Result<_, _>>().map_err(|error| reason(&error))?;
    let number = number.filter(|_| frames.len() == 1);
    Ok(vec![track(None, frames, side, number)?])
}

fn parsed<'a, T: Deserialize<'a>>(text: &'a str) -> Result<T, String> {
    serde_json::from_str(text).map_err(|error| reason(&error))
}

fn reason(error: &serde_json::Error) -> String {
    if error.classify() != serde_json::error::Category::Data {
        return format!("{error}; a point that is not seen is null, not NaN");
    }
    let (line, column) = (error.line(), error.column());
    format!(
        "line {line}, column {column}: what ends here is no frame; a frame is null, 21 points [x, y], or a \
         result with `hand_landmarks`"
    )
}

fn track(
    camera: Option<String>,
    frames: Vec<Option<Frame>>,
    side: Side,
    number: Option<u64>,
) -> Result<LandmarkTrack, String> {
    let numbers: Vec<Option<u64>> =
        frames.iter().map(|frame| number_of(frame.as_ref()).or(number)).collect();
    let numbered = numbers.iter().any(Option::is_some);
    let hands = frames.into_iter().enumerate().map(|(k, frame)| {
        candidates(frame).map_err(|what| format!("frame {k} of the file: {what}"))
    });
    let chosen = choose(hands.collect::<Result<_, _>>()?, side)?;
    // Null in a list of numbered frames is no frame.
    let frames = numbers.into_iter().zip(chosen);
    LandmarkTrack::of(
        camera,
        frames.filter(|(number, hand)| !numbered || number.is_some() || hand.is_some()),
    )
}

fn number_of(frame: Option<&Frame>) -> Option<u64> {
    match frame {
        Some(Frame::Result(result)) => result.frame,
        _ => None,
    }
}

/// The hands of a frame.
fn candidates(frame: Option<Frame>) -> Result<Vec<Candidate>, String> {
    let (hands, labels, is_mirrored) = match frame {
        None => return Ok(Vec::new()),
        Some(Frame::Hand(points)) => (vec![points], None, false),
        Some(Frame::Result(result)) => {
            let hands = match result.landmarks {
                None => Vec::new(),
                Some(Hands::One(points)) if points.is_empty() => Vec::new(),
                Some(Hands::One(points)) => vec![points],
                Some(Hands::Many(hands)) => hands.into_iter().map(Hand::points).collect(),
            };
            match result.multi_handedness {
                Some(mirrored) => (hands, Some(mirrored), true),
                None => (hands, result.handedness.or(result.handednesses), false),
            }
        }
    };
    let labels = labels.unwrap_or_default();
    if !labels.is_empty() && labels.len() != hands.len() {
        return Err(format!("{} hands, and {} names of their sides", hands.len(), labels.len()));
    }
    let mut candidates = Vec::new();
    for (k, points) in hands.into_iter().enumerate() {
        let Some(points) = points_of(&points)? else { continue };
        let said = labels.get(k).map(|label| label.side(is_mirrored)).transpose()?;
        candidates.push(Candidate { points, said });
    }
    Ok(candidates)
}

fn points_of(points: &[Option<Point>]) -> Result<Option<Landmarks>, String> {
    let point = |point: &Option<Point>| point.as_ref().and_then(Point::landmark);
    hand(points.iter().map(point).collect())
}

impl Hand {
    fn points(self) -> Vec<Option<Point>> {
        match self {
            Self::Bare(points) | Self::Message { landmark: points } => points,
        }
    }
}

impl Point {
    fn landmark(&self) -> Option<Landmark> {
        match self {
            Self::List(numbers) => match numbers[..] {
                [Some(x), Some(y), ..] => landmark(x, y, 1.0),
                _ => None,
            },
            Self::Named { x, y, confidence } => landmark((*x)?, (*y)?, confidence.unwrap_or(1.0)),
        }
    }
}

impl Label {
    fn side(&self, is_mirrored: bool) -> Result<(Side, f64), String> {
        let (label, score) = match self {
            Self::Text(label) => (label.as_str(), 1.0),
            Self::Classes(classes) | Self::Message { classification: classes } => {
                let class = classes.first().ok_or("a hand's side is an empty list")?;
                (class.label.as_str(), class.score.unwrap_or(1.0))
            }
            Self::Class(class) => (class.label.as_str(), class.score.unwrap_or(1.0)),
        };
        let is_left = match label.to_lowercase().as_str() {
            "left" => true,
            "right" => false,
            _ => return Err(format!("'{}' is neither Left nor Right", label.escape_debug())),
        };
        Ok((if is_left == is_mirrored { Side::Right } else { Side::Left }, score))
    }
}
