use crate::chain::Chain;
use crate::error::{Error, Result};
use crate::limits::MAX_POINTS;
use crate::points::{in_range, norm, sub};

/// How often each point is averaged with its neighbours, 1 : 2 : 1, against the steps of the grid.
const SMOOTHINGS: usize = 2;

/// Takes points at equal steps of about `step` pixels along a contour, and appends them to `out`.
///
/// Pixels are denser along slanting lines than along the grid's, up to a factor of √2, and so weigh
/// more or less as the picture is rolled; equal steps do not. An open chain keeps its ends; a
/// closed one is sampled from its first point on.
///
/// # Errors
/// A coordinate out of range, a step that is not positive, or one so small that there would be more
/// than [`MAX_POINTS`] points.
///
/// ```
/// use phalanx_shape_context::{Chain, resample};
///
/// let diagonal: Vec<_> = (0..=30).map(|i| [f64::from(i), f64::from(i)]).collect();
/// let mut points = Vec::new();
/// resample(&diagonal, Chain::Open, 1.0, &mut points)?;
/// assert_eq!(points.len(), 43); // 30 √2 px long, one pixel apart, both ends kept
/// # Ok::<(), phalanx_shape_context::Error>(())
/// ```
pub fn resample(
    points: &[[f64; 2]],
    chain: Chain,
    step: f64,
    out: &mut Vec<[f64; 2]>,
) -> Result<()> {
    if let Some(point) = points.iter().position(|&p| !in_range(p)) {
        return Err(Error::BadPoint { point, x: points[point][0], y: points[point][1] });
    }
    let curve = smoothed(points, chain);
    let length: f64 = curve.windows(2).map(|pair| norm(sub(pair[1], pair[0]))).sum();
    let steps = (length / step).round().max(1.0);
    if step.is_nan() || step <= 0.0 {
        return Err(Error::BadStep { step });
    }
    if steps > MAX_POINTS as f64 {
        return Err(Error::TooManyPoints { points: steps as usize });
    }
    let (spacing, mut taken, mut travelled) = (length / steps, 0.0, 0.0);
    for pair in curve.windows(2) {
        let [from, stretch] = [pair[0], sub(pair[1], pair[0])];
        let reach = norm(stretch);
        while taken < steps && taken * spacing < travelled + reach {
            let share = (taken * spacing - travelled) / reach;
            out.push([from[0] + share * stretch[0], from[1] + share * stretch[1]]);
            taken += 1.0;
        }
        travelled += reach;
    }
    if chain == Chain::Open {
        out.extend(curve.last());
    }
    Ok(())
}

/// The smoothed contour; a closed one ends on its first point again. Open ends stay in place.
fn smoothed(points: &[[f64; 2]], chain: Chain) -> Vec<[f64; 2]> {
    let mut curve = points.to_vec();
    let n = curve.len();
    let inner = match chain {
        Chain::Closed => 0..n,
        Chain::Open => 1..n.saturating_sub(1),
    };
    for _ in 0..SMOOTHINGS {
        let rough = curve.clone();
        for i in inner.clone() {
            let (before, after) = (rough[(i + n - 1) % n], rough[(i + 1) % n]);
            curve[i] = [0, 1].map(|k| (before[k] + 2.0 * rough[i][k] + after[k]) / 4.0);
        }
    }
    if chain == Chain::Closed {
        curve.extend(curve.first().copied());
    }
    curve
}
