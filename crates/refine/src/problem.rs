//! The energy of a fit, and its normal equations.

use std::borrow::Cow;

use glam::{DAffine3, DMat3, DVec3};
use phalanx_hand::{Dof, HandShape, Link, Motions, Pose, PosedHand, Primitive};

use crate::doubt::{CameraDoubt, Correction, HandDoubt, Moves};
use crate::proportions::{Proportions, Slope};
use crate::system::{FrameSystem, Row};
use crate::touching::{Touch, touches};
use crate::view::{Match, View};
use crate::{Evidence, PosePrior, Result};

/// One frame: what its cameras saw, and what is known of its pose.
#[derive(Clone, Copy)]
pub(crate) struct Frame<'a> {
    pub(crate) evidence: &'a [Evidence],
    pub(crate) prior: &'a PosePrior,
}

/// What is fitted besides the poses.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Freedom {
    pub(crate) hand: Option<HandDoubt>,
    pub(crate) cameras: Option<CameraDoubt>,
}

/// The unknowns of one frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Moment {
    pub(crate) pose: Pose,
    /// Of cameras that stand elsewhere in every frame; none of others.
    pub(crate) corrections: Vec<Correction>,
}

/// What all frames share.
#[derive(Debug, Clone)]
pub(crate) struct Shared {
    pub(crate) proportions: Proportions,
    /// Of cameras that stand where they stand; none of others.
    pub(crate) corrections: Vec<Correction>,
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
    /// The share of its border from which on a view that is left unexplained counts less; infinite
    /// where all views are believed.
    pub(crate) disagreement: f64,
}

impl Measure {
    pub(crate) fn energy(&self, residual: f64) -> f64 {
        let (s, r) = (self.reach * self.reach, residual * residual);
        0.5 * s * r / (s + r) * self.every as f64 / (self.noise * self.noise)
    }

    /// The share of a border that is unexplained, 0 to 1.
    pub(crate) fn unexplained(&self, energy: f64, count: usize) -> f64 {
        energy / (count.max(1) as f64 * self.most())
    }

    /// What share of its energy a view of which so much is unexplained adds to that of a pose, and of its
    /// slope: the robust measure once more, of whole views. A view that is left half of what disagrees
    /// counts fully. Of fewer than three views none is known to be wrong.
    fn belief(&self, unexplained: f64, views: usize) -> [f64; 2] {
        if views < 3 || self.disagreement.is_infinite() {
            return [1.0; 2];
        }
        let falls = 1.0 / (1.0 + unexplained / self.disagreement);
        let full = 1.5 * 1.5;
        [full * falls, full * falls * falls]
    }

    /// The energy of a residual far beyond reach.
    pub(crate) fn most(&self) -> f64 {
        0.5 * self.reach * self.reach * self.every as f64 / (self.noise * self.noise)
    }

    fn weight(&self, residual: f64) -> f64 {
        let s = self.reach * self.reach;
        let w = s / (s + residual * residual);
        w * w * self.every as f64 / (self.noise * self.noise)
    }

    /// How far a view's border lies outside the hand's, px: what segmentation adds all around or
    /// takes away. It is where the energy of a view's distances has a minimum, looked for from
    /// nothing, so that a pose has one energy, whatever was tried before it.
    pub(crate) fn margin(&self, distances: &[f64]) -> f64 {
        const CLOSE_PX: f64 = 1e-7;
        // Beyond all distances everything pulls back.
        let (mut low, mut high) =
            distances.iter().fold((0.0, 0.0), |(low, high), &d| (d.min(low), d.max(high)));
        let mut margin = 0.0;
        while high - low > CLOSE_PX {
            let (slope, curvature) = self.margin_slope(margin, distances);
            let newton = margin - slope / curvature;
            if curvature > 0.0 && (newton - margin).abs() < CLOSE_PX {
                break;
            }
            *(if slope > 0.0 { &mut high } else { &mut low }) = margin;
            let is_within = curvature > 0.0 && low < newton && newton < high;
            margin = if is_within { newton } else { 0.5 * (low + high) };
        }
        margin
    }

    /// The first and the second derivative of the energy of a view's distances by its margin.
    fn margin_slope(&self, margin: f64, distances: &[f64]) -> (f64, f64) {
        let s = self.reach * self.reach;
        let known = Known::new(margin, self.margin);
        let (mut slope, mut curvature) = (known.gradient, known.hessian);
        for distance in distances {
            let residual = distance - margin;
            let (weight, r) = (self.weight(residual), residual * residual);
            slope -= weight * residual;
            curvature += weight * (s - 3.0 * r) / (s + r);
        }
        (slope, curvature)
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
    /// The unknowns of a frame before anything is known but a pose.
    pub(crate) fn moment(&self, frame: usize, pose: &Pose) -> Moment {
        let views = self.frames[frame].evidence.len();
        let each = self.freedom.cameras.is_some_and(|doubt| doubt.moves == Moves::EveryFrame);
        Moment { pose: *pose, corrections: vec![Correction::NONE; if each { views } else { 0 }] }
    }

    /// What all frames share before anything is known.
    pub(crate) fn shared(&self) -> Shared {
        let views = self.frames.first().map_or(0, |frame| frame.evidence.len());
        let all = self.freedom.cameras.is_some_and(|doubt| doubt.moves == Moves::Never);
        Shared {
            proportions: Proportions::of(self.given),
            corrections: vec![Correction::NONE; if all { views } else { 0 }],
        }
    }

    /// How the hand seems moved in a view.
    pub(crate) fn motion(&self, moment: &Moment, shared: &Shared, view: usize) -> DAffine3 {
        let correction = moment.corrections.get(view).or(shared.corrections.get(view));
        correction.map_or(DAffine3::IDENTITY, |own| own.motion(self.rest.translation))
    }

    /// What is known of the shared numbers: their energy, and for each its Hessian and gradient.
    pub(crate) fn shared_prior(&self, shared: &Shared) -> (f64, Vec<Known>) {
        let mut known = Vec::new();
        if let Some(HandDoubt { size, each }) = self.freedom.hand {
            for (k, &logarithm) in shared.proportions.logarithms.iter().enumerate() {
                known.push(Known::new(logarithm, if k == 0 { size } else { each }));
            }
        }
        known.extend(self.known_of(&shared.corrections));
        (known.iter().map(|known| known.energy).sum(), known)
    }

    fn known_of(&self, corrections: &[Correction]) -> Vec<Known> {
        let deviations = self.freedom.cameras.map_or([1.0; 2], |doubt| [doubt.turn, doubt.shift]);
        let of = move |correction: &Correction| {
            let parts = [correction.turn, correction.shift].map(|part| part.to_array());
            let known = move |k: usize| Known::new(parts[k / 3][k % 3], deviations[k / 3]);
            (0..Correction::NUMBERS).map(known)
        };
        corrections.iter().flat_map(of).collect()
    }

    /// The energy of one frame and its normal equations.
    pub(crate) fn look(
        &self,
        frame: usize,
        moment: &Moment,
        shared: &Shared,
        measure: Measure,
        views: &mut [View],
    ) -> Result<FrameSystem> {
        let Frame { evidence, prior } = &self.frames[frame];
        let hand = match self.freedom.hand {
            Some(_) => shared.proportions.hand(self.given),
            None => self.given.clone(),
        };
        let posed = hand.pose(&moment.pose, self.rest);
        let motions = hand.motions(&moment.pose, self.rest);
        let slopes = self
            .freedom
            .hand
            .map(|_| shared.proportions.slopes(self.given, &moment.pose, self.rest, &posed));
        let numbers = prior.dofs().len();
        let corrections = numbers + evidence.len();
        let of_hand = self.freedom.hand.map_or(0, |_| shared.proportions.logarithms.len());
        let of_cameras = Correction::NUMBERS * shared.corrections.len();
        let own = corrections + Correction::NUMBERS * moment.corrections.len();
        let mut system = FrameSystem::new(own, of_hand + of_cameras);
        system.add_prior(prior, &moment.pose);
        system.add_known(corrections, &self.known_of(&moment.corrections));
        let mut rows = Rows { dofs: slots(prior.dofs()), own: Row::new(), shared: Row::new() };
        let views_seen = evidence.len();
        for (v, (view, evidence)) in views.iter_mut().zip(*evidence).enumerate() {
            let correction = moment.corrections.get(v).or(shared.corrections.get(v));
            let place = Place::new(evidence, correction, self.rest.translation);
            view.compare(&place.seen(&posed.primitives), evidence, measure.every)?;
            let distances = view.matches.iter().map(|found| place.scale * found.passing.distance);
            let distances: Vec<f64> = distances.collect();
            let margin = measure.margin(&distances);
            let energies: f64 = distances.iter().map(|d| measure.energy(d - margin)).sum();
            let unexplained = measure.unexplained(energies, distances.len());
            let belief = measure.belief(unexplained, views_seen);
            system.begin_border(belief.map(|share| share * evidence.weight()));
            system.add_known(numbers + v, &[Known::new(margin, measure.margin)]);
            for (found, distance) in view.matches.iter().zip(distances) {
                let residual = distance - margin;
                let contact = place.contact(found, &posed);
                rows.clear();
                rows.of_pose(&contact, &motions);
                rows.own.push((numbers + v, -1.0));
                if !moment.corrections.is_empty() {
                    let first = corrections + Correction::NUMBERS * v;
                    rows.own.extend(place.row(&contact, first));
                }
                if let Some(slopes) = &slopes {
                    rows.of_proportions(&contact, &slopes[found.solid], place.scale);
                }
                if !shared.corrections.is_empty() {
                    rows.shared.extend(place.row(&contact, of_hand + Correction::NUMBERS * v));
                }
                let energy = measure.energy(residual);
                let weight = measure.weight(residual);
                system.add_border(residual, energy, weight, &rows.own, &rows.shared);
            }
        }
        for touch in touches(&posed) {
            rows.of_touch(&touch, &posed, &motions, slopes.as_deref());
            let Touch { excess, .. } = touch;
            system.add(excess, touch.energy(), Touch::WEIGHT, &rows.own, &rows.shared);
        }
        Ok(system)
    }
}

/// What is known of a number: that it is 0 to a standard deviation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Known {
    pub(crate) energy: f64,
    pub(crate) gradient: f64,
    pub(crate) hessian: f64,
}

impl Known {
    fn new(value: f64, deviation: f64) -> Self {
        let hessian = deviation.powi(-2);
        Self { energy: 0.5 * value * value * hessian, gradient: value * hessian, hessian }
    }
}

/// Pixels that a millimetre is wide at a point of the world, over the border's grain.
pub(crate) fn place_scale(evidence: &Evidence, at: DVec3) -> f64 {
    let camera = evidence.camera();
    let focal = (camera.intrinsics.fx * camera.intrinsics.fy).sqrt();
    focal / camera.extrinsics.to_camera(at).length() / evidence.grain()
}

/// Where a camera stands.
struct Place<'a> {
    evidence: &'a Evidence,
    /// The motion that its correction gives the hand.
    motion: Option<DAffine3>,
    /// What the motion turns about.
    pivot: DVec3,
    /// Pixels that a millimetre is wide there, over the border's grain.
    scale: f64,
    /// From the camera's directions to the world's, as they are before the motion.
    back: DMat3,
}

impl<'a> Place<'a> {
    fn new(evidence: &'a Evidence, correction: Option<&Correction>, pivot: DVec3) -> Self {
        let camera = evidence.camera();
        let motion = correction.map(|correction| correction.motion(pivot));
        let turned = motion.map_or(DMat3::IDENTITY, |motion| motion.matrix3.transpose());
        Self {
            evidence,
            motion,
            pivot,
            scale: place_scale(evidence, pivot),
            back: turned * camera.extrinsics.rotation.transpose(),
        }
    }

    /// The solids as they seem to stand.
    fn seen<'s>(&self, solids: &'s [Primitive]) -> Cow<'s, [Primitive]> {
        match self.motion {
            Some(motion) => solids.iter().map(|solid| solid.moved(&motion)).collect(),
            None => Cow::Borrowed(solids),
        }
    }

    fn contact<'p>(&self, found: &Match, posed: &'p PosedHand) -> Contact<'p> {
        let passing = &found.passing;
        let balls = posed.primitives[found.solid].balls();
        let points = match passing.point {
            Some(point) => {
                let world = self.evidence.camera().extrinsics.to_world(point);
                let motion = self.motion.unwrap_or(DAffine3::IDENTITY);
                let nothing = (0.0, DVec3::ZERO);
                [(1.0, motion.inverse().transform_point3(world)), nothing, nothing]
            }
            None => [0, 1, 2].map(|k| (passing.weights[k], balls[k.min(balls.len() - 1)].center)),
        };
        Contact {
            links: &posed.links[found.solid],
            weights: passing.weights,
            points,
            normal: self.back * passing.normal * self.scale,
        }
    }

    /// The slopes of a correction, whose numbers begin at `first`.
    fn row(&self, contact: &Contact<'_>, first: usize) -> impl Iterator<Item = (usize, f64)> {
        let motion = self.motion.unwrap_or(DAffine3::IDENTITY);
        let middle: DVec3 = contact.points.iter().map(|(weight, point)| *point * *weight).sum();
        let arm = motion.transform_point3(middle) - self.pivot;
        let normal = motion.transform_vector3(contact.normal);
        let slopes = [arm.cross(normal).to_array(), normal.to_array()];
        (0..Correction::NUMBERS).map(move |k| (first + k, slopes[k / 3][k % 3]))
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
    own: Row,
    shared: Row,
}

impl Rows {
    fn clear(&mut self) {
        self.own.clear();
        self.shared.clear();
    }

    fn of_pose(&mut self, contact: &Contact<'_>, motions: &Motions) {
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
                    match self.own.iter_mut().find(|(other, _)| *other == slot) {
                        Some((_, sum)) => *sum += slope,
                        None => self.own.push((slot, slope)),
                    }
                }
            }
        }
        self.own.sort_unstable_by_key(|&(slot, _)| slot);
    }

    /// The slopes of how deep two digits are in each other.
    fn of_touch(
        &mut self,
        touch: &Touch,
        posed: &PosedHand,
        motions: &Motions,
        slopes: Option<&[[Vec<Slope>; 3]]>,
    ) {
        self.clear();
        for ((&solid, &place), away) in touch.solids.iter().zip(&touch.places).zip([-1.0, 1.0]) {
            let centers = [0, 1].map(|k| posed.primitives[solid].balls()[k].center);
            let weights = [1.0 - place, place, 0.0];
            let contact = Contact {
                links: &posed.links[solid],
                weights,
                points: [(1.0 - place, centers[0]), (place, centers[1]), (0.0, DVec3::ZERO)],
                normal: touch.apart * away,
            };
            self.of_pose(&contact, motions);
            if let Some(slopes) = slopes {
                self.of_proportions(&contact, &slopes[solid], 0.0);
                // It is as thick as on average.
                let thick = Contact { weights: [0.5, 0.5, 0.0], normal: DVec3::ZERO, ..contact };
                self.of_proportions(&thick, &slopes[solid], -1.0);
            }
        }
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
}

#[cfg(test)]
mod tests {
    use phalanx_camera::{Camera, Rig};
    use phalanx_hand::Digit;
    use phalanx_render::Renderer;
    use proptest::prelude::*;

    use super::*;
    use crate::hull::Hull;
    use crate::touching;

    fn rig() -> Rig {
        Rig::from_toml(include_str!("../fixtures/desk.toml")).unwrap()
    }

    fn seen(camera: &Camera, hand: &HandShape, pose: &Pose, rest: &DAffine3) -> Evidence {
        let solids = hand.pose(pose, rest).primitives;
        let mask = Renderer::new(camera).unwrap().silhouette(&solids).unwrap();
        Evidence::new(camera, &mask).unwrap()
    }

    #[test]
    fn a_margin_is_where_the_energy_is_least() {
        let measure =
            Measure { reach: 1.0, noise: 0.5, margin: 1.0, every: 1, disagreement: f64::INFINITY };
        assert_eq!(measure.margin(&[]), 0.0);
        assert_eq!(measure.margin(&[0.0; 9]), 0.0);
        for (offset, noise) in [(0.3, 0.4), (-0.8, 0.1), (6.0, 0.3), (-20.0, 3.0)] {
            let noise = |k: u32| noise * (f64::from(k) * 2.4).sin();
            let distances: Vec<f64> = (0..300).map(|k| offset + noise(k)).collect();
            let margin = measure.margin(&distances);
            let (slope, curvature) = measure.margin_slope(margin, &distances);
            assert!(slope.abs() < 1e-3 && curvature > 0.0, "{offset}: {margin}, {slope}");
        }
    }

    /// The energy of the border when the same rays are held against the same solids.
    fn energy(
        problem: &Problem<'_>,
        moment: &Moment,
        shared: &Shared,
        measure: Measure,
        views: &[View],
    ) -> f64 {
        let hand = shared.proportions.hand(problem.given);
        let posed = hand.pose(&moment.pose, problem.rest);
        let mut energy = touching::energy(&posed);
        for (v, (view, evidence)) in views.iter().zip(problem.frames[0].evidence).enumerate() {
            let correction = moment.corrections.get(v).or(shared.corrections.get(v));
            let place = Place::new(evidence, correction, problem.rest.translation);
            let extrinsics = &evidence.camera().extrinsics;
            let to_camera =
                DAffine3::from_mat3_translation(extrinsics.rotation, extrinsics.translation);
            let solids = place.seen(&posed.primitives);
            let distance = |found: &Match| {
                let hull = Hull::new(&solids[found.solid].moved(&to_camera));
                place.scale * hull.pass(found.ray).distance
            };
            let distances: Vec<f64> = view.matches.iter().map(distance).collect();
            let margin = measure.margin(&distances);
            energy += Known::new(margin, measure.margin).energy;
            energy += distances.iter().map(|d| measure.energy(d - margin)).sum::<f64>();
        }
        energy
    }

    proptest! {
        #![proptest_config(crate::property::cases(12))]

        #[test]
        fn the_gradient_is_that_of_the_energy(
            true_pose in prop::array::uniform20(-0.1..0.9_f64),
            offset in prop::array::uniform20(-0.2..0.2_f64),
            global in prop::array::uniform8(-0.1..0.1_f64),
            moves in prop_oneof![Just(Moves::Never), Just(Moves::EveryFrame)],
            crossed in any::<bool>(),
        ) {
            let (rig, given) = (rig(), HandShape::adult());
            let rest = rig.volume.rest_frame();
            let mut truth = Pose::REST;
            truth.0[..20].copy_from_slice(&true_pose);
            let mut pose = truth;
            pose.0.iter_mut().zip(offset).for_each(|(angle, offset)| *angle += offset);
            pose.0[20..].iter_mut().zip(global).for_each(|(number, offset)| *number += offset);
            if crossed {
                let (one, other) = (Digit::Index.dofs(), Digit::Middle.dofs());
                for (&one, other) in one[1..].iter().zip(&other[1..]) {
                    pose[one] = pose[*other] + 0.01;
                }
                [pose[one[0]], pose[other[0]]] = [-0.25, 0.25];
                prop_assume!(touches(&given.pose(&pose, &rest)).count() > 0);
            }
            let evidence: Vec<Evidence> =
                rig.cameras.iter().map(|camera| seen(camera, &given, &truth, &rest)).collect();
            // So vague that only the border has a say.
            let prior = PosePrior::independent(pose, &[1e6; Dof::COUNT]).unwrap();
            let problem = Problem {
                given: &given,
                rest: &rest,
                frames: vec![Frame { evidence: &evidence, prior: &prior }],
                freedom: Freedom {
                    hand: Some(HandDoubt { size: 1e6, each: 1e6 }),
                    cameras: Some(CameraDoubt { turn: 1e6, shift: 1e6, moves }),
                },
            };
            let measure = Measure { reach: 3.0, noise: 0.5, margin: 1.0, every: 7, disagreement: f64::INFINITY };
            let (moment, shared) = (problem.moment(0, &pose), problem.shared());
            let mut views: Vec<View> =
                evidence.iter().map(|evidence| View::new(evidence).unwrap()).collect();
            let system = problem.look(0, &moment, &shared, measure, &mut views).unwrap();
            // Where a ray goes just through the axis of a solid, distances have a kink.
            let within = |slope: f64, gradient: f64| {
                (slope - gradient).abs() <= 2e-2 * (1.0 + slope.abs().max(gradient.abs()))
            };
            let step = 1e-5;
            let slope = |change: &dyn Fn(&mut Moment, &mut Shared, f64)| {
                let at = |step: f64| {
                    let (mut moment, mut shared) = (moment.clone(), shared.clone());
                    change(&mut moment, &mut shared, step);
                    energy(&problem, &moment, &shared, measure, &views)
                };
                let across = |step: f64| (at(step) - at(-step)) / (2.0 * step);
                // Where the energy jumps, as a solid comes before another, it has no slope: one over
                // a third of the way is another.
                let smooth = within(across(step), across(step / 3.0));
                let here = at(0.0);
                smooth.then(|| [(here - at(-step)) / step, (at(step) - here) / step])
            };
            let mut jumps = 0;
            // Where it has a kink, the gradient lies between the slopes to either side.
            let mut agree = |slopes: Option<[f64; 2]>, gradient: f64| {
                jumps += usize::from(slopes.is_none());
                slopes.is_none_or(|[left, right]| {
                    let nearest = gradient.clamp(left.min(right), left.max(right));
                    within(nearest, gradient)
                })
            };
            for (k, dof) in Dof::ALL.into_iter().enumerate() {
                // Ranges have a say of their own.
                if pose.out_of_range().contains(&dof) {
                    continue;
                }
                let slope = slope(&|moment, _, step| moment.pose[dof] += step);
                let gradient = system.own_gradient()[k];
                prop_assert!(agree(slope, gradient), "{dof}: {slope:?} is not {gradient}");
            }
            let bones = shared.proportions.logarithms.len();
            // The last two are the forearm's, whose end moves with its width.
            for number in 0..bones - 2 {
                let slope =
                    slope(&|_, shared, step| shared.proportions.logarithms[number] += step);
                let gradient = system.shared_gradient()[number];
                // The size changes the forearm too.
                let alike = number == 0 || agree(slope, gradient);
                prop_assert!(alike, "bone {number}: {slope:?} is not {gradient}");
            }
            for v in 0..evidence.len() {
                let slope = slope(&|moment, shared, step| {
                    let corrections = match moves {
                        Moves::Never => &mut shared.corrections,
                        Moves::EveryFrame => &mut moment.corrections,
                    };
                    corrections[v].turn.x += step;
                });
                let gradient = match moves {
                    Moves::Never => system.shared_gradient()[bones + 6 * v],
                    Moves::EveryFrame => {
                        system.own_gradient()[Dof::COUNT + evidence.len() + 6 * v]
                    }
                };
                prop_assert!(agree(slope, gradient), "camera {v}: {slope:?} is not {gradient}");
            }
            prop_assert!(jumps <= 10, "{jumps} jumps");
        }
    }
}
