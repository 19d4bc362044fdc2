//! Principal components of blocks of inputs.

use faer::{Mat, MatRef};
use rayon::prelude::*;

use crate::data::check;
use crate::error::Result;
use crate::linalg;

/// A block of consecutive inputs, and how many of its principal components are kept.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FeatureBlock {
    /// Number of inputs, at least 1; they follow those of the previous blocks.
    pub inputs: usize,
    /// Maximum number of components.
    pub components: usize,
}

/// The principal components of some inputs, brought to a total variance of 1.
pub(crate) struct Pca {
    pub(crate) mean: Vec<f64>,
    /// d×K: orthogonal rows, each of the same length.
    pub(crate) matrix: Mat<f64>,
}

impl Pca {
    /// Of the rows of `x`, K×n, at most so many, the strongest first.
    pub(crate) fn of(x: MatRef<'_, f64>, components: usize) -> Result<Self> {
        check::matrix("x", x)?;
        let n = x.ncols() as f64;
        let mean: Vec<f64> = x.row_iter().map(|row| row.iter().sum::<f64>() / n).collect();
        let centred = Mat::from_fn(x.ncols(), x.nrows(), |i, k| x[(k, i)] - mean[k]);
        // XᵀX and XXᵀ have the same eigenvalues, and Xᵀ takes the eigenvectors of one to those of the other. The
        // smaller one takes less time, by the cube of its size.
        let are_few = x.ncols() < x.nrows();
        let smaller = if are_few { centred.transpose() } else { centred.as_ref() };
        let eigen = linalg::eigen(&linalg::gram(smaller))?;
        let strong = |&k: &usize| eigen.values[k] > 1e-12 * eigen.values[0];
        let kept: Vec<usize> = (0..components.min(eigen.values.len())).filter(strong).collect();
        let total: f64 = kept.iter().map(|&k| eigen.values[k] / n).sum();
        let scale = if total > 0.0 { total.sqrt().recip() } else { 0.0 };
        let matrix = if are_few {
            let of_length_1 =
                |i: usize, d: usize| eigen.vectors[(i, kept[d])] / eigen.values[kept[d]].sqrt();
            let vectors = Mat::from_fn(x.ncols(), kept.len(), |i, d| scale * of_length_1(i, d));
            linalg::product(vectors.transpose(), centred.as_ref())
        } else {
            Mat::from_fn(kept.len(), x.nrows(), |d, k| scale * eigen.vectors[(k, kept[d])])
        };
        Ok(Self { mean, matrix })
    }
}

/// The principal components of each block of the rows of `x`, K×n.
pub(crate) fn of_blocks(x: MatRef<'_, f64>, blocks: &[FeatureBlock]) -> Result<Vec<Pca>> {
    check::length("inputs of all blocks", x.nrows(), blocks.iter().map(|b| b.inputs).sum())?;
    let starts = blocks.iter().scan(0, |next, block| {
        let start = *next;
        *next += block.inputs;
        Some((start, block))
    });
    let starts: Vec<(usize, &FeatureBlock)> = starts.collect();
    let of_block = |&(start, block): &(usize, &FeatureBlock)| {
        Pca::of(x.subrows(start, block.inputs), block.components)
    };
    starts.par_iter().map(of_block).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Repeated until they are more than the inputs, samples vary as they did before.
    #[test]
    fn few_samples_have_the_components_of_the_same_ones_repeated() {
        let (inputs, samples, times) = (9, 6, 2);
        let value = |k: usize, i: usize| ((1.3 + k as f64) * (0.4 + 0.7 * i as f64)).sin();
        let few = Mat::from_fn(inputs, samples, value);
        let many = Mat::from_fn(inputs, times * samples, |k, i| value(k, i % samples));
        // Six samples differ in five ways.
        for (components, expected) in [(3, 3), (9, 5)] {
            let [few, many] = [&few, &many].map(|x| Pca::of(x.as_ref(), components).unwrap());
            assert_eq!([few.matrix.nrows(), many.matrix.nrows()], [expected; 2]);
            for d in 0..expected {
                let pairs = || (0..inputs).map(|k| (few.matrix[(d, k)], many.matrix[(d, k)]));
                let sign: f64 = pairs().map(|(a, b)| a * b).sum::<f64>().signum();
                assert!(pairs().all(|(a, b)| (a - sign * b).abs() < 1e-9), "component {d}");
            }
            assert!(few.mean.iter().zip(&many.mean).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }

    #[test]
    fn samples_that_do_not_differ_have_no_components() {
        for samples in [1, 2, 9] {
            let pca = Pca::of(Mat::from_fn(4, samples, |k, _| k as f64).as_ref(), 3).unwrap();
            assert_eq!(pca.matrix.shape(), (0, 4), "{samples}");
        }
    }
}
