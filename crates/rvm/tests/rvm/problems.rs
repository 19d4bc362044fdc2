//! Random problems and the list of fitters to try on them.

use faer::{Mat, MatRef};
use phalanx_rvm::{
    AgarwalTriggs, ArdRvm, Bandwidth, Fit, Kernel, KernelRidge, MultiOutputRvm, NystromRidge,
    OrthogonalLeastSquares, RelevanceVectorMachine, Result, Ridge, Stop, TwoStageSelection,
};
use rand_core::Rng;
use rand_pcg::Pcg64Mcg;

pub(crate) type Fitter = fn(MatRef<'_, f64>, MatRef<'_, f64>) -> Result<Fit>;

pub(crate) const GAUSSIAN: Kernel = Kernel::Gaussian(Bandwidth::Relative(1.0));

/// Every fitter, with the kernels that it knows.
pub(crate) const FITTERS: [(&str, Fitter); 13] = [
    ("ridge, linear", |x, y| Ridge::default().fit(x, y)),
    ("ridge, Gaussian", |x, y| Ridge { kernel: GAUSSIAN, lambda: 0.1 }.fit(x, y)),
    ("Agarwal-Triggs, linear", |x, y| {
        AgarwalTriggs { kernel: Kernel::Linear, ..AgarwalTriggs::default() }.fit(x, y)
    }),
    ("Agarwal-Triggs, Gaussian", |x, y| AgarwalTriggs::default().fit(x, y)),
    ("RVM, linear", |x, y| {
        RelevanceVectorMachine { kernel: Kernel::Linear, ..RelevanceVectorMachine::default() }
            .fit(x, y)
    }),
    ("RVM, Gaussian", |x, y| RelevanceVectorMachine::default().fit(x, y)),
    ("multi-output RVM, linear", |x, y| {
        MultiOutputRvm { kernel: Kernel::Linear, ..MultiOutputRvm::default() }.fit(x, y)
    }),
    ("multi-output RVM, Gaussian", |x, y| MultiOutputRvm::default().fit(x, y)),
    ("ARD", |x, y| ArdRvm { rounds: 3, ..ArdRvm::default() }.fit(x, y)),
    ("kernel ridge", |x, y| KernelRidge::default().fit(x, y)),
    ("Nyström ridge", |x, y| NystromRidge::default().fit(x, y)),
    ("orthogonal least squares", |x, y| {
        OrthogonalLeastSquares { kernel: GAUSSIAN, count: 1, ..OrthogonalLeastSquares::default() }
            .fit(x, y)
    }),
    ("two stages", |x, y| {
        TwoStageSelection { features: Stop::Threshold(0.05), ..TwoStageSelection::default() }
            .fit(x, y)
    }),
];

pub(crate) struct Source(Pcg64Mcg);

impl Source {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::new(u128::from(seed) * 2 + 1))
    }

    /// Uniform in −1…1.
    pub(crate) fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub(crate) fn matrix(&mut self, rows: usize, columns: usize) -> Mat<f64> {
        Mat::from_fn(rows, columns, |_, _| self.uniform())
    }

    /// A random order of 0..n.
    pub(crate) fn order(&mut self, n: usize) -> Vec<usize> {
        let mut keyed: Vec<(u64, usize)> = (0..n).map(|i| (self.0.next_u64(), i)).collect();
        keyed.sort_unstable();
        keyed.into_iter().map(|(_, i)| i).collect()
    }
}

/// Inputs K×I and mildly non-linear targets m×I with noise, of unequal scales.
pub(crate) fn smooth(seed: u64, k: usize, m: usize, i: usize) -> (Mat<f64>, Mat<f64>) {
    let mut source = Source::new(seed);
    let x = source.matrix(k, i);
    let mix = source.matrix(m, k);
    let bend = source.matrix(m, k);
    let y = Mat::from_fn(m, i, |j, t| {
        let along: f64 = (0..k).map(|f| mix[(j, f)] * x[(f, t)]).sum();
        let across: f64 = (0..k).map(|f| bend[(j, f)] * x[(f, t)]).sum();
        let value = along + 0.5 * across.sin().powi(2) + 0.1 * source.uniform();
        10_f64.powi(j as i32 % 3) * value + j as f64
    });
    (x, y)
}

/// The columns of `x` in this order.
pub(crate) fn columns(x: MatRef<'_, f64>, order: &[usize]) -> Mat<f64> {
    Mat::from_fn(x.nrows(), order.len(), |i, j| x[(i, order[j])])
}

/// The rows of `x` in this order.
pub(crate) fn rows(x: MatRef<'_, f64>, order: &[usize]) -> Mat<f64> {
    Mat::from_fn(order.len(), x.ncols(), |i, j| x[(order[i], j)])
}

/// Are two matrices equal to within `tolerance` of each row's largest magnitude?
pub(crate) fn close(a: MatRef<'_, f64>, b: MatRef<'_, f64>, tolerance: f64) -> bool {
    assert_eq!(a.shape(), b.shape());
    (0..a.nrows()).all(|i| {
        let scale = b.row(i).iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        (0..a.ncols()).all(|j| (a[(i, j)] - b[(i, j)]).abs() <= tolerance * scale)
    })
}

/// Solves a square system by elimination with full pivoting.
pub(crate) fn solve(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    use faer::linalg::solvers::Solve;
    a.full_piv_lu().solve(b)
}
