//! Where 0° points, for contours whose axes are known.

use std::f64::consts::{FRAC_PI_2, TAU};

use phalanx_shape_context::{Chain, Orientation, ShapeContexts, hand_axis};

/// Tangents of a circle are a quarter turn ahead of its radii; of a chain too, at its ends.
#[test]
fn tangents_run_round_the_area() {
    let circle: Vec<[f64; 2]> = (0..40)
        .map(|i| (TAU * f64::from(i) / 40.0).sin_cos())
        .map(|(sin, cos)| [9.0 * cos, 9.0 * sin])
        .collect();
    let mut contexts = ShapeContexts::new();
    for (chain, points, slack) in
        [(Chain::Closed, &circle[..], 1e-9), (Chain::Open, &circle[..30], 0.5)]
    {
        let found = contexts.compute(points, Orientation::Tangent { chain }).expect("tangents");
        for (i, p) in points.iter().enumerate() {
            let [x, y] = found.axis(i);
            let ahead = y.atan2(x) - p[1].atan2(p[0]) - FRAC_PI_2;
            assert!(ahead.sin().abs() <= slack && ahead.cos() > 0.0, "{chain:?} {i}: {ahead}");
        }
    }
}

/// Where a contour runs out along a line one pixel wide and back, its tip's tangent is across it.
#[test]
fn the_tip_of_a_thin_line_has_a_tangent() {
    let mut points: Vec<[f64; 2]> = (0..6).map(|y| [0.0, -f64::from(y)]).collect();
    points.extend((0..5).rev().map(|y| [0.0, -f64::from(y)]));
    points.extend([[1.0, 1.0], [1.0, 3.0], [-1.0, 3.0], [-1.0, 1.0]]);
    let mut contexts = ShapeContexts::new();
    let orientation = Orientation::Tangent { chain: Chain::Closed };
    let forth = contexts.compute(&points, orientation).expect("tangents").axis(5);
    assert_eq!(forth, [1.0, 0.0]);
    points.reverse();
    let tip = points.len() - 6;
    let back = contexts.compute(&points, orientation).expect("tangents").axis(tip);
    assert_eq!(back, [1.0, 0.0]);
}

/// The axis at a contour point is a quarter turn ahead of the line from the centroid.
#[test]
fn centroid_axes_are_across_the_spokes() {
    let points = [[3.0, 0.0], [0.0, 2.0], [-3.0, 0.0], [0.0, -2.0]];
    let mut contexts = ShapeContexts::new();
    let found = contexts.compute(&points, Orientation::Centroid).expect("axes");
    let axes: Vec<_> = (0..4).map(|i| found.axis(i)).collect();
    assert_eq!(axes, [[0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [1.0, 0.0]]);
}

/// The principal axis of a drop points along its tail.
#[test]
fn the_principal_axis_points_along_the_tail() {
    let drop = [[0.0, 1.0], [0.0, -1.0], [-1.0, 0.0], [1.0, 1.0], [1.0, -1.0], [8.0, 0.0]];
    for (turn, tail) in [([1.0, 0.0], [1.0, 0.0]), ([0.0, -1.0], [0.0, -1.0])] {
        let [cos, sin]: [f64; 2] = turn;
        let points = drop.map(|[x, y]| [cos * x - sin * y, sin * x + cos * y]);
        let mut contexts = ShapeContexts::new();
        let [x, y] = contexts.compute(&points, Orientation::PrincipalAxis).expect("axes").axis(3);
        assert!((x - tail[0]).hypot(y - tail[1]) < 1e-9, "{turn:?}: {x} {y}");
    }
}

#[test]
fn the_hand_axis_has_the_angle_of_its_direction() {
    let axis = hand_axis(&[[0.0, 0.0], [1.0, 0.0], [4.0, 6.0]], [1.0, 2.0]).expect("an axis");
    assert_eq!((axis.tip, axis.tip_index), ([4.0, 6.0], 2));
    assert_eq!(axis.direction(), [0.6, 0.8]);
    assert!((axis.angle() - 0.8_f64.atan2(0.6)).abs() < 1e-12);
}
