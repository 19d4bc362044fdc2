//! The real program, run as its users run it.

mod desk;
mod estimates;
mod refusals;
