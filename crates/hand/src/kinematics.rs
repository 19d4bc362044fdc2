//! Forward kinematics: from shape and pose to 21 joints and to the solids that draw the hand.

use glam::{DAffine3, DMat3, DVec3};

use crate::dof::{Digit, Dof};
use crate::pose::Pose;
use crate::primitive::{Primitive, Sphere};
use crate::shape::{FingerShape, HandShape, Side, ThumbShape};
use crate::twist::Bone;
use crate::twist::{Twist, Twists};

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

/// A digit's three joints and the end of its skin, the directions of its three segments and the axes
/// that it turns about.
struct Chain {
    joints: [DVec3; 4],
    directions: [DVec3; 3],
    abduction_axis: DVec3,
    flexion_axis: DVec3,
}

/// The solids of a hand as they are made, each with what its spheres move with.
#[derive(Default)]
struct Solids {
    primitives: Vec<Primitive>,
    bones: Vec<[Bone; 3]>,
}

impl Solids {
    fn wedge(&mut self, corners: [(Sphere, Bone); 3]) {
        self.primitives.push(Primitive::Wedge(corners.map(|(sphere, _)| sphere)));
        self.bones.push(corners.map(|(_, bone)| bone));
    }

    fn round_cone(&mut self, ends: [(Sphere, Bone); 2]) {
        self.primitives.push(Primitive::RoundCone(ends.map(|(sphere, _)| sphere)));
        self.bones.push([ends[0].1, ends[1].1, ends[1].1]);
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
        let solids = self.solids(&chains, palm);

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
            0 => self.thumb.chain(pose),
            _ => fingers[k - 1].chain(Digit::FINGERS[k - 1], pose),
        })
    }

    /// Every solid, in the frame of the forearm; `palm` is the wrist's rotation.
    fn solids(&self, chains: &[Chain; 5], palm: DMat3) -> Solids {
        let mut solids = Solids::default();
        solids.primitives.push(self.forearm_solid());
        solids.bones.push([Bone::Forearm; 3]);
        self.push_palm(&mut solids, chains, palm);
        self.push_thumb_sphere(&mut solids, chains, palm);
        chains[0].push_segments(&mut solids, Digit::Thumb, &self.thumb.radii_mm);
        for (k, finger) in self.fingers().into_iter().enumerate() {
            chains[k + 1].push_segments(&mut solids, Digit::FINGERS[k], &finger.radii_mm);
        }
        solids
    }

    fn forearm_solid(&self) -> Primitive {
        let forearm = &self.forearm;
        let [wrist, far] = forearm.half_widths_mm;
        // The round cap of the wrist's end stays behind the wrist.
        let ends = [
            Sphere::new(DVec3::new(0.0, 0.0, -0.5 * wrist), wrist),
            Sphere::new(DVec3::new(0.0, 0.0, -forearm.length_mm), far),
        ];
        Primitive::GeneralisedCylinder { ends, thin_axis: DVec3::Y, flatness: forearm.flatness }
    }

    /// The slab between the wrist and the knuckles, the heel of the hand, and the webs between
    /// the fingers.
    fn push_palm(&self, solids: &mut Solids, chains: &[Chain; 5], palm: DMat3) {
        let shape = &self.palm;
        let [thumb_side, little_side] = self.wrist_spheres(palm).map(|sphere| (sphere, Bone::Palm));
        let knuckles: [(Sphere, Bone); 4] = std::array::from_fn(|k| {
            (Sphere::new(chains[k + 1].joints[0], shape.knuckle_radii_mm[k]), Bone::Palm)
        });
        let [index, middle, ring, little] = knuckles;
        let heel = (Sphere::new(palm * shape.heel_mm, shape.heel_radius_mm), Bone::Palm);
        solids.wedge([thumb_side, index, middle]);
        solids.wedge([thumb_side, little_side, middle]);
        solids.wedge([little_side, middle, ring]);
        solids.wedge([little_side, heel, ring]);
        solids.wedge([heel, ring, little]);
        let fingers = self.fingers();
        for pair in 0..3 {
            let web = |k: usize| {
                let chain = &chains[k + 1];
                let along = shape.web_reach * fingers[k].lengths_mm[0];
                let center = chain.joints[0] + chain.directions[0] * along;
                (Sphere::new(center, shape.web_radius_mm), Bone::Segment(Digit::FINGERS[k], 0))
            };
            let (near, next) = (web(pair), web(pair + 1));
            solids.wedge([knuckles[pair], near, next]);
            solids.wedge([knuckles[pair], knuckles[pair + 1], next]);
        }
    }

    /// The sphere of the thumb and the web between thumb and index finger.
    fn push_thumb_sphere(&self, solids: &mut Solids, chains: &[Chain; 5], palm: DMat3) {
        let shape = &self.palm;
        let metacarpal = Bone::Segment(Digit::Thumb, 0);
        let [thumb_side, _] = self.wrist_spheres(palm).map(|sphere| (sphere, Bone::Palm));
        let [base, mcp, ..] = chains[0].joints;
        let index_knuckle = chains[1].joints[0];
        let [base_radius, mcp_radius, ..] = self.thumb.radii_mm;
        let thin = |at: DVec3| Sphere::new(at, shape.thumb_web_radius_mm);
        let root = (Sphere::new(base, base_radius), metacarpal);
        solids.wedge([thumb_side, root, (Sphere::new(mcp, mcp_radius), metacarpal)]);
        solids.wedge([
            root,
            (thin(base.lerp(mcp, 0.85)), metacarpal),
            (thin(thumb_side.0.center.lerp(index_knuckle, 0.8)), Bone::Palm),
        ]);
    }

    /// The wrist's thumb side and little finger's side.
    fn wrist_spheres(&self, palm: DMat3) -> [Sphere; 2] {
        let shape = &self.palm;
        [1.0, -1.0].map(|side| {
            let center = palm * DVec3::new(side * shape.wrist_half_width_mm, 0.0, 4.0);
            Sphere::new(center, shape.wrist_radius_mm)
        })
    }
}

/// From joint to joint, of segments the last of which is measured to the skin.
fn joint_distances([first, middle, last]: [f64; 3], radii: &[f64; 4]) -> [f64; 3] {
    [first, middle, last - radii[3]]
}

impl ThumbShape {
    /// How far its four joints are from each other, base to tip, mm.
    pub fn joint_distances_mm(&self) -> [f64; 3] {
        joint_distances(self.lengths_mm, &self.radii_mm)
    }

    fn chain(&self, pose: &Pose) -> Chain {
        let rest = DMat3::from_rotation_y(self.splay_deg.to_radians())
            * DMat3::from_rotation_x(self.drop_deg.to_radians())
            * DMat3::from_rotation_z(-self.roll_deg.to_radians());
        let [abduction, flexions @ ..] = Digit::Thumb.dofs().map(|dof| pose[dof]);
        let frame = rest * DMat3::from_rotation_y(abduction);
        Chain::bent(self.base_mm, frame, rest.y_axis, flexions, self.lengths_mm)
    }
}

impl FingerShape {
    /// How far its four joints are from each other, knuckle to tip, mm.
    ///
    /// ```
    /// use phalanx_hand::HandShape;
    ///
    /// let index = HandShape::adult().index;
    /// let [_, _, to_tip] = index.joint_distances_mm();
    /// assert_eq!(to_tip, index.lengths_mm[2] - index.radii_mm[3]);
    /// ```
    pub fn joint_distances_mm(&self) -> [f64; 3] {
        joint_distances(self.lengths_mm, &self.radii_mm)
    }

    fn chain(&self, finger: Digit, pose: &Pose) -> Chain {
        let [abduction, flexions @ ..] = finger.dofs().map(|dof| pose[dof]);
        // Away from the middle finger is towards -X for the ring and the little finger.
        let outwards = if matches!(finger, Digit::Ring | Digit::Little) { -1.0 } else { 1.0 };
        let frame = DMat3::from_rotation_y(self.splay_deg.to_radians() + outwards * abduction);
        Chain::bent(self.base_mm, frame, DVec3::Y * outwards, flexions, self.lengths_mm)
    }
}

impl Chain {
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

    fn turned(self, rotation: DMat3) -> Self {
        Self {
            joints: self.joints.map(|joint| rotation * joint),
            directions: self.directions.map(|direction| rotation * direction),
            abduction_axis: rotation * self.abduction_axis,
            flexion_axis: rotation * self.flexion_axis,
        }
    }

    /// The spheres at its joints and in its tip; the last one ends at the skin.
    fn spheres(&self, radii: &[f64; 4]) -> [Sphere; 4] {
        let mut spheres = std::array::from_fn(|k| Sphere::new(self.joints[k], radii[k]));
        spheres[3].center -= self.directions[2] * radii[3];
        spheres
    }

    /// The three segments.
    fn push_segments(&self, solids: &mut Solids, digit: Digit, radii: &[f64; 4]) {
        let spheres = self.spheres(radii);
        for segment in 0..3 {
            let bone = Bone::Segment(digit, segment);
            solids.round_cone([(spheres[segment], bone), (spheres[segment + 1], bone)]);
        }
    }
}

fn palm_rotation(pose: &Pose) -> DMat3 {
    DMat3::from_rotation_y(pose[Dof::WristDeviation])
        * DMat3::from_rotation_x(pose[Dof::WristFlexion])
}
