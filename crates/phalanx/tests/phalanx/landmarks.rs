//! Takes of drawn hands with a detector's landmarks, beside masks and alone.

use glam::{DVec2, DVec3};
use phalanx::{
    Delay, Error, FrameFit, ItemRng, Missing, NoProgress, TakeFrame, TakeSettings, TrackSettings,
    Tracker, fit_frame, fit_take,
};
use phalanx_camera::Camera;
use phalanx_hand::{JOINTS, Landmark, Landmarks};

use crate::drawn::{Drawn, FITTED, drawn, mean_error};

/// What a detector's points are off by, px: some 4 mm.
const STD: f64 = 1.5;

/// Of so many points one is missing.
const MISSING: usize = 9;

/// A normally distributed number, nearly.
fn normal(random: &mut ItemRng) -> f64 {
    (0..12).map(|_| random.uniform()).sum::<f64>() - 6.0
}

/// The points of one picture as a detector has them: they err alone and together, and some are missing.
fn detected(camera: &Camera, joints: &[DVec3; JOINTS], item: usize) -> Landmarks {
    let mut random = ItemRng::new(21, item as u64);
    let mut offset = || DVec2::new(normal(&mut random), normal(&mut random));
    let together = offset() * (0.5 * STD);
    std::array::from_fn(|k| {
        let at = camera.project(joints[k])? + together + offset() * (0.8 * STD);
        let is_seen = !(item + 4 * k).is_multiple_of(MISSING);
        is_seen.then_some(Landmark { at, confidence: 0.9 })
    })
}

/// A drawn take whose cameras have landmarks too.
fn detected_take(count: usize) -> Drawn {
    let mut take = drawn(count);
    for (k, (frame, joints)) in take.frames.iter_mut().zip(&take.joints).enumerate() {
        let views = take.cameras.iter().enumerate();
        frame.landmarks =
            views.map(|(view, camera)| Some(detected(camera, joints, 3 * k + view))).collect();
    }
    take
}

fn without_masks(frames: &[TakeFrame]) -> Vec<TakeFrame> {
    let of =
        |frame: &TakeFrame| TakeFrame { masks: vec![None; frame.masks.len()], ..frame.clone() };
    frames.iter().map(of).collect()
}

fn without_landmarks(frames: &[TakeFrame]) -> Vec<TakeFrame> {
    let of = |frame: &TakeFrame| TakeFrame { landmarks: Vec::new(), ..frame.clone() };
    frames.iter().map(of).collect()
}

fn errors(fits: &[FrameFit], joints: &[[DVec3; JOINTS]]) -> Vec<f64> {
    fits.iter().zip(joints).map(|(fit, truth)| mean_error(&fit.joints, truth)).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// In a third of the frames one camera takes index and ring finger for each other.
#[test]
fn landmarks_make_masks_no_worse_and_fit_a_take_alone() {
    let Drawn { cameras, mut frames, joints } = detected_take(6);
    for frame in frames.iter_mut().step_by(3) {
        let points = frame.landmarks[0].as_mut().expect("detected");
        (5..9).for_each(|joint| points.swap(joint, joint + 8));
    }
    let fit = |frames: &[TakeFrame]| {
        fit_take(&cameras, frames, &TakeSettings::default(), &NoProgress).expect("a fit")
    };
    let masks = errors(&FITTED.1.frames, &joints);
    let both = fit(&frames);
    let of_both = errors(&both.frames, &joints);
    // Masks as exact as drawn ones leave nothing to tell.
    assert!(mean(&of_both) < mean(&masks) + 0.2, "{of_both:.1?} {masks:.1?}");
    let mut one_mask = frames.clone();
    for frame in &mut one_mask {
        frame.masks[1..].fill(None);
    }
    let of_one = errors(&fit(&without_landmarks(&one_mask)).frames, &joints);
    let with_landmarks = errors(&fit(&one_mask).frames, &joints);
    assert!(mean(&with_landmarks) < 0.3 * mean(&of_one), "{with_landmarks:.1?} {of_one:.1?}");
    let points = without_masks(&frames);
    let alone = fit(&points);
    let of_points = errors(&alone.frames, &joints);
    assert!(mean(&of_points) < 7.0, "{of_points:.1?}");
    for (k, frame) in both.frames.iter().chain(&alone.frames).enumerate() {
        assert!(frame.joint_std.iter().all(|std| (0.1..60.0).contains(std)));
        for view in &frame.views[usize::from(k % 3 == 0)..] {
            assert_eq!(view.missing, None);
            let landmarks = view.landmarks.expect("detected");
            assert!(landmarks.is_used && landmarks.distance_px < 3.0 * STD, "{landmarks:?}");
        }
    }
    let one = fit_frame(&cameras, &points[3], &alone).expect("a fit");
    assert!(mean_error(&one.joints, &joints[3]) < 9.0, "a frame alone");
}

/// Landmarks of another hand in one camera are left out, and said, while its mask is used.
#[test]
fn landmarks_that_contradict_the_other_views_are_left_out() {
    let Drawn { cameras, mut frames, joints } = detected_take(5);
    for frame in &mut frames {
        let points = frame.landmarks[1].as_mut().expect("detected");
        points.iter_mut().flatten().for_each(|point| point.at += DVec2::new(60.0, -25.0));
    }
    let fit = |frames: &[TakeFrame]| {
        fit_take(&cameras, frames, &TakeSettings::default(), &NoProgress).expect("a fit")
    };
    let both = fit(&frames);
    let left_out = |fit: &&FrameFit| {
        let view = fit.views[1];
        view.is_mask_used
            && view.missing.is_none()
            && view.landmarks.is_some_and(|landmarks| !landmarks.is_used)
    };
    assert_eq!(both.frames.iter().filter(left_out).count(), 5);
    let of_both = errors(&both.frames, &joints);
    assert!(mean(&of_both) < 6.0, "{of_both:.1?}");
    let alone = fit(&without_masks(&frames));
    let said = |fit: &&FrameFit| fit.views[1].missing == Some(Missing::Disagrees);
    assert_eq!(alone.frames.iter().filter(said).count(), 5);
    let of_points = errors(&alone.frames, &joints);
    assert!(mean(&of_points) < 9.0, "{of_points:.1?}");
}

#[test]
fn a_hand_is_tracked_by_landmarks() {
    let Drawn { cameras, frames, joints } = detected_take(12);
    let settings = TrackSettings { delay: Delay::None, ..TrackSettings::default() };
    for frames in [frames.clone(), without_masks(&frames)] {
        let mut tracker = Tracker::new(&cameras, &settings).expect("a tracker");
        let mut fits = Vec::new();
        for frame in &frames {
            let answer = tracker.push(frame).expect("a frame");
            fits.extend(answer.and_then(|frame| frame.fit));
        }
        let found = errors(&fits, &joints);
        assert!(found.len() == 12 && mean(&found) < 12.0, "{found:.1?}");
    }
}

#[test]
fn landmarks_of_one_camera_alone_are_no_hand_and_of_another_number_an_error() {
    let Drawn { cameras, frames, .. } = detected_take(2);
    let mut frames = without_masks(&frames);
    let fit = |frames: &[TakeFrame]| {
        fit_take(&cameras, frames, &TakeSettings::default(), &NoProgress).unwrap_err()
    };
    for frame in &mut frames {
        frame.landmarks[1..].fill(None);
    }
    assert!(matches!(fit(&frames), Error::NoHand));
    for frame in &mut frames {
        frame.landmarks.truncate(1);
    }
    let error = fit(&frames);
    assert!(matches!(error, Error::LandmarkCount { found: 1, .. }), "{error}");
}
