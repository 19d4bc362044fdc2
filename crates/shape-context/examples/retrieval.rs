//! Asks of each of many shapes whether the nearest of the others is of the same kind, and draws how
//! two of them match.
//!
//! `cargo run --release -p phalanx-shape-context --example retrieval -- matching.svg`

use std::f64::consts::TAU;
use std::fmt::Write;

use phalanx_shape_context::{Chain, Error, Matcher, Orientation, ShapeContexts, resample};

/// How many shapes of each kind there are.
const EACH: usize = 20;

/// Points along each.
const POINTS: f64 = 100.0;

/// Directions and reaches of a shape's lobes.
type Kind = (&'static str, &'static [(f64, f64)]);

const KINDS: [Kind; 6] = [
    ("open hand", &[(-2.6, 1.0), (-2.0, 1.4), (-1.6, 1.6), (-1.2, 1.5), (-0.8, 1.2), (1.57, 1.6)]),
    ("three fingers", &[(-2.6, 1.0), (-2.0, 1.4), (-1.6, 1.6), (1.57, 1.6)]),
    ("pointing", &[(-1.6, 1.6), (1.57, 1.6)]),
    ("thumb up", &[(-2.6, 1.1), (1.57, 1.6)]),
    ("clover", &[(0.0, 0.9), (2.1, 0.9), (4.2, 0.9), (5.2, 0.3)]),
    ("star", &[(0.0, 1.0), (1.26, 0.8), (2.51, 1.0), (3.77, 1.0), (5.03, 1.0)]),
];

/// Numbers from −1 to 1 that look random: Weyl's sequence, folded.
fn jitter(index: usize) -> f64 {
    2.0 * (index as f64 * 0.754_877_666_246_692_8 + 0.3).fract() - 1.0
}

/// A shape of a kind, its lobes bent and stretched, rolled and scaled: different for each number.
fn shape((_, lobes): Kind, number: usize) -> Result<Vec<[f64; 2]>, Error> {
    let by = |what: usize| jitter(31 * number + 7 * what);
    let (roll, size) = (0.6 * by(0), 20.0 * 1.5_f64.powf(by(1)));
    let curve: Vec<[f64; 2]> = (0..720)
        .map(|step| {
            let angle = TAU * f64::from(step) / 720.0;
            let reach: f64 = lobes
                .iter()
                .enumerate()
                .map(|(i, (at, reach))| {
                    let turn = (angle - at - 0.12 * by(2 + i)).cos() - 1.0;
                    reach * (1.0 + 0.2 * by(20 + i)) * (32.0 * turn).exp()
                })
                .sum();
            let radius = size * (1.0 + reach);
            [radius * (angle + roll).cos(), radius * (angle + roll).sin()]
        })
        .collect();
    let length: f64 = curve.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum();
    let mut points = Vec::new();
    resample(&curve, Chain::Closed, length / POINTS, &mut points)?;
    Ok(points)
}

fn contexts(points: &[[f64; 2]]) -> Result<Vec<f32>, Error> {
    let mut contexts = ShapeContexts::new();
    Ok(contexts.compute(points, Orientation::PrincipalAxis)?.values().to_vec())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let shapes = KINDS
        .iter()
        .flat_map(|&kind| (0..EACH).map(move |number| shape(kind, number)))
        .collect::<Result<Vec<_>, _>>()?;
    let described = shapes.iter().map(|points| contexts(points)).collect::<Result<Vec<_>, _>>()?;
    let mut matcher = Matcher::new();
    let mut right = [0; KINDS.len()];
    for (i, one) in described.iter().enumerate() {
        let mut nearest = (f64::INFINITY, i);
        for (j, other) in described.iter().enumerate().filter(|(j, _)| *j != i) {
            let distance = matcher.compare(one, other)?.distance;
            nearest = if distance < nearest.0 { (distance, j) } else { nearest };
        }
        right[i / EACH] += usize::from(nearest.1 / EACH == i / EACH);
    }
    for ((name, _), right) in KINDS.iter().zip(right) {
        println!("{name:14} nearest of the same kind: {right:2} of {EACH}");
    }
    if let Some(path) = std::env::args().nth(1) {
        let [a, b] = [0, 3];
        let partners = matcher.compare(&described[a], &described[b])?.partners;
        std::fs::write(path, drawing([&shapes[a], &shapes[b]], partners))?;
    }
    Ok(())
}

/// Both contours side by side, and lines between every fourth pair of partners.
fn drawing(shapes: [&[[f64; 2]]; 2], partners: &[usize]) -> String {
    let place = |side: usize, index: usize| {
        let points = shapes[side];
        let largest = points.iter().flatten().fold(0.0_f64, |most, c| most.max(c.abs()));
        let [x, y] = points[index].map(|c| 150.0 * c / largest);
        (160.0 + 360.0 * side as f64 + x, 160.0 + y)
    };
    let mut svg = String::from(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="680" height="320"><rect width="100%" height="100%" fill="#fff"/>"##,
    );
    let mut add = |text: String| writeln!(svg, "{text}").expect("a string takes everything");
    // The shape with fewer points is the one whose partners are told.
    let few = usize::from(shapes[1].len() < shapes[0].len());
    for (index, &partner) in partners.iter().enumerate().step_by(4) {
        let ((x1, y1), (x2, y2)) = (place(few, index), place(1 - few, partner));
        add(format!(
            r##"<line x1="{x1:.1}" y1="{y1:.1}" x2="{x2:.1}" y2="{y2:.1}" stroke="#7fa6c9" stroke-width="0.8"/>"##
        ));
    }
    for (side, points) in shapes.iter().enumerate() {
        for index in 0..points.len() {
            let (x, y) = place(side, index);
            add(format!(r##"<circle cx="{x:.1}" cy="{y:.1}" r="2" fill="#c8451b"/>"##));
        }
    }
    svg + "</svg>\n"
}
