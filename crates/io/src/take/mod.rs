//! A take: one hand over time, with what is known of how sure each number is.
//!
//! It is held in three forms, each read and written: CSV ([`read_csv`], [`write_csv`]), JSON Lines
//! ([`read_json_lines`], [`write_json_lines`]) and NumPy's NPZ ([`read_npz`], [`write_npz`]).

mod by_name;
mod csv_table;
mod frames;
mod header;
mod json_lines;
mod npz;
mod schema;
mod stored_zip;
mod validate;

pub use csv_table::{CsvWriter, read_csv, write_csv};
pub use frames::{
    FORMAT_VERSION, FrameView, JOINT_NAMES, LeftOut, PoseEstimate, Take, TakeFrame, TakeHeader,
};
pub use json_lines::{JsonLinesWriter, read_json_lines, write_json_lines};
pub use npz::{read_npz, write_npz};
pub use schema::json_schema;
