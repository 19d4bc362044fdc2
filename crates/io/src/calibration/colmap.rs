//! COLMAP's text: `cameras.txt` and `images.txt`.

use std::collections::BTreeMap;

use glam::{DMat3, DQuat, DVec3};

use crate::calibration::document::Document;
use crate::calibration::lens_model::LensModel;
use crate::calibration::numbers;
use crate::calibration::record::{CameraMatrix, FIRST_CENTRE, Pose, Record};
use crate::error::{Error, Result};

/// What `cameras.txt` says of each camera's inside, by its number.
pub(super) type Cameras = BTreeMap<String, Inside>;

#[derive(Debug, Clone)]
pub(super) struct Inside {
    size: [f64; 2],
    matrix: CameraMatrix,
    lens: LensModel,
    coefficients: Vec<f64>,
}

/// What `images.txt` says of a picture: where its camera stands.
#[derive(Debug, Clone)]
pub(super) struct Image {
    camera: String,
    name: String,
    pose: Pose,
}

fn said(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter(|line| !line.trim_start().starts_with('#'))
}

/// Reads `cameras.txt`.
pub(super) fn cameras(text: &str) -> Result<Cameras> {
    let lines = said(text).filter(|line| !line.trim().is_empty());
    lines
        .map(|line| {
            let mut words = line.split_whitespace();
            let (Some(id), Some(model)) = (words.next(), words.next()) else {
                return Err(Error::calibration(format!("`{line}` is no camera of COLMAP's")));
            };
            let rest: Vec<&str> = words.collect();
            let numbers = numbers::of_line(&rest.join(" "), "cameras.txt")?;
            Ok((id.to_owned(), inside(id, model, &numbers)?))
        })
        .collect()
}

/// A camera of a model, pixels counted from the corner of the first as ours.
fn inside(id: &str, model: &str, numbers: &[f64]) -> Result<Inside> {
    let wrong = |what: String| Error::field(id, "MODEL", what);
    let [width, height, ref rest @ ..] = *numbers else {
        return Err(wrong("has no width and height".to_owned()));
    };
    let lens = if model.ends_with("FISHEYE") { LensModel::Fisheye } else { LensModel::Perspective };
    let (fx, fy, cx, cy, coefficients) = match (model, rest) {
        ("SIMPLE_PINHOLE", &[f, cx, cy]) => (f, f, cx, cy, vec![]),
        ("PINHOLE", &[fx, fy, cx, cy]) => (fx, fy, cx, cy, vec![]),
        ("SIMPLE_RADIAL" | "SIMPLE_RADIAL_FISHEYE", &[f, cx, cy, k]) => {
            (f, f, cx, cy, vec![k, 0.0, 0.0, 0.0])
        }
        ("RADIAL" | "RADIAL_FISHEYE", &[f, cx, cy, k1, k2]) => {
            (f, f, cx, cy, vec![k1, k2, 0.0, 0.0])
        }
        ("OPENCV" | "OPENCV_FISHEYE", &[fx, fy, cx, cy, a, b, c, d]) => {
            (fx, fy, cx, cy, vec![a, b, c, d])
        }
        ("FULL_OPENCV", &[fx, fy, cx, cy, ref k @ ..]) if k.len() == 8 => {
            (fx, fy, cx, cy, k.to_vec())
        }
        _ => {
            return Err(wrong(format!(
                "`{model}` with {} parameters is not known: use PINHOLE, OPENCV, FULL_OPENCV or \
                 OPENCV_FISHEYE",
                rest.len()
            )));
        }
    };
    let matrix = CameraMatrix { fx, fy, cx: cx - FIRST_CENTRE, cy: cy - FIRST_CENTRE };
    Ok(Inside { size: [width, height], matrix, lens, coefficients })
}

/// Reads `images.txt`: a line of the picture, and a line of its points, which may be empty.
pub(super) fn images(text: &str) -> Result<Vec<Image>> {
    let mut images = Vec::new();
    let mut lines = said(text);
    while let Some(line) = lines.next() {
        if line.trim().is_empty() {
            continue;
        }
        let words: Vec<&str> = line.split_whitespace().collect();
        let [_, ref pose @ .., _, _] = words[..] else {
            return Err(Error::calibration(format!("`{line}` is no picture of COLMAP's")));
        };
        let pose = numbers::of_line(&pose[..pose.len().min(7)].join(" "), "images.txt")?;
        let (&[w, x, y, z, tx, ty, tz], [_, _, _, _, _, _, _, _, camera, name @ ..]) =
            (&pose[..], &words[..])
        else {
            return Err(Error::calibration(format!("`{line}` is no picture of COLMAP's")));
        };
        let name = name.join(" ");
        let turn = DQuat::from_xyzw(x, y, z, w);
        if (turn.length() - 1.0).abs() > 1e-2 {
            return Err(Error::field(&name, "QW QX QY QZ", "is no unit quaternion"));
        }
        let rotation = DMat3::from_quat(turn.normalize());
        let pose = Pose { rotation, translation: DVec3::new(tx, ty, tz) };
        images.push(Image { camera: (*camera).to_owned(), name, pose });
        lines.next();
    }
    Ok(images)
}

/// A camera for each picture, called by its file without the extension.
pub(super) fn document(cameras: &Cameras, images: Vec<Image>) -> Result<Document> {
    let record = |image: Image| {
        let stem = image.name.rsplit_once('.').map_or(image.name.as_str(), |(stem, _)| stem);
        let name = stem.replace(['/', '\\'], "_");
        let Some(inside) = cameras.get(&image.camera) else {
            let what = format!("{} is not in cameras.txt", image.camera);
            return Err(Error::field(&name, "CAMERA_ID", what));
        };
        let Inside { size, matrix, lens, coefficients } = inside.clone();
        let record = Record::new(name, matrix, image.pose);
        Ok(Record { size: Some(size), lens, coefficients, ..record })
    };
    Ok(Document {
        records: images.into_iter().map(record).collect::<Result<_>>()?,
        hint: Some(" (COLMAP's scale is arbitrary: measure the distance between two cameras)"),
        ..Document::default()
    })
}
