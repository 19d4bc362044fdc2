//! The normal equations that ridge, sparse and relevance vector solvers work on.

use faer::{Mat, MatRef};

use crate::basis::spec::BasisSpec;
use crate::data::scaler::StandardScaler;
use crate::model::Model;
use crate::model::parts::{ModelParts, Posterior};

/// Normal equations of p centred basis columns Φ (n×p) and m centred, standardised targets Y
/// (n×m). A solver sees no more of the data than this.
pub(crate) trait Equations {
    /// The basis of the columns.
    fn columns(&self) -> &BasisSpec;

    /// Number of samples n.
    fn samples(&self) -> usize;

    /// What centring subtracted from each column.
    fn means(&self) -> &[f64];

    /// What centring subtracted from each standardised target.
    fn target_means(&self) -> &[f64];

    /// G = ΦᵀΦ (the paper's F Fᵀ), p×p.
    fn gram(&self) -> Mat<f64>;

    /// One column of G.
    fn gram_column(&self, k: usize) -> Vec<f64>;

    /// The diagonal of G.
    fn gram_diagonal(&self) -> Vec<f64>;

    /// B = ΦᵀY, p×m.
    fn correlations(&self) -> Mat<f64>;

    /// ‖yⱼ‖² of each target.
    fn energies(&self) -> Vec<f64>;

    /// ‖Y‖².
    fn energy(&self) -> f64 {
        self.energies().iter().sum()
    }

    /// ‖yⱼ − Φ wⱼ‖² of each target for weights (kept×m) on the columns `kept`.
    fn residuals(&self, kept: &[usize], weights: MatRef<'_, f64>) -> Vec<f64>;
}

/// The model on the columns `kept` with standardised `weights` (kept×m), standardised noise
/// deviations per target and the posterior over `kept`.
pub(crate) fn model(
    equations: &dyn Equations,
    kept: &[usize],
    weights: MatRef<'_, f64>,
    noise: &[f64],
    posterior: Posterior,
) -> Model {
    let columns = equations.columns();
    let (inputs, targets) = (columns.input_scaling(), columns.target_scaling());
    let (features, basis) = columns.keep(kept);
    let scale = targets.scale();
    let parts = ModelParts {
        inputs: inputs.scale().len(),
        outputs: scale.len(),
        feature_means: features.iter().map(|&f| inputs.mean()[f]).collect(),
        feature_scales: features.iter().map(|&f| inputs.scale()[f]).collect(),
        features,
        basis,
        column_means: kept.iter().map(|&k| equations.means()[k]).collect(),
        weights: (0..kept.len())
            .flat_map(|k| scale.iter().enumerate().map(move |(j, s)| s * weights[(k, j)]))
            .collect(),
        bias: bias(targets, equations.target_means()),
        noise: scale.iter().zip(noise).map(|(s, noise)| s * noise).collect(),
        posterior,
    };
    Model::trusted(parts)
}

/// Means of the targets, in their units.
fn bias(targets: &StandardScaler, standardised: &[f64]) -> Vec<f64> {
    let units = targets.mean().iter().zip(targets.scale());
    units.zip(standardised).map(|((mean, scale), z)| mean + scale * z).collect()
}
