//! One training set, learnt from some of the cameras with every method.

use anyhow::{Context, Result};
use faer::Mat;
use phalanx::{
    OrientationRule, PoseContexts, Progress, SceneSource, SceneSubset, Training, describe_each,
    targets,
};
use phalanx_hand::Pose;
use phalanx_multiview::CodebookTrainer;
use phalanx_shape_context::BINS;
use rayon::prelude::*;

use super::histograms::{ViewCodebooks, describe_with};
use super::method::{Method, Predictor};
use crate::data::described::Samples;
use crate::data::sets::Set;
use crate::eval::table1::PaperCounts;

/// What has been learnt from one training set through some of the cameras.
pub(crate) struct Learner {
    pub(crate) train: &'static str,
    pub(crate) train_samples: usize,
    pub(crate) codebooks: ViewCodebooks,
    pub(crate) predictors: Vec<(Method, Predictor)>,
    /// What guessing without looking says.
    pub(crate) mean: Predictor,
}

/// Learns from a set through each choice of cameras. The pictures are drawn once.
pub(crate) fn learn(
    set: &Set<'_>,
    views: &[Vec<usize>],
    rule: OrientationRule,
    methods: &[Method],
    progress: &dyn Progress,
) -> Result<Vec<Learner>> {
    let contexts = pilot_contexts(set, rule, progress)?;
    let codebooks =
        views.iter().map(|views| codebooks(&contexts, views, &CodebookTrainer::default()));
    let codebooks = codebooks.collect::<Result<Vec<_>>>()?;
    drop(contexts);
    let samples = describe(set, rule, &codebooks, progress)?.samples;
    let fitted =
        |(codebooks, samples)| Learner::fit(set.name, codebooks, &samples, methods, progress);
    codebooks.into_iter().zip(samples).map(fitted).collect()
}

impl Learner {
    /// Fits every method to samples that the codebooks described.
    pub(crate) fn fit(
        train: &'static str,
        codebooks: ViewCodebooks,
        samples: &Samples,
        methods: &[Method],
        progress: &dyn Progress,
    ) -> Result<Self> {
        let counts = PaperCounts::paper(codebooks.views.len(), train).at_most(samples.x.ncols());
        progress.begin(&format!("fit {train}"), methods.len());
        let fit = |&method: &Method| -> Result<(Method, Predictor)> {
            let predictor = method.fit(samples, counts);
            progress.step();
            Ok((method, predictor.with_context(|| method.name())?))
        };
        let predictors = methods.par_iter().map(fit).collect::<Result<_>>()?;
        let mean = Method::Mean.fit(samples, counts)?;
        Ok(Self { train, train_samples: samples.x.ncols(), codebooks, predictors, mean })
    }
}

/// Shape contexts of a part of a set, in every camera.
pub(crate) fn pilot_contexts(
    set: &Set<'_>,
    rule: OrientationRule,
    progress: &dyn Progress,
) -> Result<Vec<PoseContexts>> {
    let described =
        describe_each(set.rig, &SceneSubset::new(set, Training::CODEBOOK_SCENES), rule, progress)?;
    Ok(described.into_iter().filter_map(Result::ok).collect())
}

/// Codebooks of some of the cameras.
pub(crate) fn codebooks(
    contexts: &[PoseContexts],
    views: &[usize],
    vocabulary: &CodebookTrainer,
) -> Result<ViewCodebooks> {
    let seen: Vec<Vec<&[f32]>> = contexts
        .iter()
        .map(|sample| views.iter().map(|&v| sample[v].as_slice()).collect())
        .collect();
    Ok(ViewCodebooks { views: views.to_vec(), codebooks: vocabulary.fit(&seen, BINS)? })
}

/// What was seen of a set.
pub(crate) struct Seen {
    /// The scenes that could be described.
    pub(crate) numbers: Vec<usize>,
    /// Their descriptors and poses, for each of the codebooks.
    pub(crate) samples: Vec<Samples>,
}

/// Describes a whole set with each of the codebooks. Scenes that some camera does not show well
/// enough are left out, and said so on standard error.
///
/// # Errors
/// None of the scenes can be described.
pub(crate) fn describe(
    set: &Set<'_>,
    rule: OrientationRule,
    codebooks: &[ViewCodebooks],
    progress: &dyn Progress,
) -> Result<Seen> {
    let all: Vec<usize> = (0..set.count()).collect();
    progress.begin(&format!("see {}", set.name), all.len());
    let described = describe_with(set.rig, set, &all, rule, codebooks, progress)?;
    let (mut numbers, mut first) = (Vec::new(), None);
    let mut columns = vec![Vec::new(); codebooks.len()];
    for (number, described) in all.into_iter().zip(described) {
        match described {
            Ok(described) => {
                numbers.push(number);
                for (columns, x) in columns.iter_mut().zip(described) {
                    columns.push(x);
                }
            }
            Err(error) => first = first.or(Some(error)),
        }
    }
    if let Some(error) = first {
        if numbers.is_empty() {
            return Err(error).context(set.name);
        }
        let (left_out, all) = (set.count() - numbers.len(), set.count());
        eprintln!("{}: {left_out} of {all} are left out; the first: {error:#}", set.name);
    }
    let poses: Vec<_> = numbers.iter().map(|&number| set.poses[number]).collect();
    let samples = columns.iter().map(|columns| joined(columns, &poses)).collect();
    Ok(Seen { numbers, samples })
}

/// Descriptors as the columns of a matrix, with their poses.
pub(crate) fn joined(columns: &[Vec<f64>], poses: &[Pose]) -> Samples {
    let dim = columns.first().map_or(0, Vec::len);
    Samples { x: Mat::from_fn(dim, columns.len(), |row, i| columns[i][row]), y: targets(poses) }
}
