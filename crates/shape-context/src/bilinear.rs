//! Votes shared by the bins around a point.

use std::f64::consts::TAU;

use crate::grid::{BINS, RINGS, SECTORS, sector_edges};
use crate::orientation::Axes;
use crate::points::{Columns, cross, dot};

/// Adds, for every point, the shares of the others in each bin; `weights` gets one row per point.
pub(crate) fn share(
    points: &Columns,
    mean_distance: f64,
    axes: &Axes,
    weights: &mut Vec<[f64; BINS]>,
) {
    weights.clear();
    weights.resize(points.xs.len(), [0.0; BINS]);
    for (i, row) in weights.iter_mut().enumerate() {
        let axis = axes.of(i);
        let from = [points.xs[i], points.ys[i]];
        for (x, y) in points.xs.iter().zip(&points.ys) {
            vote([x - from[0], y - from[1]], axis, mean_distance, row);
        }
    }
}

/// Shares one vote among the two nearest rings and the two nearest sectors, in proportion to how
/// near their middles are: rings in octaves, sectors in angle. Within the middle of the innermost
/// ring all of it is that ring's; what would go to a ring beyond the last is dropped.
fn vote(offset: [f64; 2], axis: [f64; 2], mean_distance: f64, row: &mut [f64; BINS]) {
    let distance = offset[0].hypot(offset[1]);
    // The ring that begins at μ/16 is the first: the disc inside μ/8 has it to itself.
    let ring = (distance / mean_distance).log2() + 3.5;
    if distance == 0.0 || ring >= RINGS as f64 {
        return;
    }
    let ring = ring.max(0.0);
    let angle = cross(axis, offset).atan2(dot(axis, offset));
    let sector = (angle - sector_edges()[0]) / TAU * SECTORS as f64 - 0.5;
    let (inner, first) = (ring.floor(), sector.floor());
    let (outwards, onwards) = (ring - inner, sector - first);
    let first = first.rem_euclid(SECTORS as f64) as usize % SECTORS;
    for (ring, of_ring) in [(inner as usize, 1.0 - outwards), (inner as usize + 1, outwards)] {
        if ring < RINGS {
            row[ring * SECTORS + first] += of_ring * (1.0 - onwards);
            row[ring * SECTORS + (first + 1) % SECTORS] += of_ring * onwards;
        }
    }
}
