//! The hand as a tree of bones, each turning on its parent.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use phalanx_hand::{Bone, Digit, Dof, HandShape, Pose, Side};

/// How many bones there are: the forearm, the palm and three for each digit.
pub(crate) const BONES: usize = 17;

/// The names of the bones: of the joint on which each turns.
pub(crate) const BONE_NAMES: [&str; BONES] = [
    "forearm",
    "wrist",
    "thumb_cmc",
    "thumb_mcp",
    "thumb_ip",
    "index_mcp",
    "index_pip",
    "index_dip",
    "middle_mcp",
    "middle_pip",
    "middle_dip",
    "ring_mcp",
    "ring_pip",
    "ring_dip",
    "little_mcp",
    "little_pip",
    "little_dip",
];

/// The person's hand as bones; the first is the root. Its place is that of the wrist in the frame
/// of the hand at rest.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Skeleton {
    pub(crate) bones: [SkeletonBone; BONES],
}

/// A bone: where it begins on its parent, and what turns it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SkeletonBone {
    /// None of the root.
    pub(crate) parent: Option<usize>,
    /// The beginning in the parent's frame, mm.
    pub(crate) offset: DVec3,
    /// The turn at rest.
    pub(crate) rest: DQuat,
    /// The axes about which numbers of the pose turn it, from the outermost inwards.
    pub(crate) turns: Vec<(DVec3, Dof)>,
    /// The end in the bone's own frame, mm, of bones that carry no other.
    pub(crate) tip: Option<DVec3>,
}

impl Skeleton {
    pub(crate) fn new(shape: &HandShape) -> Self {
        let root = SkeletonBone::new(None, DVec3::ZERO, DQuat::IDENTITY);
        let palm = SkeletonBone::new(Some(0), DVec3::ZERO, DQuat::IDENTITY);
        let mut bones = vec![
            root.turned(DVec3::X, Dof::ThetaX)
                .turned(DVec3::Y, Dof::ThetaY)
                .turned(DVec3::Z, Dof::ThetaZ),
            palm.turned(DVec3::Y, Dof::WristDeviation).turned(DVec3::X, Dof::WristFlexion),
        ];
        let thumb = &shape.thumb;
        let thumb_rest = DQuat::from_rotation_y(thumb.splay_deg.to_radians())
            * DQuat::from_rotation_x(thumb.drop_deg.to_radians())
            * DQuat::from_rotation_z(-thumb.roll_deg.to_radians());
        push_digit(&mut bones, Digit::Thumb, thumb.base_mm, thumb_rest, thumb.joint_distances_mm());
        for (digit, finger) in Digit::FINGERS.into_iter().zip(shape.fingers()) {
            let rest = DQuat::from_rotation_y(finger.splay_deg.to_radians());
            push_digit(&mut bones, digit, finger.base_mm, rest, finger.joint_distances_mm());
        }
        if shape.side == Side::Left {
            bones.iter_mut().for_each(SkeletonBone::mirror);
        }
        let mut bones = bones.into_iter();
        Self { bones: std::array::from_fn(|_| bones.next().expect("two bones and five digits")) }
    }

    /// Each bone's turn on its parent.
    pub(crate) fn rotations(&self, pose: &Pose) -> [DQuat; BONES] {
        self.bones.each_ref().map(|bone| bone.rotation(pose))
    }

    /// Each bone's own frame, in the frame of the hand at rest, mm.
    pub(crate) fn frames(&self, pose: &Pose) -> [DAffine3; BONES] {
        let mut frames = [DAffine3::from_translation(pose.translation()); BONES];
        for (k, rotation) in self.rotations(pose).into_iter().enumerate() {
            let bone = &self.bones[k];
            let own = DAffine3::from_rotation_translation(rotation, bone.offset);
            frames[k] = bone.parent.map_or(frames[k], |parent| frames[parent]) * own;
        }
        frames
    }
}

/// Which bone moves as a part of the hand does.
pub(crate) fn bone_of(bone: Bone) -> usize {
    match bone {
        Bone::Forearm => 0,
        Bone::Palm => 1,
        Bone::Segment(digit, segment) => 2 + 3 * (digit as usize) + segment,
    }
}

fn push_digit(
    bones: &mut Vec<SkeletonBone>,
    digit: Digit,
    base: DVec3,
    rest: DQuat,
    lengths: [f64; 3],
) {
    let [abduction, flexions @ ..] = digit.dofs();
    // Away from the middle finger is towards -X for the ring and the little finger.
    let outwards = if matches!(digit, Digit::Ring | Digit::Little) { -1.0 } else { 1.0 };
    let first = bones.len();
    for (segment, flexion) in flexions.into_iter().enumerate() {
        let bone = match segment {
            0 => SkeletonBone::new(Some(1), base, rest).turned(DVec3::Y * outwards, abduction),
            _ => SkeletonBone::new(
                Some(first + segment - 1),
                DVec3::Z * lengths[segment - 1],
                DQuat::IDENTITY,
            ),
        };
        bones.push(bone.turned(DVec3::X, flexion));
    }
    bones[first + 2].tip = Some(DVec3::Z * lengths[2]);
}

impl SkeletonBone {
    fn new(parent: Option<usize>, offset: DVec3, rest: DQuat) -> Self {
        Self { parent, offset, rest, turns: Vec::new(), tip: None }
    }

    fn turned(mut self, axis: DVec3, dof: Dof) -> Self {
        self.turns.push((axis, dof));
        self
    }

    fn rotation(&self, pose: &Pose) -> DQuat {
        let turns = self.turns.iter().map(|&(axis, dof)| DQuat::from_axis_angle(axis, pose[dof]));
        turns.fold(self.rest, |rotation, turn| rotation * turn)
    }

    /// The same bone of the other hand: x is mirrored, and with it the sense of turns.
    fn mirror(&mut self) {
        let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
        self.offset = mirror * self.offset;
        self.rest = DQuat::from_xyzw(self.rest.x, -self.rest.y, -self.rest.z, self.rest.w);
        self.turns.iter_mut().for_each(|(axis, _)| *axis = -(mirror * *axis));
        self.tip = self.tip.map(|tip| mirror * tip);
    }
}

#[cfg(test)]
mod tests {
    use phalanx_hand::JOINTS;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(crate::property::cases(256))]

        #[test]
        fn the_bones_end_where_the_hand_has_its_joints(
            numbers in prop::array::uniform28(-1.5..1.5_f64),
            left in any::<bool>(),
        ) {
            let side = if left { Side::Left } else { Side::Right };
            let shape = HandShape { side, ..HandShape::adult() };
            let (pose, skeleton) = (Pose(numbers), Skeleton::new(&shape));
            let expected = shape.pose(&pose, &DAffine3::IDENTITY).joints;
            let frames = skeleton.frames(&pose);
            let mut joints = vec![frames[1].translation];
            for (frame, bone) in frames.iter().zip(&skeleton.bones).skip(2) {
                joints.push(frame.translation);
                joints.extend(bone.tip.map(|tip| frame.transform_point3(tip)));
            }
            prop_assert_eq!(joints.len(), JOINTS);
            for (joint, expected) in joints.iter().zip(expected) {
                prop_assert!((*joint - expected).length() < 1e-9);
            }
        }
    }
}
