//! A pose: 28 numbers.

use std::f64::consts::TAU;
use std::ops::{Index, IndexMut};

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

use crate::dof::{Digit, Dof, Unit};

/// The 28 numbers of a hand pose, y ∈ ℝ²⁸ of the paper's § 3: radians and millimetres, in the
/// order of [`Dof::ALL`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pose(pub [f64; Dof::COUNT]);

impl Pose {
    /// The flat hand in its rest splay, palm down, the wrist in the middle of the volume.
    pub const REST: Self = Self([0.0; Dof::COUNT]);

    /// The global rotation R = R_X(θ_X) R_Y(θ_Y) R_Z(θ_Z), about the wrist.
    pub fn rotation(&self) -> DMat3 {
        DMat3::from_rotation_x(self[Dof::ThetaX])
            * DMat3::from_rotation_y(self[Dof::ThetaY])
            * DMat3::from_rotation_z(self[Dof::ThetaZ])
    }

    /// The wrist's offset from the middle of the working volume, mm, in the frame of the hand at
    /// rest.
    pub fn translation(&self) -> DVec3 {
        DVec3::new(self[Dof::TX], self[Dof::TY], self[Dof::TZ])
    }

    /// The numbers outside their plausible range, a bent knuckle's narrower abduction included.
    ///
    /// ```
    /// use phalanx_hand::{Dof, Pose};
    ///
    /// let mut pose = Pose::REST;
    /// pose[Dof::IndexAbduction] = 15_f64.to_radians();
    /// assert_eq!(pose.out_of_range(), []);
    /// pose[Dof::IndexMcp] = 90_f64.to_radians(); // a bent knuckle spreads less
    /// assert_eq!(pose.out_of_range(), [Dof::IndexAbduction]);
    /// ```
    pub fn out_of_range(&self) -> Vec<Dof> {
        // A file's decimal degrees do not come back exactly.
        const SLACK: f64 = 1e-9;
        let outside =
            |dof: Dof, (low, high): (f64, f64)| self[dof] < low - SLACK || self[dof] > high + SLACK;
        let mut found: Vec<Dof> =
            Dof::ALL.into_iter().filter(|&dof| outside(dof, dof.range())).collect();
        for finger in Digit::FINGERS {
            let [abduction, mcp, ..] = finger.dofs();
            let limit = abduction_limit(self[mcp]);
            if outside(abduction, (-limit, limit)) && !found.contains(&abduction) {
                found.push(abduction);
            }
        }
        found
    }
}

/// The largest abduction to either side, radians, of a finger whose knuckle is flexed by `mcp`
/// radians: 20° when straight, shrinking linearly to 5° at 90° because the collateral ligaments
/// tighten.
///
/// ```
/// use phalanx_hand::abduction_limit;
///
/// assert!((abduction_limit(0.0).to_degrees() - 20.0).abs() < 1e-9);
/// assert!((abduction_limit(90_f64.to_radians()).to_degrees() - 5.0).abs() < 1e-9);
/// ```
pub fn abduction_limit(mcp: f64) -> f64 {
    let bent = (mcp / std::f64::consts::FRAC_PI_2).clamp(0.0, 1.0);
    (20.0 - 15.0 * bent).to_radians()
}

/// Whether a motion that was read as degrees may be in radians: some angle is not 0, and none is more than
/// 2π degrees. A number that is not known is NaN.
///
/// ```
/// use phalanx_hand::{Dof, Pose, may_be_radians};
///
/// let mut bent = Pose::REST;
/// bent[Dof::IndexPip] = 1.2_f64.to_radians(); // 1.2 in a file of degrees
/// assert!(may_be_radians([Pose::REST, bent]) && !may_be_radians([Pose::REST]));
/// ```
pub fn may_be_radians(motion: impl IntoIterator<Item = Pose>) -> bool {
    let angle = |pose: Pose| {
        let angles = Dof::ALL.into_iter().filter(|dof| dof.unit() == Unit::Angle);
        angles.map(|dof| pose[dof].to_degrees().abs()).fold(0.0, f64::max)
    };
    let most = motion.into_iter().map(angle).fold(0.0, f64::max);
    0.0 < most && most <= TAU
}

impl Index<Dof> for Pose {
    type Output = f64;

    fn index(&self, dof: Dof) -> &f64 {
        &self.0[dof.index()]
    }
}

impl IndexMut<Dof> for Pose {
    fn index_mut(&mut self, dof: Dof) -> &mut f64 {
        &mut self.0[dof.index()]
    }
}

impl Default for Pose {
    fn default() -> Self {
        Self::REST
    }
}
