//! The residuals of one frame, and its normal equations.

use crate::error::Result;
use crate::geometry::correspondence::{Correspondence, DrawnPlace, ViewMatcher};
use crate::geometry::drawn_term::DrawnTerm;
use crate::geometry::self_collision::{Penetration, penetrations};
use crate::geometry::shape_parameters::PrimitiveSlopes;
use crate::priors::gaussian::GaussianPenalty;
use crate::priors::nuisance::ExtrinsicsCorrection;
use crate::solver::jacobian::{Place, Rows};
use crate::solver::landmark_residuals::{LandmarkResiduals, Slots};
use crate::solver::matched_frame::{FramePoint, MatchedBoundary, MatchedFrame};
use crate::solver::normal_equations::NormalEquations;
use crate::solver::problem::Frame;

impl FramePoint<'_> {
    /// The energy of the frame and its normal equations.
    pub(crate) fn linearised(self, views: &mut [ViewMatcher]) -> Result<NormalEquations> {
        let matched = self.matched(views, f64::INFINITY)?.expect("no energy is above infinity");
        Ok(matched.linearised(views))
    }
}

impl MatchedFrame<'_> {
    /// The energy of the frame and its normal equations; `views` are those that were matched.
    pub(crate) fn linearised(mut self, views: &[ViewMatcher]) -> NormalEquations {
        let mut system = std::mem::take(&mut self.prior);
        let FramePoint { problem, parameters, shared, .. } = self.at;
        let twists = self.hand.twists(&parameters.pose, problem.rest);
        let mut rows = Rows::new(self.frame().prior.dofs(), &twists);
        let (given, pose, rest) = (problem.given, &parameters.pose, problem.rest);
        let slopes =
            problem.freedom.hand.map(|_| shared.shape.slopes(given, pose, rest, &self.posed));
        let slopes = slopes.as_deref();
        for (v, view) in views.iter().enumerate() {
            self.add_boundary(&mut system, v, view, slopes, &mut rows);
            if self.at.loss.drawn == DrawnTerm::Area {
                self.add_areas(&mut system, v, view, slopes, &mut rows);
            }
        }
        self.add_landmarks(&mut system, &mut rows);
        for penetration in penetrations(&self.posed) {
            rows.of_penetration(&penetration, &self.posed, slopes);
            let Penetration { excess, .. } = penetration;
            system.add(excess, penetration.energy(), Penetration::WEIGHT, &rows.own, &rows.shared);
        }
        system
    }

    /// Adds how far a view's observed boundary is from the hand.
    fn add_boundary(
        &self,
        system: &mut NormalEquations,
        v: usize,
        view: &ViewMatcher,
        slopes: Option<&[PrimitiveSlopes]>,
        rows: &mut Rows,
    ) {
        let MatchedBoundary { nearer, distances, margin, weights, .. } = &self.boundaries[v];
        let loss = self.at.loss;
        system.begin_boundary(*weights);
        let known = GaussianPenalty::new(*margin, loss.margin);
        system.add_penalties(self.frame().prior.dofs().len() + v, &[known]);
        for (found, distance) in view.correspondences.iter().zip(distances) {
            let residual = distance - margin;
            self.distance_rows(v, found, slopes, -1.0, rows);
            rows.of_translation(*distance * *nearer);
            let (energy, weight) = (loss.energy(residual), loss.weight(residual));
            system.add_boundary_residual(residual, energy, weight, &rows.own, &rows.shared);
        }
    }

    /// Adds the areas between a view's silhouettes: what they cost, and how that changes as the drawn outline moves along
    /// its normals.
    fn add_areas(
        &self,
        system: &mut NormalEquations,
        v: usize,
        view: &ViewMatcher,
        slopes: Option<&[PrimitiveSlopes]>,
        rows: &mut Rows,
    ) {
        let MatchedBoundary { areas, grain, .. } = &self.boundaries[v];
        system.add_areas(*areas);
        for DrawnPlace { drawn, outside, length } in &view.drawn_places {
            let residual = -outside / grain;
            self.distance_rows(v, drawn, slopes, 0.0, rows);
            let weight = length * self.at.loss.area_weight(residual.abs());
            system.add_area_slope(residual, weight, &rows.own, &rows.shared);
        }
    }

    /// The slopes of how far outside the hand a place of a view is; `of_margin` is that by the view's margin.
    fn distance_rows(
        &self,
        v: usize,
        found: &Correspondence,
        slopes: Option<&[PrimitiveSlopes]>,
        of_margin: f64,
        rows: &mut Rows,
    ) {
        let FramePoint { parameters, shared, .. } = self.at;
        let MatchedBoundary { place, scale, .. } = &self.boundaries[v];
        let contact = place.contact(found, &self.posed, *scale);
        let of_camera = ExtrinsicsCorrection::NUMBERS * v;
        rows.clear();
        rows.of_pose(&contact);
        rows.own.push((self.frame().prior.dofs().len() + v, of_margin));
        if !parameters.corrections.is_empty() {
            rows.own.extend(place.row(&contact, self.at.first_correction() + of_camera));
        }
        if let Some(slopes) = slopes {
            rows.of_shape(&contact, &slopes[found.primitive], *scale);
        }
        if !shared.corrections.is_empty() {
            rows.shared.extend(place.row(&contact, self.at.of_hand() + of_camera));
        }
    }

    /// Adds how far landmarks are from their joints.
    fn add_landmarks(&self, system: &mut NormalEquations, rows: &mut Rows) {
        let FramePoint { problem, parameters, shared, loss, .. } = self.at;
        let evidence = &self.frame().evidence;
        let joint_slopes = match problem.freedom.hand {
            Some(_) if !evidence.landmarks.is_empty() => {
                Some(shared.shape.joint_slopes(problem.given, &parameters.pose, problem.rest))
            }
            _ => None,
        };
        for (k, seen) in evidence.landmarks.iter().enumerate() {
            let v = evidence.place_of(k);
            let place = Place::new(seen.camera(), self.at.correction(v), problem.rest.translation);
            let of_place = ExtrinsicsCorrection::NUMBERS * v;
            let slots = Slots {
                own_place: (!parameters.corrections.is_empty())
                    .then_some(self.at.first_correction() + of_place),
                shared_place: (!shared.corrections.is_empty())
                    .then_some(self.at.of_hand() + of_place),
                shape: joint_slopes.as_deref(),
            };
            let residuals = LandmarkResiduals::new(seen, place, &self.posed, loss);
            residuals.add_to(system, &self.posed, evidence.views(), &slots, rows);
        }
    }

    fn frame(&self) -> &Frame<'_> {
        &self.at.problem.frames[self.at.frame]
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;
    use glam::{DVec2, DVec3};
    use phalanx_camera::{Camera, Distortion, Intrinsics, Rig};
    use phalanx_hand::{Digit, Dof, HandShape, Landmark, Pose};
    use phalanx_render::Renderer;
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::self_collision;
    use crate::geometry::sphere_hull::SphereHull;
    use crate::observation::evidence::Evidence;
    use crate::observation::landmarks::LandmarkObservation;
    use crate::observation::silhouette::SilhouetteObservation;
    use crate::priors::nuisance::{CameraMotion, ExtrinsicsPrior, ShapePrior};
    use crate::priors::pose::PosePrior;
    use crate::solver::loss::RobustLoss;
    use crate::solver::matched_frame::DistanceAt;
    use crate::solver::problem::{FrameParameters, FreeParameters, Problem, SharedParameters};

    fn rig() -> Rig {
        Rig::from_toml(include_str!("../../fixtures/desk.toml")).unwrap()
    }

    fn seen(
        camera: &Camera,
        hand: &HandShape,
        pose: &Pose,
        rest: &DAffine3,
    ) -> SilhouetteObservation {
        let primitives = hand.pose(pose, rest).primitives;
        let mask = Renderer::new(camera).unwrap().silhouette(&primitives).unwrap();
        SilhouetteObservation::new(camera, &mask.into()).unwrap()
    }

    /// The joints as a camera with a lens sees them, each off its place, and some not seen.
    fn points(
        camera: &Camera,
        hand: &HandShape,
        pose: &Pose,
        rest: &DAffine3,
    ) -> LandmarkObservation {
        let mut camera = camera.clone();
        camera.intrinsics.lens = Distortion { k1: -0.1, p1: 0.01, ..Distortion::NONE }.into();
        let mut joints = hand.pose(pose, rest).joints.into_iter().enumerate();
        let landmarks = std::array::from_fn(|_| {
            let (k, joint) = joints.next()?;
            let off = DVec2::from_angle(k as f64) * (0.3 * k as f64);
            let at = camera.project(joint)? + off;
            (k % 5 != 3).then_some(Landmark { at, confidence: 1.0 - 0.03 * k as f64 })
        });
        LandmarkObservation::new(&camera, &landmarks, 1.5).unwrap().weighted(0.7)
    }

    /// The energy of the boundary when the same rays are held against the same primitives.
    fn energy(
        problem: &Problem<'_>,
        parameters: &FrameParameters,
        shared: &SharedParameters,
        loss: RobustLoss,
        views: &[ViewMatcher],
    ) -> f64 {
        let hand = shared.shape.hand(problem.given);
        let posed = hand.pose(&parameters.pose, problem.rest);
        let mut energy = self_collision::energy(&posed);
        let Evidence { silhouettes, landmarks } = problem.frames[0].evidence;
        let pivot = problem.rest.translation;
        let distance_at = DistanceAt::of(problem, 0, parameters);
        let correction = |v: usize| parameters.corrections.get(v).or(shared.corrections.get(v));
        for (k, seen) in landmarks.iter().enumerate() {
            let motion = problem.motion(parameters, shared, problem.frames[0].evidence.place_of(k));
            let loss = loss.of_landmarks(seen.std());
            for (point, joint) in seen.points().iter().zip(posed.joints) {
                let Some(point) = point else { continue };
                let drawn = seen.camera().project(motion.transform_point3(joint)).unwrap();
                energy += seen.weight() * point.confidence * loss.energy(drawn.distance(point.at));
            }
        }
        for (v, (view, evidence)) in views.iter().zip(silhouettes).enumerate() {
            let place = Place::new(evidence.camera(), correction(v), pivot);
            let scale = evidence.pixels_per_mm(distance_at.point());
            let extrinsics = &evidence.camera().extrinsics;
            let to_camera =
                DAffine3::from_mat3_translation(extrinsics.rotation, extrinsics.translation);
            let primitives = place.seen(&posed.primitives);
            let distance = |found: &Correspondence| {
                let hull = SphereHull::new(&primitives[found.primitive].moved(&to_camera));
                scale * hull.closest_approach(found.ray).distance
            };
            let distances: Vec<f64> = view.correspondences.iter().map(distance).collect();
            let margin = loss.margin(&distances);
            energy += GaussianPenalty::new(margin, loss.margin).energy;
            energy += distances.iter().map(|d| loss.energy(d - margin)).sum::<f64>();
        }
        energy
    }

    #[derive(Debug, Clone, Copy)]
    enum SeenAs {
        Silhouettes,
        OneSilhouette,
        Landmarks,
        Both,
    }

    /// The slope of the areas between silhouettes, by each number of a pose, is what a small change of the number adds to
    /// them: a finger that was not seen where it is drawn, one that was seen where none is drawn, and a hand that was seen
    /// elsewhere.
    #[test]
    fn areas_change_as_their_slope_foretells() {
        let (given, rest) = (HandShape::adult(), DAffine3::IDENTITY);
        let intrinsics = Intrinsics::pinhole(640, 480, 800.0);
        let camera = [250.0, 450.0, 90.0].into();
        let camera = Camera::look_at("one", intrinsics, camera, DVec3::Z * 80.0, DVec3::Z).unwrap();
        let mut truth = Pose::REST;
        truth[Dof::IndexMcp] = 0.9;
        truth[Dof::TX] = 6.0;
        let mut pose = Pose::REST;
        pose[Dof::RingMcp] = 0.7;
        let evidence = [seen(&camera, &given, &truth, &rest)];
        let prior = PosePrior::independent(pose, &[1e6; Dof::COUNT]).unwrap();
        let frames = vec![Frame { evidence: Evidence::from(&evidence[..]), prior: &prior }];
        let freedom = FreeParameters::default();
        let problem = Problem { given: &given, rest: &rest, frames, freedom };
        let loss = RobustLoss {
            reach: 12.0,
            noise: 0.5,
            margin: 1.0,
            every: 1,
            disagreement: f64::INFINITY,
            drawn: DrawnTerm::Area,
        };
        let mut views = [ViewMatcher::new(&evidence[0], loss.noise).unwrap()];
        let shared = problem.shared();
        let mut linearised = |pose: &Pose, with_slope: bool| {
            let parameters = problem.frame_parameters(0, pose);
            let (problem, parameters, shared) = (&problem, &parameters, &shared);
            let at = FramePoint { problem, frame: 0, parameters, shared, loss };
            let matched = at.matched(&mut views, f64::INFINITY).unwrap().unwrap();
            if !with_slope {
                views[0].drawn_places.clear();
            }
            matched.linearised(&views)
        };
        let (with, without) = (linearised(&pose, true), linearised(&pose, false));
        for (dof, step) in [
            (Dof::IndexMcp, 0.05),
            (Dof::IndexAbduction, 0.05),
            (Dof::RingMcp, 0.05),
            (Dof::TX, 2.0),
            (Dof::TY, 2.0),
            (Dof::ThetaZ, 0.03),
        ] {
            let slope = with.own_gradient()[dof.index()] - without.own_gradient()[dof.index()];
            let mut areas = |offset: f64| {
                let mut pose = pose;
                pose[dof] += offset;
                linearised(&pose, true).boundaries[0].areas
            };
            let foretold = (areas(step) - areas(-step)) / (2.0 * step);
            assert!(foretold.abs() > 100.0, "{dof}: {foretold} says nothing");
            // A millimetre is taken to be as wide as at the hand's place at rest, wherever on the hand it is.
            let off = (slope - foretold).abs() / foretold.abs();
            assert!(off < 0.2, "{dof}: {slope} {foretold}");
        }
    }

    proptest! {
        #![proptest_config(crate::property::cases(24))]

        #[test]
        fn the_gradient_is_that_of_the_energy(
            true_pose in prop::array::uniform20(-0.1..0.9_f64),
            offset in prop::array::uniform20(-0.2..0.2_f64),
            global in prop::array::uniform8(-0.1..0.1_f64),
            moves in prop_oneof![Just(CameraMotion::Static), Just(CameraMotion::PerFrame)],
            crossed in any::<bool>(),
            seen_as in prop_oneof![
                Just(SeenAs::Silhouettes), Just(SeenAs::OneSilhouette),
                Just(SeenAs::Landmarks), Just(SeenAs::Both),
            ],
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
                prop_assume!(penetrations(&given.pose(&pose, &rest)).count() > 0);
            }
            let evidence: Vec<SilhouetteObservation> =
                rig.cameras.iter().map(|camera| seen(camera, &given, &truth, &rest)).collect();
            let mut cameras = rig.cameras.clone();
            // One of a camera without a silhouette.
            cameras[0].name = "another".to_owned();
            let landmarks: Vec<LandmarkObservation> =
                cameras.iter().map(|camera| points(camera, &given, &truth, &rest)).collect();
            let evidence = match seen_as {
                SeenAs::Silhouettes => Evidence::from(&evidence),
                SeenAs::OneSilhouette => Evidence { silhouettes: &evidence[..1], landmarks: &[] },
                SeenAs::Landmarks => Evidence::from(&landmarks),
                SeenAs::Both => Evidence { silhouettes: &evidence, landmarks: &landmarks[..2] },
            };
            // So vague that only the boundary has a say.
            let prior = PosePrior::independent(pose, &[1e6; Dof::COUNT]).unwrap();
            let problem = Problem {
                given: &given,
                rest: &rest,
                frames: vec![Frame { evidence, prior: &prior }],
                freedom: FreeParameters {
                    hand: Some(ShapePrior { size: 1e6, thickness: 1e6, each: 1e6 }),
                    cameras: Some(ExtrinsicsPrior { turn: 1e6, shift: 1e6, motion: moves }),
                },
            };
            let loss = RobustLoss { reach: 3.0, noise: 0.5, margin: 1.0, every: 7, disagreement: f64::INFINITY, drawn: DrawnTerm::Outline };
            let (parameters, shared) = (problem.frame_parameters(0, &pose), problem.shared());
            let mut views: Vec<ViewMatcher> =
                evidence.silhouettes.iter().map(|own| ViewMatcher::new(own, loss.noise).unwrap()).collect();
            let at = FramePoint { problem: &problem, frame: 0, parameters: &parameters, shared: &shared, loss };
            let system = at.linearised(&mut views).unwrap();
            // It is looked at no further once it is surely above an energy.
            prop_assert!(at.matched(&mut views.clone(), system.energy).unwrap().is_some());
            let nothing = at.matched(&mut views.clone(), 0.0).unwrap();
            prop_assert!(nothing.is_none() || evidence.silhouettes.is_empty());
            // Where a ray goes just through the axis of a solid, distances have a kink.
            let within = |slope: f64, gradient: f64| {
                (slope - gradient).abs() <= 2e-2 * (1.0 + slope.abs().max(gradient.abs()))
            };
            let step = 1e-5;
            let slope = |change: &dyn Fn(&mut FrameParameters, &mut SharedParameters, f64)| {
                let at = |step: f64| {
                    let (mut parameters, mut shared) = (parameters.clone(), shared.clone());
                    change(&mut parameters, &mut shared, step);
                    energy(&problem, &parameters, &shared, loss, &views)
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
                let slope = slope(&|parameters, _, step| parameters.pose[dof] += step);
                let gradient = system.own_gradient()[k];
                prop_assert!(agree(slope, gradient), "{dof}: {slope:?} is not {gradient}");
            }
            let bones = shared.shape.logarithms.len();
            // The last two are the forearm's, whose end moves with its width.
            for number in 0..bones - 2 {
                let slope =
                    slope(&|_, shared, step| shared.shape.logarithms[number] += step);
                let gradient = system.shared_gradient()[number];
                // The size changes the forearm too.
                let alike = number == 0 || agree(slope, gradient);
                prop_assert!(alike, "bone {number}: {slope:?} is not {gradient}");
            }
            for v in 0..evidence.views() {
                let slope = slope(&|parameters, shared, step| {
                    let corrections = match moves {
                        CameraMotion::Static => &mut shared.corrections,
                        CameraMotion::PerFrame => &mut parameters.corrections,
                    };
                    corrections[v].turn.x += step;
                });
                let gradient = match moves {
                    CameraMotion::Static => system.shared_gradient()[bones + 6 * v],
                    CameraMotion::PerFrame => {
                        system.own_gradient()[Dof::COUNT + evidence.silhouettes.len() + 6 * v]
                    }
                };
                prop_assert!(agree(slope, gradient), "camera {v}: {slope:?} is not {gradient}");
            }
            prop_assert!(jumps <= 10, "{jumps} jumps");
        }
    }
}
