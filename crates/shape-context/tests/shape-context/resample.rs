//! Points at equal steps along a contour.

use phalanx_shape_context::{Chain, Error, resample};
use proptest::prelude::*;

use crate::{property, star};

fn resampled(points: &[[f64; 2]], chain: Chain, step: f64) -> Vec<[f64; 2]> {
    let mut out = Vec::new();
    resample(points, chain, step, &mut out).expect("a good contour");
    out
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The pixels of a line at some angle, as a contour runs along them.
fn line(length: f64, angle: f64) -> Vec<[f64; 2]> {
    let (sin, cos) = angle.sin_cos();
    let steps = (length * cos.abs().max(sin.abs())).round();
    let at = |i: i32| f64::from(i) / steps * length;
    (0..=steps as i32).map(|i| [(at(i) * cos).round(), (at(i) * sin).round()]).collect()
}

proptest! {
    #![proptest_config(property::cases(64))]

    #[test]
    fn a_line_has_as_many_points_at_any_angle(angle in 0.0..std::f64::consts::TAU) {
        let line = line(100.0, angle);
        let found = resampled(&line, Chain::Open, 1.0);
        // As many as it is long, but for the steps of the grid that smoothing leaves.
        prop_assert!((100..=106).contains(&found.len()), "{} of {}", found.len(), line.len());
        prop_assert_eq!((found[0], found[found.len() - 1]), (line[0], line[line.len() - 1]));
    }

    #[test]
    fn steps_are_equal_and_points_stay_near(step in 0.5..3.0, cut in 0..40_usize) {
        let hand = star::star([50.0, 45.0], 12.0, &star::HAND);
        for (chain, points) in [(Chain::Closed, &hand[..]), (Chain::Open, &hand[cut..])] {
            let found = resampled(points, chain, step);
            for pair in found.windows(2) {
                // The straight line is shorter where the contour bends.
                prop_assert!(distance(pair[0], pair[1]) < 1.01 * step);
            }
            for &p in &found {
                let nearest = points.iter().map(|&q| distance(p, q)).fold(f64::MAX, f64::min);
                prop_assert!(nearest < 1.5, "{nearest}");
            }
            if chain == Chain::Closed {
                prop_assert!(distance(found[0], found[found.len() - 1]) < 1.01 * step);
            }
        }
    }

    #[test]
    fn the_direction_of_an_open_contour_drops_out(cut in 0..40_usize) {
        let hand = star::star([50.0, 45.0], 12.0, &star::HAND);
        let open = &hand[cut..];
        let backwards: Vec<_> = open.iter().rev().copied().collect();
        let forth = resampled(open, Chain::Open, 1.0);
        let back = resampled(&backwards, Chain::Open, 1.0);
        prop_assert_eq!(forth.len(), back.len());
        for (a, b) in forth.into_iter().zip(back.into_iter().rev()) {
            prop_assert!(distance(a, b) < 1e-9);
        }
    }

    #[test]
    fn whatever_the_input_there_is_an_answer_or_an_error(
        points in prop::collection::vec([any::<f64>(), any::<f64>()], 0..6),
        small in prop::collection::vec([0..3_i8, 0..3_i8], 0..6),
        step in any::<f64>(),
    ) {
        let small: Vec<_> = small.iter().map(|p| p.map(f64::from)).collect();
        for (points, step) in [(&points, step), (&points, 1e8), (&small, step), (&small, 0.3)] {
            for chain in [Chain::Open, Chain::Closed] {
                let mut out = Vec::new();
                if resample(points, chain, step, &mut out).is_ok() {
                    prop_assert!(out.iter().flatten().all(|c| c.is_finite()));
                    prop_assert!(chain == Chain::Closed || out.is_empty() == points.is_empty());
                }
            }
        }
    }
}

#[test]
fn bad_steps_are_named() {
    let line = [[0.0, 0.0], [5.0, 0.0]];
    let with = |step| resample(&line, Chain::Open, step, &mut Vec::new());
    for step in [0.0, -1.0, f64::NEG_INFINITY] {
        assert_eq!(with(step), Err(Error::BadStep { step }));
    }
    assert!(matches!(with(f64::NAN), Err(Error::BadStep { .. })));
    assert!(matches!(with(1e-300), Err(Error::TooManyPoints { .. })));
}
