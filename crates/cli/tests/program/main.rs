//! The real program, run as its users run it.

mod calibrations;
mod desk;
mod doctors;
mod estimates;
#[path = "../installed/mod.rs"]
mod installed;
mod landmarks;
mod manuals;
mod one_recording;
mod outputs;
mod refinements;
mod refusals;
mod resumed;
mod rigs;
mod takes;
mod tracks;
mod trainings;
