//! Outlines of solids that reach or cross the camera's plane.
//!
//! From any point outside a convex solid a camera can look so that all of the solid is in front of
//! it: along the normal of a plane between the two. There the solid has an ordinary outline. Turned
//! back it is a cone of rays, of which the picture shows what lies in its pyramid.

use glam::{DAffine3, DMat3, DVec2, DVec3};
use phalanx_hand::Primitive;

use crate::outline;
use crate::surface::Surface;

/// Solids that stay so far in front of the camera's plane, mm, need no clipping; nothing is seen
/// nearer.
pub(crate) const NEAR: f64 = 1.0;

/// A camera's centre that is nearer to a solid than this, mm, counts as inside.
const TOUCHING: f64 = 1e-3;

/// Appends the corners of a solid's outline like [`outline::trace`], of what is in front of the
/// camera and within a square about a disc of radius `reach` of the normalised plane, which must
/// hold the picture. A solid that holds the camera's centre has the square for its outline.
pub(crate) fn trace(
    solid_in_camera: &Primitive,
    reach: f64,
    deviation: f64,
    corners: &mut Vec<DVec2>,
) {
    // The square is so large that its sides are out of sight.
    let half_side = 2.0 * reach;
    let rays = match cone(solid_in_camera, reach, deviation) {
        Some(rays) => rays,
        None => [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| DVec3::new(x * half_side, y * half_side, 1.0))
            .to_vec(),
    };
    let sides = [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y];
    let within = sides.iter().fold(rays, |rays, side| cut(&rays, side.extend(half_side)));
    corners.extend(within.iter().map(|ray| ray.truncate() / ray.z));
}

/// The unit normal, from the camera's centre to a solid, of a plane between the two; `None` where
/// the solid holds the centre.
pub(crate) fn plane_between(solid_in_camera: &Primitive) -> Option<DVec3> {
    let spheres = solid_in_camera.spheres();
    let unsquash = solid_in_camera.squash().inverse();
    let anchor = spheres[0].center;
    // Undoing the squash moves the centre, and keeps planes between.
    let centre = anchor - unsquash * anchor;
    let gap = |away: DVec3| {
        let gaps = spheres.iter().map(|sphere| away.dot(sphere.center - centre) - sphere.radius);
        gaps.fold(f64::INFINITY, f64::min)
    };
    // The widest gap is before the piece of the surface that is nearest.
    let normals = Surface::of(solid_in_camera).map(|surface| -surface.facing(centre));
    let widest = normals.map(|away| (gap(away), away)).max_by(|(a, _), (b, _)| a.total_cmp(b));
    widest.filter(|(gap, _)| *gap > TOUCHING).map(|(_, away)| (unsquash * away).normalize())
}

/// Rays along the outline of a solid, so many that in the picture, a disc of radius `reach` of the
/// normalised plane, they stay within `deviation`; `None` where the solid holds the camera's centre.
fn cone(solid_in_camera: &Primitive, reach: f64, deviation: f64) -> Option<Vec<DVec3>> {
    let ahead = plane_between(solid_in_camera)?;
    let (right, down) = ahead.any_orthonormal_pair();
    let back = DMat3::from_cols(right, down, ahead);
    let turned = solid_in_camera.moved(&DAffine3::from_mat3(back.transpose()));
    // A plane of depth 1 is nowhere coarser than its directions, and 1 + r² times as fine at r.
    let finer = deviation / (1.0 + reach * reach);
    let mut corners = Vec::new();
    outline::trace(&turned, 0.0, finer, &mut corners)?;
    Some(corners.into_iter().map(|corner| back * corner.extend(1.0)).collect())
}

/// What of a convex polygon of rays lies on the side of a plane through the camera's centre that
/// `inwards` points to (Sutherland and Hodgman, 1974, *Reentrant polygon clipping*).
fn cut(rays: &[DVec3], inwards: DVec3) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(rays.len() + 1);
    let Some(mut from) = rays.last().copied() else { return kept };
    for &to in rays {
        let (before, after) = (inwards.dot(from), inwards.dot(to));
        if (before < 0.0) != (after < 0.0) {
            kept.push(from.lerp(to, before / (before - after)));
        }
        if after >= 0.0 {
            kept.push(to);
        }
        from = to;
    }
    kept
}
