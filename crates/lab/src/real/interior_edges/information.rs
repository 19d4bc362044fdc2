//! What edges inside the silhouettes say of a pose: a Gaussian, linearised about a pose.

use anyhow::{Context, Result};
use faer::linalg::solvers::{DenseSolveCore, Solve};
use faer::{Mat, Side};
use glam::{DAffine3, DVec3};
use phalanx_camera::Camera;
use phalanx_hand::{Dof, HandShape, Pose, PosedHand, Primitive, Twists};
use phalanx_refine::PosePrior;

use super::crease::{Crease, creases};
use super::photograph::Photograph;

/// Edges are looked for so far from where they are drawn, mm: half a finger's width.
const REACH_MM: f64 = 8.0;

/// What is known of a number without edges, over what is known beforehand.
const NOTHING: f64 = 1e-3;

/// Millimetres by which a point is moved to see how that changes its place in a picture.
const SMALL_MM: f64 = 1e-3;

/// A view's photograph.
pub(super) struct Seen<'a> {
    pub(super) camera: &'a Camera,
    pub(super) photograph: Photograph,
}

/// The edges of some views about a pose, as a Gaussian over the numbers that `prior` leaves open, and how many were
/// found. An edge is known to a standard deviation of `noise` px.
///
/// # Errors
/// A hand that a camera cannot draw.
pub(super) fn of_edges(
    views: &[Seen<'_>],
    hand: &HandShape,
    rest: &DAffine3,
    pose: &Pose,
    prior: &PosePrior,
    noise: f64,
) -> Result<(PosePrior, usize)> {
    let (posed, twists) = (hand.pose(pose, rest), hand.twists(pose, rest));
    let dofs = prior.dofs();
    let mut information = Mat::<f64>::zeros(dofs.len(), dofs.len());
    let mut pull = Mat::<f64>::zeros(dofs.len(), 1);
    for (k, &dof) in dofs.iter().enumerate() {
        information[(k, k)] = NOTHING / prior.deviation(dof).powi(2);
    }
    let mut found = 0;
    for view in views {
        let Some(scale) = pixels_per_mm(view.camera, posed.joints[9]) else { continue };
        let reach = REACH_MM * scale;
        for crease in creases(view.camera, &posed, reach)? {
            let Some(apart) = view.photograph.edge(crease.at, crease.normal, reach) else {
                continue;
            };
            found += 1;
            let falls = 1.0 / (1.0 + (2.0 * apart / reach).powi(2));
            let weight = falls * falls / (noise * noise);
            let row: Vec<f64> =
                dofs.iter().map(|&dof| slope(view.camera, &crease, &posed, &twists, dof)).collect();
            for (i, a) in row.iter().enumerate() {
                pull[(i, 0)] += weight * a * apart;
                for (j, b) in row.iter().enumerate() {
                    information[(i, j)] += weight * a * b;
                }
            }
        }
    }
    let factor = information.llt(Side::Lower).ok().context("edges say nothing that is finite")?;
    let (step, covariance) = (factor.solve(&pull), factor.inverse());
    let mut mean = *pose;
    for (k, &dof) in dofs.iter().enumerate() {
        mean[dof] += step[(k, 0)];
    }
    let count = dofs.len();
    let covariance: Vec<f64> =
        (0..count * count).map(|k| covariance[(k % count, k / count)]).collect();
    Ok((PosePrior::correlated(mean, dofs, &covariance)?, found))
}

/// How far a crease moves along its normal as a number of the pose grows, px.
fn slope(camera: &Camera, crease: &Crease, hand: &PosedHand, twists: &Twists, dof: Dof) -> f64 {
    let velocity = velocity(crease, hand, twists, dof);
    let Some(speed) = velocity.try_normalize() else { return 0.0 };
    let place = |along: f64| camera.project(crease.point + speed * along);
    let moved = place(SMALL_MM).zip(place(-SMALL_MM)).map(|(to, from)| to - from);
    let moved = moved.unwrap_or_default() / (2.0 * SMALL_MM) * velocity.length();
    moved.dot(crease.normal)
}

/// How the place of a crease moves as a number of the pose grows, mm: as the spheres that it lies between do.
fn velocity(crease: &Crease, hand: &PosedHand, twists: &Twists, dof: Dof) -> DVec3 {
    let primitive = &hand.primitives[crease.primitive];
    let spheres = primitive.spheres();
    let of_sphere = |k: usize| {
        let is_moved = hand.bones[crease.primitive][k].is_moved_by(dof);
        if is_moved { twists.of(dof).velocity(spheres[k].center) } else { DVec3::ZERO }
    };
    if let Primitive::RoundCone([a, b]) = primitive {
        let axis = b.center - a.center;
        let along = (crease.point - a.center).dot(axis) / axis.length_squared();
        return of_sphere(0).lerp(of_sphere(1), along.clamp(0.0, 1.0));
    }
    let apart = |k: &usize| crease.point.distance(spheres[*k].center);
    let nearest = (0..spheres.len()).min_by(|a, b| apart(a).total_cmp(&apart(b)));
    of_sphere(nearest.unwrap_or(0))
}

/// How many pixels a millimetre is at a point.
fn pixels_per_mm(camera: &Camera, at: DVec3) -> Option<f64> {
    let beside = at + DVec3::new(1.0, 1.0, 1.0).cross(at - camera.centre()).normalize();
    Some(camera.project(beside)?.distance(camera.project(at)?))
}

#[cfg(test)]
mod tests {
    use image::{GrayImage, Luma};
    use phalanx::Mask;
    use phalanx_camera::Intrinsics;
    use phalanx_hand::{Bone, Digit};
    use phalanx_render::Renderer;

    use super::*;

    /// A finger that is folded before the palm lies inside the silhouette; here it is brighter than the palm.
    #[test]
    fn edges_pull_a_folded_finger_to_where_it_is_seen() {
        let (hand, rest) = (HandShape::adult(), DAffine3::IDENTITY);
        let at = [0.0, -450.0, 90.0].into();
        let intrinsics = Intrinsics::pinhole(320, 240, 500.0);
        let camera = Camera::look_at("palm", intrinsics, at, 80.0 * DVec3::Z, DVec3::Z).unwrap();
        let mut truth = Pose::REST;
        (truth[Dof::IndexMcp], truth[Dof::IndexPip]) = (1.2, 1.0);
        let posed = hand.pose(&truth, &rest);
        let is_index = |bone: &Bone| matches!(bone, Bone::Segment(Digit::Index, _));
        let solids = posed.primitives.iter().zip(&posed.bones);
        let of_index = solids.filter(|(_, bones)| bones.iter().all(is_index));
        let of_index: Vec<Primitive> = of_index.map(|(solid, _)| *solid).collect();
        let mut renderer = Renderer::new(&camera).unwrap();
        let mut drawn = |solids: &[Primitive]| Mask::from(renderer.silhouette(solids).unwrap());
        let (whole, index) = (drawn(&posed.primitives), drawn(&of_index));
        let levels =
            GrayImage::from_fn(320, 240, |x, y| Luma([if index.is_hand(x, y) { 180 } else { 90 }]));
        let mut deviations = [0.0; Dof::COUNT];
        deviations[Dof::IndexMcp.index()] = 0.3;
        for off in [-0.1, 0.1] {
            let mut pose = truth;
            pose[Dof::IndexMcp] += off;
            let prior = PosePrior::independent(pose, &deviations).unwrap();
            let photograph = Photograph::new(&levels.clone().into(), whole.hand_pixels());
            let views = [Seen { camera: &camera, photograph }];
            let (known, found) = of_edges(&views, &hand, &rest, &pose, &prior, 1.0).unwrap();
            let left = known.mean()[Dof::IndexMcp] - truth[Dof::IndexMcp];
            assert!(found > 10 && left.abs() < 0.5 * off.abs(), "{found} edges: {off} {left}");
        }
    }
}
