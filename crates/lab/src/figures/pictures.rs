//! `cargo xtask pictures`: the pictures of the README, and photographs to try the program on.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use image::{RgbImage, imageops};
use phalanx::{
    OrientationRule, Picture, Progress, SceneDescriber, SceneSource, Training, Workspace,
    draw_overlay,
};
use phalanx::{draw_silhouette, working_window};
use phalanx_camera::Rig;
use phalanx_hand::{HandShape, Pose};
use phalanx_segmentation::{Silhouette, SkinModel};

use crate::data::data_set::{DataSet, at_seven_angles};
use crate::data::sets::Test;
use crate::figures::mosaic::{mosaic, tinted};
use crate::figures::photograph::photograph;
use crate::files;
use crate::progress;

/// Which frames of `complex` are shown, and at which of the seven angles.
const SHOWN: [(usize, usize); 3] = [(30, 0), (110, 2), (200, 4)];
/// A panel of the README's picture, px.
const PANEL: (u32, u32) = (200, 150);

/// Which samples of the held-out tests are shown.
const HELD_OUT_SHOWN: [usize; 3] = [150, 750, 1350];
/// The colour of a silhouette.
const HAND: [u8; 3] = [222, 222, 222];

#[derive(Args)]
pub struct Arguments {
    /// Where the pictures go: one photograph for each camera of the desk, `estimates.png`, and
    /// `held-out.png`.
    #[arg(long, value_name = "DIR", default_value = "docs/pictures")]
    out: PathBuf,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let (rig, hand) = (files::rig(None)?, files::hand(None)?);
    let frames = files::poses(&files::in_repository("fixtures/trajectories/complex.csv"))?.poses;
    let poses = at_seven_angles(&frames);
    let photographs = |(frame, angle): (usize, usize)| -> Result<Vec<RgbImage>> {
        let pose = &poses[7 * frame + angle];
        rig.cameras
            .iter()
            .map(|camera| photograph(camera, &hand, pose, &rig, frame as u64))
            .collect()
    };
    let shown = SHOWN.into_iter().map(photographs).collect::<Result<Vec<_>>>()?;
    for (camera, picture) in rig.cameras.iter().zip(&shown[0]) {
        files::write_png(&arguments.out.join(format!("{}.png", camera.name)), picture)?;
    }
    let bar = progress::Bar::new();
    let sheet = estimates(&shown, &rig, &hand, &bar)?;
    drop(bar);
    files::write_png(&arguments.out.join("estimates.png"), &sheet)?;
    files::write_png(&arguments.out.join("held-out.png"), &held_out(&rig, &hand)?)?;
    files::print(&format!("{}\n", arguments.out.display()))
}

/// One row for each of the held-out tests, one panel for each camera: a few samples of each.
fn held_out(rig: &Rig, hand: &HandShape) -> Result<RgbImage> {
    let mut describer = SceneDescriber::new(rig, OrientationRule::default())?;
    let mut panels = Vec::new();
    for test in Test::SYNTHETIC {
        let set = test.set(rig, hand, &[]);
        for number in HELD_OUT_SHOWN {
            let silhouettes = describer.silhouettes(&set.scene(number))?;
            panels.extend(silhouettes.map(|silhouette| tinted(&silhouette.mask, HAND)));
        }
    }
    Ok(mosaic(&panels, (HELD_OUT_SHOWN.len() * rig.cameras.len()) as u32, 3))
}

/// One row for each pose, one panel for each camera: the photograph with what was seen and
/// estimated drawn over it, by an estimator that learnt from `complex` without the frames shown
/// and their neighbours.
fn estimates(
    shown: &[Vec<RgbImage>],
    rig: &Rig,
    hand: &HandShape,
    progress: &dyn Progress,
) -> Result<RgbImage> {
    let estimator = Training::default().run(rig, hand, &unseen_poses()?, progress)?;
    let skin = SkinModel::builtin();
    let mut workspace = Workspace::default();
    let mut sheet = RgbImage::new(PANEL.0 * rig.cameras.len() as u32, PANEL.1 * shown.len() as u32);
    for (row, photographs) in shown.iter().enumerate() {
        let pictures: Vec<Picture<'_>> =
            photographs.iter().map(|image| Picture::Photograph(image, &skin)).collect();
        let estimate = estimator.estimate(&pictures, &mut workspace)?;
        for (column, (camera, image)) in rig.cameras.iter().zip(photographs).enumerate() {
            let drawn = draw_silhouette(camera, hand, &estimate.pose, &rig.volume.rest_frame())?;
            let drawn = Silhouette::from_mask(&drawn)?;
            let mut panel = image.clone();
            let window = working_window(panel.dimensions())?;
            let observed = &estimate.observation.views[column].silhouette;
            let rule = estimator.orientation();
            draw_overlay(&mut panel, window, observed, rule, Some(&drawn));
            let panel = imageops::thumbnail(&panel, PANEL.0, PANEL.1);
            let (x, y) = (column as u32 * PANEL.0, row as u32 * PANEL.1);
            imageops::replace(&mut sheet, &panel, x.into(), y.into());
        }
    }
    Ok(sheet)
}

/// `complex` without the frames that are shown and their neighbours.
fn unseen_poses() -> Result<Vec<Pose>> {
    let poses = DataSet::stored("complex")?.poses;
    let near = |frame: usize| SHOWN.iter().any(|&(shown, _)| frame.abs_diff(shown) < 3);
    let kept = poses.iter().enumerate().filter(|(i, _)| !near(i / 7));
    Ok(kept.map(|(_, pose)| *pose).collect())
}
