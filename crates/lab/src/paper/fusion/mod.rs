//! § 2: low, intermediate and high level, and one regressor for all cameras.

mod descriptors;
mod levels;
mod report;
mod unseen;

use anyhow::Result;
use faer::Mat;
use phalanx::Progress;
use phalanx_camera::Rig;
use rayon::prelude::*;

use super::{Experiment, Finding};
use crate::context::Lab;
use crate::data::described::Described;
use crate::data::split::Split;
use crate::eval::table1::PaperCounts;
use crate::metrics::{AngleErrors, mean_predictor};
use descriptors::Codebooks;
use levels::{Join, Kept, Level, Training};
use unseen::Unseen;

pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "fusion",
    place: "§ 2, § 5",
    title: "three ways to join views",
    claim: "views are best joined at the intermediate level: pooling all shape contexts gains \
            little, since they fit more than one orientation, and joining estimates of single views \
            (by regressors of their own, or by one that serves all cameras) asks for more than \
            training sets can give.",
    run,
};

const SPLITS: u64 = 2;

/// How one way of joining did on each test set of one split.
struct Outcome {
    way: Way,
    errors: Vec<AngleErrors>,
}

/// One way of joining.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Way {
    family: Family,
    level: &'static str,
    kept: Kept,
    join: Join,
}

/// The levels that the paper tells apart.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Family {
    Low,
    /// As the paper has it, with all centres shared by the views.
    Intermediate,
    /// With more centres than the paper's: not part of the claim.
    IntermediateLarge,
    High,
}

/// One data set's outcomes, each the mean over the splits.
struct Results {
    tests: Vec<String>,
    /// Of predicting the training mean, test set by test set.
    guesses: Vec<f64>,
    outcomes: Vec<Outcome>,
    /// Samples kept by the paper's regressor.
    count: usize,
    train_samples: usize,
}

fn run(lab: &Lab<'_>) -> Result<Finding> {
    let azimuths = azimuths(&lab.rig);
    let unseen = Unseen::draw(lab)?;
    let (open_close, complex) = (lab.open_close()?, lab.complex()?);
    lab.progress.begin("split, cluster, fit, test", 2 * SPLITS as usize);
    let sets: [(&Described, &[&Described]); 2] =
        [(open_close, &[]), (complex, &[&unseen.whole, &unseen.damaged])];
    let results: Vec<Results> = sets
        .iter()
        .map(|(set, beyond)| results(set, beyond, &azimuths, lab.progress))
        .collect::<Result<_>>()?;
    report::finding(&results[0], &results[1], unseen.left_out)
}

/// Each camera's angle about the forearm, radians: a hand turned by θ_Z looks to it as one turned
/// by θ_Z less this angle looks from above.
fn azimuths(rig: &Rig) -> Vec<f64> {
    let to_hand = rig.volume.rest_frame().inverse();
    let azimuth = |centre| {
        let seen = to_hand.transform_point3(centre);
        (-seen.x).atan2(seen.y)
    };
    rig.cameras.iter().map(|camera| azimuth(camera.centre())).collect()
}

fn results(
    set: &Described,
    beyond: &[&Described],
    azimuths: &[f64],
    progress: &dyn Progress,
) -> Result<Results> {
    let counts = PaperCounts::paper(azimuths.len(), &set.name);
    let splits: Vec<(Vec<Outcome>, Vec<f64>)> = (0..SPLITS)
        .into_par_iter()
        .map(|seed| {
            let outcomes = outcomes(set, beyond, azimuths, counts, seed);
            progress.step();
            outcomes
        })
        .collect::<Result<_>>()?;
    let average = |k: usize| {
        let of_split = |split: &(Vec<Outcome>, _), test: usize| split.0[k].errors[test].clone();
        let over_splits = |test: usize| {
            AngleErrors::average(&splits.iter().map(|s| of_split(s, test)).collect::<Vec<_>>())
        };
        Outcome { way: splits[0].0[k].way, errors: (0..=beyond.len()).map(over_splits).collect() }
    };
    let guess = |test: usize| splits.iter().map(|s| s.1[test]).sum::<f64>() / SPLITS as f64;
    let tests = std::iter::once(set).chain(beyond.iter().copied());
    Ok(Results {
        tests: tests.map(|test| test.name.clone()).collect(),
        guesses: (0..=beyond.len()).map(guess).collect(),
        outcomes: (0..splits[0].0.len()).map(average).collect(),
        count: counts.gauss_samples,
        train_samples: set.poses.len().div_ceil(2),
    })
}

/// Every way of joining on one split, and the errors of guessing, test set by test set: the
/// split's own other half first.
fn outcomes(
    set: &Described,
    beyond: &[&Described],
    azimuths: &[f64],
    counts: PaperCounts,
    seed: u64,
) -> Result<(Vec<Outcome>, Vec<f64>)> {
    let split = Split::even(set.poses.len(), seed);
    let codebooks = Codebooks::learn(set, &split.train, seed)?;
    let all = |set: &Described| (0..set.poses.len()).collect::<Vec<_>>();
    let mut sets = vec![(set, split.test)];
    sets.extend(beyond.iter().map(|&set| (set, all(set))));
    let describe = |(set, samples): &(&Described, Vec<usize>)| codebooks.describe(set, samples);
    let tests = sets.iter().map(describe).collect::<Result<Vec<_>>>()?;
    let truths: Vec<Mat<f64>> = sets.iter().map(|(set, samples)| targets(set, samples)).collect();
    let training = Training {
        x: &codebooks.describe(set, &split.train)?,
        y: &targets(set, &split.train),
        active: &set.active,
        counts,
        seed,
    };
    let errors = |estimates: &Mat<f64>, truth: &Mat<f64>| {
        AngleErrors::new(estimates.as_ref(), truth.as_ref(), &set.active)
    };
    let mut outcomes = Vec::new();
    for (family, level) in levels(azimuths) {
        for &kept in level.kept() {
            let tests: Vec<_> = tests.iter().collect();
            for (join, estimates) in level.estimates(&training, kept, &tests)? {
                let errors = estimates.iter().zip(&truths).map(|(e, truth)| errors(e, truth));
                let way = Way { family, level: level.name(), kept, join };
                outcomes.push(Outcome { way, errors: errors.collect() });
            }
        }
    }
    let guess = |truth| errors(&mean_predictor(training.y, Mat::ncols(truth)), truth).mae();
    Ok((outcomes, truths.iter().map(guess).collect()))
}

/// All levels, in the order of the table.
fn levels(azimuths: &[f64]) -> [(Family, Level<'_>); 6] {
    [
        (Family::Low, Level::Low),
        (Family::Intermediate, Level::Intermediate),
        (Family::IntermediateLarge, Level::IntermediateLarge),
        (Family::High, Level::High),
        (Family::High, Level::HighLarge),
        (Family::High, Level::Shared(azimuths)),
    ]
}

fn targets(set: &Described, samples: &[usize]) -> Mat<f64> {
    phalanx::targets(&samples.iter().map(|&i| set.poses[i]).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use phalanx::draw_silhouette;
    use phalanx_hand::{Dof, Pose};

    use super::azimuths;
    use crate::files;

    #[test]
    fn a_camera_turned_about_the_forearm_sees_the_hand_turned_back() {
        let (rig, hand) = (files::rig(None).unwrap(), files::hand(None).unwrap());
        let rest = rig.volume.rest_frame();
        let draw = |camera: &str, theta_z: f64| {
            let mut pose = Pose::REST;
            pose[Dof::IndexMcp] = 0.8;
            pose[Dof::ThetaZ] = theta_z;
            draw_silhouette(rig.camera(camera).unwrap(), &hand, &pose, &rest).unwrap()
        };
        for (camera, azimuth) in rig.cameras.iter().zip(azimuths(&rig)) {
            let seen = draw(&camera.name, 0.7);
            let differing = |theta_z: f64| {
                let turned = draw("top", theta_z);
                seen.pixels().zip(turned.pixels()).filter(|(a, b)| a != b).count()
            };
            assert!(differing(0.7 - azimuth) < 10, "{}", camera.name);
            assert!(azimuth == 0.0 || differing(0.7 + azimuth) > 200, "{}", camera.name);
        }
    }
}
