//! How far each joint of a take moves, with deviations: the table that a clinic keeps.

mod range_of_motion;
mod render;
mod table;

pub use range_of_motion::{ANGLES, AngleRange, FrameChoice, Measured, RangeOfMotion};
pub(crate) use render::short;
pub use render::{print_page, to_csv, to_json, to_text};
pub use table::{NamedRange, Row, Table, range_table};
