//! The fast histograms against a slow and obvious version: `atan2`, `sqrt`, `log2`.

use phalanx_shape_context::{
    BINS, Chain, Orientation, RINGS, SECTORS, ShapeContexts, mean_distance, ring_radii,
    sector_edges,
};
use proptest::prelude::*;

use crate::{property, star};

const ORIENTATIONS: [Orientation; 5] = [
    Orientation::ImageAxes,
    Orientation::Tangent { chain: Chain::Open },
    Orientation::Centroid,
    Orientation::PrincipalAxis,
    Orientation::HandAxis { forearm_end: [3.0, -60.5] },
];

fn slow_mean_distance(points: &[[f64; 2]]) -> f64 {
    let mut sum = 0.0;
    for (i, a) in points.iter().enumerate() {
        for b in &points[..i] {
            sum += (a[0] - b[0]).hypot(a[1] - b[1]);
        }
    }
    2.0 * sum / (points.len() * (points.len() - 1)) as f64
}

/// One row of [`BINS`] per point, given each point's axis.
fn slow_contexts(points: &[[f64; 2]], axis: impl Fn(usize) -> [f64; 2]) -> Vec<f64> {
    let mean = slow_mean_distance(points);
    let mut rows = vec![0.0; points.len() * BINS];
    for (i, (from, row)) in points.iter().zip(rows.chunks_exact_mut(BINS)).enumerate() {
        let [cos, sin] = axis(i);
        for to in points.iter().filter(|&to| to != from) {
            let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
            let octave = (dx.hypot(dy) / mean).log2();
            let ring = (octave + 4.0).floor().max(0.0) as usize;
            let turn = (dy.atan2(dx) - sin.atan2(cos)).to_degrees() - 7.5;
            let sector = (turn.rem_euclid(360.0) / 30.0).floor() as usize % SECTORS;
            if ring < RINGS {
                row[ring * SECTORS + sector] += 1.0;
            }
        }
        let seen: f64 = row.iter().sum();
        for bin in row {
            *bin /= seen;
        }
    }
    rows
}

/// No pair of these inputs is on an edge, so the counts must agree and only f32 may round.
fn compare(points: &[[f64; 2]]) -> Result<(), TestCaseError> {
    let mut contexts = ShapeContexts::new();
    for orientation in ORIENTATIONS {
        let fast = contexts.compute(points, orientation)?;
        let slow = slow_contexts(points, |i| fast.axis(i));
        prop_assert_eq!(fast.values().len(), slow.len());
        for (bin, (&f, s)) in fast.values().iter().zip(slow).enumerate() {
            prop_assert!((f64::from(f) - s).abs() < 1e-6, "{orientation:?}: bin {bin}: {f} {s}");
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(property::cases(48))]

    #[test]
    fn agrees_on_real_points(
        points in prop::collection::vec([-50.0..50.0, -50.0..50.0], 20..90),
    ) {
        compare(&points)?;
    }

    #[test]
    fn agrees_on_hands_of_pixels(palm in 6.0..20.0, x in -20.0..20.0_f64, tilt in 0.0..0.3) {
        let lobes = star::HAND.map(|(at, width, reach)| (at + tilt, width, reach + tilt));
        compare(&star::star([x.round(), -9.0], palm, &lobes))?;
    }

    #[test]
    fn agrees_on_the_mean_distance(
        points in prop::collection::vec([-50.0..50.0, -50.0..50.0], 3..60),
    ) {
        let (fast, slow) = (mean_distance(&points)?, slow_mean_distance(&points));
        prop_assert!((fast / slow - 1.0).abs() < 1e-12, "{fast} {slow}");
    }
}

#[test]
fn a_point_of_known_place_falls_into_its_bin() {
    // Three far points fix the scale; the fourth is turned about the first.
    for (sector, edge) in sector_edges().into_iter().enumerate() {
        for ring in 0..RINGS {
            let seen = |radius: f64| {
                let (sin, cos) = (edge + 0.1).sin_cos();
                let near = [radius * cos, radius * sin];
                let points = [[0.0, 0.0], near, [900.0, 0.0], [900.0, 1.0], [900.0, 2.0]];
                (mean_distance(&points).expect("a scale"), points)
            };
            // The radius moves the mean distance a little: settle on one inside the ring.
            let mut radius = 1.0;
            for _ in 0..60 {
                radius = 0.8 * ring_radii(seen(radius).0)[ring];
            }
            let mut contexts = ShapeContexts::new();
            let rows = contexts.compute(&seen(radius).1, Orientation::ImageAxes).expect("a shape");
            assert!(rows.values()[ring * SECTORS + sector] > 0.0, "ring {ring}, sector {sector}");
        }
    }
}

/// In a 3-4-5 triangle one side *is* the mean distance. At any size it belongs to the outer ring.
#[test]
fn a_distance_of_exactly_the_mean_goes_outwards() {
    let mut contexts = ShapeContexts::new();
    for size in 1..200 {
        let size = f64::from(size) / 7.0;
        let triangle = [[0.0, 0.0], [3.0 * size, 0.0], [0.0, 4.0 * size]];
        let rows = contexts.compute(&triangle, Orientation::ImageAxes).expect("a shape");
        let ring: f32 = rows.values()[3 * SECTORS..4 * SECTORS].iter().sum();
        assert_eq!(ring, 0.5, "seen from the right angle, 3 is within the mean and 4 is not");
    }
}

#[test]
fn no_pair_of_pixels_is_on_a_sectors_edge() {
    // Slopes of displacements within a 120×90 picture against axes that join pixels of it.
    let edges = sector_edges();
    let mut nearest = f64::INFINITY;
    for axis in [[1.0, 0.0], [1.0, 1.0], [3.0, -70.0], [31.0, 59.0], [-100.0, 1.0], [59.5, 44.5]] {
        for dx in -119..120 {
            for dy in -89..90 {
                if (dx, dy) == (0, 0) {
                    continue;
                }
                let [x, y]: [f64; 2] = axis;
                let turn = f64::from(dy).atan2(f64::from(dx)) - y.atan2(x);
                for edge in edges {
                    let gap = (turn - edge).rem_euclid(std::f64::consts::TAU);
                    nearest = nearest.min(gap.min(std::f64::consts::TAU - gap));
                }
            }
        }
    }
    // A million times the rounding of the angles themselves.
    assert!(nearest > 1e-9, "{nearest}");
}
