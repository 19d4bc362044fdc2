//! Where a file of named values has its cameras.

use crate::calibration::document::Document;
use crate::calibration::field::Field;
use crate::calibration::fields::{Fields, is_camera};
use crate::calibration::unit::Unit;
use crate::calibration::value::{Map, Sections, Value, get, repeated_name};
use crate::calibration::{chain, flat};
use crate::error::{Error, Result};

/// Keys under which cameras, or parts of them, stand by name or in a list.
const CONTAINERS: [&str; 12] = [
    "cameras",
    "camera",
    "cams",
    "calibration",
    "calibrations",
    "intrinsics",
    "intrinsic",
    "extrinsics",
    "extrinsic",
    "camera_poses",
    "poses",
    "calib",
];

/// Keys beside cameras that are of no matter for them.
const PASSED: [&str; 3] = ["metadata", "names", "rms"];

/// The most keys that a note lists.
const MOST_LISTED: usize = 12;

/// What a file says, by where it has its cameras.
pub(super) fn document(root: &Map) -> Result<Document> {
    let unit = proved_unit(root)?;
    if chain::is_chain(root) {
        let records = chain::records(root)?;
        let hint = Some(" (Kalibr writes metres)");
        return Ok(Document { records, unit, hint, ..Document::default() });
    }
    let (sections, mut unknown) = sections(root)?;
    let mut document = Document { unit, hint: hint(root), ..Document::default() };
    for (name, section) in &sections {
        let fields = Fields::of(name, section);
        if fields.is_ignored() {
            document.notes.push(format!("camera `{name}` is left out: the file says to ignore it"));
            continue;
        }
        document.records.push(fields.record()?);
        for key in fields.unknown() {
            if !unknown.iter().any(|known| known == key) {
                unknown.push(key.to_owned());
            }
        }
    }
    if !unknown.is_empty() {
        let more = if unknown.len() > MOST_LISTED { ", …" } else { "" };
        unknown.truncate(MOST_LISTED);
        document.notes.push(format!("not known and passed over: {}{more}", unknown.join(", ")));
    }
    Ok(document)
}

/// The cameras with what each has, and the keys beside them that nothing is known of.
fn sections(root: &Map) -> Result<(Sections, Vec<String>)> {
    let contained = contained(root);
    if contained.iter().any(|(_, map)| is_camera(map)) {
        let unknown = beside(root, |key, _| CONTAINERS.contains(&key));
        return Ok((named(contained), unknown));
    }
    let of_camera = |value: &Value| value.as_map().is_some_and(is_camera) && !value.is_matrix();
    let own: Sections = root
        .iter()
        .filter(|(_, value)| of_camera(value))
        .filter_map(|(key, value)| Some((key.clone(), value.as_map()?.clone())))
        .collect();
    if !own.is_empty() {
        let unknown = beside(root, |_, value| of_camera(value));
        return Ok((named(own), unknown));
    }
    if let Some(found) = flat::sections(root) {
        return Ok(found);
    }
    let keys: Vec<&str> = root.iter().map(|(key, _)| key.as_str()).take(MOST_LISTED).collect();
    Err(Error::calibration(format!(
        "no camera is recognised in it; it has {}",
        if keys.is_empty() { "nothing".to_owned() } else { keys.join(", ") }
    )))
}

/// Cameras by the names that they give themselves.
fn named(sections: Sections) -> Sections {
    let own = |(key, map): (String, Map)| (Fields::of(&key, &map).own_name().unwrap_or(key), map);
    sections.into_iter().map(own).collect()
}

/// The same with cameras that stand in a list by the names that they give themselves, or numbered.
pub(super) fn lists_by_name(root: Map) -> Result<Map> {
    let by_name = |(key, value): (String, Value)| match value {
        Value::List(list)
            if CONTAINERS.contains(&key.as_str())
                && list.iter().all(|item| item.as_map().is_some_and(is_camera)) =>
        {
            let mut cameras = Map::new();
            for (index, item) in list.into_iter().enumerate() {
                let Value::Map(map) = item else { continue };
                let own = Fields::of("", &map).own_name();
                cameras.push((own.unwrap_or_else(|| format!("cam{index}")), Value::Map(map)));
            }
            match repeated_name(&cameras) {
                Some(name) => {
                    Err(phalanx_camera::Error::DuplicateName { camera: name.to_owned() }.into())
                }
                None => Ok((key, Value::Map(cameras))),
            }
        }
        value => Ok((key, value)),
    };
    root.into_iter().map(by_name).collect()
}

/// What stands under the usual keys, put together by name.
fn contained(root: &Map) -> Sections {
    let mut found = Sections::new();
    let mut add = |name: &str, map: &Map| match found.iter_mut().find(|(known, _)| known == name) {
        Some((_, known)) => known.extend(map.iter().cloned()),
        None => found.push((name.to_owned(), map.clone())),
    };
    for key in CONTAINERS {
        for (name, value) in get(root, key).and_then(Value::as_map).into_iter().flatten() {
            // multical: from the first camera's frame to that of another.
            let name = name.split_once("_to_").map_or(name.as_str(), |(name, _)| name);
            if let (Value::Map(map), false) = (value, value.is_matrix()) {
                add(name, map);
            }
        }
    }
    found
}

/// Keys of the file that are neither cameras nor known.
fn beside(root: &Map, is_known: impl Fn(&str, &Value) -> bool) -> Vec<String> {
    let unknown = |(key, value): &&(String, Value)| {
        !is_known(key, value)
            && !PASSED.contains(&key.as_str())
            && Field::of(key) == Field::Unknown
            && !UNITS.contains(&key.as_str())
    };
    root.iter().filter(unknown).map(|(key, _)| key.clone()).collect()
}

const UNITS: [&str; 4] = ["unit", "units", "length_unit", "unit_mm"];

/// The unit that a file states: in words, or as FreeMoCap does by its board.
fn proved_unit(root: &Map) -> Result<Option<Unit>> {
    let metadata = get(root, "metadata").and_then(Value::as_map);
    for map in [Some(root), metadata].into_iter().flatten() {
        for key in UNITS {
            match get(map, key) {
                Some(Value::Text(text)) => return text.parse().map(Some),
                Some(Value::Number(mm)) => return Unit::of_mm(*mm).map(Some),
                _ => {}
            }
        }
    }
    let board = metadata.and_then(|metadata| get(metadata, "board")).and_then(Value::as_map);
    let is_mm = board.is_some_and(|board| get(board, "square_length_mm").is_some());
    Ok(is_mm.then_some(Unit::MILLIMETRE))
}

/// What tools of this layout use.
fn hint(root: &Map) -> Option<&'static str> {
    let has = |value: &Value, keys: &[&str]| {
        value.as_map().is_some_and(|map| keys.iter().any(|key| get(map, key).is_some()))
    };
    let in_cameras = |keys: &[&str]| match get(root, "cameras") {
        Some(Value::Map(map)) => map.iter().any(|(_, value)| has(value, keys)),
        _ => false,
    };
    if in_cameras(&["cam_id", "port"]) {
        Some(" (Caliscope writes metres)")
    } else if in_cameras(&["panel", "node"]) {
        Some(" (the Panoptic Studio's is cm)")
    } else if root.iter().any(|(_, value)| has(value, &["distortions"])) {
        Some(" (Anipose's is its board's, mostly mm; Pose2Sim's is m)")
    } else if get(root, "names").is_some() {
        Some(" (EasyMocap's is mostly m)")
    } else {
        None
    }
}
