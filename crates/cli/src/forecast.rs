//! What a training is going to take.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use phalanx::{Cost, Losses, Progress};

use crate::counts::counted;
use crate::progress::Bar;

/// Says what a training takes: scenes and memory beforehand, and the time for drawing once some scenes
/// are drawn. Shows the progress.
pub(crate) struct Forecast {
    bar: Bar,
    cost: Cost,
    /// When drawing began, and how many scenes are drawn; nothing once the time has been said.
    drawn: Mutex<Option<(Instant, usize)>>,
}

impl Forecast {
    /// Scenes by which the time is known.
    const FIRST_BLOCK: usize = 256;

    pub(crate) fn new(cost: Cost, views: usize) -> Self {
        let Cost { scenes, bytes } = cost;
        let mebibytes = bytes.div_ceil(1 << 20);
        let (scenes, cameras) = (counted(scenes, "scene"), counted(views, "camera"));
        eprintln!("phalanx: {scenes} to draw for {cameras}; about {mebibytes} MiB");
        Self { bar: Bar::new(), cost, drawn: Mutex::new(Some((Instant::now(), 0))) }
    }

    /// Says something above the progress.
    pub(crate) fn say(&self, text: &str) {
        self.bar.say(text);
    }

    /// How long all scenes take, once the first block is drawn.
    fn time(&self) -> Option<Duration> {
        let mut drawn = self.drawn.lock().ok()?;
        let (since, count) = drawn.as_mut()?;
        *count += 1;
        if *count < Self::FIRST_BLOCK {
            return None;
        }
        let each = since.elapsed().div_f64(*count as f64);
        *drawn = None;
        Some(each.mul_f64(self.cost.scenes as f64))
    }
}

impl Progress for Forecast {
    fn begin(&self, stage: &str, items: usize) {
        self.bar.begin(stage, items);
    }

    fn step(&self) {
        self.bar.step();
        if let Some(time) = self.time() {
            let seconds = time.as_secs_f64();
            let time = match seconds {
                ..90.0 => format!("{seconds:.0} s"),
                _ => format!("{:.0} min", seconds / 60.0),
            };
            self.bar.say(&format!("drawing takes about {time}, and then fitting its time"));
        }
    }

    fn lost(&self, losses: &Losses, scenes: usize) {
        self.bar.lost(losses, scenes);
    }
}
