use rand_pcg::Pcg64;

use crate::cluster::kmeans::KMeans;
use crate::cluster::lloyd::Assignment;
use crate::cluster::seeding::Seeding;
use crate::codebook::Codebook;
use crate::distance::metric::Metric;
use crate::distance::packed::Packed;
use crate::error::Result;
use crate::samples;

/// K-means for samples that do not fit into memory, which come in batches (Sculley, 2010).
///
/// Each sample moves its nearest centre towards itself by one over the number of samples that the
/// centre has had so far, so that a centre is the mean of all of them, and later batches move it
/// less and less. The same batches in the same order give the same bytes at any number of threads.
///
/// ```
/// use phalanx_codebook::{KMeans, MiniBatch};
///
/// let batch = [0.9, 0.1, 0.8, 0.2, 0.2, 0.8, 0.1, 0.9];
/// let settings = KMeans { centres: 2, ..KMeans::default() };
/// let mut clustering = MiniBatch::new(settings, &batch, 2)?;
/// for _ in 0..10 {
///     clustering.add(&batch)?; // in earnest, other samples each time
/// }
/// let codebook = clustering.finish()?;
/// assert!((codebook.centres()[0] - 0.5).abs() > 0.3);
/// # Ok::<(), phalanx_codebook::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct MiniBatch {
    metric: Metric,
    dim: usize,
    centres: Vec<f32>,
    /// How many samples each centre has had.
    counts: Vec<usize>,
    /// The mean distance of the last batch.
    distortion: f64,
}

impl MiniBatch {
    /// Draws the first centres from a batch by k-means++, and adds it.
    ///
    /// Of the settings the number of centres, the seed, the metric and the candidates count here;
    /// when to stop is the caller's choice.
    ///
    /// # Errors
    /// As of [`KMeans::fit`].
    pub fn new(settings: KMeans, batch: &[f32], dim: usize) -> Result<Self> {
        settings.check()?;
        let KMeans { metric, centres, candidates, seed, .. } = settings;
        samples::check(metric, "sample", batch, dim)?;
        samples::check_count(batch.len() / dim, centres)?;
        let packed = Packed::new(metric, batch, dim);
        let seeding = Seeding { metric, samples: batch, dim, packed: &packed };
        let seeds = seeding.seed(centres, candidates, &mut Pcg64::new(u128::from(seed), 0))?;
        let counts = vec![0; centres];
        let mut clustering = Self { metric, dim, centres: seeds, counts, distortion: 0.0 };
        clustering.add(batch)?;
        Ok(clustering)
    }

    /// Moves the centres by another batch; returns the mean distance of its samples to the centres
    /// nearest to them before.
    ///
    /// # Errors
    /// No samples, not a whole number of them, or one that the metric cannot compare.
    pub fn add(&mut self, batch: &[f32]) -> Result<f64> {
        let Self { metric, dim, .. } = *self;
        samples::check(metric, "sample", batch, dim)?;
        let mut distances = vec![0.0; batch.len() / dim];
        let assignment = Assignment::new(metric, batch, dim, &self.centres, &mut distances);
        assignment.draw_centres(&mut self.centres, &mut self.counts);
        self.distortion = assignment.distortion();
        Ok(self.distortion)
    }

    /// The codebook; its scale is the mean distance of the last batch.
    ///
    /// # Errors
    /// None that its batches have not shown.
    pub fn finish(self) -> Result<Codebook> {
        Codebook::from_fit(self.metric, self.centres, self.dim, self.distortion)
    }
}
