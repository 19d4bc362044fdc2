//! What a user of the library sees.

mod default_preset;
mod doubts;
mod drawn;
mod estimator;
mod golden;
mod landmarks;
mod mistaken;
#[path = "../property/mod.rs"]
mod property;
mod sizes;
mod take;
mod windows;
