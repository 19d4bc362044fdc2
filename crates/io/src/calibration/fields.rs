//! What the fields of a camera hold.

use glam::{DMat3, DVec3};

use crate::calibration::field::Field;
use crate::calibration::lens_model::{LensModel, is_fisheye};
use crate::calibration::record::{CameraMatrix, Pose, Record};
use crate::calibration::rotation;
use crate::calibration::value::{Map, Value};
use crate::error::{Error, Result};

/// A camera's fields.
pub(super) struct Fields<'a> {
    name: &'a str,
    /// Without what is null.
    entries: Vec<(Field, &'a str, &'a Value)>,
}

/// Whether named values may be those of a camera: they have a camera matrix, focal lengths or a pose.
pub(super) fn is_camera(map: &Map) -> bool {
    let mut entries = Vec::new();
    append(map, 0, &mut entries);
    let is_matrix = |value: &Value| value.numbers().is_some_and(|numbers| numbers.len() >= 3);
    let has = |wanted| entries.iter().any(|(field, ..)| *field == wanted);
    let is_posed = has(Field::Rotation) && has(Field::Translation);
    let is_seen = |(field, key, value): &(Field, &str, &Value)| match field {
        Field::Matrix => is_matrix(value),
        Field::MatrixElement => *key == "fx",
        _ => false,
    };
    is_posed || entries.iter().any(is_seen)
}

/// What `fisheye` says by having fields of its own.
static YES: Value = Value::Bool(true);

/// The entries of a map and of the maps in it, but for OpenCV's matrices.
fn append<'a>(map: &'a Map, depth: usize, entries: &mut Vec<(Field, &'a str, &'a Value)>) {
    for (key, value) in map {
        match value {
            Value::Null => {}
            Value::Map(inner) if !value.is_matrix() => {
                if Field::of(key) == Field::Fisheye {
                    entries.push((Field::Fisheye, key, &YES));
                }
                if depth < 3 && inner.len() < 100 {
                    append(inner, depth + 1, entries);
                }
            }
            _ => entries.push((Field::of(key), key, value)),
        }
    }
}

impl<'a> Fields<'a> {
    pub(super) fn of(name: &'a str, map: &'a Map) -> Self {
        let mut entries = Vec::new();
        append(map, 0, &mut entries);
        Self { name, entries }
    }

    /// The name that the camera gives itself.
    pub(super) fn own_name(&self) -> Option<String> {
        let (_, key, value) = self.entries.iter().find(|(field, ..)| *field == Field::Name)?;
        let text = value.as_text()?;
        // Caliscope numbers its cameras, and calls their videos cam_0.mp4.
        let is_number = matches!(*key, "cam_id" | "port") && text.parse::<u32>().is_ok();
        Some(if is_number { format!("cam_{text}") } else { text })
    }

    /// Whether the file says to pass the camera over.
    pub(super) fn is_ignored(&self) -> bool {
        self.find(Field::Ignore).is_some_and(|(_, value)| value.as_bool() == Some(true))
    }

    /// The keys that nothing is known of.
    pub(super) fn unknown(&self) -> impl Iterator<Item = &'a str> {
        let unknown = |entry: &&(Field, &'a str, &'a Value)| entry.0 == Field::Unknown;
        self.entries.iter().filter(unknown).map(|(_, key, _)| *key)
    }

    fn find(&self, wanted: Field) -> Option<(&'a str, &'a Value)> {
        let found = self.entries.iter().find(|(field, ..)| *field == wanted);
        found.map(|(_, key, value)| (*key, *value))
    }

    fn wrong(&self, field: &str, what: impl AsRef<str>) -> Error {
        Error::field(self.name, field, what)
    }

    fn numbers(&self, field: Field) -> Result<Option<(&'a str, Vec<f64>)>> {
        let Some((key, value)) = self.find(field) else { return Ok(None) };
        match value.numbers() {
            Some(numbers) => Ok(Some((key, numbers))),
            None => Err(self.wrong(key, "holds something that is no number")),
        }
    }

    /// A number by its own key.
    fn element(&self, wanted: &str) -> Option<f64> {
        let of = |(_, key, value): &(Field, &str, &Value)| {
            key.eq_ignore_ascii_case(wanted).then(|| value.numbers()).flatten()
        };
        match self.entries.iter().find_map(of)?[..] {
            [number] => Some(number),
            _ => None,
        }
    }

    /// What a file says of the camera.
    pub(super) fn record(&self) -> Result<Record> {
        let (lens, coefficients) = self.lens()?;
        let mut record = Record::new(self.name.to_owned(), self.matrix()?, self.pose()?);
        if self.find(Field::WorldFromCamera).is_some() {
            record.notes.push("its pose in the world was inverted".to_owned());
        }
        (record.lens, record.coefficients) = (lens, coefficients);
        record.size = self.size()?;
        let turns = self.numbers(Field::Turns)?.is_some_and(|(_, turns)| turns != [0.0]);
        if turns {
            let note =
                "its calibration is of the turned picture (rotation_count): turn its pictures";
            record.notes.push(note.to_owned());
        }
        Ok(record)
    }

    fn size(&self) -> Result<Option<[f64; 2]>> {
        if let Some((key, numbers)) = self.numbers(Field::Size)? {
            return match numbers[..] {
                [width, height] | [width, height, _] => Ok(Some([width, height])),
                _ => Err(self.wrong(key, "is not a width and a height")),
            };
        }
        let side = |field| -> Result<Option<f64>> {
            match self.numbers(field)? {
                None => Ok(None),
                Some((key, numbers)) => match numbers[..] {
                    [side] => Ok(Some(side)),
                    _ => Err(self.wrong(key, "is not one number")),
                },
            }
        };
        Ok(side(Field::Width)?.zip(side(Field::Height)?).map(<[f64; 2]>::from))
    }

    fn matrix(&self) -> Result<CameraMatrix> {
        let Some((key, numbers)) = self.numbers(Field::Matrix)? else {
            let elements = ["fx", "fy", "cx", "cy"].map(|key| self.element(key));
            return match elements {
                [Some(fx), Some(fy), Some(cx), Some(cy)] => Ok(CameraMatrix { fx, fy, cx, cy }),
                _ => {
                    Err(self.wrong("camera_matrix", "is missing, also as K, matrix or fx fy cx cy"))
                }
            };
        };
        match numbers[..] {
            [fx, fy, cx, cy] => Ok(CameraMatrix { fx, fy, cx, cy }),
            [fx, skew, cx, zero, fy, cy, a, b, one] => {
                // What is left of a fit that was told that there is none.
                let none = 1e-9 * fx.abs();
                let is_zero = |number: f64| number.abs() <= none;
                if is_zero(skew) && is_zero(zero) && is_zero(a) && is_zero(b) && one == 1.0 {
                    return Ok(CameraMatrix { fx, fy, cx, cy });
                }
                let what = if is_zero(cx) && is_zero(cy) && a > 1.0 && b > 1.0 {
                    "is transposed, as MATLAB writes it: transpose it, and take 1 from the principal point"
                } else {
                    "is not [fx 0 cx; 0 fy cy; 0 0 1]: calibrate without skew"
                };
                Err(self.wrong(key, what))
            }
            _ => Err(self.wrong(key, format!("holds {} numbers, not 9", numbers.len()))),
        }
    }

    fn lens(&self) -> Result<(LensModel, Vec<f64>)> {
        let mut model = None;
        for (field, key, value) in &self.entries {
            let named = match (field, value) {
                (Field::Model, _) => {
                    let name = value.as_text().ok_or_else(|| self.wrong(key, "is no name"))?;
                    LensModel::named(self.name, key, &name)?
                }
                // Whatever the key is called.
                (Field::Unknown | Field::Passed, Value::Text(text)) if is_fisheye(text) => {
                    LensModel::Fisheye
                }
                _ => continue,
            };
            // Kalibr's camera model is a pinhole whatever its distortion model is.
            if named == LensModel::Fisheye || model.is_none() {
                model = Some(named);
            }
        }
        if let Some((key, value)) = self.find(Field::Fisheye) {
            match value.as_bool() {
                Some(true) => model = Some(LensModel::Fisheye),
                Some(false) => {}
                None => return Err(self.wrong(key, "is neither true nor false")),
            }
        }
        let coefficients = match self.numbers(Field::Distortion)? {
            Some((_, numbers)) => numbers,
            None => self.single_coefficients(),
        };
        Ok((model.unwrap_or(LensModel::Perspective), coefficients))
    }

    /// Coefficients that stand apart, in OpenCV's order.
    fn single_coefficients(&self) -> Vec<f64> {
        let order = ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"];
        let all = order.map(|key| self.element(key));
        match all.iter().rposition(Option::is_some) {
            None => Vec::new(),
            Some(last) => {
                let count = [4, 5, 8].into_iter().find(|&count| count > last).unwrap_or(8);
                all[..count].iter().map(|k| k.unwrap_or(0.0)).collect()
            }
        }
    }

    fn pose(&self) -> Result<Pose> {
        if let Some((key, numbers)) = self.numbers(Field::WorldFromCamera)? {
            let pose = self.pose_matrix(key, &numbers)?;
            return Ok(Pose::of_camera(pose.rotation, pose.translation));
        }
        if let Some((key, numbers)) = self.numbers(Field::CameraFromWorld)? {
            return self.pose_matrix(key, &numbers);
        }
        self.refuse_ambiguous_pose()?;
        let missing = |field| {
            self.wrong(
                field,
                "is missing: the file does not say where the camera stands; calibrate the \
                 cameras together, or give the file with the extrinsics, too",
            )
        };
        let (key, turn) = self.numbers(Field::Rotation)?.ok_or_else(|| missing("rotation"))?;
        let rotation = rotation::of_numbers(self.name, key, &turn)?;
        let (key, shift) =
            self.numbers(Field::Translation)?.ok_or_else(|| missing("translation"))?;
        let [x, y, z] = shift[..] else {
            return Err(self.wrong(key, format!("holds {} numbers, not 3", shift.len())));
        };
        Ok(Pose { rotation, translation: DVec3::new(x, y, z) })
    }

    /// A matrix [R t], with or without its last row.
    fn pose_matrix(&self, key: &str, numbers: &[f64]) -> Result<Pose> {
        let (rows, rest) = numbers.as_chunks::<4>();
        let is_last = |row: &[f64; 4]| *row == [0.0, 0.0, 0.0, 1.0];
        match rows {
            [a, b, c] | [a, b, c, _] if rest.is_empty() && rows[3..].iter().all(is_last) => {
                let column = |i: usize| DVec3::new(a[i], b[i], c[i]);
                let rotation = DMat3::from_cols(column(0), column(1), column(2));
                Ok(Pose { rotation, translation: column(3) })
            }
            _ => Err(self.wrong(key, "is no matrix of 3×4 or 4×4 numbers, [R t; 0 0 0 1]")),
        }
    }

    fn refuse_ambiguous_pose(&self) -> Result<()> {
        let has = |field| self.find(field).is_some();
        let whole = has(Field::Rotation) && has(Field::Translation);
        let says_it = |(_, _, value): &&(Field, &str, &Value)| matches!(value, Value::Text(text) if Field::of(text) == Field::WorldFromCamera);
        let unclear = self.entries.iter().find(says_it).or_else(|| {
            let ambiguous = |e: &&(Field, &str, &Value)| e.0 == Field::AmbiguousPose;
            self.entries.iter().filter(|_| !whole).find(ambiguous)
        });
        match unclear {
            None => Ok(()),
            Some((_, key, _)) => Err(self.wrong(
                key,
                "is a pose in the world, or does not say which way it goes: give rotation and translation \
                 from the world to the camera, x_cam = R x_world + t, or a matrix `camera_to_world`",
            )),
        }
    }
}
