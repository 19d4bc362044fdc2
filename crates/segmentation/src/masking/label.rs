//! What training pixels are of.

/// The class of a training pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Label {
    /// Bare skin.
    Skin,
    /// Anything else.
    NonSkin,
}
