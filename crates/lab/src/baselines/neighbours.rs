//! Nearest neighbours: the simplest estimates to compare with.

use faer::{Mat, MatRef};
use phalanx_codebook::chi_squared;
use rayon::prelude::*;

/// For each column of `queries`, the mean of the targets of the `count` training columns that
/// are nearest in Euclidean distance; of equal ones the first.
pub(crate) fn nearest_mean(
    train: MatRef<'_, f64>,
    targets: MatRef<'_, f64>,
    queries: MatRef<'_, f64>,
    count: usize,
) -> Mat<f64> {
    let columns = |x: MatRef<'_, f64>| -> Vec<Vec<f64>> {
        (0..x.ncols()).map(|i| x.col(i).iter().copied().collect()).collect()
    };
    let train = columns(train);
    let nearest = |query: &Vec<f64>| -> Vec<usize> {
        let distance = |sample: &Vec<f64>| -> f64 {
            sample.iter().zip(query).map(|(a, b)| (a - b).powi(2)).sum()
        };
        let mut order: Vec<(f64, usize)> = train.iter().map(distance).zip(0..).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        order.into_iter().take(count).map(|(_, i)| i).collect()
    };
    let chosen: Vec<Vec<usize>> = columns(queries).par_iter().map(nearest).collect();
    Mat::from_fn(targets.nrows(), queries.ncols(), |row, query| {
        let chosen = &chosen[query];
        chosen.iter().map(|&i| targets[(row, i)]).sum::<f64>() / chosen.len() as f64
    })
}

/// For each column of `queries`, the number of the training column at the smallest χ²; of equal
/// ones the first. Columns are histograms, or several of them one after the other.
pub(crate) fn nearest_by_chi_squared(
    train: MatRef<'_, f64>,
    queries: MatRef<'_, f64>,
) -> Vec<usize> {
    let columns = |x: MatRef<'_, f64>| -> Vec<Vec<f32>> {
        (0..x.ncols()).map(|i| x.col(i).iter().map(|&votes| votes as f32).collect()).collect()
    };
    let train = columns(train);
    let nearest = |query: &Vec<f32>| {
        let distances = train.iter().map(|sample| chi_squared(sample, query)).enumerate();
        distances.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(i, _)| i)
    };
    columns(queries).par_iter().map(nearest).collect()
}

#[cfg(test)]
mod tests {
    use faer::mat;

    use super::*;

    #[test]
    fn the_mean_is_over_the_nearest() {
        let train = mat![[0.0, 1.0, 10.0, 2.0]];
        let targets = mat![[1.0, 3.0, 100.0, 8.0]];
        let queries = mat![[0.4]];
        let mean = nearest_mean(train.as_ref(), targets.as_ref(), queries.as_ref(), 3);
        assert_eq!(mean[(0, 0)], 4.0);
    }
    #[test]
    fn the_nearest_histogram_is_found() {
        let train = mat![[1.0, 0.5, 0.5], [0.0, 0.5, 0.5]];
        let queries = mat![[0.9, 0.4], [0.1, 0.6]];
        assert_eq!(nearest_by_chi_squared(train.as_ref(), queries.as_ref()), [0, 1]);
    }
}
