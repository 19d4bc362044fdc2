//! Where a hand is and how its arm is turned, before anything is refined: a start for
//! refinement.
//!
//! The paper proposes it (§ 3): "a more accurate global orientation can be obtained by
//! triangulation when multiple views are used".

use glam::{DVec2, DVec3};
use phalanx_camera::{Rig, triangulate};
use phalanx_hand::{Dof, HandShape, Pose, Primitive, Side};

use crate::error::{Error, Result};
use crate::localize::sighting::{Sighting, arm};
use crate::window::PicturedHand;

/// A pose whose global part was found from the hands' places in the views.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GlobalStart {
    /// The pose: the given one with another position, θ_X and θ_Y.
    pub pose: Pose,
    /// Root mean square by which the wrist's rays miss its place, mm; of a single view 0.
    pub miss: f64,
}

/// Places a hand whose fingers and θ_Z are known roughly, as by regression: position from the
/// wrist's places in the views, θ_X and θ_Y from the arm's directions in them.
///
/// With two or more views the wrist's rays and the planes of the arm are intersected. With one
/// view the arm is taken to be as nearly as it can be where it is at rest, and the distance
/// follows from the hand's size.
///
/// `hands` holds the hand in each view's picture ([`Window::pictured_hand`](crate::Window::pictured_hand)), or
/// nothing where it is not seen. Pictures may have any size.
///
/// # Errors
/// No view, cameras whose rays are parallel, or a wrist where a lens maps nothing.
pub fn initial_global(
    rig: &Rig,
    hand: &HandShape,
    fingers: &Pose,
    hands: &[Option<PicturedHand>],
) -> Result<GlobalStart> {
    let seen = hands.iter().flatten();
    let views: Vec<Sighting> =
        seen.map(|seen| Sighting::new(&seen.camera, &seen.hand)).collect::<Result<_>>()?;
    match views.as_slice() {
        [] => Err(Error::Mismatch { part: "views with a hand", found: 0, expected: 1 }),
        [view] => Ok(one_view(rig, hand, fingers, view)),
        views => {
            let met = triangulate(&views.iter().map(|view| view.wrist).collect::<Vec<_>>())?;
            let rest = rig.volume.rest_frame().matrix3.z_axis;
            // Where the planes are all but parallel, the direction at rest decides.
            let direction = arm(views).unwrap_or_else(|| views[0].in_plane(rest));
            Ok(GlobalStart {
                pose: placed(rig, hand, fingers, met.point, direction),
                miss: met.spread,
            })
        }
    }
}

/// The start from a single view.
fn one_view(rig: &Rig, hand: &HandShape, fingers: &Pose, view: &Sighting<'_>) -> GlobalStart {
    let direction = view.in_plane(rig.volume.rest_frame().matrix3.z_axis);
    let ray = view.wrist;
    let mut distance = (rig.volume.center - ray.origin).dot(ray.direction).max(1.0);
    let mut pose = *fingers;
    // The length in the picture goes with one over the distance; perspective makes it take a few
    // rounds.
    for _ in 0..4 {
        pose = placed(rig, hand, fingers, ray.origin + ray.direction * distance, direction);
        let Some(length) = length_in_picture(rig, hand, &pose, view) else { break };
        distance *= (length / view.hand.length).clamp(0.25, 4.0);
    }
    GlobalStart { pose, miss: 0.0 }
}

/// How far the posed hand reaches beyond its wrist along the arm in a view, px.
fn length_in_picture(rig: &Rig, hand: &HandShape, pose: &Pose, view: &Sighting<'_>) -> Option<f64> {
    let posed = hand.pose(pose, &rig.volume.rest_frame());
    let wrist = view.camera.project(posed.joints[0])?;
    let along = DVec2::from_array(view.hand.direction);
    let is_arm = |solid: &&Primitive| matches!(solid, Primitive::GeneralisedCylinder { .. });
    let spheres =
        posed.primitives.iter().filter(|solid| !is_arm(solid)).flat_map(Primitive::spheres);
    spheres
        .map(|ball| {
            let depth = view.camera.extrinsics.to_camera(ball.center).z;
            let radius = ball.radius * view.camera.intrinsics.fx / depth;
            Some((view.camera.project(ball.center)? - wrist).dot(along) + radius)
        })
        .try_fold(0.0, |most: f64, reach| Some(most.max(reach?)))
        .filter(|&length| length > 0.0)
}

/// The pose with its wrist and forearm where they are in the world.
fn placed(rig: &Rig, hand: &HandShape, fingers: &Pose, wrist: DVec3, direction: DVec3) -> Pose {
    let to_rest = rig.volume.rest_frame().inverse();
    let offset = to_rest.transform_point3(wrist);
    let mut axis = to_rest.transform_vector3(direction);
    if hand.side == Side::Left {
        axis.x = -axis.x;
    }
    // R_X R_Y R_Z turns +Z to (sin θ_Y, −sin θ_X cos θ_Y, cos θ_X cos θ_Y).
    let mut pose = *fingers;
    pose[Dof::ThetaX] = (-axis.y).atan2(axis.z);
    pose[Dof::ThetaY] = axis.x.clamp(-1.0, 1.0).asin();
    [pose[Dof::TX], pose[Dof::TY], pose[Dof::TZ]] = offset.to_array();
    pose
}
