use pulp::Arch;
use serde::{Deserialize, Serialize};

use crate::codebook::Codebook;
use crate::encode::encoder::Encoder;
use crate::encode::nearest::{Rank, find_nearest};
use crate::encode::scratch::Scratch;
use crate::error::{Error, Result};
use crate::samples;

/// How samples vote.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct SoftAssignment {
    /// Into how many of the nearest centres each sample votes, 1 to K; with 1, as in
    /// [`HARD`](Self::HARD), every vote is whole: a histogram of nearest centres.
    pub neighbours: usize,
}

impl SoftAssignment {
    /// Hard assignment: each sample's whole vote goes to the nearest centre.
    pub const HARD: Self = Self { neighbours: 1 };
}

impl Default for SoftAssignment {
    /// Five neighbours.
    fn default() -> Self {
        Self { neighbours: 5 }
    }
}

/// Soft votes into a codebook's centres, as an encoder like any other.
#[derive(Debug, Clone, Copy)]
pub struct SoftHistogram<'a> {
    /// The centres.
    pub codebook: &'a Codebook,
    /// How samples vote.
    pub assignment: SoftAssignment,
}

impl Encoder for SoftHistogram<'_> {
    fn bins(&self) -> usize {
        self.codebook.dim()
    }

    fn dim(&self) -> usize {
        self.codebook.len()
    }

    fn encode(&self, samples: &[f32], scratch: &mut Scratch, out: &mut [f64]) -> Result<()> {
        self.codebook.soft_assign(samples, self.assignment, scratch, out)
    }
}

impl Codebook {
    /// The histogram of the samples' votes (Agarwal and Triggs, 2006; de Campos and Murray, 2006,
    /// section 2), written to `out`, one number per centre.
    ///
    /// `samples` are vectors of [`dim`](Self::dim) numbers one after the other. Each votes into its
    /// nearest centres with weights exp(−d/s) that sum to 1, d being the distance (χ², or the squared Euclidean
    /// one) and s the [`scale`](Self::scale);
    /// the votes are divided by the number of samples, so that `out` sums to 1 too.
    ///
    /// # Errors
    /// No samples, not a whole number of them, one that the metric cannot compare, no
    /// neighbours or more than centres, or an output of another length than the centres'.
    ///
    /// ```
    /// use phalanx_codebook::{Codebook, Scratch, SoftAssignment};
    ///
    /// let codebook = Codebook::from_parts(vec![1.0, 0.0, 0.0, 1.0], 2, 0.5)?;
    /// let samples = [1.0, 0.0, 0.5, 0.5]; // one is a centre, the other halfway
    /// let mut votes = [0.0; 2];
    /// codebook.soft_assign(&samples, SoftAssignment { neighbours: 2 }, &mut Scratch::default(), &mut votes)?;
    /// assert!(votes[0] > votes[1] && votes[1] > 0.25);
    /// assert!((votes[0] + votes[1] - 1.0).abs() < 1e-12);
    /// # Ok::<(), phalanx_codebook::Error>(())
    /// ```
    pub fn soft_assign(
        &self,
        samples: &[f32],
        assignment: SoftAssignment,
        scratch: &mut Scratch,
        out: &mut [f64],
    ) -> Result<()> {
        let SoftAssignment { neighbours } = assignment;
        let centres = self.len();
        if neighbours == 0 || neighbours > centres {
            return Err(Error::Neighbours { neighbours, centres });
        }
        if out.len() != centres {
            return Err(Error::OutputLength { length: out.len(), centres });
        }
        samples::check(self.metric(), "sample", samples, self.dim())?;

        out.fill(0.0);
        let Scratch { support, distances, ranks, weights } = scratch;
        let arch = Arch::new();
        for sample in samples.chunks_exact(self.dim()) {
            self.packed.load(sample, support);
            let smallest = self.packed.whole().compare(arch, support, distances);
            let nearest = find_nearest(&distances[..centres], neighbours, ranks);
            // The nearest one's weight is 1, however far it is.
            let weight = |rank: &Rank| (f64::from(smallest - rank.distance()) / self.scale()).exp();
            weights.clear();
            weights.extend(nearest.iter().map(weight));
            let total: f64 = weights.iter().sum();
            for (rank, weight) in nearest.iter().zip(&*weights) {
                out[rank.centre()] += weight / total;
            }
        }
        let count = (samples.len() / self.dim()) as f64;
        for votes in out {
            *votes /= count;
        }
        Ok(())
    }
}
