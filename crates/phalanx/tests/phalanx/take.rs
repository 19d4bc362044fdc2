//! Whole takes of drawn hands, from masks and cameras alone.

use glam::{DAffine3, DMat3, DVec3};
use phalanx::{
    Delay, Error, FitDoubt, Missing, NoProgress, Proportions, TakeFrame, TakeSettings,
    TrackSettings, TrackedFrame, Tracker, VolumeEstimate, draw_mask, estimate_volume, fit_frame,
    fit_take,
};
use phalanx_camera::{Camera, Extrinsics, Intrinsics};
use phalanx_hand::{Dof, HandShape, Pose, Side};
use phalanx_segmentation::Mask;

use crate::drawn::{
    Drawn, FITTED, cameras, drawn, drawn_coming, drawn_nearing, drawn_of, drawn_sleeved,
    drawn_stills, drawn_turning, hand, mean_error, sleeved,
};

#[test]
fn a_take_is_fitted_from_masks_alone() {
    let (Drawn { cameras, frames, joints }, fit) = &*FITTED;
    let errors: Vec<f64> =
        fit.frames.iter().zip(joints).map(|(fit, truth)| mean_error(&fit.joints, truth)).collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    assert!(mean < 6.0, "{errors:.1?}");
    for fit in &fit.frames {
        assert!(fit.views.iter().all(|view| view.missing.is_none()), "{:?}", fit.views);
        assert!(fit.joint_std.iter().all(|std| (0.1..60.0).contains(std)), "{:?}", fit.joint_std);
    }
    // Wherever it was thought to be, the arm is along +z and the hand near the world's origin.
    assert!(fit.volume.volume.forearm.normalize().z > 0.95, "{:?}", fit.volume);
    assert!(fit.volume.volume.center.distance(DVec3::new(18.0, 0.0, -10.0)) < 25.0);
    let alone = fit_frame(cameras, &frames[3], fit).expect("a fit");
    assert!(mean_error(&alone.joints, &joints[3]) < 8.0, "a frame alone");
}

/// Where the take's hand is on average says little of how it is turned at either end.
#[test]
fn a_frame_alone_is_found_however_the_take_turned_its_hand() {
    let Drawn { cameras, frames, joints } = drawn_turning(8, 3.4);
    let take = fit_take(&cameras, &frames, &TakeSettings::default(), &NoProgress).expect("a fit");
    for (k, truth) in joints.iter().enumerate() {
        let alone = fit_frame(&cameras, &frames[k], &take).expect("a fit");
        let errors = [&take.frames[k], &alone].map(|fit| mean_error(&fit.joints, truth));
        assert!(errors.iter().all(|error| *error < 8.0), "frame {k}: {errors:.1?}");
    }
}

/// Two views agreed on a wrong pose of these, and the one that was right was left out.
#[test]
fn a_frame_alone_is_found_where_nothing_in_the_take_is_like_it() {
    let (Drawn { cameras, .. }, take) = &*FITTED;
    let Drawn { frames, joints, .. } = drawn_stills(52);
    for k in [10, 29, 51] {
        let alone = fit_frame(cameras, &frames[k], take).expect("a fit");
        let error = mean_error(&alone.joints, &joints[k]);
        assert!(error < 8.0, "still {k}: {error:.1}");
        assert!(alone.views.iter().all(|view| view.missing.is_none()), "still {k}");
    }
}

#[test]
fn a_childs_hand_is_found() {
    let small = hand().scaled(|| 0.7);
    let Drawn { cameras, frames, joints } = drawn_of(&small, 6);
    let fit = fit_take(&cameras, &frames, &TakeSettings::default(), &NoProgress).expect("a fit");
    let (found, drawn) = (fit.hand.length_mm(), small.length_mm());
    assert!((found / drawn - 1.0).abs() < 0.05, "{found:.0} mm in place of {drawn:.0} mm");
    let errors: Vec<f64> =
        fit.frames.iter().zip(&joints).map(|(fit, truth)| mean_error(&fit.joints, truth)).collect();
    assert!(errors.iter().sum::<f64>() / 6.0 < 6.0, "{errors:.1?}");
}

#[test]
fn one_camera_says_how_little_it_knows_of_the_distance() {
    let Drawn { cameras, frames, joints } = drawn(6);
    let of_top = |frame: &TakeFrame| TakeFrame::of_masks(vec![frame.masks[1].clone()]);
    let frames: Vec<TakeFrame> = frames.iter().map(of_top).collect();
    let fit = fit_take(&cameras[1..2], &frames, &TakeSettings::default(), &NoProgress);
    let fit = fit.expect("a fit");
    let mut shares = Vec::new();
    for (fit, truth) in fit.frames.iter().zip(&joints) {
        let (error, std) = (mean_error(&fit.joints, truth), fit.joint_std[9]);
        let distance = truth[9].distance(cameras[1].centre());
        assert!((0.08..0.5).contains(&(std / distance)), "{std:.0} mm of {distance:.0} mm");
        assert!(error < 3.0 * std, "{error:.0} mm, {std:.0} mm were said");
        shares.push(error / distance);
    }
    // Hands differ in size by some 13 %, and the one that it is taken for is 6 % shorter.
    assert!(shares.iter().sum::<f64>() / 6.0 < 0.15, "{shares:.2?}");
}

/// Outlines lay all around outside what was seen, as of hands that are nearer than they are.
#[test]
fn a_hand_before_one_camera_is_drawn_where_it_is_seen() {
    let Drawn { cameras, frames, joints } = drawn(12);
    for (view, camera) in cameras.iter().enumerate() {
        let of_view = |frame: &TakeFrame| TakeFrame::of_masks(vec![frame.masks[view].clone()]);
        let frames: Vec<TakeFrame> = frames.iter().map(of_view).collect();
        let camera = std::slice::from_ref(camera);
        let fit = fit_take(camera, &frames, &TakeSettings::default(), &NoProgress).expect("a fit");
        let mut share = 0.0;
        for (k, (fit, truth)) in fit.frames.iter().zip(&joints).enumerate() {
            let overlap = fit.views[0].overlap.expect("it shows the hand");
            assert!(overlap > 0.9, "view {view}, frame {k}: {overlap:.2}");
            share += mean_error(&fit.joints, truth) / truth[9].distance(camera[0].centre()) / 12.0;
        }
        // Hands differ in size by some 13 %.
        assert!(share < 0.13, "view {view}: {share:.3} of its distance");
    }
}

/// It moves along the line of sight alone, of which nothing is seen but that it grows.
#[test]
fn a_hand_that_comes_nearer_to_one_camera_is_followed() {
    for (view, camera) in cameras().iter().enumerate() {
        let Drawn { frames, joints, .. } = drawn_nearing(camera, 12, 200.0);
        let of_view = |frame: &TakeFrame| TakeFrame::of_masks(vec![frame.masks[view].clone()]);
        let frames: Vec<TakeFrame> = frames.iter().map(of_view).collect();
        let only = std::slice::from_ref(camera);
        let fit = fit_take(only, &frames, &TakeSettings::default(), &NoProgress).expect("a fit");
        let distance = |joints: &[DVec3]| joints[9].distance(camera.centre());
        let found = distance(&fit.frames[0].joints) / distance(&fit.frames[11].joints);
        let drawn = distance(&joints[0]) / distance(&joints[11]);
        assert!((found / drawn - 1.0).abs() < 0.1, "view {view}: {found:.2} for {drawn:.2}");
    }
}

#[test]
fn the_end_of_a_sleeve_is_not_taken_for_a_hand_before_one_camera() {
    let Drawn { cameras, mut frames, joints } = drawn(6);
    for (frame, joints) in frames.iter_mut().zip(&joints) {
        let mask = frame.masks.remove(2).expect("drawn");
        frame.masks = vec![Some(sleeved(&mask, &cameras[2], joints[0], 120.0))];
    }
    let settings = TakeSettings::default();
    let fit = fit_take(&cameras[2..], &frames, &settings, &NoProgress).expect("a fit");
    for (fit, truth) in fit.frames.iter().zip(&joints) {
        let ahead = (fit.joints[9] - fit.joints[0]).normalize();
        let along = ahead.dot((truth[9] - truth[0]).normalize());
        assert!(along > 0.5, "{along:.2}");
    }
}

/// A forearm that ends at a rolled-up sleeve looks much like a hand with its fingers together.
#[test]
fn the_hand_is_not_looked_for_at_the_sleeve_of_a_long_arm() {
    let Drawn { cameras, frames, joints } = drawn_sleeved(6, 200.0);
    let fit = fit_take(&cameras, &frames, &TakeSettings::default(), &NoProgress).expect("a fit");
    for (k, (own, truth)) in fit.frames.iter().zip(&joints).enumerate() {
        let alone = fit_frame(&cameras, &frames[k], &fit).expect("a fit");
        let errors = [own, &alone].map(|fit| mean_error(&fit.joints, truth));
        assert!(errors.iter().all(|error| *error < 8.0), "frame {k}: {errors:.1?}");
        assert!(own.doubts.is_empty() && alone.doubts.is_empty(), "frame {k}: {:?}", own.doubts);
    }
}

#[test]
fn a_view_that_shows_something_else_is_named_and_does_no_harm() {
    let Drawn { cameras, mut frames, joints } = drawn(5);
    for frame in &mut frames {
        // A face that joins the hand.
        let mask = frame.masks[1].as_mut().expect("drawn");
        let hand = mask.hand_pixels();
        let (x, y): (Vec<f64>, Vec<f64>) = hand.map(|[x, y]| (f64::from(x), f64::from(y))).unzip();
        let middle = [x, y].map(|all| all.iter().sum::<f64>() / all.len() as f64);
        let face = |x: u32, y: u32| {
            let (dx, dy) = (f64::from(x) - middle[0], f64::from(y) - middle[1] + 40.0);
            (dx / 35.0).powi(2) + (dy / 45.0).powi(2) < 1.0
        };
        *mask = Mask::from_fn(320, 240, |x, y| face(x, y) || mask.is_hand(x, y));
    }
    let fit = fit_take(&cameras, &frames, &TakeSettings::default(), &NoProgress).expect("a fit");
    let named = fit.frames.iter().filter(|fit| fit.views[1].missing == Some(Missing::Disagrees));
    assert!(
        named.count() >= 4,
        "{:?}",
        fit.frames.iter().map(|fit| &fit.views).collect::<Vec<_>>()
    );
    let errors: Vec<f64> =
        fit.frames.iter().zip(&joints).map(|(fit, truth)| mean_error(&fit.joints, truth)).collect();
    assert!(errors.iter().sum::<f64>() / 5.0 < 12.0, "{errors:.1?}");
}

#[test]
fn a_camera_that_shows_another_moment_is_named_and_does_no_harm() {
    let Drawn { cameras, mut frames, joints } = drawn(6);
    let shown: Vec<Option<Mask>> = frames.iter().map(|frame| frame.masks[0].clone()).collect();
    for (k, frame) in frames.iter_mut().enumerate() {
        frame.masks[0] = shown[(k + 3) % 6].clone();
    }
    let fit = fit_take(&cameras, &frames, &TakeSettings::default(), &NoProgress).expect("a fit");
    let named = |view: usize| {
        fit.frames.iter().filter(|fit| fit.views[view].missing == Some(Missing::Disagrees)).count()
    };
    let errors: Vec<f64> =
        fit.frames.iter().zip(&joints).map(|(fit, truth)| mean_error(&fit.joints, truth)).collect();
    assert_eq!([0, 1, 2].map(named), [6, 0, 0], "{errors:.1?}");
    assert!(errors.iter().sum::<f64>() / 6.0 < 6.0, "{errors:.1?}");
}

/// The same as it is seen in a mirror: x turns round in the world and in every picture.
fn mirrored(camera: &Camera) -> Camera {
    let flip = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    let Extrinsics { rotation, translation } = camera.extrinsics;
    let extrinsics =
        Extrinsics { rotation: flip * rotation * flip, translation: flip * translation };
    let cx = f64::from(camera.intrinsics.width) - camera.intrinsics.cx;
    let intrinsics = Intrinsics { cx, ..camera.intrinsics };
    Camera { intrinsics, extrinsics, ..camera.clone() }
}

#[test]
fn a_left_hand_is_fitted_as_a_right_one_in_a_mirror() {
    let (Drawn { cameras, frames, .. }, right) = &*FITTED;
    let cameras: Vec<Camera> = cameras.iter().map(mirrored).collect();
    let flip = |mask: &Mask| image::imageops::flip_horizontal(&**mask).into();
    let flipped = |mask: &Option<Mask>| mask.as_ref().map(flip);
    let of_frame =
        |frame: &TakeFrame| TakeFrame::of_masks(frame.masks.iter().map(flipped).collect());
    let frames: Vec<TakeFrame> = frames.iter().map(of_frame).collect();
    let hand = HandShape { side: Side::Left, ..HandShape::adult() };
    let settings = TakeSettings { hand, ..TakeSettings::default() };
    let left = fit_take(&cameras, &frames, &settings, &NoProgress).expect("a fit");
    assert_eq!(left.hand.side, Side::Left);
    for (right, left) in right.frames.iter().zip(&left.frames) {
        let seen = right.joints.map(|joint| joint * DVec3::new(-1.0, 1.0, 1.0));
        let apart = mean_error(&left.joints, &seen);
        assert!(apart < 3.0, "{apart:.1} mm");
        assert_eq!(left.doubts.is_empty(), right.doubts.is_empty());
    }
}

/// A camera and what it sees left of a column of its picture.
fn cut(camera: &Camera, mask: &Mask, column: u32) -> (Camera, Mask) {
    let intrinsics = Intrinsics { width: column, ..camera.intrinsics };
    let seen = Mask::from_fn(column, mask.height(), |x, y| mask.is_hand(x, y));
    (Camera { intrinsics, ..camera.clone() }, seen)
}

#[test]
fn a_hand_that_is_cut_off_is_doubted() {
    let Drawn { cameras, frames, joints } = drawn(4);
    // Through the fingers, in the one view that shows them to the right of the wrist; with one other.
    let across = |camera: &Camera, joint: usize| {
        joints.iter().map(|all| camera.project(all[joint]).expect("before it").x).sum::<f64>() / 4.0
    };
    let is_to_the_right = |k: &usize| across(&cameras[*k], 12) > across(&cameras[*k], 0) + 40.0;
    let first = (0..cameras.len()).find(is_to_the_right).expect("a view from the side");
    let second = (first + 1) % cameras.len();
    let column = across(&cameras[first], 9) as u32;
    let mut seen = Vec::new();
    for frame in &frames {
        let [one, other] = [first, second].map(|k| frame.masks[k].clone().expect("drawn"));
        let (camera, part) = cut(&cameras[first], &one, column);
        seen.push((camera, TakeFrame::of_masks(vec![Some(part), Some(other)])));
    }
    let both = [seen[0].0.clone(), cameras[second].clone()];
    let frames: Vec<TakeFrame> = seen.into_iter().map(|(_, frame)| frame).collect();
    let fit = fit_take(&both, &frames, &TakeSettings::default(), &NoProgress).expect("a fit");
    for fit in &fit.frames {
        let is_cut_off = |doubt: &FitDoubt| matches!(doubt, FitDoubt::CutOff { view: 0 });
        assert!(fit.doubts.iter().any(is_cut_off), "{:?}", fit.doubts);
    }
}

#[test]
fn a_take_without_a_hand_is_an_error() {
    let cameras = cameras();
    let nothing = TakeFrame::of_masks(vec![Some(Mask::new(320, 240)), None, None]);
    let fit = fit_take(&cameras, &[nothing], &TakeSettings::default(), &NoProgress);
    assert!(matches!(fit, Err(Error::NoHand)));
    let short = TakeFrame::of_masks(vec![None]);
    let volume = estimate_volume(&cameras, &[short], &HandShape::adult(), &NoProgress);
    assert!(matches!(volume, Err(Error::PictureCount { .. })));
}

#[test]
fn frames_come_in_the_order_of_time_or_without_times() {
    let Drawn { cameras, mut frames, .. } = drawn(3);
    let fit = |frames: &[TakeFrame]| {
        fit_take(&cameras, frames, &TakeSettings::default(), &NoProgress).expect_err("times")
    };
    frames[2].seconds = frames[1].seconds;
    let error = fit(&frames);
    assert!(matches!(error, Error::FrameTime { .. }), "{error}");
    frames[2].seconds = None;
    assert_eq!(fit(&frames).to_string(), "frame 2 has no time; `TakeFrame::at` gives it one");
    let mut tracker = Tracker::new(&cameras, &TrackSettings::default()).expect("a tracker");
    let error = tracker.push(&frames[2]).expect_err("no time");
    assert_eq!(error.to_string(), "a frame has no time; `TakeFrame::at` gives it one");
}

#[test]
fn the_volume_holds_a_hand_that_goes_far_along_its_own_axes() {
    let (cameras, hand, rest) = (cameras(), hand(), DAffine3::IDENTITY);
    let pose = |k: usize| {
        let mut pose = Pose::REST;
        pose[Dof::TX] = 36.0 * k as f64 - 90.0;
        // Turned about the forearm, so that the hand's axes are not the world's, by more and more.
        pose[Dof::ThetaZ] = 0.4 + 0.1 * k as f64;
        pose[Dof::IndexPip] = 0.3 * k as f64;
        pose
    };
    let poses: Vec<Pose> = (0..6).map(pose).collect();
    let frame = |pose: &Pose| {
        let mask = |camera| draw_mask(camera, &hand, pose, &rest).expect("a hand before it");
        TakeFrame::of_masks(cameras.iter().map(|camera| Some(mask(camera))).collect())
    };
    let frames: Vec<TakeFrame> = poses.iter().map(frame).collect();
    let found = estimate_volume(&cameras, &frames, &HandShape::adult(), &NoProgress);
    let VolumeEstimate { volume, turns } = found.expect("a volume");
    let axes = volume.rest_frame().matrix3.transpose();
    let way = axes * DVec3::X * 180.0;
    assert!(way.y.abs() > 60.0, "the hand is turned: {way}");
    for axis in 0..3 {
        let expected = way[axis].abs().max(20.0);
        assert!((volume.size[axis] - expected).abs() < 25.0, "{} for {way}", volume.size);
    }
    let turned = (turns[2][1] - turns[2][0]).to_degrees();
    assert!((turned - 28.6).abs() < 10.0, "{turned}° about the forearm");
}

fn track(cameras: &[Camera], frames: &[TakeFrame], delay: Delay) -> Vec<TrackedFrame> {
    let settings = TrackSettings { hand: hand(), proportions: Proportions::Given, delay };
    let mut tracker = Tracker::new(cameras, &settings).expect("a hand");
    let mut tracked = Vec::new();
    for (k, frame) in frames.iter().enumerate() {
        let due = tracker.push(frame).expect("a frame");
        assert_eq!(due.is_some(), delay == Delay::None || k > 0, "{k}");
        tracked.extend(due);
    }
    tracked.extend(tracker.finish().expect("a frame"));
    tracked
}

#[test]
fn a_hand_is_tracked_frame_by_frame() {
    let Drawn { cameras, frames, joints } = drawn(8);
    for delay in [Delay::None, Delay::OneFrame] {
        let tracked = track(&cameras, &frames, delay);
        assert_eq!(tracked.len(), frames.len());
        for (k, (frame, truth)) in tracked.iter().zip(&joints).enumerate() {
            assert!((frame.time - k as f64 / 30.0).abs() < 1e-12);
            let error = mean_error(&frame.fit.as_ref().expect("a hand").joints, truth);
            assert!(error < 8.0, "{delay:?}, frame {k}: {error} mm");
        }
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
        assert_eq!(alone.install(|| track(&cameras, &frames, delay)), tracked);
    }
}

#[test]
fn the_size_of_a_childs_hand_is_found_as_soon_as_two_cameras_see_it() {
    let small = hand().scaled(|| 0.7);
    let settings = TrackSettings { delay: Delay::None, ..TrackSettings::default() };
    for first in [0, 1] {
        let Drawn { cameras, mut frames, joints } = drawn_of(&small, 5);
        frames[..first].iter_mut().for_each(|frame| frame.masks[1..].fill(None));
        let mut tracker = Tracker::new(&cameras, &settings).expect("a hand");
        for (k, (frame, truth)) in frames.iter().zip(&joints).enumerate() {
            let tracked = tracker.push(frame).expect("a frame").expect("no delay");
            let error = mean_error(&tracked.fit.expect("a hand").joints, truth);
            let ratio = tracker.hand().length_mm() / small.length_mm();
            assert_eq!((ratio - 1.0).abs() < 0.07, k >= first, "frame {k}: {ratio}");
            assert!(k != first || error < 5.0, "frame {k}: {error} mm");
        }
    }
}

/// While it comes only fingers are seen, which a small hand's arm explains as well.
#[test]
fn a_hand_that_comes_into_the_pictures_is_learnt_once_they_show_all_of_it() {
    const AWAY: usize = 6;
    let Drawn { cameras, frames, joints } = drawn_coming(&hand(), 10, AWAY);
    let settings = TrackSettings { delay: Delay::None, ..TrackSettings::default() };
    let mut tracker = Tracker::new(&cameras, &settings).expect("a hand");
    for (k, (frame, truth)) in frames.iter().zip(&joints).enumerate() {
        let tracked = tracker.push(frame).expect("a frame").expect("no delay");
        let Some(fit) = tracked.fit else { continue };
        let error = mean_error(&fit.joints, truth);
        assert!(error < 15.0 || !fit.doubts.is_empty(), "frame {k}: {error} mm, undoubted");
        assert!(error < 15.0 || k < AWAY, "frame {k}: {error} mm");
    }
}

#[test]
fn a_camera_that_is_lost_makes_poses_less_certain_and_none_makes_them_unseen() {
    let Drawn { cameras, mut frames, joints } = drawn(9);
    frames[4].masks[0] = None;
    frames[6].masks.fill(None);
    let tracked = track(&cameras, &frames, Delay::None);
    let fit = |k: usize| tracked[k].fit.as_ref().expect("a hand");
    let spread = |k: usize| fit(k).joint_std.iter().sum::<f64>();
    assert!(spread(4) > spread(3) && spread(4) > spread(5), "{:?}", [3, 4, 5].map(spread));
    assert!(mean_error(&fit(4).joints, &joints[4]) < 10.0);
    assert_eq!(fit(6).doubts, [FitDoubt::NotSeen]);
    assert!(fit(6).joint_std.iter().all(|std| std.is_infinite()));
    for k in [7, 8] {
        let error = mean_error(&fit(k).joints, &joints[k]);
        assert!(error < 8.0, "frame {k} after the hand was lost: {error} mm");
    }
}

#[test]
fn a_hand_that_has_not_been_seen_yet_has_no_pose_and_time_goes_on() {
    let Drawn { cameras, frames, .. } = drawn(1);
    let mut tracker = Tracker::new(&cameras, &TrackSettings::default()).expect("a hand");
    let nothing = TakeFrame::of_masks(vec![None; cameras.len()]);
    assert_eq!(tracker.push(&nothing.clone().at(0.0)).expect("a frame"), None);
    let first = tracker.push(&frames[0].clone().at(0.1)).expect("a frame").expect("the one before");
    assert_eq!(first, TrackedFrame { time: 0.0, fit: None });
    assert!(tracker.world_from_hand().is_some());
    let error = tracker.push(&frames[0].clone().at(0.1)).expect_err("no time has passed");
    assert!(matches!(error, Error::FrameTime { .. }), "{error}");
}

#[test]
fn a_tracker_goes_on_from_its_state_as_if_it_had_never_stopped() {
    let Drawn { cameras, mut frames, .. } = drawn(6);
    frames[2].masks.fill(None);
    let whole = track(&cameras, &frames, Delay::OneFrame);
    let settings =
        TrackSettings { hand: hand(), proportions: Proportions::Given, delay: Delay::OneFrame };
    let mut tracker = Tracker::new(&cameras, &settings).expect("a hand");
    for (broken, frame) in frames.iter().enumerate() {
        let state = tracker.state().expect("the hand is given");
        let mut resumed = Tracker::resumed(&cameras, state).expect("a tracker");
        let mut tracked = Vec::new();
        for (k, frame) in frames.iter().enumerate().skip(broken) {
            let due = resumed.push(frame).expect("a frame");
            assert_eq!(due.is_some(), k > broken, "{k}");
            tracked.extend(due);
        }
        tracked.extend(resumed.finish().expect("a frame"));
        assert_eq!(tracked, whole[broken..]);
        tracker.push(frame).expect("a frame");
    }
    let learning = Tracker::new(&cameras, &TrackSettings::default()).expect("a hand");
    assert!(learning.state().is_none());
}
