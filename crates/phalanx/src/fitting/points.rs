//! A detector's landmarks in a frame, and what they tell of where the hand is.

use glam::{DAffine3, DMat3, DVec3};
use phalanx_camera::{Camera, Ray, triangulate};
use phalanx_hand::{Landmarks, Side};
use phalanx_refine::LandmarkObservation;

use super::weights::PointWeight;
use crate::error::{Error, Result};

/// The knuckles of index to little finger among the joints.
const KNUCKLES: [usize; 4] = [5, 9, 13, 17];

/// The points of one camera.
#[derive(Debug, Clone)]
pub(super) struct CameraPoints {
    camera: Camera,
    points: Landmarks,
}

impl CameraPoints {
    /// Of a frame's landmarks, one for each camera, or none at all.
    ///
    /// # Errors
    /// Another number of them than cameras, or points that are not finite.
    pub(super) fn of(
        cameras: &[Camera],
        landmarks: &[Option<Landmarks>],
    ) -> Result<Vec<Option<Self>>> {
        if landmarks.is_empty() {
            return Ok(vec![None; cameras.len()]);
        }
        if landmarks.len() != cameras.len() {
            let cameras = cameras.iter().map(|camera| camera.name.clone()).collect();
            return Err(Error::LandmarkCount { cameras, found: landmarks.len() });
        }
        let of_camera = |(camera, points): (&Camera, &Option<Landmarks>)| {
            let seen = points.filter(|points| points.iter().any(Option::is_some));
            let Some(points) = seen else { return Ok(None) };
            // Refuses what is not finite.
            LandmarkObservation::new(camera, &points, 1.0)?;
            Ok(Some(Self { camera: camera.clone(), points }))
        };
        cameras.iter().zip(landmarks).map(of_camera).collect()
    }

    /// What they tell of a hand at `frame`; `None` of a hand that is not before the camera.
    pub(super) fn observation(
        &self,
        weight: &PointWeight,
        frame: &DAffine3,
    ) -> Option<LandmarkObservation> {
        let std = weight.std_mm * self.pixels_per_mm(frame)?;
        let seen = LandmarkObservation::new(&self.camera, &self.points, std).ok()?;
        Some(seen.weighted(weight.weight))
    }

    /// How many pixels a millimetre is wide at a hand.
    pub(super) fn pixels_per_mm(&self, frame: &DAffine3) -> Option<f64> {
        let at = self.camera.extrinsics.to_camera(frame.translation);
        let focal = (self.camera.intrinsics.fx * self.camera.intrinsics.fy).sqrt();
        (at.z > 0.0).then(|| focal / at.length())
    }

    fn ray(&self, joint: usize) -> Option<Ray> {
        self.camera.unproject(self.points[joint]?.at)
    }
}

/// Where the points of any two cameras say that the hand is, z along the palm and its back upwards; first
/// what rays agree on best.
pub(super) fn palm_frames(points: &[Option<CameraPoints>], side: Side) -> Vec<DAffine3> {
    let seen: Vec<&CameraPoints> = points.iter().flatten().collect();
    let pairs = (0..seen.len()).flat_map(|k| (k + 1..seen.len()).map(move |other| (k, other)));
    let mut frames: Vec<(f64, DAffine3)> =
        pairs.filter_map(|(one, other)| palm_frame([seen[one], seen[other]], side)).collect();
    frames.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    frames.into_iter().map(|(_, frame)| frame).collect()
}

/// That of two cameras, and how far their rays pass each other at most, mm; `None` where the wrist or two
/// knuckles are not seen by both.
fn palm_frame(seen: [&CameraPoints; 2], side: Side) -> Option<(f64, DAffine3)> {
    let meet = |joint: usize| {
        let rays = [seen[0].ray(joint)?, seen[1].ray(joint)?];
        let met = triangulate(&rays).ok()?;
        Some((met.spread, met.point))
    };
    let (mut spread, wrist) = meet(0)?;
    let mut knuckles: Vec<DVec3> = Vec::new();
    for (apart, knuckle) in KNUCKLES.into_iter().filter_map(meet) {
        spread = spread.max(apart);
        knuckles.push(knuckle);
    }
    let [first, .., last] = knuckles[..] else { return None };
    let middle = knuckles.iter().sum::<DVec3>() / knuckles.len() as f64;
    let z = (middle - wrist).try_normalize()?;
    let towards_thumb = match side {
        Side::Right => first - last,
        Side::Left => last - first,
    };
    let x = towards_thumb.reject_from_normalized(z).try_normalize()?;
    Some((spread, DAffine3::from_mat3_translation(DMat3::from_cols(x, z.cross(x), z), wrist)))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use phalanx_camera::Intrinsics;
    use phalanx_hand::{HandShape, Landmark, Pose};

    use super::*;

    /// A hand at rest lies as its points say, of either side.
    #[test]
    fn points_of_two_cameras_tell_where_the_palm_is() {
        let camera = |name: &str, at: DVec3| {
            let intrinsics = Intrinsics::pinhole(640, 480, 600.0);
            Camera::look_at(name, intrinsics, at, DVec3::ZERO, DVec3::Y).unwrap()
        };
        let cameras = [
            camera("a", DVec3::new(500.0, 300.0, 100.0)),
            camera("b", DVec3::new(-400.0, 350.0, 90.0)),
        ];
        let turn = DMat3::from_rotation_x(0.4) * DMat3::from_rotation_z(1.1);
        let rest = DAffine3::from_mat3_translation(turn, DVec3::new(20.0, -10.0, -50.0));
        for side in [Side::Right, Side::Left] {
            let joints = HandShape { side, ..HandShape::adult() }.pose(&Pose::REST, &rest).joints;
            let seen = |camera: &Camera| {
                Some(std::array::from_fn(|k| camera.project(joints[k]).map(Landmark::sure)))
            };
            let points =
                CameraPoints::of(&cameras, &[seen(&cameras[0]), seen(&cameras[1])]).unwrap();
            let frames = palm_frames(&points, side);
            assert_eq!(frames.len(), 1);
            assert!(frames[0].translation.distance(rest.translation) < 1e-6);
            for (axis, own) in [
                (rest.matrix3.y_axis, frames[0].matrix3.y_axis),
                (rest.matrix3.z_axis, frames[0].matrix3.z_axis),
            ] {
                assert!(axis.angle_between(own) < 0.2, "{side:?}: {axis} {own}");
            }
            assert!(palm_frames(&points[..1], side).is_empty());
        }
    }
}
