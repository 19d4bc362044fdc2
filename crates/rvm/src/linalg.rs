//! The few dense operations in use, each sequential or cut into fixed blocks, so that no result
//! depends on the number of threads.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{self, LltRegularization};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_inverse::invert_lower_triangular;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, Mat, MatMut, MatRef, Par, Spec};
use rayon::prelude::*;

use crate::error::{Error, Result};

/// Columns of a product that one task computes.
const BLOCK: usize = 96;
/// Multiplications in a product up to which it is small.
const SMALL: usize = 1 << 19;
/// Multiplications in a tile of a small product, and most columns and depth of one.
const TILE: usize = 16 * 16 * 16;
const TILE_COLUMNS: usize = 4;
const TILE_DEPTH: usize = 64;

/// A·B.
pub(crate) fn product(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let mut out = Mat::zeros(a.nrows(), b.ncols());
    multiply(out.as_mut(), a, b);
    out
}

/// A·B into `out`, all zeros.
///
/// Above the size of a tile, unless one factor is a vector, faer allocates twice the last-level
/// cache in every thread. Small products are therefore cut into tiles, at a third more time.
fn multiply(mut out: MatMut<'_, f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    let ((m, k), n) = (a.shape(), b.ncols());
    let by_a_vector = m.min(k).min(n) <= 1;
    if by_a_vector || !(TILE..SMALL).contains(&(m * k * n)) {
        matmul(out, Accum::Replace, a, b, 1.0, Par::Seq);
        return;
    }
    let by_columns = a.to_owned();
    let depth = k.min(TILE_DEPTH);
    for (j, columns) in cut(n, TILE_COLUMNS) {
        for (i, rows) in cut(m, TILE / (TILE_COLUMNS * depth)) {
            let mut out = out.rb_mut().submatrix_mut(i, j, rows, columns);
            for (l, depth) in cut(k, depth) {
                let a = by_columns.submatrix(i, l, rows, depth);
                let b = b.submatrix(l, j, depth, columns);
                matmul(out.rb_mut(), Accum::Add, a, b, 1.0, Par::Seq);
            }
        }
    }
}

/// Where the pieces of a whole start, and their sizes.
fn cut(whole: usize, size: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..whole).step_by(size).map(move |start| (start, size.min(whole - start)))
}

/// A·v.
pub(crate) fn times(a: MatRef<'_, f64>, v: &[f64]) -> Vec<f64> {
    product(a, MatRef::from_column_major_slice(v, v.len(), 1)).col_as_slice(0).to_vec()
}

/// A·U for an upper triangular U.
pub(crate) fn times_upper(a: MatRef<'_, f64>, u: MatRef<'_, f64>) -> Mat<f64> {
    let mut out = Mat::zeros(a.nrows(), u.ncols());
    triangular::matmul(
        out.as_mut(),
        BlockStructure::Rectangular,
        Accum::Replace,
        a,
        BlockStructure::Rectangular,
        u,
        BlockStructure::TriangularUpper,
        1.0,
        Par::Seq,
    );
    out
}

/// XᵀX, exactly symmetric.
pub(crate) fn gram(x: MatRef<'_, f64>) -> Mat<f64> {
    let p = x.ncols();
    let mut out = Mat::zeros(p, p);
    if p == 0 {
        return out;
    }
    out.as_mut().par_col_chunks_mut(BLOCK).enumerate().for_each(|(block, mut columns)| {
        let start = block * BLOCK;
        let width = columns.ncols();
        let below = columns.rb_mut().subrows_mut(start, p - start);
        let lhs = x.subcols(start, p - start).transpose();
        multiply(below, lhs, x.subcols(start, width));
    });
    for j in 1..p {
        for i in 0..j {
            out[(i, j)] = out[(j, i)];
        }
    }
    out
}

/// Lower Cholesky factor of a symmetric matrix (its lower half is read), with zeros above;
/// `None` where it is not positive definite to working precision.
pub(crate) fn cholesky(mut a: Mat<f64>) -> Option<Mat<f64>> {
    let n = a.nrows();
    let params = Spec::default();
    let mut memory = MemBuffer::new(factor::cholesky_in_place_scratch::<f64>(n, Par::Seq, params));
    let stack = MemStack::new(&mut memory);
    factor::cholesky_in_place(a.as_mut(), LltRegularization::default(), Par::Seq, stack, params)
        .ok()?;
    for j in 0..n {
        a.col_as_slice_mut(j)[..j].fill(0.0);
    }
    Some(a)
}

/// Eigenvalues of a symmetric matrix, the largest first, and their eigenvectors of length 1.
pub(crate) struct Eigen {
    pub(crate) values: Vec<f64>,
    /// One in each column.
    pub(crate) vectors: Mat<f64>,
}

/// Decomposes a symmetric matrix.
pub(crate) fn eigen(a: &Mat<f64>) -> Result<Eigen> {
    let n = a.nrows();
    let params = Spec::default();
    let compute = ComputeEigenvectors::Yes;
    let scratch = self_adjoint_evd_scratch::<f64>(n, compute, Par::Seq, params);
    let mut memory = MemBuffer::new(scratch);
    let (mut values, mut vectors) = (Diag::zeros(n), Mat::zeros(n, n));
    let stack = MemStack::new(&mut memory);
    let into = Some(vectors.as_mut());
    self_adjoint_evd(a.as_ref(), values.as_mut(), into, Par::Seq, stack, params)
        .map_err(|_| Error::Eigenvalues { size: n })?;
    // They come ascending.
    let values = values.column_vector().iter().rev().copied().collect();
    let vectors = Mat::from_fn(n, n, |i, k| vectors[(i, n - 1 - k)]);
    Ok(Eigen { values, vectors })
}

/// Inverse of a lower triangular matrix.
pub(crate) fn lower_inverse(l: MatRef<'_, f64>) -> Mat<f64> {
    let mut out = Mat::zeros(l.nrows(), l.ncols());
    invert_lower_triangular(out.as_mut(), l, Par::Seq);
    out
}

/// Solves L X = B in place of B, for a lower triangular L.
pub(crate) fn lower_solve(l: MatRef<'_, f64>, b: &mut Mat<f64>) {
    b.as_mut().par_col_chunks_mut(BLOCK).for_each(|columns| {
        solve_lower_triangular_in_place(l, columns, Par::Seq);
    });
}

/// Solves U X = B in place of B, for an upper triangular U.
pub(crate) fn upper_solve(u: MatRef<'_, f64>, b: &mut Mat<f64>) {
    b.as_mut().par_col_chunks_mut(BLOCK).for_each(|columns| {
        solve_upper_triangular_in_place(u, columns, Par::Seq);
    });
}

/// Solves L Lᵀ X = B in place of B.
pub(crate) fn cholesky_solve(l: MatRef<'_, f64>, b: &mut Mat<f64>) {
    lower_solve(l, b);
    upper_solve(l.transpose(), b);
}

/// The square submatrix on `kept`.
pub(crate) fn submatrix(a: MatRef<'_, f64>, kept: &[usize]) -> Mat<f64> {
    Mat::from_fn(kept.len(), kept.len(), |i, j| a[(kept[i], kept[j])])
}

/// The rows of `a` in `kept`.
pub(crate) fn subrows(a: MatRef<'_, f64>, kept: &[usize]) -> Mat<f64> {
    Mat::from_fn(kept.len(), a.ncols(), |i, j| a.rb()[(kept[i], j)])
}

/// Euclidean norm of each row.
pub(crate) fn row_norms(a: MatRef<'_, f64>) -> Vec<f64> {
    (0..a.nrows()).map(|i| a.row(i).iter().map(|v| v * v).sum::<f64>().sqrt()).collect()
}

/// Sum of aᵢⱼ bᵢⱼ.
pub(crate) fn inner(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> f64 {
    (0..a.ncols()).map(|j| (0..a.nrows()).map(|i| a[(i, j)] * b[(i, j)]).sum::<f64>()).sum()
}

/// y += s·x.
pub(crate) fn axpy(y: &mut [f64], s: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += s * x;
    }
}

/// Subtracts its mean from each column; returns the means.
pub(crate) fn centre(columns: &mut Mat<f64>) -> Vec<f64> {
    (0..columns.ncols())
        .map(|j| {
            let column = columns.col_as_slice_mut(j);
            let mean = column.iter().sum::<f64>() / column.len() as f64;
            for value in &mut *column {
                *value -= mean;
            }
            mean
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By a vector, tiny, small with tiles that are not full, and large.
    #[test]
    fn products_of_every_size_are_those_of_their_definition() {
        for (m, k, n) in [(40, 50, 1), (3, 4, 5), (37, 130, 9), (300, 2, 30), (90, 80, 100)] {
            let wave = |i: usize, j: usize| (0.7 * i as f64 + 1.3 * j as f64).sin();
            let (a, by_rows) = (Mat::from_fn(m, k, wave), Mat::from_fn(k, m, |i, j| wave(j, i)));
            let b = Mat::from_fn(k, n, |i, j| wave(j, 3 * i));
            let expected =
                Mat::from_fn(m, n, |i, j| (0..k).map(|l| a[(i, l)] * b[(l, j)]).sum::<f64>());
            for a in [a.as_ref(), by_rows.transpose()] {
                let difference: Mat<f64> = product(a, b.as_ref()) - &expected;
                assert!(difference.norm_max() < 1e-12 * k as f64, "{m} {k} {n}");
            }
        }
    }
}
