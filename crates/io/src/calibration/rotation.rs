//! Rotations as files have them: matrices, rounded or not, and rotation vectors.

use glam::{DMat3, DVec3};

use crate::error::{Error, Result};

/// How far a matrix may be from a rotation, radians: a quarter of a degree.
const FARTHEST: f64 = 0.25 * std::f64::consts::PI / 180.0;

/// What is said of, radians; six decimals are passed over.
const SAID: f64 = 1e-5;

/// What is taken as it is.
const EXACT: f64 = 1e-9;

/// The rotation of nine numbers, row by row, or of a rotation vector's three.
pub(super) fn of_numbers(camera: &str, field: &str, numbers: &[f64]) -> Result<DMat3> {
    if !numbers.iter().all(|number| number.is_finite()) {
        return Err(Error::field(camera, field, "is not finite"));
    }
    match *numbers {
        [x, y, z] => of_vector(camera, field, DVec3::new(x, y, z)),
        [a, b, c, d, e, f, g, h, i] => {
            Ok(DMat3::from_cols_array(&[a, b, c, d, e, f, g, h, i]).transpose())
        }
        _ => {
            let what =
                format!("holds {} numbers: a matrix has 9 and a rotation vector 3", numbers.len());
            Err(Error::field(camera, field, what))
        }
    }
}

/// Rodrigues's formula: a turn by the vector's length about its direction.
fn of_vector(camera: &str, field: &str, vector: DVec3) -> Result<DMat3> {
    let angle = vector.length();
    if angle > 4.0 * std::f64::consts::PI {
        let what = format!(
            "is a rotation vector of {angle:.1} radians: are these degrees, or Euler angles? They are \
             not read"
        );
        return Err(Error::field(camera, field, what));
    }
    Ok(vector.try_normalize().map_or(DMat3::IDENTITY, |axis| DMat3::from_axis_angle(axis, angle)))
}

/// A matrix with no larger determinant is far from every rotation, and Newton's iteration divides by it.
const SINGULAR: f64 = 1e-3;

/// The nearest rotation to a matrix, and a note where they differ visibly.
///
/// The polar factor, by Newton's iteration (N. Higham, 1986).
pub(super) fn nearest(camera: &str, matrix: DMat3) -> Result<(DMat3, Option<String>)> {
    if !matrix.is_finite() {
        return Err(Error::field(camera, "rotation", "is not finite"));
    }
    let determinant = matrix.determinant();
    if determinant < 0.0 && off(&matrix, &-polar(-matrix)) <= FARTHEST {
        let camera = camera.to_owned();
        return Err(phalanx_camera::Error::Reflection { camera }.into());
    }
    if determinant <= SINGULAR {
        let what = format!("is no rotation: its determinant is {determinant:.3}, not 1");
        return Err(Error::field(camera, "rotation", what));
    }
    let rotation = polar(matrix);
    let off = off(&matrix, &rotation);
    let degrees = off.to_degrees();
    if off.is_nan() || off > FARTHEST {
        let what = format!(
            "is no rotation, by {degrees:.2}°: is it another matrix, or written with too few digits?"
        );
        return Err(Error::field(camera, "rotation", what));
    }
    let said = (off > SAID).then(|| {
        format!("camera `{camera}`: its rotation is rounded; the nearest is {degrees:.3}° away")
    });
    Ok((if off > EXACT { rotation } else { matrix }, said))
}

/// The rotation of a matrix's polar decomposition.
fn polar(matrix: DMat3) -> DMat3 {
    (0..50).fold(matrix, |turn, _| (turn + turn.inverse().transpose()) * 0.5)
}

/// The largest distance between two matrices' columns: for rotations about an angle.
fn off(a: &DMat3, b: &DMat3) -> f64 {
    let columns = [a.x_axis - b.x_axis, a.y_axis - b.y_axis, a.z_axis - b.z_axis];
    columns.iter().map(|column| column.length()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::{nearest, of_numbers};
    use glam::{DMat3, DQuat, DVec3, EulerRot};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::property::cases(256))]

        #[test]
        fn rounding_is_undone(a in -3.1..3.1, b in -1.5..1.5, c in -3.1..3.1, digits in 3..8) {
            let exact = DMat3::from_quat(DQuat::from_euler(EulerRot::XYZ, a, b, c));
            let scale = 10f64.powi(digits);
            let rounded = exact.to_cols_array().map(|e| (e * scale).round() / scale);
            let (found, note) = nearest("c", DMat3::from_cols_array(&rounded)).unwrap();
            prop_assert!((found.transpose() * found - DMat3::IDENTITY).to_cols_array().iter()
                .all(|e| e.abs() < 1e-8));
            prop_assert!((found - exact).to_cols_array().iter().all(|e| e.abs() <= 1.5 / scale));
            prop_assert!(note.is_some() || digits > 3);
        }

        #[test]
        fn a_vector_is_its_turn(x in -2.0..2.0, y in -2.0..2.0, z in -1.0..1.0) {
            let vector = DVec3::new(x, y, z);
            let turn = of_numbers("c", "rotation", &vector.to_array()).unwrap();
            // The axis stays, and a vector across it is turned by the length.
            prop_assert!((turn * vector - vector).length() < 1e-12);
            let across = vector.any_orthogonal_vector().normalize_or(DVec3::X);
            prop_assert!((across.dot(turn * across) - vector.length().cos()).abs() < 1e-9);
        }
    }

    #[test]
    fn what_is_far_from_a_rotation_is_refused() {
        for matrix in [
            DMat3::ZERO,
            DMat3::IDENTITY * 1.01,
            DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0)),
            DMat3::from_cols(DVec3::X, DVec3::X, DVec3::Z),
            DMat3::from_cols(DVec3::NAN, DVec3::Y, DVec3::Z),
        ] {
            assert!(nearest("c", matrix).is_err(), "{matrix}");
        }
        assert!(of_numbers("c", "rotation", &[90.0, 0.0, 45.0]).is_err());
        assert!(of_numbers("c", "rotation", &[1.0; 4]).is_err());
    }
}
