//! Every descriptor that some level of fusion starts from.

use anyhow::Result;
use faer::Mat;
use phalanx_codebook::Encoder;
use phalanx_multiview::{PooledEncoder, Scratch, ViewEncoders};
use phalanx_shape_context::BINS;
use rayon::prelude::*;

use crate::data::described::{Described, vocabulary};

/// Codebooks learnt from one half of a split.
pub(super) struct Codebooks {
    /// All centres shared by the views.
    joined: ViewEncoders,
    /// All centres for one view, for each view.
    large: Vec<ViewEncoders>,
    /// All centres for all views together.
    pooled: PooledEncoder,
}

/// Descriptors of some samples, K × I each.
pub(super) struct Descriptors {
    /// All views' shape contexts in one histogram.
    pub(super) pooled: Mat<f64>,
    /// The views' histograms, one after the other.
    pub(super) joined: Mat<f64>,
    /// The same, view by view.
    pub(super) parts: Vec<Mat<f64>>,
    /// Each view's histogram of all the centres.
    pub(super) large: Vec<Mat<f64>>,
    /// The same, one after the other.
    pub(super) joined_large: Mat<f64>,
    /// Each view's histogram in the codebook that all share.
    pub(super) alike: Vec<Mat<f64>>,
}

impl Codebooks {
    pub(super) fn learn(described: &Described, samples: &[usize], seed: u64) -> Result<Self> {
        let views = described.contexts[0].len();
        let all: Vec<usize> = (0..views).collect();
        let one = |view| Ok(vocabulary(seed).fit(&described.seen(&[view], samples), BINS)?);
        Ok(Self {
            joined: vocabulary(seed).fit(&described.seen(&all, samples), BINS)?,
            large: all.par_iter().map(|&view| one(view)).collect::<Result<_>>()?,
            pooled: vocabulary(seed).pool(&described.seen(&all, samples), BINS)?,
        })
    }

    pub(super) fn describe(&self, described: &Described, samples: &[usize]) -> Result<Descriptors> {
        let all: Vec<usize> = (0..self.joined.views().len()).collect();
        let seen = described.seen(&all, samples);
        let joined = phalanx::descriptors(&self.joined, &seen)?;
        let mut end = 0;
        let parts = self.joined.views().iter().map(|encoder| {
            let begin = end;
            end += encoder.dim();
            joined.get(begin..end, ..).to_owned()
        });
        let parts = parts.collect();
        let of_view = |view: usize| described.seen(&[view], samples);
        let large = |view: usize| Ok(phalanx::descriptors(&self.large[view], &of_view(view))?);
        let large: Vec<Mat<f64>> = all.iter().map(|&view| large(view)).collect::<Result<_>>()?;
        let each = large[0].nrows();
        Ok(Descriptors {
            parts,
            joined,
            pooled: self.pool(&seen)?,
            joined_large: Mat::from_fn(each * large.len(), samples.len(), |k, i| {
                large[k / each][(k % each, i)]
            }),
            large,
            alike: all.iter().map(|&view| self.pool(&of_view(view))).collect::<Result<_>>()?,
        })
    }

    /// The pooled histograms of some samples' views.
    fn pool(&self, seen: &[Vec<&[f32]>]) -> Result<Mat<f64>> {
        let columns: Vec<Vec<f64>> = seen
            .par_iter()
            .map_init(Scratch::default, |scratch, views| {
                let mut column = vec![0.0; self.pooled.dim()];
                self.pooled.describe(views, scratch, &mut column)?;
                Ok(column)
            })
            .collect::<Result<_>>()?;
        Ok(Mat::from_fn(self.pooled.dim(), columns.len(), |k, i| columns[i][k]))
    }
}
