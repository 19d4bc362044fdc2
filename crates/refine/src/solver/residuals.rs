//! The energy of one frame, residual by residual, and its normal equations.

use crate::error::Result;
use crate::geometry::correspondence::View;
use crate::geometry::self_collision::{Touch, touches};
use crate::priors::gaussian::Known;
use crate::priors::nuisance::Correction;
use crate::solver::jacobian::{Place, Rows};
use crate::solver::loss::Measure;
use crate::solver::normal_equations::FrameSystem;
use crate::solver::problem::{Frame, Moment, Problem, Shared};

/// The energy of one frame and its normal equations.
pub(crate) fn linearise(
    problem: &Problem<'_>,
    frame: usize,
    moment: &Moment,
    shared: &Shared,
    measure: Measure,
    views: &mut [View],
) -> Result<FrameSystem> {
    let Frame { evidence, prior } = &problem.frames[frame];
    let hand = match problem.freedom.hand {
        Some(_) => shared.proportions.hand(problem.given),
        None => problem.given.clone(),
    };
    let posed = hand.pose(&moment.pose, problem.rest);
    let motions = hand.motions(&moment.pose, problem.rest);
    let slopes = problem
        .freedom
        .hand
        .map(|_| shared.proportions.slopes(problem.given, &moment.pose, problem.rest, &posed));
    let numbers = prior.dofs().len();
    let corrections = numbers + evidence.len();
    let of_hand = problem.freedom.hand.map_or(0, |_| shared.proportions.logarithms.len());
    let of_cameras = Correction::NUMBERS * shared.corrections.len();
    let own = corrections + Correction::NUMBERS * moment.corrections.len();
    let mut system = FrameSystem::new(own, of_hand + of_cameras);
    system.add_prior(prior, &moment.pose);
    system.add_known(corrections, &problem.known_of(&moment.corrections));
    let mut rows = Rows::new(prior.dofs());
    let views_seen = evidence.len();
    for (v, (view, evidence)) in views.iter_mut().zip(*evidence).enumerate() {
        let correction = moment.corrections.get(v).or(shared.corrections.get(v));
        let place = Place::new(evidence, correction, problem.rest.translation);
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

#[cfg(test)]
mod tests {
    use glam::DAffine3;
    use phalanx_camera::{Camera, Rig};
    use phalanx_hand::{Digit, Dof, HandShape, Pose};
    use phalanx_render::Renderer;
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::correspondence::Match;
    use crate::geometry::self_collision;
    use crate::geometry::sphere_hull::Hull;
    use crate::observation::silhouette::Evidence;
    use crate::priors::nuisance::{CameraDoubt, HandDoubt, Moves};
    use crate::priors::pose::PosePrior;
    use crate::solver::problem::Freedom;

    fn rig() -> Rig {
        Rig::from_toml(include_str!("../../fixtures/desk.toml")).unwrap()
    }

    fn seen(camera: &Camera, hand: &HandShape, pose: &Pose, rest: &DAffine3) -> Evidence {
        let solids = hand.pose(pose, rest).primitives;
        let mask = Renderer::new(camera).unwrap().silhouette(&solids).unwrap();
        Evidence::new(camera, &mask).unwrap()
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
        let mut energy = self_collision::energy(&posed);
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
            let system = linearise(&problem, 0, &moment, &shared, measure, &mut views).unwrap();
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
