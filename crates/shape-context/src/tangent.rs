use crate::chain::Chain;
use crate::error::{Error, Result};
use crate::points::{cross, norm, perpendicular, sub, unit};

/// How many neighbours on either side a tangent is fitted to: on the pixel grid the chord of the
/// nearest two only knows multiples of 45°.
const REACH: usize = 3;

/// Relative size below which an area or a fitted direction is taken for zero.
const NEGLIGIBLE: f64 = 1e-9;

/// The unit tangent at each point, along the travel that goes round the enclosed area from +x
/// towards +y (clockwise on a screen), whichever way the points run.
pub(crate) fn tangents(
    points: &[[f64; 2]],
    chain: Chain,
    mean_distance: f64,
    out: &mut Vec<[f64; 2]>,
) -> Result<()> {
    let area = signed_area(points);
    if area.abs() <= NEGLIGIBLE * mean_distance * mean_distance {
        return Err(Error::NoArea);
    }
    out.clear();
    for point in 0..points.len() {
        let fit = Fit::at(points, chain, point);
        out.push(fit.tangent(area.signum()).ok_or(Error::NoTangent { point })?);
    }
    Ok(())
}

/// The area round which the points travel, positive from +x towards +y. An open chain is closed by
/// the straight line between its ends: for a hand, the cut through the forearm.
fn signed_area(points: &[[f64; 2]]) -> f64 {
    let origin = points[0];
    points.windows(2).map(|p| cross(sub(p[0], origin), sub(p[1], origin))).sum::<f64>() / 2.0
}

/// What the neighbours of a point say of its direction.
struct Fit {
    /// Least-squares slope of position against index, up to a factor.
    slope: [f64; 2],
    /// Sum of the displacements to the neighbours.
    lean: [f64; 2],
    /// Sum of the lengths that went into either, the measure of what is negligible.
    lengths: f64,
}

impl Fit {
    fn at(points: &[[f64; 2]], chain: Chain, i: usize) -> Self {
        let n = points.len();
        // Indices from `n` on stand for those that wrapped round, so that none is negative.
        let (first, last) = match chain {
            Chain::Closed => {
                let reach = REACH.min((n - 1) / 2);
                (n + i - reach, n + i + reach)
            }
            Chain::Open => (n + i.saturating_sub(REACH), n + (i + REACH).min(n - 1)),
        };
        let mut fit = Self { slope: [0.0; 2], lean: [0.0; 2], lengths: 0.0 };
        for j in first..=last {
            let weight = (2 * j) as f64 - (first + last) as f64;
            let offset = sub(points[j % n], points[i]);
            for (axis, component) in offset.into_iter().enumerate() {
                fit.slope[axis] += weight * component;
                fit.lean[axis] += component;
            }
            fit.lengths += norm(offset);
        }
        fit
    }

    /// The tangent, when the points travel with (+1) or against (−1) the wanted sense.
    ///
    /// At the tip of a line one pixel wide the contour turns back on itself and the slope
    /// vanishes; the neighbours then lie on the inner side, across the tangent.
    fn tangent(&self, sense: f64) -> Option<[f64; 2]> {
        let floor = NEGLIGIBLE * self.lengths;
        if norm(self.slope) > floor {
            Some(unit(self.slope).map(|c| sense * c))
        } else if norm(self.lean) > floor {
            Some(perpendicular(unit(self.lean)).map(|c| -c))
        } else {
            None
        }
    }
}
