//! Contours that cannot be described are refused by name.

use phalanx_shape_context::{
    Chain, Error, MAX_POINTS, Orientation, ShapeContexts, forearm_axis, hand_axis, mean_distance,
};
use proptest::prelude::*;

use crate::property;

const BENT: [[f64; 2]; 4] = [[0.0, 0.0], [4.0, 0.0], [9.0, 1.0], [9.0, 5.0]];

fn error(points: &[[f64; 2]], orientation: Orientation) -> Error {
    ShapeContexts::new().compute(points, orientation).map(|_| ()).expect_err("a refusal")
}

#[test]
fn too_few_and_too_many_points() {
    let points = vec![[1.0, 2.0]; MAX_POINTS + 1];
    assert_eq!(mean_distance(&[]), Err(Error::TooFewPoints { points: 0 }));
    assert_eq!(error(&points[..2], Orientation::Centroid), Error::TooFewPoints { points: 2 });
    assert_eq!(mean_distance(&points), Err(Error::TooManyPoints { points: MAX_POINTS + 1 }));
}

#[test]
fn coordinates_out_of_range() {
    for bad in [f64::NAN, f64::INFINITY, -1e300] {
        let mut points = BENT;
        points[2][1] = bad;
        assert!(matches!(mean_distance(&points), Err(Error::BadPoint { point: 2, .. })));
        assert!(matches!(hand_axis(&BENT, [bad, 0.0]), Err(Error::BadForearmEnd { .. })));
    }
}

#[test]
fn points_in_one_place() {
    assert_eq!(mean_distance(&[[3.0, 4.0]; 9]), Err(Error::Coincident { mean_distance: 0.0 }));
    assert_eq!(hand_axis(&[[3.0, 4.0]; 9], [3.0, 4.0]), Err(Error::NoHandAxis));
    // In one place, and with nothing along the second.
    for sides in [[[3.0, 4.0]; 2], [[0.0, 0.0], [0.0, 1.0]]] {
        assert_eq!(forearm_axis(&BENT, sides), Err(Error::NoForearmAxis));
    }
}

#[test]
fn a_point_far_from_all_others() {
    let mut points: Vec<_> = (0..50).map(|i| [f64::from(i % 7), f64::from(i / 7)]).collect();
    points.push([1e6, 0.0]);
    assert!(matches!(error(&points, Orientation::ImageAxes), Error::Isolated { point: 50, .. }));
}

#[test]
fn shapes_without_a_direction() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    assert_eq!(error(&square, Orientation::PrincipalAxis), Error::NoPrincipalAxis);
    let cross = [[0.0, 0.0], [3.0, 0.0], [-3.0, 0.0], [0.0, 3.0], [0.0, -3.0]];
    assert_eq!(error(&cross, Orientation::Centroid), Error::AtCentroid { point: 0 });
    let line = [[0.0, 0.0], [1.0, 2.0], [2.0, 4.0], [3.0, 6.0]];
    assert_eq!(error(&line, Orientation::Tangent { chain: Chain::Open }), Error::NoArea);
    let mut stuck = vec![[0.0, 0.0]; 9];
    stuck.extend([[5.0, 0.0], [5.0, 5.0], [0.0, 5.0]]);
    let tangent = Orientation::Tangent { chain: Chain::Open };
    assert_eq!(error(&stuck, tangent), Error::NoTangent { point: 0 });
}

/// A direction is a unit vector even where the squares of its components underflow.
#[test]
fn neighbours_that_almost_coincide() {
    let points =
        [[0.0, -8e-9], [-7e-9, 0.0], [0.0, 0.0], [5e-160, 0.0], [0.0, 3e-320], [4e-320, 0.0]];
    for chain in [Chain::Open, Chain::Closed] {
        let mut contexts = ShapeContexts::new();
        let found = contexts.compute(&points, Orientation::Tangent { chain }).expect("a tangent");
        for point in 0..points.len() {
            let [x, y] = found.axis(point);
            assert!((x.hypot(y) - 1.0).abs() < 1e-12, "{chain:?} {point}: {x} {y}");
        }
    }
}

proptest! {
    #![proptest_config(property::cases(256))]

    /// Whatever the points, an answer is finite.
    #[test]
    fn never_panics_and_never_answers_nan(
        points in prop::collection::vec([any::<f64>(), any::<f64>()], 0..12),
        small in prop::collection::vec([0..3_i8, 0..3_i8], 0..12),
        end in [any::<f64>(), any::<f64>()],
    ) {
        let small: Vec<_> = small.iter().map(|p| p.map(f64::from)).collect();
        let tiny: Vec<_> = points.iter().map(|p| p.map(|c| c % 1e-8)).collect();
        let mut contexts = ShapeContexts::new();
        for points in [points, small, tiny] {
            for sides in [[end, [1.0, 1.0]], [[0.0, 2.0], [2.0, 2.0]]] {
                if let Ok(axis) = forearm_axis(&points, sides) {
                    let [x, y] = axis.direction;
                    prop_assert!((x.hypot(y) - 1.0).abs() < 1e-9 && axis.width > 0.0);
                    prop_assert!(axis.start.iter().all(|c| c.is_finite()));
                }
            }
            for orientation in [
                Orientation::ImageAxes,
                Orientation::Tangent { chain: Chain::Closed },
                Orientation::Tangent { chain: Chain::Open },
                Orientation::Centroid,
                Orientation::PrincipalAxis,
                Orientation::HandAxis { forearm_end: end },
                Orientation::HandAxis { forearm_end: [1.0, 1.0] },
                Orientation::ForearmAxis { direction: end },
                Orientation::ForearmAxis { direction: [0.0, 5e-324] },
            ] {
                if let Ok(found) = contexts.compute(&points, orientation) {
                    prop_assert_eq!(found.rows().len(), points.len());
                    prop_assert!(found.mean_distance().is_finite());
                    for (i, row) in found.rows().enumerate() {
                        prop_assert!((row.iter().sum::<f32>() - 1.0).abs() < 1e-5);
                        let [x, y] = found.axis(i);
                        prop_assert!((x.hypot(y) - 1.0).abs() < 1e-9);
                    }
                }
            }
        }
    }
}
