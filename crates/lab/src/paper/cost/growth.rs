//! How the stages grow with the sizes of what they work on.

use std::hint::black_box;

use anyhow::{Context, Result};
use faer::Mat;
use phalanx_codebook::{Codebook, Encoder, SoftAssignment};
use phalanx_hand::Pose;
use phalanx_multiview::{CodebookTrainer, ViewEncoders};
use phalanx_rvm::{Bandwidth, KernelRidge, Model, Regularisation};
use phalanx_segmentation::Silhouette;
use phalanx_shape_context::{BINS, Orientation, ShapeContexts};

use super::stages::estimate;
use crate::clock::seconds;
use crate::context::Lab;
use crate::data::described::{Described, Halves, vocabulary};
use crate::data::split::Split;
use crate::eval::table1::{PaperCounts, TableMethod};

/// Times of one stage at rising sizes.
pub(super) struct Growth {
    pub(super) stage: &'static str,
    /// Size and seconds.
    pub(super) points: Vec<(f64, f64)>,
}

/// What a group of stages grows with.
pub(super) struct Group {
    pub(super) with: &'static str,
    pub(super) growths: Vec<Growth>,
}

impl Growth {
    pub(super) fn exponent(&self) -> f64 {
        exponent(&self.points)
    }

    fn over(
        stage: &'static str,
        sizes: &[usize],
        time: impl FnMut(usize) -> Result<f64>,
    ) -> Result<Self> {
        let times = sizes.iter().copied().map(time).collect::<Result<Vec<_>>>()?;
        let points = sizes.iter().map(|size| *size as f64).zip(times).collect();
        Ok(Self { stage, points })
    }
}

pub(super) fn run(lab: &Lab<'_>, halves: &Halves) -> Result<Vec<Group>> {
    let described = lab.complex()?;
    let outline = Outline::of(lab, lab.single()?)?;
    Ok(vec![
        cameras(lab)?,
        contour_points(described, &outline)?,
        centres(described)?,
        training_samples(halves)?,
        kept_samples(halves)?,
    ])
}

/// A contour of which any number of points can be taken.
struct Outline {
    points: Vec<[f64; 2]>,
    forearm_end: [f64; 2],
}

impl Outline {
    /// What a camera sees of the first pose of complex.
    fn of(lab: &Lab<'_>, view: usize) -> Result<Self> {
        let pose = &lab.complex()?.poses[0];
        let rest = lab.rig.volume.rest_frame();
        let mask = phalanx::draw_silhouette(&lab.rig.cameras[view], &lab.hand, pose, &rest)?;
        let Silhouette { contour, forearm, .. } = Silhouette::from_mask(&mask)?;
        Ok(Self { points: contour.points, forearm_end: forearm.end })
    }

    /// So many points, evenly spaced along the list of the contour's.
    fn points(&self, count: usize) -> Vec<[f64; 2]> {
        let last = self.points.len() - 1;
        let point = |k: usize| {
            let place = last as f64 * k as f64 / count as f64;
            let (before, part) = (place as usize, place.fract());
            let [from, to] = [self.points[before], self.points[before + 1]];
            [0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis]))
        };
        (0..count).map(point).collect()
    }

    fn orientation(&self) -> Orientation {
        Orientation::HandAxis { forearm_end: self.forearm_end }
    }
}

/// A codebook of shape contexts from all over the data set; what assignment costs does not depend on
/// which they are.
fn codebook(described: &Described, centres: usize) -> Result<Codebook> {
    let every = described.poses.len() / centres;
    let centre = |k: usize| described.contexts[k * every][0][..BINS].iter().copied();
    Ok(Codebook::from_parts((0..centres).flat_map(centre).collect(), BINS, 0.1)?)
}

/// How many centres each of so many cameras has.
type Centres = fn(usize) -> usize;

/// What is learnt from some of the cameras at a number of centres for each: the codebooks, and the
/// regressor of the joined descriptors, with one to estimate from.
struct Learnt {
    codebooks: ViewEncoders,
    model: Model,
    x: Vec<f64>,
}

impl Learnt {
    fn from(described: &Described, views: &[usize], centres: usize) -> Result<Self> {
        let split = Split::even(described.poses.len(), 0);
        let vocabulary = CodebookTrainer { centres, ..vocabulary(0) };
        let seen = described.seen(views, &split.train);
        let codebooks = vocabulary.fit(&seen, BINS)?;
        let poses: Vec<Pose> = split.train.iter().map(|&i| described.poses[i]).collect();
        let train = phalanx::descriptors(&codebooks, &seen)?;
        let test = phalanx::descriptors(&codebooks, &described.seen(views, &split.test[..1]))?;
        let counts = PaperCounts::paper(3, &described.name);
        let regressor = TableMethod::Gauss.regressor(counts).context("it fits nothing")?;
        let model = regressor.fit(&train, &phalanx::targets(&poses))?.model;
        Ok(Self { codebooks, model, x: test.col(0).iter().copied().collect() })
    }
}

/// Describes what each of the cameras sees, and estimates a pose from it with the model of those
/// cameras: at the same number of centres for each camera, and at 90 shared out among them.
fn cameras(lab: &Lab<'_>) -> Result<Group> {
    let (described, views) = (lab.complex()?, lab.all_views());
    let of_view = |&view: &usize| Outline::of(lab, view);
    let outlines = views.iter().map(of_view).collect::<Result<Vec<_>>>()?;
    let seen: Vec<_> = outlines.iter().map(|o| (o.points(300), o.orientation())).collect();
    let mut contexts = ShapeContexts::new();
    let mut scratch = phalanx_codebook::Scratch::default();
    let mut describe = |learnt: &Learnt| {
        seconds(|| {
            for ((points, orientation), encoder) in seen.iter().zip(learnt.codebooks.views()) {
                let mut x = vec![0.0; encoder.dim()];
                let values = contexts.compute(black_box(points), *orientation)?.values();
                encoder.encode(values, &mut scratch, &mut x)?;
                black_box(&x);
            }
            Ok(())
        })
    };
    let counts: Vec<usize> = (1..=views.len()).collect();
    let mut growths = Vec::new();
    let of_cameras: [(_, _, Centres); 2] = [
        ("descriptors, 30 centres each", "pose, 30 centres each", |_| 30),
        ("descriptors, 90 shared", "pose, 90 shared", |cameras| 90 / cameras),
    ];
    for (describing, estimating, centres) in of_cameras {
        let learn = |&count: &usize| Learnt::from(described, &views[..count], centres(count));
        let learnt = counts.iter().map(learn).collect::<Result<Vec<_>>>()?;
        growths.push(Growth::over(describing, &counts, |count| describe(&learnt[count - 1]))?);
        let pose = |count: usize| estimate(&learnt[count - 1].model, &learnt[count - 1].x);
        growths.push(Growth::over(estimating, &counts, pose)?);
    }
    Ok(Group { with: "cameras", growths })
}

fn contour_points(described: &Described, outline: &Outline) -> Result<Group> {
    let mut contexts = ShapeContexts::new();
    let sizes = [100, 200, 400, 800];
    let compute = |count: usize| {
        let points = outline.points(count);
        seconds(|| {
            black_box(contexts.compute(black_box(&points), outline.orientation())?);
            Ok(())
        })
    };
    let shapes = Growth::over("shape contexts", &sizes, compute)?;
    let (codebook, mut x) = (codebook(described, 30)?, vec![0.0; 30]);
    let mut scratch = phalanx_codebook::Scratch::default();
    let vote = |count: usize| {
        let seen = contexts.compute(&outline.points(count), outline.orientation())?;
        let values = seen.values().to_vec();
        seconds(|| {
            Ok(codebook.soft_assign(
                black_box(&values),
                SoftAssignment::default(),
                &mut scratch,
                &mut x,
            )?)
        })
    };
    let votes = Growth::over("votes", &sizes, vote)?;
    Ok(Group { with: "contour points", growths: vec![shapes, votes] })
}

fn centres(described: &Described) -> Result<Group> {
    let samples = &described.contexts[0][0];
    let mut scratch = phalanx_codebook::Scratch::default();
    let vote = |count: usize| {
        let (codebook, mut x) = (codebook(described, count)?, vec![0.0; count]);
        seconds(|| {
            Ok(codebook.soft_assign(
                black_box(samples),
                SoftAssignment::default(),
                &mut scratch,
                &mut x,
            )?)
        })
    };
    let growths = vec![Growth::over("votes", &[30, 60, 120, 240, 360], vote)?];
    Ok(Group { with: "K", growths })
}

fn sizes(halves: &Halves) -> [usize; 4] {
    [8, 4, 2, 1].map(|part| halves.train.x.ncols() / part)
}

fn first(of: &Mat<f64>, count: usize) -> Mat<f64> {
    of.subcols(0, count).to_owned()
}

/// The steps of the linear fit, and the ν/m at which it could end, on the fewest and on the most
/// samples.
pub(super) fn linear_steps(halves: &Halves) -> Result<[(usize, f64); 2]> {
    let counts = PaperCounts::paper(3, "complex");
    let regressor = TableMethod::Lin.regressor(counts).context("it fits nothing")?;
    let [fewest, .., most] = sizes(halves);
    let steps = |count| -> Result<(usize, f64)> {
        let (x, y) = (first(&halves.train.x, count), first(&halves.train.y, count));
        let report = regressor.fit(&x, &y)?.report;
        Ok((report.iterations, report.penalty.context("bridges have a penalty")?))
    };
    Ok([steps(fewest)?, steps(most)?])
}

fn training_samples(halves: &Halves) -> Result<Group> {
    let sizes = sizes(halves);
    let counts = PaperCounts::paper(3, "complex");
    let fit = |method: TableMethod| {
        let regressor = method.regressor(counts).context("it fits nothing")?;
        Growth::over(method.name(), &sizes, |count| {
            let (x, y) = (first(&halves.train.x, count), first(&halves.train.y, count));
            seconds(|| {
                black_box(regressor.fit(&x, &y)?);
                Ok(())
            })
        })
    };
    let methods = [TableMethod::Lin, TableMethod::Gauss, TableMethod::Both];
    let growths = methods.into_iter().map(fit).collect::<Result<_>>()?;
    Ok(Group { with: "training samples", growths })
}

/// Estimates by a model that keeps all of so many samples.
fn kept_samples(halves: &Halves) -> Result<Group> {
    let x: Vec<f64> = halves.test.x.col(0).iter().copied().collect();
    let ridge = KernelRidge {
        bandwidth: Bandwidth::Relative(1.0),
        regularisation: Regularisation::Fixed(0.1),
    };
    let pose = |count: usize| {
        let (train_x, train_y) = (first(&halves.train.x, count), first(&halves.train.y, count));
        let model = ridge.fit(train_x.as_ref(), train_y.as_ref())?.model;
        estimate(&model, &x)
    };
    let growths = vec![Growth::over("pose", &[20, 40, 80, 160, 320], pose)?];
    Ok(Group { with: "selected samples", growths })
}

/// How a time grows with a size: the exponent of the power law that fits best, by least squares
/// on logarithms.
fn exponent(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean_x = logs.iter().map(|p| p.0).sum::<f64>() / count;
    let mean_y = logs.iter().map(|p| p.1).sum::<f64>() / count;
    let product: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    product / logs.iter().map(|(x, _)| (x - mean_x).powi(2)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_has_its_exponent() {
        let points: Vec<(f64, f64)> = [1.0, 2.0, 5.0].map(|x: f64| (x, 3.0 * x.powf(1.5))).into();
        assert!((exponent(&points) - 1.5).abs() < 1e-12);
    }
}
