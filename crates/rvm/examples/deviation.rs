//! Draws, as an SVG, what a relevance vector machine says of sin(x)/x where it has samples and where
//! it has none: its plain deviation and that of RVM*.
//!
//!     cargo run --release -p phalanx-rvm --example deviation > crates/rvm/deviation.svg

use phalanx_rvm::faer::Mat;
use phalanx_rvm::{ArdRvm, AugmentedRvm, Regressor, Result};
use rand_core::Rng;
use rand_pcg::Pcg64Mcg;

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 330.0;
/// x drawn from −`REACH` to `REACH`.
const REACH: f64 = 20.0;
const POINTS: usize = 400;

fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.sin() / x }
}

/// Where a point of the graph is drawn.
fn place(x: f64, y: f64) -> String {
    let across = (x + REACH) / (2.0 * REACH) * WIDTH;
    let down = HEIGHT * (1.35 - y) / 2.65;
    format!("{across:.1},{down:.1}")
}

fn main() -> Result<()> {
    let mut random = Pcg64Mcg::new(3);
    let mut uniform = || f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5;
    // None between 2 and 7.
    let x = Mat::from_fn(1, 120, |_, _| {
        let along = 15.0 * uniform() - 2.5;
        if along > 2.0 { along + 5.0 } else { along }
    });
    let y = Mat::from_fn(1, 120, |_, t| {
        sinc(x[(0, t)]) + 0.1 * (0..12).map(|_| uniform()).sum::<f64>()
    });
    let model = ArdRvm::default().fit(x.as_ref(), y.as_ref())?.model;
    let kept = model.kept_samples().to_vec();
    let along = |t: usize| REACH * (2.0 * t as f64 / (POINTS - 1) as f64 - 1.0);
    let grid = Mat::from_fn(1, POINTS, |_, t| along(t));
    let (mean, plain) = model.predict_with_std(grid.as_ref())?;
    let (_, augmented) =
        AugmentedRvm::new(model, x.as_ref(), y.as_ref())?.predict_with_std(grid.as_ref())?;

    let band = |std: &Mat<f64>| {
        let edge = |t: usize, sign: f64| place(along(t), mean[(0, t)] + sign * 2.0 * std[(0, t)]);
        let above = (0..POINTS).map(|t| edge(t, 1.0));
        let below = (0..POINTS).rev().map(|t| edge(t, -1.0));
        above.chain(below).collect::<Vec<_>>().join(" ")
    };
    let line = |value: &dyn Fn(usize) -> f64| {
        (0..POINTS).map(|t| place(along(t), value(t))).collect::<Vec<_>>().join(" ")
    };
    println!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" \
         font-family=\"sans-serif\" font-size=\"13\">"
    );
    println!("<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>");
    println!("<polygon points=\"{}\" fill=\"#fbd3a6\"/>", band(&augmented));
    println!("<polygon points=\"{}\" fill=\"#9ec9e8\"/>", band(&plain));
    let truth = line(&|t| sinc(along(t)));
    println!(
        "<polyline points=\"{truth}\" fill=\"none\" stroke=\"#777\" stroke-dasharray=\"5 4\"/>"
    );
    let mean = line(&|t| mean[(0, t)]);
    println!("<polyline points=\"{mean}\" fill=\"none\" stroke=\"#134b73\" stroke-width=\"2\"/>");
    for t in 0..x.ncols() {
        let at = place(x[(0, t)], y[(0, t)]);
        let (across, down) = at.split_once(',').unwrap_or_default();
        println!("<circle cx=\"{across}\" cy=\"{down}\" r=\"2\" fill=\"#333\"/>");
        if kept.contains(&t) {
            println!(
                "<circle cx=\"{across}\" cy=\"{down}\" r=\"6\" fill=\"none\" stroke=\"#c0392b\" \
                 stroke-width=\"2\"/>"
            );
        }
    }
    let labels = [
        ("#134b73", "mean"),
        ("#9ec9e8", "two deviations, plain"),
        ("#fbd3a6", "two deviations, RVM*"),
        ("#c0392b", "vectors kept"),
        ("#777", "sin(x)/x"),
    ];
    for (row, (colour, label)) in labels.iter().enumerate() {
        let down = 20 + 18 * row;
        println!(
            "<rect x=\"12\" y=\"{}\" width=\"14\" height=\"10\" fill=\"{colour}\"/>",
            down - 9
        );
        println!("<text x=\"32\" y=\"{down}\" fill=\"#222\">{label}</text>");
    }
    println!("</svg>");
    Ok(())
}
