//! `cargo xtask end-model`: trains the model of an arm's ends that the segmentation crate ships, on drawn hands whose
//! arms end within the picture.

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use glam::{DAffine3, DQuat, DVec2, DVec3};
use phalanx::ItemRng;
use phalanx_camera::{Camera, Intrinsics};
use phalanx_hand::{Dof, HandShape, sample_pose};
use phalanx_segmentation::{
    Cleanup, EndModel, EndParts, HandDetection, HandDetector, Mask, WristModel,
};

use super::drawn_hand::DrawnHand;
use crate::files;

/// Hands that are learnt from, and as many that are tested on.
const SAMPLES: u64 = 6000;
const SEED: u64 = 77;
/// How far bones and radii differ from the mean hand's.
const SPREAD: f64 = 0.15;
/// Side of the pictures, px.
const SIDE: u32 = 200;
/// The forearm before it is cut, up to an elbow, and where it is cut behind the wrist, mm.
const FOREARM: f64 = 320.0;
const CUTS: [f64; 2] = [15.0, 270.0];
/// How far from straight across it is cut, radians.
const SLANT: f64 = 0.4;
/// How far ahead of the wrist the middle of a hand is, mm.
const MIDDLE: f64 = 70.0;

/// A candidate is at the hand's end that points within 45° of the arm and whose wrist is within a quarter of the hand's
/// length, and at the other that points 120° away or more.
const SAME: f64 = 0.7;
const NEAR: f64 = 0.25;
const OPPOSED: f64 = -0.5;

/// Precision of the weights' prior, and steps of Newton's method.
const RIDGE: f64 = 3.0;
const STEPS: usize = 25;

#[derive(Args)]
pub struct Arguments {
    /// Where the model goes; the file that the crate ships by default.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// What may be the hand in a silhouette, and whether it is at the hand's end of the arm.
struct Candidate {
    detection: HandDetection,
    is_hand: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let hand = files::hand(None)?;
    let learnt: Vec<Candidate> = candidates(&hand, 0..SAMPLES)?.into_iter().flatten().collect();
    let model = fit(&learnt)?;
    let shipped = files::in_repository("crates/segmentation/models/end.txt");
    let out = arguments.out.clone().unwrap_or(shipped);
    files::write_whole(&out, &model.to_bytes())?;
    let tested = test(&model, &candidates(&hand, SAMPLES..2 * SAMPLES)?);
    files::print(&format!("{}\n{tested}", out.display()))
}

/// Logistic regression, both classes with the same weight in all.
fn fit(candidates: &[Candidate]) -> Result<EndModel> {
    let count = candidates.len() as f64;
    let mean = |of: &dyn Fn(&HandDetection) -> f64| -> f64 {
        candidates.iter().map(|candidate| of(&candidate.detection)).sum::<f64>() / count
    };
    let means = std::array::from_fn(|k| mean(&|hand| hand.profile[k]));
    let deviations =
        std::array::from_fn(|k| mean(&|hand| (hand.profile[k] - means[k]).powi(2)).sqrt());
    let mut parts = EndParts { means, deviations, weights: Vec::new() };
    let terms: Vec<Vec<f64>> =
        candidates.iter().map(|candidate| parts.terms(&candidate.detection.profile)).collect();
    let size = terms.first().context("no hand was found in any drawn silhouette")?.len();
    let design = Mat::from_fn(terms.len(), size, |row, column| terms[row][column]);
    let hands = candidates.iter().filter(|candidate| candidate.is_hand).count() as f64;
    let share = |is_hand: bool| if is_hand { hands / count } else { 1.0 - hands / count };
    let mut weights = Mat::<f64>::zeros(size, 1);
    for _ in 0..STEPS {
        let odds = &design * &weights;
        let probability = |row: usize| (1.0 + (-odds[(row, 0)]).exp()).recip();
        let of_class = |row: usize| 0.5 / share(candidates[row].is_hand);
        let off = Mat::from_fn(terms.len(), 1, |row, _| {
            of_class(row) * (probability(row) - f64::from(u8::from(candidates[row].is_hand)))
        });
        let scaled = Mat::from_fn(terms.len(), size, |row, column| {
            let variance = probability(row) * (1.0 - probability(row));
            of_class(row) * variance * design[(row, column)]
        });
        let mut curvature = design.transpose() * scaled;
        for k in 0..size {
            curvature[(k, k)] += RIDGE;
        }
        let gradient = design.transpose() * off + &weights * RIDGE;
        let factor = curvature.llt(Side::Lower).ok().context("weights are not finite")?;
        weights -= factor.solve(gradient);
    }
    parts.weights = (0..size).map(|k| weights[(k, 0)]).collect();
    Ok(EndModel::from_parts(parts)?)
}

/// How often the model is right.
fn test(model: &EndModel, silhouettes: &[Vec<Candidate>]) -> String {
    let is_right = |candidate: &Candidate| {
        (model.log_odds(&candidate.detection.profile) > 0.0) == candidate.is_hand
    };
    let share = |is_hand: bool| {
        let own = || silhouettes.iter().flatten().filter(|own| own.is_hand == is_hand);
        own().filter(|own| is_right(own)).count() as f64 / own().count() as f64
    };
    let odds = |own: &&Candidate| model.log_odds(&own.detection.profile);
    let likeliest = |own: &&Vec<Candidate>| {
        let best = own.iter().max_by(|a, b| odds(a).total_cmp(&odds(b)));
        best.is_some_and(|best| best.is_hand)
    };
    let shows = |own: &&Vec<Candidate>| {
        [true, false].iter().all(|end| own.iter().any(|candidate| candidate.is_hand == *end))
    };
    let both: Vec<&Vec<Candidate>> = silhouettes.iter().filter(shows).collect();
    let right = both.iter().copied().filter(likeliest).count() as f64 / both.len() as f64;
    format!(
        "others: {:.3} of those at the hand's end are right, {:.3} of those at the arm's\n\
         {} silhouettes have both; the likeliest is the hand in {right:.3}\n",
        share(true),
        share(false),
        both.len(),
    )
}

/// What may be the hand in each of some silhouettes.
fn candidates(hand: &HandShape, numbers: std::ops::Range<u64>) -> Result<Vec<Vec<Candidate>>> {
    let mut finder = HandDetector::default();
    let mut all = Vec::new();
    for number in numbers {
        let Some(sample) = sample(hand, number)? else { continue };
        let found = finder.find(&sample.mask, &Cleanup::default(), WristModel::builtin());
        let label = |detection: HandDetection| {
            let same = DVec2::from_array(detection.direction).dot(sample.direction);
            let off = DVec2::from_array(detection.wrist).distance(sample.wrist()) / sample.length();
            let is_hand = same > SAME && off < NEAR;
            (is_hand || same < OPPOSED).then_some(Candidate { detection, is_hand })
        };
        all.push(found.unwrap_or_default().into_iter().filter_map(label).collect());
    }
    Ok(all)
}

/// A hand of its own in a pose of its own, seen from anywhere but nearly along its arm, which is cut across anywhere;
/// nothing where hand or arm reach the picture's border.
fn sample(hand: &HandShape, number: u64) -> Result<Option<DrawnHand>> {
    let mut random = ItemRng::new(SEED, number);
    let mut hand = hand.scaled(|| random.between(1.0 - SPREAD, 1.0 + SPREAD));
    hand.forearm.length_mm = FOREARM;
    let [near, far] = hand.forearm.half_widths_mm;
    hand.forearm.half_widths_mm =
        [near * random.between(0.9, 1.1), far * random.between(0.8, 1.25)];
    let mut pose = sample_pose(|| random.uniform());
    pose[Dof::WristFlexion] = random.between(-40.0, 40.0).to_radians();
    pose[Dof::WristDeviation] = random.between(-20.0, 15.0).to_radians();
    let roll = DQuat::from_rotation_z(random.between(0.0, std::f64::consts::TAU));
    let tilt = DQuat::from_rotation_x(random.between(-50.0, 50.0).to_radians());
    let rest = DAffine3::from_quat(tilt * roll);
    let away = random.between(400.0, 1500.0);
    let focal = random.between(55.0, 85.0) * away / 185.0;
    let turned = random.between(0.0, std::f64::consts::TAU);
    let up = DVec3::new(turned.cos(), 0.0, turned.sin());
    let cut = random.between(CUTS[0], CUTS[1]);
    let aim = rest.transform_point3(DVec3::Z * (MIDDLE - 0.5 * cut));
    let inside = Intrinsics::pinhole(SIDE, SIDE, focal);
    let camera = Camera::look_at("c", inside, aim + DVec3::Y * away, aim, up)?;
    let Some(end) = camera.project(rest.transform_point3(DVec3::NEG_Z * cut)) else {
        return Ok(None);
    };
    let Some(drawn) = DrawnHand::of(&hand, &pose, &rest, &camera)? else { return Ok(None) };
    let across = DVec2::from_angle(random.between(-SLANT, SLANT)).rotate(drawn.direction);
    let mask = Mask::from_fn(SIDE, SIDE, |x, y| {
        let pixel = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
        drawn.mask.is_hand(x, y) && (pixel - end).dot(across) > 0.0
    });
    let is_at_border = (0..SIDE).any(|k| {
        [(k, 0), (k, SIDE - 1), (0, k), (SIDE - 1, k)].iter().any(|&(x, y)| mask.is_hand(x, y))
    });
    Ok((!is_at_border).then_some(DrawnHand { mask, ..drawn }))
}
