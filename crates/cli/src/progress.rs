//! Progress on a terminal.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::counts::counted;
use indicatif::{ProgressBar, ProgressStyle};
use phalanx::{LossReason, Losses, Progress};

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
        let all = format!("{} of {scenes}", losses.count());
        for line in loss_lines(&all, losses) {
            self.say(&line);
        }
    }
}

/// What a training lost, `all` being how many scenes: a sentence, and a line for each camera with its most
/// frequent reason. Every reason with its first scene would be a line of many hundred characters.
pub(crate) fn loss_lines(all: &str, losses: &Losses) -> Vec<String> {
    let mut cameras: BTreeMap<&str, (usize, (usize, LossReason))> = BTreeMap::new();
    for (camera, reason, scenes) in losses.iter() {
        let (sum, most) = cameras.entry(camera).or_insert((0, (0, reason)));
        *sum += scenes;
        if scenes > most.0 {
            *most = (scenes, reason);
        }
    }
    let advice = "they do no harm unless they are many: then move the rig's volume to where its cameras look";
    let first = format!("{all} scenes could not be used; {advice}");
    let lines = cameras.into_iter().map(|(camera, (sum, (_, reason)))| {
        let of = if camera.is_empty() { String::new() } else { format!("camera '{camera}': ") };
        format!("{of}{}, mostly: {reason}", counted(sum, "scene"))
    });
    std::iter::once(first).chain(lines).collect()
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.current().finish_and_clear();
    }
}
