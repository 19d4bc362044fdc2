//! What an estimate is worth and what it says of itself.

use phalanx::{Picture, Workspace};
use phalanx_hand::{Dof, Pose};
use phalanx_segmentation::{ForearmCue, Mask};

use super::desk::{
    ESTIMATOR, FROM_TOP, closing, difference_deg, estimate, masks, mean, poses, rig, top, unseen,
};

/// The pose that does best without looking.
fn mean_pose() -> Pose {
    let poses = poses();
    Pose(std::array::from_fn(|k| {
        poses.iter().map(|pose| pose.0[k]).sum::<f64>() / poses.len() as f64
    }))
}

/// Forty poses spread over those that are learnt, by additive recurrences.
fn scattered() -> Vec<Pose> {
    let spread = |k: i32, step: f64| (f64::from(k) * step).fract();
    (0..40).map(|k| closing(spread(k, 0.618), 60.0 * spread(k, 0.755))).collect()
}

#[test]
fn estimates_are_near_the_truth() {
    for (rig, estimator) in [(rig(), &*ESTIMATOR), (top(), &*FROM_TOP)] {
        for (kind, poses) in [("learnt", poses()), ("unseen", scattered())] {
            let error = |pose| {
                let found = estimate(estimator, &masks(&rig, pose)).unwrap();
                difference_deg(&found.pose, pose)
            };
            let error = mean(poses.iter().map(error));
            let blind = mean(poses.iter().map(|pose| difference_deg(&mean_pose(), pose)));
            let views = rig.cameras.len();
            assert!(
                error < 0.1 * blind,
                "{views} views, {kind} poses: {error:.2} of {blind:.2} degrees"
            );
        }
    }
}

#[test]
fn what_never_varied_is_repeated_and_not_estimated() {
    let found = estimate(&ESTIMATOR, &masks(&rig(), &unseen()[2])).unwrap();
    for dof in [Dof::WristFlexion, Dof::ThetaX, Dof::TX, Dof::TZ] {
        assert!(found.pose[dof].abs() < 1e-9 && found.std[dof.index()].is_none(), "{dof}");
    }
    for dof in [Dof::IndexMcp, Dof::MiddlePip, Dof::ThetaZ] {
        assert!((1e-4..1.0).contains(&found.std[dof.index()].unwrap()), "{dof}");
    }
}

#[test]
fn strange_views_are_less_certain() {
    let known = estimate(&ESTIMATOR, &masks(&rig(), &unseen()[2])).unwrap();
    // Fingers that were never seen apart: a fist that points.
    let mut pointing = super::desk::closing(1.0, 30.0);
    for dof in [Dof::IndexMcp, Dof::IndexPip, Dof::IndexDip] {
        pointing[dof] = 0.0;
    }
    let strange = estimate(&ESTIMATOR, &masks(&rig(), &pointing)).unwrap();
    let [strange, known] = [strange, known].map(|found| found.std[Dof::IndexPip.index()].unwrap());
    assert!(strange > 1.5 * known, "{strange} {known}");
}

#[test]
fn joints_and_forearms_belong_to_the_pose_and_the_pictures() {
    let pose = unseen()[3];
    let found = estimate(&ESTIMATOR, &masks(&rig(), &pose)).unwrap();
    let frame = rig().volume.rest_frame();
    assert_eq!(found.joints, ESTIMATOR.hand().pose(&found.pose, &frame).joints);
    let truth = ESTIMATOR.hand().pose(&pose, &frame).joints;
    for (joint, (a, b)) in found.joints.iter().zip(truth).enumerate() {
        assert!(a.distance(b) < 10.0, "joint {joint}: {} mm", a.distance(b));
    }
    assert_eq!(found.observation.views.len(), 3);
    for forearm in found.observation.forearms() {
        assert_eq!((forearm.cue, forearm.crossings), (ForearmCue::Border, 1));
        assert!(forearm.end[0] < 1.0, "the forearm enters on the left");
    }
}

#[test]
fn a_used_workspace_changes_nothing() {
    let mut workspace = Workspace::default();
    let top_only = masks(&top(), &unseen()[5]);
    for pose in unseen() {
        // Another number of views, and a failure, in between.
        FROM_TOP.estimate(&[Picture::Mask(&top_only[0])], &mut workspace).unwrap();
        let mut masks = masks(&rig(), &pose);
        let fresh = estimate(&ESTIMATOR, &masks).unwrap();
        let used = |masks: &[Mask], workspace: &mut Workspace| {
            let pictures: Vec<_> = masks.iter().map(Picture::Mask).collect();
            ESTIMATOR.estimate(&pictures, workspace)
        };
        assert_eq!(used(&masks, &mut workspace).unwrap(), fresh);
        let silhouettes: Vec<_> = fresh.observation.silhouettes().cloned().collect();
        let again = ESTIMATOR.estimate_silhouettes(&silhouettes, &mut workspace).unwrap();
        assert_eq!(again, fresh);
        masks[1].fill(0);
        used(&masks, &mut workspace).unwrap_err();
    }
}
