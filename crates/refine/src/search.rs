//! Digits that went the wrong way: they are tried in other postures.

use faer::{Mat, Side};
use glam::DAffine3;
use image::GrayImage;
use phalanx_hand::{Digit, Dof, HandShape, Link, Pose, PosedHand, Primitive};

use crate::view::View;
use crate::{Evidence, PosePrior, Result};

/// Steps along each direction in which the prior leaves a digit freedom, in standard deviations.
const STEPS: [f64; 6] = [-2.1, -1.4, -0.7, 0.7, 1.4, 2.1];

/// How many such directions are tried, those of the most freedom.
const DIRECTIONS: usize = 2;

/// Energy of a pixel in which the drawn silhouette differs from the observed one.
const PIXEL: f64 = 1.0;

/// The search for postures that explain the silhouettes better.
pub(crate) struct Search<'a> {
    pub(crate) hand: &'a HandShape,
    pub(crate) rest: &'a DAffine3,
    pub(crate) evidence: &'a [Evidence],
    pub(crate) prior: &'a PosePrior,
    /// How the hand seems moved in each view.
    pub(crate) motions: &'a [DAffine3],
    pub(crate) views: &'a mut [View],
}

/// The hand without the digits that are tried, as each view draws it.
struct Background {
    digits: Vec<Digit>,
    drawn: Vec<GrayImage>,
    scratch: GrayImage,
}

impl Search<'_> {
    /// Tries every digit in other postures, and keeps those that make the drawn silhouettes differ
    /// from the observed ones in fewer pixels, the prior taken into account.
    pub(crate) fn run(&mut self, start: &Pose) -> Result<Pose> {
        let mut pose = *start;
        for digit in Digit::ALL {
            let mut background = self.background(&pose, &[digit])?;
            for direction in freedom(self.prior, digit) {
                let stepped = |step: f64| {
                    let mut candidate = pose;
                    for (dof, along) in digit.dofs().into_iter().zip(direction) {
                        let (low, high) = dof.range();
                        candidate[dof] = (pose[dof] + step * along).clamp(low, high);
                    }
                    candidate
                };
                pose = self.best(&pose, STEPS.map(stepped), &mut background)?;
            }
        }
        Ok(pose)
    }

    /// Tries neighbouring fingers together in postures from their whole ranges: where one was taken
    /// for the other, neither finds its place alone.
    pub(crate) fn run_pairs(&mut self, start: &Pose) -> Result<Pose> {
        let mut pose = *start;
        for pair in Digit::FINGERS.windows(2) {
            let background = self.background(&pose, pair)?;
            let mut tried = Vec::with_capacity(2);
            for &digit in pair {
                let mut postures = grid(self.prior, digit, &pose);
                postures.push(pose);
                tried.push(self.drawn(digit, &postures)?);
            }
            let mut best = (f64::INFINITY, pose);
            for (one, ones) in &tried[0] {
                for (other, others) in &tried[1] {
                    let mut both = *one;
                    pair[1].dofs().into_iter().for_each(|dof| both[dof] = other[dof]);
                    let views = background.drawn.iter().zip(ones).zip(others).zip(self.evidence);
                    let differing: u32 = views
                        .map(|(((rest, one), other), seen)| {
                            difference([rest, one, other], seen.mask())
                        })
                        .sum();
                    let cost = PIXEL * f64::from(differing) + self.prior.energy(&both);
                    if cost < best.0 {
                        best = (cost, both);
                    }
                }
            }
            pose = best.1;
        }
        Ok(pose)
    }

    /// A digit in each of some postures, alone, in every view.
    fn drawn(&mut self, digit: Digit, postures: &[Pose]) -> Result<Vec<(Pose, Vec<GrayImage>)>> {
        let mut drawn = Vec::with_capacity(postures.len());
        for &posture in postures {
            let own = solids(&self.hand.pose(&posture, self.rest), &[digit], Part::Digits);
            let mut images = vec![GrayImage::default(); self.views.len()];
            for (v, image) in images.iter_mut().enumerate() {
                self.draw(v, &own, image)?;
            }
            drawn.push((posture, images));
        }
        Ok(drawn)
    }

    /// The best of a pose and others that differ from it in the background's digits.
    fn best(
        &mut self,
        pose: &Pose,
        others: impl IntoIterator<Item = Pose>,
        background: &mut Background,
    ) -> Result<Pose> {
        let mut best = (self.cost(pose, background)?, *pose);
        for candidate in others {
            let cost = self.cost(&candidate, background)?;
            if cost < best.0 {
                best = (cost, candidate);
            }
        }
        Ok(best.1)
    }

    fn background(&mut self, pose: &Pose, digits: &[Digit]) -> Result<Background> {
        let posed = self.hand.pose(pose, self.rest);
        let others: Vec<Primitive> = solids(&posed, digits, Part::Others);
        let mut drawn = vec![GrayImage::default(); self.views.len()];
        for (v, image) in drawn.iter_mut().enumerate() {
            self.draw(v, &others, image)?;
        }
        Ok(Background { digits: digits.to_vec(), drawn, scratch: GrayImage::default() })
    }

    fn cost(&mut self, pose: &Pose, background: &mut Background) -> Result<f64> {
        let posed = self.hand.pose(pose, self.rest);
        let own = solids(&posed, &background.digits, Part::Digits);
        let mut differing = 0;
        for (v, other) in background.drawn.iter().enumerate() {
            self.draw(v, &own, &mut background.scratch)?;
            differing += difference([other, other, &background.scratch], self.evidence[v].mask());
        }
        Ok(PIXEL * f64::from(differing) + self.prior.energy(pose))
    }

    fn draw(&mut self, view: usize, solids: &[Primitive], image: &mut GrayImage) -> Result<()> {
        let moved: Vec<Primitive> =
            solids.iter().map(|solid| solid.moved(&self.motions[view])).collect();
        self.views[view].draw(&moved, &self.evidence[view], image)
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Part {
    Digits,
    Others,
}

/// The solids that move with some digits, or all others.
fn solids(posed: &PosedHand, digits: &[Digit], part: Part) -> Vec<Primitive> {
    let moves = |link: &Link| matches!(link, Link::Segment(digit, _) if digits.contains(digit));
    let all = posed.primitives.iter().zip(&posed.links);
    all.filter(|(_, links)| links.iter().any(moves) == (part == Part::Digits))
        .map(|(solid, _)| *solid)
        .collect()
}

/// How many pixels of the union of three masks differ from a fourth.
fn difference([a, b, c]: [&GrayImage; 3], seen: &GrayImage) -> u32 {
    let pixels = a.iter().zip(b.iter()).zip(c.iter()).zip(seen.iter());
    pixels.map(|(((a, b), c), seen)| u32::from((a | b | c) >> 7 != seen >> 7)).sum()
}

/// The principal directions of the prior's covariance of a digit's four angles, each as long as its
/// standard deviation; none where the prior knows an angle.
fn freedom(prior: &PosePrior, digit: Digit) -> Vec<[f64; 4]> {
    let Some(covariance) = prior.covariance_of(&digit.dofs()) else { return Vec::new() };
    let covariance = Mat::from_fn(4, 4, |i, j| covariance[4 * j + i]);
    let Ok(eigen) = covariance.self_adjoint_eigen(Side::Lower) else { return Vec::new() };
    // Eigenvalues ascend.
    let direction = |k: usize| {
        let length = eigen.S()[k].max(0.0).sqrt();
        std::array::from_fn(|i| eigen.U()[(i, k)] * length)
    };
    (4 - DIRECTIONS..4).rev().map(direction).collect()
}

/// A digit's two flexions next to its base on a grid over their ranges; the last joint's follows the
/// one before it, as in the prior.
fn grid(prior: &PosePrior, digit: Digit, pose: &Pose) -> Vec<Pose> {
    const PLACES: [f64; 4] = [0.1, 0.37, 0.63, 0.9];
    let [_, base, middle, last] = digit.dofs();
    let Some(covariance) = prior.covariance_of(&[middle, last]) else { return Vec::new() };
    let slope = covariance[1] / covariance[0];
    let at = |dof: Dof, place: f64| {
        let (low, high) = dof.range();
        low + place * (high - low)
    };
    let posture = |base_place: f64, middle_place: f64| {
        let mut posture = *pose;
        posture[base] = at(base, base_place);
        posture[middle] = at(middle, middle_place);
        let (low, high) = last.range();
        let follows = prior.mean()[last] + slope * (posture[middle] - prior.mean()[middle]);
        posture[last] = follows.clamp(low, high);
        posture
    };
    PLACES.iter().flat_map(|&b| PLACES.iter().map(move |&m| posture(b, m))).collect()
}
