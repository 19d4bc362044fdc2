//! Poses and hands that are found by a detector's points, alone and beside silhouettes.

mod desk;
mod property;

use desk::{bent, rig};
use glam::{DAffine3, DVec2};
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, Landmark, Landmarks, Pose};
use phalanx_refine::{
    BundleAdjustment, BundleFrame, Error, Evidence, LandmarkObservation, NuisanceParameters,
    PoseFitSettings, PosePrior, ShapePrior, SilhouetteObservation,
};
use phalanx_render::Renderer;
use proptest::prelude::*;

/// What a point of these detectors is off by, px: about 5 mm.
const STD: f64 = 1.5;

/// The joints in each camera's picture, off by what `noise` says of a point: its view and its joint.
fn points(
    rig: &Rig,
    hand: &HandShape,
    pose: &Pose,
    noise: impl Fn(usize, usize) -> DVec2,
) -> Vec<Landmarks> {
    let joints = hand.pose(pose, &rig.volume.rest_frame()).joints;
    let of_view = |(view, camera): (usize, &phalanx_camera::Camera)| -> Landmarks {
        std::array::from_fn(|k| Some(Landmark::sure(camera.project(joints[k])? + noise(view, k))))
    };
    rig.cameras.iter().enumerate().map(of_view).collect()
}

fn observed(rig: &Rig, points: &[Landmarks]) -> Vec<LandmarkObservation> {
    let views = rig.cameras.iter().zip(points);
    views.map(|(camera, points)| LandmarkObservation::new(camera, points, STD).unwrap()).collect()
}

fn silhouettes(rig: &Rig, hand: &HandShape, pose: &Pose) -> Vec<SilhouetteObservation> {
    let primitives = hand.pose(pose, &rig.volume.rest_frame()).primitives;
    let see = |camera: &phalanx_camera::Camera| {
        let mask = Renderer::new(camera).unwrap().silhouette(&primitives).unwrap();
        SilhouetteObservation::new(camera, &mask.into()).unwrap()
    };
    rig.cameras.iter().map(see).collect()
}

/// Next to nothing is known.
fn vague() -> PosePrior {
    let mut deviations = [0.7; Dof::COUNT];
    for dof in [Dof::TX, Dof::TY, Dof::TZ] {
        deviations[dof.index()] = 50.0;
    }
    PosePrior::independent(Pose::REST, &deviations).unwrap()
}

fn settings() -> PoseFitSettings {
    PoseFitSettings { disagreement: Some(0.1), ..PoseFitSettings::default() }
}

/// How far joints are from each other on average, mm.
fn apart(hand: &HandShape, one: &Pose, other: &Pose) -> f64 {
    let [one, other] = [one, other].map(|pose| hand.pose(pose, &DAffine3::IDENTITY).joints);
    one.iter().zip(other).map(|(a, b)| a.distance(b)).sum::<f64>() / one.len() as f64
}

/// Points that err by about `STD`, the same way for the same place.
fn usual(view: usize, joint: usize) -> DVec2 {
    let k = (21 * view + joint) as f64;
    DVec2::new((2.4 * k).sin(), (3.7 * k).cos()) * (STD * std::f64::consts::SQRT_2)
}

proptest! {
    #![proptest_config(crate::property::cases(12))]

    #[test]
    fn points_alone_tell_the_pose(
        bends in prop::array::uniform5(0.1..1.1_f64),
        turns in prop::array::uniform3(-0.4..0.4_f64),
    ) {
        let (rig, hand) = (rig(), HandShape::adult());
        let mut truth = bent(bends);
        truth.0[Dof::ThetaX.index()..Dof::TX.index()].copy_from_slice(&turns);
        let rest = rig.volume.rest_frame();
        let exact = observed(&rig, &points(&rig, &hand, &truth, |_, _| DVec2::ZERO));
        let fit = settings().fit(&hand, &rest, &exact, &Pose::REST, &vague()).unwrap();
        prop_assert!(apart(&hand, &fit.pose, &truth) < 1.0, "{}", apart(&hand, &fit.pose, &truth));
        prop_assert!(fit.ious.is_empty() && fit.landmarks_unexplained.len() == 3);
        let noisy = observed(&rig, &points(&rig, &hand, &truth, usual));
        let fit = settings().fit(&hand, &rest, &noisy, &Pose::REST, &vague()).unwrap();
        prop_assert!(apart(&hand, &fit.pose, &truth) < 5.0, "{}", apart(&hand, &fit.pose, &truth));
        // Its steps may end before it has converged; a few more find nothing better.
        let again = settings().fit(&hand, &rest, &noisy, &fit.pose, &vague()).unwrap();
        prop_assert!(apart(&hand, &fit.pose, &again.pose) < 0.5);
        prop_assert!(fit.landmarks_unexplained.iter().all(|share| *share < 0.15));
    }

    /// Fingers that a detector takes for each other in one view do not drag the pose along, nor does a view
    /// of another hand; in one of a thousand a finger is still led astray, by which the joints are 6 mm off on
    /// average in place of 2.
    #[test]
    fn what_contradicts_the_other_views_does_not_drag(
        bends in prop::array::uniform5(0.1..1.1_f64),
        view in 0..3_usize,
    ) {
        let (rig, hand) = (rig(), HandShape::adult());
        let (truth, rest) = (bent(bends), rig.volume.rest_frame());
        let mut seen = points(&rig, &hand, &truth, usual);
        for joint in 5..9 {
            seen[view].swap(joint, joint + 12);
        }
        let evidence = observed(&rig, &seen);
        let fit = settings().fit(&hand, &rest, &evidence, &Pose::REST, &vague()).unwrap();
        prop_assert!(apart(&hand, &fit.pose, &truth) < 8.0, "{}", apart(&hand, &fit.pose, &truth));
        let mut seen = points(&rig, &hand, &truth, usual);
        for landmark in seen[view].iter_mut().flatten() {
            landmark.at += DVec2::new(40.0, 0.0);
        }
        let evidence = observed(&rig, &seen);
        let fit = settings().fit(&hand, &rest, &evidence, &Pose::REST, &vague()).unwrap();
        prop_assert!(apart(&hand, &fit.pose, &truth) < 8.0, "{}", apart(&hand, &fit.pose, &truth));
        let worst = fit.landmarks_unexplained.iter().copied().fold(0.0, f64::max);
        prop_assert_eq!(fit.landmarks_unexplained[view], worst);
    }
}

#[test]
fn points_beside_silhouettes_tell_a_finger_before_the_palm() {
    let (rig, hand) = (rig(), HandShape::adult());
    let (truth, rest) = (bent([0.2, 0.2, 1.0, 0.2, 0.2]), rig.volume.rest_frame());
    let masks = silhouettes(&rig, &hand, &truth);
    let landmarks = observed(&rig, &points(&rig, &hand, &truth, usual));
    // One camera's picture leaves open what a few points say.
    let settings = PoseFitSettings { max_restarts: 0, ..settings() };
    let fit = |landmarks: &[LandmarkObservation]| {
        let evidence = Evidence { silhouettes: &masks[..1], landmarks };
        let fit = settings.fit(&hand, &rest, evidence, &bent([0.2; 5]), &vague()).unwrap();
        apart(&hand, &fit.pose, &truth)
    };
    let (alone, both) = (fit(&[]), fit(&landmarks[1..]));
    assert!(both < 0.6 * alone, "{alone} {both}");
    // More is known of it with both.
    let evidence = Evidence { silhouettes: &masks, landmarks: &landmarks };
    let unknown = ShapePrior { size: 0.06, thickness: 0.06, each: 0.06 }.deviations(&hand);
    let known = |evidence: Evidence<'_>| {
        settings.posterior(&hand, &rest, evidence, &truth, &vague(), &unknown).unwrap().joints
    };
    let (of_masks, of_both) = (known((&masks).into()), known(evidence));
    assert!(of_masks.iter().zip(of_both).all(|(alone, both)| both < *alone));
}

#[test]
fn a_hand_is_learnt_from_points_alone() {
    let (rig, given) = (rig(), HandShape::adult());
    let own = given.scaled(|| 1.12);
    let rest = rig.volume.rest_frame();
    let frame = |k: u32| {
        let bend = |finger: u32| 0.2 + 0.9 * f64::from((3 * k + 2 * finger) % 7) / 7.0;
        let pose = bent([0, 1, 2, 3, 4].map(bend));
        let landmarks = observed(&rig, &points(&rig, &own, &pose, usual));
        BundleFrame { observations: Vec::new(), landmarks, start: Pose::REST, prior: vague() }
    };
    let frames: Vec<BundleFrame> = (0..8).map(frame).collect();
    let found = BundleAdjustment::default().run(&given, &rest, &frames).unwrap();
    let ratio = found.hand.length_mm() / own.length_mm();
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
    let names: Vec<&str> = found.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(names, rig.cameras.iter().map(|camera| camera.name.as_str()).collect::<Vec<_>>());
}

#[test]
fn points_that_say_nothing_are_refused() {
    let camera = &rig().cameras[0];
    let wrong = |landmarks: &Landmarks, std: f64| {
        LandmarkObservation::new(camera, landmarks, std).unwrap_err()
    };
    let mut landmarks: Landmarks = [None; 21];
    assert!(matches!(wrong(&landmarks, 1.0), Error::NoLandmark { .. }));
    landmarks[3] = Some(Landmark::sure(DVec2::new(3.0, f64::NAN)));
    assert!(matches!(wrong(&landmarks, 1.0), Error::NotFinite { .. }));
    landmarks[3] = Some(Landmark { at: DVec2::ONE, confidence: 1.5 });
    assert!(matches!(wrong(&landmarks, 1.0), Error::Parameter { .. }));
    landmarks[3] = Some(Landmark::sure(DVec2::ONE));
    assert!(matches!(wrong(&landmarks, 0.0), Error::Parameter { .. }));
    assert!(LandmarkObservation::new(camera, &landmarks, 1.0).is_ok());
    let nuisance = Some(NuisanceParameters::default());
    let settings = PoseFitSettings { nuisance, ..PoseFitSettings::default() };
    let none = settings.fit(
        &HandShape::adult(),
        &DAffine3::IDENTITY,
        Evidence::default(),
        &Pose::REST,
        &vague(),
    );
    assert!(matches!(none, Err(Error::NoObservation)));
}
