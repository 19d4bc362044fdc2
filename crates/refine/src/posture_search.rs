//! Digits that went the wrong way: they are tried in other postures.

use glam::DAffine3;
use phalanx_hand::{Bone, Digit, Dof, HandShape, Pose, PosedHand, Primitive};
use phalanx_segmentation::Mask;

use crate::error::{Error, Result};
use crate::geometry::correspondence::ViewMatcher;
use crate::geometry::self_collision;
use crate::observation::silhouette::SilhouetteObservation;
use crate::priors::pose::PosePrior;

/// Places in the range of each of a digit's first two flexions that are tried.
const PLACES: usize = 6;

/// Valleys of the cost over such postures that are followed down.
const VALLEYS: usize = 2;

/// How much higher than a pose the valleys that are followed from it may begin.
const SLOPE: f64 = 50.0;

/// Of the postures of one of two fingers so many are tried with the other's.
const WITHIN: usize = 8;

/// Steps of an angle on the way down a valley, from half the distance of places, radians.
const STEPS: [f64; 3] = [0.16, 0.08, 0.04];

/// Energy of a pixel in which the drawn silhouette differs from the observed one.
const PIXEL: f64 = 1.0;

/// The search for postures that explain the silhouettes better.
pub(crate) struct Search<'a> {
    pub(crate) hand: &'a HandShape,
    pub(crate) rest: &'a DAffine3,
    pub(crate) evidence: &'a [SilhouetteObservation],
    pub(crate) prior: &'a PosePrior,
    /// How the hand seems moved in each view.
    pub(crate) motions: &'a [DAffine3],
    pub(crate) views: &'a mut [ViewMatcher],
}

/// What a search came to.
pub(crate) struct Found {
    pub(crate) pose: Pose,
    /// How much less speaks against it than against the pose that the search began at.
    pub(crate) won: f64,
}

impl Found {
    /// The same with digits put from one posture into another.
    fn and(self, from: &Costed, to: &Costed) -> Self {
        Self { pose: to.pose, won: self.won + (from.cost - to.cost) }
    }
}

/// The hand without the digits that are tried, as each view draws it.
struct Background {
    digits: Vec<Digit>,
    drawn: Vec<Mask>,
    scratch: Mask,
}

/// A posture of one digit or of two, and what speaks against it.
#[derive(Clone, Copy)]
struct Costed {
    cost: f64,
    pose: Pose,
    /// Where it is on the grid: two places for each digit.
    places: [usize; 4],
}

/// A digit alone in one posture of the grid.
struct Drawn {
    pose: Pose,
    places: [usize; 2],
    /// In every view.
    images: Vec<Mask>,
    /// Energy of its pixels outside the observed silhouettes, which no other digit makes up for.
    spill: f64,
}

impl Search<'_> {
    /// Tries every digit in other postures, and keeps those that make the drawn silhouettes differ
    /// from the observed ones in fewer pixels, the prior taken into account.
    pub(crate) fn run(&mut self, start: &Pose) -> Result<Found> {
        let mut found = Found { pose: *start, won: 0.0 };
        for digit in Digit::ALL {
            let mut background = self.background(&found.pose, &[digit])?;
            let standing = self.standing(&found.pose, &mut background)?;
            let tried = self.tried(digit, &standing, &mut background)?;
            found = found.and(&standing, &self.lowest(&standing, tried, &mut background)?);
        }
        Ok(found)
    }

    /// The postures of a digit that explain the silhouettes best, and how much more speaks against each than against the
    /// pose that they differ from.
    pub(crate) fn alternatives(&mut self, digit: Digit, pose: &Pose) -> Result<Vec<(Pose, f64)>> {
        let mut background = self.background(pose, &[digit])?;
        let standing = self.standing(pose, &mut background)?;
        let tried = self.tried(digit, &standing, &mut background)?;
        let follow = |valley: &Costed| {
            let found = self.follow(valley, &mut background)?;
            Ok((found.pose, found.cost - standing.cost))
        };
        valleys(tried).iter().map(follow).collect()
    }

    /// The postures of a digit on the grid against which not much more speaks than against a pose.
    fn tried(
        &mut self,
        digit: Digit,
        standing: &Costed,
        background: &mut Background,
    ) -> Result<Vec<Costed>> {
        let mut tried = Vec::with_capacity(PLACES * PLACES);
        for ([i, j], pose) in self.postures(digit, &standing.pose) {
            let cost = self.cost_below(standing.cost + SLOPE, &pose, background)?;
            tried.extend(cost.map(|cost| Costed { cost, pose, places: [i, j, 0, 0] }));
        }
        Ok(tried)
    }

    /// Tries neighbouring fingers together: where one was taken for the other, neither finds its
    /// place alone.
    pub(crate) fn run_pairs(&mut self, start: &Pose) -> Result<Found> {
        let mut found = Found { pose: *start, won: 0.0 };
        for pair in Digit::FINGERS.windows(2) {
            let mut background = self.background(&found.pose, pair)?;
            let standing = self.standing(&found.pose, &mut background)?;
            let limit = standing.cost + SLOPE;
            let ones = self.drawn(pair[0], &found.pose)?;
            let others = self.drawn(pair[1], &found.pose)?;
            let mut tried = Vec::with_capacity(ones.len() * others.len());
            for one in &ones {
                for other in &others {
                    let mut both = one.pose;
                    pair[1].dofs().into_iter().for_each(|dof| both[dof] = other.pose[dof]);
                    let layers = background.drawn.iter().zip(&one.images).zip(&other.images);
                    let mut cost = self.prior.energy(&both);
                    for (((rest, one), other), seen) in layers.zip(self.evidence) {
                        if cost < limit {
                            cost += PIXEL * f64::from(difference([rest, one, other], seen));
                        }
                    }
                    if cost < limit {
                        let ([i, j], [k, l]) = (one.places, other.places);
                        tried.push(Costed { cost, pose: both, places: [i, j, k, l] });
                    }
                }
            }
            found = found.and(&standing, &self.lowest(&standing, tried, &mut background)?);
        }
        Ok(found)
    }

    /// A digit's first two flexions on a grid over their ranges; the last joint's follows the one
    /// before it, as in the prior. None where the prior knows them.
    fn postures(&self, digit: Digit, pose: &Pose) -> Vec<([usize; 2], Pose)> {
        let [_, base, middle, last] = digit.dofs();
        let Some(covariance) = self.prior.covariance_of(&[middle, last]) else {
            return Vec::new();
        };
        let slope = covariance[1] / covariance[0];
        let at = |dof: Dof, place: usize| {
            let (low, high) = dof.range();
            low + (place as f64 + 0.5) / PLACES as f64 * (high - low)
        };
        let posture = |number: usize| {
            let mut posture = *pose;
            let places = [number / PLACES, number % PLACES];
            posture[base] = at(base, places[0]);
            posture[middle] = at(middle, places[1]);
            let mean = self.prior.mean();
            let (low, high) = last.range();
            let follows = mean[last] + slope * (posture[middle] - mean[middle]);
            posture[last] = follows.clamp(low, high);
            (places, posture)
        };
        (0..PLACES * PLACES).map(posture).collect()
    }

    /// A digit alone, in those postures that lie best within the observed silhouettes.
    fn drawn(&mut self, digit: Digit, pose: &Pose) -> Result<Vec<Drawn>> {
        let mut drawn = Vec::with_capacity(PLACES * PLACES);
        'postures: for (places, pose) in self.postures(digit, pose) {
            let own = primitives(&self.hand.pose(&pose, self.rest), &[digit], Part::Digits);
            let mut images = vec![Mask::default(); self.views.len()];
            let mut outside = 0;
            for (v, image) in images.iter_mut().enumerate() {
                if !self.can_draw(v, &own, image)? {
                    continue 'postures;
                }
                let seen = &self.evidence[v];
                outside += difference([seen.mask(), seen.mask(), image], seen);
            }
            let spill = PIXEL * f64::from(outside) + self.prior.energy(&pose);
            drawn.push(Drawn { pose, places, images, spill });
        }
        drawn.sort_by(|a, b| a.spill.total_cmp(&b.spill));
        drawn.truncate(WITHIN);
        Ok(drawn)
    }

    /// The best of a pose and what others lead to that differ from it in the background's digits.
    fn lowest(
        &mut self,
        standing: &Costed,
        others: Vec<Costed>,
        background: &mut Background,
    ) -> Result<Costed> {
        let mut best = *standing;
        for other in valleys(others) {
            let found = self.follow(&other, background)?;
            if found.cost < best.cost {
                best = found;
            }
        }
        Ok(best)
    }

    /// Follows a valley down by smaller and smaller steps of each angle; the last joint moves with
    /// the one before it.
    fn follow(&mut self, from: &Costed, background: &mut Background) -> Result<Costed> {
        let mut best = *from;
        for step in STEPS {
            for digit in background.digits.clone() {
                let [abduction, base, middle, last] = digit.dofs();
                for moved in [&[abduction][..], &[base], &[middle, last]] {
                    for step in [-step, step] {
                        let mut candidate = best.pose;
                        for &dof in moved {
                            let (low, high) = dof.range();
                            candidate[dof] = (candidate[dof] + step).clamp(low, high);
                        }
                        if let Some(cost) = self.cost_below(best.cost, &candidate, background)? {
                            best = Costed { cost, pose: candidate, ..best };
                        }
                    }
                }
            }
        }
        Ok(best)
    }

    fn background(&mut self, pose: &Pose, digits: &[Digit]) -> Result<Background> {
        let posed = self.hand.pose(pose, self.rest);
        let others: Vec<Primitive> = primitives(&posed, digits, Part::Others);
        let mut drawn = vec![Mask::default(); self.views.len()];
        for (v, image) in drawn.iter_mut().enumerate() {
            self.draw(v, &others, image)?;
        }
        Ok(Background { digits: digits.to_vec(), drawn, scratch: Mask::default() })
    }

    /// The pose that the search begins at.
    fn standing(&mut self, pose: &Pose, background: &mut Background) -> Result<Costed> {
        let cost = self.cost_below(f64::INFINITY, pose, background)?.unwrap_or(f64::INFINITY);
        Ok(Costed { cost, pose: *pose, places: [0; 4] })
    }

    /// What speaks against a pose; none where that reaches a limit, beyond which nothing is drawn.
    fn cost_below(
        &mut self,
        limit: f64,
        pose: &Pose,
        background: &mut Background,
    ) -> Result<Option<f64>> {
        let posed = self.hand.pose(pose, self.rest);
        let own = primitives(&posed, &background.digits, Part::Digits);
        let mut cost = self.prior.energy(pose) + self_collision::energy(&posed);
        for (v, other) in background.drawn.iter().enumerate() {
            if cost >= limit {
                break;
            }
            if !self.can_draw(v, &own, &mut background.scratch)? {
                return Ok(None);
            }
            let differing = difference([other, other, &background.scratch], &self.evidence[v]);
            cost += PIXEL * f64::from(differing);
        }
        Ok((cost < limit).then_some(cost))
    }

    fn draw(&mut self, view: usize, primitives: &[Primitive], image: &mut Mask) -> Result<()> {
        let moved: Vec<Primitive> =
            primitives.iter().map(|primitive| primitive.moved(&self.motions[view])).collect();
        self.views[view].draw(&moved, &self.evidence[view], image)
    }

    /// Whether the view's camera can draw primitives; draws them if so.
    fn can_draw(
        &mut self,
        view: usize,
        primitives: &[Primitive],
        image: &mut Mask,
    ) -> Result<bool> {
        match self.draw(view, primitives, image) {
            Ok(()) => Ok(true),
            Err(Error::Render { .. }) => Ok(false),
            Err(error) => Err(error),
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Part {
    Digits,
    Others,
}

/// The primitives that move with some digits, or all others.
fn primitives(posed: &PosedHand, digits: &[Digit], part: Part) -> Vec<Primitive> {
    let moves = |bone: &Bone| matches!(bone, Bone::Segment(digit, _) if digits.contains(digit));
    let all = posed.primitives.iter().zip(&posed.bones);
    all.filter(|(_, bones)| bones.iter().any(moves) == (part == Part::Digits))
        .map(|(primitive, _)| *primitive)
        .collect()
}

/// How many of the known pixels of the union of three masks differ from what was seen.
fn difference([a, b, c]: [&Mask; 3], seen: &SilhouetteObservation) -> u32 {
    // So few at a time that a byte can count them.
    const COUNTED: usize = 240;
    let layers = a.chunks(COUNTED).zip(b.chunks(COUNTED)).zip(c.chunks(COUNTED));
    let observed = seen.mask().chunks(COUNTED).zip(seen.known().chunks(COUNTED));
    let mut differing = 0;
    for (((a, b), c), (seen, known)) in layers.zip(observed) {
        let drawn = a.iter().zip(b).zip(c).map(|((a, b), c)| a | b | c);
        let pixels = drawn.zip(seen).zip(known);
        let counted = pixels.map(|((drawn, seen), known)| ((drawn ^ seen) & known) >> 7);
        differing += u32::from(counted.sum::<u8>());
    }
    differing
}

/// The lowest of postures on a grid, none beside another.
fn valleys(mut tried: Vec<Costed>) -> Vec<Costed> {
    tried.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut lowest: Vec<Costed> = Vec::with_capacity(VALLEYS);
    for costed in tried {
        let beside = |other: &Costed| {
            let places = costed.places.iter().zip(other.places);
            places.into_iter().all(|(&a, b)| a.abs_diff(b) <= 1)
        };
        if lowest.len() < VALLEYS && !lowest.iter().any(beside) {
            lowest.push(costed);
        }
    }
    lowest
}
