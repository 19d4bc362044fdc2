//! Files as tools write them.

use phalanx_hand::{Landmarks, Side};
use phalanx_io::Source;
use phalanx_io::landmarks::{LandmarkTrack, read};
use serde_json::{Value, json};

fn track(name: &str, text: &str, side: Side) -> LandmarkTrack {
    let mut tracks = read(&Source { name, bytes: text.as_bytes() }, side).unwrap();
    assert_eq!(tracks.len(), 1);
    tracks.remove(0)
}

fn first_x(points: &Landmarks) -> f64 {
    points[0].unwrap().at.x
}

/// A hand whose wrist is at `x`.
fn points(x: f64) -> Vec<Value> {
    (0..21)
        .map(|k| json!({ "x": x, "y": 0.01 * f64::from(k), "z": 0.1, "visibility": 0.0 }))
        .collect()
}

#[test]
fn a_lone_hand_is_taken_whatever_it_is_called() {
    let result = |label: &str| {
        json!({
            "handedness": [[{ "index": 0, "score": 0.97, "category_name": label }]],
            "hand_landmarks": [points(0.25)],
            "hand_world_landmarks": [points(0.0)],
        })
    };
    let file = json!([result("Left"), result("Right"), { "hand_landmarks": [], "handedness": [] }]);
    let track = track("a.json", &file.to_string(), Side::Right);
    assert_eq!(track.frames.keys().copied().collect::<Vec<_>>(), [0, 1]);
    assert!(track.frames.values().all(|points| first_x(points) == 0.25));
}

#[test]
fn of_several_hands_that_of_the_side_is_taken() {
    let tasks = json!([
        { "landmarks": [points(0.1), points(0.2)],
          "worldLandmarks": [],
          "handedness": [[{ "score": 0.9, "categoryName": "Left" }],
                         [{ "score": 0.9, "categoryName": "Right" }]] },
        { "landmarks": [points(0.3)], "handedness": [[{ "score": 0.9, "categoryName": "Left" }]] },
    ])
    .to_string();
    let right = track("a.json", &tasks, Side::Right);
    assert_eq!(right.frames.len(), 1);
    assert_eq!(first_x(&right.frames[&0]), 0.2);
    assert_eq!(first_x(&track("a.json", &tasks, Side::Left).frames[&1]), 0.3);
    // As in a mirror.
    let solutions = json!([{
        "multi_hand_landmarks": [{ "landmark": points(0.1) }, { "landmark": points(0.2) }],
        "multi_handedness": [{ "classification": [{ "index": 0, "score": 0.9, "label": "Left" }] },
                             { "classification": [{ "index": 1, "score": 0.9, "label": "Right" }] }],
    }]);
    assert_eq!(first_x(&track("a.json", &solutions.to_string(), Side::Right).frames[&0]), 0.1);
}

#[test]
fn json_lines_have_the_numbers_that_they_say() {
    let line = |frame: u32| json!({ "frame": frame, "hand_landmarks": [points(0.5)] }).to_string();
    let lines = track("a.jsonl", &format!("{}\n{}\n", line(14), line(16)), Side::Right);
    assert_eq!(lines.frames.keys().copied().collect::<Vec<_>>(), [14, 16]);
    let one = json!({ "hand_landmarks": [points(0.5)] }).to_string();
    let numbered = track("cam0_000000000031.json", &one, Side::Right);
    assert_eq!(numbered.frames.keys().copied().collect::<Vec<_>>(), [31]);
}

#[test]
fn openpose_s_hand_of_the_surest_person_is_taken() {
    let hand = |x: f64, sure: f64| -> Vec<f64> { (0..21).flat_map(|_| [x, 20.0, sure]).collect() };
    let mut unseen = hand(50.0, 0.8);
    unseen[3..6].fill(0.0);
    let file = json!({ "version": 1.3, "people": [
        { "person_id": [-1], "pose_keypoints_2d": [], "hand_left_keypoints_2d": hand(70.0, 0.9),
          "hand_right_keypoints_2d": hand(30.0, 0.2) },
        { "person_id": [-1], "hand_left_keypoints_2d": [], "hand_right_keypoints_2d": unseen },
    ]})
    .to_string();
    let name = "take_000000000012_keypoints.json";
    let right = &track(name, &file, Side::Right).frames[&12];
    assert_eq!(first_x(right), 50.0);
    assert_eq!((right[1], right[2].unwrap().confidence), (None, 0.8));
    assert_eq!(first_x(&track(name, &file, Side::Left).frames[&12]), 70.0);
    let nobody = json!({ "version": 1.3, "people": [] }).to_string();
    assert!(track(name, &nobody, Side::Right).frames.is_empty());
}

#[test]
fn deeplabcut_s_frames_may_be_pictures() {
    let text = "scorer,n,n,n,n,n\nbodyparts,wrist,wrist,wrist,nose,nose\ncoords,x,y,likelihood,x,y\n\
                labeled-data/take/img0042.png,10.5,20.5,0.75,1,2\n";
    let track = track("a.csv", text, Side::Right);
    let wrist = track.frames[&42][0].unwrap();
    assert_eq!((wrist.at.x, wrist.at.y, wrist.confidence), (10.5, 20.5, 0.75));
}
