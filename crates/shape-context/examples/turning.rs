//! Turns a hand-like contour and prints how far its shape contexts move, in each orientation.
//!
//! `cargo run --release -p phalanx-shape-context --example turning`

use std::f64::consts::TAU;

use phalanx_shape_context::{Chain, Error, Orientation, ShapeContexts};

/// A palm with four fingers and a thumb, about the origin, its forearm below.
fn hand() -> Vec<[f64; 2]> {
    let fingers = [(-2.6, 1.0), (-2.0, 1.4), (-1.6, 1.6), (-1.2, 1.5), (-0.8, 1.2), (1.57, 1.3)];
    (0..300)
        .map(|i| {
            let angle = TAU * f64::from(i) / 300.0;
            let reach: f64 = fingers
                .iter()
                .map(|(at, reach)| reach * (8.0 * ((angle - at).cos() - 1.0) * 4.0).exp())
                .sum();
            [20.0 * (1.0 + reach) * angle.cos(), 20.0 * (1.0 + reach) * angle.sin()]
        })
        .collect()
}

fn main() -> Result<(), Error> {
    let hand = hand();
    let (sin, cos) = 20.0_f64.to_radians().sin_cos();
    let turn = |[x, y]: [f64; 2]| [cos * x - sin * y, sin * x + cos * y];
    let turned: Vec<_> = hand.iter().copied().map(turn).collect();

    let end = [0.0, 50.0];
    let chain = Chain::Closed;
    let mut contexts = ShapeContexts::new();
    println!("mean χ² between the contexts of a hand and of the same hand turned by 20°");
    for (name, before, after) in [
        ("image axes", Orientation::ImageAxes, Orientation::ImageAxes),
        ("tangent", Orientation::Tangent { chain }, Orientation::Tangent { chain }),
        ("centroid", Orientation::Centroid, Orientation::Centroid),
        ("principal axis", Orientation::PrincipalAxis, Orientation::PrincipalAxis),
        (
            "hand axis",
            Orientation::HandAxis { forearm_end: end },
            Orientation::HandAxis { forearm_end: turn(end) },
        ),
    ] {
        let before = contexts.compute(&hand, before)?.values().to_vec();
        let after = contexts.compute(&turned, after)?.values();
        println!("{name:>14}  {:.3}", chi_squared(&before, after) / hand.len() as f32);
    }
    Ok(())
}

fn chi_squared(a: &[f32], b: &[f32]) -> f32 {
    let term = |(a, b): (&f32, &f32)| (a - b).powi(2) / (a + b).max(f32::MIN_POSITIVE);
    a.iter().zip(b).map(term).sum::<f32>() / 2.0
}
