//! The perceptron: what it learns, what it says of itself, what it refuses.

use faer::{Mat, MatRef};
use phalanx_rvm::{
    AffineMap, AffineMapParts, BlockPca, Error, FeatureBlock, Fit, IncompleteFit, MissingInputs,
    Mlp, MlpParts, MlpTrainer, PcaMlp, Regressor, Scratch, random_subset,
};
use proptest::prelude::*;

use crate::problems::Source;
use crate::property;

fn small() -> MlpTrainer {
    MlpTrainer { hidden: vec![16, 16], epochs: 30, batch: 32, rate: 5e-3, dropout: 0.0, seed: 3 }
}

fn fit(fitter: &MlpTrainer, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Fit<Mlp> {
    fitter.fit(x, y).expect("a network")
}

fn predict(network: &Mlp, x: MatRef<'_, f64>) -> (Mat<f64>, Vec<f64>) {
    let (mut mean, mut std) = (vec![0.0; network.outputs()], vec![0.0; network.outputs()]);
    let (mut scratch, mut all) = (Scratch::default(), Mat::zeros(network.outputs(), x.ncols()));
    for t in 0..x.ncols() {
        let input: Vec<f64> = x.col(t).iter().copied().collect();
        network.predict_into(&input, &mut scratch, &mut mean, &mut std).unwrap();
        all.col_as_slice_mut(t).copy_from_slice(&mean);
    }
    (all, std)
}

/// Two targets of two inputs.
fn bent(seed: u64, samples: usize) -> (Mat<f64>, Mat<f64>) {
    let x = Source::new(seed).matrix(2, samples);
    let y = Mat::from_fn(2, samples, |j, t| match j {
        0 => (2.0 * x[(0, t)]).sin() + x[(1, t)],
        _ => x[(0, t)] * x[(1, t)],
    });
    (x, y)
}

proptest! {
    #![proptest_config(property::cases(24))]

    /// Deviations are the root mean square errors of one sample in 16.
    #[test]
    fn deviations_are_of_samples_that_were_not_learnt_from(seed in any::<u64>()) {
        let (x, y) = bent(seed, 320);
        let (mean, std) = predict(&fit(&small(), x.as_ref(), y.as_ref()).model, x.as_ref());
        for (j, std) in std.into_iter().enumerate() {
            let held_out = random_subset(320, 20, small().seed);
            let squares = held_out.into_iter().map(|t| (mean[(j, t)] - y[(j, t)]).powi(2));
            let expected = (squares.sum::<f64>() / 20.0).sqrt();
            prop_assert!((std - expected).abs() < 1e-4 * (1.0 + expected), "{} {}", std, expected);
        }
    }

    /// Units do not matter: neither those of the inputs together, nor those of each target, however
    /// far it is from zero.
    #[test]
    fn units_do_not_matter(seed in any::<u64>(), scale in -40..40_i32, shift in -1e5..1e5_f64) {
        let (x, y) = bent(seed, 200);
        let scale = 2.0_f64.powi(scale); // exact
        let (plain, _) = predict(&fit(&small(), x.as_ref(), y.as_ref()).model, x.as_ref());
        let other_x = Mat::from_fn(2, 200, |i, t| scale * x[(i, t)]);
        let other_y = Mat::from_fn(2, 200, |j, t| scale * (shift + y[(j, t)]));
        let other = fit(&small(), other_x.as_ref(), other_y.as_ref());
        let (other, _) = predict(&other.model, other_x.as_ref());
        for t in 0..200 {
            for j in 0..2 {
                let back = other[(j, t)] / scale - shift;
                // Steps are many, and the rounding of the shifted targets grows with them.
                prop_assert!((back - plain[(j, t)]).abs() < 0.05, "{} {}", back, plain[(j, t)]);
            }
        }
    }

    /// The components are the inputs turned: what is kept of a block has a total variance of 1, and
    /// with all components distances keep their proportions.
    #[test]
    fn components_turn_and_scale_blocks(seed in any::<u64>(), first in 1..4_usize) {
        let x = Source::new(seed).matrix(first + 3, 60);
        let blocks = [first, 3].map(|inputs| FeatureBlock { inputs, components: inputs });
        let components = BlockPca::fit(x.as_ref(), &blocks).unwrap();
        prop_assert_eq!((components.inputs(), components.outputs()), (first + 3, first + 3));
        let z = components.apply(x.as_ref()).unwrap();
        for (start, count) in [(0, first), (first, 3)] {
            let own = z.subrows(start, count);
            prop_assert!((own.squared_norm_l2() / 60.0 - 1.0).abs() < 1e-4);
            let apart = |m: MatRef<'_, f64>, t: usize| (m.col(t) - m.col(0)).norm_l2();
            let all = |m: MatRef<'_, f64>| (1..60).map(|t| apart(m, t)).sum::<f64>();
            let raw = x.subrows(start, count);
            let scale = all(own) / all(raw);
            // Components are single-precision numbers of about 1.
            prop_assert!((1..60).all(|t| (apart(own, t) - scale * apart(raw, t)).abs() < 1e-4));
        }
    }
}

#[test]
fn a_bent_surface_is_learnt() {
    let (x, y) = bent(1, 3000);
    let fitter = MlpTrainer { hidden: vec![32, 32], epochs: 60, ..small() };
    let fitted = fit(&fitter, x.as_ref(), y.as_ref());
    let (new_x, new_y) = bent(2, 300);
    let (mean, _) = predict(&fitted.model, new_x.as_ref());
    let error = (&mean - &new_y).norm_l1() / 600.0;
    assert!(error < 0.05, "{error}");
    let course = &fitted.report.traces[0].objective;
    assert_eq!(course.len(), 60);
    assert!(course[59] < 0.3 * course[0], "{course:?}");
}

#[test]
fn any_number_of_threads_and_dropout_give_the_same_bits() {
    // Parts of a batch, of the weights and of the judges, none of them whole.
    let (x, y) = bent(5, 5000);
    let fitter =
        MlpTrainer { hidden: vec![150, 150], batch: 300, dropout: 0.3, epochs: 2, ..small() };
    let of_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| fit(&fitter, x.as_ref(), y.as_ref()))
    };
    assert!(of_threads(1) == of_threads(3));
    let other = fit(&MlpTrainer { seed: 4, ..fitter.clone() }, x.as_ref(), y.as_ref());
    assert!(other != of_threads(1));
}

#[test]
fn what_does_not_vary_stays_and_has_no_deviation() {
    let (x, mut y) = bent(7, 64);
    y.row_mut(1).fill(4.5);
    let (mean, std) = predict(&fit(&small(), x.as_ref(), y.as_ref()).model, x.as_ref());
    assert!((0..64).all(|t| mean[(1, t)] == 4.5) && std[1] == f64::INFINITY && std[0] > 0.0);
    y.fill(-1.25);
    let (mean, std) = predict(&fit(&small(), x.as_ref(), y.as_ref()).model, x.as_ref());
    assert!(mean.col_iter().all(|c| c.iter().all(|&v| v == -1.25)) && std == [f64::INFINITY; 2]);
    // One sample is the mean.
    let one = fit(&small(), x.subcols(0, 1), mean.subcols(0, 1));
    assert_eq!(predict(&one.model, x.subcols(0, 1)).0, mean.subcols(0, 1));
}

#[test]
fn what_cannot_be_learnt_from_is_named() {
    let (x, y) = bent(9, 40);
    let refused = |fitter: MlpTrainer| fitter.fit(x.as_ref(), y.as_ref()).unwrap_err().to_string();
    for (fitter, name) in [
        (MlpTrainer { epochs: 0, ..small() }, "epochs"),
        (MlpTrainer { batch: 0, ..small() }, "batch"),
        (MlpTrainer { hidden: vec![4, 0], ..small() }, "hidden"),
        (MlpTrainer { rate: f64::NAN, ..small() }, "rate"),
        (MlpTrainer { dropout: 1.0, ..small() }, "dropout"),
    ] {
        assert!(refused(fitter).starts_with(name), "{name}");
    }
    let fewer = small().fit(x.as_ref(), y.subcols(0, 39));
    assert!(matches!(fewer, Err(Error::Shape { .. })));
    let mut spoilt = x.clone();
    spoilt[(1, 3)] = f64::INFINITY;
    let bad = small().fit(spoilt.as_ref(), y.as_ref()).unwrap_err();
    assert!(matches!(bad, Error::BadValue { what: "x", row: 1, column: 3, .. }), "{bad}");
    let none = small().fit(x.subcols(0, 0), y.subcols(0, 0));
    assert!(matches!(none, Err(Error::Empty { .. })));
}

fn layer(inputs: usize, outputs: usize) -> AffineMap {
    let (matrix, offset) = (vec![0.5; inputs * outputs], vec![0.0; outputs]);
    AffineMap::from_parts(AffineMapParts { inputs, matrix, offset }).unwrap()
}

/// Of layers and deviations, in standardised units.
fn network(layers: Vec<AffineMap>, std: Vec<f64>) -> Result<Mlp, Error> {
    let (mean, scale) = (vec![0.0; std.len()], vec![1.0; std.len()]);
    Mlp::from_parts(MlpParts { layers, mean, scale, std })
}

#[test]
fn parts_that_do_not_fit_are_refused() {
    assert!(network(vec![layer(3, 2), layer(2, 1)], vec![0.1]).is_ok());
    for (layers, std) in [
        (vec![], vec![]),
        (vec![layer(3, 2), layer(3, 1)], vec![0.1]),
        (vec![layer(3, 2)], vec![0.1]),
        (vec![layer(3, 1)], vec![-0.1]),
        (vec![layer(3, 1)], vec![f64::NAN]),
    ] {
        assert!(network(layers, std).is_err());
    }
    let network = network(vec![layer(3, 1)], vec![0.1]).unwrap();
    let spoils: [fn(&mut MlpParts); 3] = [
        |parts| parts.mean.push(0.0),
        |parts| parts.scale = vec![-1.0],
        |parts| parts.mean = vec![f64::NAN],
    ];
    for (k, spoil) in spoils.into_iter().enumerate() {
        let mut parts = network.parts().clone();
        spoil(&mut parts);
        assert!(Mlp::from_parts(parts).is_err(), "spoil {k}");
    }
    let components = |outputs| BlockPca::from_parts(vec![layer(2, 1), layer(1, outputs)]);
    assert!(PcaMlp::from_parts(components(1), network.clone()).is_err());
    let own = PcaMlp::from_parts(components(2), network).unwrap();
    assert_eq!((own.inputs(), own.outputs()), (3, 1));
    // So many inputs that their number overflows, of which none is read.
    let nothing = AffineMapParts { inputs: usize::MAX, matrix: vec![], offset: vec![] };
    let nothing = AffineMap::from_parts(nothing).unwrap();
    assert_eq!(BlockPca::from_parts(vec![nothing.clone(), nothing]).inputs(), usize::MAX);
    let (mut mean, mut std) = ([0.0], [0.0]);
    let short = own.predict_into(&[1.0, 2.0], &mut Scratch::default(), &mut mean, &mut std);
    assert!(matches!(short, Err(Error::Shape { .. })));
    own.predict_into(&[1.0, 2.0, 4.0], &mut Scratch::default(), &mut mean, &mut std).unwrap();
    assert_eq!((mean, std), ([0.5 * (1.5 + 2.0 + 2.0)], [0.1]));
}

#[cfg(feature = "serde")]
#[test]
fn stored_networks_come_back_and_spoilt_ones_do_not() {
    let network = network(vec![layer(3, 2), layer(2, 1)], vec![0.1]).unwrap();
    let own = PcaMlp::from_parts(BlockPca::from_parts(vec![layer(4, 3)]), network);
    let own = own.unwrap();
    let bytes = postcard::to_allocvec(&own).unwrap();
    assert_eq!(postcard::from_bytes::<PcaMlp>(&bytes).unwrap(), own);
    // A first block of five inputs, of which there are four times three numbers.
    let mut spoilt = bytes.clone();
    assert_eq!(spoilt[1], 4);
    spoilt[1] = 5;
    assert!(postcard::from_bytes::<PcaMlp>(&spoilt).is_err());
    assert!(postcard::from_bytes::<PcaMlp>(&bytes[..bytes.len() - 1]).is_err());
}

/// Two targets of two inputs, of which either may be missing and is then read as 3.
fn incomplete(seed: u64) -> (Fit<Mlp>, Fit<Mlp>, IncompleteFit) {
    let (x, y) = bent(seed, 1600);
    let single = Mat::from_fn(2, 1600, |i, t| x[(i, t)] as f32);
    let missing =
        MissingInputs { groups: vec![0, 1], stand_ins: vec![3.0; 2], present: vec![1, 2] };
    let fitter = small();
    let whole = fitter.fit_single(single.as_ref(), y.as_ref(), &mut |_| ()).unwrap();
    let (first, second) =
        fitter.fit_incomplete(single.as_ref(), y.as_ref(), &missing, 30, &mut |_| ()).unwrap();
    (whole, first, second)
}

#[test]
fn what_learns_on_without_inputs_is_first_what_it_was() {
    let (whole, first, _) = incomplete(5);
    assert_eq!(first.model, whole.model);
    assert_eq!(first.report, whole.report);
}

/// The first target is mostly the first input's; each set's deviation is that of what it tells.
#[test]
fn what_is_missing_is_not_needed_and_deviations_say_so() {
    let (_, _, IncompleteFit { model, deviations }) = incomplete(6);
    let (x, y) = bent(7, 400);
    for (set, deviations) in deviations.iter().enumerate() {
        let seen = Mat::from_fn(2, 400, |i, t| if i == set { x[(i, t)] } else { 3.0 });
        let (mean, _) = predict(&model, seen.as_ref());
        let squares = (0..400).map(|t| (mean[(0, t)] - y[(0, t)]).powi(2)).sum::<f64>();
        let error = (squares / 400.0).sqrt();
        assert!((error / deviations[0] - 1.0).abs() < 0.35, "{set}: {error} {deviations:?}");
    }
    let ignored = Mat::from_fn(2, 1, |i, _| [0.4, 3.0][i]);
    assert!((predict(&model, ignored.as_ref()).0[(0, 0)] - 0.8_f64.sin()).abs() < 0.2);
    assert!(deviations[0][0] < deviations[1][0], "{deviations:?}");
}

#[test]
fn inputs_that_cannot_be_missing_are_refused() {
    let (x, y) = bent(1, 40);
    let single = Mat::from_fn(2, 40, |i, t| x[(i, t)] as f32);
    let good = MissingInputs { groups: vec![0, 1], stand_ins: vec![0.0; 2], present: vec![1] };
    let spoils: [fn(&mut MissingInputs); 4] = [
        |missing| missing.groups = vec![0],
        |missing| missing.groups = vec![0, 64],
        |missing| missing.stand_ins = vec![f64::NAN; 2],
        |missing| missing.present = Vec::new(),
    ];
    for spoil in spoils {
        let mut missing = good.clone();
        spoil(&mut missing);
        let fitted = small().fit_incomplete(single.as_ref(), y.as_ref(), &missing, 2, &mut |_| ());
        assert!(fitted.is_err(), "{missing:?}");
    }
}
