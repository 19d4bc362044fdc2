//! The shape contexts of one silhouette of 300 points.

use anyhow::{Context, Result};
use phalanx_shape_context::{Orientation, ShapeContexts};

use super::clock::{each, median};
use super::data::matrix;
use super::peers::Peers;
use super::row::{Figure, Row, Target};

const REPETITIONS: usize = 3;
/// Contours in one measurement of ours.
const CONTOURS: u32 = 200;

/// How bench_shape_context.py begins a peer's line, the peer, and what it does in that time.
const PEERS: [(&str, &str, &str); 3] = [
    ("numba loops", "numba", "descriptors"),
    ("numpy bincount", "NumPy", "descriptors"),
    ("cv2 computeDistance (300 vs 300, 1 ", "OpenCV", "distance of two shapes"),
];

pub(crate) fn rows(peers: &Peers) -> Result<Vec<Row>> {
    eprintln!("shape contexts");
    let path = Peers::data()?.join("contour.csv");
    let argument = path.display().to_string();
    let mut printed = Vec::new();
    let mut ours = Vec::new();
    for _ in 0..REPETITIONS {
        match peers.script("bench_shape_context.py", &[&argument]) {
            Ok(text) => printed.push(text),
            Err(error) => return Ok(vec![Row::skipped("300 shape contexts", "numba", &error)]),
        }
        let contour = matrix(&path)?;
        let points: Vec<[f64; 2]> =
            (0..contour.ncols()).map(|t| [contour[(0, t)], contour[(1, t)]]).collect();
        let mut contexts = ShapeContexts::new();
        ours.push(each(CONTOURS, || contexts.compute(&points, Orientation::ImageAxes).map(drop))?);
    }
    let ours = median(ours).map_or(Figure::None, |seconds| Figure::Value(1e3 * seconds));
    let row = |(start, peer, does): (&str, &'static str, &'static str)| Row {
        work: "300 shape contexts".to_owned(),
        figure: does,
        unit: "ms",
        peer,
        theirs: theirs(&printed, start).into(),
        ours: if does == "descriptors" { ours.clone() } else { Figure::None },
        target: if peer == "numba" { Target::AtMost(0.2) } else { Target::Open },
    };
    Ok(PEERS.map(row).to_vec())
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
