//! Which hand it is, as an option.

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

impl From<SideName> for Side {
    fn from(name: SideName) -> Self {
        match name {
            SideName::Right => Self::Right,
            SideName::Left => Self::Left,
        }
    }
}
