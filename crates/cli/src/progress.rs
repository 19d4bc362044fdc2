//! Progress on a terminal.

use std::sync::{Mutex, MutexGuard, PoisonError};

use indicatif::{ProgressBar, ProgressStyle};
use phalanx::{Losses, Progress};

/// A bar on standard error with the time that remains of the stage; nothing where standard error is no
/// terminal. What a training loses is said in any case.
pub(crate) struct Bar(Mutex<ProgressBar>);

impl Bar {
    pub(crate) fn new() -> Self {
        Self(Mutex::new(ProgressBar::hidden()))
    }

    /// Says something above the bar.
    pub(crate) fn say(&self, message: &str) {
        self.current().suspend(|| eprintln!("phalanx: {message}"));
    }

    fn current(&self) -> MutexGuard<'_, ProgressBar> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Progress for Bar {
    fn begin(&self, stage: &str, items: usize) {
        let style = ProgressStyle::with_template("{msg:26} {wide_bar} {pos}/{len} {eta:>4} left")
            .expect("the template is well-formed");
        let bar = ProgressBar::new(items as u64).with_style(style);
        bar.set_message(stage.to_owned());
        let mut current = self.current();
        current.finish_and_clear();
        *current = bar;
    }

    fn step(&self) {
        self.current().inc(1);
    }

    fn lost(&self, losses: &Losses, scenes: usize) {
        let lost = losses.count();
        self.say(&format!("{lost} of {scenes} scenes could not be used: {losses}"));
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.current().finish_and_clear();
    }
}
