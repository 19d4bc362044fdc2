//! Few points that stand for many.

use faer::Mat;

use crate::error::Result;
use crate::linalg;

/// Most rounds of moving points to the middle of what is nearest to them.
const ROUNDS: usize = 30;
/// How far along a principal axis the first points are placed, in standard deviations: near the two
/// principal points of half a normal distribution each, which are 1.4 apart from its middle.
const FIRST: f64 = 1.5;

/// Principal points (Flury 1990) by Lloyd's algorithm, the first of them held at the origin.
pub(super) struct PrincipalPoints {
    /// One in each column.
    pub(super) centres: Mat<f64>,
    /// For each sample, the number of the point that is nearest.
    pub(super) nearest: Vec<usize>,
}

impl PrincipalPoints {
    /// Of samples m×n, at most `count`: the origin, and two along each of the principal axes about
    /// it, the strongest first.
    pub(super) fn of(samples: &Mat<f64>, count: usize) -> Result<Self> {
        let (m, n) = samples.shape();
        let axes = linalg::eigen(&linalg::gram(samples.transpose()))?;
        let count = count.min(2 * m + 1);
        let centres = Mat::from_fn(m, count, |j, point| match point.checked_sub(1) {
            None => 0.0,
            Some(place) => {
                let deviation = (axes.values[place / 2].max(0.0) / n as f64).sqrt();
                let side = if place % 2 == 0 { FIRST } else { -FIRST };
                side * deviation * axes.vectors[(j, place / 2)]
            }
        });
        let mut points = Self { centres, nearest: vec![0; n] };
        points.assign(samples);
        for _ in 0..ROUNDS {
            points.move_to_middles(samples);
            if !points.assign(samples) {
                break;
            }
        }
        Ok(points)
    }

    pub(super) fn count(&self) -> usize {
        self.centres.ncols()
    }

    /// Finds every sample's nearest point, of equal ones the first; says whether any changed.
    fn assign(&mut self, samples: &Mat<f64>) -> bool {
        let mut changed = false;
        for (k, nearest) in self.nearest.iter_mut().enumerate() {
            let sample = samples.col_as_slice(k);
            let distance = |point: usize| -> f64 {
                let centre = self.centres.col_as_slice(point);
                sample.iter().zip(centre).map(|(a, b)| (a - b) * (a - b)).sum()
            };
            let distances = (0..self.centres.ncols()).map(|point| (point, distance(point)));
            let best = distances.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(point, _)| point);
            changed |= best != *nearest;
            *nearest = best;
        }
        changed
    }

    /// Moves every point but the first to the mean of the samples nearest to it; a point that no
    /// sample is nearest to stays.
    fn move_to_middles(&mut self, samples: &Mat<f64>) {
        for point in 1..self.count() {
            let members: Vec<usize> =
                (0..samples.ncols()).filter(|&k| self.nearest[k] == point).collect();
            if members.is_empty() {
                continue;
            }
            let mut mean = vec![0.0; samples.nrows()];
            for &k in &members {
                linalg::axpy(&mut mean, 1.0 / members.len() as f64, samples.col_as_slice(k));
            }
            self.centres.col_as_slice_mut(point).copy_from_slice(&mean);
        }
    }
}
