//! What becomes of a descriptor when a camera drops out: the low level describes what is left in the
//! same numbers, the intermediate one refuses, the high level averages fewer.
//! `cargo run -p phalanx-multiview --example missing_view`

use phalanx_multiview::{CodebookTrainer, Error, Estimate, Scratch, inverse_variance};

fn main() -> Result<(), Error> {
    // 60 samples of three views, six 4-bin histograms each.
    let histogram = |k: usize| {
        let [a, b, c] = [k % 7, k % 5, k % 3].map(|part| part as f32 / 18.0);
        [a, b, c, 1.0 - a - b - c]
    };
    let view = |i: usize, v: usize| (i..i + 6).flat_map(|k| histogram(k + 11 * v)).collect();
    let samples: Vec<Vec<Vec<f32>>> =
        (0..60).map(|i| (0..3).map(|v| view(i, v)).collect()).collect();
    let vocabulary = CodebookTrainer { centres: 18, ..CodebookTrainer::default() };
    let (all, two) = (&samples[0][..], &samples[0][..2]);
    let mut scratch = Scratch::default();

    let pooled = vocabulary.pool(&samples, 4)?;
    let (mut of_all, mut of_two) = (vec![0.0; 18], vec![0.0; 18]);
    pooled.describe(all, &mut scratch, &mut of_all)?;
    pooled.describe(two, &mut scratch, &mut of_two)?;
    let moved: f64 = of_all.iter().zip(&of_two).map(|(a, b)| (a - b).abs()).sum::<f64>() / 2.0;
    println!("low: {:.0} % of the votes move", 100.0 * moved);

    let joined = vocabulary.fit(&samples, 4)?;
    let refusal = joined.describe(two, &mut scratch, &mut of_two).err();
    println!("intermediate: {}", refusal.map_or("described".into(), |error| error.to_string()));

    let estimates = [(30.0, 2.0), (34.0, 4.0), (33.0, 2.0)].map(|(mean, std)| ([mean], [std]));
    for views in [3, 2] {
        let views: Vec<_> =
            estimates[..views].iter().map(|(mean, std)| Estimate { mean, std }).collect();
        let (mean, std) = inverse_variance(&views)?;
        println!("high, of {}: {:.1} ± {:.1} degrees", views.len(), mean[0], std[0]);
    }
    Ok(())
}
