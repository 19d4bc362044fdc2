//! The loops over all pairs of points, compiled for the widest instructions at hand.

use pulp::Arch;

use crate::{
    grid::{Grid, OPPOSITE, SLOTS},
    orientation::Axes,
    points::Columns,
};

/// How many points fell into each slot, seen from one point.
pub(crate) type Counts = [u32; SLOTS];

/// Partial sums, so that additions need not wait for one another. Their number is fixed, whatever
/// the width of the instructions, and with it the rounding.
const LANES: usize = 8;

/// The sum of the distances of all pairs.
pub(crate) fn distance_sum(xs: &[f64], ys: &[f64]) -> f64 {
    Arch::new().dispatch(|| {
        (0..xs.len())
            .map(|i| distances_from([xs[i], ys[i]], &xs[i + 1..], &ys[i + 1..]))
            .sum::<f64>()
    })
}

#[allow(clippy::inline_always, reason = "must be compiled with the caller's instruction set")]
#[inline(always)]
fn distances_from(from: [f64; 2], xs: &[f64], ys: &[f64]) -> f64 {
    let distance = |x: f64, y: f64| {
        let (dx, dy) = (x - from[0], y - from[1]);
        (dx * dx + dy * dy).sqrt()
    };
    let (x_chunks, x_rest) = xs.as_chunks::<LANES>();
    let (y_chunks, y_rest) = ys.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (x, y) in x_chunks.iter().zip(y_chunks) {
        for lane in 0..LANES {
            sums[lane] += distance(x[lane], y[lane]);
        }
    }
    let rest: f64 = x_rest.iter().zip(y_rest).map(|(&x, &y)| distance(x, y)).sum();
    sums.iter().sum::<f64>() + rest
}

/// Counts, for every point, the others in each slot of its grid.
pub(crate) fn count(
    points: &Columns,
    mean_distance: f64,
    axes: &Axes,
    slots: &mut Vec<u64>,
    counts: &mut Vec<Counts>,
) {
    let Columns { xs, ys } = points;
    slots.clear();
    slots.resize(xs.len(), 0);
    counts.clear();
    counts.resize(xs.len(), [0; SLOTS]);
    Arch::new().dispatch(|| match axes {
        Axes::Shared(axis) => count_shared(xs, ys, &Grid::new(mean_distance, *axis), slots, counts),
        Axes::PerPoint(axes) => {
            for (i, (row, axis)) in counts.iter_mut().zip(axes).enumerate() {
                find_slots(&Grid::new(mean_distance, *axis), [xs[i], ys[i]], xs, ys, slots);
                for &slot in &*slots {
                    row[slot as usize] += 1;
                }
            }
        }
    });
}

/// With one axis for all, i → j tells j → i as well.
#[allow(clippy::inline_always, reason = "must be compiled with the caller's instruction set")]
#[inline(always)]
fn count_shared(xs: &[f64], ys: &[f64], grid: &Grid, slots: &mut [u64], counts: &mut [Counts]) {
    for i in 0..xs.len() {
        let [row, later @ ..] = &mut counts[i..] else { return };
        let slots = &mut slots[i + 1..];
        find_slots(grid, [xs[i], ys[i]], &xs[i + 1..], &ys[i + 1..], slots);
        for (&slot, other) in slots.iter().zip(later) {
            row[slot as usize] += 1;
            other[usize::from(OPPOSITE[slot as usize])] += 1;
        }
    }
}

#[allow(clippy::inline_always, reason = "must be compiled with the caller's instruction set")]
#[inline(always)]
fn find_slots(grid: &Grid, from: [f64; 2], xs: &[f64], ys: &[f64], slots: &mut [u64]) {
    for ((slot, &x), &y) in slots.iter_mut().zip(xs).zip(ys) {
        *slot = grid.slot(x - from[0], y - from[1]);
    }
}
