//! Digits that went the wrong way: each is tried in other postures.

use faer::{Mat, Side};
use image::GrayImage;
use phalanx_hand::{Digit, HandShape, Link, Pose, Primitive};

use glam::DAffine3;

use crate::view::View;
use crate::{Evidence, PosePrior, Result};

/// Steps along the two directions in which the prior leaves a digit most freedom, in standard
/// deviations.
const STEPS: [f64; 6] = [-2.1, -1.4, -0.7, 0.7, 1.4, 2.1];

/// Energy of a pixel that differs.
const PIXEL: f64 = 1.0;

/// Tries every digit in other postures, and keeps those that make the drawn silhouettes differ from
/// the observed ones in fewer pixels, the prior taken into account.
pub(crate) fn try_postures(
    hand: &HandShape,
    rest: &DAffine3,
    evidence: &[Evidence],
    prior: &PosePrior,
    start: &Pose,
    views: &mut [View],
) -> Result<Pose> {
    let mut pose = *start;
    let mut scratch = GrayImage::default();
    let mut others = vec![GrayImage::default(); views.len()];
    for digit in Digit::ALL {
        let directions = freedom(prior, digit);
        if directions.is_empty() {
            continue;
        }
        let posed = hand.pose(&pose, rest);
        let is_of = |links: &[Link; 3]| {
            links.iter().any(|link| matches!(link, Link::Segment(own, _) if *own == digit))
        };
        let solids = |posed: &phalanx_hand::PosedHand, own: bool| -> Vec<Primitive> {
            let all = posed.primitives.iter().zip(&posed.links);
            all.filter(|(_, links)| is_of(links) == own).map(|(solid, _)| *solid).collect()
        };
        let rest_of_hand = solids(&posed, false);
        for ((view, seen), other) in views.iter_mut().zip(evidence).zip(&mut others) {
            view.draw(&rest_of_hand, seen, other)?;
        }
        let mut cost = |pose: &Pose| -> Result<f64> {
            let own = solids(&hand.pose(pose, rest), true);
            let mut differing = 0;
            for ((view, seen), other) in views.iter_mut().zip(evidence).zip(&others) {
                view.draw(&own, seen, &mut scratch)?;
                differing += difference(other, &scratch, seen.mask());
            }
            Ok(PIXEL * f64::from(differing) + prior.energy(pose))
        };
        let mut best = (cost(&pose)?, pose);
        for direction in 0..2 {
            let from = best.1;
            for step in STEPS {
                let mut candidate = from;
                for (dof, directions) in digit.dofs().into_iter().zip(&directions) {
                    let (low, high) = dof.range();
                    candidate[dof] = (from[dof] + step * directions[direction]).clamp(low, high);
                }
                let cost = cost(&candidate)?;
                if cost < best.0 {
                    best = (cost, candidate);
                }
            }
        }
        pose = best.1;
    }
    Ok(pose)
}

/// How many pixels of the union of two masks differ from a third.
fn difference(one: &GrayImage, other: &GrayImage, seen: &GrayImage) -> u32 {
    let pixels = one.iter().zip(other.iter()).zip(seen.iter());
    pixels.map(|((a, b), c)| u32::from((a | b) >> 7 != c >> 7)).sum()
}

/// The two principal directions of the prior's covariance of a digit's four angles, each as long as
/// its standard deviation, transposed; none where the prior knows an angle.
fn freedom(prior: &PosePrior, digit: Digit) -> Vec<[f64; 2]> {
    let Some(covariance) = prior.covariance_of(&digit.dofs()) else { return Vec::new() };
    let covariance = Mat::from_fn(4, 4, |i, j| covariance[4 * j + i]);
    let Ok(eigen) = covariance.self_adjoint_eigen(Side::Lower) else { return Vec::new() };
    // In ascending order.
    let direction = |k: usize, i: usize| eigen.U()[(i, k)] * eigen.S()[k].max(0.0).sqrt();
    (0..4).map(|i| [direction(3, i), direction(2, i)]).collect()
}
