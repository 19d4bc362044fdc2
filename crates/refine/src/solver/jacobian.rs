//! The slopes of residuals by the pose, the hand's shape and the cameras' places.

use std::borrow::Cow;

use glam::{DAffine3, DMat3, DVec3};
use phalanx_camera::Camera;
use phalanx_hand::{Bone, Dof, JOINTS, PosedHand, Primitive, Twist, Twists};

use crate::geometry::correspondence::Correspondence;
use crate::geometry::self_collision::Penetration;
use crate::geometry::shape_parameters::PrimitiveSlopes;
use crate::priors::nuisance::ExtrinsicsCorrection;
use crate::solver::normal_equations::Row;

/// A contact between a ray and a posed hand, in the world.
pub(crate) struct Contact<'a> {
    bones: &'a [Bone; 3],
    /// The spheres' weights in the place that the ray passes.
    weights: [f64; 3],
    /// What moves there, with weights: the spheres' centres, or one point of a squashed primitive.
    points: [(f64, DVec3); 3],
    /// ∂residual of a shift, px/mm.
    normal: DVec3,
}

/// Where a camera stands.
pub(crate) struct Place<'a> {
    camera: &'a Camera,
    /// The motion that its correction gives the hand.
    motion: Option<DAffine3>,
    /// What the motion turns about.
    pivot: DVec3,
    /// From the camera's directions to the world's, as they are before the motion.
    back: DMat3,
}

impl<'a> Place<'a> {
    pub(crate) fn new(
        camera: &'a Camera,
        correction: Option<&ExtrinsicsCorrection>,
        pivot: DVec3,
    ) -> Self {
        let motion = correction.map(|correction| correction.motion(pivot));
        let turned = motion.map_or(DMat3::IDENTITY, |motion| motion.matrix3.transpose());
        Self { camera, motion, pivot, back: turned * camera.extrinsics.rotation.transpose() }
    }

    /// The primitives as they seem to stand.
    pub(crate) fn seen<'s>(&self, primitives: &'s [Primitive]) -> Cow<'s, [Primitive]> {
        match self.motion {
            Some(motion) => primitives.iter().map(|primitive| primitive.moved(&motion)).collect(),
            None => Cow::Borrowed(primitives),
        }
    }

    /// A point of the world as it seems to stand.
    pub(crate) fn moved(&self, point: DVec3) -> DVec3 {
        self.motion.map_or(point, |motion| motion.transform_point3(point))
    }

    /// A joint, of which a residual changes with its place in the camera's frame by `slope`.
    pub(crate) fn joint<'p>(
        &self,
        bones: &'p [Bone; 3],
        joint: DVec3,
        slope: DVec3,
    ) -> Contact<'p> {
        let nothing = (0.0, DVec3::ZERO);
        let normal = self.back * slope;
        Contact { bones, weights: [0.0; 3], points: [(1.0, joint), nothing, nothing], normal }
    }

    /// The contact of an edge where a millimetre is `scale` pixels wide.
    pub(crate) fn contact<'p>(
        &self,
        found: &Correspondence,
        posed: &'p PosedHand,
        scale: f64,
    ) -> Contact<'p> {
        let approach = &found.approach;
        let spheres = posed.primitives[found.primitive].spheres();
        let points = match approach.point {
            Some(point) => {
                let world = self.camera.extrinsics.to_world(point);
                let motion = self.motion.unwrap_or(DAffine3::IDENTITY);
                let nothing = (0.0, DVec3::ZERO);
                [(1.0, motion.inverse().transform_point3(world)), nothing, nothing]
            }
            None => {
                [0, 1, 2].map(|k| (approach.weights[k], spheres[k.min(spheres.len() - 1)].center))
            }
        };
        Contact {
            bones: &posed.bones[found.primitive],
            weights: approach.weights,
            points,
            normal: self.back * approach.normal * scale,
        }
    }

    /// The slopes of a correction, whose numbers begin at `first`.
    pub(crate) fn row(
        &self,
        contact: &Contact<'_>,
        first: usize,
    ) -> impl Iterator<Item = (usize, f64)> {
        let motion = self.motion.unwrap_or(DAffine3::IDENTITY);
        let middle: DVec3 = contact.points.iter().map(|(weight, point)| *point * *weight).sum();
        let arm = motion.transform_point3(middle) - self.pivot;
        let normal = motion.transform_vector3(contact.normal);
        let slopes = [arm.cross(normal).to_array(), normal.to_array()];
        (0..ExtrinsicsCorrection::NUMBERS).map(move |k| (first + k, slopes[k / 3][k % 3]))
    }
}

/// A twist as its turn and the velocity of what is at the world's origin, so that what it does to a residual is linear
/// in the force and the torque that the residual's slope is.
#[derive(Clone, Copy)]
struct Motion {
    turn: DVec3,
    shift: DVec3,
}

impl Motion {
    fn of(twist: &Twist) -> Self {
        match twist {
            Twist::Turn { axis, origin } => Self { turn: *axis, shift: origin.cross(*axis) },
            Twist::Shift(direction) => Self { turn: DVec3::ZERO, shift: *direction },
        }
    }
}

/// Memory for the rows of one residual.
pub(crate) struct Rows {
    /// Where each number of a pose is among those that are fitted.
    slots: [Option<usize>; Dof::COUNT],
    /// How each moves what hangs on it.
    motions: [Motion; Dof::COUNT],
    pub(crate) own: Row,
    pub(crate) shared: Row,
}

impl Rows {
    /// For poses of which these numbers are fitted, and what they move.
    pub(crate) fn new(dofs: &[Dof], twists: &Twists) -> Self {
        let mut slots = [None; Dof::COUNT];
        for (slot, dof) in dofs.iter().enumerate() {
            slots[dof.index()] = Some(slot);
        }
        let motions = Dof::ALL.map(|dof| Motion::of(twists.of(dof)));
        Self { slots, motions, own: Row::new(), shared: Row::new() }
    }

    pub(crate) fn clear(&mut self) {
        self.own.clear();
        self.shared.clear();
    }

    /// Adds the slopes of a contact by the pose.
    pub(crate) fn of_pose(&mut self, contact: &Contact<'_>) {
        let Contact { bones, points, normal, .. } = contact;
        let mut k = 0;
        while k < 3 {
            // Spheres of one bone move as one.
            let (mut weight, mut moment) = (0.0, DVec3::ZERO);
            let bone = bones[k];
            while k < 3 && bones[k] == bone {
                weight += points[k].0;
                moment += points[k].1 * points[k].0;
                k += 1;
            }
            if weight == 0.0 {
                continue;
            }
            let (force, torque) = (*normal * weight, moment.cross(*normal));
            let is_first = self.own.is_empty();
            for dof in bone.dofs() {
                let Motion { turn, shift } = self.motions[dof.index()];
                let slope = turn.dot(torque) + shift.dot(force);
                match self.slots[dof.index()] {
                    Some(slot) if is_first => self.own.push((slot, slope)),
                    Some(_) => self.add(dof, slope),
                    None => {}
                }
            }
        }
        self.own.sort_unstable_by_key(|&(slot, _)| slot);
    }

    /// What a shift of the whole hand, in the frame at rest, adds to the slopes of its pose.
    pub(crate) fn of_translation(&mut self, slopes: DVec3) {
        for (dof, slope) in [Dof::TX, Dof::TY, Dof::TZ].into_iter().zip(slopes.to_array()) {
            self.add(dof, slope);
        }
    }

    fn add(&mut self, dof: Dof, slope: f64) {
        let Some(slot) = self.slots[dof.index()] else { return };
        match self.own.iter_mut().find(|(other, _)| *other == slot) {
            Some((_, sum)) => *sum += slope,
            None => self.own.push((slot, slope)),
        }
    }

    /// The slopes of how deep two digits are in each other.
    pub(crate) fn of_penetration(
        &mut self,
        penetration: &Penetration,
        posed: &PosedHand,
        slopes: Option<&[PrimitiveSlopes]>,
    ) {
        self.clear();
        for ((&primitive, &place), away) in
            penetration.primitives.iter().zip(&penetration.places).zip([-1.0, 1.0])
        {
            let centers = [0, 1].map(|k| posed.primitives[primitive].spheres()[k].center);
            let weights = [1.0 - place, place, 0.0];
            let contact = Contact {
                bones: &posed.bones[primitive],
                weights,
                points: [(1.0 - place, centers[0]), (place, centers[1]), (0.0, DVec3::ZERO)],
                normal: penetration.apart * away,
            };
            self.of_pose(&contact);
            if let Some(slopes) = slopes {
                self.of_shape(&contact, &slopes[primitive], 0.0);
                // It is as thick as on average.
                let thick = Contact { weights: [0.5, 0.5, 0.0], normal: DVec3::ZERO, ..contact };
                self.of_shape(&thick, &slopes[primitive], -1.0);
            }
        }
    }

    /// The slopes of a joint by the hand's proportions, by which all joints move as said.
    pub(crate) fn of_joint(
        &mut self,
        contact: &Contact<'_>,
        slopes: &[[DVec3; JOINTS]],
        joint: usize,
    ) {
        let of_numbers = slopes.iter().map(|moved| contact.normal.dot(moved[joint])).enumerate();
        self.shared.extend(of_numbers.filter(|(_, slope)| *slope != 0.0));
    }

    pub(crate) fn of_shape(&mut self, contact: &Contact<'_>, slopes: &PrimitiveSlopes, scale: f64) {
        for (weight, slopes) in contact.weights.iter().zip(slopes) {
            for slope in slopes.iter().filter(|_| *weight > 0.0) {
                let moved = contact.normal.dot(slope.center) - scale * slope.radius;
                match self.shared.iter_mut().find(|(other, _)| *other == slope.number) {
                    Some((_, sum)) => *sum += weight * moved,
                    None => self.shared.push((slope.number, weight * moved)),
                }
            }
        }
        self.shared.sort_unstable_by_key(|&(number, _)| number);
    }
}
