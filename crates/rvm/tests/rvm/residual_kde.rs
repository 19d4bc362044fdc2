//! Hypotheses around a prediction: what they share, what they cover, what they cannot be made of.

use faer::Mat;
use phalanx_rvm::{Error, Hypothesis, ResidualKde, ResidualKdeParts};
use proptest::prelude::*;

use crate::problems::Source;
use crate::property;

fn squared_distance(hypothesis: &Hypothesis, target: impl Iterator<Item = f64>) -> f64 {
    hypothesis.mean.iter().zip(target).map(|(a, b)| (a - b).powi(2)).sum()
}

proptest! {
    #![proptest_config(property::cases(24))]

    /// With every sample a neighbour, the hypotheses are points among all residuals: their
    /// weights, means and deviations are those of the residuals nearest to each.
    #[test]
    fn hypotheses_are_the_middles_of_what_is_nearest(
        seed in any::<u64>(),
        count in 1..6_usize,
        scale in 0.1..10.0_f64,
    ) {
        let (m, n) = (3, 60);
        let mut source = Source::new(seed);
        let (predictions, targets) = (source.matrix(m, n), source.matrix(m, n));
        let units = [1.0, scale, 2.0];
        let density =
            ResidualKde::fit(predictions.as_ref(), targets.as_ref(), &units, n)?;
        let prediction = [0.1, -0.2, 0.3];
        let hypotheses = density.hypotheses(&prediction, count)?;
        prop_assert!(hypotheses.len() <= count);
        prop_assert_eq!(&hypotheses[0].mean, &prediction);
        prop_assert!(hypotheses[1..].is_sorted_by(|a, b| a.weight >= b.weight));
        let candidate = |i: usize, j: usize| prediction[j] + targets[(j, i)] - predictions[(j, i)];
        let far = |h: &Hypothesis, i: usize| -> f64 {
            (0..m).map(|j| ((h.mean[j] - candidate(i, j)) / units[j]).powi(2)).sum()
        };
        for (place, hypothesis) in hypotheses.iter().enumerate() {
            let members: Vec<usize> = (0..n)
                .filter(|&i| hypotheses.iter().all(|h| far(hypothesis, i) <= far(h, i) + 1e-12))
                .collect();
            let share = members.len() as f64 / n as f64;
            prop_assert!((share - hypothesis.weight).abs() < 1e-12);
            for j in 0..m {
                let of = members.iter().map(|&i| candidate(i, j));
                let mean = of.clone().sum::<f64>() / members.len() as f64;
                let square: f64 = of.map(|v| (v - hypothesis.mean[j]).powi(2)).sum();
                let std = (square / members.len().max(1) as f64).sqrt();
                prop_assert!(place == 0 || (mean - hypothesis.mean[j]).abs() < 1e-9);
                prop_assert!((std - hypothesis.std[j]).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn more_hypotheses_lie_nearer_to_the_truth(seed in any::<u64>()) {
        let (m, n) = (4, 300);
        let mut source = Source::new(seed);
        let predictions = source.matrix(m, n);
        let errors = source.matrix(m, n);
        let targets = &predictions + &errors;
        let density =
            ResidualKde::fit(predictions.as_ref(), targets.as_ref(), &[1.0; 4], 200)?;
        let covered = |count: usize| -> phalanx_rvm::Result<f64> {
            let mut total = 0.0;
            for i in 0..n {
                let hypotheses = density.hypotheses(predictions.col_as_slice(i), count)?;
                let truth = targets.col_as_slice(i);
                let distances =
                    hypotheses.iter().map(|h| squared_distance(h, truth.iter().copied()));
                total += distances.fold(f64::INFINITY, f64::min);
            }
            Ok(total)
        };
        let (one, three, five) = (covered(1)?, covered(3)?, covered(5)?);
        prop_assert!(three < 0.95 * one && five < 0.95 * three, "{one} {three} {five}");
    }

    #[test]
    fn barely_right_data_give_finite_hypotheses(
        seed in any::<u64>(),
        m in 1..4_usize,
        n in 1..8_usize,
        levels in 0..3_u32,
    ) {
        let mut source = Source::new(seed);
        let mut coarse =
            || Mat::from_fn(m, n, |_, _| (f64::from(levels) * source.uniform()).round());
        let (predictions, targets) = (coarse(), coarse());
        let units = vec![1.0; m];
        let density =
            ResidualKde::fit(predictions.as_ref(), targets.as_ref(), &units, n)?;
        let hypotheses = density.hypotheses(predictions.col_as_slice(0), n)?;
        let total: f64 = hypotheses.iter().map(|h| h.weight).sum();
        prop_assert!((total - 1.0).abs() < 1e-12);
        for hypothesis in hypotheses {
            prop_assert!(hypothesis.mean.iter().all(|v| v.is_finite()));
            prop_assert!(hypothesis.std.iter().all(|&v| v > 0.0));
        }
    }
}

/// Where a sample has one of two targets, whichever, both are among three hypotheses.
#[test]
fn two_answers_are_told_apart() {
    let mut source = Source::new(3);
    let predictions = source.matrix(2, 400);
    let targets = Mat::from_fn(2, 400, |j, i| {
        let side = if i % 2 == 0 { 3.0 } else { -3.0 };
        predictions[(j, i)] + if j == 0 { side } else { 0.0 } + 0.1 * source.uniform()
    });
    let density = ResidualKde::fit(predictions.as_ref(), targets.as_ref(), &[1.0; 2], 100).unwrap();
    let hypotheses = density.hypotheses(&[0.0, 0.0], 3).unwrap();
    assert_eq!(hypotheses.len(), 3);
    assert!(hypotheses[0].weight < 1e-12, "nothing is near the mean of the two");
    for hypothesis in &hypotheses[1..] {
        assert!((hypothesis.mean[0].abs() - 3.0).abs() < 0.05 && hypothesis.mean[1].abs() < 0.05);
        assert!((hypothesis.weight - 0.5).abs() < 0.2 && hypothesis.std[0] < 0.1);
    }
    assert!(hypotheses[1].mean[0] * hypotheses[2].mean[0] < 0.0);
}

/// A change to a density's parts.
type Change = fn(&mut ResidualKdeParts);

#[test]
fn what_cannot_be_one_is_named() {
    let mut source = Source::new(8);
    let (p, t) = (source.matrix(2, 9), source.matrix(2, 9));
    let fit =
        |units: &[f64], neighbours| ResidualKde::fit(p.as_ref(), t.as_ref(), units, neighbours);
    assert!(matches!(fit(&[1.0], 4), Err(Error::Shape { what: "units", .. })));
    assert!(matches!(fit(&[1.0, 0.0], 4), Err(Error::Parameter { name: "unit", .. })));
    assert!(matches!(fit(&[1.0; 2], 10), Err(Error::Parameter { name: "neighbours", .. })));
    let density = fit(&[1.0; 2], 4).unwrap();
    assert!(matches!(density.hypotheses(&[0.0], 2), Err(Error::Shape { .. })));
    assert!(matches!(density.hypotheses(&[0.0, f64::NAN], 2), Err(Error::BadValue { .. })));
    assert!(matches!(
        density.hypotheses(&[0.0; 2], 5),
        Err(Error::Parameter { name: "count", .. })
    ));
    assert!(matches!(
        density.hypotheses(&[0.0; 2], 0),
        Err(Error::Parameter { name: "count", .. })
    ));
    let changes: [(&str, Change); 5] = [
        ("outputs", |p| p.outputs = 0),
        ("neighbours", |p| p.neighbours = 100),
        ("units", |p| p.units[0] = -1.0),
        ("predictions", |p| p.predictions.truncate(17)),
        ("residuals", |p| p.residuals[3] = f64::NAN),
    ];
    for (expected, change) in changes {
        let mut parts = density.clone().into_parts();
        change(&mut parts);
        match ResidualKde::from_parts(parts) {
            Err(Error::Parts { field, .. }) => assert_eq!(field, expected),
            other => panic!("{expected}: {other:?}"),
        }
    }
    assert_eq!(ResidualKde::from_parts(density.clone().into_parts()).unwrap(), density);
}
