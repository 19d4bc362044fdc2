//! Hands fitted to what calibrated cameras saw, without a trained model.
//!
//! [`fit_take`] goes through a whole take: where the hand works, each frame from several starts, which views
//! disagree, the hand's proportions, and each frame once more in the light of its neighbours. [`fit_frame`]
//! fits one frame of a hand that is known.

mod borders;
mod chain;
mod consensus;
mod flesh;
mod found;
mod frame_fit;
mod knowledge;
mod known;
mod line_of_sight;
mod misfit;
mod mistake;
mod motion;
mod observation;
mod passes;
mod points;
mod proportions;
mod repertoire;
mod report;
mod search;
mod single;
mod size;
mod starts;
mod take;
mod take_frame;
mod times;
mod tracking;
mod views;
mod volume;
mod weights;
mod wrong_view;

pub use consensus::VolumeEstimate;
pub use report::{FitDoubt, FrameFit, LandmarkFit, Missing, ViewFit};
pub use single::fit_frame;
pub use take::{Proportions, TakeFit, TakeSettings, fit_take};
pub use take_frame::TakeFrame;
pub use tracking::{Delay, TrackSettings, TrackedFrame, Tracker, TrackerState};
pub use volume::{estimate_volume, trusted_volume};
