//! Progress on the terminal.

use std::sync::Mutex;

use indicatif::{ProgressBar, ProgressStyle};
use phalanx::{Losses, Progress};

/// A bar on standard error with an estimate of the time that remains; nothing where that is no
/// terminal.
pub(crate) struct Bar(Mutex<ProgressBar>);

impl Bar {
    /// Shows nothing before the first stage begins.
    pub(crate) fn new() -> Self {
        Self(Mutex::new(ProgressBar::hidden()))
    }
}

impl Default for Bar {
    fn default() -> Self {
        Self::new()
    }
}

impl Progress for Bar {
    fn begin(&self, stage: &str, items: usize) {
        let style = ProgressStyle::with_template("{msg:26} {wide_bar} {pos}/{len} {eta:>4}")
            .expect("the template is well-formed");
        let bar = ProgressBar::new(items as u64).with_style(style);
        bar.set_message(stage.to_owned());
        let mut current = self.0.lock().expect("no holder of the lock panics");
        current.finish_and_clear();
        *current = bar;
    }

    fn step(&self) {
        self.0.lock().expect("no holder of the lock panics").inc(1);
    }

    fn lost(&self, losses: &Losses, scenes: usize) {
        let bar = self.0.lock().expect("no holder of the lock panics");
        bar.suspend(|| {
            eprintln!("{} of {scenes} scenes could not be used: {losses}", losses.count());
        });
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        if let Ok(bar) = self.0.get_mut() {
            bar.finish_and_clear();
        }
    }
}
