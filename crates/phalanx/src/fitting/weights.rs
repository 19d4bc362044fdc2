//! What is known of each view: how much what it shows counts, and when it contradicts the others.

use serde::{Deserialize, Serialize};

/// What a take tells of its cameras, one by one.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct ViewWeights {
    /// How much a place of each border counts beside one that is known independently to the fit's noise.
    pub(super) borders: Vec<f64>,
    /// How well each camera's landmarks are known.
    pub(super) points: Vec<PointWeight>,
    /// Which cameras' masks are of something else than the hand that the others show, in the whole take.
    pub(super) wrong: Vec<bool>,
    /// How far each view of a frame may be from agreeing with its pose, and does not contradict it: the masks, then the
    /// landmarks.
    pub(super) limits: Vec<f64>,
}

/// How well the landmarks of a camera are known.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct PointWeight {
    /// Standard deviation of a point along each axis, mm at the hand.
    pub(super) std_mm: f64,
    /// How much a point counts beside one that errs independently.
    pub(super) weight: f64,
}

impl PointWeight {
    /// Before anything is known of them: points are as far off as borders may be, a quarter of a finger's
    /// width, and all of a hand count as much as its border, of some 350 places beside 21 points along two
    /// axes.
    pub(super) const UNKNOWN: Self = Self { std_mm: 4.0, weight: 8.0 };
}

impl ViewWeights {
    /// Of so many cameras of which nothing is known.
    pub(super) fn unknown(cameras: usize) -> Self {
        Self {
            borders: vec![1.0; cameras],
            points: vec![PointWeight::UNKNOWN; cameras],
            wrong: vec![false; cameras],
            limits: vec![1.0; 2 * cameras],
        }
    }

    /// Which views no frame is fitted to: of the masks, then of so many cameras' landmarks.
    pub(super) fn left_out(&self, points: usize) -> Vec<bool> {
        let mut left_out = self.wrong.clone();
        left_out.resize(left_out.len() + points, false);
        left_out
    }

    /// How much what counts most counts: a place of the best view's border; of landmarks alone, the best
    /// camera's points.
    pub(super) fn most(&self) -> f64 {
        self.borders.iter().copied().fold(f64::MIN_POSITIVE, f64::max)
    }

    /// The same beside the best view. Poses are fitted with these: the prior of postures is a normal
    /// distribution in place of one with two peaks, straight and folded, and pulls every finger between them
    /// when it counts as much as borders that err together.
    pub(super) fn relative(&self) -> Self {
        let most = self.most();
        let point = |point: &PointWeight| PointWeight { weight: point.weight / most, ..*point };
        Self {
            borders: self.borders.iter().map(|weight| weight / most).collect(),
            points: self.points.iter().map(point).collect(),
            wrong: self.wrong.clone(),
            limits: self.limits.clone(),
        }
    }
}
