//! How long work tells its caller how far it is.

use crate::losses::Losses;

/// Receives the progress of long work, from any thread.
pub trait Progress: Sync {
    /// A stage of `items` steps begins.
    fn begin(&self, stage: &str, items: usize);
    /// One more step of the stage is done.
    fn step(&self);
    /// Some of so many training scenes could not be used.
    fn lost(&self, _losses: &Losses, _scenes: usize) {}
}

/// Receives progress and tells nobody.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoProgress;

impl Progress for NoProgress {
    fn begin(&self, _stage: &str, _items: usize) {}
    fn step(&self) {}
}
