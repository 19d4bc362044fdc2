//! Random poses: with the couplings of a real hand, and without.

use crate::dof::{Digit, Dof};
use crate::pose::{Pose, abduction_limit};

/// A digit's four angles from a prior with the couplings of a real hand, radians, in the order of
/// [`Digit::dofs`]. DIP follows PIP by about two thirds (Rijpkema and Girard 1991), the thumb's
/// outer joints bend together, abduction narrows as the knuckle bends, and a digit is more often
/// nearly straight or nearly bent than halfway (the arcsine law). All angles are within their
/// plausible ranges.
///
/// `uniform` gives numbers that are uniform in [0, 1); four are taken.
pub fn sample_posture(digit: Digit, mut uniform: impl FnMut() -> f64) -> [f64; 4] {
    let mut curl = || (std::f64::consts::FRAC_PI_2 * uniform()).sin().powi(2);
    let (outer, base) = (curl(), curl());
    let spread = 2.0 * uniform() - 1.0;
    let wobble = 2.0 * uniform() - 1.0;
    let degrees = if digit == Digit::Thumb {
        [
            12.5 + 22.0 * spread,
            -8.0 + 46.0 * base,
            -4.0 + 54.0 * outer,
            -8.0 + 72.0 * outer + 6.0 * wobble,
        ]
    } else {
        let mcp = -10.0 + 95.0 * base;
        let pip = 102.0 * outer;
        let dip = (pip * 2.0 / 3.0 + 6.0 * wobble).clamp(0.0, 78.0);
        [spread * 0.9 * abduction_limit(mcp.to_radians()).to_degrees(), mcp, pip, dip]
    };
    degrees.map(f64::to_radians)
}

/// A pose whose digits are independent [`sample_posture`]s; all else is at rest.
///
/// ```
/// use phalanx_hand::{Dof, sample_pose};
///
/// let mut state = 1_u64; // any generator will do
/// let mut uniform = || {
///     state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
///     (state >> 11) as f64 / (1_u64 << 53) as f64
/// };
/// for _ in 0..100 {
///     let pose = sample_pose(&mut uniform);
///     assert_eq!(pose.out_of_range(), []);
///     let uncoupled = pose[Dof::IndexDip] - 2.0 / 3.0 * pose[Dof::IndexPip];
///     assert!(uncoupled.abs() < 6.1_f64.to_radians());
/// }
/// ```
pub fn sample_pose(mut uniform: impl FnMut() -> f64) -> Pose {
    let mut pose = Pose::REST;
    for digit in Digit::ALL {
        let posture = sample_posture(digit, &mut uniform);
        for (dof, angle) in digit.dofs().into_iter().zip(posture) {
            pose[dof] = angle;
        }
    }
    pose
}

/// A pose whose 20 internal angles are independent and uniform in their plausible ranges, without
/// any coupling: also such as no hand can take. All else is at rest.
pub fn sample_pose_independent(mut uniform: impl FnMut() -> f64) -> Pose {
    let mut pose = Pose::REST;
    for dof in Dof::ALL.into_iter().filter(|dof| dof.is_internal()) {
        let (low, high) = dof.range();
        pose[dof] = low + (high - low) * uniform();
    }
    pose
}
