use crate::axis::hand_axis;
use crate::chain::Chain;
use crate::error::{Error, Result};
use crate::points::{centroid, in_range, norm, perpendicular, sub, unit};
use crate::principal::principal_axis;
use crate::tangent::tangents;

/// What the direction 0° of the shape contexts is.
///
/// All but [`ImageAxes`](Self::ImageAxes) turn with the shape. None depends on where the contour
/// begins or on the direction in which it runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Orientation {
    /// The image's +x, for all points: not invariant to rotation.
    ImageAxes,
    /// The tangent at each point (Belongie, Malik and Puzicha, 2002), fitted to three neighbours
    /// on either side and directed so that the enclosed area is rounded from +x towards +y. An
    /// open chain is closed by the straight line between its ends.
    Tangent {
        /// Whether the contour goes all the way round.
        chain: Chain,
    },
    /// At each point, the perpendicular to the line from the centroid of the contour points to it,
    /// a quarter turn from +x towards +y (de Campos and Murray, 2006, section 2).
    Centroid,
    /// The direction in which the contour points spread most, for all points. Of its two senses,
    /// that with positive skewness: the longer tail lies ahead.
    PrincipalAxis,
    /// The hand axis, for all points: from the forearm's end to the contour point furthest from it
    /// (de Campos and Murray, 2006, section 2). See [`hand_axis`].
    HandAxis {
        /// The forearm's end, in pixels.
        forearm_end: [f64; 2],
    },
    /// The forearm's axis, for all points: along its two sides, towards the hand. No finger moves
    /// it. See [`forearm_axis`](crate::forearm_axis).
    ForearmAxis {
        /// Its direction, of any length but zero.
        direction: [f64; 2],
    },
}

/// Unit vectors of the direction 0°.
#[derive(Debug, Clone)]
pub(crate) enum Axes {
    Shared([f64; 2]),
    PerPoint(Vec<[f64; 2]>),
}

impl Axes {
    /// Finds the axes of checked points, reusing the memory of the last ones.
    pub(crate) fn find(
        &mut self,
        points: &[[f64; 2]],
        orientation: Orientation,
        mean_distance: f64,
    ) -> Result<()> {
        *self = match orientation {
            Orientation::ImageAxes => Self::Shared([1.0, 0.0]),
            Orientation::PrincipalAxis => Self::Shared(principal_axis(points, mean_distance)?),
            Orientation::HandAxis { forearm_end } => {
                Self::Shared(hand_axis(points, forearm_end)?.direction())
            }
            Orientation::ForearmAxis { direction } => {
                let is_direction = in_range(direction) && direction != [0.0; 2];
                Self::Shared(is_direction.then(|| unit(direction)).ok_or(Error::NoForearmAxis)?)
            }
            Orientation::Tangent { chain } => {
                let mut axes = self.take_buffer();
                tangents(points, chain, mean_distance, &mut axes)?;
                Self::PerPoint(axes)
            }
            Orientation::Centroid => {
                let mut axes = self.take_buffer();
                around_centroid(points, mean_distance, &mut axes)?;
                Self::PerPoint(axes)
            }
        };
        Ok(())
    }

    fn take_buffer(&mut self) -> Vec<[f64; 2]> {
        match self {
            Self::Shared(_) => Vec::new(),
            Self::PerPoint(axes) => std::mem::take(axes),
        }
    }

    pub(crate) fn of(&self, point: usize) -> [f64; 2] {
        match self {
            Self::Shared(axis) => *axis,
            Self::PerPoint(axes) => axes[point],
        }
    }
}

/// Displacements from the centroid shorter than this part of the mean distance have no direction.
const NEGLIGIBLE: f64 = 1e-9;

fn around_centroid(points: &[[f64; 2]], mean_distance: f64, out: &mut Vec<[f64; 2]>) -> Result<()> {
    let centre = centroid(points);
    out.clear();
    for (point, &p) in points.iter().enumerate() {
        let spoke = sub(p, centre);
        if norm(spoke) <= NEGLIGIBLE * mean_distance {
            return Err(Error::AtCentroid { point });
        }
        out.push(perpendicular(unit(spoke)));
    }
    Ok(())
}
