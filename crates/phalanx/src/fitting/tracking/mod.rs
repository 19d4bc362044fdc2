//! Hands followed through frames that come one after the other.

mod follow;
mod motion;
mod noise;
mod own_hand;
mod recent;
mod recover;
mod seen;
mod tracker;

pub use tracker::{Delay, TrackSettings, TrackedFrame, Tracker};
