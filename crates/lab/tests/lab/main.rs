//! What the experiments stand on.

mod files;
mod scores;
