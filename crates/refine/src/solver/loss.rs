//! The robust loss of residuals, and the offset of a whole boundary that it is least at.

use crate::geometry::drawn_term::DrawnTerm;
use crate::priors::gaussian::GaussianPenalty;

/// The robust measure of residuals (Geman and McClure 1987).
#[derive(Debug, Clone, Copy)]
pub(crate) struct RobustLoss {
    /// Residuals well beyond this, px, do not count.
    pub(crate) reach: f64,
    /// Standard deviation of a boundary's place, px.
    pub(crate) noise: f64,
    /// Standard deviation of what segmentation adds to or takes from a whole boundary, px.
    pub(crate) margin: f64,
    /// Of so many edges one is looked at.
    pub(crate) every: usize,
    /// The share of its boundary from which on a view that is left unexplained counts less; infinite
    /// where all views are believed.
    pub(crate) disagreement: f64,
    /// How it counts where the drawn silhouette is not the observed one.
    pub(crate) drawn: DrawnTerm,
}

/// Landmarks count as much further from their joints than boundaries do from theirs, each over its deviation:
/// which joint a point belongs to is known, and where it is errs along two axes.
const OF_LANDMARKS: f64 = 3.0;

impl RobustLoss {
    /// The measure of landmarks that are known to a standard deviation of `std` px.
    pub(crate) fn of_landmarks(&self, std: f64) -> Self {
        let reach = OF_LANDMARKS * self.reach / self.noise * std;
        Self { reach, noise: std, every: 1, ..*self }
    }

    pub(crate) fn energy(&self, residual: f64) -> f64 {
        let (s, r) = (self.reach * self.reach, residual * residual);
        0.5 * s * r / (s + r) * self.every as f64 / (self.noise * self.noise)
    }

    /// What a pixel between the silhouettes costs that is so far from the observed boundary, px: the slope of a place's
    /// energy up to where that is steepest, and no less beyond (Huber 1964), so that a finger that is drawn where
    /// nothing was seen costs the more, the larger it is.
    pub(crate) fn density(&self, apart: f64) -> f64 {
        let steepest = self.reach / 3.0_f64.sqrt();
        let apart = apart.min(steepest);
        self.weight(apart) * apart / self.every as f64
    }

    /// The weight of a place of a drawn outline that is so far from the observed boundary, px, for the slope of the area
    /// that it bounds.
    pub(crate) fn area_weight(&self, apart: f64) -> f64 {
        /// Nearer than any pixel's middle is to a boundary.
        const LEAST: f64 = 1e-6;
        let apart = apart.max(LEAST);
        self.every as f64 * self.density(apart) / apart
    }

    /// The share of a boundary that is unexplained, 0 to 1: of so many places, and of what areas between the silhouettes
    /// add, which are wholly so.
    pub(crate) fn unexplained(&self, energy: f64, count: usize, areas: f64) -> f64 {
        (energy + areas) / (count.max(1) as f64 * self.most() + areas)
    }

    /// What share of its energy a view of which so much is unexplained adds to that of a pose, and of its
    /// slope: the robust measure once more, of whole views. A view that is left half of what disagrees
    /// counts fully. Of fewer than three views none is known to be wrong.
    pub(crate) fn belief(&self, unexplained: f64, views: usize) -> [f64; 2] {
        if views < 3 || self.disagreement.is_infinite() {
            return [1.0; 2];
        }
        let falls = 1.0 / (1.0 + unexplained / self.disagreement);
        let full = 1.5 * 1.5;
        [full * falls, full * falls * falls]
    }

    /// The energy of a residual far beyond reach.
    pub(crate) fn most(&self) -> f64 {
        0.5 * self.reach * self.reach * self.every as f64 / (self.noise * self.noise)
    }

    pub(crate) fn weight(&self, residual: f64) -> f64 {
        let s = self.reach * self.reach;
        let w = s / (s + residual * residual);
        w * w * self.every as f64 / (self.noise * self.noise)
    }

    /// How far a view's boundary lies outside the hand's, px: what segmentation adds all around or
    /// takes away. It is where the energy of a view's distances has a minimum, looked for from
    /// nothing, so that a pose has one energy, whatever was tried before it.
    pub(crate) fn margin(&self, distances: &[f64]) -> f64 {
        const CLOSE_PX: f64 = 1e-7;
        // Beyond all distances everything pulls back.
        let (mut low, mut high) =
            distances.iter().fold((0.0, 0.0), |(low, high), &d| (d.min(low), d.max(high)));
        let mut margin = 0.0;
        while high - low > CLOSE_PX {
            let (slope, curvature) = self.margin_slope(margin, distances);
            let newton = margin - slope / curvature;
            if curvature > 0.0 && (newton - margin).abs() < CLOSE_PX {
                break;
            }
            *(if slope > 0.0 { &mut high } else { &mut low }) = margin;
            let is_within = curvature > 0.0 && low < newton && newton < high;
            margin = if is_within { newton } else { 0.5 * (low + high) };
        }
        margin
    }

    /// The first and the second derivative of the energy of a view's distances by its margin.
    fn margin_slope(&self, margin: f64, distances: &[f64]) -> (f64, f64) {
        let s = self.reach * self.reach;
        let known = GaussianPenalty::new(margin, self.margin);
        let (mut slope, mut curvature) = (known.gradient, known.hessian);
        for distance in distances {
            let residual = distance - margin;
            let (weight, r) = (self.weight(residual), residual * residual);
            slope -= weight * residual;
            curvature += weight * (s - 3.0 * r) / (s + r);
        }
        (slope, curvature)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_margin_is_where_the_energy_is_least() {
        let loss = RobustLoss {
            reach: 1.0,
            noise: 0.5,
            margin: 1.0,
            every: 1,
            disagreement: f64::INFINITY,
            drawn: DrawnTerm::Outline,
        };
        assert_eq!(loss.margin(&[]), 0.0);
        assert_eq!(loss.margin(&[0.0; 9]), 0.0);
        for (offset, noise) in [(0.3, 0.4), (-0.8, 0.1), (6.0, 0.3), (-20.0, 3.0)] {
            let noise = |k: u32| noise * (f64::from(k) * 2.4).sin();
            let distances: Vec<f64> = (0..300).map(|k| offset + noise(k)).collect();
            let margin = loss.margin(&distances);
            let (slope, curvature) = loss.margin_slope(margin, &distances);
            assert!(slope.abs() < 1e-3 && curvature > 0.0, "{offset}: {margin}, {slope}");
        }
    }
}
