//! Draws the README's figure: K-means' centres and balls of a fixed radius for the same samples.
//!
//! `cargo run -p phalanx-codebook --example centres > crates/codebook/figures/centres.svg`

use std::fmt::Write;

use phalanx_codebook::{Codebook, Error, FixedRadius, KMeans, Metric};
use rand_core::Rng;
use rand_pcg::Pcg64;

/// Width and height of each of the two pictures.
const SIZE: f32 = 320.0;
const CENTRES: usize = 60;

/// A dense spot among thinly spread samples.
fn samples() -> Vec<f32> {
    let mut rng = Pcg64::new(7, 0);
    let mut uniform = || (rng.next_u32() >> 8) as f32 / (1_u32 << 24) as f32;
    let mut samples = Vec::new();
    for i in 0..2000 {
        // Four uniform numbers make a bell.
        let mut normal = || (0..4).map(|_| uniform() - 0.5).sum::<f32>();
        let spread = if i % 6 == 0 { 0.24 } else { 0.04 };
        samples.extend([spread * normal(), spread * normal()]);
    }
    samples
}

/// The codebook of balls whose number comes nearest to that of K-means' centres.
fn balls(samples: &[f32]) -> Result<Codebook, Error> {
    let mut radius = 1.0;
    loop {
        let cover = FixedRadius { radius, metric: Metric::Euclidean, ..FixedRadius::default() };
        let codebook = cover.fit(samples, 2)?;
        if codebook.len() >= CENTRES {
            return Ok(codebook);
        }
        radius *= 0.95;
    }
}

fn draw(samples: &[f32], codebook: &Codebook, left: f32) {
    let place = |point: &[f32]| (left + SIZE * (point[0] + 0.5), SIZE * (point[1] + 0.5));
    let mut dots = String::new();
    for (x, y) in samples.chunks_exact(2).map(place) {
        write!(dots, "M{x:.0} {y:.0}h0").expect("a string takes everything");
    }
    println!(r##"<path d="{dots}" stroke="#9aa7b5" stroke-width="2" stroke-linecap="round"/>"##);
    for (x, y) in codebook.centres().chunks_exact(2).map(place) {
        println!(r##"<circle cx="{x:.1}" cy="{y:.1}" r="4" fill="#c8451b" stroke="#fff"/>"##);
    }
}

fn main() -> Result<(), Error> {
    let samples = samples();
    let kmeans = KMeans { centres: CENTRES, metric: Metric::Euclidean, ..KMeans::default() };
    let (width, height) = (2.0 * SIZE + 20.0, SIZE + 24.0);
    println!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" font-size="13">"#
    );
    println!(r##"<rect width="100%" height="100%" fill="#fff"/>"##);
    draw(&samples, &kmeans.fit(&samples, 2)?.codebook, 0.0);
    draw(&samples, &balls(&samples)?, SIZE + 20.0);
    for (left, label) in [(0.0, "K-means"), (SIZE + 20.0, "a fixed radius")] {
        println!(
            r#"<text x="{}" y="{}" text-anchor="middle">{label}</text>"#,
            left + SIZE / 2.0,
            SIZE + 16.0
        );
    }
    println!("</svg>");
    Ok(())
}
