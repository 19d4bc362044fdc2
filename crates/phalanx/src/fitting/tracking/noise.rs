//! How much a hand's velocity changes, and how much frames tell, learnt as a take goes on.

use phalanx_hand::Dof;
use serde::{Deserialize, Serialize};

use crate::fitting::motion::FREEDOM;

/// Which numbers are learnt together: the digits and the wrist, the hand's turn, its place.
const GROUPS: usize = 3;

/// Before anything is learnt a hand may move as fast as this: 300°/s, 1 m/s.
const USUAL_SPEEDS: [f64; GROUPS] = [5.2, 5.2, 1000.0];

/// And it may take up that speed, or lose it, within so many seconds.
const TURNS_WITHIN: f64 = 0.1;

/// Accelerations of speed / time that last for that time.
const USUAL_DENSITY: [f64; GROUPS] = [
    USUAL_SPEEDS[0] * USUAL_SPEEDS[0] / TURNS_WITHIN,
    USUAL_SPEEDS[1] * USUAL_SPEEDS[1] / TURNS_WITHIN,
    USUAL_SPEEDS[2] * USUAL_SPEEDS[2] / TURNS_WITHIN,
];

/// What is learnt stays within this factor of what it was at first: a picture that stands still would let
/// variances shrink to nothing.
const FARTHEST: f64 = 1e6;

fn within(value: f64, first: f64) -> f64 {
    value.clamp(first / FARTHEST, first * FARTHEST)
}

/// Frames in which what was learnt is forgotten to a third.
const MEMORY: f64 = 10.0;

/// An innovation of more than so many deviations counts as one of so many.
const MOST: f64 = 3.0;

/// The median of a normal distribution's squares is this share of their mean.
const MEDIAN_SQUARE: f64 = 0.4549;

/// Less of a number's variance than this is not said by a frame that says something about it.
const TOLD: f64 = 0.1;

/// What a motion is predicted with.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct MotionNoise {
    /// Spectral density of what changes velocities, in squares of a number's unit per s³, by group.
    density: [f64; GROUPS],
    /// What a unit of a fit's energy counts.
    unit: f64,
    /// The same before anything was learnt.
    first_unit: f64,
    /// What the frame before told that had not been predicted, in deviations.
    before: [f64; Dof::COUNT],
}

fn group(number: usize) -> usize {
    match number {
        k if k < Dof::ThetaX.index() => 0,
        k if k < Dof::TX.index() => 1,
        _ => 2,
    }
}

impl MotionNoise {
    /// Nothing is learnt yet; a unit of a fit's energy counts `unit`.
    pub(super) fn new(unit: f64) -> Self {
        Self { density: USUAL_DENSITY, unit, first_unit: unit, before: [0.0; Dof::COUNT] }
    }

    /// The speed of each number, a standard deviation, before anything is known of it.
    pub(super) fn usual_speeds() -> [f64; Dof::COUNT] {
        std::array::from_fn(|k| USUAL_SPEEDS[group(k)])
    }

    /// The density of every number.
    pub(super) fn densities(&self) -> [f64; Dof::COUNT] {
        std::array::from_fn(|k| self.density[group(k)])
    }

    /// What a unit of a fit's energy counts.
    pub(super) fn unit(&self) -> f64 {
        self.unit
    }

    /// How many times the variance of each number must be if its change, `offset`, is one of a process with
    /// heavy tails (the weights of Student's distribution; Lange, Little and Taylor 1989).
    pub(super) fn inflation(
        offset: &[f64; Dof::COUNT],
        variances: &[f64; Dof::COUNT],
    ) -> [f64; Dof::COUNT] {
        std::array::from_fn(|k| {
            let square = offset[k] * offset[k] / variances[k];
            ((FREEDOM + square) / (FREEDOM + 1.0)).max(1.0)
        })
    }

    /// Learns from a frame: how far each number came out from where it was predicted, with which variance,
    /// and the variance that is left of it.
    ///
    /// Of a filter that is right, what frames tell that had not been predicted is white (Mehra 1970): where
    /// it goes on in one direction, velocities change more than was thought, where it goes to and fro, less.
    /// How large it is on the whole, robustly, says how much all variances are.
    pub(super) fn learn(
        &mut self,
        offset: &[f64; Dof::COUNT],
        before: &[f64; Dof::COUNT],
        after: &[f64; Dof::COUNT],
    ) {
        let mut told = [0.0; Dof::COUNT];
        let mut squares = Vec::with_capacity(Dof::COUNT);
        let (mut products, mut counts) = ([0.0; GROUPS], [0.0; GROUPS]);
        for k in 0..Dof::COUNT {
            let variance = before[k] - after[k];
            if variance < TOLD * before[k] {
                continue;
            }
            told[k] = (offset[k] / variance.sqrt()).clamp(-MOST, MOST);
            squares.push(told[k] * told[k]);
            products[group(k)] += told[k] * self.before[k];
            counts[group(k)] += 1.0;
        }
        self.before = told;
        if squares.is_empty() {
            return;
        }
        for (group, density) in self.density.iter_mut().enumerate() {
            let product = products[group] / f64::max(counts[group], 1.0);
            *density *= (product.clamp(-1.0, 1.0) / MEMORY).exp();
        }
        squares.sort_by(f64::total_cmp);
        let size = squares[squares.len() / 2] / MEDIAN_SQUARE;
        let size = size.clamp(1.0 / MOST, MOST).powf(1.0 / MEMORY);
        self.density.iter_mut().for_each(|density| *density *= size);
        self.unit = within(self.unit / size, self.first_unit);
        for (density, usual) in self.density.iter_mut().zip(USUAL_DENSITY) {
            *density = within(*density, usual);
        }
    }
}
