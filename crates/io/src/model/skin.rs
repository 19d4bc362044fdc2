//! The hand's surface as triangles, each corner on one bone.

use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

use glam::{DAffine3, DMat3, DVec3};
use phalanx_hand::{Bone, ForearmShape, HandShape, Pose, Primitive, Sphere};

use crate::model::bones::bone_of;

/// Corners around a bone.
const AROUND: usize = 12;
/// Rings of corners over each of a bone's round ends.
const RINGS: usize = 4;
/// How much of the forearm is drawn, mm: pictures cut it anyway.
const FOREARM_MM: f64 = 90.0;

/// A surface over the bones, of the hand at rest in its own frame (the root's), mm.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Skin {
    /// Each corner's place.
    pub(crate) positions: Vec<DVec3>,
    /// The direction outwards at each corner.
    pub(crate) normals: Vec<DVec3>,
    /// The bone that each corner moves with.
    pub(crate) bones: Vec<u8>,
    /// Three corners each, against the clock seen from outside.
    pub(crate) triangles: Vec<[u16; 3]>,
}

impl Skin {
    pub(crate) fn new(shape: &HandShape) -> Self {
        let shape = HandShape { forearm: shortened(&shape.forearm), ..shape.clone() };
        let posed = shape.pose(&Pose::REST, &DAffine3::IDENTITY);
        let mut skin = Self::default();
        let mut drawn = BTreeSet::new();
        for (solid, bones) in posed.primitives.iter().zip(&posed.bones) {
            let spheres = solid.spheres();
            for (a, b) in (0..spheres.len()).flat_map(|b| (0..b).map(move |a| (a, b))) {
                // Neighbouring wedges share an edge.
                let bits = |k: usize| spheres[k].center.to_array().map(f64::to_bits);
                if drawn.insert((bits(a).min(bits(b)), bits(a).max(bits(b)))) {
                    skin.push_round_cone([(spheres[a], bones[a]), (spheres[b], bones[b])], solid);
                }
            }
            if let Primitive::Wedge(spheres) = solid {
                skin.push_faces(spheres, *bones);
            }
        }
        skin
    }

    /// The hull of two spheres, squashed as the solid is.
    fn push_round_cone(
        &mut self,
        [(a, a_bone), (b, b_bone)]: [(Sphere, Bone); 2],
        solid: &Primitive,
    ) {
        let between = b.center - a.center;
        let ratio = (a.radius - b.radius) / between.length();
        // A sphere inside the other adds nothing, and NaN passes neither test.
        if !(-1.0..=1.0).contains(&ratio) {
            return;
        }
        let along = between.normalize();
        let (side, up) = along.any_orthonormal_pair();
        let seam = ratio.acos();
        let first = self.positions.len();
        let squash = solid.squash();
        let stretch = squash.inverse();
        for ring in 0..2 * RINGS {
            let (sphere, bone, angle) = if ring < RINGS {
                (a, a_bone, PI + (seam - PI) * part(ring))
            } else {
                (b, b_bone, seam * (1.0 - part(ring - RINGS)))
            };
            for k in 0..AROUND {
                let turn = TAU * k as f64 / AROUND as f64;
                let outwards =
                    along * angle.cos() + (side * turn.cos() + up * turn.sin()) * angle.sin();
                let at = sphere.center + outwards * sphere.radius - a.center;
                self.corner(a.center + squash * at, stretch * outwards, bone);
            }
        }
        self.push_rings(first);
    }

    /// The triangles between rings of corners from `first` on.
    fn push_rings(&mut self, first: usize) {
        for ring in 0..2 * RINGS - 1 {
            for k in 0..AROUND {
                let corner = |ring: usize, k: usize| (first + ring * AROUND + k % AROUND) as u16;
                let [a, b, c, d] = [
                    corner(ring, k),
                    corner(ring, k + 1),
                    corner(ring + 1, k + 1),
                    corner(ring + 1, k),
                ];
                self.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }

    /// The two flat faces of a wedge: the planes that touch its three spheres.
    fn push_faces(&mut self, spheres: &[Sphere; 3], bones: [Bone; 3]) {
        let [p, q, r] = spheres;
        let (u, v) = (q.center - p.center, r.center - p.center);
        let across = u.cross(v);
        let Some(axis) = across.try_normalize() else { return };
        // n·u = r_p − r_q and n·v = r_p − r_r, of unit length.
        let rows = DMat3::from_cols(u, v, axis).transpose();
        let within = rows.inverse() * DVec3::new(p.radius - q.radius, p.radius - r.radius, 0.0);
        let height = 1.0 - within.length_squared();
        // One sphere within the hull of the others, or NaN: no plane touches all three.
        if height.is_nan() || height <= 0.0 {
            return;
        }
        for side in [1.0, -1.0] {
            let outwards = within + axis * (side * height.sqrt());
            let first = self.positions.len() as u16;
            for (sphere, bone) in spheres.iter().zip(bones) {
                self.corner(sphere.center + outwards * sphere.radius, outwards, bone);
            }
            let order = if side > 0.0 { [0, 1, 2] } else { [0, 2, 1] };
            self.triangles.push(order.map(|k| first + k));
        }
    }

    fn corner(&mut self, at: DVec3, outwards: DVec3, bone: Bone) {
        self.positions.push(at);
        self.normals.push(outwards.normalize());
        self.bones.push(bone_of(bone) as u8);
    }
}

/// How far a ring is over a round end, 0 at its first.
fn part(ring: usize) -> f64 {
    ring as f64 / (RINGS - 1) as f64
}

fn shortened(forearm: &ForearmShape) -> ForearmShape {
    let length_mm = forearm.length_mm.min(FOREARM_MM);
    let [wrist, far] = forearm.half_widths_mm;
    let end = wrist + (far - wrist) * length_mm / forearm.length_mm;
    ForearmShape { length_mm, half_widths_mm: [wrist, end], flatness: forearm.flatness }
}

#[cfg(test)]
mod tests {
    use phalanx_hand::Side;

    use super::*;

    #[test]
    fn every_corner_is_on_the_hand_and_triangles_face_outwards() {
        for side in [Side::Right, Side::Left] {
            let skin = Skin::new(&HandShape { side, ..HandShape::adult() });
            assert!(skin.positions.len() < usize::from(u16::MAX));
            assert!(skin.positions.iter().all(|at| at.is_finite() && at.length() < 220.0));
            for triangle in &skin.triangles {
                let [a, b, c] = triangle.map(|corner| skin.positions[usize::from(corner)]);
                let facing = (b - a).cross(c - a);
                let outwards: DVec3 =
                    triangle.iter().map(|&corner| skin.normals[usize::from(corner)]).sum();
                assert!(facing.length() < 1e-9 || facing.dot(outwards) > 0.0);
            }
        }
    }
}
