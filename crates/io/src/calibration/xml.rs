//! XML: OpenCV's storage, Qualisys's and Vicon's calibrations.

use glam::{DMat3, DQuat, DVec3};
use roxmltree::{Document, Node, ParsingOptions};

use crate::calibration::record::{CameraMatrix, Pose, Record};
use crate::calibration::value::{Map, Value, wrong_names};
use crate::error::{Error, Result};

/// The most elements and texts that a file may hold.
const MOST_NODES: u32 = 100_000;

/// How deep elements may be nested.
const DEEPEST: usize = 64;

/// What a calibration in XML holds.
pub(super) enum Content {
    /// OpenCV's storage.
    Storage(Map),
    /// The cameras of Qualisys or Vicon, in millimetres.
    Records(Vec<Record>),
}

/// Reads a text.
pub(super) fn parse(text: &str) -> Result<Content> {
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options)
        .map_err(|e| Error::calibration(e.to_string()))?;
    let root = document.root_element();
    if let Some(cameras) = child(root, "cameras").filter(|_| root.tag_name().name() != STORAGE) {
        let cameras = children(cameras).filter(|camera| camera.has_tag_name("camera"));
        return cameras.filter(is_video).map(qualisys).collect::<Result<_>>().map(Content::Records);
    }
    match root.tag_name().name() {
        STORAGE => match value(root, 0)? {
            Value::Map(map) => Ok(Content::Storage(map)),
            _ => Err(Error::calibration("opencv_storage holds nothing by name")),
        },
        "Cameras" => {
            let cameras = children(root).filter(|camera| camera.has_tag_name("Camera"));
            cameras.filter(is_video).map(vicon).collect::<Result<_>>().map(Content::Records)
        }
        other => Err(Error::calibration(format!(
            "<{other}> is not recognised: OpenCV's <opencv_storage>, Qualisys's and Vicon's <Cameras> \
             are read"
        ))),
    }
}

const STORAGE: &str = "opencv_storage";

fn children<'a, 'i>(node: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(Node::is_element)
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    children(node).find(|child| child.has_tag_name(name))
}

/// An element of OpenCV's storage.
fn value(node: Node<'_, '_>, depth: usize) -> Result<Value> {
    if depth == DEEPEST {
        return Err(Error::calibration(format!("more than {DEEPEST} elements in each other")));
    }
    if children(node).next().is_none() {
        let text = node.text().unwrap_or_default().trim().trim_matches('"');
        return Ok(if text.is_empty() { Value::Null } else { Value::Text(text.to_owned()) });
    }
    // OpenCV calls the items of a list `_`.
    if children(node).all(|child| child.has_tag_name("_")) {
        let items = children(node).map(|child| value(child, depth + 1));
        return items.collect::<Result<_>>().map(Value::List);
    }
    let entry = |child: Node<'_, '_>| {
        // And a name that XML does not allow `_01`.
        let name = child.tag_name().name();
        let name = match name.strip_prefix('_') {
            Some(rest) if rest.starts_with(|c: char| c.is_ascii_digit()) => rest,
            _ => name,
        };
        Ok((name.to_owned(), value(child, depth + 1)?))
    };
    let map: Map = children(node).map(entry).collect::<Result<_>>()?;
    match wrong_names(&map) {
        Some(what) => Err(Error::calibration(what)),
        None => Ok(Value::Map(map)),
    }
}

/// Whether a camera of a system for markers films, too. Qualisys says it by the model, Vicon by the
/// type.
fn is_video(camera: &Node<'_, '_>) -> bool {
    let of = |name: &str| camera.attribute(name).map(str::to_ascii_lowercase);
    match (of("model"), of("TYPE"), of("SYSTEM")) {
        (None, None, None) => true,
        (Some(model), ..) => ["video", "hybrid", "none"].iter().any(|kind| model.contains(kind)),
        (None, kind, system) => {
            kind.is_some_and(|kind| kind.contains("video")) || system.is_some_and(|s| s == "dv")
        }
    }
}

/// The numbers of an attribute.
fn numbers(camera: &str, node: Node<'_, '_>, attribute: &str) -> Result<Vec<f64>> {
    let wrong = |what: &str| Error::field(camera, attribute, what);
    let text = node.attribute(attribute).ok_or_else(|| wrong("is missing"))?;
    let numbers =
        text.split_whitespace().map(|word| word.parse().ok().filter(|n: &f64| n.is_finite()));
    numbers.collect::<Option<_>>().ok_or_else(|| wrong("holds something that is no number"))
}

fn number(camera: &str, node: Node<'_, '_>, attribute: &str) -> Result<f64> {
    array(camera, node, attribute).map(|[number]| number)
}

fn array<const N: usize>(camera: &str, node: Node<'_, '_>, attribute: &str) -> Result<[f64; N]> {
    let found = numbers(camera, node, attribute)?;
    let count = found.len();
    found
        .try_into()
        .map_err(|_| Error::field(camera, attribute, format!("holds {count} numbers, not {N}")))
}

fn part<'a, 'i>(camera: &str, node: Node<'a, 'i>, name: &str) -> Result<Node<'a, 'i>> {
    child(node, name).ok_or_else(|| Error::field(camera, name, "is missing"))
}

/// A camera of a `.qca.txt`: intrinsics in 64ths of a pixel of the whole sensor, the camera's pose in
/// the world with its rotation column by column, and the camera turned by half about its x axis.
fn qualisys(camera: Node<'_, '_>) -> Result<Record> {
    let name = camera.attribute("serial").unwrap_or("?");
    let fov = part(name, camera, "fov_video")?;
    let side = |attribute| number(name, fov, attribute);
    let (left, top, right, bottom) = (side("left")?, side("top")?, side("right")?, side("bottom")?);
    let intrinsic = part(name, camera, "intrinsic")?;
    let of_64 = |attribute| number(name, intrinsic, attribute).map(|number| number / 64.0);
    let transform = part(name, camera, "transform")?;
    let along = |attribute: &str| number(name, transform, attribute);
    let column = |k: &str| -> Result<DVec3> {
        let row = |i: u32| along(&format!("r{i}{k}"));
        Ok(DVec3::new(row(1)?, row(2)?, row(3)?))
    };
    // What is listed first, r11 r12 r13, is the first column; rows of the inverse.
    let world_from_camera = DMat3::from_cols(column("1")?, column("2")?, column("3")?).transpose();
    let position = DVec3::new(along("x")?, along("y")?, along("z")?);
    let half_turn = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
    let inverse = Pose::of_camera(world_from_camera, position);
    Ok(Record {
        size: Some([right - left + 1.0, bottom - top + 1.0]),
        coefficients: vec![
            of_64("radialDistortion1")?,
            of_64("radialDistortion2")?,
            of_64("tangentalDistortion1")?,
            of_64("tangentalDistortion2")?,
        ],
        ..Record::new(
            name.to_owned(),
            CameraMatrix {
                fx: of_64("focalLengthU")?,
                fy: of_64("focalLengthV")?,
                cx: of_64("centerPointU")? - left,
                cy: of_64("centerPointV")? - top,
            },
            Pose {
                rotation: half_turn * inverse.rotation,
                translation: half_turn * inverse.translation,
            },
        )
    })
}

/// A camera of an `.xcp`, with the camera's pose in the world.
fn vicon(camera: Node<'_, '_>) -> Result<Record> {
    let name = camera.attribute("DEVICEID").unwrap_or("?");
    let frame = part(name, part(name, camera, "KeyFrames")?, "KeyFrame")?;
    let aspect = number(name, camera, "PIXEL_ASPECT_RATIO")?;
    let fx = number(name, frame, "FOCAL_LENGTH")?;
    let [cx, cy] = array(name, frame, "PRINCIPAL_POINT")?;
    let [x, y, z, w] = array(name, frame, "ORIENTATION")?;
    let turn = DQuat::from_xyzw(x, y, z, w);
    if (turn.length() - 1.0).abs() > 1e-2 {
        return Err(Error::field(name, "ORIENTATION", "is no unit quaternion"));
    }
    let world_from_camera = DMat3::from_quat(turn.normalize());
    let radial = match frame.attribute("VICON_RADIAL2") {
        Some(words) => words.split_whitespace().skip(3).take(2).map(str::parse).collect(),
        None => match frame.attribute("VICON_RADIAL") {
            Some(words) => words.split_whitespace().take(2).map(str::parse).collect(),
            None => Ok(vec![0.0; 2]),
        },
    };
    let radial: Vec<f64> = radial.unwrap_or_default();
    let [k1, k2] = radial[..] else {
        return Err(Error::field(name, "VICON_RADIAL", "does not hold two numbers"));
    };
    let size = match camera.attribute("SENSOR_SIZE") {
        Some(_) => Some(array(name, camera, "SENSOR_SIZE")?),
        None => None,
    };
    Ok(Record {
        size,
        coefficients: vec![k1, k2, 0.0, 0.0],
        notes: vec!["Vicon's radial distortion is taken for OpenCV's k1 and k2".to_owned()],
        ..Record::new(
            name.to_owned(),
            CameraMatrix { fx, fy: fx / aspect, cx, cy },
            Pose::of_camera(world_from_camera, DVec3::from_array(array(name, frame, "POSITION")?)),
        )
    })
}
