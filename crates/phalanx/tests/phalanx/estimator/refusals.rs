//! What cannot be estimated from, by name and camera.

use image::{GrayImage, Luma, RgbImage};
use phalanx::{Descriptor, Error, Estimator, ExtraFeatures, Picture, Workspace};
use phalanx_codebook::{AnyEncoder, Codebook, SoftAssignment};
use phalanx_multiview::ViewEncoders;
use phalanx_rvm::Model;
use phalanx_segmentation::{Error as Segmentation, ForearmCue, MIN_SIDE, Mask, SkinModel};

use super::desk::{ESTIMATOR, FROM_TOP, difference_deg, estimate, masks, rig, top, unseen};

fn uniform(width: u32, height: u32, level: u8) -> Mask {
    GrayImage::from_pixel(width, height, Luma([level])).into()
}

/// What the estimator says of this mask as the second of three.
fn refusal(second: Mask) -> Error {
    let mut masks = masks(&rig(), &unseen()[1]);
    masks[1] = second;
    estimate(&ESTIMATOR, &masks).unwrap_err()
}

#[test]
fn one_picture_per_camera() {
    let all = masks(&rig(), &unseen()[1]);
    let four = [all.clone(), all[..1].to_vec()].concat();
    for some in [&all[..0], &all[..2], &four] {
        let error = estimate(&ESTIMATOR, some).unwrap_err();
        let found = some.len();
        assert_eq!(
            error.to_string(),
            format!("expected one picture per camera, 3 (side, top, other_side), found {found}")
        );
    }
    let error = ESTIMATOR.estimate_silhouettes(&[], &mut Workspace::default()).unwrap_err();
    assert!(matches!(error, Error::PictureCount { found: 0, .. }));
}

#[test]
fn pictures_have_their_cameras_shape() {
    let message = refusal(uniform(160, 90, 0)).to_string();
    assert!(message.starts_with("camera 'top': the picture is 160×90"), "{message}");
    for (width, height) in [(90, 120), (120, 92), (1, 1000), (0, 0), (120, 0)] {
        let error = refusal(uniform(width, height, 255));
        let found = (width, height);
        match error {
            Error::PictureShape { camera, found: f, .. } => {
                assert_eq!((camera.as_str(), f), ("top", found));
            }
            Error::Silhouette { camera, reason: Segmentation::ImageTooSmall { .. } } => {
                assert_eq!(camera, "top");
            }
            other => panic!("{found:?}: {other}"),
        }
    }
}

#[test]
fn tiny_pictures_are_refused_and_small_ones_are_not() {
    // Half of it hand: it would make a silhouette.
    let half = |width, height| Mask::from_fn(width, height, |x, _| x < width / 2);
    for (width, height) in [(2, 1), (4, 3), (20, 15)] {
        let error = refusal(half(width, height));
        assert!(
            matches!(&error, Error::Silhouette { camera, reason: Segmentation::ImageTooSmall { .. } } if camera == "top"),
            "{error}"
        );
    }
    let least = half(24, 18);
    assert!(least.height() >= MIN_SIDE);
    let error = estimate(&FROM_TOP, &[least]).map(|_| ());
    assert!(!matches!(
        error,
        Err(Error::Silhouette { reason: Segmentation::ImageTooSmall { .. }, .. })
    ));
}

#[test]
fn empty_and_full_masks_are_named() {
    let error = refusal(uniform(120, 90, 0));
    assert!(error.to_string().starts_with("camera 'top': empty mask"), "{error}");
    // 127 is not hand.
    let error = refusal(uniform(120, 90, 127));
    assert!(error.to_string().starts_with("camera 'top': empty mask"), "{error}");
    let error = refusal(uniform(120, 90, 255));
    assert!(error.to_string().starts_with("camera 'top': no contour"), "{error}");
}

#[test]
fn a_photograph_without_a_hand_is_named() {
    let skin = SkinModel::builtin();
    let green = RgbImage::from_pixel(120, 90, image::Rgb([30, 160, 40]));
    let pictures = [Picture::Photograph(&green, &skin)];
    let error = FROM_TOP.estimate(&pictures, &mut Workspace::default()).unwrap_err();
    assert!(error.to_string().starts_with("camera 'top': empty mask"), "{error}");
}

#[test]
fn a_hand_cut_off_from_the_border_is_known_by_its_stump() {
    let pose = unseen()[0];
    let mut mask = masks(&top(), &pose).remove(0);
    for (x, _, level) in mask.enumerate_pixels_mut() {
        if x < 3 {
            *level = Luma([0]);
        }
    }
    let found = estimate(&FROM_TOP, &[mask]).unwrap();
    let forearm = found.observation.views[0].silhouette.forearm;
    assert_eq!((forearm.cue, forearm.crossings), (ForearmCue::SmoothEnd, 0));
    let error = difference_deg(&found.pose, &pose);
    assert!(error < 6.0, "{error:.2} degrees");
}

#[test]
fn a_disc_has_no_forearm() {
    let disc = Mask::from_fn(120, 90, |x, y| {
        let (dx, dy) = (f64::from(x) - 60.0, f64::from(y) - 45.0);
        dx.hypot(dy) < 25.0
    });
    let error = refusal(disc);
    assert!(error.to_string().starts_with("camera 'top': no forearm"), "{error}");
}

#[test]
fn a_second_crossing_is_reported() {
    let mut mask = masks(&top(), &unseen()[0]).remove(0);
    for y in 30..33 {
        for x in 60..120 {
            mask.put_pixel(x, y, Luma([255]));
        }
    }
    let found = estimate(&FROM_TOP, &[mask]).unwrap();
    assert_eq!(found.observation.views[0].silhouette.forearm.crossings, 2);
}

fn codebook(coding: &AnyEncoder) -> Codebook {
    match coding {
        AnyEncoder::SoftHistogram { codebook, .. } => codebook.clone(),
        other => panic!("the paper's estimator counts: {other:?}"),
    }
}

#[test]
fn parts_that_do_not_fit_are_refused() {
    let estimator = &*ESTIMATOR;
    let together = |rig, codes: &ViewEncoders, model: &Model| {
        let (hand, rule) = (estimator.hand().clone(), estimator.orientation());
        let descriptor = Descriptor::new(rule, codes.clone(), ExtraFeatures::Nothing);
        Estimator::from_parts(rig, hand, descriptor, model.clone())
    };
    let (codes, model) = (estimator.descriptor().codes(), &estimator.regressor().models()[0]);
    let whole = together(rig(), codes, model).unwrap();
    assert_eq!(&whole, estimator);

    let message = |result: phalanx::Result<Estimator>| result.unwrap_err().to_string();
    assert_eq!(message(together(top(), codes, model)), "3 codebooks where there should be 1");
    let two = rig().select(&["side", "top"]).unwrap();
    let codebooks: Vec<Codebook> = codes.views().iter().map(codebook).collect();
    let views = |codebooks: &[Codebook]| {
        ViewEncoders::soft_histograms(codebooks.to_vec(), SoftAssignment::default()).unwrap()
    };
    assert_eq!(
        message(together(two, &views(&codebooks[..2]), model)),
        "30 regressor inputs where there should be 20"
    );
    let mut parts = model.clone().into_parts();
    parts.outputs = 27;
    parts.bias.pop();
    parts.noise.pop();
    parts.weights =
        parts.weights.chunks_exact(28).flat_map(|column| &column[..27]).copied().collect();
    let fewer = Model::from_parts(parts).unwrap();
    assert_eq!(
        message(together(rig(), codes, &fewer)),
        "27 regressor outputs where there should be 28"
    );
    let coarse = Codebook::from_parts(vec![0.25; 40], 4, 0.1).unwrap();
    let mixed = [codebooks[0].clone(), coarse, codebooks[2].clone()];
    assert_eq!(
        message(together(rig(), &views(&mixed), model)),
        "camera 'top': its codebook is of 4 bins where shape contexts have 60"
    );
    let mut unusable = rig();
    unusable.cameras[0].intrinsics.fx = 0.0;
    assert!(matches!(together(unusable, codes, model), Err(Error::Rig(_))));
    assert!(
        ViewEncoders::soft_histograms(codebooks.clone(), SoftAssignment { neighbours: 11 })
            .is_err()
    );
}

#[test]
fn a_regressor_that_overflows_is_named() {
    let mut parts = FROM_TOP.regressor().models()[0].clone().into_parts();
    parts.weights.fill(1e149);
    parts.column_means.fill(-1e149);
    parts.bias.fill(1e149);
    parts.noise.fill(1e149);
    let model = Model::from_parts(parts).unwrap();
    let wild =
        Estimator::from_parts(top(), FROM_TOP.hand().clone(), FROM_TOP.descriptor().clone(), model);
    match estimate(&wild.unwrap(), &masks(&top(), &unseen()[0])) {
        Err(Error::Overflow { dof, .. }) => assert_eq!(dof, "thumb.abduction"),
        Err(other) => panic!("{other}"),
        Ok(found) => {
            assert!(found.pose.0.iter().chain(found.std.iter().flatten()).all(|v| v.is_finite()));
        }
    }
}

#[test]
fn estimators_can_be_shared_by_threads() {
    fn shared<T: Send + Sync>() {}
    shared::<Estimator>();
    shared::<Error>();
}
