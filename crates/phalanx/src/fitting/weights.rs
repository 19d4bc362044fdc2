//! How much what each view shows counts.

use serde::{Deserialize, Serialize};

/// How much borders and points count, camera by camera.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct ViewWeights {
    /// How much a place of each border counts beside one that is known independently to the fit's noise.
    pub(super) borders: Vec<f64>,
    /// How well each camera's landmarks are known.
    pub(super) points: Vec<PointWeight>,
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
        Self { borders: vec![1.0; cameras], points: vec![PointWeight::UNKNOWN; cameras] }
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
        }
    }
}
