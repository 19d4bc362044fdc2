//! What is done with any bytes at all, for each thing that is read from files: to be refused by name
//! or to be sound, but never to crash or to hang.

use glam::DAffine3;
use image::{GrayImage, RgbImage};
use phalanx::{Error, Estimator, PartialTraining, Segment, Segmentation, decode_picture};
use phalanx_camera::Rig;
use phalanx_codebook::{AnyEncoder, Encoder, Scratch};
use phalanx_hand::{HandShape, Pose, PoseTable, Side};
use phalanx_io::calibration::{Calibration, Missing, Unit, to_anipose_toml, to_opencv_yaml};
use phalanx_io::export::{
    CoordinateNames, LengthUnit, Placement, bvh, c3d, deviation_file, glb, motion_file, trc,
};
use phalanx_io::take::{Take, write_csv, write_json_lines, write_npz};
use phalanx_io::{Source, evaluation, landmarks, take};
use phalanx_segmentation::{Cleanup, Mask, Silhouette, SkinModel, WristModel, clean};

/// A target's name, which is also its corpus's, and what it does.
pub(crate) type Target = (&'static str, fn(&[u8]));

/// All of them.
#[allow(dead_code, reason = "each fuzz target uses one of them")]
pub(crate) const TARGETS: [Target; 15] = [
    ("model", model),
    ("part", part),
    ("rig", rig),
    ("calibration", calibration),
    ("landmarks", landmarks),
    ("take", take),
    ("reference", reference),
    ("hand", hand),
    ("poses", poses),
    ("segmentation", segmentation),
    ("skin_model", skin_model),
    ("wrist_model", wrist_model),
    ("coding", coding),
    ("mask", mask),
    ("picture", picture),
];

/// A model's payload, under a header that vouches for it, and as a whole file.
pub(crate) fn model(data: &[u8]) {
    let _ = Estimator::from_bytes(data);
    if let Ok(estimator) =
        Estimator::from_bytes(&sealed(*b"PHALANX\0", Estimator::from_bytes, data))
    {
        let bytes = estimator.to_bytes().expect("what was read can be written");
        assert_eq!(Estimator::from_bytes(&bytes).expect("and read again"), estimator);
    }
}

/// The same of a part of a training.
pub(crate) fn part(data: &[u8]) {
    let _ = PartialTraining::from_bytes(data);
    if let Ok(part) =
        PartialTraining::from_bytes(&sealed(*b"PHXPART\0", PartialTraining::from_bytes, data))
    {
        part.to_bytes().expect("what was read can be written");
    }
}

/// A payload under a header of the format that is read at present.
fn sealed<T>(mark: [u8; 8], read: fn(&[u8]) -> phalanx::Result<T>, payload: &[u8]) -> Vec<u8> {
    let newest = [&mark[..], &[0xff; 4]].concat();
    let Err(Error::FileVersion { known, .. }) = read(&newest) else {
        panic!("a file of the last format there can be is not refused for it");
    };
    let length = (payload.len() as u64).to_le_bytes();
    let checksum = crc32fast::hash(payload).to_le_bytes();
    [&mark[..], &known.to_le_bytes(), &length, &checksum, payload].concat()
}

pub(crate) fn rig(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Ok(rig) = Rig::from_toml(text) {
        let text = rig.to_toml().expect("what was read can be written");
        let again = Rig::from_toml(&text).expect("and read again");
        assert_eq!(again.cameras.len(), rig.cameras.len());
    }
}

/// A file, or two that complete each other, with a separator between them.
pub(crate) fn calibration(data: &[u8]) {
    let files: Vec<Source<'_>> = data
        .splitn(2, |&byte| byte == 0x1c)
        .map(|bytes| Source { name: "cameras", bytes })
        .collect();
    let squares = Missing { unit: Unit::of_mm(25.0).ok(), size: Some((1280, 720)) };
    for missing in [Missing::default(), squares] {
        let Ok(Calibration { cameras, .. }) = Calibration::read(&files, &missing) else { continue };
        for text in [to_anipose_toml(&cameras), to_opencv_yaml(&cameras)] {
            let file = Source { name: "written", bytes: text.as_bytes() };
            let again = Calibration::read(&[file], &Missing::default());
            let again = again.expect("what was read can be written and read again");
            assert_eq!(again.cameras.len(), cameras.len());
        }
    }
}

pub(crate) fn landmarks(data: &[u8]) {
    let file = Source { name: "take_7_keypoints.json", bytes: data };
    for side in [Side::Left, Side::Right] {
        for track in landmarks::read(&file, side).into_iter().flatten() {
            let points = track.in_pixels((640, 480)).frames.into_values().flatten().flatten();
            for point in points {
                assert!(point.at.is_finite() && 0.0 < point.confidence && point.confidence <= 1.0);
            }
        }
    }
}

/// A take in any of its forms, written in all of them and for other tools.
pub(crate) fn take(data: &[u8]) {
    let read = [take::read_csv(data), take::read_json_lines(data), take::read_npz(data)];
    for take in read.into_iter().flatten() {
        let (mut csv, mut lines) = (Vec::new(), Vec::new());
        write_csv(&take, &mut csv).expect("what was read can be written");
        write_json_lines(&take, &mut lines).expect("as lines, too");
        let npz = write_npz(&take).expect("and as arrays");
        let again =
            [take::read_csv(&csv[..]), take::read_json_lines(&lines[..]), take::read_npz(&npz)];
        for again in again {
            assert_eq!(again.expect("and read again").frames.len(), take.frames.len());
        }
        export(&take);
    }
}

/// What a format cannot hold is refused.
fn export(take: &Take) {
    let _ = trc(take, "take.trc", Placement::WORLD);
    let _ = c3d(take, Placement::WORLD);
    let _ = bvh(take, Placement::WORLD);
    let _ = glb(take, Placement::WORLD);
    for file in [motion_file, deviation_file] {
        let _ = file(take, CoordinateNames::OpenSim, LengthUnit::Millimetre);
    }
}

pub(crate) fn reference(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let read = [
        evaluation::read_csv(data),
        evaluation::read_trc(&text),
        evaluation::read_motion_file(&text),
    ];
    for reference in read.into_iter().flatten() {
        assert!(reference.instants.is_sorted());
        assert_eq!(reference.poses.len(), reference.instants.len());
        assert_eq!(reference.joints.len(), reference.instants.len());
    }
}

pub(crate) fn hand(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Ok(shape) = HandShape::from_toml(text) {
        shape.pose(&Pose::REST, &DAffine3::IDENTITY);
        HandShape::from_toml(&shape.to_toml()).expect("what was read can be read again");
    }
}

pub(crate) fn poses(data: &[u8]) {
    if let Ok(table) = PoseTable::read(data) {
        assert!(table.poses.iter().all(|pose| pose.0.iter().all(|number| number.is_finite())));
    }
}

/// What tells the hand from the rest of each camera's pictures, and a picture.
pub(crate) fn segmentation(data: &[u8]) {
    let file = sealed(*b"PHXSEGM\0", Segmentation::from_bytes, data);
    let Ok(segmentation) = Segmentation::from_bytes(&file) else { return };
    segmentation.to_bytes().expect("what was read can be written");
    if let Ok(segmenter) = segmentation.of_camera("top") {
        let _ = segmenter.segment(&RgbImage::new(4, 3));
    }
}

pub(crate) fn skin_model(data: &[u8]) {
    if let Ok(model) = SkinModel::from_bytes(data) {
        assert_eq!(SkinModel::from_bytes(&model.to_bytes()).expect("read again"), model);
    }
}

pub(crate) fn wrist_model(data: &[u8]) {
    if let Ok(model) = WristModel::from_bytes(data) {
        model.to_bytes();
    }
}

/// A coding, and then a code.
pub(crate) fn coding(data: &[u8]) {
    let Ok(coding) = postcard::from_bytes::<AnyEncoder>(data) else { return };
    let bins = coding.bins();
    let sample = vec![1.0 / bins as f32; bins];
    let mut code = vec![0.0; coding.dim()];
    if coding.encode(&sample, &mut Scratch::default(), &mut code).is_ok() {
        assert!(code.iter().all(|number| number.is_finite()));
    }
}

/// A width and the pixels of a mask, which is cleaned and traced.
pub(crate) fn mask(data: &[u8]) {
    let Some((&width, pixels)) = data.split_first() else { return };
    let width = usize::from(width).max(1);
    let height = pixels.len() / width;
    let pixels = pixels[..width * height].to_vec();
    let Some(mask) = GrayImage::from_raw(width as u32, height as u32, pixels) else { return };
    let mask = Mask::from(mask);
    let _ = Silhouette::from_mask(&mask);
    if let Ok(cleaned) = clean(&mask, &Cleanup::default()) {
        let _ = Silhouette::from_mask(&cleaned);
    }
}

/// A picture's file, decoded in less memory than fuzzing allows.
pub(crate) fn picture(data: &[u8]) {
    let _ = decode_picture(data, 32 << 20);
}
