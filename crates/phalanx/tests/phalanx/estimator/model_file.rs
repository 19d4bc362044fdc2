//! The model file: what is stored comes back, and nothing else is believed.

use phalanx::{Error, Estimator, draw_silhouette};
use proptest::prelude::*;

use super::desk::{ESTIMATOR, FROM_TOP, estimate, masks, rig, top, unseen};
use crate::property;

const HEADER: usize = 24;

fn bytes() -> Vec<u8> {
    FROM_TOP.to_bytes().unwrap()
}

/// The payload under a header that vouches for it.
fn sealed(payload: &[u8]) -> Vec<u8> {
    let mut bytes = bytes()[..12].to_vec();
    bytes.extend((payload.len() as u64).to_le_bytes());
    bytes.extend(crc32fast::hash(payload).to_le_bytes());
    bytes.extend(payload);
    bytes
}

/// A model that is read although it was tampered with must be usable or say why not.
fn try_out(bytes: &[u8]) {
    let Ok(estimator) = Estimator::from_bytes(bytes) else {
        return;
    };
    if let Ok(found) = estimate(&estimator, &masks(&top(), &unseen()[2])) {
        let numbers = || found.pose.0.iter().chain(found.std.iter().flatten());
        assert!(numbers().all(|number| number.is_finite()), "{found:?}");
        assert!(found.joints.iter().all(|joint| joint.is_finite()), "{found:?}");
    }
    let rest = estimator.rig().volume.rest_frame();
    for camera in &estimator.rig().cameras {
        // An error or a picture, but an end.
        let _ = draw_silhouette(camera, estimator.hand(), &unseen()[2], &rest);
    }
}

#[test]
fn what_is_saved_is_loaded() {
    for estimator in [&*ESTIMATOR, &*FROM_TOP] {
        let bytes = estimator.to_bytes().unwrap();
        let loaded = Estimator::from_bytes(&bytes).unwrap();
        assert_eq!(&loaded, estimator);
        assert!(loaded.to_bytes().unwrap() == bytes);
    }
    let loaded = Estimator::from_bytes(&ESTIMATOR.to_bytes().unwrap()).unwrap();
    for pose in unseen() {
        let masks = masks(&rig(), &pose);
        assert_eq!(estimate(&loaded, &masks).unwrap(), estimate(&ESTIMATOR, &masks).unwrap());
    }
    // The helper that the tests below tamper with is itself right.
    assert!(sealed(&bytes()[HEADER..]) == bytes());
}

#[test]
fn truncated_or_longer_files_are_refused() {
    let bytes = bytes();
    let lengths = (0..64).chain((64..bytes.len()).step_by(97)).chain([bytes.len() - 1]);
    for length in lengths {
        let error = Estimator::from_bytes(&bytes[..length]).unwrap_err();
        match error {
            Error::ForeignFile { .. } => assert!(length < 8, "{length}"),
            Error::FileLength { found, .. } => assert_eq!(found, length as u64),
            other => panic!("{length} bytes: {other}"),
        }
    }
    let longer = [bytes.as_slice(), &[0]].concat();
    assert!(matches!(Estimator::from_bytes(&longer), Err(Error::FileLength { .. })));
    // A payload that is cut and vouched for again.
    for length in (0..bytes.len() - HEADER).step_by(211) {
        let error = Estimator::from_bytes(&sealed(&bytes[HEADER..][..length])).unwrap_err();
        assert!(matches!(error, Error::FileContent { .. }), "{length} bytes: {error}");
    }
    let error = Estimator::from_bytes(&sealed(&longer[HEADER..])).unwrap_err();
    assert!(error.to_string().contains("1 bytes are left over"), "{error}");
}

#[test]
fn a_flipped_bit_is_noticed() {
    let bytes = bytes();
    let flips = (0..HEADER * 8).chain((HEADER * 8..bytes.len() * 8).step_by(1231));
    for bit in flips {
        let mut flipped = bytes.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        let error = Estimator::from_bytes(&flipped).unwrap_err();
        let expected = match bit / 8 {
            0..8 => matches!(error, Error::ForeignFile { .. }),
            8..12 => matches!(error, Error::FileVersion { known: 11, .. }),
            12..20 => matches!(error, Error::FileLength { .. }),
            _ => matches!(error, Error::FileChecksum { .. }),
        };
        assert!(expected, "bit {bit}: {error}");
    }
}

#[test]
fn other_files_and_formats_are_refused_by_name() {
    let message = |bytes: &[u8]| Estimator::from_bytes(bytes).unwrap_err().to_string();
    for foreign in [&b""[..], b"PHALANX", b"\x89PNG\r\n\x1a\n and so on", &[0; 4096]] {
        assert_eq!(message(foreign), "not a phalanx model: the file does not begin with its mark");
    }
    let mut newer = bytes();
    newer[8..12].copy_from_slice(&12_u32.to_le_bytes());
    let expected = "the model has format 12; this version reads format 11: train again, or use the \
                    version that wrote it";
    assert_eq!(message(&newer), expected);
    let mut endless = bytes();
    endless[12..20].copy_from_slice(&u64::MAX.to_le_bytes());
    assert!(matches!(Estimator::from_bytes(&endless), Err(Error::FileLength { .. })));
}

/// The largest number that a variable-length integer of the payload can hold.
const HUGE: [u8; 10] = [0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01];

#[test]
fn no_length_is_believed() {
    let bytes = bytes();
    let payload = &bytes[HEADER..];
    // The rig, the hand and the codebook's head lie at the beginning; lengths of the regressor's
    // vectors anywhere.
    for at in (0..700).chain((700..payload.len()).step_by(173)) {
        let inserted = [&payload[..at], &HUGE, &payload[at + 1..]].concat();
        try_out(&sealed(&inserted));
        for byte in [0x00, 0x7f, 0x80, 0xff] {
            let mut changed = payload.to_vec();
            changed[at] = byte;
            try_out(&sealed(&changed));
        }
    }
}

/// A change of the payload: at a share of its length, these bytes over or between those there.
fn change() -> impl Strategy<Value = (f64, Vec<u8>, bool)> {
    let huge = Just(HUGE.to_vec());
    let number = prop::num::f64::ANY.prop_map(|number| number.to_le_bytes().to_vec());
    let noise = prop::collection::vec(any::<u8>(), 1..12);
    (0.0..1.0, prop_oneof![huge, number, noise], any::<bool>())
}

proptest! {
    #![proptest_config(property::cases(256))]

    #[test]
    fn tampered_payloads_are_refused_or_usable(
        changes in prop::collection::vec(change(), 1..4),
        near_the_front in any::<bool>(),
    ) {
        let mut payload = bytes()[HEADER..].to_vec();
        for (share, with, between) in changes {
            let reach = if near_the_front { 700 } else { payload.len() };
            let at = (share * reach as f64) as usize;
            let end = if between { at } else { (at + with.len()).min(payload.len()) };
            payload.splice(at..end, with);
        }
        try_out(&sealed(&payload));
    }

    #[test]
    fn any_bytes_are_refused(noise in prop::collection::vec(any::<u8>(), 0..400)) {
        prop_assert!(Estimator::from_bytes(&noise).is_err());
        prop_assert!(Estimator::from_bytes(&sealed(&noise)).is_err());
    }
}
