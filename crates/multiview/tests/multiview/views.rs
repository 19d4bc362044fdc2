//! Joining views: properties, refusals, storage and threads.

use phalanx_codebook::{AnyEncoder, Codebook, KMeans, SoftAssignment};
use phalanx_multiview::{CodebookTrainer, Error, PooledEncoder, Scratch, ViewEncoders};
use proptest::prelude::*;

use crate::property;

const BINS: usize = 6;

/// A sample: each view's histograms, one after the other.
type Views = Vec<Vec<f32>>;

fn histogram() -> impl Strategy<Value = Vec<f32>> {
    prop::collection::vec(0.01_f32..1.0, BINS).prop_map(|heights| {
        let sum: f32 = heights.iter().sum();
        heights.iter().map(|h| h / sum).collect()
    })
}

fn view(histograms: std::ops::Range<usize>) -> impl Strategy<Value = Vec<f32>> {
    prop::collection::vec(histogram(), histograms).prop_map(|all| all.concat())
}

/// Codebooks of 4, 5, … centres, and a sample of as many views.
fn joined_and_sample() -> impl Strategy<Value = (ViewEncoders, Views)> {
    (1_usize..4).prop_flat_map(|views| {
        let codebooks: Vec<_> = (0..views)
            .map(|v| {
                view(4 + v..5 + v)
                    .prop_map(|centres| Codebook::from_parts(centres, BINS, 0.1).unwrap())
            })
            .collect();
        let joined = (codebooks, 1_usize..5).prop_map(|(codebooks, neighbours)| {
            ViewEncoders::soft_histograms(codebooks, SoftAssignment { neighbours }).unwrap()
        });
        (joined, prop::collection::vec(view(1..12), views))
    })
}

fn describe(joined: &ViewEncoders, sample: &Views) -> Vec<f64> {
    let mut x = vec![f64::NAN; joined.dim()];
    joined.describe(sample, &mut Scratch::default(), &mut x).unwrap();
    x
}

/// How the contexts of each view vote.
fn assignment(joined: &ViewEncoders) -> SoftAssignment {
    match joined.views()[0] {
        AnyEncoder::SoftHistogram { assignment, .. } => assignment,
        _ => panic!("votes"),
    }
}

fn owned(joined: &ViewEncoders) -> Vec<Codebook> {
    joined.codebooks().into_iter().cloned().collect()
}

/// The parts of x, view by view.
fn parts<'a>(joined: &ViewEncoders, mut x: &'a [f64]) -> Vec<&'a [f64]> {
    let split = joined.codebooks().into_iter().map(|codebook| {
        let (part, rest) = x.split_at(codebook.len());
        x = rest;
        part
    });
    split.collect()
}

proptest! {
    #![proptest_config(property::cases(64))]

    #[test]
    fn each_view_is_a_histogram((joined, sample) in joined_and_sample()) {
        let x = describe(&joined, &sample);
        for part in parts(&joined, &x) {
            prop_assert!(part.iter().all(|&votes| votes >= 0.0));
            prop_assert!((part.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn each_part_is_that_views_own_votes((joined, sample) in joined_and_sample()) {
        let x = describe(&joined, &sample);
        for ((part, codebook), contexts) in
            parts(&joined, &x).into_iter().zip(joined.codebooks()).zip(&sample)
        {
            let mut votes = vec![0.0; codebook.len()];
            let mut scratch = phalanx_codebook::Scratch::default();
            codebook.soft_assign(contexts, assignment(&joined), &mut scratch, &mut votes).unwrap();
            prop_assert_eq!(part, votes.as_slice());
        }
    }

    #[test]
    fn the_order_of_contour_points_does_not_matter((joined, sample) in joined_and_sample()) {
        let reversed: Views = sample
            .iter()
            .map(|view| view.chunks_exact(BINS).rev().flatten().copied().collect())
            .collect();
        for (a, b) in describe(&joined, &sample).iter().zip(describe(&joined, &reversed)) {
            prop_assert!((a - b).abs() < 1e-12);
        }
    }

    #[test]
    fn views_in_another_order_give_the_parts_in_that_order(
        (joined, sample) in joined_and_sample()
    ) {
        let mut codebooks = owned(&joined);
        codebooks.reverse();
        let turned = ViewEncoders::soft_histograms(codebooks, assignment(&joined)).unwrap();
        let backwards: Views = sample.iter().rev().cloned().collect();
        let (x, y) = (describe(&joined, &sample), describe(&turned, &backwards));
        let mut expected = parts(&joined, &x);
        expected.reverse();
        prop_assert_eq!(parts(&turned, &y), expected);
    }

    #[test]
    fn a_used_scratch_changes_nothing(
        (joined, sample) in joined_and_sample(),
        (other, others) in joined_and_sample(),
    ) {
        let mut scratch = Scratch::default();
        other.describe(&others, &mut scratch, &mut vec![0.0; other.dim()]).unwrap();
        let mut x = vec![0.0; joined.dim()];
        joined.describe(&sample, &mut scratch, &mut x).unwrap();
        prop_assert_eq!(x, describe(&joined, &sample));
    }

    #[test]
    fn stored_and_read_back_it_is_the_same((joined, _) in joined_and_sample()) {
        let text = serde_json::to_string(&joined).unwrap();
        prop_assert_eq!(serde_json::from_str::<ViewEncoders>(&text).unwrap(), joined);
    }
}

/// 30 samples of `views` views, 8 histograms each, all different.
fn samples(views: usize) -> Vec<Views> {
    let histogram = |seed: usize| {
        let heights: Vec<f32> = (0..BINS).map(|b| 1.0 + (seed * (b + 3) % 2003) as f32).collect();
        let sum: f32 = heights.iter().sum();
        heights.into_iter().map(move |h| h / sum)
    };
    let view =
        |i: usize, v: usize| (0..8).flat_map(|k| histogram(500 + 8 * i + k + 500 * v)).collect();
    (0..30).map(|i| (0..views).map(|v| view(i, v)).collect()).collect()
}

fn vocabulary() -> CodebookTrainer {
    CodebookTrainer { centres: 18, ..CodebookTrainer::default() }
}

#[test]
fn centres_are_shared_evenly() {
    for views in 1..=3 {
        let joined = vocabulary().fit(&samples(views), BINS).unwrap();
        assert_eq!((joined.views().len(), joined.dim()), (views, 18));
        assert!(joined.codebooks().iter().all(|codebook| codebook.len() == 18 / views));
    }
    let vocabulary = CodebookTrainer { centres: 22, ..vocabulary() };
    let joined = vocabulary.fit(&samples(4), BINS).unwrap();
    let shares: Vec<usize> = joined.codebooks().into_iter().map(Codebook::len).collect();
    assert_eq!(shares, [6, 6, 5, 5], "what is left over goes to the first views");
}

#[test]
fn views_are_learnt_apart() {
    let both = samples(2);
    let joined = vocabulary().fit(&both, BINS).unwrap();
    let mut other = both.clone();
    for sample in &mut other {
        sample[1].reverse();
    }
    let changed = vocabulary().fit(&other, BINS).unwrap();
    assert_eq!(joined.codebooks()[0], changed.codebooks()[0]);
    assert_ne!(joined.codebooks()[1], changed.codebooks()[1]);
}

#[test]
fn the_seed_decides() {
    let fit = |seed| {
        let clustering = KMeans { seed, ..KMeans::default() };
        CodebookTrainer { clustering, ..vocabulary() }.fit(&samples(2), BINS).unwrap()
    };
    assert_eq!(fit(1), fit(1));
    assert_ne!(fit(1), fit(2));
}

#[test]
fn the_same_at_any_number_of_threads() {
    let fit = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| vocabulary().fit(&samples(3), BINS).unwrap())
    };
    assert_eq!(fit(1), fit(2));
    assert_eq!(fit(1), fit(8));
}

/// A periodic list, of which every n-th item is the same: a codebook of few of its items still has all of
/// them.
#[test]
fn few_samples_of_a_periodic_list_see_every_phase() {
    const PHASES: usize = BINS;
    let histogram = |phase: usize| {
        let mut histogram = vec![0.0_f32; BINS];
        histogram[phase] = 1.0;
        histogram
    };
    let all: Vec<Views> = (0..400).map(|k| vec![histogram(k % PHASES)]).collect();
    let few = CodebookTrainer { centres: PHASES, most_samples: 100, ..vocabulary() };
    let codebooks = few.fit(&all, BINS).unwrap();
    for phase in 0..PHASES {
        let nearest = codebooks.codebooks()[0].nearest(&histogram(phase)).unwrap();
        assert!(nearest.distance < 1e-6, "phase {phase}: {}", nearest.distance);
    }
}

#[test]
fn what_cannot_be_learnt_from_is_named() {
    let message = |samples: &[Views], vocabulary: &CodebookTrainer, dim| {
        vocabulary.fit(samples, dim).unwrap_err().to_string()
    };
    assert_eq!(message(&[], &vocabulary(), BINS), "there is no view");
    assert_eq!(message(&[vec![]], &vocabulary(), BINS), "there is no view");
    let mut odd = samples(2);
    odd[7].pop();
    assert_eq!(message(&odd, &vocabulary(), BINS), "1 views where there are codebooks for 2");
    let mut torn = samples(2);
    torn[3][1].pop();
    assert_eq!(
        message(&torn, &vocabulary(), BINS),
        "sample 3, view 1: 47 numbers do not make shape contexts of 6"
    );
    assert!(matches!(vocabulary().fit(&samples(2), 0), Err(Error::Shape { dim: 0, .. })));
    let none = CodebookTrainer { most_samples: 0, ..vocabulary() };
    assert_eq!(message(&samples(2), &none, BINS), "view 0: no samples");
    let mut bad = samples(2);
    bad[0][1][0] = f32::NAN;
    let message = message(&bad, &vocabulary(), BINS);
    assert!(message.starts_with("view 1: bin 0 of sample 0 is NaN"), "{message}");
    let greedy = CodebookTrainer { assignment: SoftAssignment { neighbours: 10 }, ..vocabulary() };
    assert_eq!(
        greedy.fit(&samples(2), BINS).unwrap_err().to_string(),
        "view 0: 10 neighbours among 9 centres"
    );
}

#[test]
fn what_cannot_be_described_is_named() {
    let samples = samples(2);
    let joined = vocabulary().fit(&samples, BINS).unwrap();
    let describe = |sample: &[Vec<f32>], length: usize| {
        let mut x = vec![0.0; length];
        joined.describe(sample, &mut Scratch::default(), &mut x).unwrap_err()
    };
    assert!(matches!(describe(&samples[0][..1], 18), Error::ViewCount { expected: 2, found: 1 }));
    assert!(matches!(describe(&samples[0], 17), Error::OutputLength { expected: 18, found: 17 }));
    let blind = [samples[0][0].clone(), Vec::new()];
    assert!(matches!(describe(&blind, 18), Error::View { view: 1, .. }));
}

#[test]
fn pooling_forgets_which_view_saw_what() {
    let samples = samples(3);
    let pooled = vocabulary().pool(&samples, BINS).unwrap();
    let describe = |sample: &[Vec<f32>]| {
        let mut x = vec![f64::NAN; pooled.dim()];
        pooled.describe(sample, &mut Scratch::default(), &mut x).unwrap();
        x
    };
    assert_eq!(pooled.dim(), 18, "every centre serves all views");
    let sample = &samples[7];
    let x = describe(sample);
    assert!((x.iter().sum::<f64>() - 1.0).abs() < 1e-9);
    assert_eq!(x, describe(&[sample.concat()]), "as one view with all the contexts");
    // Each view's histogram counts by its number of contexts, which here is the same.
    let each: Vec<_> = sample.iter().map(|view| describe(std::slice::from_ref(view))).collect();
    for (k, x) in x.iter().enumerate() {
        assert!((x - each.iter().map(|view| view[k]).sum::<f64>() / 3.0).abs() < 1e-9);
    }
    let mut turned = sample.clone();
    turned.rotate_left(1);
    let turned = describe(&turned);
    assert!(x.iter().zip(&turned).all(|(a, b)| (a - b).abs() < 1e-9));
}

#[test]
fn pooling_is_learning_from_a_single_view_of_all_contexts() {
    let samples = samples(3);
    let flat: Vec<Views> = samples.iter().map(|views| vec![views.concat()]).collect();
    let pooled = CodebookTrainer { most_samples: 50, ..vocabulary() }.pool(&samples, BINS).unwrap();
    let again = CodebookTrainer { most_samples: 50, ..vocabulary() }.pool(&flat, BINS).unwrap();
    assert_eq!(pooled, again);
}

#[test]
fn what_cannot_be_pooled_is_named() {
    let samples = samples(2);
    let pooled = vocabulary().pool(&samples, BINS).unwrap();
    let describe = |views: &[Vec<f32>], length: usize| {
        let mut x = vec![0.0; length];
        pooled.describe(views, &mut Scratch::default(), &mut x).unwrap_err()
    };
    assert!(matches!(describe(&[], 18), Error::NoViews));
    assert!(matches!(describe(&samples[0], 17), Error::OutputLength { expected: 18, found: 17 }));
    assert_eq!(describe(&[Vec::new()], 18).to_string(), "all views: no samples");
    assert!(matches!(vocabulary().pool::<Views, _>(&[], BINS), Err(Error::NoViews)));
    for neighbours in [0, 19] {
        let parts =
            PooledEncoder::from_parts(pooled.codebook().clone(), SoftAssignment { neighbours });
        assert!(matches!(parts, Err(Error::Pooled(_))));
    }
    let stored = serde_json::to_string(&pooled).unwrap();
    assert_eq!(serde_json::from_str::<PooledEncoder>(&stored).unwrap(), pooled);
    let greedy = stored.replace(r#""neighbours":5"#, r#""neighbours":19"#);
    let error = serde_json::from_str::<PooledEncoder>(&greedy).unwrap_err().to_string();
    assert!(error.contains("19 neighbours among 18 centres"), "{error}");
}

#[test]
fn parts_that_do_not_fit_are_refused() {
    assert!(matches!(
        ViewEncoders::soft_histograms(Vec::new(), SoftAssignment::default()),
        Err(Error::NoViews)
    ));
    let joined = vocabulary().fit(&samples(2), BINS).unwrap();
    for neighbours in [0, 10] {
        let parts = ViewEncoders::soft_histograms(owned(&joined), SoftAssignment { neighbours });
        assert!(matches!(parts, Err(Error::View { view: 0, .. })));
    }
    // What is read back is checked likewise.
    let stored = serde_json::to_string(&joined).unwrap();
    let greedy = stored.replace(r#""neighbours":5"#, r#""neighbours":10"#);
    assert_ne!(stored, greedy);
    let error = serde_json::from_str::<ViewEncoders>(&greedy).unwrap_err().to_string();
    assert!(error.contains("10 neighbours among 9 centres"), "{error}");
}

#[test]
fn the_code_of_a_view_that_is_missing_is_zero() {
    let codebook = Codebook::from_parts(vec![1.0, 0.0, 0.0, 1.0], 2, 0.1).unwrap();
    let joined = ViewEncoders::soft_histograms(vec![codebook; 2], SoftAssignment::HARD).unwrap();
    let (mut x, mut scratch) = ([f64::NAN; 4], Scratch::default());
    joined.describe_some(&[Some(&[0.9, 0.1]), None], &mut scratch, &mut x).unwrap();
    assert_eq!(x, [1.0, 0.0, 0.0, 0.0]);
}
