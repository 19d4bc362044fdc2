//! The proportions of a hand as numbers that can be fitted.

use glam::{DAffine3, DVec3};
use phalanx_hand::{HandShape, JOINTS, Measure, Pose, PosedHand};

/// How a hand differs from a given one: the logarithms of a factor for its size, of one for how thick it is, and of
/// one for every bone and radius, in the order of [`HandShape::scaled`].
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ShapeParameters {
    pub(crate) logarithms: Vec<f64>,
}

/// How a sphere changes with one of the numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SphereSlope {
    pub(crate) number: usize,
    pub(crate) center: DVec3,
    pub(crate) radius: f64,
}

/// How the spheres of a primitive change with the numbers.
pub(crate) type PrimitiveSlopes = [Vec<SphereSlope>; 3];

/// The size's and the thickness's.
const COMMON: usize = 2;

impl ShapeParameters {
    /// Those of the given hand itself.
    pub(crate) fn of(given: &HandShape) -> Self {
        let mut logarithms = vec![0.0; COMMON];
        let _as_given = given.scaled(|| {
            logarithms.push(0.0);
            1.0
        });
        Self { logarithms }
    }

    /// The hand.
    pub(crate) fn hand(&self, given: &HandShape) -> HandShape {
        let (common, each) = self.logarithms.split_at(COMMON);
        let mut each = each.iter();
        given.scaled_by(|measure| {
            let of_all = match measure {
                Measure::Length => common[0],
                Measure::Radius => common[0] + common[1],
            };
            (of_all + each.next().copied().unwrap_or(0.0)).exp()
        })
    }

    /// How each joint of the posed hand changes with each of the numbers, by differences.
    pub(crate) fn joint_slopes(
        &self,
        given: &HandShape,
        pose: &Pose,
        rest: &DAffine3,
    ) -> Vec<[DVec3; JOINTS]> {
        const STEP: f64 = 1e-5;
        let at = self.hand(given).pose(pose, rest).joints;
        let of_number = |number: usize| {
            let mut changed = self.clone();
            changed.logarithms[number] += STEP;
            let moved = changed.hand(given).pose(pose, rest).joints;
            std::array::from_fn(|joint| (moved[joint] - at[joint]) / STEP)
        };
        (0..self.logarithms.len()).map(of_number).collect()
    }

    /// How each sphere of each primitive of the posed hand changes with the numbers, by differences.
    pub(crate) fn slopes(
        &self,
        given: &HandShape,
        pose: &Pose,
        rest: &DAffine3,
        posed: &PosedHand,
    ) -> Vec<PrimitiveSlopes> {
        const STEP: f64 = 1e-4;
        let mut slopes = vec![PrimitiveSlopes::default(); posed.primitives.len()];
        for number in 0..self.logarithms.len() {
            let mut changed = self.clone();
            changed.logarithms[number] += STEP;
            let changed = changed.hand(given).pose(pose, rest);
            for (primitive, slopes) in slopes.iter_mut().enumerate() {
                let (before, after) = (
                    posed.primitives[primitive].spheres(),
                    changed.primitives[primitive].spheres(),
                );
                for (k, (a, b)) in before.iter().zip(after).enumerate() {
                    if a != b {
                        slopes[k].push(SphereSlope {
                            number,
                            center: (b.center - a.center) / STEP,
                            radius: (b.radius - a.radius) / STEP,
                        });
                    }
                }
            }
        }
        slopes
    }
}
