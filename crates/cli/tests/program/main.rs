//! The real program, run as its users run it.

mod calibrations;
mod desk;
mod doctors;
mod estimates;
mod landmarks;
mod manuals;
mod outputs;
mod refinements;
mod refusals;
mod resumed;
mod rigs;
mod takes;
mod tracks;
mod trainings;
