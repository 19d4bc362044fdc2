//! Drawn takes, of which it is known where every joint is.

use std::sync::LazyLock;

use glam::{DAffine3, DVec2, DVec3};
use phalanx::{ItemRng, NoProgress, TakeFit, TakeFrame, TakeSettings, fit_take};
use phalanx_camera::{Camera, Intrinsics, Rig};
use phalanx_hand::{Digit, Dof, HandShape, JOINTS, Pose};
use phalanx_render::Renderer;
use phalanx_segmentation::Mask;

/// A drawn take: cameras on three sides of a desk, and a hand that is no mean one.
pub(crate) struct Drawn {
    pub(crate) cameras: Vec<Camera>,
    pub(crate) frames: Vec<TakeFrame>,
    pub(crate) joints: Vec<[DVec3; JOINTS]>,
}

/// The desk's cameras, with pictures that a hand is small in.
pub(crate) fn cameras() -> Vec<Camera> {
    zoomed(1.6)
}

/// The desk's cameras with pictures of 320 by 240, as many times as large as they are.
fn zoomed(times: f64) -> Vec<Camera> {
    let rig = Rig::from_toml(include_str!("../../fixtures/desk.toml")).expect("a rig");
    let wide = |camera: &Camera| {
        let Intrinsics { fx, .. } = camera.intrinsics;
        camera.with_intrinsics(Intrinsics::pinhole(320, 240, times * fx))
    };
    rig.cameras.iter().map(wide).collect()
}

/// Someone's hand: 6 % longer than the mean one, its bones up to 4 % more or less.
pub(crate) fn hand() -> HandShape {
    let mut random = ItemRng::new(5, 0);
    HandShape::adult().scaled(|| 1.06 * random.between(0.96, 1.04))
}

/// Fingers that open and close in turn while the hand turns a little.
fn pose(frame: usize) -> Pose {
    let mut pose = Pose::REST;
    let at = frame as f64;
    for (k, finger) in Digit::FINGERS.into_iter().enumerate() {
        let bent = 0.5 - 0.5 * (0.8 * at + 1.5 * k as f64).cos();
        let angles = [0.0, 0.9 * bent, 1.3 * bent, 0.8 * bent];
        finger.dofs().into_iter().zip(angles).for_each(|(dof, angle)| pose[dof] = angle);
    }
    pose[Dof::ThetaX] = 0.15 * (0.5 * at).sin();
    pose[Dof::ThetaZ] = 0.6 + 0.3 * (0.4 * at).cos();
    [pose[Dof::TX], pose[Dof::TY], pose[Dof::TZ]] = [4.0 * at, 3.0 * (0.7 * at).sin(), -10.0];
    pose
}

pub(crate) fn drawn(count: usize) -> Drawn {
    drawn_of(&hand(), count)
}

/// Six frames, and what is fitted to them.
pub(crate) static FITTED: LazyLock<(Drawn, TakeFit)> = LazyLock::new(|| {
    let take = drawn(6);
    let fit = fit_take(&take.cameras, &take.frames, &TakeSettings::default(), &NoProgress);
    (take, fit.expect("a fit"))
});

/// The same of another hand.
pub(crate) fn drawn_of(hand: &HandShape, count: usize) -> Drawn {
    drawn_in(hand, (0..count).map(pose))
}

/// The same of a hand that is turned about its forearm by so much in all, radians.
pub(crate) fn drawn_turning(count: usize, turned: f64) -> Drawn {
    let turning = |frame: usize| {
        let mut pose = pose(frame);
        pose[Dof::ThetaZ] = turned * (frame as f64 / (count - 1) as f64 - 0.5);
        pose
    };
    drawn_in(&hand(), (0..count).map(turning))
}

/// The same of a hand that comes along its arm, from so many frames away.
pub(crate) fn drawn_coming(hand: &HandShape, count: usize, away: usize) -> Drawn {
    /// How far it comes from frame to frame, mm.
    const STEP: f64 = 60.0;
    let coming = |frame: usize| {
        let mut pose = pose(frame);
        pose[Dof::TZ] -= STEP * away.saturating_sub(frame) as f64;
        pose
    };
    drawn_in(hand, (0..count).map(coming))
}

/// The same of a hand that does nothing but come nearer to a camera, by so much in all, mm.
pub(crate) fn drawn_nearing(camera: &Camera, count: usize, by: f64) -> Drawn {
    let towards = camera.centre().normalize();
    let nearer = |frame: usize| {
        let mut pose = pose(frame);
        let at = towards * (by * (frame as f64 / (count - 1) as f64 - 0.5));
        [pose[Dof::TX], pose[Dof::TY], pose[Dof::TZ]] = at.to_array();
        pose
    };
    drawn_in(&hand(), (0..count).map(nearer))
}

/// Fingers that are nearly straight, on a slender arm that ends within the pictures: it is cut across so far behind the
/// wrist, mm.
pub(crate) fn drawn_sleeved(count: usize, behind: f64) -> Drawn {
    let mut hand = hand();
    (hand.forearm.half_widths_mm, hand.forearm.flatness) = ([24.0, 40.0], 0.7);
    let straight = |frame: usize| {
        let mut pose = pose(frame);
        for finger in Digit::FINGERS {
            let angles = [0.0, 0.195, 0.24, 0.135];
            finger.dofs().into_iter().zip(angles).for_each(|(dof, angle)| pose[dof] = angle);
        }
        pose
    };
    let mut drawn = drawn_before(zoomed(0.8), &hand, (0..count).map(straight));
    for (frame, joints) in drawn.frames.iter_mut().zip(&drawn.joints) {
        for (mask, camera) in frame.masks.iter_mut().zip(&drawn.cameras) {
            *mask = mask.take().map(|mask| sleeved(&mask, camera, joints[0], behind));
        }
    }
    drawn
}

/// What a camera sees of a hand and of so much of its forearm behind the wrist, mm, which lies along +z.
pub(crate) fn sleeved(mask: &Mask, camera: &Camera, wrist: DVec3, behind: f64) -> Mask {
    let seen = |behind: f64| camera.project(wrist - DVec3::Z * behind).expect("before it");
    let [wrist, end] = [0.0, behind].map(seen);
    let (width, height) = mask.dimensions();
    Mask::from_fn(width, height, |x, y| {
        let pixel = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
        mask.is_hand(x, y) && (pixel - end).dot(wrist - end) > 0.0
    })
}

/// Each frame by itself: fingers bent by any amounts, and the hand turned in any way that an arm allows.
pub(crate) fn drawn_stills(count: usize) -> Drawn {
    let mut random = ItemRng::new(7, 0);
    let still = move |_: usize| {
        let mut pose = pose(2);
        for finger in Digit::FINGERS {
            let bent = random.between(0.0, 1.0);
            let angles = [random.between(-0.15, 0.15), 1.3 * bent, 1.6 * bent, 0.9 * bent];
            finger.dofs().into_iter().zip(angles).for_each(|(dof, angle)| pose[dof] = angle);
        }
        pose[Dof::ThetaX] = random.between(-0.6, 0.6);
        pose[Dof::ThetaY] = random.between(-0.4, 0.4);
        pose[Dof::ThetaZ] = random.between(-1.0, 2.0);
        pose[Dof::WristFlexion] = random.between(-0.5, 0.5);
        pose
    };
    drawn_in(&hand(), (0..count).map(still))
}

/// How many frames there are in a second.
const RATE: f64 = 30.0;

/// A hand in some poses.
fn drawn_in(hand: &HandShape, poses: impl Iterator<Item = Pose>) -> Drawn {
    drawn_before(cameras(), hand, poses)
}

/// The same before some cameras.
fn drawn_before(
    cameras: Vec<Camera>,
    hand: &HandShape,
    poses: impl Iterator<Item = Pose>,
) -> Drawn {
    let rest = DAffine3::IDENTITY;
    let mut renderers: Vec<Renderer> =
        cameras.iter().map(|camera| Renderer::new(camera).expect("a camera")).collect();
    let (mut frames, mut joints) = (Vec::new(), Vec::new());
    for pose in poses {
        let posed = hand.pose(&pose, &rest);
        let mut mask = |renderer: &mut Renderer| {
            let drawn = renderer.silhouette(&posed.primitives);
            Some(drawn.expect("a hand before the camera").into())
        };
        let masks = renderers.iter_mut().map(&mut mask).collect();
        frames.push(TakeFrame::of_masks(masks).at(frames.len() as f64 / RATE));
        joints.push(posed.joints);
    }
    Drawn { cameras, frames, joints }
}

pub(crate) fn mean_error(found: &[DVec3; JOINTS], truth: &[DVec3; JOINTS]) -> f64 {
    found.iter().zip(truth).map(|(a, b)| a.distance(*b)).sum::<f64>() / JOINTS as f64
}
