//! Which hand it is, as an option.

use std::fmt;

use clap::ValueEnum;
use phalanx_hand::Side;

/// The sides by name.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum SideName {
    /// A right hand.
    #[default]
    Right,
    /// A left hand.
    Left,
}

impl From<Side> for SideName {
    fn from(side: Side) -> Self {
        match side {
            Side::Right => Self::Right,
            Side::Left => Self::Left,
        }
    }
}

impl fmt::Display for SideName {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Right => "right",
            Self::Left => "left",
        })
    }
}

impl From<SideName> for Side {
    fn from(name: SideName) -> Self {
        match name {
            SideName::Right => Self::Right,
            SideName::Left => Self::Left,
        }
    }
}
