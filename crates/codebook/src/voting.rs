use pulp::Arch;
use serde::{Deserialize, Serialize};

use crate::{Codebook, Coding, Error, Result, packed::Support, samples};

/// How samples vote.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Voting {
    /// Into how many of the nearest centres each sample votes, 1 to K. With 1 every vote is whole:
    /// a histogram of nearest centres.
    pub neighbours: usize,
}

impl Default for Voting {
    /// Five neighbours.
    fn default() -> Self {
        Self { neighbours: 5 }
    }
}

/// The memory that coding needs, kept from one call to the next.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    pub(crate) support: Support,
    pub(crate) distances: Vec<f32>,
    ranks: Vec<Rank>,
    weights: Vec<f64>,
}

/// Soft votes into a codebook's centres, as a coding like any other.
#[derive(Debug, Clone, Copy)]
pub struct SoftCounts<'a> {
    /// The centres.
    pub codebook: &'a Codebook,
    /// How samples vote.
    pub voting: Voting,
}

impl Coding for SoftCounts<'_> {
    fn bins(&self) -> usize {
        self.codebook.dim()
    }

    fn dim(&self) -> usize {
        self.codebook.len()
    }

    fn encode(&self, samples: &[f32], scratch: &mut Scratch, out: &mut [f64]) -> Result<()> {
        self.codebook.soft_assign(samples, self.voting, scratch, out)
    }
}

impl Codebook {
    /// The histogram of the samples' votes (Agarwal and Triggs, 2006; de Campos and Murray, 2006,
    /// section 2), written to `out`, one number per centre.
    ///
    /// `samples` are histograms of [`dim`](Self::dim) bins one after the other. Each votes into its
    /// nearest centres with weights exp(−χ²/s) that sum to 1, s being the [`scale`](Self::scale);
    /// the votes are divided by the number of samples, so that `out` sums to 1 too.
    ///
    /// # Errors
    /// No samples, not a whole number of them, one that is not a histogram that sums to 1, no
    /// neighbours or more than centres, or an output of another length than the centres'.
    pub fn soft_assign(
        &self,
        samples: &[f32],
        voting: Voting,
        scratch: &mut Scratch,
        out: &mut [f64],
    ) -> Result<()> {
        let Voting { neighbours } = voting;
        let centres = self.len();
        if neighbours == 0 || neighbours > centres {
            return Err(Error::Neighbours { neighbours, centres });
        }
        if out.len() != centres {
            return Err(Error::OutputLength { length: out.len(), centres });
        }
        samples::check("sample", samples, self.dim())?;

        out.fill(0.0);
        let Scratch { support, distances, ranks, weights } = scratch;
        let arch = Arch::new();
        for sample in samples.chunks_exact(self.dim()) {
            support.find(sample);
            let smallest = self.packed.whole().compare(arch, support, distances);
            let nearest = find_nearest(&distances[..centres], neighbours, ranks);
            // The nearest one's weight is 1, however far it is.
            let weight =
                |rank: &Rank| (f64::from(smallest - rank.chi_squared()) / self.scale()).exp();
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

/// A centre's distance and, to settle ties, its index, in one number that orders them: the bits of
/// floats that are not negative are in the order of the floats.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Rank(u64);

impl Rank {
    fn new(centre: usize, chi_squared: f32) -> Self {
        Self(u64::from(chi_squared.to_bits()) << 32 | centre as u64)
    }

    fn chi_squared(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    fn centre(self) -> usize {
        self.0 as u32 as usize
    }
}

/// The `count` nearest centres, in no particular order.
fn find_nearest<'a>(distances: &[f32], count: usize, ranks: &'a mut Vec<Rank>) -> &'a [Rank] {
    ranks.clear();
    ranks.extend(distances.iter().enumerate().map(|(centre, &d)| Rank::new(centre, d)));
    if count < ranks.len() {
        ranks.select_nth_unstable(count);
    }
    &ranks[..count]
}
