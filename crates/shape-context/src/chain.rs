//! Whether a contour is closed.

/// Whether a contour's last point is followed by its first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Chain {
    /// The points go all the way round.
    Closed,
    /// The first and last points are ends, as where a forearm leaves the picture.
    Open,
}
