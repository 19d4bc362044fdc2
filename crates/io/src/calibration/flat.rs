//! Files in which each key names a field and a camera: `K_01`, `dist_01`, `M1`, `D1`, `left_K`.

use crate::calibration::field::Field;
use crate::calibration::record::MOST_CAMERAS;
use crate::calibration::value::{Map, Sections, Value, get};

/// The fields that may stand so.
const FIELDS: [Field; 9] = [
    Field::Matrix,
    Field::Distortion,
    Field::Rotation,
    Field::Translation,
    Field::Size,
    Field::Width,
    Field::Height,
    Field::Fisheye,
    Field::CameraFromWorld,
];

/// What OpenCV's stereo calibration has beside its cameras, and what lists their names.
const PASSED: [&str; 7] = ["E", "F", "Q", "P", "names", "unit", "metadata"];

/// The cameras, and the keys that nothing is known of.
pub(super) fn sections(root: &Map) -> Option<(Sections, Vec<String>)> {
    let is_rectified = ["P1", "P2", "Q"].iter().any(|key| get(root, key).is_some());
    let mut sections = Sections::new();
    let mut shared = Map::new();
    let mut unknown = Vec::new();
    let names = listed(root);
    sections.extend(names.iter().map(|name| (name.clone(), Map::new())));
    for (key, value) in root {
        match split(key, value, &names) {
            // Rotations of the rectified views are none of the cameras.
            Some((field, _)) if is_rectified && matches!(field, "R" | "P") => {}
            Some((field, name)) => add(&mut sections, name, field, value),
            None if by_camera(key, value) => {
                for (name, value) in value.as_map().into_iter().flatten() {
                    add(&mut sections, name.clone(), key, value);
                }
            }
            None if FIELDS.contains(&Field::of(key)) => shared.push((key.clone(), value.clone())),
            None if !PASSED.contains(&key.trim_end_matches(|c: char| c.is_ascii_digit()))
                && Field::of(key) == Field::Unknown =>
            {
                unknown.push(key.clone());
            }
            None => {}
        }
    }
    let is_camera =
        |(_, map): &(String, Map)| map.iter().any(|(k, _)| Field::of(k) == Field::Matrix);
    if !sections.iter().any(is_camera) {
        return None;
    }
    share(&mut sections, &shared);
    Some((sections, unknown))
}

/// The names that a file lists, in their order.
fn listed(root: &Map) -> Vec<String> {
    match get(root, "names") {
        Some(Value::List(names)) if names.len() <= MOST_CAMERAS => {
            names.iter().filter_map(Value::as_text).collect()
        }
        _ => Vec::new(),
    }
}

fn add(sections: &mut Sections, name: String, field: &str, value: &Value) {
    let entry = (field.to_owned(), value.clone());
    match sections.iter_mut().find(|(known, _)| *known == name) {
        Some((_, map)) => map.push(entry),
        None => sections.push((name, vec![entry])),
    }
}

/// Whether a field has its values by the cameras' names.
fn by_camera(key: &str, value: &Value) -> bool {
    FIELDS.contains(&Field::of(key))
        && !value.is_matrix()
        && value.as_map().is_some_and(|map| map.iter().all(|(_, v)| v.numbers().is_some()))
}

/// The field and the camera of a key.
fn split<'a>(key: &'a str, value: &Value, names: &[String]) -> Option<(&'a str, String)> {
    let count = value.numbers()?.len();
    let of = |name: &String| {
        let field = key.strip_suffix(name.as_str())?.strip_suffix('_')?;
        FIELDS.contains(&Field::of(field)).then(|| (field, name.clone()))
    };
    if let Some(found) = names.iter().find_map(of) {
        return Some(found);
    }
    // `k1` is a coefficient where it is one number, and a matrix of camera 1 where it is nine.
    if count == 1 && Field::of(key) != Field::Unknown {
        return None;
    }
    let is_field = |word: &str| FIELDS.contains(&Field::of(word));
    let is_separator = |c: char| matches!(c, '_' | '-' | ' ');
    let mut ends: Vec<usize> = key.char_indices().map(|(at, _)| at).skip(1).collect();
    ends.reverse();
    for &at in &ends {
        let (field, rest) = key.split_at(at);
        if rest.starts_with(is_separator) && is_field(field) {
            return Some((field, rest.trim_start_matches(is_separator).to_owned()));
        }
        let is_number = rest.chars().all(|c| c.is_ascii_digit());
        if is_number && field.ends_with(|c: char| c.is_ascii_alphabetic()) && is_field(field) {
            return Some((field, format!("cam{rest}")));
        }
    }
    ends.iter().rev().find_map(|&at| {
        let (name, field) = key.split_at(at);
        let field = field.strip_prefix(is_separator)?;
        is_field(field).then(|| (field, name.to_owned()))
    })
}

/// Gives the cameras what stands once for all: a picture size, and the second camera's pose from the
/// first.
fn share(sections: &mut Sections, shared: &Map) {
    let has = |map: &Map, field| map.iter().any(|(key, _)| Field::of(key) == field);
    let posed = |map: &Map| has(map, Field::Rotation) && has(map, Field::Translation);
    let is_pose = |entry: &&(String, Value)| {
        matches!(Field::of(&entry.0), Field::Rotation | Field::Translation)
    };
    if let [(_, first), (_, second)] = &mut sections[..]
        && !posed(first)
        && !posed(second)
        && posed(shared)
    {
        // No turn, as a rotation vector, and no way.
        let zeros = || Value::List(vec![Value::Number(0.0); 3]);
        first.extend([("R".to_owned(), zeros()), ("T".to_owned(), zeros())]);
        second.extend(shared.iter().filter(is_pose).cloned());
    }
    for (_, map) in sections {
        if !has(map, Field::Size) && !has(map, Field::Width) {
            map.extend(shared.iter().filter(|entry| !is_pose(entry)).cloned());
        }
    }
}
