//! The shape contexts of one silhouette of 300 points.

use anyhow::{Context, Result};
use phalanx_shape_context::{Matcher, Orientation, ShapeContexts};

use super::data::matrix;
use super::programs::Peers;
use super::row::{Figure, Row, Target};
use crate::clock::{each, median};

const REPETITIONS: usize = 3;
/// Contours in one measurement of ours, and pairs of shapes.
const CONTOURS: u32 = 200;
const PAIRS: u32 = 10;
/// The other shape of a pair is the first one, stretched.
const STRETCH: f64 = 1.2;

/// What is timed.
const DESCRIPTORS: &str = "descriptors";
const DISTANCE: &str = "distance of two shapes (theirs warps too)";

/// How bench_shape_context.py begins a peer's line, the peer, and what it does in that time.
const PEERS: [(&str, &str, &str); 3] = [
    ("numba loops", "numba", DESCRIPTORS),
    ("numpy bincount", "NumPy", DESCRIPTORS),
    ("cv2 computeDistance (300 vs 300, 1 ", "OpenCV", DISTANCE),
];

pub(crate) fn rows(peers: &Peers) -> Result<Vec<Row>> {
    eprintln!("shape contexts");
    let path = Peers::data()?.join("contour.csv");
    let argument = path.display().to_string();
    let mut printed = Vec::new();
    let (mut described, mut compared) = (Vec::new(), Vec::new());
    for _ in 0..REPETITIONS {
        match peers.script("bench_shape_context.py", &[&argument]) {
            Ok(text) => printed.push(text),
            Err(error) => return Ok(vec![Row::skipped("300 shape contexts", "numba", &error)]),
        }
        let contour = matrix(&path)?;
        let points: Vec<[f64; 2]> =
            (0..contour.ncols()).map(|t| [contour[(0, t)], contour[(1, t)]]).collect();
        let mut contexts = ShapeContexts::new();
        let whole = || contexts.compute(&points, Orientation::ImageAxes).map(drop);
        described.push(each(CONTOURS, whole)?);
        compared.push(each(PAIRS, || compare(&points).map(drop))?);
    }
    let ours = |times| median(times).map_or(Figure::None, |seconds| Figure::Value(1e3 * seconds));
    let (described, compared) = (ours(described), ours(compared));
    let row = |(start, peer, does): (&str, &'static str, &'static str)| Row {
        work: "300 shape contexts".to_owned(),
        figure: does,
        unit: "ms",
        peer,
        theirs: theirs(&printed, start).into(),
        ours: if does == DESCRIPTORS { described.clone() } else { compared.clone() },
        target: if peer == "numba" { Target::AtMost(0.2) } else { Target::Open },
    };
    Ok(PEERS.map(row).to_vec())
}

/// The distance of a shape from itself stretched: two sets of contexts and their assignment.
fn compare(points: &[[f64; 2]]) -> Result<f64> {
    let stretched: Vec<[f64; 2]> = points.iter().map(|[x, y]| [STRETCH * x, *y]).collect();
    let mut contexts = ShapeContexts::new();
    let one = contexts.compute(points, Orientation::ImageAxes)?.values().to_vec();
    let other = contexts.compute(&stretched, Orientation::ImageAxes)?.values().to_vec();
    Ok(Matcher::new().compare(&one, &other)?.distance)
}

/// The median of the milliseconds at the ends of the lines that begin so.
fn theirs(printed: &[String], start: &str) -> Result<f64> {
    let of_run = |text: &String| {
        let line = text.lines().find(|line| line.starts_with(start));
        let line = line.with_context(|| format!("no line '{start}'"))?;
        let number = line.trim_end().strip_suffix("ms").map(str::trim_end);
        let number = number.and_then(|text| text.rsplit(' ').next());
        number.and_then(|n| n.parse().ok()).with_context(|| format!("no milliseconds in '{line}'"))
    };
    let times = printed.iter().map(of_run).collect::<Result<Vec<f64>>>()?;
    median(times).context("nothing was run")
}
