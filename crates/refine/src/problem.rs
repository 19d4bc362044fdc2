//! The energy of a fit, and its normal equations.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use phalanx_hand::{Dof, HandShape, Link, Motions, Pose, PosedHand, Primitive};

use crate::proportions::{Proportions, Slope};
use crate::system::{FrameSystem, Row};
use crate::view::{Match, View};
use crate::{Evidence, PosePrior, Result};

/// One frame: what its cameras saw, and what is known of its pose.
pub(crate) struct Frame<'a> {
    pub(crate) evidence: &'a [Evidence],
    pub(crate) prior: &'a PosePrior,
}

/// What is fitted besides the poses, and how far it may stray: standard deviations.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Freedom {
    /// Of the logarithms of a hand's size and of each of its bones and radii.
    pub(crate) hand: Option<[f64; 2]>,
    /// Of each camera's turn about the hand, radians, and shift, mm, about each axis.
    pub(crate) cameras: Option<[f64; 2]>,
}

/// The unknowns of one frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Moment {
    pub(crate) pose: Pose,
    /// How far each view's border lies outside the hand's, px: what segmentation adds all around or
    /// takes away.
    pub(crate) margins: Vec<f64>,
}

/// What all frames share.
#[derive(Debug, Clone)]
pub(crate) struct Shared {
    pub(crate) proportions: Proportions,
    /// Each camera's scaled axis of turning, radians, and shift, mm, that the hand seems moved by.
    pub(crate) corrections: Vec<[DVec3; 2]>,
}

/// The robust measure of residuals (Geman and McClure 1987).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Measure {
    /// Residuals well beyond this, px, do not count.
    pub(crate) reach: f64,
    /// Standard deviation of a border's place, px.
    pub(crate) noise: f64,
    /// Standard deviation of what segmentation adds to or takes from a whole border, px.
    pub(crate) margin: f64,
    /// Of so many cracks one is looked at.
    pub(crate) every: usize,
}

impl Measure {
    fn energy(&self, residual: f64) -> f64 {
        let (s, r) = (self.reach * self.reach, residual * residual);
        0.5 * s * r / (s + r) * self.every as f64 / (self.noise * self.noise)
    }

    fn weight(&self, residual: f64) -> f64 {
        let s = self.reach * self.reach;
        let w = s / (s + residual * residual);
        w * w * self.every as f64 / (self.noise * self.noise)
    }
}

/// A fit of one hand to what cameras saw.
pub(crate) struct Problem<'a> {
    pub(crate) given: &'a HandShape,
    pub(crate) rest: &'a DAffine3,
    pub(crate) frames: Vec<Frame<'a>>,
    pub(crate) freedom: Freedom,
}

/// A contact between a ray and a posed hand, in the world.
struct Contact<'a> {
    links: &'a [Link; 3],
    /// The balls' weights in the place that the ray passes.
    weights: [f64; 3],
    /// What moves there, with weights: the balls' centres, or one point of a squashed solid.
    points: [(f64, DVec3); 3],
    /// ∂residual of a shift, px/mm.
    normal: DVec3,
}

impl Problem<'_> {
    /// How many numbers all frames share.
    pub(crate) fn shared_count(&self, shared: &Shared) -> usize {
        let hand = self.freedom.hand.map_or(0, |_| shared.proportions.logarithms.len());
        hand + self.freedom.cameras.map_or(0, |_| 6 * shared.corrections.len())
    }

    /// What is known of the shared numbers: their energy, and for each its Hessian and gradient.
    pub(crate) fn shared_prior(&self, shared: &Shared) -> (f64, Vec<(f64, f64)>) {
        let mut known = Vec::new();
        let mut energy = 0.0;
        let mut add = |value: f64, deviation: f64| {
            let precision = deviation.powi(-2);
            energy += 0.5 * value * value * precision;
            known.push((precision, value * precision));
        };
        if let Some([size, each]) = self.freedom.hand {
            for (k, &logarithm) in shared.proportions.logarithms.iter().enumerate() {
                add(logarithm, if k == 0 { size } else { each });
            }
        }
        if let Some(deviations) = self.freedom.cameras {
            for correction in &shared.corrections {
                for (part, deviation) in correction.iter().zip(deviations) {
                    part.to_array().into_iter().for_each(|value| add(value, deviation));
                }
            }
        }
        (energy, known)
    }

    /// The energy of one frame and its normal equations.
    pub(crate) fn look(
        &self,
        frame: usize,
        moment: &Moment,
        shared: &Shared,
        measure: Measure,
        views: &mut [View],
    ) -> Result<(f64, FrameSystem)> {
        let Frame { evidence, prior } = &self.frames[frame];
        let Moment { pose, margins } = moment;
        let hand = shared.proportions.hand(self.given);
        let posed = hand.pose(pose, self.rest);
        let motions = hand.motions(pose, self.rest);
        let slopes = self
            .freedom
            .hand
            .map(|_| shared.proportions.slopes(self.given, pose, self.rest, &posed));
        let mut system = FrameSystem::new(prior.dofs().len(), margins.len(), self.shared_count(shared));
        let mut energy = 0.0;
        for (v, (view, evidence)) in views.iter_mut().zip(*evidence).enumerate() {
            let correction = correction(shared.corrections[v], self.rest.translation);
            let seen: Vec<Primitive>;
            let solids = if self.freedom.cameras.is_some() {
                seen = posed.primitives.iter().map(|solid| solid.moved(&correction)).collect();
                &seen
            } else {
                &posed.primitives
            };
            view.compare(solids, evidence, measure.every)?;
            let extrinsics = &evidence.camera().extrinsics;
            let back = correction.matrix3.transpose() * extrinsics.rotation.transpose();
            let scale = pixels_per_mm(evidence, self.rest.translation);
            let mut rows = Rows { dofs: slots(prior.dofs()), pose: Row::new(), shared: Row::new() };
            for found in &view.matches {
                let residual = scale * found.passing.distance - margins[v];
                energy += measure.energy(residual);
                let contact = contact(found, &posed, evidence, back, scale, &correction);
                rows.of_pose(&contact, &motions);
                rows.pose.push((prior.dofs().len() + v, -1.0));
                rows.shared.clear();
                if let Some(slopes) = &slopes {
                    rows.of_proportions(&contact, &slopes[found.solid], scale);
                }
                if self.freedom.cameras.is_some() {
                    let first = self.shared_count(shared) - 6 * shared.corrections.len() + 6 * v;
                    rows.of_camera(&contact, first, &correction, self.rest.translation);
                }
                let weight = measure.weight(residual);
                system.add(residual, weight, &rows.pose, &rows.shared);
            }
        }
        energy += system.add_prior(prior, moment, measure.margin);
        Ok((energy, system))
    }
}

/// The motion that a camera seems to give the hand.
pub(crate) fn correction([turn, shift]: [DVec3; 2], pivot: DVec3) -> DAffine3 {
    let rotation = DMat3::from_quat(DQuat::from_scaled_axis(turn));
    DAffine3::from_mat3_translation(rotation, pivot - rotation * pivot + shift)
}

/// Pixels that a millimetre is wide at the middle of the volume.
pub(crate) fn pixels_per_mm(evidence: &Evidence, middle: DVec3) -> f64 {
    let camera = evidence.camera();
    let intrinsics = &camera.intrinsics;
    (intrinsics.fx * intrinsics.fy).sqrt() / camera.extrinsics.to_camera(middle).length()
}

fn contact<'a>(
    found: &Match,
    posed: &'a PosedHand,
    evidence: &Evidence,
    back: DMat3,
    scale: f64,
    correction: &DAffine3,
) -> Contact<'a> {
    let passing = &found.passing;
    let balls = posed.primitives[found.solid].balls();
    let points = match passing.point {
        Some(point) => {
            let world = evidence.camera().extrinsics.to_world(point);
            let uncorrected = correction.inverse().transform_point3(world);
            [(1.0, uncorrected), (0.0, DVec3::ZERO), (0.0, DVec3::ZERO)]
        }
        None => [0, 1, 2].map(|k| (passing.weights[k], balls[k.min(balls.len() - 1)].center)),
    };
    Contact {
        links: &posed.links[found.solid],
        weights: passing.weights,
        points,
        normal: back * passing.normal * scale,
    }
}

/// Where each number of a pose is among those that are fitted.
fn slots(dofs: &[Dof]) -> [Option<usize>; Dof::COUNT] {
    let mut slots = [None; Dof::COUNT];
    for (slot, dof) in dofs.iter().enumerate() {
        slots[dof.index()] = Some(slot);
    }
    slots
}

/// Memory for the rows of one residual.
struct Rows {
    dofs: [Option<usize>; Dof::COUNT],
    pose: Row,
    shared: Row,
}

impl Rows {
    fn of_pose(&mut self, contact: &Contact<'_>, motions: &Motions) {
        self.pose.clear();
        let Contact { links, points, normal, .. } = contact;
        let mut k = 0;
        while k < 3 {
            // Balls of one link move as one.
            let (mut weight, mut moment) = (0.0, DVec3::ZERO);
            let link = links[k];
            while k < 3 && links[k] == link {
                weight += points[k].0;
                moment += points[k].1 * points[k].0;
                k += 1;
            }
            if weight == 0.0 {
                continue;
            }
            for dof in link.dofs() {
                if let Some(slot) = self.dofs[dof.index()] {
                    let slope = weight * normal.dot(motions.of(dof).velocity(moment / weight));
                    match self.pose.iter_mut().find(|(other, _)| *other == slot) {
                        Some((_, sum)) => *sum += slope,
                        None => self.pose.push((slot, slope)),
                    }
                }
            }
        }
        self.pose.sort_unstable_by_key(|&(slot, _)| slot);
    }

    fn of_proportions(&mut self, contact: &Contact<'_>, slopes: &[Vec<Slope>; 3], scale: f64) {
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

    fn of_camera(
        &mut self,
        contact: &Contact<'_>,
        first: usize,
        correction: &DAffine3,
        pivot: DVec3,
    ) {
        let middle: DVec3 = contact.points.iter().map(|(weight, point)| *point * *weight).sum();
        let arm = correction.transform_point3(middle) - pivot;
        let normal = correction.transform_vector3(contact.normal);
        let slopes = [arm.cross(normal), normal];
        let numbers = slopes.iter().flat_map(DVec3::to_array);
        self.shared.extend(numbers.enumerate().map(|(k, slope)| (first + k, slope)));
    }
}
