//! Tells textures apart by bags of small patches, each coding by its own: how often the texture with
//! the nearest code is the right one.
//!
//! `cargo run --release -p phalanx-codebook --example textures`

use phalanx_codebook::{
    AnyEncoder, Encoder, Error, ExpectationMaximisation, Fisher, KMeans, Metric, Scratch,
    SoftAssignment, Vlad, squared_euclidean,
};
use rand_core::Rng;
use rand_pcg::Pcg64;

const PATCH: usize = 8;
const TEXTURES: usize = 12;

/// Strips of noisy waves, cut from a texture: which one sets their two frequencies and their phase
/// to one another.
fn patches(texture: usize, count: usize, seed: u64) -> Vec<f32> {
    let mut rng = Pcg64::new(u128::from(seed), texture as u128);
    let mut uniform = || (rng.next_u32() >> 8) as f32 / (1_u32 << 24) as f32;
    let slow = 0.5 + 0.05 * (texture % 4) as f32;
    let share = 0.3 + 0.1 * (texture / 4) as f32;
    let strip = |_| {
        let start = 40.0 * uniform();
        let wave = |i: usize| {
            let at = start + i as f32;
            (slow * at).sin() + share * (3.1 * slow * at).cos() + 1.6 * (uniform() - 0.5)
        };
        (0..PATCH).map(wave).collect::<Vec<_>>()
    };
    (0..count).flat_map(strip).collect()
}

fn code(coding: &AnyEncoder, samples: &[f32]) -> Result<Vec<f32>, Error> {
    let mut code = vec![0.0; coding.dim()];
    coding.encode(samples, &mut Scratch::default(), &mut code)?;
    Ok(code.into_iter().map(|value| value as f32).collect())
}

fn main() -> Result<(), Error> {
    let training: Vec<f32> = (0..TEXTURES).flat_map(|texture| patches(texture, 500, 1)).collect();
    let codebook = |centres| -> Result<_, Error> {
        let kmeans = KMeans { centres, metric: Metric::Euclidean, ..KMeans::default() };
        Ok(kmeans.fit(&training, PATCH)?.codebook)
    };
    let em = ExpectationMaximisation { components: 16, ..ExpectationMaximisation::default() };
    let counts = |assignment| -> Result<_, Error> {
        Ok(AnyEncoder::SoftHistogram { codebook: codebook(64)?, assignment })
    };
    let codings = [
        ("hard votes, 64 centres", counts(SoftAssignment::HARD)?),
        ("soft votes, 64 centres", counts(SoftAssignment::default())?),
        ("residuals, 16 centres", AnyEncoder::Vlad(Vlad { codebook: codebook(16)? })),
        ("Fisher, 16 Gaussians", AnyEncoder::Fisher(Fisher { mixture: em.fit(&training, PATCH)? })),
    ];
    for (name, coding) in codings {
        let known = (0..TEXTURES)
            .map(|texture| code(&coding, &patches(texture, 500, 2)))
            .collect::<Result<Vec<_>, _>>()?;
        let mut right = 0;
        let trials = 40;
        for trial in 0..TEXTURES * trials {
            let code = code(&coding, &patches(trial % TEXTURES, 60, 100 + trial as u64))?;
            let distances: Vec<f64> =
                known.iter().map(|other| squared_euclidean(&code, other)).collect();
            let nearest =
                (0..TEXTURES).fold(0, |a, b| if distances[b] < distances[a] { b } else { a });
            right += usize::from(nearest == trial % TEXTURES);
        }
        let share = 100.0 * right as f64 / (TEXTURES * trials) as f64;
        println!("{name:24} {:4} numbers  {share:.0} % right", coding.dim());
    }
    Ok(())
}
