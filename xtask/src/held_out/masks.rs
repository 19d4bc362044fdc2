//! Silhouettes made elsewhere.

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use image::GrayImage;
use phalanx::{Describer, Picture, PoseContexts, Scene};
use phalanx_hand::Pose;
use phalanx_multiview::Scratch;
use phalanx_segmentation::Silhouette;

use super::Ground;
use super::errors::Truth;
use super::learner::{Learner, joined};
use super::row::{self, Row};
use crate::files;

/// A folder of silhouettes, camera by camera, and what they show.
pub(crate) struct Masks {
    poses: Vec<Pose>,
    contexts: Vec<PoseContexts>,
    /// How many frames could not be described.
    pub(crate) left_out: usize,
}

impl Masks {
    /// Reads `DIR/<camera>/<frame>.png` for every camera of the rig and every row of
    /// `DIR/poses.csv`, and describes them. Frames that cannot be are named on standard error and
    /// left out.
    ///
    /// # Errors
    /// No truth, truth without frames, or no frame that can be described.
    pub(crate) fn read(folder: &Path, ground: &Ground) -> Result<Self> {
        let path = folder.join("poses.csv");
        let table = files::poses(&path)?;
        let frames =
            table.frames.with_context(|| format!("{}: no column 'frame'", path.display()))?;
        let (mut poses, mut contexts) = (Vec::new(), Vec::new());
        let mut describer = Describer::default();
        for (pose, frame) in table.poses.iter().zip(&frames) {
            match describe(folder, frame, ground, &mut describer) {
                Ok(described) => {
                    poses.push(*pose);
                    contexts.push(described);
                }
                Err(error) => eprintln!("frame {frame} is left out: {error:#}"),
            }
        }
        if poses.is_empty() {
            bail!("{}: none of {} frames can be described", folder.display(), frames.len());
        }
        let left_out = frames.len() - poses.len();
        Ok(Self { poses, contexts, left_out })
    }

    /// Every learner's every method on them.
    pub(crate) fn test(&self, learners: &[Learner], ground: &Ground) -> Result<Vec<Row>> {
        let mut scratch = Scratch::default();
        let mut samples = Vec::new();
        for learner in learners {
            let describe =
                |contexts: &PoseContexts| learner.codebooks.describe(contexts, &mut scratch);
            let columns = self.contexts.iter().map(describe).collect::<Result<Vec<_>, _>>()?;
            samples.push(joined(&columns, &self.poses));
        }
        let scene = |pose: &Pose| Scene::nominal(&ground.rig, &ground.hand, *pose);
        let truth = Truth::of(self.poses.iter().map(scene), ground);
        row::rows("masks", learners, &samples, &truth, ground)
    }
}

/// One frame's shape contexts in every camera.
fn describe(
    folder: &Path,
    frame: &str,
    ground: &Ground,
    describer: &mut Describer,
) -> Result<PoseContexts> {
    let mut silhouette = Silhouette::default();
    let view = |camera: &phalanx_camera::Camera| -> Result<Vec<f32>> {
        let path = folder.join(&camera.name).join(format!("{frame}.png"));
        let name = || path.display().to_string();
        let mask: GrayImage = image::open(&path).with_context(name)?.to_luma8();
        let (width, height) = (camera.intrinsics.width, camera.intrinsics.height);
        ensure!(
            u64::from(mask.width())
                .abs_diff(u64::from(mask.height()) * u64::from(width) / u64::from(height))
                <= 1,
            "{}: {}×{} is not the shape of the camera's {width}×{height}",
            name(),
            mask.width(),
            mask.height()
        );
        describer.silhouette(Picture::Mask(&mask), &mut silhouette).with_context(name)?;
        Ok(describer.contexts(&silhouette, ground.rule).with_context(name)?.values().to_vec())
    };
    ground.rig.cameras.iter().map(view).collect()
}
