//! Forward selection against a search that solves every candidate's least squares problem.

use faer::Mat;
use phalanx_rvm::{ForwardSelection, Kernel, Standardiser};
use proptest::prelude::*;

use crate::problems::{few, rows, smooth, solve};

proptest! {
    #![proptest_config(few())]

    #[test]
    fn each_column_is_the_best_next_one(seed in any::<u64>(), count in 1..=6_usize) {
        let (x, y) = smooth(seed, 8, 3, 30);
        let lambda = 0.1;
        let z = Standardiser::fit(x.as_ref())?.apply(x.as_ref())?;
        let targets = Standardiser::fit(y.as_ref())?.apply(y.as_ref())?;
        // ‖Y‖² − tr(B (G + λI)⁻¹ Bᵀ) on these columns.
        let error = |chosen: &[usize]| {
            let f = rows(z.as_ref(), chosen);
            let system = &f * f.transpose() + lambda * Mat::<f64>::identity(f.nrows(), f.nrows());
            let right = &f * targets.transpose();
            let weights = solve(system.as_ref(), right.as_ref());
            targets.squared_norm_l2() - (right.transpose() * weights).diagonal().column_vector().sum()
        };
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
        let fit = ForwardSelection { kernel: Kernel::Linear, count, lambda }
            .fit(x.as_ref(), y.as_ref())?;
        prop_assert_eq!(fit.model.selected_features(), chosen);
        for (found, expected) in fit.report.traces[0].objective.iter().zip(&errors) {
            prop_assert!((found - expected).abs() < 1e-8 * expected, "{found} {expected}");
        }
    }
}
