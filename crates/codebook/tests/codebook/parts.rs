//! Codebooks from parts, to bytes and back; and bytes that are no codebook.

use phalanx_codebook::{Codebook, Error};
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::histograms::{DIM, histograms};
use crate::property;

fn codebook() -> Codebook {
    Codebook::from_parts(histograms(33, 4), DIM, 0.09).expect("a codebook")
}

#[test]
fn parts_and_bytes_give_the_codebook_back() {
    let codebook = codebook();
    let (centres, dim) = (codebook.centres().to_vec(), codebook.dim());
    assert_eq!((centres.len(), dim, codebook.len()), (33 * DIM, DIM, 33));
    assert_eq!(Codebook::from_parts(centres, dim, codebook.scale()).as_ref(), Ok(&codebook));
    let bytes = postcard::to_stdvec(&codebook).expect("bytes");
    assert_eq!(postcard::from_bytes::<Codebook>(&bytes).expect("a codebook"), codebook);
    let text = serde_json::to_string(&codebook).expect("text");
    assert_eq!(serde_json::from_str::<Codebook>(&text).expect("a codebook"), codebook);
}

#[test]
fn hostile_parts_are_refused_by_name() {
    let from = |centres: &[f32], dim, scale| {
        Codebook::from_parts(centres.to_vec(), dim, scale).expect_err("a refusal")
    };
    let good = [0.5, 0.5, 1.0, 0.0];
    assert_eq!(from(&[], 2, 0.1), Error::Empty { what: "centre" });
    for dim in [0, 3, usize::MAX] {
        assert_eq!(from(&good, dim, 0.1), Error::Shape { what: "centre", values: 4, dim });
    }
    for scale in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(from(&good, 2, scale), Error::BadScale { scale });
    }
    assert!(matches!(from(&good, 2, f64::NAN), Error::BadScale { .. }));
    assert!(matches!(from(&[0.5, 0.5, 2.0, 0.0], 2, 0.1), Error::NotNormalised { index: 1, .. }));
    assert!(matches!(from(&[0.5, 0.5, 2.0, -1.0], 2, 0.1), Error::BadHeight { index: 1, .. }));
}

#[test]
fn hostile_text_is_refused() {
    let read = |value: Value| serde_json::from_value::<Codebook>(value);
    assert!(
        read(json!({ "metric": "ChiSquared", "dim": 2, "scale": 0.1, "centres": [0.5, 0.5] }))
            .is_ok()
    );
    assert!(
        read(json!({ "metric": "ChiSquared", "dim": 3, "scale": 0.1, "centres": [0.5, 0.5] }))
            .is_err()
    );
    assert!(
        read(json!({ "metric": "ChiSquared", "dim": 2, "scale": -0.1, "centres": [0.5, 0.5] }))
            .is_err()
    );
    assert!(
        read(json!({ "metric": "ChiSquared", "dim": 2, "scale": 0.1, "centres": [0.5, 0.9] }))
            .is_err()
    );
    assert!(read(json!({ "metric": "ChiSquared", "dim": 2, "scale": 0.1 })).is_err());
}

proptest! {
    #![proptest_config(property::cases(256))]

    /// Cut short or with a byte changed, a codebook is refused or is one that its parts allow.
    #[test]
    fn damaged_bytes_never_panic(cut: prop::sample::Index, at: prop::sample::Index, byte: u8) {
        let bytes = postcard::to_stdvec(&codebook()).expect("bytes");
        prop_assert!(postcard::from_bytes::<Codebook>(&bytes[..cut.index(bytes.len())]).is_err());
        let mut damaged = bytes.clone();
        damaged[at.index(bytes.len())] = byte;
        if let Ok(read) = postcard::from_bytes::<Codebook>(&damaged) {
            prop_assert!(Codebook::from_parts(read.centres().to_vec(), read.dim(), read.scale()).is_ok());
        }
    }

    #[test]
    fn any_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = postcard::from_bytes::<Codebook>(&bytes);
    }
}
