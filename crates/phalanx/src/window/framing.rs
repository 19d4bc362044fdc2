//! What of a picture is looked at.

use serde::{Deserialize, Serialize};

/// What of a camera's picture is described.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Framing {
    /// The whole picture, brought to [`WORKING_SIZE`](crate::WORKING_SIZE): the paper's way, for a
    /// hand that fills a fifth of it.
    #[default]
    Picture,
    /// A [`Window`](crate::Window) on the hand, wherever and however large it is in the picture.
    Window,
}
