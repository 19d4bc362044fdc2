use serde::{Deserialize, Serialize};

use crate::cluster::gaussian_mixture::GaussianMixture;
use crate::distance::metric::Metric;
use crate::encode::encoder::{Encoder, check_length, normalise};
use crate::encode::scratch::Scratch;
use crate::error::Result;
use crate::samples;

/// The Fisher vector: how a mixture of Gaussians would have to change to fit the samples better
/// (Perronnin and Dance, 2007), by its means and its deviations.
///
/// As Perronnin, Sánchez and Mensink (2010) advise, of each number the root is taken, its sign
/// kept, and the whole has length 1; the derivative by the weights says little and is left out.
///
/// ```
/// use phalanx_codebook::{Encoder, Fisher, GaussianMixture, MixtureParts, Scratch};
///
/// let (weights, means, variances) = (vec![1.0], vec![0.0], vec![1.0]);
/// let mixture = GaussianMixture::from_parts(MixtureParts { dim: 1, weights, means, variances })?;
/// let mut code = [0.0; 2];
/// Fisher { mixture }.encode(&[3.0, 3.2], &mut Scratch::default(), &mut code)?;
/// assert!(code[0] > 0.0 && code[1] > 0.0); // the mean should move up, and the deviation grow
/// # Ok::<(), phalanx_codebook::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Fisher {
    /// The mixture.
    pub mixture: GaussianMixture,
}

impl Encoder for Fisher {
    fn bins(&self) -> usize {
        self.mixture.dim()
    }

    /// 2 × components × the length of a sample.
    fn dim(&self) -> usize {
        2 * self.mixture.len() * self.mixture.dim()
    }

    /// The derivatives by the means, component by component, then those by the deviations.
    fn encode(&self, samples: &[f32], scratch: &mut Scratch, out: &mut [f64]) -> Result<()> {
        let dim = self.bins();
        check_length(out, self.dim())?;
        samples::check(Metric::Euclidean, "sample", samples, dim)?;
        out.fill(0.0);
        let (by_means, by_deviations) = out.split_at_mut(self.mixture.len() * dim);
        let shares = &mut scratch.weights;
        for sample in samples.chunks_exact(dim) {
            self.mixture.responsibilities(sample, shares);
            for (k, &share) in shares.iter().enumerate() {
                let (mean, variance) = self.mixture.component(k);
                let at = k * dim..(k + 1) * dim;
                let of_component = by_means[at.clone()].iter_mut().zip(&mut by_deviations[at]);
                let of_sample = sample.iter().zip(mean).zip(variance);
                for ((first, second), ((&x, &m), &v)) in of_component.zip(of_sample) {
                    let standard = (f64::from(x) - f64::from(m)) / f64::from(v).sqrt();
                    *first += share * standard;
                    *second +=
                        share * (standard * standard - 1.0) * std::f64::consts::FRAC_1_SQRT_2;
                }
            }
        }
        let count = (samples.len() / dim) as f64;
        for (k, weight) in self.mixture.parts().weights.iter().enumerate() {
            let information = count * weight.sqrt();
            for part in [&mut *by_means, &mut *by_deviations] {
                part[k * dim..(k + 1) * dim].iter_mut().for_each(|value| *value /= information);
            }
        }
        normalise(out);
        Ok(())
    }
}
