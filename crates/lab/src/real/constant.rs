//! The best constants: what is right on average without looking at any picture.

use std::collections::BTreeMap;
use std::ops::{Add, Div, Sub};

use super::angles::{BoneAngles, COUNT};
use super::frame::FrameName;
use super::reference::Points;
use phalanx_hand::JOINTS;

/// The mean hand about its wrist: each joint where it is on average, seen from the wrist.
#[derive(Debug, Clone)]
pub struct ConstantPoints<V>(Points<V>);

impl<V> ConstantPoints<V>
where
    V: Copy + Sub<Output = V> + Add<Output = V> + Div<f64, Output = V>,
{
    /// Of all frames in which the wrist is known.
    pub fn of(frames: &BTreeMap<FrameName, Points<V>>) -> Self {
        Self(std::array::from_fn(|joint| {
            let offsets = || frames.values().filter_map(|points| Some(points[joint]? - points[0]?));
            Some(offsets().reduce(V::add)? / offsets().count() as f64)
        }))
    }

    /// By how much each joint of a frame is missed by the constant at the frame's own wrist, in the unit
    /// of the points.
    pub fn errors(&self, points: &Points<V>, length: impl Fn(V) -> f64) -> [Option<f64>; JOINTS] {
        std::array::from_fn(|joint| Some(length(points[joint]? - points[0]? - self.0[joint]?)))
    }
}

/// The median of each angle, degrees.
#[derive(Debug, Clone)]
pub struct ConstantAngles(BoneAngles<Option<f64>>);

impl ConstantAngles {
    /// Of all frames.
    pub fn of(frames: &BTreeMap<FrameName, BoneAngles<Option<f64>>>) -> Self {
        Self(std::array::from_fn(|k| {
            let mut values: Vec<f64> = frames.values().filter_map(|angles| angles[k]).collect();
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 2).copied()
        }))
    }

    /// By how much the angles of a frame are missed, degrees.
    pub fn errors(&self, angles: &BoneAngles<Option<f64>>) -> [Option<f64>; COUNT] {
        std::array::from_fn(|k| Some((angles[k]? - self.0[k]?).abs()))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn a_constant_hand_is_the_mean_about_the_wrist() {
        let frame = |wrist: DVec3, tip: DVec3| {
            let mut points = [None; JOINTS];
            points[0] = Some(wrist);
            points[4] = Some(wrist + tip);
            points
        };
        let frames = BTreeMap::from([
            (FrameName::Number(0), frame(DVec3::ZERO, DVec3::X)),
            (FrameName::Number(1), frame(DVec3::splat(100.0), 3.0 * DVec3::X)),
        ]);
        let constant = ConstantPoints::of(&frames);
        let errors = constant.errors(&frames[&FrameName::Number(1)], DVec3::length);
        assert_eq!((errors[0], errors[4], errors[5]), (Some(0.0), Some(1.0), None));
    }

    #[test]
    fn a_constant_angle_is_the_median() {
        let frame = |angle| {
            let mut angles = [None; COUNT];
            angles[3] = Some(angle);
            angles
        };
        let angles = [10.0, 90.0, 20.0].map(frame);
        let frames = (0..).map(FrameName::Number).zip(angles).collect();
        let constant = ConstantAngles::of(&frames);
        assert_eq!(constant.errors(&angles[1])[3], Some(70.0));
        assert_eq!(constant.errors(&angles[1])[4], None);
    }
}
