//! What shape contexts must not depend on.
//!
//! The contours are hand-like curves on the pixel grid. Moved, scaled or turned, their displacements
//! are off the grid by rounding only, some 1e-14 of their length, while the nearest sector edge is
//! 1e-9 away or more; so histograms must agree to the rounding of f32, not merely on the whole.

use phalanx_shape_context::{Chain, Orientation, ShapeContexts, forearm_axis, hand_axis};
use proptest::prelude::*;

use crate::{property, star};

const TOLERANCE: f32 = 1e-6;

/// Where a forearm ends: the middle, and where its two sides begin.
#[derive(Debug, Clone, Copy)]
struct End {
    middle: [f64; 2],
    sides: [[f64; 2]; 2],
}

impl End {
    fn map(self, map: impl Fn([f64; 2]) -> [f64; 2]) -> Self {
        Self { middle: map(self.middle), sides: self.sides.map(map) }
    }
}

fn orientations(chain: Chain, points: &[[f64; 2]], end: End) -> Vec<Orientation> {
    [vec![Orientation::ImageAxes], oriented(chain, points, end)].concat()
}

/// Those that turn with the shape.
fn oriented(chain: Chain, points: &[[f64; 2]], end: End) -> Vec<Orientation> {
    let axis = forearm_axis(points, end.sides).expect("a forearm");
    vec![
        Orientation::Tangent { chain },
        Orientation::Centroid,
        Orientation::PrincipalAxis,
        Orientation::HandAxis { forearm_end: end.middle },
        Orientation::ForearmAxis { direction: axis.direction },
    ]
}

fn rows(points: &[[f64; 2]], orientation: Orientation) -> Result<Vec<Vec<f32>>, TestCaseError> {
    let mut contexts = ShapeContexts::new();
    Ok(contexts.compute(points, orientation)?.rows().map(<[f32]>::to_vec).collect())
}

fn assert_close(
    a: &[Vec<f32>],
    b: &[Vec<f32>],
    orientation: Orientation,
) -> Result<(), TestCaseError> {
    prop_assert_eq!(a.len(), b.len());
    for (point, (a, b)) in a.iter().zip(b).enumerate() {
        for (bin, (a, b)) in a.iter().zip(b).enumerate() {
            prop_assert!(
                (a - b).abs() <= TOLERANCE,
                "{orientation:?}: point {point}, bin {bin}: {a} {b}"
            );
        }
    }
    Ok(())
}

/// A hand on the grid, and its forearm's end: half-way between two pixels, as the middle of a run.
fn hand() -> impl Strategy<Value = (Vec<[f64; 2]>, End)> {
    let lobe =
        (-0.1..0.1, 0.1..0.2, 0.8..1.7).prop_map(|(turn, width, reach)| (turn, width, reach));
    (prop::array::uniform6(lobe), 7.0..16.0_f64, 0..40_i32).prop_map(|(lobes, palm, x)| {
        let mut lobes = lobes;
        lobes.iter_mut().zip(star::HAND).for_each(|(lobe, (at, ..))| lobe.0 += at);
        let x = f64::from(x);
        let side = |across: f64| [x + across * palm, 45.0 + 1.5 * palm];
        let middle = [x + 0.5, 45.0 + 2.0 * palm.round()];
        let end = End { middle, sides: [side(-0.4), side(0.4)] };
        (star::star([x, 45.0], palm, &lobes), end)
    })
}

proptest! {
    #![proptest_config(property::cases(32))]

    #[test]
    fn histograms_are_non_negative_and_sum_to_one((points, end) in hand()) {
        for orientation in orientations(Chain::Closed, &points, end) {
            for row in rows(&points, orientation)? {
                prop_assert!(row.iter().all(|&bin| bin >= 0.0));
                prop_assert!((row.iter().sum::<f32>() - 1.0).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn position_and_scale_drop_out(
        (points, end) in hand(),
        scale in 0.1..10.0,
        shift in [-300.0..300.0, -300.0..300.0],
    ) {
        let moved = |p: [f64; 2]| [scale * p[0] + shift[0], scale * p[1] + shift[1]];
        let image: Vec<_> = points.iter().copied().map(moved).collect();
        let before = orientations(Chain::Closed, &points, end);
        let after = orientations(Chain::Closed, &image, end.map(moved));
        for (before, after) in before.into_iter().zip(after) {
            assert_close(&rows(&points, before)?, &rows(&image, after)?, before)?;
        }
    }

    #[test]
    fn rotation_drops_out_of_the_oriented_modes(
        (points, end) in hand(),
        angle in 0.0..std::f64::consts::TAU,
    ) {
        let (sin, cos) = angle.sin_cos();
        let turned = |p: [f64; 2]| [cos * p[0] - sin * p[1], sin * p[0] + cos * p[1]];
        let image: Vec<_> = points.iter().copied().map(turned).collect();
        for chain in [Chain::Closed, Chain::Open] {
            for (before, after) in oriented(chain, &points, end).into_iter().zip(oriented(chain, &image, end.map(turned))) {
                assert_close(&rows(&points, before)?, &rows(&image, after)?, before)?;
            }
        }
    }

    #[test]
    fn rotation_shows_without_orientation((points, _) in hand(), angle in 0.5..5.5) {
        let (sin, cos) = f64::sin_cos(angle);
        let turned: Vec<_> =
            points.iter().map(|p| [cos * p[0] - sin * p[1], sin * p[0] + cos * p[1]]).collect();
        let orientation = Orientation::ImageAxes;
        prop_assert_ne!(rows(&points, orientation)?, rows(&turned, orientation)?);
    }

    #[test]
    fn the_start_of_a_closed_contour_and_its_direction_drop_out(
        (points, end) in hand(),
        start in 0..1000_usize,
    ) {
        let start = start % points.len();
        let mut elsewhere = points.clone();
        elsewhere.rotate_left(start);
        for orientation in orientations(Chain::Closed, &points, end) {
            let mut expected = rows(&points, orientation)?;
            expected.rotate_left(start);
            assert_close(&expected, &rows(&elsewhere, orientation)?, orientation)?;
        }
        elsewhere.reverse();
        for orientation in orientations(Chain::Closed, &points, end) {
            let mut expected = rows(&points, orientation)?;
            expected.rotate_left(start);
            expected.reverse();
            assert_close(&expected, &rows(&elsewhere, orientation)?, orientation)?;
        }
    }

    #[test]
    fn the_direction_of_an_open_contour_drops_out((points, end) in hand(), cut in 10..40_usize) {
        let open = &points[..points.len() - cut];
        let backwards: Vec<_> = open.iter().rev().copied().collect();
        for orientation in orientations(Chain::Open, open, end) {
            let mut expected = rows(open, orientation)?;
            expected.reverse();
            assert_close(&expected, &rows(&backwards, orientation)?, orientation)?;
        }
    }

    #[test]
    fn the_tip_is_the_furthest_point_and_survives_reordering((points, end) in hand(), by in 1..99_usize) {
        let end = end.middle;
        let axis = hand_axis(&points, end)?;
        let distance = |p: [f64; 2]| (p[0] - end[0]).hypot(p[1] - end[1]);
        prop_assert_eq!(points[axis.tip_index], axis.tip);
        prop_assert!(points.iter().all(|&p| distance(p) <= distance(axis.tip) + 1e-9));
        let mut other = points.clone();
        other.reverse();
        other.rotate_left(by % points.len());
        prop_assert_eq!(hand_axis(&other, end)?.tip, axis.tip);
    }
}

/// Straight sides up to `length`, and above them two fingers of given lengths.
fn fork(left: f64, right: f64) -> Vec<[f64; 2]> {
    let line = |from: [f64; 2], to: [f64; 2]| {
        (0..40).map(move |i| {
            let share = f64::from(i) / 40.0;
            [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])]
        })
    };
    let corners = [
        [-6.0, 0.0],
        [-6.0, -30.0],
        [-12.0, -30.0 - left],
        [-8.0, -30.0 - left],
        [0.0, -30.0],
        [8.0, -30.0 - right],
        [12.0, -30.0 - right],
        [6.0, -30.0],
        [6.0, 0.0],
    ];
    corners.windows(2).flat_map(|pair| line(pair[0], pair[1])).collect()
}

proptest! {
    #![proptest_config(property::cases(32))]

    /// The furthest point changes finger here; the hand axis jumps by 30 degrees and more.
    #[test]
    fn a_finger_that_outgrows_another_does_not_turn_the_forearm(
        length in 15.0..25.0,
        more in 0.001..0.1,
        cut in 0.0..6.0_f64,
    ) {
        let sides = [[-6.0, 0.0], [6.0, -cut]];
        let (before, after) = (fork(length + more, length), fork(length, length + more));
        let turn = |a: f64, b: f64| (a - b).abs().to_degrees();
        let forearm =
            turn(forearm_axis(&before, sides)?.angle(), forearm_axis(&after, sides)?.angle());
        prop_assert!(forearm < 0.1, "{forearm}");
        let end = [0.0, -cut / 2.0];
        let hand = turn(hand_axis(&before, end)?.angle(), hand_axis(&after, end)?.angle());
        prop_assert!(hand > 20.0, "{hand}");
    }

    /// However obliquely the forearm is cut, its axis lies between its sides.
    #[test]
    fn the_forearms_axis_does_not_depend_on_the_cut(
        cuts in [0.0..8.0_f64, 0.0..8.0],
        angle in 0.0..std::f64::consts::TAU,
    ) {
        let turned = |[x, y]: [f64; 2]| {
            let (sin, cos) = angle.sin_cos();
            [cos * x - sin * y, sin * x + cos * y]
        };
        let points: Vec<_> = fork(20.0, 20.0).into_iter().map(turned).collect();
        let sides = [[-6.0, -cuts[0]], [6.0, -cuts[1]]].map(turned);
        let axis = forearm_axis(&points, sides)?;
        let expected = turned([0.0, -1.0]);
        let off = (axis.direction[0] - expected[0]).hypot(axis.direction[1] - expected[1]);
        prop_assert!(off < 0.02, "{off}");
        let start = turned([0.0, -cuts[0].max(cuts[1])]);
        let off = (axis.start[0] - start[0]).hypot(axis.start[1] - start[1]);
        prop_assert!(off < 0.2, "{off}");
        prop_assert!((axis.width - 12.0).abs() < 0.2, "{}", axis.width);
    }
}

#[test]
fn tied_tips_do_not_depend_on_order_or_rotation() {
    // A symmetric fork seen from its stem: both tips are equally far.
    let fork = [[-3.0, 8.0], [0.0, 4.0], [3.0, 8.0], [0.0, 1.0]];
    let tip = hand_axis(&fork, [0.0, 0.0]).expect("an axis").tip;
    let mut reversed = fork;
    reversed.reverse();
    assert_eq!(hand_axis(&reversed, [0.0, 0.0]).expect("an axis").tip, tip);
    for degrees in 0..360_i32 {
        let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
        let turned = |p: [f64; 2]| [cos * p[0] - sin * p[1], sin * p[0] + cos * p[1]];
        let found = hand_axis(&fork.map(turned), [0.0, 0.0]).expect("an axis").tip;
        assert_eq!(found, turned(tip), "{degrees}");
    }
}

#[test]
fn a_workspace_forgets_the_last_contour() {
    let hand = star::star([50.0, 45.0], 12.0, &star::HAND);
    let mut contexts = ShapeContexts::new();
    let end = End { middle: [50.0, 80.0], sides: [[45.0, 62.0], [55.0, 62.0]] };
    for orientation in orientations(Chain::Closed, &hand, end) {
        let fresh = ShapeContexts::new()
            .compute(&hand[..60], orientation)
            .map(|rows| rows.values().to_vec())
            .expect("a shape");
        contexts.compute(&hand, Orientation::Centroid).expect("a shape");
        assert_eq!(contexts.compute(&hand[..60], orientation).expect("a shape").values(), fresh);
    }
}
