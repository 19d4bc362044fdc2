//! Any points, written in each form, are read as they were.

use std::collections::BTreeMap;
use std::fmt::Write;

use glam::DVec2;
use phalanx_hand::{JOINTS, Landmark, Landmarks, Side};
use phalanx_io::landmarks::{LandmarkTrack, read};
use phalanx_io::{Error, Source};
use proptest::prelude::*;
use serde_json::{Value, json};

type Frames = Vec<Option<Landmarks>>;

/// Frames of which the last shows a hand, points of pictures of 640×480, in eighths.
fn frames(confident: bool) -> impl Strategy<Value = Frames> {
    let sure = if confident { 1..=8_u32 } else { 8..=8_u32 };
    let point = (-100..5200_i32, -100..3900_i32, sure).prop_map(|(x, y, sure)| Landmark {
        at: DVec2::new(f64::from(x) / 8.0, f64::from(y) / 8.0),
        confidence: f64::from(sure) / 8.0,
    });
    let large = Landmark { at: DVec2::new(300.0, 200.0), confidence: 1.0 };
    let points = prop::array::uniform21(prop::option::weighted(0.8, point));
    let frame = prop::option::weighted(0.7, points.clone())
        .prop_map(|frame| frame.filter(|points| points.iter().any(Option::is_some)));
    (prop::collection::vec(frame, 0..5), points).prop_map(move |(mut frames, mut last)| {
        last[0] = Some(large);
        frames.push(Some(last));
        frames
    })
}

fn track(frames: &Frames) -> LandmarkTrack {
    let numbered = (0..).zip(frames).filter_map(|(k, frame)| Some((k, (*frame)?)));
    LandmarkTrack { frames: numbered.collect(), ..LandmarkTrack::default() }
}

/// The same of a file that does not number its frames.
fn placed(frames: &Frames) -> LandmarkTrack {
    LandmarkTrack { places: Some(frames.len() as u64), ..track(frames) }
}

fn read_one(name: &str, bytes: &[u8], side: Side) -> Result<LandmarkTrack, Error> {
    let mut tracks = read(&Source { name, bytes }, side)?;
    assert_eq!(tracks.len(), 1);
    Ok(tracks.remove(0))
}

fn table(frames: &Frames) -> String {
    let mut text = "frame,joint,x_px,y_px,confidence\n".to_owned();
    for (k, points) in frames.iter().enumerate() {
        for (joint, point) in points.iter().flatten().enumerate() {
            let Some(Landmark { at, confidence }) = point else { continue };
            writeln!(text, "{k:04},{joint},{},{},{confidence}", at.x, at.y).unwrap();
        }
    }
    text
}

fn deeplabcut(frames: &Frames) -> String {
    let row = |first: &str, cell: &dyn Fn(usize) -> String| {
        (0..3 * JOINTS).fold(first.to_owned(), |row, k| row + "," + &cell(k)) + "\n"
    };
    let mut text = row("scorer", &|_| "net".to_owned());
    text += &row("bodyparts", &|k| phalanx_io::take::JOINT_NAMES[k / 3].to_owned());
    text += &row("coords", &|k| ["x", "y", "likelihood"][k % 3].to_owned());
    for (number, points) in frames.iter().enumerate() {
        text += &row(&number.to_string(), &|k| {
            let point = points.and_then(|points| points[k / 3]);
            point.map_or_else(String::new, |point| numbers(point)[k % 3].to_string())
        });
    }
    text
}

fn numbers(point: Landmark) -> [f64; 3] {
    [point.at.x, point.at.y, point.confidence]
}

/// As `numpy.save` writes an array of frames × 21 × 3, or of two cameras that see the same.
fn array(frames: &Frames, views: usize) -> Vec<u8> {
    let shape = if views == 1 { String::new() } else { format!("{views}, ") };
    let shape = format!("{shape}{}, {JOINTS}, 3", frames.len());
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({shape}), }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(u16::try_from(header.len()).unwrap().to_le_bytes());
    bytes.extend(header.as_bytes());
    for points in (0..views).flat_map(|_| frames) {
        for joint in 0..JOINTS {
            let point = points.and_then(|points| points[joint]);
            let of = point.map_or([f64::NAN, f64::NAN, 0.0], numbers);
            bytes.extend(of.iter().flat_map(|number| (*number as f32).to_le_bytes()));
        }
    }
    bytes
}

fn point_lists(points: &Landmarks) -> Value {
    points
        .iter()
        .map(|point| point.map_or(Value::Null, |own| json!([own.at.x, own.at.y])))
        .collect()
}

proptest! {
    #![proptest_config(crate::property::cases(64))]

    #[test]
    fn what_is_written_with_confidences_is_read(frames in frames(true)) {
        let whole = track(&frames);
        prop_assert_eq!(&read_one("a.csv", table(&frames).as_bytes(), Side::Right).unwrap(), &whole);
        let written = deeplabcut(&frames);
        prop_assert_eq!(&read_one("a.csv", written.as_bytes(), Side::Right).unwrap(), &whole);
        let whole = placed(&frames);
        prop_assert_eq!(&read_one("a.npy", &array(&frames, 1), Side::Right).unwrap(), &whole);
        let file = array(&frames, 2);
        let both = read(&Source { name: "a.npy", bytes: &file }, Side::Right).unwrap();
        prop_assert_eq!(both, vec![whole.clone(), whole]);
    }

    #[test]
    fn what_is_written_as_lists_is_read(frames in frames(false)) {
        let whole = placed(&frames);
        let lists: Value =
            frames.iter().map(|frame| frame.as_ref().map_or(Value::Null, point_lists)).collect();
        let text = lists.to_string();
        prop_assert_eq!(&read_one("a.json", text.as_bytes(), Side::Right).unwrap(), &whole);
        let text = json!({ "frames": lists.clone() }).to_string();
        prop_assert_eq!(&read_one("a.json", text.as_bytes(), Side::Left).unwrap(), &whole);
        let text = json!({ "views": { "left": lists } }).to_string();
        let named = read_one("a.json", text.as_bytes(), Side::Left).unwrap();
        prop_assert_eq!(named.camera.as_deref(), Some("left"));
        prop_assert_eq!(named.frames, whole.frames);
    }

    /// Shares of a picture come out in its pixels, and pixels stay.
    #[test]
    fn shares_become_pixels(frames in frames(true)) {
        let whole = track(&frames);
        let size = (640, 480);
        prop_assert_eq!(&whole.clone().in_pixels(size), &whole);
        let mut shares = whole.clone();
        let shrink = DVec2::new(1.0 / 1024.0, 1.0 / 512.0);
        shares.frames.values_mut().flatten().flatten().for_each(|point| point.at *= shrink);
        prop_assert_eq!(&shares.in_pixels((1024, 512)), &whole);
    }

    #[test]
    fn files_of_one_camera_join(frames in frames(true)) {
        let whole = track(&frames);
        let mut joined = LandmarkTrack::default();
        for (&number, points) in &whole.frames {
            let frames = BTreeMap::from([(number, *points)]);
            joined.join(LandmarkTrack { frames, ..LandmarkTrack::default() }, "a").unwrap();
        }
        prop_assert_eq!(&joined, &whole);
        let again = joined.join(whole, "b.json").unwrap_err().to_string();
        prop_assert!(again.starts_with("landmarks: b.json: frame "), "{again}");
    }
}
