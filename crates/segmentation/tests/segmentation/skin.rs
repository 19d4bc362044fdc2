//! Skin models: training, deciding, saving.

use std::path::PathBuf;

use image::{Rgb, RgbImage};
use phalanx_segmentation::{
    BUILTIN_SOURCE, Error, Label, Mask, SkinModel, SkinParams, SkinTrainer, chroma,
};
use proptest::prelude::*;

use crate::property;

const SKIN: [u8; 3] = [200, 140, 110];
const WALL: [u8; 3] = [120, 130, 140];

fn small_model() -> SkinModel {
    let mut trainer = SkinTrainer::default();
    trainer.add_pixel(SKIN, Label::Skin);
    trainer.add_pixel(WALL, Label::NonSkin);
    trainer.finish("two pixels").unwrap()
}

fn models() -> impl Strategy<Value = SkinModel> {
    let pixels = proptest::collection::vec((any::<[u8; 3]>(), any::<bool>()), 1..50);
    let params = (4..=8_u32, 0..6_u32, 0.01..0.99);
    (pixels, params).prop_map(|(pixels, (bits, smoothing, prior))| {
        let mut trainer = SkinTrainer::new(SkinParams { bits, smoothing, prior }).unwrap();
        trainer.add_pixel(SKIN, Label::Skin);
        trainer.add_pixel(WALL, Label::NonSkin);
        for (rgb, is_skin) in pixels {
            trainer.add_pixel(rgb, if is_skin { Label::Skin } else { Label::NonSkin });
        }
        trainer.finish("made up").unwrap()
    })
}

proptest! {
    #![proptest_config(property::cases(48))]

    #[test]
    fn a_model_survives_its_bytes_its_parts_and_serde(model in models()) {
        prop_assert_eq!(&SkinModel::from_bytes(&model.to_bytes()).unwrap(), &model);
        prop_assert_eq!(&SkinModel::from_parts(model.parts().clone()).unwrap(), &model);
        let stored = postcard::to_allocvec(&model).unwrap();
        prop_assert_eq!(&postcard::from_bytes::<SkinModel>(&stored).unwrap(), &model);
    }

    #[test]
    fn damaged_bytes_never_panic(at in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let mut bytes = small_model().to_bytes();
        let at = at.index(bytes.len());
        let _ = SkinModel::from_bytes(&bytes[..at]);
        bytes[at] = byte;
        let _ = SkinModel::from_bytes(&bytes);
    }

    #[test]
    fn any_text_after_the_first_line_never_panics(rest in "[a-z0-9. \n-]{0,200}") {
        let _ = SkinModel::from_bytes(format!("phalanx skin model 1\n{rest}").as_bytes());
    }

    #[test]
    fn only_chroma_decides(rgb in any::<[u8; 3]>(), other in any::<[u8; 3]>()) {
        let model = SkinModel::builtin();
        if chroma(rgb) == chroma(other) {
            prop_assert_eq!(model.is_skin(rgb), model.is_skin(other));
        }
        let image = RgbImage::from_pixel(3, 2, Rgb(rgb));
        let expected = if model.is_skin(rgb) { 255 } else { 0 };
        prop_assert!(model.classify(&image).iter().all(|&level| level == expected));
    }
}

#[test]
fn hostile_texts_are_refused_by_line() {
    let head = "phalanx skin model 1\nsource x\nbits 7\nsmoothing 1\nprior 0.5\n";
    let line_of = |text: String| match SkinModel::from_bytes(text.as_bytes()) {
        Err(Error::Model { line, .. }) => line,
        other => panic!("{other:?}"),
    };
    assert_eq!(line_of(String::new()), 1);
    assert_eq!(line_of("phalanx skin model 2\n".to_owned()), 1);
    assert_eq!(line_of(head.replace("bits 7", "bits many")), 3);
    assert_eq!(line_of(format!("{head}128 0 1 1\n")), 6);
    assert_eq!(line_of(format!("{head}1 1 1 1\n1 1 1 1\n")), 7);
    assert_eq!(line_of(format!("{head}1 1 1 4294967296\n")), 6);
    assert_eq!(line_of(format!("{head}1 1 1 1 1\n")), 6);
    let huge = SkinModel::from_bytes(head.replace("bits 7", "bits 31").as_bytes());
    assert!(matches!(huge, Err(Error::Parameter { name: "bits", .. })));
    let nan = SkinModel::from_bytes(head.replace("0.5", "NaN").as_bytes());
    assert!(matches!(nan, Err(Error::Parameter { name: "prior", .. })));
    let untrained = SkinModel::from_bytes(format!("{head}1 1 1 0\n").as_bytes());
    assert_eq!(untrained, Err(Error::NoTrainingPixels(Label::NonSkin)));
}

#[test]
fn learns_from_an_image_and_its_mask() {
    let hand = |x: u32| x < 3;
    let image = RgbImage::from_fn(8, 4, |x, _| Rgb(if hand(x) { SKIN } else { WALL }));
    let mask = Mask::from_fn(8, 4, |x, _| hand(x));
    let mut trainer = SkinTrainer::default();
    trainer.add_image(&image, &mask).unwrap();
    let mismatch = trainer.add_image(&image, &Mask::new(4, 8));
    assert!(matches!(mismatch, Err(Error::SizeMismatch { found: (4, 8), .. })));
    let model = trainer.finish("one image").unwrap();
    assert_eq!(model.classify(&image), mask);
    let mut used = Mask::default();
    model.classify_into(&image, &mut used);
    assert_eq!(used, mask);
    assert!(!model.is_skin([0, 255, 0]), "a colour far from both classes");
}

#[test]
fn a_higher_prior_finds_more_skin() {
    let SkinParams { bits, smoothing, .. } = SkinParams::default();
    let skin_bins = |prior| {
        let mut parts = SkinModel::builtin().into_parts();
        parts.params = SkinParams { bits, smoothing, prior };
        let model = SkinModel::from_parts(parts).unwrap();
        (0..=255_u8).filter(|&g| model.is_skin([200, g, 110])).count()
    };
    assert!(skin_bins(0.05) < skin_bins(0.5) && skin_bins(0.5) < skin_bins(0.95));
}

#[test]
fn the_built_in_model_names_its_source_and_knows_skin_of_many_tones() {
    let model = SkinModel::builtin();
    assert_eq!(model.parts().source, BUILTIN_SOURCE);
    assert_eq!(model.to_bytes(), include_bytes!("../../models/skin.txt"));
    for tone in [[224, 172, 145], [198, 134, 102], [141, 85, 60], [95, 58, 42]] {
        assert!(model.is_skin(tone), "{tone:?}");
    }
    for other in [[128, 128, 128], [255, 255, 255], [0, 0, 0], [60, 90, 160], [40, 140, 60]] {
        assert!(!model.is_skin(other), "{other:?}");
    }
}

/// `PHALANX_DATA` names the folder of the data set that [`BUILTIN_SOURCE`] describes.
#[test]
#[ignore = "needs the UCI skin pixels in the folder PHALANX_DATA"]
fn the_shipped_file_is_what_its_source_gives() {
    let data = std::env::var_os("PHALANX_DATA").expect("PHALANX_DATA names the data's folder");
    let path = PathBuf::from(data).join("skin-pixels/Skin_NonSkin.txt");
    let text = std::fs::read_to_string(&path).unwrap();
    let mut trainer = SkinTrainer::default();
    for row in text.lines().skip(1) {
        let values: Vec<u8> = row.split_whitespace().map(|value| value.parse().unwrap()).collect();
        let [b, g, r, label] = values[..] else { panic!("{row}") };
        trainer.add_pixel([r, g, b], if label == 1 { Label::Skin } else { Label::NonSkin });
    }
    assert_eq!(trainer.finish(BUILTIN_SOURCE).unwrap(), SkinModel::builtin());
}
