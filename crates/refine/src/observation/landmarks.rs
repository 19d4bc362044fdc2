//! The points of a hand that a detector saw.

use glam::{DAffine3, DVec2, DVec3};
use phalanx_camera::Camera;
use phalanx_hand::{HandShape, JOINTS, Landmark, Landmarks, Pose};

use crate::error::{Error, Result};

/// One camera and the points of a hand that a detector saw in its picture.
#[derive(Debug, Clone, PartialEq)]
pub struct LandmarkObservation {
    camera: Camera,
    points: Landmarks,
    std: f64,
    weight: f64,
}

impl LandmarkObservation {
    /// Points in the pixels of the camera's image, each off its place by a standard deviation of `std` px
    /// along each axis. A point of half the confidence counts half.
    ///
    /// # Errors
    /// No point, one that is not finite, a confidence that is not from 0 to 1, or a deviation that is not
    /// positive.
    pub fn new(camera: &Camera, points: &Landmarks, std: f64) -> Result<Self> {
        camera.validate()?;
        if points.iter().all(Option::is_none) {
            return Err(Error::NoLandmark { camera: camera.name.clone() });
        }
        if !(std > 0.0 && std.is_finite()) {
            let name = "standard deviation of landmarks";
            return Err(Error::Parameter { name, value: std, allowed: "positive" });
        }
        for Landmark { at, confidence } in points.iter().flatten() {
            if let Some(value) = at.to_array().into_iter().find(|value| !value.is_finite()) {
                return Err(Error::NotFinite { what: "landmark of camera", name: "px", value });
            }
            if !(0.0..=1.0).contains(confidence) {
                let name = "confidence of a landmark";
                return Err(Error::Parameter { name, value: *confidence, allowed: "from 0 to 1" });
            }
        }
        Ok(Self { camera: camera.clone(), points: *points, std, weight: 1.0 })
    }

    /// The same, where each point counts `weight` times as much as one that errs independently of the
    /// others.
    #[must_use]
    pub fn weighted(self, weight: f64) -> Self {
        Self { weight, ..self }
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The points, px.
    pub fn points(&self) -> &Landmarks {
        &self.points
    }

    /// Standard deviation of a point along each axis, px.
    pub fn std(&self) -> f64 {
        self.std
    }

    /// How much a point counts.
    pub(crate) fn weight(&self) -> f64 {
        self.weight
    }

    /// How far each joint of a posed hand is drawn from its point, px; `None` of points that were not seen
    /// and of joints that are not before the camera.
    pub fn residuals(
        &self,
        hand: &HandShape,
        rest: &DAffine3,
        pose: &Pose,
    ) -> [Option<DVec2>; JOINTS] {
        let joints = hand.pose(pose, rest).joints;
        std::array::from_fn(|k| {
            self.points[k].and_then(|point| Some(self.camera.project(joints[k])? - point.at))
        })
    }
}

/// A joint as a camera sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Projection {
    /// Where, px.
    pub(crate) at: DVec2,
    /// How x and y change with its place in the camera's frame, px/mm.
    pub(crate) slopes: [DVec3; 2],
}

impl Projection {
    /// Of a point of the world; `None` behind the camera or beyond the lens's fold.
    pub(crate) fn of(camera: &Camera, world: DVec3) -> Option<Self> {
        const STEP: f64 = 1e-6;
        let at = camera.extrinsics.to_camera(world);
        if at.z <= 0.0 {
            return None;
        }
        let normalised = at.truncate() / at.z;
        let pixel = |offset: DVec2| camera.intrinsics.to_pixel(normalised + offset);
        let slope = |axis: DVec2| -> Option<DVec2> {
            Some((pixel(axis * STEP)? - pixel(-axis * STEP)?) / (2.0 * STEP))
        };
        let (along_x, along_y) = (slope(DVec2::X)?, slope(DVec2::Y)?);
        let slope = |x: f64, y: f64| DVec3::new(x, y, -x * normalised.x - y * normalised.y) / at.z;
        let slopes = [slope(along_x.x, along_y.x), slope(along_x.y, along_y.y)];
        Some(Self { at: pixel(DVec2::ZERO)?, slopes })
    }
}
