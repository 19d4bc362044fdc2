use crate::error::{Error, Result};
use crate::grid::{BINS, SLOTS};
use crate::mean_distance::mean_distance_of;
use crate::orientation::{Axes, Orientation};
use crate::pairs::Counts;
use crate::points::Columns;
use crate::{bilinear, pairs};

/// How a point votes for where it is seen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Binning {
    /// Into the one bin in which it lies.
    #[default]
    Nearest,
    /// Into the two nearest rings and the two nearest sectors, by how near their middles are, so
    /// that no histogram jumps where a point crosses an edge. Takes several times as long.
    Bilinear,
}

/// Computes shape contexts, keeping its memory from one contour to the next.
#[derive(Debug, Clone)]
pub struct ShapeContexts {
    binning: Binning,
    points: Columns,
    axes: Axes,
    slots: Vec<u64>,
    counts: Vec<Counts>,
    weights: Vec<[f64; BINS]>,
    histograms: Vec<f32>,
}

impl Default for ShapeContexts {
    fn default() -> Self {
        Self::new()
    }
}

impl ShapeContexts {
    /// An empty workspace; each point votes into one bin.
    pub fn new() -> Self {
        Self::with_binning(Binning::Nearest)
    }

    /// An empty workspace whose points vote as told.
    ///
    /// ```
    /// use phalanx_shape_context::{Binning, Orientation, ShapeContexts};
    ///
    /// let points = [[0.0, 0.0], [4.0, 0.0], [9.0, 1.0], [9.0, 5.0]];
    /// let mut contexts = ShapeContexts::with_binning(Binning::Bilinear);
    /// let first = &contexts.compute(&points, Orientation::ImageAxes)?.values()[..60];
    /// assert!(first.iter().filter(|&&height| height > 0.0).count() > 3);
    /// # Ok::<(), phalanx_shape_context::Error>(())
    /// ```
    pub fn with_binning(binning: Binning) -> Self {
        Self {
            binning,
            points: Columns::default(),
            axes: Axes::Shared([1.0, 0.0]),
            slots: Vec::new(),
            counts: Vec::new(),
            weights: Vec::new(),
            histograms: Vec::new(),
        }
    }

    /// The shape context of every point of a contour: where the others lie as seen from it
    /// (Belongie, Malik and Puzicha, 2002; the grid of de Campos and Murray, 2006, section 2).
    ///
    /// `points` are in pixels, y down, in the order of the contour (which matters to
    /// [`Orientation::Tangent`] alone). A point does not see itself, those in the same place, or
    /// those beyond 2μ, where μ is the mean distance of all pairs; each histogram is divided by
    /// the number it does see.
    ///
    /// # Errors
    /// Too few or too many points, coordinates out of range, all points in one place, a point that
    /// sees no other, or an orientation that the contour does not define.
    ///
    /// ```
    /// use phalanx_shape_context::{BINS, Orientation, ShapeContexts};
    ///
    /// let square = [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]];
    /// let mut contexts = ShapeContexts::new();
    /// let first = contexts.compute(&square, Orientation::ImageAxes)?.values().to_vec();
    /// // Neither place nor size matters.
    /// let moved = square.map(|[x, y]| [2.0 * x + 50.0, 2.0 * y + 70.0]);
    /// let found = contexts.compute(&moved, Orientation::ImageAxes)?;
    /// assert_eq!(found.values(), first);
    /// assert!(found.rows().all(|row| row.len() == BINS && (row.iter().sum::<f32>() - 1.0).abs() < 1e-6));
    /// # Ok::<(), phalanx_shape_context::Error>(())
    /// ```
    pub fn compute(
        &mut self,
        points: &[[f64; 2]],
        orientation: Orientation,
    ) -> Result<Descriptors<'_>> {
        self.points.load(points)?;
        let mean_distance = mean_distance_of(&self.points)?;
        self.axes.find(points, orientation, mean_distance)?;
        let Self { points, axes, slots, counts, weights, histograms, .. } = self;
        let normalised = match self.binning {
            Binning::Nearest => {
                pairs::count(points, mean_distance, axes, slots, counts);
                normalise(counts, histograms)
            }
            Binning::Bilinear => {
                bilinear::share(points, mean_distance, axes, weights);
                normalise_shares(weights, histograms)
            }
        };
        normalised.map_err(|point| Error::Isolated { point, mean_distance })?;
        Ok(Descriptors { histograms: &self.histograms, mean_distance, axes: &self.axes })
    }
}

/// Divides each row of counts by its sum, or names the row that has none.
fn normalise(counts: &[[u32; SLOTS]], out: &mut Vec<f32>) -> std::result::Result<(), usize> {
    out.clear();
    for (point, row) in counts.iter().enumerate() {
        let seen: u32 = row[..BINS].iter().sum();
        if seen == 0 {
            return Err(point);
        }
        let scale = 1.0 / seen as f32;
        out.extend(row[..BINS].iter().map(|&count| count as f32 * scale));
    }
    Ok(())
}

/// The same for shares of votes.
fn normalise_shares(weights: &[[f64; BINS]], out: &mut Vec<f32>) -> std::result::Result<(), usize> {
    out.clear();
    for (point, row) in weights.iter().enumerate() {
        let seen: f64 = row.iter().sum();
        if seen <= LEAST_SEEN {
            return Err(point);
        }
        out.extend(row.iter().map(|&share| (share / seen) as f32));
    }
    Ok(())
}

/// A point at the very edge of sight has a share of a vote that is nothing but rounding.
const LEAST_SEEN: f64 = 1e-9;

/// The shape contexts of one contour.
#[derive(Debug, Clone, Copy)]
pub struct Descriptors<'a> {
    histograms: &'a [f32],
    mean_distance: f64,
    axes: &'a Axes,
}

impl<'a> Descriptors<'a> {
    /// All histograms one after the other, [`BINS`] numbers each, in the order of the points.
    ///
    /// Each is non-negative and sums to 1; bin `ring * SECTORS + sector`, the innermost ring first
    /// and the sectors as in [`sector_edges`](crate::sector_edges).
    pub fn values(&self) -> &'a [f32] {
        self.histograms
    }

    /// The histograms, one slice of [`BINS`] numbers per point.
    pub fn rows(&self) -> std::slice::ChunksExact<'a, f32> {
        self.histograms.chunks_exact(BINS)
    }

    /// The mean distance μ of all pairs of points, in pixels. The rings end at
    /// [`ring_radii`](crate::ring_radii)`(μ)`.
    pub fn mean_distance(&self) -> f64 {
        self.mean_distance
    }

    /// The unit vector from which the sectors of a point are measured.
    ///
    /// # Panics
    /// When there is no such point.
    pub fn axis(&self, point: usize) -> [f64; 2] {
        let points = self.rows().len();
        assert!(point < points, "point {point} of {points}");
        self.axes.of(point)
    }
}
