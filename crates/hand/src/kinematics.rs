//! Forward kinematics: from shape and pose to 21 joints and to the solids that draw the hand.

use glam::{DAffine3, DMat3, DVec3};

use crate::chain::Chain;
use crate::dof::{Digit, Dof};
use crate::pose::Pose;
use crate::primitive::Primitive;
use crate::shape::{HandShape, Side};
use crate::solids::Solids;
use crate::twist::{Bone, Twist, Twists};

/// How many joints a posed hand reports.
pub const JOINTS: usize = 21;

/// A hand in a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct PosedHand {
    /// Joint centres, mm: 0 the wrist, then base to tip of thumb (1–4), index (5–8), middle
    /// (9–12), ring (13–16) and little finger (17–20). A tip is the middle of the last segment's
    /// rounded end, as far below the skin as that is thick: detectors of landmarks put it there.
    pub joints: [DVec3; JOINTS],
    /// The solids whose union is the hand and forearm, mm.
    pub primitives: Vec<Primitive>,
    /// What the spheres of each solid move with, in the order of its spheres; the last is repeated
    /// where there are fewer than three.
    pub bones: Vec<[Bone; 3]>,
}

impl PosedHand {
    /// Where the skin of thumb, index, middle, ring and little finger ends, mm: beyond the tips of this hand's `joints`.
    ///
    /// ```
    /// use glam::DAffine3;
    /// use phalanx_hand::{HandShape, Pose};
    ///
    /// let shape = HandShape::adult();
    /// let hand = shape.pose(&Pose::REST, &DAffine3::IDENTITY);
    /// let [_, _, middle, ..] = hand.ends(&shape);
    /// assert!((middle.length() - shape.length_mm()).abs() < 1e-9);
    /// ```
    pub fn ends(&self, shape: &HandShape) -> [DVec3; 5] {
        let fingers = shape.fingers().map(|finger| finger.radii_mm);
        let radii = [&[shape.thumb.radii_mm], &fingers[..]].concat();
        std::array::from_fn(|digit| {
            let [last, tip] = [3, 4].map(|joint| self.joints[4 * digit + joint]);
            tip + (tip - last).normalize_or_zero() * radii[digit][3]
        })
    }
}

impl HandShape {
    /// Poses the hand: joints and solids in world coordinates, where `rest` maps the frame of
    /// the hand at rest (wrist in the middle of the volume) to the world.
    ///
    /// A left hand is the mirror image in its own frame: its joint angles mean the same, its
    /// orientation is mirrored with it (θ_Z = 90° has the thumb up too), its position is not.
    pub fn pose(&self, pose: &Pose, rest: &DAffine3) -> PosedHand {
        let palm = palm_rotation(pose);
        let chains = self.chains(pose).map(|chain| chain.turned(palm));

        let mut joints = [DVec3::ZERO; JOINTS];
        let radii = std::iter::once(&self.thumb.radii_mm)
            .chain(self.fingers().map(|finger| &finger.radii_mm));
        for ((own, chain), radii) in joints[1..].chunks_exact_mut(4).zip(&chains).zip(radii) {
            own.copy_from_slice(&chain.spheres(radii).map(|sphere| sphere.center));
        }
        let solids = Solids::of(self, &chains, palm);

        let motion = *rest * self.global_motion(pose);
        PosedHand {
            joints: joints.map(|joint| motion.transform_point3(joint)),
            primitives: solids.primitives.iter().map(|solid| solid.moved(&motion)).collect(),
            bones: solids.bones,
        }
    }

    /// From the wrist to the end of the middle finger, all joints straight, mm.
    ///
    /// ```
    /// use phalanx_hand::HandShape;
    ///
    /// assert!((HandShape::adult().length_mm() - 185.0).abs() < 1.0);
    /// ```
    pub fn length_mm(&self) -> f64 {
        let [_, _, middle, ..] = self.chains(&Pose::REST);
        middle.joints[3].length()
    }

    /// How each number of the pose moves the hand, in world coordinates: the derivative of
    /// [`pose`](Self::pose) in closed form.
    ///
    /// ```
    /// use glam::DAffine3;
    /// use phalanx_hand::{Dof, HandShape, Pose};
    ///
    /// let (shape, rest) = (HandShape::adult(), DAffine3::IDENTITY);
    /// let tip = |pose: &Pose| shape.pose(pose, &rest).joints[8]; // of the index finger
    /// let mut bent = Pose::REST;
    /// bent[Dof::IndexPip] = 1e-6;
    /// let moved = (tip(&bent) - tip(&Pose::REST)) / 1e-6;
    /// let twists = shape.twists(&Pose::REST, &rest);
    /// assert!((twists.of(Dof::IndexPip).velocity(tip(&Pose::REST)) - moved).length() < 1e-3);
    /// ```
    pub fn twists(&self, pose: &Pose, rest: &DAffine3) -> Twists {
        let (palm, rotation) = (palm_rotation(pose), pose.rotation());
        let own = *rest * self.global_motion(pose);
        // A mirror turns the sense of rotations about it.
        let turn = |frame: DMat3, axis: DVec3, origin: DVec3| Twist::Turn {
            axis: frame * axis * frame.determinant().signum(),
            origin: own.transform_point3(origin),
        };
        let outer = rest.matrix3 * self.mirror();
        let about_x = DMat3::from_rotation_x(pose[Dof::ThetaX]);
        let about_y = about_x * DMat3::from_rotation_y(pose[Dof::ThetaY]);
        let deviated = rotation * DMat3::from_rotation_y(pose[Dof::WristDeviation]);
        let mut twists = [Twist::Shift(DVec3::ZERO); Dof::COUNT];
        let mut set = |dof: Dof, motion: Twist| twists[dof.index()] = motion;
        set(Dof::ThetaX, turn(outer, DVec3::X, DVec3::ZERO));
        set(Dof::ThetaY, turn(outer, about_x.y_axis, DVec3::ZERO));
        set(Dof::ThetaZ, turn(outer, about_y.z_axis, DVec3::ZERO));
        set(Dof::TX, Twist::Shift(rest.matrix3.x_axis));
        set(Dof::TY, Twist::Shift(rest.matrix3.y_axis));
        set(Dof::TZ, Twist::Shift(rest.matrix3.z_axis));
        set(Dof::WristDeviation, turn(outer, rotation.y_axis, DVec3::ZERO));
        set(Dof::WristFlexion, turn(outer, deviated.x_axis, DVec3::ZERO));
        let chains = self.chains(pose).map(|chain| chain.turned(palm));
        for (digit, chain) in Digit::ALL.into_iter().zip(chains) {
            let [abduction, flexions @ ..] = digit.dofs();
            set(abduction, turn(own.matrix3, chain.abduction_axis, chain.joints[0]));
            for (flexion, joint) in flexions.into_iter().zip(chain.joints) {
                set(flexion, turn(own.matrix3, chain.flexion_axis, joint));
            }
        }
        Twists(twists)
    }

    /// From the right hand's own frame to the frame of the hand at rest.
    fn global_motion(&self, pose: &Pose) -> DAffine3 {
        DAffine3::from_mat3_translation(self.mirror() * pose.rotation(), pose.translation())
    }

    fn mirror(&self) -> DMat3 {
        match self.side {
            Side::Right => DMat3::IDENTITY,
            Side::Left => DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0)),
        }
    }

    /// The five digits, thumb first, in the palm's frame.
    fn chains(&self, pose: &Pose) -> [Chain; 5] {
        let fingers = self.fingers();
        std::array::from_fn(|k| match k {
            0 => Chain::of_thumb(&self.thumb, pose),
            _ => Chain::of_finger(fingers[k - 1], Digit::FINGERS[k - 1], pose),
        })
    }
}

fn palm_rotation(pose: &Pose) -> DMat3 {
    DMat3::from_rotation_y(pose[Dof::WristDeviation])
        * DMat3::from_rotation_x(pose[Dof::WristFlexion])
}
