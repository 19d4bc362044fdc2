use pulp::Arch;
use serde::{Deserialize, Serialize};

use crate::codebook::{Codebook, first_equal};
use crate::encode::encoder::{Encoder, check_length, normalise};
use crate::encode::scratch::Scratch;
use crate::error::Result;
use crate::samples;

/// The vector of locally aggregated descriptors: what is left of the samples when their nearest
/// centres are taken away, summed for each centre (Jégou, Douze, Schmid and Pérez, 2010).
///
/// Counts tell how many samples are near a centre, residuals to which side of it they lie, so that
/// few centres say much. As Jégou et al. (2012) advise, of each sum the root is taken, its sign
/// kept, so that no frequent sample drowns the others, and the whole has length 1.
///
/// ```
/// use phalanx_codebook::{Codebook, Encoder, Metric, Scratch, Vlad};
///
/// let codebook = Codebook::with_metric(Metric::Euclidean, vec![0.0, 10.0], 1, 1.0)?;
/// let mut code = [0.0; 2];
/// Vlad { codebook }.encode(&[-1.0, 14.0], &mut Scratch::default(), &mut code)?;
/// assert!(code[0] < 0.0 && code[1] > 0.0); // below the first centre, above the second
/// # Ok::<(), phalanx_codebook::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Vlad {
    /// The centres; their scale is not used.
    pub codebook: Codebook,
}

impl Encoder for Vlad {
    fn bins(&self) -> usize {
        self.codebook.dim()
    }

    /// K centres times the bins.
    fn dim(&self) -> usize {
        self.codebook.centres().len()
    }

    /// Centre by centre. Samples that are all at their centres have a code of zeros.
    fn encode(&self, samples: &[f32], scratch: &mut Scratch, out: &mut [f64]) -> Result<()> {
        let bins = self.bins();
        check_length(out, self.dim())?;
        samples::check(self.codebook.metric(), "sample", samples, bins)?;
        out.fill(0.0);
        let Scratch { support, distances, .. } = scratch;
        let arch = Arch::new();
        for sample in samples.chunks_exact(bins) {
            self.codebook.packed.load(sample, support);
            let smallest = self.codebook.packed.whole().compare(arch, support, distances);
            let start = first_equal(distances, smallest) * bins;
            let centre = &self.codebook.centres()[start..start + bins];
            for ((sum, &height), &of_centre) in
                out[start..start + bins].iter_mut().zip(sample).zip(centre)
            {
                *sum += f64::from(height) - f64::from(of_centre);
            }
        }
        normalise(out);
        Ok(())
    }
}
