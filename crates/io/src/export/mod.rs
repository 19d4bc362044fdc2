//! Takes as the files of other tools.
//!
//! | format | holds | gaps |
//! |---|---|---|
//! | [`trc`] | joints | NaN |
//! | [`motion_file`] (MOT), [`deviation_file`] (STO) | the 28 numbers | no row |
//! | [`c3d`] | joints | residual −1 |
//! | [`bvh`] | the person's bones and their turns | the pose before |
//! | [`glb`] (glTF 2.0) | a skinned hand that moves | in between |

mod bvh;
mod c3d;
mod coordinates;
mod glb;
mod motion;
mod placement;
mod timing;
mod trc;

pub use bvh::bvh;
pub use c3d::c3d;
pub use coordinates::{Coordinate, CoordinateNames};
pub use glb::glb;
pub use motion::{deviation_file, motion_file};
pub use placement::{Axes, LengthUnit, Placement};
pub use timing::{frame_rate, largest_jitter};
pub use trc::trc;
