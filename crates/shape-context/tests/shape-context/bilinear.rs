//! Votes shared by bins: what must hold of them, and how they go with whole votes.

use phalanx_shape_context::{
    BINS, Binning, Matcher, Orientation, SECTORS, ShapeContexts, mean_distance,
};
use proptest::prelude::*;

use crate::{property, star};

fn contexts(binning: Binning, points: &[[f64; 2]]) -> Vec<f32> {
    let mut contexts = ShapeContexts::with_binning(binning);
    contexts.compute(points, Orientation::ImageAxes).expect("a shape").values().to_vec()
}

fn furthest(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

proptest! {
    #![proptest_config(property::cases(64))]

    #[test]
    fn histograms_sum_to_1_and_do_not_jump(
        points in prop::collection::vec([-50.0..50.0, -50.0..50.0], 30..60),
        moved in 0..30_usize,
    ) {
        let before = contexts(Binning::Bilinear, &points);
        for row in before.chunks_exact(BINS) {
            prop_assert!(row.iter().all(|&height| height >= 0.0));
            prop_assert!((row.iter().sum::<f32>() - 1.0).abs() < 1e-5);
        }
        let mut points = points;
        let near = points.iter().enumerate().any(|(i, p)| {
            i != moved && (p[0] - points[moved][0]).hypot(p[1] - points[moved][1]) < 0.5
        });
        prop_assume!(!near);
        points[moved][0] += 1e-6;
        prop_assert!(furthest(&before, &contexts(Binning::Bilinear, &points)) < 1e-4);
    }
}

/// In the middle of a bin no other has a share.
#[test]
fn the_middle_of_a_bin_is_its_own() {
    // The others lie ahead, in the first sector and the last.
    for sector in 2..SECTORS - 2 {
        for ring in 1..4_usize {
            let angle = (22.5 + 30.0 * sector as f64).to_radians();
            let seen = |radius: f64| {
                let near = [radius * angle.cos(), radius * angle.sin()];
                [[0.0, 0.0], near, [900.0, 0.0], [900.0, 1.0], [900.0, 2.0]]
            };
            // The radius moves the mean distance a little: settle on one in the ring's middle.
            let mut radius = 1.0;
            for _ in 0..60 {
                let mean = mean_distance(&seen(radius)).expect("a scale");
                radius = mean * 2.0_f64.powf(ring as f64 - 3.5);
            }
            let rows = contexts(Binning::Bilinear, &seen(radius));
            let bin = ring * SECTORS + sector;
            assert!(rows[bin] > 0.0, "ring {ring}, sector {sector}");
            for beside in [bin - 1, bin + 1, bin - SECTORS, bin + SECTORS] {
                assert!(rows[beside] < 1e-6, "ring {ring}, sector {sector}: {}", rows[beside]);
            }
        }
    }
}

#[test]
fn shapes_match_themselves_and_less_so_others() {
    let hand = star::star([60.0, 45.0], 14.0, &star::HAND);
    let fist = star::star([60.0, 45.0], 14.0, &star::HAND[5..]);
    let mut matcher = Matcher::new();
    for binning in [Binning::Nearest, Binning::Bilinear] {
        let [hand, fist] = [&hand, &fist].map(|points| contexts(binning, points));
        let same = matcher.compare(&hand, &hand).expect("a matching");
        assert_eq!(same.distance, 0.0);
        assert!(matcher.compare(&hand, &fist).expect("a matching").distance > 0.1);
        let [ahead, back] = [(&hand, &fist), (&fist, &hand)]
            .map(|(a, b)| matcher.compare(a, b).expect("a matching").distance);
        assert_eq!(ahead, back);
    }
}

#[test]
fn what_is_no_context_is_refused() {
    let mut matcher = Matcher::new();
    let good = vec![1.0; BINS];
    let mut error = |bad: &[f32]| matcher.compare(bad, &good).expect_err("a refusal").to_string();
    assert!(error(&[]).starts_with("0 numbers"));
    assert!(error(&good[1..]).starts_with("59 numbers"));
    assert_eq!(
        error(&[&good[..], &[f32::NAN], &good[1..]].concat()),
        "bin 0 of context 1 is NaN: heights are finite and not negative"
    );
}
