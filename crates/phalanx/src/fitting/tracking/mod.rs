//! Hands followed through frames that come one after the other.

mod delay;
mod follow;
mod last;
mod motion;
mod noise;
mod own_hand;
mod recent;
mod recover;
mod seen;
mod settings;
mod state;
mod tracker;

pub use delay::Delay;
pub use settings::TrackSettings;
pub use state::TrackerState;
pub use tracker::{TrackedFrame, Tracker};
