//! Pictures in colour give what their masks give.

use image::RgbImage;
use phalanx::{Estimate, Picture, Segmenter, Workspace};
use phalanx_camera::Rig;
use phalanx_hand::{HandShape, Pose};
use phalanx_render::{Appearance, Background, Renderer};
use phalanx_segmentation::{
    BackgroundModel, BackgroundParams, PlainBackground, SkinModel, downsample,
};

use super::desk::{ESTIMATOR, difference_deg, estimate, masks, mean, resized, rig, unseen};

fn photographs(rig: &Rig, pose: &Pose, appearance: &Appearance, seed: u64) -> Vec<RgbImage> {
    let solids = HandShape::adult().pose(pose, &rig.volume.rest_frame()).primitives;
    let shade = |(view, camera)| {
        let mut renderer = Renderer::new(camera).unwrap();
        renderer.shade(&solids, appearance, seed + view).unwrap()
    };
    (0..).zip(&rig.cameras).map(shade).collect()
}

fn look(photographs: &[RgbImage], segmenters: &[Segmenter]) -> Estimate {
    let pictures: Vec<_> = photographs
        .iter()
        .zip(segmenters.iter().cycle())
        .map(|(photograph, segmenter)| Picture::Photograph(photograph, segmenter))
        .collect();
    ESTIMATOR.estimate(&pictures, &mut Workspace::default()).unwrap()
}

#[test]
fn skin_is_found_by_its_colour() {
    let skin = [Segmenter::Skin(SkinModel::builtin())];
    let tones = [[224, 172, 140], [141, 85, 54], [198, 134, 100]];
    for (width, height) in [(120, 90), (320, 240)] {
        for tone in tones {
            let appearance = Appearance { skin: tone, ..Appearance::default() };
            let change = |pose| {
                let taken = photographs(&resized(&rig(), width, height), &pose, &appearance, 7);
                let plain = estimate(&ESTIMATOR, &masks(&rig(), &pose)).unwrap();
                difference_deg(&look(&taken, &skin).pose, &plain.pose)
            };
            let change = mean(unseen().into_iter().map(change));
            assert!(change < 1.5, "{width}×{height}, skin {tone:?}: {change:.2} degrees");
        }
    }
}

#[test]
fn the_hand_stands_out_from_a_wall_or_a_recorded_background() {
    // Evenly lit: Otsu's threshold would take deep shade on the hand for the wall.
    let appearance = Appearance {
        ambient: 0.75,
        background: Background::Gradient { top: [20, 24, 40], bottom: [36, 40, 60] },
        ..Appearance::default()
    };
    // Nothing: the empty scene, five times.
    let recorded: Vec<Segmenter> = rig()
        .cameras
        .iter()
        .map(|camera| {
            let mut renderer = Renderer::new(camera).unwrap();
            let frames: Vec<_> = (100..105)
                .map(|seed| renderer.shade(&[], &appearance, seed).unwrap())
                .map(|frame| downsample(&frame, 120, 90).unwrap())
                .collect();
            let params = BackgroundParams::default();
            Segmenter::Background(BackgroundModel::from_frames(&frames, params).unwrap())
        })
        .collect();
    let wall = [Segmenter::PlainBackground(PlainBackground::Dark)];
    for segmenters in [recorded.as_slice(), &wall] {
        let change = |pose| {
            let taken = photographs(&rig(), &pose, &appearance, 9);
            let plain = estimate(&ESTIMATOR, &masks(&rig(), &pose)).unwrap();
            difference_deg(&look(&taken, segmenters).pose, &plain.pose)
        };
        let change = mean(unseen().into_iter().map(change));
        assert!(change < 3.0, "{change:.2} degrees");
    }
}
