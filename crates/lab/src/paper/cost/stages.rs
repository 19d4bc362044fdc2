//! The stages whose times the paper gives, and memory.

use std::hint::black_box;

use anyhow::{Context, Result};
use image::RgbImage;
use phalanx::{Describer, OrientationRule, Picture};
use phalanx_codebook::Encoder;
use phalanx_hand::Dof;
use phalanx_render::{Appearance, Renderer};
use phalanx_rvm::{Model, Scratch};
use phalanx_segmentation::{Silhouette, SkinModel};
use phalanx_shape_context::BINS;

use crate::clock::seconds;
use crate::context::Lab;
use crate::data::described::{Described, Halves, Samples, vocabulary};
use crate::data::split::Split;
use crate::eval::table1::{PaperCounts, TableMethod};
use crate::memory;

/// The counts that the paper's § 5.4 has times for.
const COUNTS: PaperCounts =
    PaperCounts { lin_features: 32, gauss_samples: 38, both_features: 32, both_samples: 38 };
/// The size of the photographs, px.
const PICTURE: (u32, u32) = (640, 480);

/// A time of the paper's and ours, seconds.
pub(super) struct Stage {
    pub(super) name: &'static str,
    pub(super) paper: Option<f64>,
    pub(super) here: f64,
}

/// Something that is kept in memory, bytes.
pub(super) struct Held {
    pub(super) name: String,
    pub(super) bytes: usize,
}

pub(super) struct Stages {
    pub(super) timed: Vec<Stage>,
    pub(super) held: Vec<Held>,
    /// Seconds to describe one picture, and to estimate a pose by lin, gauss and both.
    pub(super) describe: f64,
    pub(super) estimate: [f64; 3],
    /// Seconds to learn the codebooks, and to fit the regressor that takes longest.
    pub(super) clustering: f64,
    pub(super) dearest_fit: f64,
}

/// Times every stage on three views of the training half of complex.
pub(super) fn run(lab: &Lab<'_>) -> Result<(Stages, Halves)> {
    let described = lab.complex()?;
    let views = lab.all_views();
    let halves = described.halves(&views, 0)?;
    let clustering = clustering(described, &views)?;
    let (models, fits) = fitted(&halves.train)?;
    let estimate = estimates(&models, &halves.test)?;
    let photographs = photographs(lab)?;
    let describe = describe(&photographs[..1], &halves)?;
    let frame = self::describe(&photographs, &halves)? + estimate[1];
    let stage = |name, paper, here| Stage { name, paper, here };
    let timed = vec![
        stage("descriptor of one picture", Some(0.170), describe),
        stage("pose, linear, 32 features", Some(7.2e-6), estimate[0]),
        stage("pose, Gaussian, 38 samples, all 90 features", Some(35.7e-6), estimate[1]),
        stage("pose, Gaussian, 38 samples, 32 features", Some(25.4e-6), estimate[2]),
        stage("a frame of three cameras, the most expensive parameters", Some(0.652), frame),
        stage("training: clustering the codebooks", None, clustering),
        stage("training: linear, 32 features", Some(7.0), fits[0]),
        stage("training: Gaussian, 38 samples, all features", Some(328.0), fits[1]),
        stage("training: Gaussian, 38 samples, 32 features", Some(305.0), fits[2]),
    ];
    let held = held(described, &halves, &models);
    let dearest_fit = fits.into_iter().fold(0.0, f64::max);
    Ok((Stages { timed, held, describe, estimate, clustering, dearest_fit }, halves))
}

/// Seconds to learn the codebooks of the training half.
fn clustering(described: &Described, views: &[usize]) -> Result<f64> {
    let split = Split::even(described.poses.len(), 0);
    let seen = described.seen(views, &split.train);
    seconds(|| {
        black_box(vocabulary(0).fit(&seen, BINS)?);
        Ok(())
    })
}

/// The paper's three models, and the seconds that each took.
fn fitted(train: &Samples) -> Result<(Vec<Model>, Vec<f64>)> {
    let mut models = Vec::new();
    let mut times = Vec::new();
    for method in [TableMethod::Lin, TableMethod::Gauss, TableMethod::Both] {
        let regressor = method.regressor(COUNTS).context("it fits nothing")?;
        models.push(regressor.fit(&train.x, &train.y)?.model);
        times.push(seconds(|| {
            black_box(regressor.fit(&train.x, &train.y)?);
            Ok(())
        })?);
    }
    Ok((models, times))
}

fn estimates(models: &[Model], test: &Samples) -> Result<[f64; 3]> {
    let x: Vec<f64> = test.x.col(0).iter().copied().collect();
    let mut times = [0.0; 3];
    for (time, model) in times.iter_mut().zip(models) {
        *time = estimate(model, &x)?;
    }
    Ok(times)
}

/// Seconds to estimate one pose.
pub(super) fn estimate(model: &Model, x: &[f64]) -> Result<f64> {
    let (mut scratch, mut pose) = (Scratch::default(), [0.0; Dof::COUNT]);
    seconds(|| Ok(model.predict_mean_into(black_box(x), &mut scratch, &mut pose)?))
}

/// What the cameras see of a pose.
fn photographs(lab: &Lab<'_>) -> Result<Vec<RgbImage>> {
    let pose = &lab.complex()?.poses[0];
    let solids = lab.hand.pose(pose, &lab.rig.volume.rest_frame()).primitives;
    let photograph = |camera: &phalanx_camera::Camera| {
        let large = camera.intrinsics.resized(PICTURE.0, PICTURE.1);
        let mut renderer = Renderer::new(&camera.with_intrinsics(large))?;
        Ok(renderer.shade(&solids, &Appearance::default(), 0)?)
    };
    lab.rig.cameras.iter().map(photograph).collect()
}

/// Seconds from decoded photographs, of the first cameras, to their histograms.
fn describe(photographs: &[RgbImage], halves: &Halves) -> Result<f64> {
    let skin = SkinModel::builtin();
    let (mut describer, mut silhouette) = (Describer::default(), Silhouette::default());
    let mut votes = phalanx_codebook::Scratch::default();
    seconds(|| {
        for (photograph, encoder) in photographs.iter().zip(halves.codebooks.views()) {
            describer.silhouette(Picture::Photograph(photograph, &skin), &mut silhouette)?;
            let contexts = describer.contexts(&silhouette, OrientationRule::HandAxis)?;
            let mut x = vec![0.0; encoder.dim()];
            encoder.encode(contexts.values(), &mut votes, &mut x)?;
            black_box(&x);
        }
        Ok(())
    })
}

/// What is kept, by the sizes of its arrays.
fn held(described: &Described, halves: &Halves, models: &[Model]) -> Vec<Held> {
    let contexts = described.contexts.iter().flatten().map(Vec::len).sum::<usize>();
    let (poses, views) = (described.poses.len(), described.contexts[0].len());
    let reals = |count: usize| count * size_of::<f64>();
    let model = |model: &Model| {
        let parts = model.parts();
        let centres = match &parts.basis {
            phalanx_rvm::Basis::Linear => 0,
            phalanx_rvm::Basis::Gaussian { centres, .. } => centres.len(),
        };
        reals(parts.weights.len() + centres + 2 * parts.features.len() + parts.column_means.len())
    };
    let codebooks: usize = halves.codebooks.codebooks().iter().map(|c| c.centres().len()).sum();
    let x = &halves.train.x;
    let entry = |name: &str, bytes| Held { name: name.to_owned(), bytes };
    let seen = format!("shape contexts of all {poses} poses in {views} views");
    let mut held = vec![
        entry(&seen, contexts * size_of::<f32>()),
        entry("descriptors of the training half", reals(x.nrows() * x.ncols())),
        entry("I × I kernel matrix of the training half", reals(x.ncols() * x.ncols())),
        entry("codebooks, 3 × 30 centres", codebooks * size_of::<f32>()),
        entry("model: linear, 32 features", model(&models[0])),
        entry("model: Gaussian, 38 samples, all features", model(&models[1])),
        entry("model: Gaussian, 38 samples, 32 features", model(&models[2])),
    ];
    held.extend(memory::peak().map(|bytes| entry("the whole process at its peak", bytes)));
    held
}
