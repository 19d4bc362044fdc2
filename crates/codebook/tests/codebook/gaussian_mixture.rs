//! Mixtures of Gaussians, and the Fisher vectors that they make.

use phalanx_codebook::{
    AnyEncoder, Encoder, Error, ExpectationMaximisation, Fisher, GaussianMixture, MixtureParts,
    Scratch,
};
use proptest::prelude::*;
use rand_core::Rng;
use rand_pcg::Pcg64;

use crate::property;

/// Samples of two Gaussians in the plane: three in four at (−3, 0) with deviations 0.5 and 1, one
/// in four at (3, 1) with 1 and 0.25.
fn two(count: usize, seed: u64) -> Vec<f32> {
    let mut rng = Pcg64::new(u128::from(seed), 0);
    let mut uniform = || f64::from(rng.next_u32()) / f64::from(u32::MAX) - 0.5;
    let mut samples = Vec::new();
    for i in 0..count {
        let (mean, deviation) =
            if i % 4 == 0 { ([3.0, 1.0], [1.0, 0.25]) } else { ([-3.0, 0.0], [0.5, 1.0]) };
        for (mean, deviation) in mean.into_iter().zip(deviation) {
            // Twelve uniform numbers sum to unit variance.
            let normal: f64 = (0..12).map(|_| uniform()).sum();
            samples.push((mean + deviation * normal) as f32);
        }
    }
    samples
}

fn mixture(seed: u64) -> GaussianMixture {
    let em = ExpectationMaximisation { components: 2, seed, ..Default::default() };
    em.fit(&two(4000, seed), 2).expect("a mixture")
}

fn code(coding: &impl Encoder, samples: &[f32]) -> Vec<f64> {
    let mut out = vec![f64::NAN; coding.dim()];
    coding.encode(samples, &mut Scratch::default(), &mut out).expect("a code");
    out
}

/// Log density of the samples, straight from the definition.
fn log_density(parts: &MixtureParts, samples: &[f32]) -> f64 {
    let density = |sample: &[f32]| -> f64 {
        let of_component = |k: usize| {
            let factors = (0..parts.dim).map(|i| {
                let at = k * parts.dim + i;
                let (mean, variance) = (f64::from(parts.means[at]), f64::from(parts.variances[at]));
                let squared = (f64::from(sample[i]) - mean).powi(2);
                (-0.5 * squared / variance).exp() / (std::f64::consts::TAU * variance).sqrt()
            });
            parts.weights[k] * factors.product::<f64>()
        };
        (0..parts.weights.len()).map(of_component).sum()
    };
    samples.chunks_exact(parts.dim).map(|sample| density(sample).ln()).sum()
}

#[test]
fn two_gaussians_are_found_again() {
    let parts = mixture(1).parts().clone();
    let left = usize::from(parts.means[0] > 0.0);
    let right = 1 - left;
    assert!((parts.weights[left] - 0.75).abs() < 0.01, "{parts:?}");
    for (k, mean, deviation) in
        [(left, [-3.0, 0.0], [0.5, 1.0]), (right, [3.0, 1.0], [1.0_f32, 0.25])]
    {
        for i in 0..2 {
            assert!((parts.means[2 * k + i] - mean[i]).abs() < 0.1, "{parts:?}");
            let found = parts.variances[2 * k + i].sqrt();
            assert!((found / deviation[i] - 1.0).abs() < 0.1, "{parts:?}");
        }
    }
}

/// Each number of a Fisher vector is a derivative of the log density, scaled by the root of its
/// information; roots keep its sign, and the order of magnitudes within the means' and the
/// deviations' halves of one component's direction.
#[test]
fn fisher_vectors_are_derivatives_of_the_log_density() {
    let mixture = mixture(2);
    let parts = mixture.parts().clone();
    let samples = &two(60, 9)[10..];
    let code = code(&Fisher { mixture }, samples);
    let mut slow = Vec::new();
    for (by_means, step) in [(true, 1e-2_f32), (false, 1e-2)] {
        for at in 0..4 {
            let moved = |by: f32| {
                let mut parts = parts.clone();
                let deviation = parts.variances[at].sqrt();
                if by_means {
                    parts.means[at] += by * deviation;
                } else {
                    parts.variances[at] = (deviation * (1.0 + by)).powi(2);
                }
                log_density(&parts, samples)
            };
            let slope = (moved(step) - moved(-step)) / f64::from(2.0 * step);
            let information = parts.weights[at / 2] * if by_means { 1.0 } else { 2.0 };
            slow.push(slope / information.sqrt());
        }
    }
    let length = slow.iter().map(|value: &f64| value.abs()).sum::<f64>();
    for (fast, slow) in code.iter().zip(&slow) {
        assert!((fast * fast.abs() - slow / length).abs() < 1e-3, "{code:?} {slow:?}");
    }
}

#[test]
fn the_same_bytes_at_any_number_of_threads() {
    let samples = two(10_000, 3);
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let em = ExpectationMaximisation { components: 5, ..Default::default() };
        pool.install(|| em.fit(&samples, 2)).expect("a mixture")
    };
    assert_eq!(with_threads(1), with_threads(4));
}

#[test]
fn parts_and_bytes_give_the_mixture_back_and_bad_ones_are_refused() {
    let mixture = mixture(4);
    let parts = mixture.parts().clone();
    assert_eq!(GaussianMixture::from_parts(parts.clone()).as_ref(), Ok(&mixture));
    let coding = AnyEncoder::Fisher(Fisher { mixture });
    let bytes = postcard::to_stdvec(&coding).expect("bytes");
    assert_eq!(postcard::from_bytes::<AnyEncoder>(&bytes).expect("a coding"), coding);
    assert_eq!((coding.bins(), coding.dim()), (2, 8));

    let error = |change: &dyn Fn(&mut MixtureParts)| {
        let mut parts = parts.clone();
        change(&mut parts);
        GaussianMixture::from_parts(parts).expect_err("a refusal")
    };
    assert!(matches!(error(&|p| p.weights[0] = 0.9), Error::BadWeights { .. }));
    assert!(matches!(error(&|p| p.weights[0] = f64::NAN), Error::BadWeights { .. }));
    assert!(matches!(error(&|p| p.variances[3] = 0.0), Error::BadHeight { index: 1, bin: 1, .. }));
    assert!(matches!(error(&|p| p.variances[3] = -1.0), Error::BadHeight { .. }));
    assert!(matches!(error(&|p| p.means[1] = f32::NAN), Error::BadNumber { index: 0, bin: 1, .. }));
    assert!(matches!(error(&|p| p.means.truncate(3)), Error::Shape { what: "mean", .. }));
    assert!(matches!(error(&|p| p.means.truncate(2)), Error::Shape { what: "mean", .. }));
    assert!(matches!(error(&|p| p.dim = 0), Error::Shape { .. }));
    assert!(matches!(error(&|p| p.means.clear()), Error::Empty { what: "mean" }));
}

#[test]
fn settings_out_of_range_are_refused() {
    let good = ExpectationMaximisation { components: 2, ..Default::default() };
    for bad in [
        ExpectationMaximisation { components: 0, ..good },
        ExpectationMaximisation { max_iterations: 0, ..good },
        ExpectationMaximisation { tolerance: f64::NAN, ..good },
        ExpectationMaximisation { variance_floor: 0.0, ..good },
        ExpectationMaximisation { variance_floor: 1.5, ..good },
    ] {
        assert!(matches!(bad.fit(&two(9, 1), 2), Err(Error::Parameter { .. })), "{bad:?}");
    }
}

proptest! {
    #![proptest_config(property::cases(48))]

    /// Whatever the scale, and with directions that do not vary or samples that repeat.
    #[test]
    fn mixtures_of_anything_are_finite(
        exponent in -12..12,
        flat: bool,
        repeats in 1..4_usize,
        seed: u64,
    ) {
        let scale = 10_f32.powi(exponent);
        let mut samples: Vec<f32> = two(40, seed).iter().map(|value| scale * value).collect();
        if flat {
            samples.iter_mut().step_by(2).for_each(|value| *value = scale);
        }
        let samples = samples.repeat(repeats);
        let em = ExpectationMaximisation { components: 3, ..Default::default() };
        let mixture = em.fit(&samples, 2)?;
        let code = code(&Fisher { mixture }, &samples);
        prop_assert!(code.iter().all(|value| value.is_finite()));
    }
}
