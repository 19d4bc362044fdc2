//! What is known of a pose before looking at boundaries.

use faer::linalg::solvers::{DenseSolveCore, Solve};
use faer::{Mat, Side};
use phalanx_hand::{Digit, Dof, Pose, abduction_limit};

use crate::error::{Error, Result};

/// A Gaussian over those numbers of a pose that are not known; the others have the mean's value.
#[derive(Debug, Clone, PartialEq)]
pub struct PosePrior {
    mean: Pose,
    dofs: Vec<Dof>,
    /// Column after column.
    covariance: Vec<f64>,
    /// Its inverse.
    precision: Vec<f64>,
}

impl PosePrior {
    /// Independent numbers, known to a standard deviation (radians, millimetres): 0 where a number
    /// is the mean's, infinity where nothing is known.
    ///
    /// # Errors
    /// A mean that is not finite, a deviation that is negative or not a number.
    pub fn independent(mean: Pose, deviations: &[f64; Dof::COUNT]) -> Result<Self> {
        for dof in Dof::ALL {
            let value = deviations[dof.index()];
            if value.is_nan() || value < 0.0 {
                return Err(Error::NotFinite { what: "the deviation of", name: dof.name(), value });
            }
        }
        let dofs: Vec<Dof> =
            Dof::ALL.into_iter().filter(|dof| deviations[dof.index()] > 0.0).collect();
        let count = dofs.len();
        let mut covariance = vec![0.0; count * count];
        let mut precision = covariance.clone();
        for (k, dof) in dofs.iter().enumerate() {
            covariance[k * count + k] = deviations[dof.index()].powi(2);
            precision[k * count + k] = deviations[dof.index()].powi(-2);
        }
        Self { mean, dofs, covariance, precision }.checked()
    }

    /// Of some numbers with a covariance, `dofs.len()`², column after column, positive definite.
    ///
    /// # Errors
    /// A mean that is not finite, a covariance of another size or that is not positive definite.
    pub fn correlated(mean: Pose, dofs: &[Dof], covariance: &[f64]) -> Result<Self> {
        let count = dofs.len();
        if covariance.len() != count * count {
            let reason = format!("is of {} numbers for {count} dofs", covariance.len());
            return Err(Error::Precision { reason });
        }
        let square = Mat::from_fn(count, count, |i, j| covariance[j * count + i]);
        let factor = square.llt(Side::Lower).map_err(|_| Error::Precision {
            reason: "cannot be had: the covariance is not positive definite".to_owned(),
        })?;
        let inverse = factor.inverse();
        let precision = (0..count * count).map(|k| inverse[(k % count, k / count)]).collect();
        Self { mean, dofs: dofs.to_vec(), covariance: covariance.to_vec(), precision }.checked()
    }

    /// The Gaussian of some poses' numbers, of those that vary among them.
    ///
    /// # Errors
    /// No pose, or one that is not finite.
    pub fn of_poses(poses: &[Pose]) -> Result<Self> {
        // What no pose varies further is no certainty.
        const LEAST_DEG: f64 = 0.5;
        let count = poses.len() as f64;
        let mut mean = Pose::REST;
        for pose in poses {
            mean.0.iter_mut().zip(pose.0).for_each(|(mean, value)| *mean += value / count);
        }
        let varies = |dof: &Dof| poses.iter().any(|pose| pose[*dof] != poses[0][*dof]);
        let dofs: Vec<Dof> = Dof::ALL.into_iter().filter(varies).collect();
        if poses.is_empty() {
            return Err(Error::NoObservation);
        }
        let mut covariance = Vec::with_capacity(dofs.len() * dofs.len());
        for &a in &dofs {
            for &b in &dofs {
                let products = poses.iter().map(|pose| (pose[a] - mean[a]) * (pose[b] - mean[b]));
                let least = if a == b { LEAST_DEG.to_radians().powi(2) } else { 0.0 };
                covariance.push(products.sum::<f64>() / count + least);
            }
        }
        Self::correlated(mean, &dofs, &covariance)
    }

    /// What both say, as independent witnesses: the product of the two Gaussians over the numbers
    /// that this one leaves open. Of those that the other does not leave open it says nothing.
    ///
    /// # Errors
    /// Deviations so far apart that the product has no covariance to working precision.
    pub fn product(&self, other: &Self) -> Result<Self> {
        let count = self.dofs.len();
        let mut precision = Mat::<f64>::zeros(count, count);
        let mut pull = Mat::<f64>::zeros(count, 1);
        for witness in [self, other] {
            let slot = |dof: &Dof| self.dofs.iter().position(|own| own == dof);
            let slots: Vec<Option<usize>> = witness.dofs.iter().map(slot).collect();
            let columns = witness.precision.chunks_exact(witness.dofs.len().max(1));
            for ((column, &dof), &j) in columns.zip(&witness.dofs).zip(&slots) {
                for (&known, &i) in column.iter().zip(&slots) {
                    if let (Some(i), Some(j)) = (i, j) {
                        precision[(i, j)] += known;
                        pull[(i, 0)] += known * witness.mean[dof];
                    }
                }
            }
        }
        let factor = precision.llt(Side::Lower).map_err(|_| Error::Precision {
            reason: "of the two is not positive definite".to_owned(),
        })?;
        let (at, covariance) = (factor.solve(&pull), factor.inverse());
        let mut mean = self.mean;
        for (k, &dof) in self.dofs.iter().enumerate() {
            mean[dof] = at[(k, 0)];
        }
        let flat = |matrix: &Mat<f64>| -> Vec<f64> {
            (0..count * count).map(|k| matrix[(k % count, k / count)]).collect()
        };
        let (covariance, precision) = (flat(&covariance), flat(&precision));
        Self { mean, dofs: self.dofs.clone(), covariance, precision }.checked()
    }

    fn checked(self) -> Result<Self> {
        for dof in Dof::ALL {
            let value = self.mean[dof];
            if !value.is_finite() {
                return Err(Error::NotFinite {
                    what: "the prior's mean of",
                    name: dof.name(),
                    value,
                });
            }
        }
        if self.precision.iter().any(|value| !value.is_finite()) {
            return Err(Error::Precision { reason: "is not finite".to_owned() });
        }
        Ok(self)
    }

    /// The mean.
    pub fn mean(&self) -> &Pose {
        &self.mean
    }

    /// The numbers that are not known.
    pub fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    /// Standard deviation of a number, in its unit; 0 of one that is known.
    ///
    /// ```
    /// use phalanx_hand::{Dof, Pose};
    /// use phalanx_refine::PosePrior;
    ///
    /// let mut deviations = [0.0; Dof::COUNT];
    /// deviations[Dof::IndexPip.index()] = 0.3;
    /// let prior = PosePrior::independent(Pose::REST, &deviations)?;
    /// assert!((prior.deviation(Dof::IndexPip) - 0.3).abs() < 1e-12);
    /// assert_eq!(prior.deviation(Dof::IndexDip), 0.0);
    /// # Ok::<(), phalanx_refine::Error>(())
    /// ```
    pub fn deviation(&self, dof: Dof) -> f64 {
        let own = self.dofs.iter().position(|own| *own == dof);
        own.map_or(0.0, |k| self.covariance[k * (self.dofs.len() + 1)].sqrt())
    }

    /// The same knowledge about another pose.
    ///
    /// # Errors
    /// A pose that is not finite.
    pub fn recentered(&self, mean: Pose) -> Result<Self> {
        Self { mean, ..self.clone() }.checked()
    }

    /// The covariance of some numbers, column after column; `None` unless all are open.
    pub(crate) fn covariance_of(&self, dofs: &[Dof]) -> Option<Vec<f64>> {
        let slots: Vec<usize> = dofs
            .iter()
            .map(|dof| self.dofs.iter().position(|own| own == dof))
            .collect::<Option<_>>()?;
        let count = self.dofs.len();
        Some(
            slots
                .iter()
                .flat_map(|&j| slots.iter().map(move |&i| (i, j)))
                .map(|(i, j)| self.covariance[j * count + i])
                .collect(),
        )
    }

    /// The energy of a pose; see [`add`](Self::add).
    pub(crate) fn energy(&self, pose: &Pose) -> f64 {
        let count = self.dofs.len();
        let offset: Vec<f64> = self.dofs.iter().map(|&dof| pose[dof] - self.mean[dof]).collect();
        let columns = self.precision.chunks_exact(count).zip(&offset);
        let gaussian: f64 = columns
            .map(|(column, o)| o * column.iter().zip(&offset).map(|(p, o)| p * o).sum::<f64>())
            .sum();
        let beyond = self.dofs.iter().map(|&dof| {
            let (excess, deviation) = beyond_range(dof, pose);
            (excess / deviation).powi(2)
        });
        0.5 * (gaussian + beyond.sum::<f64>())
    }

    /// Half the squared Mahalanobis distance of a pose, and of how far its joints are beyond their
    /// ranges. Its gradient and Hessian are added to the beginnings of `gradient` and of the columns
    /// of `hessian`, `rows` long.
    pub(crate) fn add(
        &self,
        pose: &Pose,
        gradient: &mut [f64],
        hessian: &mut [f64],
        rows: usize,
    ) -> f64 {
        let count = self.dofs.len();
        let offset: Vec<f64> = self.dofs.iter().map(|&dof| pose[dof] - self.mean[dof]).collect();
        let mut energy = 0.0;
        for (j, column) in self.precision.chunks_exact(count).enumerate() {
            let slope: f64 = column.iter().zip(&offset).map(|(p, o)| p * o).sum();
            energy += 0.5 * slope * offset[j];
            gradient[j] += slope;
            for (h, p) in hessian[j * rows..].iter_mut().zip(column) {
                *h += p;
            }
        }
        for (j, &dof) in self.dofs.iter().enumerate() {
            let (excess, deviation) = beyond_range(dof, pose);
            energy += 0.5 * (excess / deviation).powi(2);
            gradient[j] += excess / (deviation * deviation);
            if excess != 0.0 {
                hessian[j * rows + j] += deviation.powi(-2);
            }
        }
        energy
    }
}

/// How far an angle of a joint is beyond its plausible range (0 within it), and how far it may be. Where
/// the hand is and how it is turned has no range: a turn by 181° is one by −179°.
fn beyond_range(dof: Dof, pose: &Pose) -> (f64, f64) {
    const SOFT_DEG: f64 = 2.0;
    if dof.index() >= Dof::ThetaX.index() {
        return (0.0, SOFT_DEG.to_radians());
    }
    let abduction = Digit::FINGERS.iter().find(|finger| finger.dofs()[0] == dof);
    let (low, high) = abduction.map_or(dof.range(), |finger| {
        let limit = abduction_limit(pose[finger.dofs()[1]]);
        (-limit, limit)
    });
    let excess = (pose[dof] - high).max(0.0) + (pose[dof] - low).min(0.0);
    (excess, SOFT_DEG.to_radians())
}
