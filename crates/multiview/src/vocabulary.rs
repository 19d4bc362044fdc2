//! How the codebooks of the views are learnt.

use phalanx_codebook::{KMeans, Voting};

use crate::{Concatenation, Error, Result};

/// The codebooks to learn: the paper's 90 centres, shared evenly by the views, so that
/// descriptors of one view and of three have the same length (§ 2).
#[derive(Debug, Clone, PartialEq)]
pub struct Vocabulary {
    /// Centres of all views together.
    pub centres: usize,
    /// How the shape contexts vote.
    pub voting: Voting,
    /// At most this many shape contexts of each view are clustered, evenly spaced over all.
    pub most_samples: usize,
    /// The clustering; its number of centres is replaced by each view's share, and each view
    /// has a seed of its own that follows from this one.
    pub clustering: KMeans,
}

impl Default for Vocabulary {
    fn default() -> Self {
        Self {
            centres: 90,
            voting: Voting::default(),
            most_samples: 20_000,
            clustering: KMeans::default(),
        }
    }
}

impl Vocabulary {
    /// Learns a codebook for each view. `contexts[i][v]` holds the shape contexts of sample i
    /// in view v, `dim` numbers each, one after the other.
    ///
    /// # Errors
    /// No view, views that differ in number between samples, centres that cannot be shared
    /// evenly, or what clustering reports.
    pub fn fit<S: AsRef<[Vec<f32>]>>(&self, contexts: &[S], dim: usize) -> Result<Concatenation> {
        let views = contexts.first().map_or(0, |sample| sample.as_ref().len());
        if views == 0 {
            return Err(Error::NoViews);
        }
        let odd = contexts.iter().map(|sample| sample.as_ref().len()).find(|&n| n != views);
        if let Some(found) = odd {
            return Err(Error::ViewCount { expected: views, found });
        }
        if !self.centres.is_multiple_of(views) {
            return Err(Error::UnevenShare { centres: self.centres, views });
        }
        let codebooks = (0..views).map(|view| {
            let of_view: Vec<&[f32]> =
                contexts.iter().map(|sample| sample.as_ref()[view].as_slice()).collect();
            let clustering = KMeans {
                centres: self.centres / views,
                seed: self.clustering.seed.wrapping_mul(1_000_003).wrapping_add(view as u64),
                ..self.clustering
            };
            let fit = clustering.fit(&evenly_spaced(&of_view, dim, self.most_samples), dim);
            fit.map(|fit| fit.codebook).map_err(|source| Error::View { view, source })
        });
        Concatenation::from_parts(codebooks.collect::<Result<_>>()?, self.voting)
    }
}

/// At most `most` of the vectors of all samples, evenly spaced.
fn evenly_spaced(samples: &[&[f32]], dim: usize, most: usize) -> Vec<f32> {
    let vectors = || samples.iter().flat_map(|sample| sample.chunks_exact(dim));
    let total = samples.iter().map(|sample| sample.len() / dim).sum::<usize>();
    let kept = total.min(most);
    let mut spaced = Vec::with_capacity(kept * dim);
    let mut next = 0;
    for (k, vector) in vectors().enumerate() {
        if next < kept && k == next * total / kept {
            spaced.extend_from_slice(vector);
            next += 1;
        }
    }
    spaced
}
