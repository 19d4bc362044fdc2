//! The 28 degrees of freedom: names, order, units and plausible ranges.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};

/// The five digits, thumb first, as in every list of this crate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Digit {
    /// The thumb.
    Thumb,
    /// The index finger.
    Index,
    /// The middle finger.
    Middle,
    /// The ring finger.
    Ring,
    /// The little finger.
    Little,
}

impl Digit {
    /// All digits, thumb first.
    pub const ALL: [Self; 5] = [Self::Thumb, Self::Index, Self::Middle, Self::Ring, Self::Little];
    /// The four fingers, index first.
    pub const FINGERS: [Self; 4] = [Self::Index, Self::Middle, Self::Ring, Self::Little];

    /// The digit's abduction followed by its three flexions from the base outwards: CMC, MCP
    /// and IP for the thumb; MCP, PIP and DIP for a finger.
    ///
    /// ```
    /// use phalanx_hand::{Digit, Dof};
    ///
    /// let [_, mcp, pip, dip] = Digit::Index.dofs();
    /// assert_eq!([mcp, pip, dip], [Dof::IndexMcp, Dof::IndexPip, Dof::IndexDip]);
    /// assert_eq!("index.pip".parse::<Dof>()?, pip);
    /// # Ok::<(), phalanx_hand::Error>(())
    /// ```
    pub fn dofs(self) -> [Dof; 4] {
        let first = self as usize * 4;
        std::array::from_fn(|k| Dof::ALL[first + k])
    }
}

macro_rules! dofs {
    ($($variant:ident $name:literal $unit:ident $low:literal $high:literal;)*) => {
        /// One of the 28 numbers of a pose, in the order in which a pose stores them.
        ///
        /// Zero is a flat hand in its natural rest splay. Flexion is positive towards the palm;
        /// abduction is positive away from the middle finger (for the middle finger, towards
        /// the thumb; for the thumb, away from the palm). The wrist deviates positively towards
        /// the thumb.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Dof {
            $(#[doc = concat!("`", $name, "`")] $variant,)*
        }

        impl Dof {
            /// All 28, in order.
            pub const ALL: [Self; 28] = [$(Self::$variant,)*];

            /// The column name used in every file, such as `index.pip`.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// Whether the number is an angle or a length.
            pub fn unit(self) -> Unit {
                match self { $(Self::$variant => Unit::$unit,)* }
            }

            /// The plausible range, lowest and highest, in radians or millimetres. Values
            /// outside it are legal in files and are never clamped in ground truth.
            pub fn range(self) -> (f64, f64) {
                let (low, high): (f64, f64) = match self { $(Self::$variant => ($low, $high),)* };
                (self.unit().from_file(low), self.unit().from_file(high))
            }
        }
    };
}

dofs! {
    ThumbAbduction "thumb.abduction" Angle -20.0 45.0;
    ThumbCmc "thumb.cmc" Angle -15.0 45.0;
    ThumbMcp "thumb.mcp" Angle -10.0 60.0;
    ThumbIp "thumb.ip" Angle -15.0 80.0;
    IndexAbduction "index.abduction" Angle -20.0 20.0;
    IndexMcp "index.mcp" Angle -20.0 95.0;
    IndexPip "index.pip" Angle -5.0 110.0;
    IndexDip "index.dip" Angle -5.0 80.0;
    MiddleAbduction "middle.abduction" Angle -20.0 20.0;
    MiddleMcp "middle.mcp" Angle -20.0 95.0;
    MiddlePip "middle.pip" Angle -5.0 110.0;
    MiddleDip "middle.dip" Angle -5.0 80.0;
    RingAbduction "ring.abduction" Angle -20.0 20.0;
    RingMcp "ring.mcp" Angle -20.0 95.0;
    RingPip "ring.pip" Angle -5.0 110.0;
    RingDip "ring.dip" Angle -5.0 80.0;
    LittleAbduction "little.abduction" Angle -20.0 20.0;
    LittleMcp "little.mcp" Angle -20.0 95.0;
    LittlePip "little.pip" Angle -5.0 110.0;
    LittleDip "little.dip" Angle -5.0 80.0;
    WristFlexion "wrist.flexion" Angle -70.0 80.0;
    WristDeviation "wrist.deviation" Angle -30.0 20.0;
    ThetaX "global.theta_x" Angle -180.0 180.0;
    ThetaY "global.theta_y" Angle -90.0 90.0;
    ThetaZ "global.theta_z" Angle -180.0 180.0;
    TX "global.t_x" Length -500.0 500.0;
    TY "global.t_y" Length -500.0 500.0;
    TZ "global.t_z" Length -500.0 500.0;
}

impl Dof {
    /// How many numbers a pose has.
    pub const COUNT: usize = Self::ALL.len();
    /// The 20 angles of the digits.
    pub const INTERNAL: usize = 20;

    /// The position of the number in a pose, 0 to 27.
    pub fn index(self) -> usize {
        self as usize
    }

    /// Whether this is one of the 20 angles of the digits.
    pub fn is_internal(self) -> bool {
        self.index() < Self::INTERNAL
    }
}

impl fmt::Display for Dof {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Dof {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        let named = Self::ALL.into_iter().find(|dof| dof.name() == name);
        named.ok_or_else(|| Error::UnknownDof { name: name.to_owned() })
    }
}

/// What a number of a pose measures: radians or millimetres in code, degrees or millimetres in
/// files and on screens.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// An angle.
    Angle,
    /// A length.
    Length,
}

impl Unit {
    /// From a file's degrees or millimetres to radians or millimetres.
    pub fn from_file(self, value: f64) -> f64 {
        match self {
            Self::Angle => value.to_radians(),
            Self::Length => value,
        }
    }

    /// From radians or millimetres to a file's degrees or millimetres.
    pub fn to_file(self, value: f64) -> f64 {
        match self {
            Self::Angle => value.to_degrees(),
            Self::Length => value,
        }
    }
}
