//! The hand seen through a virtual camera that is turned and zoomed onto it.

mod choice;
mod drawn;
mod finder;
pub(crate) mod framing;
mod layout;
pub(crate) mod resample;
pub(crate) mod virtual_camera;

pub(crate) use drawn::{DrawnView, DrawnWindows};
pub use finder::WindowFinder;
pub use framing::Framing;
pub use virtual_camera::{PicturedHand, Window};
