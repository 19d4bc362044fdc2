//! Digits that would be in the same place.

use glam::DVec3;
use phalanx_hand::{Bone, PosedHand, Primitive, Sphere};

/// How deep digits may press into each other at no cost, mm, about half a finger: flesh gives way,
/// and recorded and drawn motion is not so exact that fingers never meet.
const GIVES: f64 = 8.0;

/// Standard deviation of what they press in deeper, mm.
const DEVIATION: f64 = 3.0;

/// Two phalanges of different digits that are in the same place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Penetration {
    /// The two primitives, by their numbers.
    pub(crate) primitives: [usize; 2],
    /// Where on each axis they are deepest in each other, 0 at the first sphere and 1 at the second.
    pub(crate) places: [f64; 2],
    /// Unit vector from the second axis to the first, there.
    pub(crate) apart: DVec3,
    /// How much deeper than they may be, mm.
    pub(crate) excess: f64,
}

impl Penetration {
    /// What speaks against it.
    pub(crate) fn energy(&self) -> f64 {
        0.5 * Self::WEIGHT * self.excess * self.excess
    }

    /// The energy's second derivative by the excess.
    pub(crate) const WEIGHT: f64 = 1.0 / (DEVIATION * DEVIATION);
}

/// What speaks against a posed hand because of its digits being in the same place.
pub(crate) fn energy(posed: &PosedHand) -> f64 {
    penetrations(posed).map(|penetration| penetration.energy()).sum()
}

/// All phalanges of different digits that are too deep in each other. For this purpose a phalanx is
/// as thick everywhere as it is on average.
pub(crate) fn penetrations(posed: &PosedHand) -> impl Iterator<Item = Penetration> + '_ {
    let primitives = posed.primitives.iter().zip(&posed.bones).enumerate();
    let phalanges: Vec<_> = primitives
        .filter_map(|(number, (primitive, bones))| match (primitive, bones[0], bones[1]) {
            (Primitive::RoundCone(spheres), Bone::Segment(digit, _), Bone::Segment(..)) => {
                Some((number, digit, *spheres))
            }
            _ => None,
        })
        .collect();
    let pairs = (0..phalanges.len()).flat_map(move |i| (0..i).map(move |j| (i, j)));
    pairs.filter_map(move |(i, j)| {
        let ((a, digit, one), (b, other_digit, other)) = (phalanges[i], phalanges[j]);
        (digit != other_digit).then(|| penetration([a, b], one, other)).flatten()
    })
}

fn penetration(
    primitives: [usize; 2],
    one: [Sphere; 2],
    other: [Sphere; 2],
) -> Option<Penetration> {
    let thick = |spheres: [Sphere; 2]| f64::midpoint(spheres[0].radius, spheres[1].radius);
    let reach = thick(one) + thick(other) - GIVES;
    let long = |spheres: [Sphere; 2]| spheres[0].center.distance(spheres[1].center);
    // Most pairs are nowhere near each other.
    if one[0].center.distance(other[0].center) > reach + long(one) + long(other) {
        return None;
    }
    let axes = [one, other].map(|spheres| spheres.map(|sphere| sphere.center));
    let places = nearest(axes[0], axes[1]);
    let [p, q] = [0, 1].map(|k| axes[k][0].lerp(axes[k][1], places[k]));
    let excess = reach - p.distance(q);
    // Axes that cross have no direction to part in.
    let apart = (p - q).try_normalize()?;
    (excess > 0.0).then_some(Penetration { primitives, places, apart, excess })
}

/// Where two segments are nearest to each other, as shares of their lengths (Ericson 2005, § 5.1.9).
fn nearest([p, p_end]: [DVec3; 2], [q, q_end]: [DVec3; 2]) -> [f64; 2] {
    let (along, across, between) = (p_end - p, q_end - q, p - q);
    let (a, b, e) = (along.length_squared(), along.dot(across), across.length_squared());
    let (c, f) = (along.dot(between), across.dot(between));
    // The share of a segment, of no matter where on a segment without length.
    let share = |value: f64, length: f64| {
        if length > 0.0 { (value / length).clamp(0.0, 1.0) } else { 0.0 }
    };
    let s = share(b * f - c * e, a * e - b * b);
    let t = share(b * s + f, e);
    [share(b * t - c, a), t]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn points() -> impl Strategy<Value = [DVec3; 2]> {
        prop::array::uniform6(-30.0..30.0_f64)
            .prop_map(|x| [DVec3::new(x[0], x[1], x[2]), DVec3::new(x[3], x[4], x[5])])
    }

    proptest! {
        #![proptest_config(crate::property::cases(256))]

        /// No place of a fine grid is nearer.
        #[test]
        fn segments_are_nearest_there(one in points(), other in points()) {
            let at = |[s, t]: [f64; 2]| {
                one[0].lerp(one[1], s).distance(other[0].lerp(other[1], t))
            };
            let found = at(nearest(one, other));
            for i in 0..=20 {
                for j in 0..=20 {
                    let other = at([f64::from(i) / 20.0, f64::from(j) / 20.0]);
                    prop_assert!(found <= other + 1e-9, "{found} > {other}");
                }
            }
        }
    }
}
