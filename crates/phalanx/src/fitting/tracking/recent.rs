//! How far the last frames were from agreeing with what was seen.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

/// Frames that are remembered.
const FRAMES: usize = 32;

/// Of that share of them a frame is expected to be no worse than; others are looked at more closely.
const MOST: f64 = 0.75;

/// The last frames' misfits.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Recent {
    misfits: VecDeque<f64>,
}

impl Recent {
    /// Remembers a frame.
    pub(super) fn push(&mut self, misfit: f64) {
        if self.misfits.len() == FRAMES {
            self.misfits.pop_front();
        }
        self.misfits.push_back(misfit);
    }

    /// What three quarters of the frames do not exceed; 0 as long as there is none.
    pub(super) fn usual(&self) -> f64 {
        let mut sorted: Vec<f64> = self.misfits.iter().copied().collect();
        sorted.sort_by(f64::total_cmp);
        sorted.get((MOST * sorted.len() as f64) as usize).copied().unwrap_or_default()
    }
}
