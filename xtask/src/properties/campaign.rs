//! How far a campaign has come, and what it found.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

use super::discovery::Property;
use super::trial::{self, Draw};
use phalanx_lab::files;

/// A property whose cases take longer than this, s, is tried on a tenth of them.
const SLOW: f64 = 0.02;

/// How many cases tell whether a property is slow.
const FIRST: u32 = 20;

/// How many cases of a slow property are tried at a time, and how many of any other.
const SLOW_PIECE: u32 = 50;
const PIECE: u32 = 500;

#[derive(Default, Serialize, Deserialize)]
struct State {
    /// By property and seed.
    progress: BTreeMap<String, BTreeMap<u32, Progress>>,
    /// By property.
    finds: BTreeMap<String, Find>,
}

#[derive(Default, Clone, Copy, Serialize, Deserialize)]
struct Progress {
    cases: u32,
    seconds: f64,
}

#[derive(Serialize, Deserialize)]
struct Find {
    draw: Draw,
    message: String,
}

pub(super) struct Campaign {
    path: PathBuf,
    state: State,
}

impl Progress {
    fn is_slow(self) -> bool {
        self.seconds > SLOW * f64::from(self.cases)
    }

    fn wanted(self, cases: u32) -> u32 {
        if self.is_slow() { cases.div_ceil(10) } else { cases }
    }
}

impl Campaign {
    /// The campaign of a state file, or a new one if there is none.
    pub(super) fn read(path: PathBuf) -> Result<Self> {
        let state = match std::fs::read(&path) {
            Ok(bytes) => {
                serde_json::from_slice(&bytes).with_context(|| path.display().to_string())?
            }
            Err(_) => State::default(),
        };
        Ok(Self { path, state })
    }

    pub(super) fn is_sound(&self) -> bool {
        self.state.finds.is_empty()
    }

    /// Tries again what failed, and forgets what no longer does.
    pub(super) fn retry(&mut self, properties: &[Property]) -> Result<()> {
        for property in properties {
            let name = property.to_string();
            if let Some(find) = self.state.finds.remove(&name) {
                self.attempt(property, find.draw)?;
            }
        }
        self.write()
    }

    /// Tries some more cases of a property; whether any were left.
    pub(super) fn advance(&mut self, property: &Property, seed: u32, cases: u32) -> Result<bool> {
        let name = property.to_string();
        if self.state.finds.contains_key(&name) {
            return Ok(false);
        }
        let progress = self.progress(&name, seed);
        let left = progress.wanted(cases).saturating_sub(progress.cases);
        if left == 0 {
            return Ok(false);
        }
        let piece = match progress {
            Progress { cases: 0, .. } => FIRST,
            _ if progress.is_slow() => SLOW_PIECE,
            _ => PIECE,
        };
        let draw = Draw {
            rng_seed: (u64::from(seed) << 32) | u64::from(progress.cases),
            cases: piece.min(left),
        };
        if let Some(seconds) = self.attempt(property, draw)? {
            let progress = Progress {
                cases: progress.cases + draw.cases,
                seconds: progress.seconds + seconds,
            };
            self.state.progress.entry(name).or_default().insert(seed, progress);
        }
        self.write()?;
        Ok(true)
    }

    /// Tries these cases and keeps what they found; the time that they took if they passed, s.
    fn attempt(&mut self, property: &Property, draw: Draw) -> Result<Option<f64>> {
        match trial::run(property, draw)? {
            Ok(seconds) => Ok(Some(seconds)),
            Err(message) => {
                eprintln!("{property}\n{message}\n");
                self.state.finds.insert(property.to_string(), Find { draw, message });
                Ok(None)
            }
        }
    }

    fn progress(&self, name: &str, seed: u32) -> Progress {
        let seeds = self.state.progress.get(name);
        seeds.and_then(|seeds| seeds.get(&seed)).copied().unwrap_or_default()
    }

    /// What was tried and what was found, for people.
    pub(super) fn report(&self, properties: &[Property], seeds: &[u32], cases: u32) -> String {
        let report = seeds.iter().map(|&seed| self.drawn(properties, seed, cases));
        let finds = self.state.finds.iter().map(|(name, Find { draw, message })| {
            let Draw { rng_seed, cases } = draw;
            format!(
                "\nfailed: {name}\n{message}\nagain: PROPTEST_RNG_SEED={rng_seed} \
                 PROPTEST_CASES={cases} cargo test --manifest-path {name} -- --exact\n"
            )
        });
        let report: String = report.chain(finds).collect();
        format!("{report}{} properties failed\n", self.state.finds.len())
    }

    /// How many cases a seed had.
    fn drawn(&self, properties: &[Property], seed: u32, cases: u32) -> String {
        let all = properties.iter().map(|property| self.progress(&property.to_string(), seed));
        let tried: Vec<Progress> = all.filter(|progress| progress.cases > 0).collect();
        let complete = tried.iter().filter(|progress| progress.cases >= progress.wanted(cases));
        let slow = tried.iter().filter(|progress| progress.is_slow());
        let drawn: u64 = tried.iter().map(|progress| u64::from(progress.cases)).sum();
        format!(
            "seed {seed}: {} of {} properties tried, {} of them on all {cases} cases \
             (a tenth of the {} slow ones); {drawn} cases\n",
            tried.len(),
            properties.len(),
            complete.count(),
            slow.count(),
        )
    }

    fn write(&self) -> Result<()> {
        files::write_whole(&self.path, &serde_json::to_vec_pretty(&self.state)?)
    }
}
