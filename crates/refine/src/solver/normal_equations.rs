//! The normal equations of a fit: one block for each frame's pose, one for what all frames share.

use faer::linalg::solvers::{DenseSolveCore, Solve};
use faer::{Mat, MatRef, Side};
use phalanx_hand::Pose;

use crate::priors::gaussian::GaussianPenalty;
use crate::priors::pose::PosePrior;

/// A sparse row of the Jacobian: which unknown, and the slope.
pub(crate) type Row = Vec<(usize, f64)>;

/// The normal equations of one frame: Hessians column after column, lower triangles of the square
/// ones.
#[derive(Debug, Clone, Default)]
pub(crate) struct NormalEquations {
    own: usize,
    shared: usize,
    /// The frame's share of the energy.
    pub(crate) energy: f64,
    /// That of each view's boundary.
    pub(crate) boundaries: Vec<BoundaryEnergy>,
    /// How much of each view's landmarks is unexplained.
    pub(crate) landmarks: Vec<f64>,
    own_hessian: Vec<f64>,
    /// `own` × `shared`.
    mixed_hessian: Vec<f64>,
    shared_hessian: Vec<f64>,
    own_gradient: Vec<f64>,
    shared_gradient: Vec<f64>,
}

/// What the residuals of one view's boundary add up to.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct BoundaryEnergy {
    /// Half the robust squared distances over the noise, each place counting once.
    pub(crate) energy: f64,
    pub(crate) count: usize,
    /// What areas between the silhouettes add to it.
    pub(crate) areas: f64,
    /// How much each place counts in the frame's energy, and in its slope.
    pub(crate) weights: [f64; 2],
}

impl NormalEquations {
    /// Of so many unknowns of the frame and shared ones.
    pub(crate) fn new(own: usize, shared: usize) -> Self {
        Self {
            own,
            shared,
            energy: 0.0,
            boundaries: Vec::new(),
            landmarks: Vec::new(),
            own_hessian: vec![0.0; own * own],
            mixed_hessian: vec![0.0; own * shared],
            shared_hessian: vec![0.0; shared * shared],
            own_gradient: vec![0.0; own],
            shared_gradient: vec![0.0; shared],
        }
    }

    /// The Hessian of all unknowns, the frame's own first.
    pub(crate) fn whole_hessian(&self) -> Mat<f64> {
        let (n, shared) = (self.own, self.shared);
        Mat::from_fn(n + shared, n + shared, |i, j| {
            let (low, high) = (i.min(j), i.max(j));
            match (low < n, high < n) {
                (_, true) => self.own_hessian[low * n + high],
                (true, false) => self.mixed_hessian[(high - n) * n + low],
                (false, false) => self.shared_hessian[(low - n) * shared + (high - n)],
            }
        })
    }

    #[cfg(test)]
    pub(crate) fn own_gradient(&self) -> &[f64] {
        &self.own_gradient
    }

    #[cfg(test)]
    pub(crate) fn shared_gradient(&self) -> &[f64] {
        &self.shared_gradient
    }

    /// Adds what is known of the pose, whose numbers come first.
    pub(crate) fn add_prior(&mut self, prior: &PosePrior, pose: &Pose) {
        self.energy += prior.add(pose, &mut self.own_gradient, &mut self.own_hessian, self.own);
    }

    /// Adds what is known of the frame's unknowns from `first` on.
    pub(crate) fn add_penalties(&mut self, first: usize, known: &[GaussianPenalty]) {
        for (k, known) in (first..).zip(known) {
            self.energy += known.energy;
            self.own_gradient[k] += known.gradient;
            self.own_hessian[k * self.own + k] += known.hessian;
        }
    }

    /// Adds a residual of the last view's boundary. Both rows are in ascending order.
    pub(crate) fn add_boundary_residual(
        &mut self,
        residual: f64,
        energy: f64,
        weight: f64,
        own: &Row,
        shared: &Row,
    ) {
        let boundary = self.boundaries.last_mut().expect("a view's boundary was begun");
        boundary.energy += energy;
        boundary.count += 1;
        let [of_energy, of_slope] = boundary.weights;
        self.add(residual, of_energy * energy, of_slope * weight, own, shared);
    }

    /// Adds what areas between the last view's silhouettes cost.
    pub(crate) fn add_areas(&mut self, areas: f64) {
        let boundary = self.boundaries.last_mut().expect("a view's boundary was begun");
        boundary.areas += areas;
        self.energy += boundary.weights[0] * areas;
    }

    /// Adds the slope of the areas between the last view's silhouettes at a place of what bounds them. Both rows are in
    /// ascending order.
    pub(crate) fn add_area_slope(&mut self, residual: f64, weight: f64, own: &Row, shared: &Row) {
        let boundary = self.boundaries.last().expect("a view's boundary was begun");
        self.add(residual, 0.0, boundary.weights[1] * weight, own, shared);
    }

    /// Begins the boundary of the next view.
    pub(crate) fn begin_boundary(&mut self, weights: [f64; 2]) {
        self.boundaries.push(BoundaryEnergy { weights, ..BoundaryEnergy::default() });
    }

    /// Adds the energy of a view's landmarks, so much of which is unexplained.
    pub(crate) fn add_landmarks(&mut self, energy: f64, unexplained: f64) {
        self.energy += energy;
        self.landmarks.push(unexplained);
    }

    /// Adds any residual. Both rows are in ascending order.
    pub(crate) fn add(&mut self, residual: f64, energy: f64, weight: f64, own: &Row, shared: &Row) {
        self.energy += energy;
        let hessian = &mut self.own_hessian;
        add_outer(hessian, &mut self.own_gradient, self.own, own, residual, weight);
        let hessian = &mut self.shared_hessian;
        add_outer(hessian, &mut self.shared_gradient, self.shared, shared, residual, weight);
        for &(j, slope) in shared {
            let column = &mut self.mixed_hessian[j * self.own..(j + 1) * self.own];
            for &(i, other) in own {
                column[i] += weight * slope * other;
            }
        }
    }
}

fn add_outer(
    hessian: &mut [f64],
    gradient: &mut [f64],
    count: usize,
    row: &Row,
    residual: f64,
    weight: f64,
) {
    for (k, &(j, slope)) in row.iter().enumerate() {
        let scaled = weight * slope;
        gradient[j] += scaled * residual;
        for &(i, other) in &row[k..] {
            hessian[j * count + i] += scaled * other;
        }
    }
}

/// A step of all unknowns.
#[derive(Debug, Clone)]
pub(crate) struct Step {
    pub(crate) own: Vec<Vec<f64>>,
    pub(crate) shared: Vec<f64>,
    /// How much energy it would win if slopes stayed as they are.
    pub(crate) predicted_decrease: f64,
}

/// The damped step −(H + damping · diag H)⁻¹ g of all frames, each frame's pose being eliminated in
/// turn. `shared_prior` holds the diagonal Hessian and the gradient of what is known of the shared
/// numbers.
///
/// `None` where the Hessian is not positive definite to working precision.
pub(crate) fn solve(
    frames: &[NormalEquations],
    shared_prior: &[GaussianPenalty],
    damping: f64,
) -> Option<Step> {
    let shared = shared_prior.len();
    let mut reduced = Mat::<f64>::zeros(shared, shared);
    let mut slope = Mat::<f64>::zeros(shared, 1);
    for (k, known) in shared_prior.iter().enumerate() {
        reduced[(k, k)] += known.hessian;
        slope[(k, 0)] += known.gradient;
    }
    let mut eliminated = Vec::with_capacity(frames.len());
    for frame in frames {
        let n = frame.own;
        let mut square = Mat::from_fn(n, n, |i, j| frame.own_hessian[i.min(j) * n + i.max(j)]);
        (0..n).for_each(|k| square[(k, k)] *= 1.0 + damping);
        let mixed = MatRef::from_column_major_slice(&frame.mixed_hessian, n, shared);
        let factor = square.llt(Side::Lower).ok()?;
        let gradient = MatRef::from_column_major_slice(&frame.own_gradient, n, 1);
        let (across, along) = (factor.solve(mixed), factor.solve(gradient));
        for j in 0..shared {
            for i in j..shared {
                reduced[(i, j)] += frame.shared_hessian[j * shared + i];
            }
            slope[(j, 0)] += frame.shared_gradient[j];
        }
        if shared > 0 {
            reduced -= mixed.transpose() * &across;
            slope -= mixed.transpose() * &along;
        }
        eliminated.push((across, along));
    }
    (0..shared).for_each(|k| reduced[(k, k)] += damping * reduced[(k, k)].abs());
    let common = if shared > 0 { reduced.llt(Side::Lower).ok()?.solve(&slope) } else { slope };
    let own_step = |(across, along): (Mat<f64>, Mat<f64>)| -> Vec<f64> {
        let step = if shared > 0 { across * &common - along } else { -along };
        step.col(0).iter().copied().collect()
    };
    let own: Vec<Vec<f64>> = eliminated.into_iter().map(own_step).collect();
    let shared: Vec<f64> = common.col(0).iter().map(|value| -value).collect();
    let of_frames = frames
        .iter()
        .zip(&own)
        .map(|(frame, own)| dot(&frame.own_gradient, own) + dot(&frame.shared_gradient, &shared));
    let of_prior = shared_prior.iter().zip(&shared).map(|(known, step)| known.gradient * step);
    let predicted_decrease = -0.5 * (of_frames.sum::<f64>() + of_prior.sum::<f64>());
    Some(Step { own, shared, predicted_decrease })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The covariance of what all frames share, their own unknowns being fitted with it.
pub(crate) fn shared_covariance(
    frames: &[NormalEquations],
    shared_prior: &[GaussianPenalty],
) -> Option<Mat<f64>> {
    let shared = shared_prior.len();
    let mut reduced = Mat::<f64>::zeros(shared, shared);
    for (k, known) in shared_prior.iter().enumerate() {
        reduced[(k, k)] += known.hessian;
    }
    for frame in frames {
        let whole = frame.whole_hessian();
        let n = frame.own;
        let factor = whole.as_ref().submatrix(0, 0, n, n).llt(Side::Lower).ok()?;
        let mixed = whole.as_ref().submatrix(0, n, n, shared);
        reduced += whole.as_ref().submatrix(n, n, shared, shared);
        reduced -= mixed.transpose() * factor.solve(mixed);
    }
    Some(reduced.llt(Side::Lower).ok()?.inverse())
}

/// The covariance of the first `numbers` unknowns of a frame, column after column: of the inverse of its Hessian, all
/// others being unknown too. `shared_prior` holds the Hessians of what is known of those that frames share.
pub(crate) fn covariance(
    frame: &NormalEquations,
    shared_prior: &[GaussianPenalty],
    numbers: usize,
) -> Option<Vec<f64>> {
    let mut whole = frame.whole_hessian();
    for (k, known) in (frame.own..).zip(shared_prior) {
        whole[(k, k)] += known.hessian;
    }
    let inverse = whole.llt(Side::Lower).ok()?.inverse();
    Some((0..numbers * numbers).map(|k| inverse[(k % numbers, k / numbers)]).collect())
}
