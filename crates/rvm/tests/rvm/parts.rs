//! Models in and out of their parts and bytes, and single against batch predictions.

use phalanx_rvm::{Basis, Error, Model, ModelParts, Posterior, Regressor, Scratch};
use proptest::prelude::*;

use crate::problems::{FITTERS, smooth};
use crate::property;

proptest! {
    #![proptest_config(property::cases(24))]

    #[test]
    fn parts_rebuild_the_model(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 5, 3, 30);
        for (_, fit) in FITTERS {
            let model = fit(x.as_ref(), y.as_ref())?.model;
            let rebuilt = Model::from_parts(model.clone().into_parts())?;
            prop_assert_eq!(rebuilt, model);
        }
    }

    #[test]
    fn one_sample_is_predicted_as_many_are(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 5, 3, 30);
        let mut scratch = Scratch::default();
        for (_, fit) in FITTERS {
            let model = fit(x.as_ref(), y.as_ref())?.model;
            let (means, stds) = model.predict_with_std(x.as_ref())?;
            prop_assert_eq!(&model.predict(x.as_ref())?, &means);
            let (mut mean, mut std) = ([0.0; 3], [0.0; 3]);
            model.predict_into(x.col_as_slice(11), &mut scratch, &mut mean, &mut std)?;
            prop_assert_eq!(means.col_as_slice(11), mean);
            prop_assert_eq!(stds.col_as_slice(11), std);
        }
    }

    #[cfg(feature = "serde")]
    #[test]
    fn hostile_bytes_are_refused_or_make_a_model(
        place in any::<prop::sample::Index>(),
        value in any::<u8>(),
        cut in any::<prop::sample::Index>(),
    ) {
        let (x, y) = smooth(4, 5, 3, 30);
        for (_, fit) in FITTERS {
            let model = fit(x.as_ref(), y.as_ref())?.model;
            let mut bytes = postcard::to_stdvec(&model)?;
            prop_assert_eq!(&postcard::from_bytes::<Model>(&bytes)?, &model);
            prop_assert!(postcard::from_bytes::<Model>(&bytes[..cut.index(bytes.len())]).is_err());
            let place = place.index(bytes.len());
            bytes[place] = value;
            if let Ok(model) = postcard::from_bytes::<Model>(&bytes) {
                let x = vec![0.5; model.inputs().min(1000)];
                let (mut mean, mut std) = (vec![0.0; model.outputs()], vec![0.0; model.outputs()]);
                // Whether it predicts is its own business; that it returns is ours.
                let _ = model.predict_into(&x, &mut Scratch::default(), &mut mean, &mut std);
            }
        }
    }
}

/// A change to a model's parts.
type Damage = fn(&mut ModelParts);

#[test]
fn parts_that_do_not_fit_are_named() {
    let (x, y) = smooth(4, 5, 3, 30);
    let damages: [(&str, Damage); 12] = [
        ("features", |p| p.features.reverse()),
        ("features", |p| p.inputs = 1),
        ("outputs", |p| p.outputs = 0),
        ("feature_means", |p| p.feature_means.push(0.0)),
        ("feature_scales", |p| p.feature_scales[0] = 0.0),
        ("column_means", |p| p.column_means[0] = f64::NAN),
        ("weights", |p| p.weights.truncate(1)),
        ("bias", |p| p.bias.clear()),
        ("noise", |p| p.noise[0] = -1.0),
        ("beta", |p| {
            if let Basis::Gaussian { beta, .. } = &mut p.basis {
                *beta = f64::INFINITY;
            }
        }),
        ("centres", |p| {
            if let Basis::Gaussian { centres, .. } = &mut p.basis {
                centres.clear();
            }
        }),
        ("posterior", |p| {
            if let Posterior::Weights(factors) = &mut p.posterior {
                factors[0].columns[0] = 1000;
            }
        }),
    ];
    let bridges = FITTERS.iter().find(|(name, _)| *name == "Agarwal-Triggs, Gaussian").unwrap().1;
    let model = bridges(x.as_ref(), y.as_ref()).unwrap().model;
    for (expected, damage) in damages {
        let mut parts = model.clone().into_parts();
        damage(&mut parts);
        match Model::from_parts(parts) {
            Err(Error::Parts { field, .. }) => assert_eq!(field, expected),
            other => panic!("{expected}: {other:?}"),
        }
    }
}

#[test]
fn public_types_cross_threads() {
    fn crosses<T: Send + Sync>() {}
    crosses::<Model>();
    crosses::<Scratch>();
    crosses::<phalanx_rvm::Fit>();
    crosses::<Error>();
}
