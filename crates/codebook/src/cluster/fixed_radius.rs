use pulp::Arch;
use rand_core::Rng;
use rand_pcg::Pcg64;

use crate::codebook::Codebook;
use crate::distance::metric::Metric;
use crate::distance::packed::Packed;
use crate::distance::support::Support;
use crate::error::{Error, Result};
use crate::samples;

/// Centres that cover the samples evenly, wherever these are dense or sparse (Jurie and Triggs,
/// 2005): balls of one radius. K-means spends most centres where most samples are, which are often
/// those that tell the least.
///
/// In each round a few of the samples that no ball covers are drawn; a centre climbs from the one
/// with the most others around it to the middle of its neighbourhood by mean shift; and what its
/// ball covers is out of the game.
///
/// ```
/// use phalanx_codebook::{FixedRadius, Metric};
///
/// // Three places, one of them with most of the samples.
/// let mut samples = vec![0.0; 96];
/// samples.extend([5.0, 9.0]);
/// let cover = FixedRadius { radius: 1.0, metric: Metric::Euclidean, ..FixedRadius::default() };
/// assert_eq!(cover.fit(&samples, 1)?.len(), 3);
/// # Ok::<(), phalanx_codebook::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FixedRadius {
    /// The distance from a centre at which its ball ends, as the metric has it (of the Euclidean
    /// one, the square); above 0.
    pub radius: f64,
    /// Stop at so many centres, at least 1, whatever is left uncovered.
    pub most: usize,
    /// How many uncovered samples are looked at in a round, at least 1.
    pub drawn: usize,
    /// What the random numbers come from.
    pub seed: u64,
    /// How samples are compared.
    pub metric: Metric,
}

impl Default for FixedRadius {
    /// χ² up to 0.2; at most 1,000 centres; 500 samples a round.
    fn default() -> Self {
        Self { radius: 0.2, most: 1000, drawn: 500, seed: 0, metric: Metric::ChiSquared }
    }
}

/// How often a centre is moved at most; a few times are enough to settle.
const SHIFTS: usize = 20;

impl FixedRadius {
    /// Finds centres for vectors of `dim` numbers, given one after the other, those of the densest
    /// places first. The codebook's scale is the radius.
    ///
    /// # Errors
    /// A setting outside its range, no samples, not a whole number of them, or one that the metric
    /// cannot compare.
    pub fn fit(&self, samples: &[f32], dim: usize) -> Result<Codebook> {
        self.check()?;
        samples::check(self.metric, "sample", samples, dim)?;
        let mut rng = Pcg64::new(u128::from(self.seed), 0);
        let mut uncovered: Vec<&[f32]> = samples.chunks_exact(dim).collect();
        let mut centres = Vec::new();
        while !uncovered.is_empty() && centres.len() < self.most * dim {
            draw_to_front(&mut uncovered, self.drawn, &mut rng);
            let drawn = &uncovered[..self.drawn.min(uncovered.len())];
            let centre = self.climb(drawn, dim);
            uncovered.retain(|sample| self.metric.distance(&centre, sample) > self.radius);
            centres.extend(centre);
        }
        Codebook::with_metric(self.metric, centres, dim, self.radius)
    }

    fn check(&self) -> Result<()> {
        let Self { radius, most, drawn, .. } = *self;
        if !(radius.is_finite() && radius > 0.0) {
            return Err(Error::Parameter { name: "radius", must_be: "finite and positive" });
        }
        if most == 0 || drawn == 0 {
            let name = if most == 0 { "most" } else { "drawn" };
            return Err(Error::Parameter { name, must_be: "at least 1" });
        }
        Ok(())
    }

    /// From the sample with the most others around it to the mean of these, and on, while that has
    /// more around it, and as long as the first sample is still covered.
    fn climb(&self, drawn: &[&[f32]], dim: usize) -> Vec<f32> {
        let packed = Packed::new(self.metric, &drawn.concat(), dim);
        let (mut support, mut distances) = (Support::default(), Vec::new());
        let mut around = |centre: &[f32]| -> Vec<usize> {
            packed.load(centre, &mut support);
            packed.whole().compare(Arch::new(), &support, &mut distances);
            let is_near = |&i: &usize| f64::from(distances[i]) <= self.radius;
            (0..drawn.len()).filter(is_near).collect()
        };
        let counts: Vec<usize> = drawn.iter().map(|sample| around(sample).len()).collect();
        let densest = (0..drawn.len()).fold(0, |a, b| if counts[b] > counts[a] { b } else { a });
        let start = drawn[densest];
        let mut centre = start.to_vec();
        let mut members = around(&centre);
        for _ in 0..SHIFTS {
            let next = mean(members.iter().map(|&i| drawn[i]), dim);
            let of_next = around(&next);
            let leaves = self.metric.distance(&next, start) > self.radius;
            if leaves || of_next.len() <= members.len() {
                break;
            }
            (centre, members) = (next, of_next);
        }
        centre
    }
}

/// Brings `count` of the samples to the front, each as likely as any other.
fn draw_to_front(samples: &mut [&[f32]], count: usize, rng: &mut Pcg64) {
    for i in 0..count.min(samples.len()) {
        let left = (samples.len() - i) as u64;
        samples.swap(i, i + (rng.next_u64() % left) as usize);
    }
}

fn mean<'a>(members: impl ExactSizeIterator<Item = &'a [f32]>, dim: usize) -> Vec<f32> {
    let count = members.len() as f64;
    let mut sums = vec![0.0; dim];
    for member in members {
        sums.iter_mut().zip(member).for_each(|(sum, &value)| *sum += f64::from(value));
    }
    sums.into_iter().map(|sum| (sum / count) as f32).collect()
}
