//! Nyström regression against kernel ridge, and against dense solutions of its own equations.

use faer::{Mat, MatRef};
use phalanx_rvm::{
    Bandwidth, Kernel, KernelRidge, NystromRegularisation, NystromRidge, PilotSample, Regressor,
    Regularisation, StandardScaler, SufficientStatistics, random_subset,
};
use proptest::prelude::*;

use crate::problems::{close, columns, smooth, solve};
use crate::property;

const BETA: f64 = 0.2;
/// Added to the kernel between the centres.
const JITTER: f64 = 1e-6;

fn nystrom(penalty: NystromRegularisation) -> NystromRidge {
    NystromRidge {
        bandwidth: Bandwidth::Gamma(BETA),
        regularisation: penalty,
        ..NystromRidge::default()
    }
}

/// exp(−β‖a − b‖²) for each column a of the one and b of the other.
fn kernel(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    Mat::from_fn(a.ncols(), b.ncols(), |i, j| {
        (-BETA * (a.col(i) - b.col(j)).squared_norm_l2()).exp()
    })
}

/// The penalty's matrix, with the jitter.
fn penalty(centres: MatRef<'_, f64>) -> Mat<f64> {
    kernel(centres, centres) + JITTER * Mat::<f64>::identity(centres.ncols(), centres.ncols())
}

/// With every row's mean taken off.
fn centred(mut rows: Mat<f64>) -> Mat<f64> {
    for i in 0..rows.nrows() {
        let mean = rows.row(i).iter().sum::<f64>() / rows.ncols() as f64;
        rows.row_mut(i).iter_mut().for_each(|v| *v -= mean);
    }
    rows
}

/// The hat matrix Φᵀ(G + λK)⁻¹Φ for centred columns Φ (p×n).
fn hat(phi: &Mat<f64>, between: &Mat<f64>, lambda: f64) -> Mat<f64> {
    let system = phi * phi.transpose() + lambda * between;
    phi.transpose() * solve(system.as_ref(), phi.as_ref())
}

proptest! {
    #![proptest_config(property::cases(24))]

    /// The two hat matrices are N(N + λ)⁻¹ with N = HKH here and HKH − E there, 0 ≤ E ≤ jitter:
    /// they differ by λ(N + λ)⁻¹E(HKH + λ)⁻¹, whose norm is at most the jitter's share of λ.
    #[test]
    fn all_samples_as_centres_are_kernel_ridge(seed in any::<u64>(), lambda in 0.01..2.0_f64) {
        let (x, y) = smooth(seed, 3, 2, 40);
        let dense = KernelRidge { bandwidth: Bandwidth::Gamma(BETA), regularisation: Regularisation::Fixed(lambda) };
        let expected = dense.fit(x.as_ref(), y.as_ref())?.model.predict(x.as_ref())?;
        let fit = nystrom(NystromRegularisation::Fixed(lambda)).fit(x.as_ref(), y.as_ref())?;
        let difference = fit.model.predict(x.as_ref())? - expected;
        let targets = centred(y);
        for j in 0..2 {
            let (moved, norm) = (difference.row(j).norm_l2(), targets.row(j).norm_l2());
            prop_assert!(moved <= (JITTER / lambda + 1e-9) * norm, "{moved:e} {norm:e}");
        }
    }

    #[test]
    fn it_solves_its_equations_in_memory(seed in any::<u64>(), lambda in 0.01..2.0_f64) {
        let (n, p) = (50, 10);
        let (x, y) = smooth(seed, 3, 2, n);
        let (new, _) = smooth(seed ^ 7, 3, 1, 10);
        let chosen = random_subset(n, p, seed);
        let (inputs, outputs) = (StandardScaler::fit(x.as_ref())?, StandardScaler::fit(y.as_ref())?);
        let (z, t) = (inputs.apply(x.as_ref())?, outputs.apply(y.as_ref())?);
        let centres = columns(z.as_ref(), &chosen);
        let raw = kernel(centres.as_ref(), z.as_ref());
        let phi = centred(raw.clone());
        let between = penalty(centres.as_ref());
        let system = &phi * phi.transpose() + lambda * &between;
        let weights = solve(system.as_ref(), (&phi * t.transpose()).as_ref());
        let mut new_phi = kernel(centres.as_ref(), inputs.apply(new.as_ref())?.as_ref());
        for i in 0..p {
            let mean = raw.row(i).iter().sum::<f64>() / n as f64;
            new_phi.row_mut(i).iter_mut().for_each(|v| *v -= mean);
        }
        let expected = outputs.invert((weights.transpose() * &new_phi).as_ref())?;
        let model = nystrom(NystromRegularisation::Fixed(lambda)).fit_on(x.as_ref(), y.as_ref(), &chosen)?.model;
        let (mean, std) = model.predict_with_std(new.as_ref())?;
        prop_assert_eq!(model.kept_samples(), chosen);
        prop_assert!(close(mean.as_ref(), expected.as_ref(), 1e-5));
        let spread = new_phi.transpose() * solve(system.as_ref(), new_phi.as_ref());
        let used = hat(&phi, &between, lambda).diagonal().column_vector().sum();
        let residuals = &t - weights.transpose() * &phi;
        for j in 0..2 {
            let squared = residuals.row(j).squared_norm_l2();
            let noise = outputs.scale()[j] * (squared / (n as f64 - 1.0 - used)).sqrt();
            for s in 0..10 {
                let expected = noise * (1.0 + spread[(s, s)]).sqrt();
                prop_assert!((std[(j, s)] - expected).abs() < 1e-5 * expected);
            }
        }
    }

    #[test]
    fn the_penalty_has_the_least_cross_validation_error(seed in any::<u64>()) {
        let (n, p, m) = (50, 10, 2);
        let (x, y) = smooth(seed, 3, m, n);
        let chosen = random_subset(n, p, seed);
        let z = StandardScaler::fit(x.as_ref())?.apply(x.as_ref())?;
        let t = StandardScaler::fit(y.as_ref())?.apply(y.as_ref())?;
        let centres = columns(z.as_ref(), &chosen);
        let phi = centred(kernel(centres.as_ref(), z.as_ref()));
        let between = penalty(centres.as_ref());
        let grid = vec![1e-3, 0.1, 3.0];
        let expected = grid.iter().map(|&lambda| {
            let hat = hat(&phi, &between, lambda);
            let residuals = &t - &t * hat.transpose();
            // The mean leverage, with the bias's 1/n.
            let leverage = (hat.diagonal().column_vector().sum() + 1.0) / n as f64;
            residuals.squared_norm_l2() / ((1.0 - leverage).powi(2) * (n * m) as f64)
        }).collect::<Vec<f64>>();
        let fit = nystrom(NystromRegularisation::Gcv(grid.clone())).fit_on(x.as_ref(), y.as_ref(), &chosen)?;
        for (found, expected) in fit.report.traces[0].objective.iter().zip(&expected) {
            prop_assert!((found - expected).abs() < 1e-5 * expected, "{found} {expected}");
        }
        let best = (0..grid.len()).min_by(|&a, &b| expected[a].total_cmp(&expected[b]));
        prop_assert_eq!(fit.report.penalty, best.map(|b| grid[b]));
        let given = nystrom(NystromRegularisation::Fixed(fit.report.penalty.unwrap()));
        prop_assert_eq!(given.fit_on(x.as_ref(), y.as_ref(), &chosen)?.model, fit.model);
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let (x, y) = smooth(6, 6, 3, 900);
    let centres = random_subset(900, 300, 1);
    let fits = [1, 2, 8].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| NystromRidge::default().fit_on(x.as_ref(), y.as_ref(), &centres)).unwrap()
    });
    assert_eq!(fits[0], fits[1]);
    assert_eq!(fits[0], fits[2]);
}

#[test]
fn inputs_that_do_not_vary_leave_the_mean() {
    let (_, y) = smooth(2, 3, 2, 30);
    let x = Mat::full(3, 30, 4.0);
    let model = NystromRidge::default().fit(x.as_ref(), y.as_ref()).unwrap().model;
    assert!(model.kept_samples().is_empty());
    let outputs = StandardScaler::fit(y.as_ref()).unwrap();
    let mean = model.predict(x.as_ref().subcols(0, 1)).unwrap();
    for j in 0..2 {
        assert!((mean[(j, 0)] - outputs.mean()[j]).abs() < 1e-12);
    }
}

/// Centres that coincide make the kernel singular; the jitter holds.
#[test]
fn repeated_centres_are_solved() {
    let (x, y) = smooth(2, 3, 2, 30);
    let twice: Vec<usize> = (0..60).map(|i| i % 30).collect();
    let pick = |from: &Mat<f64>| columns(from.as_ref(), &twice);
    let (x2, y2) = (pick(&x), pick(&y));
    let samples: Vec<usize> = (0..60).collect();
    let pilot = PilotSample { x: x2.as_ref(), y: y2.as_ref(), samples: &samples };
    let fitter = nystrom(NystromRegularisation::Fixed(0.1));
    let doubled = phalanx_rvm::BasisSpec::new(&pilot, Kernel::Gaussian(fitter.bandwidth)).unwrap();
    let mut sums = SufficientStatistics::new(&doubled);
    sums.add(&doubled, x.as_ref(), y.as_ref()).unwrap();
    let found = fitter.fit_sums(&doubled, &sums).unwrap().model.predict(x.as_ref()).unwrap();
    let once = fitter.fit(x.as_ref(), y.as_ref()).unwrap().model.predict(x.as_ref()).unwrap();
    assert!(close(found.as_ref(), once.as_ref(), 1e-4));
}
