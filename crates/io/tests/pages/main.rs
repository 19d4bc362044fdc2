//! The pages: what they hold, and what a browser makes of them.

mod browser;
#[path = "../installed/mod.rs"]
mod installed;
mod reports;
#[path = "../formats/sample.rs"]
mod sample;
