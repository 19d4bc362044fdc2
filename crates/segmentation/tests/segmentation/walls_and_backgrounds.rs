//! Masks without a skin model.

use image::{Rgb, RgbImage};
use phalanx_segmentation::{
    BackgroundModel, BackgroundParams, BackgroundParts, Error, Mask, PlainBackground, SceneModel,
    SkinModel,
};

const SIZE: (u32, u32) = (48, 36);

fn is_hand(x: u32, y: u32) -> bool {
    (16..30).contains(&x) && y > 8
}

fn truth() -> Mask {
    Mask::from_fn(SIZE.0, SIZE.1, is_hand)
}

/// A hand before `wall`; `light` brightens and darkens, and `seed` stirs the noise.
fn scene(wall: [u8; 3], hand: Option<[u8; 3]>, light: impl Fn(u32) -> f32, seed: u32) -> RgbImage {
    RgbImage::from_fn(SIZE.0, SIZE.1, |x, y| {
        let colour = hand.filter(|_| is_hand(x, y)).unwrap_or(wall);
        let noise = ((x * 7919 + y * 104_729 + seed * 31) % 5) as f32 - 2.0;
        Rgb(colour.map(|level| (f32::from(level) * light(x) + noise).clamp(0.0, 255.0) as u8))
    })
}

#[test]
fn a_bright_wall_may_be_tinted_and_unevenly_lit() {
    let fading = |x| 1.0 - 0.5 * x as f32 / SIZE.0 as f32;
    for hand in [[214, 160, 130], [110, 70, 52]] {
        let image = scene([200, 205, 220], Some(hand), fading, 0);
        assert_eq!(PlainBackground::Bright.segment(&image).unwrap(), truth());
    }
}

#[test]
fn before_a_dark_wall_the_hand_is_what_is_bright() {
    let image = scene([18, 20, 25], Some([190, 140, 115]), |_| 1.0, 0);
    assert_eq!(PlainBackground::Dark.segment(&image).unwrap(), truth());
}

#[test]
fn a_bare_wall_is_an_error() {
    for wall in [PlainBackground::Bright, PlainBackground::Dark] {
        let bare = scene([200, 200, 200], None, |_| 1.0, 0);
        assert!(matches!(wall.segment(&bare), Err(Error::NoContrast { .. })));
        assert!(matches!(wall.segment(&RgbImage::new(0, 4)), Err(Error::ImageTooSmall { .. })));
    }
}

#[test]
fn a_recorded_background_ignores_noise_and_shadow() {
    let frames: Vec<_> = (0..5).map(|seed| scene([150, 120, 90], None, |_| 1.0, seed)).collect();
    let model = BackgroundModel::from_frames(&frames, BackgroundParams::default()).unwrap();
    let nothing = model.segment(&scene([150, 120, 90], None, |_| 1.0, 9)).unwrap();
    assert!(nothing.iter().all(|&level| level == 0));
    let shadow = |x| if x < 12 { 0.6 } else { 1.0 };
    let image = scene([150, 120, 90], Some([205, 150, 130]), shadow, 9);
    assert_eq!(model.segment(&image).unwrap(), truth());
    let strict = BackgroundParams { shadow: 1.0, ..BackgroundParams::default() };
    let model = BackgroundModel::from_frames(&frames[..1], strict).unwrap();
    assert_eq!(model.segment(&image).unwrap().get_pixel(3, 3).0[0], 255, "shadows count");
}

#[test]
fn a_noisier_pixel_needs_a_larger_difference() {
    let frames: Vec<_> = [80_u8, 120, 100]
        .map(|level| RgbImage::from_fn(2, 1, |x, _| Rgb([if x == 0 { level } else { 100 }; 3])))
        .to_vec();
    let strict = BackgroundParams { shadow: 1.0, ..BackgroundParams::default() };
    let model = BackgroundModel::from_frames(&frames, strict).unwrap();
    let image = RgbImage::from_pixel(2, 1, Rgb([140; 3]));
    assert_eq!(model.segment(&image).unwrap().into_image().into_raw(), [0, 255]);
    let noise = &model.parts().noise;
    assert!((noise[0] - 20.0).abs() < 1e-4 && noise[1] == 0.0);
}

#[test]
fn a_background_survives_its_parts_and_refuses_what_does_not_fit() {
    let frame = scene([150, 120, 90], None, |_| 1.0, 0);
    let params = BackgroundParams::default();
    let model = BackgroundModel::from_frames(std::slice::from_ref(&frame), params).unwrap();
    assert_eq!(BackgroundModel::from_parts(model.parts().clone()).unwrap(), model);
    let stored = postcard::to_allocvec(&model).unwrap();
    assert_eq!(postcard::from_bytes::<BackgroundModel>(&stored).unwrap(), model);

    let wrong_size = model.segment(&RgbImage::new(3, 3));
    let expected = Error::SizeMismatch { what: "image", expected: SIZE, found: (3, 3) };
    assert_eq!(wrong_size, Err(expected));
    assert_eq!(BackgroundModel::from_frames(&[], params), Err(Error::NoFrames));
    let frames = [frame, RgbImage::new(1, 1)];
    let mixed = BackgroundModel::from_frames(&frames, params);
    assert!(matches!(mixed, Err(Error::SizeMismatch { .. })));

    let parts = model.parts();
    let bad = [
        BackgroundParts { noise: vec![], ..parts.clone() },
        BackgroundParts { mean: vec![[f32::NAN; 3]; parts.mean.len()], ..parts.clone() },
        BackgroundParts { params: BackgroundParams { shadow: 2.0, ..params }, ..parts.clone() },
        BackgroundParts { width: u32::MAX, height: u32::MAX, ..parts.clone() },
    ];
    for parts in bad {
        assert!(matches!(BackgroundModel::from_parts(parts), Err(Error::Parameter { .. })));
    }
}

const BOARD: [u8; 3] = [180, 130, 80];
const DESK: [u8; 3] = [90, 95, 100];

/// A hand whose arm stays, and whose fingers are as long as `reach` says, over a board or not.
fn over_a_board(reach: u32, board: [u8; 3]) -> (RgbImage, Mask) {
    let mask = Mask::from_fn(192, 144, |x, y| {
        let is_arm = (40..112).contains(&y) && x < 60;
        let is_finger = (40..112).contains(&y) && y % 18 < 11 && x < 60 + reach;
        is_arm || is_finger
    });
    let picture = RgbImage::from_fn(192, 144, |x, y| {
        let background = if y < 76 { board } else { DESK };
        let noise = ((x * 7919 + y * 104_729 + reach * 31) % 5) as u8;
        let colour = if mask.is_hand(x, y) { [205, 150, 130] } else { background };
        Rgb(colour.map(|level| level + noise))
    });
    (picture, mask)
}

fn learnt_over(board: [u8; 3], reaches: impl Iterator<Item = u32>) -> Option<SceneModel> {
    let pictures: Vec<RgbImage> = reaches.map(|reach| over_a_board(reach, board).0).collect();
    SceneModel::learn(&pictures, &SkinModel::builtin()).unwrap()
}

/// Also where arm and palm never leave their place, and fingers are seen over the board.
#[test]
fn what_moves_tells_the_hand_from_a_board_that_looks_like_skin() {
    let skin = SkinModel::builtin();
    let scene = learnt_over(BOARD, (0..20).map(|k| 5 * k)).unwrap();
    for reach in [0, 30, 95] {
        let (picture, truth) = over_a_board(reach, BOARD);
        let overlap = scene.segment(&picture).unwrap().iou(&truth);
        let by_colour = skin.classify(&picture).iou(&truth);
        assert!(overlap > 0.85 && by_colour < 0.6, "{reach}: {overlap}, by colour {by_colour}");
    }
}

#[test]
fn a_scene_is_learnt_only_where_colour_does_not_tell() {
    assert!(learnt_over(DESK, (0..20).map(|k| 5 * k)).is_none(), "the desk is not like skin");
    assert!(learnt_over(BOARD, (0..20).map(|_| 50)).is_none(), "nothing moves");
    let skin = SkinModel::builtin();
    assert!(matches!(SceneModel::learn(&[], &skin), Err(Error::NoFrames)));
    let (one, other) = (RgbImage::new(4, 4), RgbImage::new(5, 4));
    let sizes = SceneModel::learn(&[one, other], &skin);
    assert!(matches!(sizes, Err(Error::SizeMismatch { .. })));
    assert!(SceneModel::learn(&[RgbImage::new(0, 0)], &skin).unwrap().is_none());
    let scene = learnt_over(BOARD, (0..20).map(|k| 5 * k)).unwrap();
    let smaller = scene.segment(&RgbImage::new(191, 144));
    assert!(matches!(smaller, Err(Error::SizeMismatch { .. })));
}
