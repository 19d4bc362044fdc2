//! The desk's cameras, and postures of a hand before them.

use phalanx_camera::Rig;
use phalanx_hand::Pose;

pub(crate) fn rig() -> Rig {
    Rig::from_toml(include_str!("../../fixtures/desk.toml")).unwrap()
}

/// A hand whose digits are bent, radians: the middle joint by so much, the others by less.
pub(crate) fn bent(bends: [f64; 5]) -> Pose {
    let mut pose = Pose::REST;
    for (k, bend) in bends.into_iter().enumerate() {
        pose.0[4 * k + 1] = 0.6 * bend;
        pose.0[4 * k + 2] = bend;
        pose.0[4 * k + 3] = 0.7 * bend;
    }
    pose
}
