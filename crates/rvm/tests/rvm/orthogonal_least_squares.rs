//! Forward selection against a search that solves every candidate's least squares problem.

use faer::Mat;
use phalanx_rvm::{Kernel, OrthogonalLeastSquares, StandardScaler};
use proptest::prelude::*;

use crate::problems::{rows, smooth, solve};
use crate::property;

/// What ‖Y − AF‖² + λ‖A‖² is at best with only these linear columns, standardised:
/// ‖Y‖² − tr(B (G + λI)⁻¹ Bᵀ).
fn penalised_error(
    x: &Mat<f64>,
    y: &Mat<f64>,
    lambda: f64,
) -> phalanx_rvm::Result<impl Fn(&[usize]) -> f64 + use<>> {
    let z = StandardScaler::fit(x.as_ref())?.apply(x.as_ref())?;
    let targets = StandardScaler::fit(y.as_ref())?.apply(y.as_ref())?;
    Ok(move |chosen: &[usize]| {
        let f = rows(z.as_ref(), chosen);
        let system = &f * f.transpose() + lambda * Mat::<f64>::identity(f.nrows(), f.nrows());
        let right = &f * targets.transpose();
        let weights = solve(system.as_ref(), right.as_ref());
        targets.squared_norm_l2() - (right.transpose() * weights).diagonal().column_vector().sum()
    })
}

proptest! {
    #![proptest_config(property::cases(24))]

    #[test]
    fn each_column_is_the_best_next_one(seed in any::<u64>(), count in 1..=6_usize) {
        let (x, y) = smooth(seed, 8, 3, 30);
        let lambda = 0.1;
        let error = penalised_error(&x, &y, lambda)?;
        let mut chosen = Vec::new();
        let mut errors = Vec::new();
        for _ in 0..count {
            let extended = |k: usize| [&chosen[..], &[k]].concat();
            let (best, least) = (0..8)
                .filter(|k| !chosen.contains(k))
                .map(|k| (k, error(&extended(k))))
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .expect("columns are left");
            chosen.push(best);
            errors.push(least);
        }
        chosen.sort_unstable();
        let fit = OrthogonalLeastSquares { kernel: Kernel::Linear, count, lambda, sweeps: 0 }
            .fit(x.as_ref(), y.as_ref())?;
        prop_assert_eq!(fit.model.selected_features(), chosen);
        for (found, expected) in fit.report.traces[0].objective.iter().zip(&errors) {
            prop_assert!((found - expected).abs() < 1e-8 * expected, "{found} {expected}");
        }
    }

    /// Replacement ends where no single exchange of a column lowers the error further, and never
    /// above where forward selection alone does.
    #[test]
    fn replacement_ends_at_a_local_optimum(seed in any::<u64>(), count in 1..=4_usize) {
        let (x, y) = smooth(seed, 8, 3, 30);
        let lambda = 0.1;
        let error = penalised_error(&x, &y, lambda)?;
        let chosen = |sweeps| {
            let forward = OrthogonalLeastSquares { kernel: Kernel::Linear, count, lambda, sweeps };
            let fit = forward.fit(x.as_ref(), y.as_ref())?;
            Ok::<_, phalanx_rvm::Error>(fit.model.selected_features().to_vec())
        };
        let (alone, replaced) = (chosen(0)?, chosen(50)?);
        let reached = error(&replaced);
        prop_assert!(reached <= error(&alone) * (1.0 + 1e-12));
        for place in 0..count {
            for other in (0..8).filter(|k| !replaced.contains(k)) {
                let mut exchanged = replaced.clone();
                exchanged[place] = other;
                prop_assert!(error(&exchanged) >= reached * (1.0 - 1e-9));
            }
        }
    }
}
