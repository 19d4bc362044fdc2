//! The experiments and chores of phalanx.
fn main() {}
