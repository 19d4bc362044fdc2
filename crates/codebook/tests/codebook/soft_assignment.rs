//! Votes against a slow and obvious version, and what must hold of any votes.

use phalanx_codebook::{Codebook, Error, Scratch, SoftAssignment, chi_squared};
use proptest::prelude::*;

use crate::property;

/// Histograms of `dim` bins, half of them empty, one after the other.
fn histograms(dim: usize, count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<f32>> {
    let height = prop_oneof![Just(0.0_f32), 0.0..1.0_f32];
    let histogram = prop::collection::vec(height, dim).prop_map(move |mut heights| {
        heights[dim / 2] += 0.1;
        let sum: f32 = heights.iter().sum();
        heights.into_iter().map(|h| h / sum).collect::<Vec<_>>()
    });
    prop::collection::vec(histogram, count).prop_map(|rows| rows.concat())
}

/// Centres, samples, their dimension, the scale and a number of neighbours.
fn elections() -> impl Strategy<Value = (Codebook, Vec<f32>, SoftAssignment)> {
    (1..70_usize).prop_flat_map(|dim| {
        (histograms(dim, 1..40), histograms(dim, 1..20), 0.05..0.2, any::<prop::sample::Index>())
            .prop_map(move |(centres, samples, scale, neighbours)| {
                let neighbours = 1 + neighbours.index(centres.len() / dim);
                let codebook = Codebook::from_parts(centres, dim, scale).expect("a codebook");
                (codebook, samples, SoftAssignment { neighbours })
            })
    })
}

fn votes(codebook: &Codebook, samples: &[f32], assignment: SoftAssignment) -> Vec<f64> {
    let mut out = vec![f64::NAN; codebook.len()];
    codebook.soft_assign(samples, assignment, &mut Scratch::default(), &mut out).expect("votes");
    out
}

/// χ² to every centre with its index, the nearest first.
fn slow_ranking(codebook: &Codebook, sample: &[f32]) -> Vec<(f64, usize)> {
    let centres = codebook.centres().chunks_exact(codebook.dim());
    let mut ranking: Vec<_> =
        centres.enumerate().map(|(i, centre)| (chi_squared(sample, centre), i)).collect();
    ranking.sort_by(|a, b| a.0.total_cmp(&b.0));
    ranking
}

fn slow_votes(codebook: &Codebook, samples: &[f32], assignment: SoftAssignment) -> Vec<f64> {
    let mut out = vec![0.0; codebook.len()];
    let n = (samples.len() / codebook.dim()) as f64;
    for sample in samples.chunks_exact(codebook.dim()) {
        let ranking = &slow_ranking(codebook, sample)[..assignment.neighbours];
        let weight = |chi_squared: f64| (-chi_squared / codebook.scale()).exp();
        let total: f64 = ranking.iter().map(|&(chi_squared, _)| weight(chi_squared)).sum();
        for &(chi_squared, centre) in ranking {
            out[centre] += weight(chi_squared) / total / n;
        }
    }
    out
}

/// Whether f32 cannot tell which centres of a sample come within its nearest few.
fn is_close_call(codebook: &Codebook, sample: &[f32], assignment: SoftAssignment) -> bool {
    let ranking = slow_ranking(codebook, sample);
    let last = ranking[assignment.neighbours - 1].0;
    ranking.get(assignment.neighbours).is_some_and(|next| next.0 - last < 1e-5)
}

proptest! {
    #![proptest_config(property::cases(256))]

    #[test]
    fn agrees_with_the_slow_version((codebook, samples, assignment) in elections()) {
        let dim = codebook.dim();
        prop_assume!(samples.chunks_exact(dim).all(|s| !is_close_call(&codebook, s, assignment)));
        let fast = votes(&codebook, &samples, assignment);
        for (centre, slow) in slow_votes(&codebook, &samples, assignment).into_iter().enumerate() {
            // A rounding of 1e-6 in χ² against a scale of 0.05 or more.
            prop_assert!((fast[centre] - slow).abs() < 1e-4, "{centre}: {} {slow}", fast[centre]);
        }
    }

    #[test]
    fn the_nearest_centre_is_the_slow_versions((codebook, samples, _) in elections()) {
        for sample in samples.chunks_exact(codebook.dim()) {
            let nearest = codebook.nearest(sample)?;
            let slow = slow_ranking(&codebook, sample)[0].0;
            prop_assert!((f64::from(nearest.distance) - slow).abs() < 2e-6);
            let centre = &codebook.centres()[nearest.centre * codebook.dim()..][..codebook.dim()];
            prop_assert!((chi_squared(sample, centre) - slow).abs() < 2e-6);
        }
    }

    #[test]
    fn votes_are_non_negative_and_sum_to_one((codebook, samples, assignment) in elections()) {
        let votes = votes(&codebook, &samples, assignment);
        prop_assert!(votes.iter().all(|&v| v >= 0.0));
        prop_assert!((votes.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_order_of_the_samples_does_not_matter((codebook, samples, assignment) in elections()) {
        let reversed: Vec<f32> =
            samples.rchunks_exact(codebook.dim()).flatten().copied().collect();
        let (forth, back) = (votes(&codebook, &samples, assignment), votes(&codebook, &reversed, assignment));
        for (a, b) in forth.into_iter().zip(back) {
            prop_assert!((a - b).abs() < 1e-14);
        }
    }

    #[test]
    fn one_neighbour_counts_the_nearest((codebook, samples, _) in elections()) {
        let mut counts = vec![0.0; codebook.len()];
        for sample in samples.chunks_exact(codebook.dim()) {
            counts[codebook.nearest(sample)?.centre] += 1.0;
        }
        let n = (samples.len() / codebook.dim()) as f64;
        let expected: Vec<f64> = counts.into_iter().map(|count| count / n).collect();
        prop_assert_eq!(votes(&codebook, &samples, SoftAssignment { neighbours: 1 }), expected);
    }

    #[test]
    fn scratch_forgets(a in elections(), b in elections()) {
        let mut scratch = Scratch::default();
        for (codebook, samples, assignment) in [a, b] {
            let mut out = vec![0.0; codebook.len()];
            codebook.soft_assign(&samples, assignment, &mut scratch, &mut out)?;
            prop_assert_eq!(out, votes(&codebook, &samples, assignment));
        }
    }
}

/// Far from every centre the weights underflow, unless the smallest χ² is subtracted first.
#[test]
fn a_far_sample_still_votes() {
    let centres = vec![1.0, 0.0, 0.0, 0.9, 0.1, 0.0];
    let codebook = Codebook::from_parts(centres, 3, 1e-5).expect("a codebook");
    let votes = votes(&codebook, &[0.0, 0.0, 1.0], SoftAssignment { neighbours: 2 });
    assert_eq!(votes, [0.5, 0.5]);
}

/// Of equal centres the first is the nearest.
#[test]
fn ties_go_to_the_first() {
    let centres = [[0.25, 0.75], [0.5, 0.5], [0.5, 0.5]].concat();
    let codebook = Codebook::from_parts(centres, 2, 0.1).expect("a codebook");
    assert_eq!(codebook.nearest(&[0.5, 0.5]).expect("a centre").centre, 1);
    assert_eq!(votes(&codebook, &[0.5, 0.5], SoftAssignment { neighbours: 1 }), [0.0, 1.0, 0.0]);
}

#[test]
fn wrong_calls_are_refused_by_name() {
    let codebook = Codebook::from_parts(vec![0.5, 0.5, 1.0, 0.0], 2, 0.1).expect("a codebook");
    let vote = |samples: &[f32], neighbours, length| {
        let out = &mut vec![0.0; length];
        codebook.soft_assign(samples, SoftAssignment { neighbours }, &mut Scratch::default(), out)
    };
    let sample = [0.5, 0.5];
    assert_eq!(vote(&sample, 0, 2), Err(Error::Neighbours { neighbours: 0, centres: 2 }));
    assert_eq!(vote(&sample, 3, 2), Err(Error::Neighbours { neighbours: 3, centres: 2 }));
    assert_eq!(vote(&sample, 1, 3), Err(Error::OutputLength { length: 3, centres: 2 }));
    assert_eq!(vote(&[], 1, 2), Err(Error::Empty { what: "sample" }));
    assert_eq!(vote(&[1.0; 3], 1, 2), Err(Error::Shape { what: "sample", values: 3, dim: 2 }));
    let two = [0.5, 0.5, 0.5, 0.6];
    assert!(matches!(vote(&two, 1, 2), Err(Error::NotNormalised { index: 1, .. })));
    for bad in [f32::NAN, f32::INFINITY, -0.1] {
        let two = [0.5, 0.5, 1.0, bad];
        assert!(matches!(vote(&two, 1, 2), Err(Error::BadHeight { index: 1, bin: 1, .. })));
    }
    assert!(matches!(codebook.nearest(&two), Err(Error::Shape { .. })));
}
