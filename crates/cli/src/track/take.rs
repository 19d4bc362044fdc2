//! A fitted take as it is written.

use glam::DAffine3;
use phalanx::{FitDoubt, FrameFit, Missing, ViewFit};
use phalanx_camera::Camera;
use phalanx_hand::HandShape;
use phalanx_io::take::{FrameView, LeftOut, PoseEstimate, TakeFrame, TakeHeader};

use crate::recording::doubt;

/// What holds for all frames.
pub(crate) fn header(
    cameras: &[Camera],
    (hand, rest): (&HandShape, DAffine3),
    rate_hz: Option<f64>,
) -> TakeHeader {
    TakeHeader {
        hand: hand.clone(),
        world_from_hand: rest,
        views: cameras.iter().map(|camera| camera.name.clone()).collect(),
        rate_hz,
        model: None,
    }
}

/// One frame, of which some views have a picture. Where no view shows a hand, there is no pose.
pub(crate) fn frame(
    cameras: &[Camera],
    (index, has_picture): (usize, &[bool]),
    time: f64,
    fit: Option<&FrameFit>,
) -> TakeFrame {
    let Some(fit) = fit.filter(|fit| !fit.doubts.contains(&FitDoubt::NotSeen)) else {
        return TakeFrame {
            index: index as u64,
            time,
            estimate: None,
            views: vec![FrameView::default(); cameras.len()],
            doubts: vec!["no-hand".to_owned()],
        };
    };
    let joint_std = fit.joint_std.map(|std| glam::DVec3::splat(std / 3.0_f64.sqrt()));
    // What views leave open has no deviation.
    let estimate = PoseEstimate {
        pose: fit.pose,
        std: fit.std.map(|std| std.is_finite().then_some(std)),
        joints: fit.joints,
        joint_std: joint_std.iter().all(|std| std.is_finite()).then_some(joint_std),
    };
    let views = fit.views.iter().zip(has_picture).map(|(view, has_picture)| FrameView {
        used: view.missing.is_none(),
        overlap: view.overlap,
        left_out: has_picture.then(|| left_out(view)).flatten(),
    });
    let doubts = fit.doubts.iter().map(|doubt| doubt::code(doubt, cameras)).collect();
    TakeFrame {
        index: index as u64,
        time,
        estimate: Some(estimate),
        views: views.collect(),
        doubts,
    }
}

/// Why a picture that is there had no part, or some of what was seen in it.
fn left_out(view: &ViewFit) -> Option<LeftOut> {
    match view.missing {
        Some(Missing::Disagrees) => Some(LeftOut::Disagrees),
        Some(Missing::NoHand) => Some(LeftOut::NoHand),
        None if view.overlap.is_some() && !view.is_mask_used => Some(LeftOut::Mask),
        None if view.landmarks.is_some_and(|landmarks| !landmarks.is_used) => {
            Some(LeftOut::Landmarks)
        }
        _ => None,
    }
}
