//! A digit as a planar chain of three segments.

use glam::{DMat3, DVec3};

use crate::dof::Digit;
use crate::pose::Pose;
use crate::primitive::Sphere;
use crate::shape::{FingerShape, ThumbShape};

/// A digit's three joints and the end of its skin, the directions of its three segments and the axes
/// that it turns about.
pub(crate) struct Chain {
    pub(crate) joints: [DVec3; 4],
    pub(crate) directions: [DVec3; 3],
    pub(crate) abduction_axis: DVec3,
    pub(crate) flexion_axis: DVec3,
}

impl Chain {
    pub(crate) fn of_thumb(shape: &ThumbShape, pose: &Pose) -> Self {
        let rest = DMat3::from_rotation_y(shape.splay_deg.to_radians())
            * DMat3::from_rotation_x(shape.drop_deg.to_radians())
            * DMat3::from_rotation_z(-shape.roll_deg.to_radians());
        let [abduction, flexions @ ..] = Digit::Thumb.dofs().map(|dof| pose[dof]);
        let frame = rest * DMat3::from_rotation_y(abduction);
        Self::bent(shape.base_mm, frame, rest.y_axis, flexions, shape.lengths_mm)
    }

    pub(crate) fn of_finger(shape: &FingerShape, finger: Digit, pose: &Pose) -> Self {
        let [abduction, flexions @ ..] = finger.dofs().map(|dof| pose[dof]);
        // Away from the middle finger is towards -X for the ring and the little finger.
        let outwards = if matches!(finger, Digit::Ring | Digit::Little) { -1.0 } else { 1.0 };
        let frame = DMat3::from_rotation_y(shape.splay_deg.to_radians() + outwards * abduction);
        Self::bent(shape.base_mm, frame, DVec3::Y * outwards, flexions, shape.lengths_mm)
    }

    /// A planar chain from `base`: +Z of `frame` is its direction, +X its flexion axis.
    fn bent(
        base: DVec3,
        frame: DMat3,
        abduction_axis: DVec3,
        flexions: [f64; 3],
        lengths: [f64; 3],
    ) -> Self {
        let mut joints = [base; 4];
        let mut directions = [DVec3::Z; 3];
        let mut flexion = 0.0;
        for segment in 0..3 {
            flexion += flexions[segment];
            directions[segment] = frame * DMat3::from_rotation_x(flexion).z_axis;
            joints[segment + 1] = joints[segment] + directions[segment] * lengths[segment];
        }
        Self { joints, directions, abduction_axis, flexion_axis: frame.x_axis }
    }

    pub(crate) fn turned(self, rotation: DMat3) -> Self {
        Self {
            joints: self.joints.map(|joint| rotation * joint),
            directions: self.directions.map(|direction| rotation * direction),
            abduction_axis: rotation * self.abduction_axis,
            flexion_axis: rotation * self.flexion_axis,
        }
    }

    /// The spheres at its joints and in its tip; the last one ends at the skin.
    pub(crate) fn spheres(&self, radii: &[f64; 4]) -> [Sphere; 4] {
        let mut spheres = std::array::from_fn(|k| Sphere::new(self.joints[k], radii[k]));
        spheres[3].center -= self.directions[2] * radii[3];
        spheres
    }
}
