//! Residual codes against a slow and obvious version, and what must hold of any.

use phalanx_codebook::{AnyEncoder, Codebook, Encoder, Error, Scratch, SoftAssignment, Vlad};
use proptest::prelude::*;

use crate::histograms::{DIM, histograms};
use crate::property;

fn vlad(centres: usize, seed: u64) -> Vlad {
    Vlad {
        codebook: Codebook::from_parts(histograms(centres, seed), DIM, 0.1).expect("a codebook"),
    }
}

fn code(coding: &impl Encoder, samples: &[f32]) -> Vec<f64> {
    let mut out = vec![f64::NAN; coding.dim()];
    coding.encode(samples, &mut Scratch::default(), &mut out).expect("a code");
    out
}

/// Residuals to the nearest centres, summed; signed roots; length 1.
fn slow_code(vlad: &Vlad, samples: &[f32]) -> Vec<f64> {
    let mut sums = vec![0.0; vlad.dim()];
    for sample in samples.chunks_exact(DIM) {
        let nearest = vlad.codebook.nearest(sample).expect("a histogram").centre;
        for (bin, value) in sample.iter().enumerate() {
            let at = nearest * DIM + bin;
            sums[at] += f64::from(*value) - f64::from(vlad.codebook.centres()[at]);
        }
    }
    let roots: Vec<f64> = sums.iter().map(|sum| sum.signum() * sum.abs().sqrt()).collect();
    let length = roots.iter().map(|root| root * root).sum::<f64>().sqrt();
    roots.into_iter().map(|root| root / length).collect()
}

fn close(a: &[f64], b: &[f64], tolerance: f64) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
}

proptest! {
    #![proptest_config(property::cases(64))]

    #[test]
    fn agrees_with_the_slow_version(centres in 1..40_usize, samples in 1..30_usize, seed: u64) {
        let (vlad, samples) = (vlad(centres, seed), histograms(samples, !seed));
        prop_assert!(close(&code(&vlad, &samples), &slow_code(&vlad, &samples), 1e-9));
    }

    #[test]
    fn the_order_of_samples_does_not_matter(samples in 2..30_usize, seed: u64) {
        let (vlad, samples) = (vlad(12, seed), histograms(samples, !seed));
        let backwards: Vec<f32> = samples.chunks_exact(DIM).rev().flatten().copied().collect();
        // A root magnifies the rounding of a sum near zero.
        prop_assert!(close(&code(&vlad, &samples), &code(&vlad, &backwards), 1e-6));
    }

    #[test]
    fn samples_seen_twice_change_nothing(samples in 1..20_usize, seed: u64) {
        let (vlad, samples) = (vlad(12, seed), histograms(samples, !seed));
        let twice = [samples.as_slice(), &samples].concat();
        prop_assert!(close(&code(&vlad, &samples), &code(&vlad, &twice), 1e-6));
    }

    #[test]
    fn a_code_has_length_1(samples in 1..20_usize, seed: u64) {
        let (vlad, samples) = (vlad(12, seed), histograms(samples, !seed));
        let squared: f64 = code(&vlad, &samples).iter().map(|value| value * value).sum();
        prop_assert!((squared - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_used_scratch_changes_nothing(seed: u64) {
        let (first, second) = (vlad(12, seed), vlad(33, !seed));
        let samples = histograms(20, seed / 2);
        let mut scratch = Scratch::default();
        second.encode(&samples, &mut scratch, &mut vec![0.0; second.dim()]).expect("a code");
        let mut out = vec![0.0; first.dim()];
        first.encode(&samples, &mut scratch, &mut out).expect("a code");
        prop_assert_eq!(out, code(&first, &samples));
    }
}

#[test]
fn samples_at_their_centres_have_a_code_of_zeros() {
    let vlad = vlad(7, 3);
    let centres = vlad.codebook.centres().to_vec();
    assert!(code(&vlad, &centres).iter().all(|&value| value == 0.0));
}

#[test]
fn any_coding_is_what_it_wraps() {
    let (vlad, samples) = (vlad(9, 5), histograms(11, 6));
    let codebook = vlad.codebook.clone();
    let assignment = SoftAssignment { neighbours: 4 };
    let mut votes = vec![0.0; 9];
    codebook.soft_assign(&samples, assignment, &mut Scratch::default(), &mut votes).expect("votes");
    assert_eq!(code(&AnyEncoder::SoftHistogram { codebook, assignment }, &samples), votes);
    let any = AnyEncoder::Vlad(vlad.clone());
    assert_eq!((any.bins(), any.dim()), (DIM, 9 * DIM));
    assert_eq!(code(&any, &samples), code(&vlad, &samples));
    let bytes = postcard::to_stdvec(&any).expect("bytes");
    assert_eq!(postcard::from_bytes::<AnyEncoder>(&bytes).expect("a coding"), any);
}

#[test]
fn what_cannot_be_coded_is_refused_by_name() {
    let (vlad, samples) = (vlad(4, 1), histograms(3, 2));
    let refusal = |samples: &[f32], length: usize| {
        let mut out = vec![0.0; length];
        vlad.encode(samples, &mut Scratch::default(), &mut out).expect_err("a refusal")
    };
    let dim = vlad.dim();
    assert_eq!(refusal(&samples, dim - 1), Error::CodeLength { length: dim - 1, dim });
    assert_eq!(refusal(&[], dim), Error::Empty { what: "sample" });
    assert!(matches!(refusal(&samples[1..], dim), Error::Shape { .. }));
    let mut heavy = samples.clone();
    heavy[DIM] += 1.0;
    assert!(matches!(refusal(&heavy, dim), Error::NotNormalised { index: 1, .. }));
}
