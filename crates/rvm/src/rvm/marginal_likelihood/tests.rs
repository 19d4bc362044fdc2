//! Every quantity that rank-one steps carry along, against C = I + ΦA⁻¹Φᵀ itself.

use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef};
use rand_core::Rng;
use rand_pcg::Pcg64Mcg;

use super::active::Active;
use super::steps::Change;
use super::*;

/// S, Q, log evidence and the noise at which it is greatest.
struct Direct {
    sparsity: Vec<f64>,
    quality: Mat<f64>,
    noise: Vec<f64>,
    value: f64,
}

impl Direct {
    fn new(evidence: &MarginalLikelihood<'_>, phi: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Self {
        let n = phi.nrows();
        let mut c = Mat::<f64>::identity(n, n);
        for (&k, alpha) in evidence.active.columns.iter().zip(&evidence.active.alpha) {
            c += phi.col(k) * phi.col(k).transpose() / faer::Scale(*alpha);
        }
        let lu = c.full_piv_lu();
        let (by_phi, by_y) = (lu.solve(phi), lu.solve(y));
        // Centred data lie in n − 1 dimensions.
        let freedom = n as f64 - 1.0;
        let misfit = |j| y.col(j).transpose() * by_y.col(j);
        let noise: Vec<f64> = (0..y.ncols()).map(|j| misfit(j) / freedom).collect();
        let value: f64 = noise
            .iter()
            .map(|noise| {
                let normal = freedom * (2.0 * std::f64::consts::PI * noise).ln();
                -0.5 * (normal + c.determinant().ln() + freedom)
            })
            .sum();
        let sparsity = (0..phi.ncols()).map(|k| phi.col(k).transpose() * by_phi.col(k)).collect();
        Self { sparsity, quality: phi.transpose() * by_y, noise, value }
    }
}

fn centred(rows: usize, columns: usize, random: &mut Pcg64Mcg) -> Mat<f64> {
    let raw = Mat::from_fn(rows, columns, |_, _| {
        f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5
    });
    Mat::from_fn(rows, columns, |i, k| raw[(i, k)] - raw.col(k).sum() / rows as f64)
}

#[test]
fn every_step_keeps_what_a_full_recomputation_gives() {
    let mut random = Pcg64Mcg::new(77);
    let (n, p, m) = (25, 12, 3);
    let phi = centred(n, p, &mut random);
    let mix = centred(p, m, &mut random);
    let y = &phi * mix + centred(n, m, &mut random);
    let (gram, correlations) = (crate::linalg::gram(phi.as_ref()), phi.transpose() * &y);
    let energies: Vec<f64> = y.col_iter().map(|target| target.squared_norm_l2()).collect();
    let targets = Targets {
        gram: &gram,
        correlations: correlations.as_ref(),
        energies: &energies,
        freedom: n as f64 - 1.0,
    };
    let mut evidence = MarginalLikelihood::new(targets, 1e-6, p, 0.0).unwrap();
    let close = |a: f64, b: f64| (a - b).abs() < 1e-8 * (1.0 + b.abs());
    let (mut added, mut changed, mut deleted) = (0, 0, 0);
    for round in 0..90 {
        // Any step will do, not only the best: here a column at a time, at varying precisions.
        let column = round * 5 % p;
        let active = evidence.active.position(column).is_some();
        let delete = active && round % 3 == 0;
        let alpha = if delete { f64::INFINITY } else { 0.1 + f64::from(round as u32 * 7 % 11) };
        evidence.take(Change::Precision { column, alpha });
        evidence.take(Change::Noise);
        match (active, delete) {
            (false, _) => added += 1,
            (true, false) => changed += 1,
            (true, true) => deleted += 1,
        }
        let direct = Direct::new(&evidence, phi.as_ref(), y.as_ref());
        assert!(close(evidence.value(), direct.value), "{} {}", evidence.value(), direct.value);
        assert!(evidence.noise.iter().zip(&direct.noise).all(|(a, b)| close(*a, *b)));
        for k in 0..p {
            assert!(close(evidence.sparsity[k], direct.sparsity[k]));
            assert!((0..m).all(|j| close(evidence.quality[(k, j)], direct.quality[(k, j)])));
        }
        let posterior = evidence.posterior().unwrap();
        let sigma = crate::linalg::gram(posterior.factor.as_ref());
        let Active { sigma: carried, mu, .. } = &evidence.active;
        for i in 0..carried.ncols() {
            let rows = carried.col_as_slice(i).iter().zip(sigma.col_as_slice(i));
            assert!(rows.into_iter().all(|(a, b)| close(*a, *b)));
            assert!(mu.col(i).iter().zip(posterior.mu.row(i).iter()).all(|(a, b)| close(*a, *b)));
        }
    }
    assert!(added > 10 && changed > 10 && deleted > 10, "{added} {changed} {deleted}");
}

/// What a step is said to gain is what the evidence gains.
#[test]
fn a_step_gains_what_it_says() {
    let mut random = Pcg64Mcg::new(5);
    let (n, p, m) = (30, 15, 2);
    let phi = centred(n, p, &mut random);
    let y = phi.subcols(0, m) * faer::Scale(3.0) + centred(n, m, &mut random);
    let (gram, correlations) = (crate::linalg::gram(phi.as_ref()), phi.transpose() * &y);
    let energies: Vec<f64> = y.col_iter().map(|target| target.squared_norm_l2()).collect();
    let targets = Targets {
        gram: &gram,
        correlations: correlations.as_ref(),
        energies: &energies,
        freedom: n as f64 - 1.0,
    };
    let mut evidence = MarginalLikelihood::new(targets, 1e-6, p, 0.0).unwrap();
    let (mut columns, mut noises) = (0, 0);
    for _ in 0..40 {
        let (step, before) = (evidence.best_step(), evidence.value());
        evidence.take(step.change);
        let gained = evidence.value() - before;
        assert!((gained - step.gain).abs() < 1e-8 * (1.0 + gained.abs()), "{gained} {}", step.gain);
        match step.change {
            Change::Precision { .. } => columns += 1,
            Change::Noise => noises += 1,
        }
    }
    assert!(columns > 5 && noises > 5, "{columns} {noises}");
}
