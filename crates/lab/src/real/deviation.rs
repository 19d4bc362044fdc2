//! From what is known of a pose to what is known of its joints.

use glam::{DAffine3, DVec3};
use phalanx_hand::{Dof, HandShape, JOINTS, Pose};

/// What is known of a pose's numbers, radians and mm.
#[derive(Debug, Clone)]
pub struct PoseCovariance {
    dofs: Vec<Dof>,
    /// Column after column.
    values: Vec<f64>,
}

/// A step by which a number of a pose is moved, radians or mm.
const STEP: f64 = 1e-5;

impl PoseCovariance {
    /// Of some numbers, column after column; the others are certain.
    ///
    /// # Panics
    /// If there are not as many values as the square of the numbers.
    pub fn new(dofs: &[Dof], values: &[f64]) -> Self {
        assert_eq!(values.len(), dofs.len() * dofs.len(), "a value for each pair of numbers");
        Self { dofs: dofs.to_vec(), values: values.to_vec() }
    }

    /// Of independent numbers with these standard deviations.
    pub fn independent(deviations: &[f64; Dof::COUNT]) -> Self {
        let mut values = vec![0.0; Dof::COUNT * Dof::COUNT];
        for (k, deviation) in deviations.iter().enumerate() {
            values[k * Dof::COUNT + k] = deviation * deviation;
        }
        Self { dofs: Dof::ALL.to_vec(), values }
    }
}

/// Standard deviations of a posed hand's joints along the world's axes, mm: to first order.
pub fn joint_deviations(
    hand: &HandShape,
    pose: &Pose,
    rest: &DAffine3,
    known: &PoseCovariance,
) -> [DVec3; JOINTS] {
    let joints = |dof: Dof, step: f64| {
        let mut moved = *pose;
        moved[dof] += step;
        hand.pose(&moved, rest).joints
    };
    let slopes: Vec<[DVec3; JOINTS]> = known
        .dofs
        .iter()
        .map(|&dof| {
            let (ahead, behind) = (joints(dof, STEP), joints(dof, -STEP));
            std::array::from_fn(|joint| (ahead[joint] - behind[joint]) / (2.0 * STEP))
        })
        .collect();
    std::array::from_fn(|joint| {
        let mut variance = DVec3::ZERO;
        for (column, values) in slopes.iter().zip(known.values.chunks(known.dofs.len())) {
            for (row, value) in slopes.iter().zip(values) {
                variance += row[joint] * column[joint] * *value;
            }
        }
        variance.max(DVec3::ZERO).map(f64::sqrt)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shift_moves_all_joints_alike() {
        let mut deviations = [0.0; Dof::COUNT];
        deviations[Dof::TX.index()] = 3.0;
        let known = PoseCovariance::independent(&deviations);
        let of = joint_deviations(&HandShape::adult(), &Pose::REST, &DAffine3::IDENTITY, &known);
        for joint in of {
            assert!((joint - DVec3::new(3.0, 0.0, 0.0)).length() < 1e-6, "{joint}");
        }
    }

    #[test]
    fn numbers_that_err_together_can_cancel() {
        let (dofs, rest) = ([Dof::TX, Dof::TY], DAffine3::IDENTITY);
        let turned = DAffine3::from_rotation_z(std::f64::consts::FRAC_PI_4);
        let known = PoseCovariance::new(&dofs, &[1.0, -1.0, -1.0, 1.0]);
        let hand = HandShape::adult();
        let across = joint_deviations(&hand, &Pose::REST, &rest, &known)[0];
        assert!((across - DVec3::new(1.0, 1.0, 0.0)).length() < 1e-6, "{across}");
        let along = joint_deviations(&hand, &Pose::REST, &turned, &known)[0];
        assert!((along - DVec3::new(2.0_f64.sqrt(), 0.0, 0.0)).length() < 1e-6, "{along}");
    }
}
