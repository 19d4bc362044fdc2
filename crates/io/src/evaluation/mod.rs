//! A take beside a reference: errors, whether the deviations keep their promise, and lag.

mod lag;
mod reference;
mod reference_csv;
mod scores;

pub use lag::{Lag, lag};
pub use reference::{Clock, Reference, read_motion_file, read_trc};
pub use reference_csv::read_csv;
pub use scores::{Evaluation, LEVELS, Scores, evaluate};
