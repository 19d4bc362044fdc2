//! Silhouettes made elsewhere.

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use phalanx::{Describer, Picture, PoseContexts, Scene};
use phalanx_hand::Pose;
use phalanx_multiview::Scratch;
use phalanx_segmentation::{Mask, Silhouette};

use super::errors::Truth;
use super::ground::Ground;
use super::learner::{Learner, joined};
use super::presets::{self, Learnt};
use super::row::{self, Row};
use crate::files;

/// A folder of silhouettes, camera by camera, and what they show.
pub(crate) struct Masks {
    poses: Vec<Pose>,
    silhouettes: Vec<Vec<Silhouette>>,
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
        let (mut poses, mut silhouettes, mut contexts) = (Vec::new(), Vec::new(), Vec::new());
        let mut describer = Describer::default();
        for (pose, frame) in table.poses.iter().zip(&frames) {
            match describe(folder, frame, ground, &mut describer) {
                Ok((seen, described)) => {
                    poses.push(*pose);
                    silhouettes.push(seen);
                    contexts.push(described);
                }
                Err(error) => eprintln!("frame {frame} is left out: {error:#}"),
            }
        }
        if poses.is_empty() {
            bail!("{}: none of {} frames can be described", folder.display(), frames.len());
        }
        let left_out = frames.len() - poses.len();
        Ok(Self { poses, silhouettes, contexts, left_out })
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
        row::rows("masks", learners, &samples, &self.truth(ground), ground)
    }

    /// Every learnt preset on them.
    pub(crate) fn test_presets(&self, learnt: &[Learnt], ground: &Ground) -> Result<Vec<Row>> {
        presets::test_masks(&self.silhouettes, learnt, &self.truth(ground), ground)
    }

    fn truth(&self, ground: &Ground) -> Truth {
        let scene = |pose: &Pose| Scene::nominal(&ground.rig, &ground.hand, *pose);
        Truth::of(self.poses.iter().map(scene), ground)
    }
}

/// One frame's silhouettes and shape contexts in every camera.
fn describe(
    folder: &Path,
    frame: &str,
    ground: &Ground,
    describer: &mut Describer,
) -> Result<(Vec<Silhouette>, PoseContexts)> {
    let view = |camera: &phalanx_camera::Camera| -> Result<(Silhouette, Vec<f32>)> {
        let path = folder.join(&camera.name).join(format!("{frame}.png"));
        let name = || path.display().to_string();
        let mask = Mask::from(image::open(&path).with_context(name)?.to_luma8());
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
        let mut silhouette = Silhouette::default();
        describer.silhouette(Picture::Mask(&mask), &mut silhouette).with_context(name)?;
        let contexts = describer.contexts(&silhouette, ground.rule).with_context(name)?;
        let contexts = contexts.values().to_vec();
        Ok((silhouette, contexts))
    };
    let views = ground.rig.cameras.iter().map(view).collect::<Result<Vec<_>>>()?;
    Ok(views.into_iter().unzip())
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use phalanx::{OrientationRule, SceneDescriber, SceneSource, draw_silhouette};
    use phalanx_hand::{Dof, write_poses};

    use super::*;
    use crate::data::sets::Test;

    /// A folder of its own, which goes with the test.
    struct Folder(PathBuf);

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    fn ground() -> Ground {
        let (rig, hand) = (files::rig(None).unwrap(), files::hand(None).unwrap());
        Ground { rig, hand, rule: OrientationRule::default() }
    }

    /// Silhouettes of three unseen poses, frame by frame.
    fn write(name: &str, ground: &Ground) -> (Folder, Vec<Pose>) {
        let folder = Folder(std::env::temp_dir().join(format!("{name}-{}", std::process::id())));
        let set = Test::Unseen.set(&ground.rig, &ground.hand, &[]);
        let poses = set.poses[..3].to_vec();
        let rest = ground.rig.volume.rest_frame();
        for camera in &ground.rig.cameras {
            std::fs::create_dir_all(folder.0.join(&camera.name)).unwrap();
            for (frame, pose) in poses.iter().enumerate() {
                let mask = draw_silhouette(camera, &ground.hand, pose, &rest).unwrap();
                let path = folder.0.join(&camera.name).join(format!("{frame}.png"));
                mask.save(path).unwrap();
            }
        }
        let truth = std::fs::File::create(folder.0.join("poses.csv")).unwrap();
        write_poses(truth, &poses, &Dof::ALL).unwrap();
        (folder, poses)
    }

    #[test]
    fn masks_from_files_are_described_as_drawn_ones() {
        let ground = ground();
        let (folder, poses) = write("masks-described", &ground);
        let masks = Masks::read(&folder.0, &ground).unwrap();
        assert_eq!(masks.left_out, 0);
        let mut describer = SceneDescriber::new(&ground.rig, ground.rule).unwrap();
        let set = Test::Unseen.set(&ground.rig, &ground.hand, &[]);
        for (frame, contexts) in masks.contexts.iter().enumerate() {
            assert_eq!(*contexts, describer.contexts(&set.scene(frame)).unwrap());
            for dof in Dof::ALL {
                assert!((masks.poses[frame][dof] - poses[frame][dof]).abs() < 1e-6, "{dof}");
            }
        }
    }

    #[test]
    fn a_missing_mask_is_left_out_and_a_missing_truth_refused() {
        let ground = ground();
        let (folder, _) = write("masks-missing", &ground);
        std::fs::remove_file(folder.0.join("top").join("1.png")).unwrap();
        let masks = Masks::read(&folder.0, &ground).unwrap();
        assert_eq!((masks.left_out, masks.poses.len()), (1, 2));
        std::fs::remove_file(folder.0.join("poses.csv")).unwrap();
        let error = Masks::read(&folder.0, &ground).err().map(|error| format!("{error:#}"));
        assert!(error.is_some_and(|error| error.contains("poses.csv")));
    }
}
