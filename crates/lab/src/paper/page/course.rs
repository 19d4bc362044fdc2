//! Progress through several experiments.

use std::sync::Mutex;

use phalanx::Progress;

use crate::progress::Bar;

/// A bar that says which of how many experiments a stage belongs to.
pub(crate) struct Course {
    bar: Bar,
    experiments: usize,
    current: Mutex<Current>,
}

#[derive(Default)]
struct Current {
    number: usize,
    name: &'static str,
}

impl Course {
    pub(crate) fn new(experiments: usize) -> Self {
        Self { bar: Bar::new(), experiments, current: Mutex::default() }
    }

    /// The next experiment begins.
    pub(crate) fn enter(&self, name: &'static str) {
        {
            let mut current = self.current.lock().expect("no holder of the lock panics");
            *current = Current { number: current.number + 1, name };
        }
        self.begin("", 1);
    }
}

impl Progress for Course {
    fn begin(&self, stage: &str, items: usize) {
        let current = self.current.lock().expect("no holder of the lock panics");
        let Current { number, name } = *current;
        self.bar.begin(&format!("{number}/{} {name} {stage}", self.experiments), items);
    }

    fn step(&self) {
        self.bar.step();
    }
}
