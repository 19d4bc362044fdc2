//! The doubts about an answer that what was seen gives at once.

use phalanx_camera::{Camera, Rig};
use phalanx_segmentation::{Forearm, ForearmCue};

use crate::checking::doubt::{Cause, ViewDoubt};
use crate::estimator::estimate::Estimate;

/// All doubts about an estimate that explains some views, by their place in the observation, less well than
/// is usual; view by view.
pub(crate) fn of(rig: &Rig, short: &[usize], estimate: &Estimate) -> Vec<ViewDoubt> {
    let cameras: Vec<usize> = estimate.observation.views.iter().map(|view| view.camera).collect();
    let unlike = short.iter().map(|&place| {
        let view = cameras[place];
        let is_cut_off = !sees_all(&rig.cameras[view], estimate);
        ViewDoubt { view, cause: if is_cut_off { Cause::CutOff } else { Cause::Unlike } }
    });
    let forearms = cameras.iter().zip(estimate.observation.forearms());
    let guessed = forearms
        .filter_map(|(&view, forearm)| Some(ViewDoubt { view, cause: of_forearm(forearm)? }));
    let mut doubts: Vec<ViewDoubt> = guessed.chain(unlike).collect();
    doubts.sort_by_key(|doubt| doubt.view);
    doubts
}

fn of_forearm(forearm: &Forearm) -> Option<Cause> {
    match (forearm.cue, forearm.crossings) {
        (ForearmCue::SmoothEnd, _) => Some(Cause::GuessedForearm),
        (ForearmCue::Border, 0 | 1) => None,
        (ForearmCue::Border, crossings) => Some(Cause::BorderCrossings(crossings)),
    }
}

/// Whether the camera's picture shows all of the estimated hand.
fn sees_all(camera: &Camera, estimate: &Estimate) -> bool {
    let is_seen = |&joint| camera.project(joint).is_some_and(|at| camera.intrinsics.contains(at));
    estimate.joints.iter().all(is_seen)
}
