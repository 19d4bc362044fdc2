//! Hands followed through frames that come one after the other.

mod delay;
mod follow;
mod motion;
mod noise;
mod own_hand;
mod recent;
mod recover;
mod seen;
mod state;
mod tracker;

pub use delay::Delay;
pub use state::TrackerState;
pub use tracker::{TrackSettings, TrackedFrame, Tracker};
