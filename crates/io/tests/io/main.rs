//! Files of other tools and our own, as a user of the crate reads and writes them.

mod calibration;
mod formats;
#[path = "../installed/mod.rs"]
mod installed;
mod landmarks;
mod opencv;
mod pages;
#[path = "../property/mod.rs"]
mod property;
mod readers;
mod sample;
