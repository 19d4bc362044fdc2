//! The loops over all pairs of points, compiled for the widest instructions at hand.
//!
//! [`Arch::dispatch`] takes a task whose code is compiled again for each instruction set; only what
//! is inlined into the task is.
#![allow(clippy::inline_always, reason = "must be compiled with the caller's instruction set")]

use pulp::{Arch, NullaryFnOnce};

use crate::grid::{Grid, OPPOSITE, SLOTS};
use crate::orientation::Axes;
use crate::points::Columns;

/// How many points fell into each slot, seen from one point.
pub(crate) type Counts = [u32; SLOTS];

/// Partial sums, so that additions need not wait for one another. Their number is fixed, whatever
/// the width of the instructions, and with it the rounding.
const LANES: usize = 8;

/// The sum of the distances of all pairs.
pub(crate) fn distance_sum(points: &Columns) -> f64 {
    Arch::new().dispatch(DistanceSum(points))
}

struct DistanceSum<'a>(&'a Columns);

impl NullaryFnOnce for DistanceSum<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        let Columns { xs, ys } = self.0;
        let mut sum = 0.0;
        for i in 0..xs.len() {
            sum += distances_from([xs[i], ys[i]], &xs[i + 1..], &ys[i + 1..]);
        }
        sum
    }
}

#[inline(always)]
fn distances_from(from: [f64; 2], xs: &[f64], ys: &[f64]) -> f64 {
    let (x_chunks, x_rest) = xs.as_chunks::<LANES>();
    let (y_chunks, y_rest) = ys.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (x, y) in x_chunks.iter().zip(y_chunks) {
        for lane in 0..LANES {
            sums[lane] += length(x[lane] - from[0], y[lane] - from[1]);
        }
    }
    for ((sum, x), y) in sums.iter_mut().zip(x_rest).zip(y_rest) {
        *sum += length(x - from[0], y - from[1]);
    }
    sums.iter().sum()
}

#[inline(always)]
fn length(dx: f64, dy: f64) -> f64 {
    (dx * dx + dy * dy).sqrt()
}

/// Counts, for every point, the others in each slot of its grid.
///
/// `slots` is scratch; `counts` gets one row per point.
pub(crate) fn count(
    points: &Columns,
    mean_distance: f64,
    axes: &Axes,
    slots: &mut Vec<u64>,
    counts: &mut Vec<Counts>,
) {
    let n = points.xs.len();
    slots.clear();
    slots.resize(n, 0);
    counts.clear();
    counts.resize(n, [0; SLOTS]);
    match axes {
        Axes::Shared(axis) => {
            let grid = Grid::new(mean_distance, *axis);
            Arch::new().dispatch(CountShared { points, grid, slots, counts });
        }
        Axes::PerPoint(axes) => {
            Arch::new().dispatch(CountEach { points, mean_distance, axes, slots, counts });
        }
    }
}

/// With one axis for all, i → j tells j → i as well.
struct CountShared<'a> {
    points: &'a Columns,
    grid: Grid,
    slots: &'a mut [u64],
    counts: &'a mut [Counts],
}

impl NullaryFnOnce for CountShared<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Columns { xs, ys } = self.points;
        let mut counts = self.counts;
        for i in 0..xs.len() {
            let Some((row, later)) = counts.split_first_mut() else { return };
            let slots = &mut self.slots[i + 1..];
            find_slots(&self.grid, [xs[i], ys[i]], &xs[i + 1..], &ys[i + 1..], slots);
            for (&slot, other) in slots.iter().zip(&mut *later) {
                row[slot as usize] += 1;
                other[usize::from(OPPOSITE[slot as usize])] += 1;
            }
            counts = later;
        }
    }
}

struct CountEach<'a> {
    points: &'a Columns,
    mean_distance: f64,
    axes: &'a [[f64; 2]],
    slots: &'a mut [u64],
    counts: &'a mut [Counts],
}

impl NullaryFnOnce for CountEach<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Columns { xs, ys } = self.points;
        for (i, (row, axis)) in self.counts.iter_mut().zip(self.axes).enumerate() {
            let grid = Grid::new(self.mean_distance, *axis);
            find_slots(&grid, [xs[i], ys[i]], xs, ys, self.slots);
            tally(self.slots, row);
        }
    }
}

#[inline(always)]
fn find_slots(grid: &Grid, from: [f64; 2], xs: &[f64], ys: &[f64], slots: &mut [u64]) {
    for ((slot, x), y) in slots.iter_mut().zip(xs).zip(ys) {
        *slot = grid.slot(x - from[0], y - from[1]);
    }
}

/// Adds each slot to the row, by way of several partial rows: neighbours often share a slot, and an
/// addition to a place in memory has to wait for the last one.
#[inline(always)]
fn tally(slots: &[u64], row: &mut Counts) {
    let mut partial = [[0; SLOTS]; 4];
    let (chunks, rest) = slots.as_chunks::<4>();
    for chunk in chunks {
        for (part, &slot) in partial.iter_mut().zip(chunk) {
            part[slot as usize] += 1;
        }
    }
    for &slot in rest {
        row[slot as usize] += 1;
    }
    for part in partial {
        row.iter_mut().zip(part).for_each(|(sum, count)| *sum += count);
    }
}
