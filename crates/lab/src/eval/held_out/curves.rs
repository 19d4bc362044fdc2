//! Error against the number of training samples, and of codebook centres.

use std::fmt::Write;

use anyhow::Result;
use comfy_table::{Table, presets};
use phalanx::Progress;
use phalanx_multiview::CodebookTrainer;
use serde::Serialize;

use super::ground::Ground;
use super::histograms::ViewCodebooks;
use super::learner::{Learner, codebooks, describe, pilot_contexts};
use super::method::Method;
use super::row::{self, Row};
use crate::data::described::Samples;
use crate::data::sets::{Augment, Set, Test, random};

const SAMPLES: [usize; 7] = [500, 1000, 2000, 5000, 10_000, 20_000, 50_000];
/// Centres of all views together.
const CENTRES: [usize; 6] = [30, 60, 90, 180, 360, 720];
/// Training samples of the curve over centres.
const SAMPLES_FOR_CENTRES: usize = 5000;
const TESTS: [Test; 2] = [Test::Unseen, Test::All];
const METHODS: [Method; 6] =
    [Method::Lin, Method::Gauss, Method::Both, Method::Forward, Method::Kernel, Method::Knn5];

/// A point of a curve.
#[derive(Serialize)]
pub(crate) struct Point {
    /// What grows: `samples` or `centres`.
    over: &'static str,
    at: usize,
    #[serde(flatten)]
    row: Row,
}

/// All curves, of all views, learnt from random poses, clean and augmented.
pub(crate) fn points(ground: &Ground, progress: &dyn Progress) -> Result<Vec<Point>> {
    let mut points = Vec::new();
    for augment in [Augment::No, Augment::Yes] {
        let most = SAMPLES.into_iter().max().unwrap_or(0);
        let set = random(&ground.rig, &ground.hand, most, augment);
        points.extend(over_samples(&set, ground, progress)?);
    }
    let set = random(&ground.rig, &ground.hand, SAMPLES_FOR_CENTRES, Augment::No);
    points.extend(over_centres(&set, ground, progress)?);
    Ok(points)
}

/// The codebooks stay; the first so many samples are learnt from.
fn over_samples(set: &Set<'_>, ground: &Ground, progress: &dyn Progress) -> Result<Vec<Point>> {
    let contexts = pilot_contexts(set, ground.rule, progress)?;
    let views: Vec<usize> = (0..ground.rig.cameras.len()).collect();
    let books = [codebooks(&contexts, &views, &CodebookTrainer::default())?];
    drop(contexts);
    let samples = describe(set, ground.rule, &books, progress)?.samples;
    let learners = SAMPLES.map(|count| {
        let first = first(&samples[0], count);
        Learner::fit(set.name, books[0].clone(), &first, &METHODS, progress)
    });
    let learners = learners.into_iter().collect::<Result<Vec<_>>>()?;
    points_of("samples", &SAMPLES, &learners, ground, progress)
}

/// The samples stay; they are described with so many centres.
fn over_centres(set: &Set<'_>, ground: &Ground, progress: &dyn Progress) -> Result<Vec<Point>> {
    let contexts = pilot_contexts(set, ground.rule, progress)?;
    let views: Vec<usize> = (0..ground.rig.cameras.len()).collect();
    progress.begin("cluster shape contexts", CENTRES.len());
    let books = CENTRES.map(|centres| {
        let books = codebooks(
            &contexts,
            &views,
            &CodebookTrainer { centres, ..CodebookTrainer::default() },
        );
        progress.step();
        books
    });
    let books = books.into_iter().collect::<Result<Vec<ViewCodebooks>>>()?;
    drop(contexts);
    let samples = describe(set, ground.rule, &books, progress)?.samples;
    let kernel = [Method::Kernel];
    let fit = |(books, samples)| Learner::fit(set.name, books, &samples, &kernel, progress);
    let learners = books.into_iter().zip(samples).map(fit).collect::<Result<Vec<_>>>()?;
    points_of("centres", &CENTRES, &learners, ground, progress)
}

fn first(samples: &Samples, count: usize) -> Samples {
    let count = count.min(samples.x.ncols());
    let part = |all: &faer::Mat<f64>| all.subcols(0, count).to_owned();
    Samples { x: part(&samples.x), y: part(&samples.y) }
}

/// Tests learners, one for each place on an axis.
fn points_of(
    over: &'static str,
    places: &[usize],
    learners: &[Learner],
    ground: &Ground,
    progress: &dyn Progress,
) -> Result<Vec<Point>> {
    let mut points = Vec::new();
    for test in TESTS {
        let set = test.set(&ground.rig, &ground.hand, &[]);
        // Learners' rows come in order, as many for each as it has methods.
        let rows = row::of_set(&set, learners, ground, progress)?;
        let each = rows.len() / learners.len();
        let places = places.iter().flat_map(|&at| std::iter::repeat_n(at, each));
        points.extend(rows.into_iter().zip(places).map(|(row, at)| Point { over, at, row }));
    }
    Ok(points)
}

/// One table for each curve's training set and test: places down, methods across.
pub(crate) fn tables(points: &[Point]) -> String {
    let mut text = String::from(
        "# Error against training samples and codebook centres\n\nPrinted by `cargo xtask eval-held-out --curves`: mean absolute error over the 21 active angles\n\
         in degrees and, in brackets, over that of predicting the training mean; three views. Every point\n\
         of a curve over samples has the codebooks of the largest set, learnt from 1,000 of its samples.\n",
    );
    let mut named = Vec::new();
    for point in points {
        let of = (point.over, point.row.train, point.row.test);
        if named.contains(&of) {
            continue;
        }
        named.push(of);
        let curve: Vec<&Point> =
            points.iter().filter(|p| (p.over, p.row.train, p.row.test) == of).collect();
        let (over, train, test) = of;
        let _ =
            write!(text, "\n## Error against {over}: `{train}`, `{test}`\n\n{}\n", table(&curve));
    }
    text
}

fn table(curve: &[&Point]) -> Table {
    let mut places: Vec<usize> = curve.iter().map(|point| point.at).collect();
    places.dedup();
    let at = |place: usize| curve.iter().filter(move |point| point.at == place);
    let mut table = Table::new();
    let methods = at(places[0]).map(|point| point.row.method.to_owned());
    table
        .load_style(presets::ASCII_MARKDOWN)
        .set_header(std::iter::once(curve[0].over.to_owned()).chain(methods));
    for place in places {
        let cell = |point: &&Point| {
            let Row { mae_deg, mean_predictor_mae_deg, .. } = point.row;
            format!("{mae_deg:.2} ({:.2})", mae_deg / mean_predictor_mae_deg)
        };
        table.add_row(std::iter::once(place.to_string()).chain(at(place).map(cell)));
    }
    table
}
