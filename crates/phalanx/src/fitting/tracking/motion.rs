//! How a hand moves between frames: at a velocity that changes at random and dies away (the integrated
//! Ornstein-Uhlenbeck process), followed by a Kalman filter (Bar-Shalom, Li and Kirubarajan 2001, § 8.2).

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use glam::{DAffine3, DMat3};
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_refine::PosePrior;
use serde::{Deserialize, Serialize};

use super::noise::MotionNoise;
use crate::error::Result;
use crate::fitting::starts;

/// The numbers of a pose.
pub(super) const NUMBERS: usize = Dof::COUNT;

/// How long a velocity lasts, seconds: reaching movements of the hand take about half a second (Flash and
/// Hogan 1985).
const LASTS: f64 = 0.5;

/// What is known of a hand's pose and of its velocity.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Motion {
    /// The hand's own frame; its pose is said about it, so that no angle is near the edge of its range.
    pub(super) rest: DAffine3,
    /// The pose; where the hand is and how it is turned is in `rest`.
    pub(super) pose: Pose,
    /// Of each number, per second.
    velocity: [f64; NUMBERS],
    /// The covariance of the pose's numbers, then of their velocities.
    #[serde(with = "covariance")]
    covariance: Mat<f64>,
}

/// A motion one step on.
pub(super) struct Prediction {
    pub(super) motion: Motion,
    /// How much of what is found out about the later state concerns the earlier one (Rauch, Tung and
    /// Striebel 1965); `None` where arithmetic does not tell.
    pub(super) smoothing: Option<Mat<f64>>,
}

impl Motion {
    /// A pose of which no velocity is known, with the covariance of its numbers, column after column.
    pub(super) fn starting(
        rest: DAffine3,
        pose: Pose,
        covariance: &[f64],
        hand: &HandShape,
    ) -> Self {
        let speeds = MotionNoise::usual_speeds();
        let both =
            Mat::from_fn(2 * NUMBERS, 2 * NUMBERS, |i, j| match (i < NUMBERS, j < NUMBERS) {
                (true, true) => covariance[j * NUMBERS + i],
                (false, false) if i == j => speeds[i - NUMBERS].powi(2),
                _ => 0.0,
            });
        Self { rest, pose, velocity: [0.0; NUMBERS], covariance: both }.recentred(hand).0
    }

    /// Where the hand will be after some seconds.
    pub(super) fn predicted(
        &self,
        seconds: f64,
        noise: &MotionNoise,
        hand: &HandShape,
    ) -> Prediction {
        let kept = (-seconds / LASTS).exp();
        let way = LASTS * (1.0 - kept);
        let mut later = self.clone();
        for dof in Dof::ALL {
            let k = dof.index();
            let (low, high) = dof.range();
            let moved = self.pose[dof] + way * self.velocity[k];
            let is_joint = k < Dof::ThetaX.index();
            later.pose[dof] = if is_joint { moved.clamp(low, high) } else { moved };
            later.velocity[k] *= kept;
        }
        // F P, then F P Fᵀ.
        let across = Mat::from_fn(2 * NUMBERS, 2 * NUMBERS, |i, j| {
            let own = self.covariance[(i, j)];
            if i < NUMBERS { own + way * self.covariance[(i + NUMBERS, j)] } else { kept * own }
        });
        later.covariance = Mat::from_fn(2 * NUMBERS, 2 * NUMBERS, |i, j| {
            let own = across[(i, j)];
            if j < NUMBERS { own + way * across[(i, j + NUMBERS)] } else { kept * own }
        });
        let [of_pose, of_both, of_velocity] = grown(seconds, kept);
        for (k, density) in noise.densities().into_iter().enumerate() {
            later.covariance[(k, k)] += density * of_pose;
            later.covariance[(k, k + NUMBERS)] += density * of_both;
            later.covariance[(k + NUMBERS, k)] += density * of_both;
            later.covariance[(k + NUMBERS, k + NUMBERS)] += density * of_velocity;
        }
        let (motion, turn) = later.recentred(hand);
        // (T F P)ᵀ solved by the later covariance, transposed: P Fᵀ Tᵀ P₁⁻¹.
        let across = &turn * across;
        let factor = motion.covariance.llt(Side::Lower).ok();
        let smoothing = factor.map(|factor| factor.solve(&across).transpose().to_owned());
        Prediction { motion, smoothing }
    }

    /// What is known of the pose before a frame is looked at. A unit of the energy that it is added to
    /// counts `unit`; each number's variance is `inflated` so many times.
    pub(super) fn prior(&self, unit: f64, inflated: &[f64; NUMBERS]) -> Result<PosePrior> {
        let roots = inflated.map(f64::sqrt);
        let covariance: Vec<f64> =
            pairs().map(|(i, j)| unit * roots[i] * roots[j] * self.covariance[(i, j)]).collect();
        Ok(PosePrior::correlated(self.pose, &Dof::ALL, &covariance)?)
    }

    /// Variance of each number of the pose.
    pub(super) fn variances(&self) -> [f64; NUMBERS] {
        std::array::from_fn(|k| self.covariance[(k, k)])
    }

    /// The same once the pose is known better: it and its covariance, column after column. The prior's
    /// variances had been `inflated` so many times.
    pub(super) fn corrected(
        &self,
        pose: &Pose,
        covariance: &[f64],
        inflated: &[f64; NUMBERS],
        hand: &HandShape,
    ) -> Self {
        let roots = inflated.map(f64::sqrt);
        let before =
            Mat::from_fn(NUMBERS, NUMBERS, |i, j| roots[i] * roots[j] * self.covariance[(i, j)]);
        let after = Mat::from_fn(NUMBERS, NUMBERS, |i, j| covariance[j * NUMBERS + i]);
        // A velocity is only known through the pose: K = P_vp P_pp⁻¹.
        let mixed =
            Mat::from_fn(NUMBERS, NUMBERS, |i, j| roots[j] * self.covariance[(i + NUMBERS, j)]);
        // Where arithmetic does not tell, the velocity stays as it was.
        let gain = match before.llt(Side::Lower) {
            Ok(factor) => factor.solve(mixed.transpose()).transpose().to_owned(),
            Err(_) => Mat::zeros(NUMBERS, NUMBERS),
        };
        let innovation = Mat::from_fn(NUMBERS, 1, |k, _| pose.0[k] - self.pose.0[k]);
        let change = &gain * innovation;
        let own = &gain * (&before - &after) * gain.transpose();
        let mixed = &gain * &after;
        let mut corrected = self.clone();
        corrected.pose = *pose;
        for k in 0..NUMBERS {
            corrected.velocity[k] += change[(k, 0)];
        }
        corrected.covariance = Mat::from_fn(2 * NUMBERS, 2 * NUMBERS, |i, j| {
            match (i.checked_sub(NUMBERS), j.checked_sub(NUMBERS)) {
                (None, None) => after[(i, j)],
                (Some(i), None) => mixed[(i, j)],
                (None, Some(j)) => mixed[(j, i)],
                (Some(k), Some(l)) => {
                    let (k, l) = (k.max(l), k.min(l));
                    self.covariance[(k + NUMBERS, l + NUMBERS)] - own[(k, l)]
                }
            }
        });
        corrected.recentred(hand).0
    }

    /// The pose of an earlier frame, about its own frame, in the light of what the next one told: `later`
    /// was predicted and came out as `found`.
    pub(super) fn smoothed(
        &self,
        smoothing: &Mat<f64>,
        later: &Self,
        found: &Self,
        hand: &HandShape,
    ) -> Pose {
        let pose = starts::in_frame(&found.pose, &found.rest, &later.rest, hand);
        let change = Mat::from_fn(2 * NUMBERS, 1, |k, _| match k.checked_sub(NUMBERS) {
            None => pose.0[k] - later.pose.0[k],
            Some(k) => found.velocity[k] - later.velocity[k],
        });
        let change = smoothing * change;
        let mut smoothed = self.pose;
        (0..NUMBERS).for_each(|k| smoothed.0[k] += change[(k, 0)]);
        smoothed
    }

    /// The same about the hand's frame as it is now, and how the numbers turn with it.
    fn recentred(mut self, hand: &HandShape) -> (Self, Mat<f64>) {
        let rest = starts::frame_at(&self.pose, &self.rest, hand);
        let turn = (self.rest.matrix3.transpose() * rest.matrix3).transpose();
        let spin = self.pose.rotation().transpose();
        self.rest = rest;
        for dof in [Dof::ThetaX, Dof::ThetaY, Dof::ThetaZ, Dof::TX, Dof::TY, Dof::TZ] {
            self.pose[dof] = 0.0;
        }
        let turn = Mat::from_fn(2 * NUMBERS, 2 * NUMBERS, |i, j| {
            let of = |block: usize, i: usize, j: usize| {
                let first = [0, Dof::ThetaX.index(), Dof::TX.index()][block];
                let inner = |matrix: &DMat3| matrix.col(j - first)[i - first];
                match block {
                    0 => f64::from(u8::from(i == j)),
                    1 => inner(&spin),
                    _ => inner(&turn),
                }
            };
            let place = |k: usize| match k % NUMBERS {
                k if k < Dof::ThetaX.index() => 0,
                k if k < Dof::TX.index() => 1,
                _ => 2,
            };
            let together = i / NUMBERS == j / NUMBERS && place(i) == place(j);
            if together { of(place(i), i % NUMBERS, j % NUMBERS) } else { 0.0 }
        });
        self.covariance = &turn * &self.covariance * turn.transpose();
        let velocity = self.velocity;
        for (i, own) in self.velocity.iter_mut().enumerate() {
            *own = (0..NUMBERS).map(|j| turn[(i, j)] * velocity[j]).sum();
        }
        (self, turn)
    }
}

/// What unit noise adds to the variance of a number, to its covariance with its velocity, and to the
/// variance of that.
fn grown(seconds: f64, kept: f64) -> [f64; 3] {
    let steps = seconds / LASTS;
    [
        0.5 * LASTS.powi(3) * (2.0 * steps - 3.0 + 4.0 * kept - kept * kept),
        0.5 * LASTS.powi(2) * (1.0 - kept).powi(2),
        0.5 * LASTS * (1.0 - kept * kept),
    ]
}

/// The places of a covariance, column after column.
fn pairs() -> impl Iterator<Item = (usize, usize)> {
    (0..NUMBERS * NUMBERS).map(|k| (k % NUMBERS, k / NUMBERS))
}

/// A covariance as it is kept: its places, column after column.
mod covariance {
    use faer::Mat;
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

    const SIZE: usize = 2 * super::NUMBERS;

    pub(super) fn serialize<S: Serializer>(
        matrix: &Mat<f64>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let places = (0..SIZE * SIZE).map(|k| matrix[(k % SIZE, k / SIZE)]);
        places.collect::<Vec<f64>>().serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Mat<f64>, D::Error> {
        let places = Vec::<f64>::deserialize(deserializer)?;
        if places.len() != SIZE * SIZE {
            return Err(D::Error::invalid_length(places.len(), &"a covariance of 56 numbers"));
        }
        Ok(Mat::from_fn(SIZE, SIZE, |i, j| places[j * SIZE + i]))
    }
}
