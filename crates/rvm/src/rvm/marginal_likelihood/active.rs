//! The active columns and the posterior of their weights.

use faer::linalg::matmul::matmul;
use faer::{Accum, ColRef, Mat, Par};

/// A column that becomes active.
pub(super) struct New<'a> {
    pub(super) column: usize,
    pub(super) alpha: f64,
    /// Its column of G.
    pub(super) gram: &'a [f64],
    /// Its regression on the active columns.
    pub(super) regression: &'a [f64],
    /// Its weight's variance over σⱼ², and its mean for each target.
    pub(super) variance: f64,
    pub(super) mean: &'a [f64],
}

/// The active columns, in no order.
#[derive(Clone)]
pub(super) struct Active {
    pub(super) columns: Vec<usize>,
    /// Where a column stands among the active ones.
    position: Vec<Option<usize>>,
    pub(super) alpha: Vec<f64>,
    /// Their columns of G, p×a.
    pub(super) gram: Mat<f64>,
    /// Σ, their weights' posterior covariance over σⱼ², a×a.
    pub(super) sigma: Mat<f64>,
    /// Posterior mean of their weights, m×a.
    pub(super) mu: Mat<f64>,
}

impl Active {
    /// Of p columns and m targets.
    pub(super) fn none(p: usize, m: usize) -> Self {
        Self {
            columns: Vec::new(),
            position: vec![None; p],
            alpha: Vec::new(),
            gram: Mat::zeros(p, 0),
            sigma: Mat::zeros(0, 0),
            mu: Mat::zeros(m, 0),
        }
    }

    /// Puts others in their place, whose posterior is then to be computed.
    pub(super) fn replace(&mut self, gram: &Mat<f64>, columns: &[usize], alpha: &[f64]) {
        self.position.fill(None);
        self.gram.truncate(gram.nrows(), 0);
        for (i, &column) in columns.iter().enumerate() {
            self.position[column] = Some(i);
            push_column(&mut self.gram, gram.col_as_slice(column));
        }
        self.columns = columns.to_vec();
        self.alpha = alpha.to_vec();
    }

    pub(super) fn len(&self) -> usize {
        self.columns.len()
    }

    pub(super) fn position(&self, column: usize) -> Option<usize> {
        self.position[column]
    }

    /// Adds a column whose regression on the others this is, with its weight's variance and mean.
    pub(super) fn push(&mut self, new: &New<'_>) {
        let &New { column, alpha, gram, regression, variance, mean } = new;
        self.add_to_sigma(variance, regression);
        let against: Vec<f64> = mean.iter().map(|mean| -mean).collect();
        self.add_to_mu(&against, regression);
        let a = self.len();
        self.sigma.reserve((a + 1).next_power_of_two(), (a + 1).next_power_of_two());
        let last = |i: usize| if i < a { -variance * regression[i] } else { variance };
        self.sigma.resize_with(a + 1, a + 1, |i, j| last(i.min(j)));
        push_column(&mut self.mu, mean);
        push_column(&mut self.gram, gram);
        self.position[column] = Some(a);
        self.columns.push(column);
        self.alpha.push(alpha);
    }

    /// Σ += `factor` · d dᵀ.
    pub(super) fn add_to_sigma(&mut self, factor: f64, d: &[f64]) {
        let d = ColRef::from_slice(d).as_mat();
        matmul(self.sigma.as_mut(), Accum::Add, d, d.transpose(), factor, Par::Seq);
    }

    /// μ += `change` dᵀ.
    pub(super) fn add_to_mu(&mut self, change: &[f64], d: &[f64]) {
        for (mu, d) in self.mu.col_iter_mut().zip(d) {
            mu.iter_mut().zip(change).for_each(|(mu, change)| *mu += d * change);
        }
    }

    /// Lets the last one take the place of this one, whose weight is zero already.
    pub(super) fn swap_remove(&mut self, i: usize) {
        let last = self.len() - 1;
        swap_remove_column(&mut self.gram, i);
        swap_remove_column(&mut self.mu, i);
        swap_remove_column(&mut self.sigma, i);
        for j in 0..last {
            self.sigma[(i, j)] = self.sigma[(last, j)];
        }
        self.sigma.truncate(last, last);
        self.position[self.columns[i]] = None;
        self.columns.swap_remove(i);
        self.alpha.swap_remove(i);
        if let Some(&moved) = self.columns.get(i) {
            self.position[moved] = Some(i);
        }
    }
}

fn push_column(mat: &mut Mat<f64>, column: &[f64]) {
    let (rows, columns) = mat.shape();
    mat.reserve(rows, (columns + 1).next_power_of_two());
    mat.resize_with(rows, columns + 1, |_, _| 0.0);
    mat.col_as_slice_mut(columns).copy_from_slice(column);
}

/// Lets the last column take the place of this one.
fn swap_remove_column(mat: &mut Mat<f64>, column: usize) {
    let (rows, last) = (mat.nrows(), mat.ncols() - 1);
    if column < last {
        let (mut to, from) = mat.as_mut().two_cols_mut(column, last);
        to.copy_from(from);
    }
    mat.truncate(rows, last);
}
