//! Takes of which something is mistaken from the first frame to the last.

use phalanx::{
    Delay, FitDoubt, FrameFit, NoProgress, TakeFit, TakeFrame, TakeSettings, Tracker, fit_frame,
    fit_take,
};
use phalanx_camera::{Camera, Intrinsics};
use phalanx_hand::HandShape;
use phalanx_segmentation::Mask;

use crate::drawn::{Drawn, FITTED, drawn, mean_error};

fn fitted(Drawn { cameras, frames, .. }: &Drawn, settings: &TakeSettings) -> TakeFit {
    fit_take(cameras, frames, settings, &NoProgress).expect("a fit")
}

fn all_have(take: &TakeFit, doubt: FitDoubt) -> bool {
    take.frames.iter().all(|fit| fit.doubts.contains(&doubt))
}

/// Its outlines lie on those of a right hand well enough that no frame alone tells.
#[test]
fn a_right_hand_that_is_taken_for_a_left_one_is_doubted_in_every_frame() {
    let mut take = drawn(6);
    let right = HandShape::adult();
    let hand = HandShape { side: right.side.other(), ..right };
    let settings = TakeSettings { hand, ..TakeSettings::default() };
    let fit = fitted(&take, &settings);
    assert!(all_have(&fit, FitDoubt::OtherSide));

    // What is fitted with what the take told is as wrong.
    let is_doubted = |fit: &FrameFit| fit.doubts.contains(&FitDoubt::OtherSide);
    assert!(is_doubted(&fit_frame(&take.cameras, &take.frames[1], &fit).expect("a fit")));
    let mut tracker = Tracker::of_take(&take.cameras, &fit, Delay::None).expect("a tracker");
    let frame = take.frames.remove(0).at(0.0);
    let tracked = tracker.push(&frame).expect("a frame").expect("at once");
    assert!(is_doubted(&tracked.fit.expect("a hand")));
}

#[test]
fn two_cameras_that_have_each_others_pictures_are_named() {
    for (cameras, pair) in [(3, [0, 2]), (2, [0, 1])] {
        let Drawn { cameras: mut of, frames, joints } = drawn(6);
        of.truncate(cameras);
        let exchanged = |frame: TakeFrame| {
            let mut masks = frame.masks;
            masks.truncate(cameras);
            masks.swap(pair[0], pair[1]);
            TakeFrame::of_masks(masks)
        };
        let frames = frames.into_iter().map(exchanged).collect();
        let fit = fitted(&Drawn { cameras: of, frames, joints }, &TakeSettings::default());
        assert!(all_have(&fit, FitDoubt::Exchanged { views: pair }), "{cameras} cameras");
    }
}

/// As where a wall and a table have the colour of skin: nothing explains it, least of all another hand.
#[test]
fn what_no_hand_explains_is_not_said_to_be_mistaken() {
    let Drawn { cameras, joints, .. } = drawn(6);
    let mask = |frame: u32, camera: &Camera| {
        let Intrinsics { width, height, .. } = camera.intrinsics;
        let is_wall = |x: u32, y: u32| 3 * x > width && 7 * y > height + 9 * frame;
        Mask::from_fn(width, height, |x, y| is_wall(x, y) && (x + 2 * y) % 60 < 45)
    };
    let frame = |frame: u32| {
        TakeFrame::of_masks(cameras.iter().map(|camera| Some(mask(frame, camera))).collect())
    };
    let frames = (0..6).map(frame).collect();
    let fit = fitted(&Drawn { cameras: cameras.clone(), frames, joints }, &TakeSettings::default());
    assert!(fit.frames.iter().all(|fit| !fit.doubts.is_empty()));
    assert!(!fit.frames.iter().flat_map(|fit| &fit.doubts).any(is_of_all));
}

fn is_of_all(doubt: &FitDoubt) -> bool {
    matches!(doubt, FitDoubt::OtherSide | FitDoubt::Exchanged { .. })
}

#[test]
fn a_right_take_has_no_such_doubt() {
    let (Drawn { joints, .. }, fit) = &*FITTED;
    assert!(mean_error(&fit.frames[0].joints, &joints[0]) < 8.0);
    assert!(!fit.frames.iter().flat_map(|fit| &fit.doubts).any(is_of_all));
}
