//! The derivative of forward kinematics: what moves with which numbers of a pose.

use glam::DVec3;

use crate::dof::{Digit, Dof};

/// A rigid part of the hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Bone {
    /// What is behind the wrist: moved by the global numbers alone.
    Forearm,
    /// The palm: moved by the wrist too.
    Palm,
    /// A digit's segment, 0 to 2 from its base outwards: moved by its abduction and the flexions
    /// up to its own too.
    Segment(Digit, usize),
}

impl Bone {
    /// What a joint moves with, by its place in [`PosedHand::joints`](crate::PosedHand::joints): the wrist
    /// with the forearm, a digit's base with the palm, its other joints with the segment that they end.
    ///
    /// ```
    /// use phalanx_hand::{Bone, Digit};
    ///
    /// assert_eq!(Bone::of_joint(0), Bone::Forearm);
    /// assert_eq!(Bone::of_joint(5), Bone::Palm);
    /// assert_eq!(Bone::of_joint(8), Bone::Segment(Digit::Index, 2)); // its tip
    /// ```
    ///
    /// # Panics
    /// A joint beyond the last.
    pub fn of_joint(joint: usize) -> Self {
        match joint.checked_sub(1) {
            None => Self::Forearm,
            Some(of_digits) => match of_digits % 4 {
                0 => Self::Palm,
                end => Self::Segment(Digit::ALL[of_digits / 4], end - 1),
            },
        }
    }

    /// Whether a number of the pose moves this part.
    pub fn is_moved_by(self, dof: Dof) -> bool {
        self.dofs().any(|own| own == dof)
    }

    /// The numbers of the pose that move this part: at most 12.
    ///
    /// ```
    /// use phalanx_hand::{Digit, Dof, Bone};
    ///
    /// let middle_phalanx = Bone::Segment(Digit::Index, 1);
    /// assert!(middle_phalanx.is_moved_by(Dof::IndexPip) && !middle_phalanx.is_moved_by(Dof::IndexDip));
    /// assert_eq!(Bone::Forearm.dofs().count(), 6);
    /// ```
    pub fn dofs(self) -> impl Iterator<Item = Dof> {
        let global = 6;
        let (wrist, digit) = match self {
            Self::Forearm => (0, None),
            Self::Palm => (2, None),
            Self::Segment(digit, segment) => (2, Some((digit, segment + 2))),
        };
        let first = Dof::INTERNAL + 2 - wrist;
        let of_digit =
            digit.into_iter().flat_map(|(digit, count)| digit.dofs().into_iter().take(count));
        of_digit.chain((first..first + wrist + global).map(|index| Dof::ALL[index]))
    }
}

/// How one number of a pose moves what hangs on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Twist {
    /// About a line.
    Turn {
        /// The unit direction of the line.
        axis: DVec3,
        /// A point on it, mm.
        origin: DVec3,
    },
    /// Along a unit direction.
    Shift(DVec3),
}

impl Twist {
    /// The velocity of a point, mm per radian or per millimetre.
    pub fn velocity(&self, point: DVec3) -> DVec3 {
        match self {
            Self::Turn { axis, origin } => axis.cross(point - *origin),
            Self::Shift(direction) => *direction,
        }
    }
}

/// How each number of a pose moves what hangs on it ([`Bone::dofs`]), in world coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twists(pub(crate) [Twist; Dof::COUNT]);

impl Twists {
    /// Of one number.
    pub fn of(&self, dof: Dof) -> &Twist {
        &self.0[dof.index()]
    }
}
