//! Inputs that may be missing.

use rand_core::Rng;
use rand_pcg::Pcg64Mcg;

use crate::data::check;
use crate::error::{Error, Result};
use crate::mlp::network::Mlp;
use crate::mlp::scaling::Scaling;

/// Inputs that may be missing, in groups that are missing together, such as those of one sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct MissingInputs {
    /// The number of each input's group, below 64.
    pub groups: Vec<usize>,
    /// What is read in place of each input where it is missing.
    pub stand_ins: Vec<f64>,
    /// The sets of groups that may be all there is, at least one; bit g stands for group g.
    pub present: Vec<u64>,
}

/// A perceptron for inputs of which some are missing.
#[derive(Debug, Clone, PartialEq)]
pub struct IncompleteFit {
    /// The perceptron, which reads the stand-ins of what is missing. Its deviations are those of the first set.
    pub model: Mlp,
    /// For each set of groups the root mean square errors of the targets on the held-out samples.
    pub deviations: Vec<Vec<f64>>,
}

impl MissingInputs {
    pub(super) fn check(&self, inputs: usize) -> Result<()> {
        check::length("groups of inputs", inputs, self.groups.len())?;
        check::length("stand-ins", inputs, self.stand_ins.len())?;
        if let Some(&index) = self.groups.iter().find(|&&group| group >= 64) {
            return Err(Error::Index { what: "groups", index, available: 64 });
        }
        check::part(
            "stand_ins",
            "holds an unusable number",
            !self.stand_ins.iter().all(|&v| check::usable(v)),
        )?;
        check::part("present", "is empty", self.present.is_empty())
    }
}

/// What takes inputs out of samples.
pub(super) struct Absence<'a> {
    missing: &'a MissingInputs,
    /// The stand-ins, scaled.
    stand_ins: Vec<f32>,
}

impl<'a> Absence<'a> {
    pub(super) fn new(missing: &'a MissingInputs, scaling: &Scaling) -> Self {
        let pairs = missing.stand_ins.iter().zip(&scaling.mean);
        let stand_ins =
            pairs.map(|(value, mean)| ((value - mean) * scaling.factor) as f32).collect();
        Self { missing, stand_ins }
    }

    /// Takes inputs out of scaled samples, stored one after the other, each as a set drawn at random says.
    pub(super) fn at_random(&self, inputs: &mut [f32], random: &mut Pcg64Mcg) {
        let sets = &self.missing.present;
        for sample in inputs.chunks_exact_mut(self.stand_ins.len()) {
            // The bias of a remainder is below one in 2⁵⁰.
            self.leave(sets[(random.next_u64() % sets.len() as u64) as usize], sample);
        }
    }

    /// Leaves of each sample what is in a set.
    pub(super) fn leave(&self, present: u64, inputs: &mut [f32]) {
        for sample in inputs.chunks_exact_mut(self.stand_ins.len()) {
            let values = sample.iter_mut().zip(&self.stand_ins).zip(&self.missing.groups);
            for ((value, stand_in), group) in values {
                if present & (1 << group) == 0 {
                    *value = *stand_in;
                }
            }
        }
    }
}
