//! Principal component analysis.

use anyhow::{Result, anyhow};
use faer::{Mat, MatRef, Side};

/// The principal axes of samples, the widest first, and where the samples lie along them.
pub(crate) struct PrincipalAxes {
    /// Each axis's part of the total variance.
    pub(crate) shares: Vec<f64>,
    /// The samples along the axes: axis × sample.
    scores: Mat<f64>,
}

impl PrincipalAxes {
    /// Of the columns of `x`.
    pub(crate) fn of(x: MatRef<'_, f64>) -> Result<Self> {
        let samples = x.ncols() as f64;
        let means: Vec<f64> =
            (0..x.nrows()).map(|k| x.row(k).iter().sum::<f64>() / samples).collect();
        let centred = Mat::from_fn(x.nrows(), x.ncols(), |k, i| x[(k, i)] - means[k]);
        let covariance = &centred * centred.transpose();
        let eigen = covariance
            .self_adjoint_eigen(Side::Lower)
            .map_err(|reason| anyhow!("the covariance has no eigenvectors: {reason:?}"))?;
        // Eigenvalues come in ascending order.
        let last = x.nrows() - 1;
        let variances: Vec<f64> = (0..=last).map(|k| eigen.S()[last - k].max(0.0)).collect();
        let total: f64 = variances.iter().sum();
        let axes = Mat::from_fn(x.nrows(), x.nrows(), |k, axis| eigen.U()[(k, last - axis)]);
        Ok(Self {
            shares: variances.iter().map(|variance| variance / total).collect(),
            scores: axes.transpose() * &centred,
        })
    }

    /// Where the samples lie along one axis, from their mean.
    pub(crate) fn scores(&self, axis: usize) -> Vec<f64> {
        self.scores.row(axis).iter().copied().collect()
    }

    /// How many of the widest axes hold `share` of the variance.
    pub(crate) fn holding(&self, share: f64) -> usize {
        let mut held = 0.0;
        let short = |part: &&f64| {
            held += **part;
            held < share
        };
        1 + self.shares.iter().take_while(short).count()
    }
}

#[cfg(test)]
mod tests {
    use faer::mat;

    use super::*;

    #[test]
    fn the_widest_axis_comes_first() {
        let x = mat![[0.0, 0.0, 1.0, -1.0], [-5.0, 5.0, 0.0, 0.0]];
        let axes = PrincipalAxes::of(x.as_ref()).unwrap();
        assert!((axes.shares[0] - 50.0 / 52.0).abs() < 1e-12);
        assert!((axes.scores(0)[1].abs() - 5.0).abs() < 1e-12);
        assert_eq!(axes.holding(0.9), 1);
        assert_eq!(axes.holding(0.99), 2);
    }
}
