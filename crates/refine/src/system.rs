//! The normal equations of a fit: one block for each frame's pose, one for what all frames share.

use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef, Side};

use crate::PosePrior;
use crate::problem::Moment;

/// A sparse row of the Jacobian: which unknown, and the slope.
pub(crate) type Row = Vec<(usize, f64)>;

/// The normal equations of one frame: Hessians column after column, lower triangles of the square
/// ones.
#[derive(Debug, Clone)]
pub(crate) struct FrameSystem {
    poses: usize,
    shared: usize,
    pub(crate) pose_hessian: Vec<f64>,
    /// `poses` × `shared`.
    mixed_hessian: Vec<f64>,
    pub(crate) shared_hessian: Vec<f64>,
    pub(crate) pose_gradient: Vec<f64>,
    pub(crate) shared_gradient: Vec<f64>,
}

impl FrameSystem {
    /// Of so many numbers of a pose, margins, and shared numbers.
    pub(crate) fn new(numbers: usize, margins: usize, shared: usize) -> Self {
        let poses = numbers + margins;
        Self {
            poses,
            shared,
            pose_hessian: vec![0.0; poses * poses],
            mixed_hessian: vec![0.0; poses * shared],
            shared_hessian: vec![0.0; shared * shared],
            pose_gradient: vec![0.0; poses],
            shared_gradient: vec![0.0; shared],
        }
    }

    /// Adds what is known of a pose and of its margins; the energy of that.
    pub(crate) fn add_prior(&mut self, prior: &PosePrior, moment: &Moment, deviation: f64) -> f64 {
        let numbers = prior.dofs().len();
        let precision = deviation.powi(-2);
        let mut energy = 0.0;
        for (v, margin) in moment.margins.iter().enumerate() {
            let k = numbers + v;
            energy += 0.5 * margin * margin * precision;
            self.pose_gradient[k] += margin * precision;
            self.pose_hessian[k * self.poses + k] += precision;
        }
        let (gradient, hessian) = (&mut self.pose_gradient, &mut self.pose_hessian);
        energy + prior.add(&moment.pose, gradient, hessian, self.poses)
    }

    /// Adds a weighted residual. Both rows are in ascending order.
    pub(crate) fn add(&mut self, residual: f64, weight: f64, pose: &Row, shared: &Row) {
        add_outer(&mut self.pose_hessian, &mut self.pose_gradient, self.poses, pose, residual, weight);
        add_outer(
            &mut self.shared_hessian,
            &mut self.shared_gradient,
            self.shared,
            shared,
            residual,
            weight,
        );
        for &(j, slope) in shared {
            let column = &mut self.mixed_hessian[j * self.poses..(j + 1) * self.poses];
            for &(i, other) in pose {
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
    pub(crate) poses: Vec<Vec<f64>>,
    pub(crate) shared: Vec<f64>,
}

/// The damped step −(H + damping · diag H)⁻¹ g of all frames, each frame's pose being eliminated in
/// turn. `shared_prior` holds the diagonal Hessian and the gradient of what is known of the shared
/// numbers.
///
/// `None` where the Hessian is not positive definite to working precision.
pub(crate) fn solve(
    frames: &[FrameSystem],
    shared_prior: &[(f64, f64)],
    damping: f64,
) -> Option<Step> {
    let shared = shared_prior.len();
    let mut reduced = Mat::<f64>::zeros(shared, shared);
    let mut slope = Mat::<f64>::zeros(shared, 1);
    for (k, &(hessian, gradient)) in shared_prior.iter().enumerate() {
        reduced[(k, k)] += hessian;
        slope[(k, 0)] += gradient;
    }
    let mut eliminated = Vec::with_capacity(frames.len());
    for frame in frames {
        let n = frame.poses;
        let mut own = Mat::from_fn(n, n, |i, j| frame.pose_hessian[i.min(j) * n + i.max(j)]);
        (0..n).for_each(|k| own[(k, k)] *= 1.0 + damping);
        let mixed = MatRef::from_column_major_slice(&frame.mixed_hessian, n, shared);
        let factor = own.llt(Side::Lower).ok()?;
        let gradient = MatRef::from_column_major_slice(&frame.pose_gradient, n, 1);
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
    let pose_step = |(across, along): (Mat<f64>, Mat<f64>)| {
        let step = if shared > 0 { across * &common - along } else { -along };
        step.col(0).iter().copied().collect()
    };
    Some(Step {
        poses: eliminated.into_iter().map(pose_step).collect(),
        shared: common.col(0).iter().map(|value| -value).collect(),
    })
}

/// The covariance of the first `numbers` unknowns of a frame, with everything shared being known,
/// column after column: of the inverse of its Hessian.
pub(crate) fn covariance(frame: &FrameSystem, numbers: usize) -> Option<Vec<f64>> {
    let n = frame.poses;
    let own = Mat::from_fn(n, n, |i, j| frame.pose_hessian[i.min(j) * n + i.max(j)]);
    let factor = own.llt(Side::Lower).ok()?;
    let inverse = faer::linalg::solvers::DenseSolveCore::inverse(&factor);
    Some((0..numbers * numbers).map(|k| inverse[(k % numbers, k / numbers)]).collect())
}
