//! The three levels at which views are joined, tried on an arc of points that turns about its centre.
//! Each of three cameras, evenly around it, sees how far to the left or right the points are; pooling
//! forgets which camera saw what. What is learnt is to look up the most similar sample.
//! `cargo run --release -p phalanx-multiview --example levels`

use std::f64::consts::TAU;

use phalanx_multiview::{CodebookTrainer, Error, Scratch, mean};

const VIEWS: usize = 3;
/// Points of the arc, and bins of the histogram that tells where one of them is seen.
const POINTS: usize = 12;
const BINS: usize = 8;

type Sample = Vec<Vec<f32>>;

/// A direction as a point of the unit circle, so that directions can be averaged.
type Direction = [f64; 2];

fn main() -> Result<(), Error> {
    let angles: Vec<f64> = (0..360).map(|degree| f64::from(degree).to_radians()).collect();
    let tests: Vec<f64> =
        angles.iter().step_by(7).map(|angle| angle + 0.4_f64.to_radians()).collect();
    let known: Vec<Sample> = angles.iter().copied().map(sample).collect();
    let unknown: Vec<Sample> = tests.iter().copied().map(sample).collect();
    let vocabulary = CodebookTrainer { centres: 30, ..CodebookTrainer::default() };

    let pooled = vocabulary.pool(&known, BINS)?;
    let low =
        look_up(&known, &unknown, pooled.dim(), |s, scratch, x| pooled.describe(s, scratch, x))?;
    let joined = vocabulary.fit(&known, BINS)?;
    let middle =
        look_up(&known, &unknown, joined.dim(), |s, scratch, x| joined.describe(s, scratch, x))?;
    let mut alone = Vec::new();
    for view in 0..VIEWS {
        let of_view = |samples: &[Sample]| samples.iter().map(|s| vec![s[view].clone()]).collect();
        let (known, unknown): (Vec<Sample>, Vec<Sample>) = (of_view(&known), of_view(&unknown));
        let one = vocabulary.fit(&known, BINS)?;
        alone.push(look_up(&known, &unknown, one.dim(), |s, scratch, x| {
            one.describe(s, scratch, x)
        })?);
    }
    let by_views =
        (0..tests.len()).map(|test| mean(&[alone[0][test], alone[1][test], alone[2][test]]));
    let high =
        by_views.map(|found| found.map(|xy| [xy[0], xy[1]])).collect::<Result<Vec<_>, _>>()?;

    let levels = [
        ("one view", &alone[0]),
        ("low: pooled", &low),
        ("intermediate: joined", &middle),
        ("high: averaged", &high),
    ];
    for (name, found) in levels {
        println!("{name:21} {:5.1} degrees off", error(found, &tests));
    }
    Ok(())
}

/// Where each camera sees each point of the arc: a histogram with most in the bin of the place.
fn sample(angle: f64) -> Sample {
    let seen = |view: usize, point: usize| {
        let across =
            (angle + 0.012 * (point * point) as f64 - TAU * view as f64 / VIEWS as f64).cos();
        let at = f64::midpoint(across, 1.0) * (BINS - 1) as f64;
        let heights: Vec<f64> = (0..BINS).map(|bin| (-(bin as f64 - at).powi(2)).exp()).collect();
        let sum: f64 = heights.iter().sum();
        heights.into_iter().map(move |height| (height / sum) as f32)
    };
    (0..VIEWS).map(|view| (0..POINTS).flat_map(|point| seen(view, point)).collect()).collect()
}

/// For each unknown sample the direction of the known one with the most similar description.
fn look_up(
    known: &[Sample],
    unknown: &[Sample],
    dim: usize,
    describe: impl Fn(&[Vec<f32>], &mut Scratch, &mut [f64]) -> Result<(), Error>,
) -> Result<Vec<Direction>, Error> {
    let mut scratch = Scratch::default();
    let mut described = |samples: &[Sample]| {
        let of_one = |sample: &Sample| {
            let mut x = vec![0.0; dim];
            describe(sample, &mut scratch, &mut x).map(|()| x)
        };
        samples.iter().map(of_one).collect::<Result<Vec<_>, _>>()
    };
    let (known, unknown) = (described(known)?, described(unknown)?);
    let nearest = |x: &Vec<f64>| {
        let distance = |k: usize| known[k].iter().zip(x).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let best = (0..known.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        let (sin, cos) = (best.unwrap_or_default() as f64).to_radians().sin_cos();
        [cos, sin]
    };
    Ok(unknown.iter().map(nearest).collect())
}

/// The mean angle between what was found and the truth, degrees.
fn error(found: &[Direction], truth: &[f64]) -> f64 {
    let off = |([cos, sin], angle): (&Direction, &f64)| {
        let turned = (sin.atan2(*cos) - angle).rem_euclid(TAU);
        turned.min(TAU - turned).to_degrees()
    };
    found.iter().zip(truth).map(off).sum::<f64>() / truth.len() as f64
}
