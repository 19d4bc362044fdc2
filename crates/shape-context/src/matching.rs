use crate::assignment::Assignment;
use crate::error::{Error, Result};
use crate::grid::BINS;
use crate::limits::MAX_MATCHED;

/// Compares shapes by their contexts, keeping its memory from one pair to the next.
///
/// Each context of the shape with fewer finds a partner of its own in the other, such that the sum
/// of their χ² statistics is as small as it can be (Belongie, Malik and Puzicha, 2002, section 3.2).
///
/// ```
/// use phalanx_shape_context::{Matcher, Orientation, ShapeContexts};
///
/// let square = [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]];
/// let kite = [[0.0, 0.0], [5.0, 1.0], [9.0, 9.0], [1.0, 5.0]];
/// let contexts = |points: &[[f64; 2]]| {
///     let mut contexts = ShapeContexts::new();
///     contexts.compute(points, Orientation::ImageAxes).map(|found| found.values().to_vec())
/// };
/// let mut matcher = Matcher::new();
/// let backwards = [square[3], square[2], square[1], square[0]];
/// let same = matcher.compare(&contexts(&square)?, &contexts(&backwards)?)?;
/// assert_eq!((same.distance, same.partners), (0.0, &[3, 2, 1, 0][..]));
/// assert!(matcher.compare(&contexts(&square)?, &contexts(&kite)?)?.distance > 0.1);
/// # Ok::<(), phalanx_shape_context::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Matcher {
    costs: Vec<f32>,
    assignment: Assignment,
}

/// How two shapes match.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Matching<'a> {
    /// The mean χ² of partners, 0 to 1.
    pub distance: f64,
    /// For each context of the shape with fewer (the first of equals), the index of its partner in
    /// the other.
    pub partners: &'a [usize],
}

impl Matcher {
    /// An empty workspace.
    pub fn new() -> Self {
        Self::default()
    }

    /// Matches two shapes' contexts, [`BINS`] numbers each, one after the other, as from
    /// [`Descriptors::values`](crate::Descriptors::values).
    ///
    /// # Errors
    /// A shape without contexts, with more than [`MAX_MATCHED`], with a part of one, or with a
    /// number that is negative or not finite.
    pub fn compare(&mut self, a: &[f32], b: &[f32]) -> Result<Matching<'_>> {
        check(a)?;
        check(b)?;
        let (few, many) = if a.len() <= b.len() { (a, b) } else { (b, a) };
        self.costs.clear();
        for context in few.chunks_exact(BINS) {
            self.costs.extend(many.chunks_exact(BINS).map(|other| chi_squared(context, other)));
        }
        let (rows, columns) = (few.len() / BINS, many.len() / BINS);
        let partners = self.assignment.solve(&self.costs, columns);
        let cost = |(row, &column): (usize, &usize)| f64::from(self.costs[row * columns + column]);
        let distance = partners.iter().enumerate().map(cost).sum::<f64>() / rows as f64;
        Ok(Matching { distance, partners })
    }
}

fn check(contexts: &[f32]) -> Result<()> {
    let values = contexts.len();
    if values == 0 || !values.is_multiple_of(BINS) || values / BINS > MAX_MATCHED {
        return Err(Error::NotContexts { values });
    }
    match contexts.iter().position(|height| !(height.is_finite() && *height >= 0.0)) {
        Some(at) => {
            Err(Error::BadHeight { context: at / BINS, bin: at % BINS, value: contexts[at] })
        }
        None => Ok(()),
    }
}

/// Partial sums, so that the loop becomes vector instructions; [`BINS`] is a multiple of it.
const LANES: usize = 12;

/// The χ² statistic of two contexts, ½ Σ (a − b)² / (a + b) with 0/0 = 0.
fn chi_squared(a: &[f32], b: &[f32]) -> f32 {
    let mut sums = [0.0; LANES];
    for (a, b) in a.as_chunks::<LANES>().0.iter().zip(b.as_chunks::<LANES>().0) {
        for lane in 0..LANES {
            let difference = a[lane] - b[lane];
            sums[lane] += difference * difference / (a[lane] + b[lane]).max(f32::MIN_POSITIVE);
        }
    }
    0.5 * sums.iter().sum::<f32>()
}
