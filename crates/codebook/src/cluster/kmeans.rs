use rand_pcg::Pcg64;

use crate::cluster::lloyd::Assignment;
use crate::cluster::seeding::Seeding;
use crate::codebook::Codebook;
use crate::distance::metric::Metric;
use crate::distance::packed::Packed;
use crate::error::{Error, Result};
use crate::samples;

/// K-means, with the χ² statistic unless told otherwise: the settings, and [`fit`](KMeans::fit).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KMeans {
    /// The number K of centres, at least 1.
    pub centres: usize,
    /// How many times to begin, each time from other seeds, at least 1. The best end is kept.
    pub restarts: usize,
    /// How many times at most to assign the samples in each, at least 1.
    pub max_iterations: usize,
    /// Stop once the distortion changes by no more than this fraction, 0 to 1.
    pub tolerance: f64,
    /// What the random numbers come from, together with the number of the restart.
    pub seed: u64,
    /// How samples are compared.
    pub metric: Metric,
    /// How many samples are drawn for each centre to begin with, at least 1, the best of which is
    /// taken. 1 is Arthur and Vassilvitskii's k-means++, more is their greedy variant, which takes
    /// longer to begin and tends to end better: 2 + ln K is usual.
    pub candidates: usize,
}

impl Default for KMeans {
    /// Ninety centres, as in the paper; three restarts of at most 100 iterations; to 1e-4; χ².
    fn default() -> Self {
        Self {
            centres: 90,
            restarts: 3,
            max_iterations: 100,
            tolerance: 1e-4,
            seed: 0,
            metric: Metric::ChiSquared,
            candidates: 1,
        }
    }
}

/// A codebook and how it came about.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The centres, with the last distortion as their scale (but no less than 1e-6, so that
    /// samples that *are* the centres make a usable codebook).
    pub codebook: Codebook,
    /// What happened.
    pub report: Report,
}

/// How the best restart went.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Report {
    /// Which restart it was, from 0.
    pub restart: usize,
    /// After each assignment, the mean distance of the samples to their nearest centres. It falls, with
    /// χ² but for small rises: the mean of the samples is not quite the minimiser of their χ². A rise is
    /// some 1e-4 of the distortion on 20,000 shape contexts, and up to 1e-3 when the centres have
    /// only a few scattered samples each.
    pub distortions: Vec<f64>,
    /// Whether the distortion settled before the iterations ran out.
    pub converged: bool,
    /// How many times a centre that had lost all its samples was moved to the worst-served one.
    pub reseeded: usize,
}

impl KMeans {
    /// Finds centres for vectors of `dim` numbers, given one after the other.
    ///
    /// Runs in rayon's current thread pool; the result is the same, bit for bit, in any. Keeps a
    /// second copy of the samples while it runs.
    ///
    /// # Errors
    /// A setting outside its range, no samples, not a whole number of them, one that the metric
    /// cannot compare (for χ², that is not a histogram that sums to 1), or fewer different samples than centres.
    ///
    /// ```
    /// use phalanx_codebook::{KMeans, Metric};
    ///
    /// let samples = [0.0, 0.2, 5.0, 5.2];
    /// let kmeans = KMeans { centres: 2, metric: Metric::Euclidean, ..KMeans::default() };
    /// let fit = kmeans.fit(&samples, 1)?;
    /// let mut centres = fit.codebook.centres().to_vec();
    /// centres.sort_by(f32::total_cmp);
    /// assert!((centres[0] - 0.1).abs() < 1e-6 && (centres[1] - 5.1).abs() < 1e-6);
    /// assert!((fit.report.distortions.last().unwrap() - 0.01).abs() < 1e-6);
    /// # Ok::<(), phalanx_codebook::Error>(())
    /// ```
    pub fn fit(&self, samples: &[f32], dim: usize) -> Result<Fit> {
        self.check()?;
        samples::check(self.metric, "sample", samples, dim)?;
        samples::check_count(samples.len() / dim, self.centres)?;
        let packed = Packed::new(self.metric, samples, dim);
        let (mut centres, mut report) = self.run(samples, dim, &packed, 0)?;
        for restart in 1..self.restarts {
            let (other_centres, other) = self.run(samples, dim, &packed, restart)?;
            if other.distortions.last() < report.distortions.last() {
                (centres, report) = (other_centres, other);
            }
        }
        let distortion = report.distortions.last().copied().unwrap_or_default();
        let codebook = Codebook::from_fit(self.metric, centres, dim, distortion)?;
        Ok(Fit { codebook, report })
    }

    pub(crate) fn check(&self) -> Result<()> {
        let at_least_one = |name, value| match value {
            0 => Err(Error::Parameter { name, must_be: "at least 1" }),
            _ => Ok(()),
        };
        at_least_one("centres", self.centres)?;
        at_least_one("restarts", self.restarts)?;
        at_least_one("max_iterations", self.max_iterations)?;
        at_least_one("candidates", self.candidates)?;
        if !(0.0..=1.0).contains(&self.tolerance) {
            return Err(Error::Parameter { name: "tolerance", must_be: "between 0 and 1" });
        }
        Ok(())
    }

    fn run(
        &self,
        samples: &[f32],
        dim: usize,
        packed: &Packed,
        restart: usize,
    ) -> Result<(Vec<f32>, Report)> {
        let mut rng = Pcg64::new(u128::from(self.seed), restart as u128);
        let seeding = Seeding { metric: self.metric, samples, dim, packed };
        let mut centres = seeding.seed(self.centres, self.candidates, &mut rng)?;
        let mut distances = vec![0.0; samples.len() / dim];
        let mut report = Report { restart, distortions: Vec::new(), converged: false, reseeded: 0 };
        loop {
            let assignment = Assignment::new(self.metric, samples, dim, &centres, &mut distances);
            let distortion = assignment.distortion();
            report.converged = report
                .distortions
                .last()
                .is_some_and(|last: &f64| (last - distortion).abs() <= self.tolerance * last);
            report.distortions.push(distortion);
            // The centres are not moved any more: the last distortion is theirs.
            if report.converged || report.distortions.len() == self.max_iterations {
                return Ok((centres, report));
            }
            report.reseeded += assignment.move_centres(samples, &mut centres, &mut distances);
        }
    }
}
