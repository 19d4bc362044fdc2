//! The paper's Figs. 10 and 11 on these photographs: one view beside two, estimated and refined, with
//! all samples and features and with the paper's few.

use std::path::Path;

use anyhow::Result;
use faer::Mat;
use image::RgbImage;
use phalanx::{
    Estimator, Framing, Observation, Progress, Refiner, RegressorConfig, SceneSource, SceneSubset,
    Training, Workspace, describe_scenes, targets,
};
use phalanx_camera::Rig;
use phalanx_hand::{HandShape, Pose};
use phalanx_refine::PoseFitSettings;
use phalanx_render::Renderer;
use phalanx_rvm::{Stop, TwoStageSelection};
use rayon::prelude::*;

use super::{Look, Seen, sheet};
use crate::data::sets;
use crate::eval::held_out::method::nystrom;
use crate::figures::mosaic::mosaic;
use crate::files;
use crate::recipes::trained;

/// Frames that are shown, evenly spaced.
const SHOWN: usize = 5;

/// What the paper's Fig. 11 selects.
const FEATURES: usize = 32;
const SAMPLES: usize = 38;

/// Estimates of all frames through some of the cameras.
struct Estimates {
    estimated: Vec<Pose>,
    refined: Vec<Pose>,
}

/// Draws the figure, and says how well each estimate covers what was seen.
pub(super) fn write(
    folder: &Path,
    rig: &Rig,
    hand: &HandShape,
    samples: usize,
    looks: &[&Look],
    progress: &dyn Progress,
) -> Result<String> {
    let mut report =
        vec!["overlap with each view, on average over the frames: estimated; refined\n".to_owned()];
    let (mut all, mut few) = (Vec::new(), Vec::new());
    for views in 1..=rig.cameras.len() {
        let learning = Learning { rig: first(rig, views), hand, samples, progress };
        let estimator = learning.with_all()?;
        few.push(learning.estimates(&learning.with_few(&estimator)?, looks)?);
        all.push(learning.estimates(&estimator, looks)?);
    }
    let selected = format!("{FEATURES} features and {SAMPLES} samples");
    for (figure, what, rows) in [(10, "all", &all), (11, selected.as_str(), &few)] {
        for (row, views) in rows.iter().zip(1..) {
            report.push(format!("  {what}, views: {views}: {}\n", row.line(rig, hand, looks)?));
        }
        let path = |stage: &str| folder.join(format!("fig-{figure}{stage}.png"));
        draw(&path(""), rig, hand, looks, rows, |row| &row.estimated)?;
        draw(&path("-refined"), rig, hand, looks, rows, |row| &row.refined)?;
    }
    Ok(report.concat())
}

/// The first cameras of a rig.
fn first(rig: &Rig, views: usize) -> Rig {
    Rig { cameras: rig.cameras[..views].to_vec(), ..rig.clone() }
}

/// What is learnt from.
struct Learning<'a> {
    rig: Rig,
    hand: &'a HandShape,
    samples: usize,
    progress: &'a dyn Progress,
}

impl Learning<'_> {
    /// With all samples and features.
    fn with_all(&self) -> Result<Estimator> {
        let Self { rig, hand, samples, progress } = self;
        let training =
            Training { framing: Framing::Window, regressor: nystrom(), ..Training::default() };
        let set = sets::loosely_placed(rig, hand, *samples);
        Ok(trained(&training, &set, None, *progress)?.estimator)
    }

    /// With the paper's selection, which needs its samples at once, in the same descriptors.
    fn with_few(&self, all: &Estimator) -> Result<Estimator> {
        let Self { rig, hand, samples, progress } = self;
        let set = sets::loosely_placed(rig, hand, *samples);
        let scenes = SceneSubset::new(&set, RegressorConfig::CANDIDATES);
        let numbers: Vec<usize> = (0..scenes.count()).collect();
        let descriptor = all.descriptor();
        progress.begin("describe for the selection", numbers.len());
        let described = describe_scenes(rig, &scenes, &numbers, descriptor, *progress)?;
        let kept: Vec<(Vec<f64>, Pose)> = described
            .into_iter()
            .zip(numbers)
            .filter_map(|(x, number)| Some((x.ok()?, scenes.scene(number).pose)))
            .collect();
        let (x, poses): (Vec<Vec<f64>>, Vec<Pose>) = kept.into_iter().unzip();
        let x = Mat::from_fn(descriptor.dim(), x.len(), |row, column| x[column][row]);
        let cascade = TwoStageSelection {
            features: Stop::Count(FEATURES),
            samples: Stop::Count(SAMPLES),
            ..TwoStageSelection::default()
        };
        let fit = RegressorConfig::Cascade(cascade).fit(&x, &targets(&poses))?;
        Ok(Estimator::from_parts(rig.clone(), (*hand).clone(), descriptor.clone(), fit.model)?)
    }

    /// What an estimator makes of the frames.
    fn estimates(&self, estimator: &Estimator, looks: &[&Look]) -> Result<Estimates> {
        let set = sets::loosely_placed(&self.rig, self.hand, self.samples);
        let refiner = Refiner::new(&self.rig, self.hand, &set.poses, PoseFitSettings::default())?;
        let both: Vec<(Pose, Pose)> = looks
            .par_iter()
            .filter_map(|look| look.seen.as_ref().ok())
            .map_init(Workspace::default, |workspace, seen| {
                estimate(estimator, &refiner, seen, workspace)
            })
            .collect::<Result<_>>()?;
        let (estimated, refined) = both.into_iter().unzip();
        Ok(Estimates { estimated, refined })
    }
}

/// The pose of one frame, seen by the first cameras, estimated and refined.
fn estimate(
    estimator: &Estimator,
    refiner: &Refiner,
    seen: &Seen,
    workspace: &mut Workspace,
) -> Result<(Pose, Pose)> {
    let views = estimator.rig().cameras.len();
    let (windows, silhouettes) = (&seen.windows[..views], &seen.silhouettes[..views]);
    let observation = Observation::through_windows(silhouettes, windows);
    let estimate = estimator.estimate_observation(observation, workspace)?;
    let refined = refiner.refine(&refiner.evidence_of(&estimate.observation)?, &estimate)?;
    Ok((estimate.pose, refined.pose))
}

impl Estimates {
    /// How much of each view is covered, on average over the frames.
    fn line(&self, rig: &Rig, hand: &HandShape, looks: &[&Look]) -> Result<String> {
        let mean = |poses: &[Pose]| -> Result<String> {
            let mut sums = vec![0.0; rig.cameras.len()];
            for (look, pose) in looks.iter().zip(poses) {
                let Ok(seen) = &look.seen else { continue };
                let solids = hand.pose(pose, &rig.volume.rest_frame()).primitives;
                for ((sum, window), seen) in
                    sums.iter_mut().zip(&seen.windows).zip(&seen.silhouettes)
                {
                    let drawn = Renderer::new(&window.camera)?.silhouette(&solids)?;
                    *sum += seen.mask.iou(&drawn.into());
                }
            }
            let shares = sums.iter().map(|sum| format!("{:.3}", sum / poses.len() as f64));
            Ok(shares.collect::<Vec<_>>().join(" "))
        };
        let (estimated, refined) = (mean(&self.estimated)?, mean(&self.refined)?);
        Ok(format!("{estimated}; {refined}"))
    }
}

/// A row for each number of views: some frames through the windows of all cameras, the hand drawn over.
fn draw(
    path: &Path,
    rig: &Rig,
    hand: &HandShape,
    looks: &[&Look],
    rows: &[Estimates],
    poses: impl Fn(&Estimates) -> &[Pose],
) -> Result<()> {
    let step = looks.len().div_ceil(SHOWN).max(1);
    let rest = rig.volume.rest_frame();
    let mut panels: Vec<RgbImage> = Vec::new();
    let mut columns = 0;
    for row in rows {
        columns = 0;
        for (look, pose) in looks.iter().zip(poses(row)).step_by(step) {
            panels.extend(sheet::fit(look, hand, &rest, pose)?);
            columns += 1;
        }
    }
    files::write_png(path, &mosaic(&panels, columns, 6))
}
